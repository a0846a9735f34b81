//! The certificate by which the service speaks TLS.

use std::{
    io,
    path::{Path, PathBuf},
    sync::{Arc, PoisonError, RwLock},
};

use rustls::{
    ServerConfig,
    crypto::ring::default_provider,
    pki_types::{CertificateDer, PrivateKeyDer, pem::PemObject as _},
    server::{ClientHello, ResolvesServerCert},
    sign::CertifiedKey,
};
use tokio_rustls::TlsAcceptor;

use super::seen::{Renewed, Seen};

/// Why a certificate cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum CertificateError {
    /// A file is not there, or is not PEM of what it should be.
    #[error("{}: {reason}", .path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        reason: String,
    },
    /// The key is of a kind that is not known, or of another certificate.
    #[error("certificate {} and key {}: {source}", .certificate.display(), .key.display())]
    Pair {
        /// The file of the certificate.
        certificate: PathBuf,
        /// The file of the key.
        key: PathBuf,
        /// Why they do not go together.
        source: rustls::Error,
    },
}

/// A chain of certificates and its key, as the files were when they were last read.
#[derive(Debug)]
pub struct Certificates {
    chain: PathBuf,
    key: PathBuf,
    seen: Seen,
    current: RwLock<Arc<CertifiedKey>>,
}

impl Certificates {
    /// The certificates of `chain`, the service's own first, and the private key of `key`, both PEM.
    ///
    /// # Errors
    /// See [`CertificateError`].
    pub fn open(chain: PathBuf, key: PathBuf) -> Result<Self, CertificateError> {
        let seen = Seen::new(vec![chain.clone(), key.clone()]);
        seen.have_changed();
        let current = RwLock::new(Arc::new(read(&chain, &key)?));
        Ok(Self { chain, key, seen, current })
    }

    /// What begins TLS on a connection, with the certificate as it is then.
    ///
    /// # Errors
    /// When the library has no version of TLS.
    pub(super) fn acceptor(self: &Arc<Self>) -> io::Result<TlsAcceptor> {
        let versions =
            ServerConfig::builder_with_provider(Arc::new(default_provider())).with_safe_default_protocol_versions();
        let config = versions.map_err(io::Error::other)?.with_no_client_auth();
        let resolver: Arc<dyn ResolvesServerCert> = Arc::clone(self) as _;
        let mut config = config.with_cert_resolver(resolver);
        config.alpn_protocols = vec![b"http/1.1".to_vec()];
        Ok(TlsAcceptor::from(Arc::new(config)))
    }
}

fn read(chain: &Path, key: &Path) -> Result<CertifiedKey, CertificateError> {
    let fault = |path: &Path, reason: String| CertificateError::File { path: path.to_owned(), reason };
    let certificates = CertificateDer::pem_file_iter(chain).and_then(Iterator::collect::<Result<Vec<_>, _>>);
    let certificates = certificates.map_err(|error| fault(chain, error.to_string()))?;
    if certificates.is_empty() {
        return Err(fault(chain, "it has no certificate in PEM".to_owned()));
    }
    let private = PrivateKeyDer::from_pem_file(key).map_err(|error| fault(key, format!("no private key: {error}")))?;
    CertifiedKey::from_der(certificates, private, &default_provider()).map_err(|source| CertificateError::Pair {
        certificate: chain.to_owned(),
        key: key.to_owned(),
        source,
    })
}

impl ResolvesServerCert for Certificates {
    fn resolve(&self, _: ClientHello<'_>) -> Option<Arc<CertifiedKey>> {
        Some(Arc::clone(&self.current.read().unwrap_or_else(PoisonError::into_inner)))
    }
}

impl Renewed for Certificates {
    fn seen(&self) -> &Seen {
        &self.seen
    }

    fn renew(&self) {
        match read(&self.chain, &self.key) {
            Ok(read) => {
                *self.current.write().unwrap_or_else(PoisonError::into_inner) = Arc::new(read);
                tracing::info!(path = %self.chain.display(), "the certificate was read again");
            }
            Err(error) => tracing::error!("{error}; the certificate from before stays"),
        }
    }
}
