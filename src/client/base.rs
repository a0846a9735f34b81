//! The address of a server.

use std::net::IpAddr;

use ureq::http::Uri;

use super::{ClientError, error::bad_url};

/// Parses the URL of a server.
pub(super) fn parse_base(base: &str) -> Result<Uri, ClientError> {
    // An `@` counts even in the apparent path, because a password may contain a slash that should be encoded.
    if base.contains("://") && base.contains('@') {
        let reason = "the URL has a user or a password, which the client does not send: leave them out";
        return Err(bad_url(base, reason));
    }
    let is_server = |uri: &Uri| {
        matches!(uri.scheme_str(), Some("http" | "https")) && uri.authority().is_some() && uri.query().is_none()
    };
    let Some(uri) = base.parse().ok().filter(is_server) else {
        return Err(bad_url(base, "this is not the URL of a server, such as http://127.0.0.1:8317"));
    };
    // `Uri` ignores a port above 65535, so the port is checked here.
    let authority = uri.authority().map_or("", ureq::http::uri::Authority::as_str);
    match authority.strip_prefix(uri.host().unwrap_or_default()).and_then(|rest| rest.strip_prefix(':')) {
        Some(port) if !port.is_empty() && !port.parse::<u16>().is_ok_and(|port| port > 0) => {
            Err(bad_url(base, "the port must be a number from 1 to 65535"))
        }
        _ => Ok(uri),
    }
}

/// Whether a server is reached without a proxy: with http, because `ureq` asks a proxy for a tunnel, which many proxies
/// allow only for https, and on this machine, which a proxy cannot reach.
pub(super) fn is_direct(uri: &Uri) -> bool {
    let host = uri.host().unwrap_or_default();
    let address = host.trim_start_matches('[').trim_end_matches(']').parse();
    let is_here = host.eq_ignore_ascii_case("localhost") || address.is_ok_and(|address: IpAddr| address.is_loopback());
    is_here || uri.scheme_str() != Some("https")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_proxy_is_for_https_to_other_machines() {
        for (base, expected) in [
            ("https://127.0.0.1:8317", true),
            ("https://127.9.0.1", true),
            ("https://[::1]:80", true),
            ("https://LocalHost:8317/ltc", true),
            ("http://10.0.0.1:8317", true),
            ("HTTP://tables.example", true),
            ("https://10.0.0.1:8317", false),
            ("HTTPS://tables.example", false),
            ("https://127.0.0.1.example", false),
        ] {
            assert_eq!(is_direct(&base.parse().expect("a URL")), expected, "{base}");
        }
    }

    #[test]
    fn a_port_is_a_number_of_16_bits() {
        for host in ["127.0.0.1", "[::1]", "h"] {
            for port in ["0", "65536", "99999", "4294967376", "18446744073709551696"] {
                let refused = parse_base(&format!("http://{host}:{port}/ltc")).expect_err(port);
                assert!(
                    refused.to_string().ends_with(&format!(":{port}/ltc: the port must be a number from 1 to 65535")),
                    "{refused}"
                );
            }
            for port in ["", ":1", ":80", ":65535"] {
                parse_base(&format!("http://{host}{port}/ltc")).unwrap_or_else(|error| panic!("{error}"));
            }
        }
    }

    #[test]
    fn a_user_is_refused_and_no_error_shows_the_password() {
        for url in [
            "http://user:secret@h",
            "https://secret@h/ltc",
            "http://user:secret@h:99999",
            "http://user:secret@",
            "http://user:secret/@h",
            "http://user:secret @h",
            "http://user:secret\n@h",
            "http://user:secret@h/?a=b",
            "ftp://user:secret@h",
        ] {
            let refused = parse_base(url).expect_err(url);
            assert!(!format!("{refused} {refused:?}").contains("secret"), "{refused:?}");
            let refused = url.parse::<crate::Source>().expect_err(url);
            assert!(!format!("{refused} {refused:?}").contains("secret"), "{refused:?}");
        }
    }

    #[test]
    fn anything_but_a_url_is_refused() {
        for base in ["", "localhost:8317", "ftp://host", "http://", "http://host/?a=b"] {
            let refused = parse_base(base).expect_err(base).to_string();
            assert!(refused.contains("this is not the URL of a server"), "{refused}");
        }
    }
}
