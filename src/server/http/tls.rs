//! The TLS certificate. It is read again when its files change.

use std::{path::PathBuf, sync::Arc};

use axum_server::tls_rustls::RustlsConfig;
use rustls::{
    ServerConfig,
    crypto::ring::default_provider,
    pki_types::{CertificateDer, PrivateKeyDer, pem::PemObject as _},
};

use super::watched::{self, Watched};

/// A certificate chain and its key.
#[derive(Debug)]
pub struct Certificate {
    chain: PathBuf,
    key: PathBuf,
    watched: Watched,
    pub(super) config: RustlsConfig,
}

impl Certificate {
    /// Reads the PEM files `chain` and `key`. The service's own certificate comes first in the chain.
    ///
    /// # Errors
    /// A message that names the file with the error.
    pub fn open(chain: PathBuf, key: PathBuf) -> Result<Self, String> {
        let watched = Watched::new(vec![chain.clone(), key.clone()]);
        let config = RustlsConfig::from_config(config(&chain, &key)?);
        Ok(Self { chain, key, watched, config })
    }

    /// Reads the files again if they changed. After an error the previous certificate stays in use.
    pub(super) fn look(&self) {
        if !self.watched.changed() {
            return;
        }
        match config(&self.chain, &self.key) {
            Ok(config) => {
                self.config.reload_from_config(config);
                tracing::info!("the certificate {} changed; using the new certificate", self.chain.display());
            }
            Err(error) => tracing::error!("{error}; the previous certificate stays in use"),
        }
    }
}

fn config(chain: &PathBuf, key: &PathBuf) -> Result<Arc<ServerConfig>, String> {
    let fault = |path: &PathBuf, error: &dyn std::fmt::Display| format!("{}: {error}", path.display());
    let read = |path: &PathBuf| watched::read(path).map_err(|error| fault(path, &error));
    let certificates = CertificateDer::pem_slice_iter(&read(chain)?).collect::<Result<Vec<_>, _>>();
    let certificates = certificates.map_err(|error| fault(chain, &error))?;
    if certificates.is_empty() {
        return Err(fault(chain, &"the file contains no PEM certificate"));
    }
    let private = PrivateKeyDer::from_pem_slice(&read(key)?);
    let private = private.map_err(|error| fault(key, &format!("the file contains no PEM private key: {error}")))?;
    let builder = ServerConfig::builder_with_provider(Arc::new(default_provider()))
        .with_safe_default_protocol_versions()
        .map_err(|error| error.to_string())?;
    let config = builder.with_no_client_auth().with_single_cert(certificates, private);
    let mut config =
        config.map_err(|error| format!("certificate {} and key {}: {error}", chain.display(), key.display()))?;
    config.alpn_protocols = vec![b"http/1.1".to_vec()];
    Ok(Arc::new(config))
}
