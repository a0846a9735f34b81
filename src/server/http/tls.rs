//! The TLS certificate. It is read again when its files change.

use std::{path::PathBuf, sync::Arc};

use axum_server::tls_rustls::RustlsConfig;
use jiff::Timestamp;
use rustls::{
    CertificateError, Error, RootCertStore, ServerConfig,
    client::verify_server_cert_signed_by_trust_anchor,
    crypto::ring::default_provider,
    pki_types::{CertificateDer, PrivateKeyDer, UnixTime, pem::PemObject as _},
    server::ParsedCertificate,
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
    for fault in certificates.iter().filter_map(|certificate| fault_of_time(certificate, UnixTime::now())) {
        tracing::warn!("{}: {fault}; clients will refuse it", chain.display());
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

/// A warning about a certificate that has expired or is not yet valid at `now`. Without trusted roots, verification
/// always fails, but it checks the time first.
fn fault_of_time(certificate: &CertificateDer<'_>, now: UnixTime) -> Option<String> {
    let parsed = ParsedCertificate::try_from(certificate).ok()?;
    let algorithms = default_provider().signature_verification_algorithms.all;
    let checked =
        verify_server_cert_signed_by_trust_anchor(&parsed, &RootCertStore::empty(), &[], now, algorithms).err()?;
    let (what, time) = match checked {
        Error::InvalidCertificate(CertificateError::ExpiredContext { not_after, .. }) => ("expired at", not_after),
        Error::InvalidCertificate(CertificateError::NotValidYetContext { not_before, .. }) => {
            ("is not valid before", not_before)
        }
        _ => return None,
    };
    let date = Timestamp::from_second(time.as_secs().cast_signed()).ok()?;
    Some(format!("a certificate {what} {date}"))
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::*;

    /// `openssl req -x509 -newkey ec -pkeyopt ec_paramgen_curve:P-256 -nodes -subj /CN=localhost -days 1`
    const PEM: &str = "\
-----BEGIN CERTIFICATE-----
MIIBfTCCASOgAwIBAgIUT+YI7XKXeYa16NbcmO3Mdob1HZQwCgYIKoZIzj0EAwIw
FDESMBAGA1UEAwwJbG9jYWxob3N0MB4XDTI2MTEyODE4Mzk1NVoXDTI2MTEyOTE4
Mzk1NVowFDESMBAGA1UEAwwJbG9jYWxob3N0MFkwEwYHKoZIzj0CAQYIKoZIzj0D
AQcDQgAECLv2XsMLbONtVHehPv38pGNXBBykdemBRly50SUXkynV5mrqJW+i+PZk
8qNq6LeP2cJkybnbAdRy077vA1fbWaNTMFEwHQYDVR0OBBYEFN+oiA2tx0HYXMws
kSdiHiF3b/2rMB8GA1UdIwQYMBaAFN+oiA2tx0HYXMwskSdiHiF3b/2rMA8GA1Ud
EwEB/wQFMAMBAf8wCgYIKoZIzj0EAwIDSAAwRQIgSrEMhh9j7ytxPRT+JWO+/41l
BVm/bq2YApqheGEV33ECIQCZKayokXPobicbQhb9BjiLpys7P40zbrMYi41wtlL6
qw==
-----END CERTIFICATE-----
";

    #[test]
    fn a_certificate_outside_its_dates_is_reported() {
        let certificate = CertificateDer::from_pem_slice(PEM.as_bytes()).expect("a certificate");
        let [not_before, not_after] = [1_795_891_195, 1_795_977_595];
        for (now, fault) in [
            (not_before - 1, Some("a certificate is not valid before 2026-11-28T18:39:55Z")),
            (not_before, None),
            (not_after, None),
            (not_after + 1, Some("a certificate expired at 2026-11-29T18:39:55Z")),
        ] {
            let now = UnixTime::since_unix_epoch(Duration::from_secs(now));
            assert_eq!(fault_of_time(&certificate, now).as_deref(), fault);
        }
    }
}
