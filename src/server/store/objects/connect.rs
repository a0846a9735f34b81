//! Opens an object store by its URL.

use std::{sync::Arc, time::Duration};

use futures_util::TryStreamExt as _;
use object_store::{
    ClientOptions, Error, ObjectStore, ObjectStoreExt as _, ObjectStoreScheme, PutPayload, RetryConfig,
    aws::AmazonS3Builder, azure::MicrosoftAzureBuilder, gcp::GoogleCloudStorageBuilder, path::Path,
};

use crate::store::{ConnectError, certificates};

/// Time limit for a request with its retries, and for connecting.
const RETRY: Duration = Duration::from_secs(8);
/// Timeout until the first byte of a response, and between two reads. A large response may take longer in total.
const READ_TIMEOUT: Duration = Duration::from_secs(30);

/// Environment variables that may contain the URL of an object store.
const ENDPOINTS: [&str; 5] =
    ["AWS_ENDPOINT", "AWS_ENDPOINT_URL", "AWS_ENDPOINT_URL_S3", "AZURE_STORAGE_ENDPOINT", "GOOGLE_BASE_URL"];

/// The environment variables for credentials, for error messages.
const SETTINGS: &str = "s3:// needs AWS_ACCESS_KEY_ID and AWS_SECRET_ACCESS_KEY, or the machine's role; gs:// needs \
    GOOGLE_SERVICE_ACCOUNT; az:// needs AZURE_STORAGE_ACCOUNT_NAME and AZURE_STORAGE_ACCOUNT_KEY";

/// Parts of the URLs of cloud metadata services. A client without credentials requests the machine's role there.
const METADATA: [&str; 3] = ["/latest/api/token", "/computeMetadata/", "/metadata/identity/"];

/// The name of the object that tests whether the store can be written.
const MARK: &str = "ltcforge";

/// Installs the cryptography provider for reqwest.
pub(super) fn install_crypto() {
    // This fails if a provider is already installed, which is fine.
    let _ = rustls::crypto::ring::default_provider().install_default();
}

/// The error for a missing setting.
pub(super) fn lacking(url: &str, reason: &str) -> ConnectError {
    ConnectError(format!("the environment lacks settings for {url}: {reason}"))
}

/// Connects to the object store at `url`. Reads credentials from the same environment variables as the cloud provider's
/// tools.
pub(super) fn connect(url: &str) -> Result<(Arc<dyn ObjectStore>, Path), ConnectError> {
    let bad = |url: &str, reason: &str| {
        let schemes = "use s3://BUCKET/PREFIX, gs:// or az://";
        ConnectError(format!("`{url}` is not the URL of an object store: {reason}; {schemes}"))
    };
    let parsed = reqwest::Url::parse(url).map_err(|error| bad(url, &error.to_string()))?;
    if !parsed.username().is_empty() || parsed.password().is_some() || parsed.query().is_some() {
        let reason = "leave credentials out of the URL; they are read from the environment";
        return Err(bad(&format!("{}://...", parsed.scheme()), reason));
    }
    let (scheme, prefix) = ObjectStoreScheme::parse(&parsed).map_err(|error| bad(url, &error.to_string()))?;
    install_crypto();
    // `from_env` also reads AWS_ALLOW_HTTP and AWS_ENDPOINT.
    let is_plain = std::env::var_os("AWS_ALLOW_HTTP").is_some_and(|value| value == "true");
    let mut has_plain_endpoint = false;
    for name in ENDPOINTS {
        let endpoint = std::env::var(name).ok().and_then(|value| reqwest::Url::parse(&value).ok());
        let Some(endpoint) = endpoint else { continue };
        has_plain_endpoint |= endpoint.scheme() == "http";
        if !endpoint.username().is_empty() || endpoint.password().is_some() {
            return Err(ConnectError(format!(
                "the environment variable {name} has a user or a password, which errors would show; use the credential variables"
            )));
        }
        if endpoint.scheme() == "http" && scheme == ObjectStoreScheme::AmazonS3 && name.starts_with("AWS") && !is_plain
        {
            return Err(lacking(url, &format!("{name} is an http:// URL, which needs AWS_ALLOW_HTTP=true")));
        }
    }
    if !has_plain_endpoint {
        certificates::load().map_err(|reason| lacking(url, &reason))?;
    }
    let client = ClientOptions::new().with_timeout_disabled();
    let client = client.with_read_timeout(READ_TIMEOUT).with_connect_timeout(RETRY);
    let retry = RetryConfig { retry_timeout: RETRY, ..RetryConfig::default() };
    let failed = |error: Error| lacking(url, &format!("{}; {SETTINGS}", text(&error)));
    macro_rules! built {
        ($builder:expr) => {{ Ok((Arc::new($builder.with_url(url).with_retry(retry).build().map_err(failed)?), prefix)) }};
    }
    match scheme {
        ObjectStoreScheme::AmazonS3 => {
            built!(AmazonS3Builder::from_env().with_client_options(client.with_allow_http(is_plain)))
        }
        ObjectStoreScheme::GoogleCloudStorage => {
            built!(GoogleCloudStorageBuilder::from_env().with_client_options(client))
        }
        ObjectStoreScheme::MicrosoftAzure => built!(MicrosoftAzureBuilder::from_env().with_client_options(client)),
        _ => Err(bad(url, &format!("the scheme `{}` is not supported", parsed.scheme()))),
    }
}

/// Checks that the store can be read, or if `writes`, that it can be written.
pub(super) async fn probe(store: &dyn ObjectStore, prefix: &Path, url: &str, writes: bool) -> Result<(), ConnectError> {
    let (verb, done) = if writes {
        let mark = prefix.clone().join(MARK);
        let text = PutPayload::from_static(b"ltcforge keeps its tables here\n");
        ("written", store.put(&mark, text).await.map(drop))
    } else {
        ("read", store.list(Some(prefix)).try_next().await.map(drop))
    };
    done.map_err(|error| {
        let reason = text(&error);
        let is_missing = matches!(error, Error::NotFound { .. }) || reason.contains("NoSuchBucket");
        if matches!(error, Error::PermissionDenied { .. } | Error::Unauthenticated { .. }) {
            ConnectError(format!("the object store {url} cannot be {verb}: {reason}"))
        } else if is_missing {
            ConnectError(format!("the object store {url} does not exist: {reason}; create the bucket first"))
        } else if METADATA.iter().any(|address| reason.contains(address)) {
            lacking(url, &format!("no credentials are set: {reason}; {SETTINGS}"))
        } else {
            ConnectError(format!("the object store {url} cannot be reached: {reason}"))
        }
    })
}

/// The text of an error in one line.
pub(super) fn text(error: &Error) -> String {
    error.to_string().split_whitespace().collect::<Vec<_>>().join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_url_is_refused_without_its_secrets() {
        for url in ["", "tables", "ftp://host/x", "http://host/x", "memory:///", "file:///tmp"] {
            let error = connect(url).unwrap_err().to_string();
            assert!(error.contains("is not the URL of an object store"), "{error}");
        }
        let error = connect("s3://key:hunter2@bucket/x").unwrap_err().to_string();
        assert!(!error.contains("hunter2") && error.contains("environment"), "{error}");
    }
}
