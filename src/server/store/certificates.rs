//! The certificates that servers are checked against.

use std::{env, fs::File};

use rustls::pki_types::CertificateDer;

/// The system's certificates, or those of `SSL_CERT_FILE` and `SSL_CERT_DIR`.
///
/// # Errors
/// One sentence that says which are missing: no file of `SSL_CERT_FILE`, or no certificate at all.
pub(super) fn load() -> Result<Vec<CertificateDer<'static>>, String> {
    let file = env::var_os("SSL_CERT_FILE");
    if let Some(file) = &file {
        File::open(file).map_err(|error| format!("SSL_CERT_FILE={} cannot be read: {error}", file.display()))?;
    }
    let loaded = rustls_native_certs::load_native_certs();
    if loaded.certs.is_empty() {
        return Err(match file {
            Some(file) => format!("SSL_CERT_FILE={} has no certificate", file.display()),
            None => "there are no certificates in the system (package ca-certificates) or in SSL_CERT_DIR".to_owned(),
        });
    }
    Ok(loaded.certs)
}
