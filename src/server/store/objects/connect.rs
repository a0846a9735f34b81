//! Opening an object store by its URL.

use std::{sync::Arc, time::Duration};

use futures_util::TryStreamExt as _;
use object_store::{
    ClientOptions, Error, ObjectStore, ObjectStoreExt as _, ObjectStoreScheme, PutPayload, RetryConfig,
    aws::AmazonS3Builder, azure::MicrosoftAzureBuilder, gcp::GoogleCloudStorageBuilder, local::LocalFileSystem,
    path::Path, signer::Signer,
};

/// How long a request is tried again.
const RETRY: Duration = Duration::from_secs(8);
/// How long a store may be silent: until the answer to a request begins, and between two pieces of it. A large answer may
/// take as long as it keeps coming.
const SILENCE: Duration = Duration::from_secs(30);

/// Variables of the environment with addresses of stores.
const ENDPOINTS: [&str; 5] =
    ["AWS_ENDPOINT", "AWS_ENDPOINT_URL", "AWS_ENDPOINT_URL_S3", "AZURE_STORAGE_ENDPOINT", "GOOGLE_BASE_URL"];

/// The object that shows whether the store can be written.
const MARK: &str = "ltcforge";

/// What a process does with a store of blobs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Access {
    /// It reads.
    Read,
    /// It also writes.
    Write,
}

/// Why a store of blobs cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum ObjectsOpenError {
    /// The URL cannot be read.
    #[error("«{url}» is no store of blobs: {reason}; it is s3://BUCKET/PREFIX, gs://, az:// or file:///FOLDER")]
    BadUrl {
        /// The URL.
        url: String,
        /// What is wrong.
        reason: String,
    },
    /// An address in the environment has a user or a password.
    #[error(
        "{0} of the environment has a user or a password, which errors would show: credentials have variables of their own"
    )]
    SecretInEndpoint(&'static str),
    /// The bucket or folder does not exist.
    #[error("the store of blobs {url} does not exist: {reason}")]
    Missing {
        /// The URL.
        url: String,
        /// The store's answer.
        reason: String,
    },
    /// The credentials do not suffice.
    #[error("the store of blobs {url} cannot be {verb}: {reason}")]
    Refused {
        /// The URL.
        url: String,
        /// `read` or `written`.
        verb: &'static str,
        /// The store's answer.
        reason: String,
    },
    /// It does not answer.
    #[error("the store of blobs {url} cannot be reached: {reason}")]
    Unreachable {
        /// The URL.
        url: String,
        /// Why.
        reason: String,
    },
}

/// A store, and what signs URLs of its objects.
#[derive(Debug, Clone)]
pub(super) struct Connected {
    pub(super) store: Arc<dyn ObjectStore>,
    pub(super) signer: Option<Arc<dyn Signer>>,
    pub(super) prefix: Path,
}

/// The store of `url`, with credentials as the provider's own tools read them from the environment.
pub(super) fn connect(url: &str) -> Result<Connected, ObjectsOpenError> {
    let bad = |reason: String| ObjectsOpenError::BadUrl { url: url.to_owned(), reason };
    let parsed = reqwest::Url::parse(url).map_err(|error| bad(error.to_string()))?;
    if !parsed.username().is_empty() || parsed.password().is_some() || parsed.query().is_some() {
        return Err(ObjectsOpenError::BadUrl {
            url: format!("{}://...", parsed.scheme()),
            reason: "credentials are not part of the URL; they are read from the environment".to_owned(),
        });
    }
    let (scheme, prefix) = ObjectStoreScheme::parse(&parsed).map_err(|error| bad(error.to_string()))?;
    // reqwest needs to be told which library of cryptography it uses. Who was told before has it already.
    let _ = rustls::crypto::ring::default_provider().install_default();
    for name in ENDPOINTS {
        let endpoint = std::env::var(name).ok().and_then(|value| reqwest::Url::parse(&value).ok());
        if endpoint.is_some_and(|endpoint| !endpoint.username().is_empty() || endpoint.password().is_some()) {
            return Err(ObjectsOpenError::SecretInEndpoint(name));
        }
    }
    let client = ClientOptions::new().with_timeout_disabled().with_read_timeout(SILENCE).with_connect_timeout(RETRY);
    let retry = RetryConfig { retry_timeout: RETRY, ..RetryConfig::default() };
    let failed = |error: Error| bad(error.to_string());
    let (store, signer): (Arc<dyn ObjectStore>, Option<Arc<dyn Signer>>) = match scheme {
        ObjectStoreScheme::AmazonS3 => {
            // `from_env` also reads AWS_ALLOW_HTTP and AWS_ENDPOINT.
            let is_plain = std::env::var_os("AWS_ALLOW_HTTP").is_some_and(|value| value == "true");
            let builder = AmazonS3Builder::from_env().with_url(url).with_retry(retry);
            let store = builder.with_client_options(client.with_allow_http(is_plain)).build().map_err(failed)?;
            let store = Arc::new(store);
            (Arc::clone(&store) as _, Some(store))
        }
        ObjectStoreScheme::GoogleCloudStorage => {
            let builder = GoogleCloudStorageBuilder::from_env().with_url(url).with_retry(retry);
            let store = Arc::new(builder.with_client_options(client).build().map_err(failed)?);
            (Arc::clone(&store) as _, Some(store))
        }
        ObjectStoreScheme::MicrosoftAzure => {
            let builder = MicrosoftAzureBuilder::from_env().with_url(url).with_retry(retry);
            let store = Arc::new(builder.with_client_options(client).build().map_err(failed)?);
            (Arc::clone(&store) as _, Some(store))
        }
        ObjectStoreScheme::Local => {
            // A network folder that is not mounted must not become a local one.
            let folder = parsed.to_file_path().map_err(|()| bad("it is no path of this machine".to_owned()))?;
            if !folder.is_dir() {
                let reason = "there is no such folder".to_owned();
                return Err(ObjectsOpenError::Missing { url: url.to_owned(), reason });
            }
            (Arc::new(LocalFileSystem::new().with_fsync(true)), None)
        }
        _ => return Err(bad(format!("«{}» is not one of its schemes", parsed.scheme()))),
    };
    Ok(Connected { store, signer, prefix })
}

/// Whether the store can be used as `access` says.
pub(super) async fn probe(connected: &Connected, url: &str, access: Access) -> Result<(), ObjectsOpenError> {
    let verb = if access == Access::Write { "written" } else { "read" };
    let done = match access {
        Access::Write => {
            let mark = connected.prefix.clone().join(MARK);
            connected.store.put(&mark, PutPayload::from_static(b"ltcforge keeps its tables here\n")).await.map(drop)
        }
        Access::Read => connected.store.list(Some(&connected.prefix)).try_next().await.map(drop),
    };
    let url = url.to_owned();
    done.map_err(|error| {
        let reason = text(&error);
        match error {
            Error::NotFound { .. } => ObjectsOpenError::Missing { url, reason },
            Error::PermissionDenied { .. } | Error::Unauthenticated { .. } => {
                ObjectsOpenError::Refused { url, verb, reason }
            }
            _ if reason.contains("NoSuchBucket") => ObjectsOpenError::Missing { url, reason },
            _ if reason.contains("ermission denied") => ObjectsOpenError::Refused { url, verb, reason },
            _ => ObjectsOpenError::Unreachable { url, reason },
        }
    })
}

/// The error in one line.
pub(super) fn text(error: &Error) -> String {
    error.to_string().split_whitespace().collect::<Vec<_>>().join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_url_is_refused_without_its_secrets() {
        for url in ["", "tables", "ftp://host/x", "http://host/x", "memory:///"] {
            assert!(matches!(connect(url), Err(ObjectsOpenError::BadUrl { .. })), "{url}");
        }
        let error = connect("s3://key:hunter2@bucket/x").unwrap_err().to_string();
        assert!(!error.contains("hunter2") && error.contains("environment"), "{error}");
        assert_eq!(connect("file:///tmp").unwrap().prefix, Path::from("tmp"));
        assert!(matches!(connect("file:///tmp/nowhere/x"), Err(ObjectsOpenError::Missing { .. })));
    }
}
