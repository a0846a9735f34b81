//! Access to the service: its tokens and its certificate. The service does not start if it would be open to everyone by
//! accident.

use std::sync::Arc;

use super::{CommandFailure, settings::ServeSettings, usage};
use ltcforge_server::http::{Certificate, TokenFile};

impl ServeSettings {
    /// The tokens of the service.
    ///
    /// # Errors
    /// When the tokens are invalid, or other machines can reach the service and it has no tokens.
    pub(super) fn tokens(&self) -> Result<Arc<TokenFile>, CommandFailure> {
        let listed = self.token_list.as_ref().map(|list| list.replace(';', "\n"));
        let tokens = TokenFile::open(listed, self.tokens.clone()).map(Arc::new).map_err(usage)?;
        let is_local = self.listen.ip().to_canonical().is_loopback();
        if is_local || self.allow_anyone == Some(true) || !tokens.current().is_empty() {
            return Ok(tokens);
        }
        Err(usage(format!(
            "other machines may reach {}, and there are no tokens: add --tokens FILE (`ltcforge token new` makes \
             a token), or --allow-anyone to let everyone read, submit, cancel and delete",
            self.listen
        )))
    }

    /// The certificate of the service; `None` for plain HTTP.
    ///
    /// # Errors
    /// When one of the two files is missing or invalid.
    pub(super) fn certificate(&self) -> Result<Option<Arc<Certificate>>, CommandFailure> {
        match (&self.tls_certificate, &self.tls_key) {
            (None, None) => Ok(None),
            (Some(certificate), Some(key)) => {
                Certificate::open(certificate.clone(), key.clone()).map(Arc::new).map(Some).map_err(usage)
            }
            (Some(_), None) => Err(usage("--tls-certificate needs --tls-key")),
            (None, Some(_)) => Err(usage("--tls-key needs --tls-certificate")),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Exit, settings::tests::settings};

    #[test]
    fn a_public_address_needs_tokens_or_allow_anyone() {
        let check = |flags: &[&str]| settings("", flags).tokens().map(|tokens| !tokens.current().is_empty());
        assert_eq!(check(&[]), Ok(false));
        for local in ["--listen=127.0.0.2:1", "--listen=[::1]:1", "--listen=[::ffff:127.0.0.1]:1"] {
            assert_eq!(check(&[local]), Ok(false), "{local}");
        }
        let list = format!("--token-list=a read sha256:{};b admin sha256:{}", "0".repeat(64), "1".repeat(64));
        for of_others in ["--listen=0.0.0.0:1", "--listen=[::]:1", "--listen=10.0.0.1:1"] {
            let refused = check(&[of_others]).expect_err(of_others);
            assert!(refused.exit == Exit::Usage && refused.message.contains("--allow-anyone"), "{refused:?}");
            assert_eq!(check(&[of_others, "--allow-anyone"]), Ok(false));
            assert_eq!(check(&[of_others, &list]), Ok(true));
        }
        let faults = check(&["--token-list=a read ltcforge_12;b", "--allow-anyone"]).expect_err("faults");
        assert!(faults.message.contains("line 2") && !faults.message.contains("ltcforge_12"), "{faults:?}");
        assert!(check(&["--token-list="]).is_err(), "a list without a token is an error");
    }
}
