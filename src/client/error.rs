//! The errors of requests to a service.

use serde::{Deserialize, Deserializer};

use ltcforge_files::{digest::Digest, recipe_document::Fault};

/// A failed request. Every variant names the URL, or the file in a folder of tables.
#[derive(Debug, thiserror::Error)]
pub enum ClientError {
    /// The text is neither the URL of a server nor a source.
    #[error("{text}: {reason}")]
    BadUrl {
        /// The text, without a password.
        text: String,
        /// The reason.
        reason: &'static str,
    },
    /// A file in a folder of tables cannot be read.
    #[error("{place}: {reason}")]
    Unreadable {
        /// The file.
        place: String,
        /// The system's error.
        reason: String,
    },
    /// No service answers at this URL, or the service says that it is unavailable.
    #[error("{url}: the server is unavailable: {reason}")]
    Unavailable {
        /// The requested URL.
        url: String,
        /// The error of the system or of the server.
        reason: String,
    },
    /// The proxy does not connect to the service.
    #[error("{url}: the proxy {proxy} does not connect: {reason}; NO_PROXY lists hosts to reach without a proxy")]
    Proxy {
        /// The requested URL.
        url: String,
        /// The host and port of the proxy.
        proxy: String,
        /// The error of the system or of the proxy.
        reason: String,
    },
    /// The service refused the request.
    #[error("{url}: {detail} ({status})")]
    Refused {
        /// The requested URL.
        url: String,
        /// HTTP status.
        status: u16,
        /// The problem's detail.
        detail: String,
        /// Faults of a recipe.
        faults: Vec<Fault>,
    },
    /// The response does not come from ltcforge.
    #[error("{url}: unexpected response: {reason}")]
    Unexpected {
        /// The requested URL.
        url: String,
        /// Why the response is not expected.
        reason: String,
    },
    /// The file is longer than the client's limit.
    #[error("{url}: the file is longer than {limit_bytes} bytes, the limit for tables; --table-limit sets the limit")]
    TooLong {
        /// The requested URL.
        url: String,
        /// The limit.
        limit_bytes: u64,
    },
    /// The file is longer than the lock file states.
    #[error("{url}: the file is longer than {stated_bytes} bytes, the size that the lock file states")]
    LongerThanStated {
        /// The requested URL.
        url: String,
        /// The pinned length.
        stated_bytes: u64,
    },
    /// The file is shorter than the lock file states.
    #[error("{url}: the file has {bytes} bytes, but the lock file states {stated_bytes}")]
    TooShort {
        /// The requested URL.
        url: String,
        /// The length of the file.
        bytes: u64,
        /// The pinned length.
        stated_bytes: u64,
    },
    /// The bytes do not have the requested digest.
    #[error("{url}: the bytes hash to {actual}, but {expected} was requested")]
    Mismatch {
        /// The requested URL.
        url: String,
        /// The requested digest.
        expected: Digest,
        /// The digest of the response.
        actual: Digest,
    },
}

/// The part of a problem document that the client reads. It is empty if a proxy sent its own page instead.
#[derive(Debug, Default, Deserialize)]
pub(super) struct ProblemDocument {
    #[serde(default, deserialize_with = "printable_text")]
    pub(super) detail: String,
    #[serde(default)]
    pub(super) errors: Vec<Fault>,
}

/// Replaces the user and the password of each URL with `***`. A password may contain characters that should be encoded
/// in a URL, so it ends at the last `@` of a line.
#[must_use]
pub fn without_passwords(text: &str) -> String {
    let mut parts = text.split("://");
    let mut shown = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        let line = part.lines().next().unwrap_or_default();
        shown.push_str("://");
        match line.rfind('@') {
            Some(at) => shown.extend(["***", &part[at..]]),
            None => shown.push_str(part),
        }
    }
    shown
}

/// The error for a text that is not a URL or a source. The error shows no password.
pub(super) fn bad_url(text: &str, reason: &'static str) -> ClientError {
    ClientError::BadUrl { text: without_passwords(&text.escape_debug().to_string()), reason }
}

/// Whether a character prints nothing or changes the text around it: control characters, marks of text direction, and
/// line breaks.
pub(super) fn is_hidden(c: char) -> bool {
    c.is_control()
        || matches!(c, '\u{61c}' | '\u{200b}'..='\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2060}'..='\u{206f}' | '\u{feff}')
}

/// Makes a server's text safe for a terminal: blanks replace line breaks and other white space, and U+FFFD replaces all
/// other characters that do not print, such as the start of an escape sequence.
pub(super) fn printable(text: &str) -> String {
    let shown = |c: char| match c {
        _ if !is_hidden(c) => c,
        _ if c.is_whitespace() => ' ',
        _ => char::REPLACEMENT_CHARACTER,
    };
    text.chars().map(shown).collect()
}

fn printable_text<'de, D: Deserializer<'de>>(deserializer: D) -> Result<String, D::Error> {
    Ok(printable(&String::deserialize(deserializer)?))
}

impl ClientError {
    /// The error of a request that got no response. All connections go to `proxy`, if there is one.
    pub(super) fn no_response(url: &str, proxy: Option<&str>, error: &ureq::Error) -> Self {
        use std::io::ErrorKind::{ConnectionRefused, HostUnreachable, NetworkUnreachable};
        let is_of_proxy = match error {
            ureq::Error::Io(error) => {
                matches!(error.kind(), ConnectionRefused | HostUnreachable | NetworkUnreachable)
            }
            ureq::Error::Timeout(timeout) => matches!(timeout, ureq::Timeout::Resolve | ureq::Timeout::Connect),
            ureq::Error::HostNotFound | ureq::Error::ConnectionFailed | ureq::Error::ConnectProxyFailed(_) => true,
            _ => false,
        };
        match (Self::transport(url, error), proxy.filter(|_| is_of_proxy)) {
            (Self::Unavailable { url, reason }, Some(proxy)) => Self::Proxy { url, proxy: proxy.to_owned(), reason },
            (error, _) => error,
        }
    }

    /// The error of a connection.
    pub(super) fn transport(url: &str, error: &ureq::Error) -> Self {
        // The error may contain the URL of a proxy, with its password.
        let (url, reason) = (url.to_owned(), without_passwords(&error.to_string()));
        match error {
            ureq::Error::Io(error) if error.kind() == std::io::ErrorKind::FileTooLarge => {
                Self::Unexpected { url, reason }
            }
            ureq::Error::Io(_)
            | ureq::Error::Timeout(_)
            | ureq::Error::HostNotFound
            | ureq::Error::ConnectionFailed
            | ureq::Error::ConnectProxyFailed(_)
            | ureq::Error::BodyStalled => Self::Unavailable { url, reason },
            _ => Self::Unexpected { url, reason },
        }
    }

    /// The error of a response whose status is not a success.
    pub(super) fn status(url: &str, status: u16, body: &[u8]) -> Self {
        let problem: ProblemDocument = serde_json::from_slice(body).unwrap_or_default();
        let url = url.to_owned();
        let shown = |fault: &Fault| Fault { pointer: printable(&fault.pointer), detail: printable(&fault.detail) };
        let faults = problem.errors.iter().map(shown).collect();
        let detail =
            if problem.detail.is_empty() { "the server refused the request".to_owned() } else { problem.detail };
        match status {
            401 => {
                let host = url.split('/').take(3).collect::<Vec<_>>().join("/");
                let detail = format!(
                    "the service needs a valid token: set LTCFORGE_TOKEN='{host} TOKEN', or ask its operator for a token"
                );
                Self::Refused { url, status, detail, faults }
            }
            502..=504 => Self::Unavailable { url, reason: format!("{detail} ({status})") },
            _ => Self::Refused { url, status, detail, faults },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn problems_are_read_and_foreign_pages_are_tolerated() {
        let body = br#"{"type":"/problems/bad-recipe","title":"t","status":422,"detail":"1 fault in the recipe",
            "errors":[{"pointer":"/x","detail":"unknown field"}]}"#;
        let error = ClientError::status("http://h/v1/jobs", 422, body);
        assert_eq!(error.to_string(), "http://h/v1/jobs: 1 fault in the recipe (422)");
        assert!(matches!(error, ClientError::Refused { faults, .. } if faults.len() == 1));
        assert!(matches!(ClientError::status("u", 404, b"<html>"), ClientError::Refused { status: 404, .. }));
    }

    /// Users of the command line set a variable, not a header.
    #[test]
    fn a_missing_token_names_its_variable() {
        let body = br#"{"detail":"the token is missing; send `Authorization: Bearer TOKEN`"}"#;
        let error = ClientError::status("https://h:1/v1/jobs", 401, body).to_string();
        assert!(error.contains("LTCFORGE_TOKEN='https://h:1 TOKEN'") && !error.contains("Bearer"), "{error}");
    }

    #[test]
    fn a_message_of_a_server_cannot_control_the_terminal() {
        let body =
            br#"{"detail":"a\u001b[2Jb\u009bc\r\nd\u202ee","errors":[{"pointer":"/\u001b","detail":"\u0007e"}]}"#;
        let error = ClientError::status("u", 422, body);
        assert_eq!(error.to_string(), "u: a\u{fffd}[2Jb\u{fffd}c  d\u{fffd}e (422)");
        let ClientError::Refused { faults, .. } = error else { panic!("{error}") };
        assert_eq!((faults[0].pointer.as_str(), faults[0].detail.as_str()), ("/\u{fffd}", "\u{fffd}e"));
        assert!(!ClientError::status("u", 503, body).to_string().contains('\x1b'));
    }

    #[test]
    fn no_password_is_shown() {
        for password in ["secret", "se:cret", "se@cret", "se/cret?x#y", "se cret", "se\"cret", "s\u{e4}cret"] {
            let url = format!("http://user:{password}@h:80/ltc");
            assert_eq!(without_passwords(&url), "http://***@h:80/ltc");
            let text = format!("2 | sources = [\"{url}\", \"http://x\"]\n  | ^^^\nmail@x: 'https://{password}@'");
            let shown = without_passwords(&text);
            assert!(!shown.contains(password) && shown.contains("http://x\"]\n  | ^^^\nmail@x"), "{shown}");
        }
        for text in ["", "http://h:80/v1", "a@b", "://", "c://\n@"] {
            assert_eq!(without_passwords(text), text);
        }
    }

    #[test]
    fn the_errors_of_a_gateway_mean_unavailable() {
        for status in [502, 503, 504] {
            assert!(matches!(ClientError::status("u", status, b""), ClientError::Unavailable { .. }), "{status}");
        }
        assert!(matches!(ClientError::status("u", 500, b""), ClientError::Refused { .. }));
    }
}
