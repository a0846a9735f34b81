//! The root certificates for verifying servers.

use std::env;

use ltcforge_files::bounded::open_regular;
use rustls::pki_types::CertificateDer;

/// Loads the system's certificates, or the certificates of `SSL_CERT_FILE` and `SSL_CERT_DIR`.
///
/// # Errors
/// A message if `SSL_CERT_FILE` cannot be read, or if no certificate is found.
pub(super) fn load() -> Result<Vec<CertificateDer<'static>>, String> {
    let file = env::var_os("SSL_CERT_FILE");
    if let Some(file) = &file {
        open_regular(file.as_ref())
            .map_err(|error| format!("SSL_CERT_FILE={} cannot be read: {error}", file.display()))?;
    }
    let loaded = rustls_native_certs::load_native_certs();
    if loaded.certs.is_empty() {
        return Err(match file {
            Some(file) => format!("SSL_CERT_FILE={} contains no certificate", file.display()),
            None => "the system has no certificates; install ca-certificates or set SSL_CERT_DIR".to_owned(),
        });
    }
    Ok(loaded.certs)
}
