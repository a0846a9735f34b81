//! Tokens of services, each for one server.
//!
//! Invariant: a token is sent only to the scheme, host and port that the user gave it for. It is never sent to another
//! server in a lock file, or to the target of a redirect.

use std::str::FromStr;

use ureq::http::Uri;

use super::{ClientError, base::parse_base};

/// The tokens of a user. The type has no `Debug`, so that no message shows a token.
#[derive(Clone, Default, PartialEq, Eq)]
pub struct ServerTokens(Vec<(Server, String)>);

/// Scheme, host in lower case, port.
type Server = (String, String, u16);

/// Why tokens cannot be used. No message shows a token.
#[derive(Debug, thiserror::Error)]
pub enum ServerTokensError {
    /// An item of the list is not a URL and a token, or its server has a token already.
    #[error("token {0}: {1}")]
    Form(usize, &'static str),
    /// The URL of an item is invalid.
    #[error("token {0}: {1}")]
    Url(usize, ClientError),
}

impl FromStr for ServerTokens {
    type Err = ServerTokensError;

    /// Parses a list of `URL TOKEN`, separated by `;`.
    fn from_str(text: &str) -> Result<Self, ServerTokensError> {
        let mut tokens = Self::NONE;
        for (at, part) in (1..).zip(text.split(';')) {
            let wrong = |what| Err(ServerTokensError::Form(at, what));
            let words: Vec<&str> = part.split_whitespace().collect();
            let &[url, token] = words.as_slice() else {
                return wrong("write URL TOKEN, as in «https://farm.example ltcforge_0123...»");
            };
            if !token.bytes().all(|byte| byte.is_ascii_alphanumeric() || b"-._~+/=".contains(&byte)) {
                return wrong("a token may contain only letters, digits and -._~+/=");
            }
            let base = parse_base(url.trim_end_matches('/')).map_err(|error| ServerTokensError::Url(at, error))?;
            if tokens.of(&base).is_some() {
                return wrong("there is another token for the same server");
            }
            tokens.0.push((server(&base), token.to_owned()));
        }
        Ok(tokens)
    }
}

impl ServerTokens {
    /// No tokens.
    pub const NONE: Self = Self(Vec::new());

    /// The token for the server of a URL.
    pub(super) fn of(&self, url: &Uri) -> Option<&str> {
        let wanted = server(url);
        self.0.iter().find(|(server, _)| *server == wanted).map(|(_, token)| token.as_str())
    }
}

fn server(url: &Uri) -> Server {
    let scheme = url.scheme_str().unwrap_or_default().to_ascii_lowercase();
    let port = url.port_u16().unwrap_or(if scheme == "https" { 443 } else { 80 });
    (scheme, url.host().unwrap_or_default().to_ascii_lowercase(), port)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_token_is_for_one_scheme_host_and_port() {
        let tokens: ServerTokens = "https://Farm.example/ltc abc; http://10.0.0.5:8317 def".parse().expect("two");
        for (url, token) in [
            ("https://farm.example", Some("abc")),
            ("https://farm.example:443/other", Some("abc")),
            ("http://farm.example", None),
            ("https://farm.example:444", None),
            ("https://farm.example.attacker.example", None),
            ("https://example", None),
            ("http://10.0.0.5:8317", Some("def")),
            ("http://10.0.0.5", None),
        ] {
            assert_eq!(tokens.of(&url.parse().expect("a URL")), token, "{url}");
        }
    }

    #[test]
    fn an_invalid_list_of_tokens_is_refused_without_being_shown() {
        for text in [
            "",
            "s3cret",
            "http://h s3cret x",
            "h s3cret",
            "http://user@h s3cret",
            "http://h a;http://H:80/ s3cret",
            "http://h s3cret\u{e4}",
        ] {
            let refused = text.parse::<ServerTokens>().err().expect(text);
            assert!(!format!("{refused} {refused:?}").contains("s3cret"), "{refused:?}");
        }
    }
}
