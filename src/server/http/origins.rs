//! The host names that the service answers to, and the web pages whose requests it accepts.
//!
//! Browsers let any page send requests to any address. `Host` is the host name in the request's address. Attackers can
//! make their own host name resolve to this machine, so that their pages look like pages of the service (DNS
//! rebinding). `Origin` is the site of the page that sends the request. `Host` may always be `localhost` or an IP
//! address, because rebinding needs a host name of the attacker.

use std::{net::IpAddr, str::FromStr};

use axum::{
    extract::Request,
    http::{HeaderMap, HeaderValue, Version, header, uri::Authority},
};

use super::{kind::ProblemKind, problem::Problem};

/// Host names and origins that are allowed in addition to the service's own.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Origins {
    /// Host names that clients may use for the service.
    pub hosts: Vec<AllowedHost>,
    /// Origins of web pages that may send requests.
    pub origins: Vec<AllowedOrigin>,
}

/// A host name in lower case, with a port if only this port is allowed.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct AllowedHost(String);

/// The origin of a web page in lower case: scheme, host, and port unless it is the default.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct AllowedOrigin(String);

impl FromStr for AllowedHost {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let wrong = || format!("«{text}» is not a host: write a name such as farm.example or farm.example:8317");
        host(text).map(|host| Self(host.to_string())).ok_or_else(wrong)
    }
}

impl FromStr for AllowedOrigin {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let is_origin = text.split_once("://").is_some_and(|(scheme, authority)| {
            !scheme.is_empty() && scheme.bytes().all(|byte| byte.is_ascii_alphanumeric()) && host(authority).is_some()
        });
        is_origin.then(|| Self(text.to_ascii_lowercase())).ok_or_else(|| {
            format!("«{text}» is not an origin: write scheme and host without a path, such as https://farm.example")
        })
    }
}

/// The authority of `text` in lower case, if it is a host with an optional port and nothing else.
fn host(text: &str) -> Option<Authority> {
    let authority: Authority = text.to_ascii_lowercase().parse().ok()?;
    let port = authority.port_u16().map(|port| format!(":{port}")).unwrap_or_default();
    let is_plain = !authority.host().is_empty() && format!("{}{port}", authority.host()) == authority.as_str();
    is_plain.then_some(authority)
}

impl Origins {
    /// Checks that a request is for this service, and not sent by a page of another site.
    ///
    /// # Errors
    /// A problem with status 400, 421 or 403.
    pub(super) fn check(&self, request: &Request) -> Result<(), Problem> {
        let host = requested_host(request)?;
        if let Some(host) = &host {
            self.check_host(host)?;
        }
        let mut origins = request.headers().get_all(header::ORIGIN).iter();
        let Some(origin) = origins.next() else { return self.check_embedding(request.headers()) };
        if origins.next().is_some() {
            return Err(Problem::new(ProblemKind::BadRequest, "the request has more than one Origin field"));
        }
        let text = String::from_utf8_lossy(origin.as_bytes()).to_ascii_lowercase();
        // The page comes from the service itself, or from a proxy in front of it.
        let is_own = host.is_some_and(|host| [format!("http://{host}"), format!("https://{host}")].contains(&text));
        if is_own || self.allows(origin) {
            return Ok(());
        }
        let detail = format!(
            "pages of «{text}» may not send requests to this service; `ltcforge serve --allow-origin ORIGIN` allows them"
        );
        Err(Problem::new(ProblemKind::ForeignOrigin, detail))
    }

    /// Rejects requests that embed an image or another file in a page of another site. Browsers send
    /// `Sec-Fetch-*` fields with these requests, but no `Origin`. Any page may link to the service. Pages of allowed
    /// origins may also embed its responses.
    fn check_embedding(&self, headers: &HeaderMap) -> Result<(), Problem> {
        let says = |name: &str, value: &str| headers.get(name).is_some_and(|field| field == value);
        let page = headers.get(header::REFERER).and_then(|field| field.to_str().ok()).unwrap_or_default();
        let page = page.to_ascii_lowercase();
        let is_of = |allowed: &AllowedOrigin| {
            page.strip_prefix(&allowed.0).is_some_and(|rest| rest.is_empty() || rest.starts_with('/'))
        };
        let is_embedded = says("sec-fetch-site", "cross-site") && !says("sec-fetch-mode", "navigate");
        if !is_embedded || self.origins.iter().any(is_of) {
            return Ok(());
        }
        let detail = "pages of other sites may link to this service, but not embed its responses; \
                      `ltcforge serve --allow-origin ORIGIN` allows them";
        Err(Problem::new(ProblemKind::ForeignOrigin, detail))
    }

    /// Whether pages of at least one other origin may send requests.
    pub(super) fn allows_any(&self) -> bool {
        !self.origins.is_empty()
    }

    /// Whether pages of this other origin may send requests.
    pub(super) fn allows(&self, origin: &HeaderValue) -> bool {
        self.origins.iter().any(|allowed| allowed.0.as_bytes().eq_ignore_ascii_case(origin.as_bytes()))
    }

    fn check_host(&self, host: &Authority) -> Result<(), Problem> {
        let name = host.host();
        let is_address = name.trim_start_matches('[').trim_end_matches(']').parse::<IpAddr>().is_ok();
        let is_allowed = |allowed: &AllowedHost| allowed.0 == name || allowed.0 == host.as_str();
        if is_address || name == "localhost" || self.hosts.iter().any(is_allowed) {
            return Ok(());
        }
        let detail = format!("«{host}» is not a name of this service; `ltcforge serve --allow-host {name}` allows it");
        Err(Problem::new(ProblemKind::WrongHost, detail))
    }
}

/// The host of a request. It comes from the absolute URI that clients send to a proxy, otherwise from the field `Host`.
/// It is `None` if the request has neither, which only HTTP/1.0 allows.
fn requested_host(request: &Request) -> Result<Option<Authority>, Problem> {
    let refuse = |detail: &str| Err(Problem::new(ProblemKind::BadRequest, detail));
    let mut fields = request.headers().get_all(header::HOST).iter();
    let field = fields.next();
    if fields.next().is_some() {
        return refuse("the request has more than one Host field");
    }
    let text = match (request.uri().authority(), field) {
        (Some(authority), _) => authority.as_str(),
        (None, Some(field)) => field.to_str().unwrap_or_default(),
        (None, None) if request.version() == Version::HTTP_10 => return Ok(None),
        (None, None) => return refuse("the request has no Host field"),
    };
    host(text).map_or_else(|| refuse(&format!("«{text}» is not a host with an optional port")), |host| Ok(Some(host)))
}

#[cfg(test)]
mod tests {
    use axum::body::Body;

    use super::*;

    /// The status of a rejected request; `None` if it is accepted.
    fn refused(uri: &str, fields: &[(&str, &str)]) -> Option<u16> {
        let policy = Origins {
            hosts: ["farm", "wiki.example:8317"].map(|host| host.parse().expect("a host")).into(),
            origins: vec!["https://wiki.example".parse().expect("an origin")],
        };
        let mut request = Request::builder().uri(uri);
        for (name, value) in fields {
            request = request.header(*name, *value);
        }
        let request = request.body(Body::empty()).expect("a request");
        policy.check(&request).err().map(|problem| problem.status().as_u16())
    }

    #[test]
    fn a_service_answers_to_addresses_and_to_allowed_names() {
        let cases = [
            ("127.0.0.1:8317", None),
            ("10.0.0.5", None),
            ("[::1]:8317", None),
            ("localhost:8317", None),
            ("LocalHost", None),
            ("attacker.example:8317", Some(421)),
            ("localhost.attacker.example:8317", Some(421)),
            ("127.0.0.1.attacker.example", Some(421)),
            ("farm:8317", None),
            ("FARM", None),
            ("farm.example", Some(421)),
            ("wiki.example:8317", None),
            ("wiki.example", Some(421)),
            ("user@farm", Some(400)),
            ("farm:port", Some(400)),
            ("farm/x", Some(400)),
            ("", Some(400)),
        ];
        for (host, status) in cases {
            assert_eq!(refused("/healthz", &[("host", host)]), status, "{host}");
        }
    }

    #[test]
    fn a_request_says_once_for_whom_it_is() {
        assert_eq!(refused("/", &[]), Some(400));
        assert_eq!(refused("/", &[("host", "localhost:8317"), ("host", "farm")]), Some(400));
        let own = [("host", "localhost:8317"), ("origin", "http://localhost:8317")];
        assert_eq!(refused("/", &own), None);
        for second in ["http://attacker.example", "http://localhost:8317"] {
            assert_eq!(refused("/", &[own[0], own[1], ("origin", second)]), Some(400), "{second}");
        }
        // The name in an absolute URI takes precedence.
        let host = [("host", "localhost:8317")];
        assert_eq!(refused("http://attacker.example/", &host), Some(421));
        assert_eq!(refused("http://localhost:8317/", &host), None);
    }

    #[test]
    fn pages_of_other_sites_may_link_here_but_embed_nothing() {
        let embeds = [("sec-fetch-site", "cross-site"), ("sec-fetch-mode", "no-cors")];
        let from = |page: &'static str| [embeds[0], embeds[1], ("referer", page)];
        let cases: [(&[(&str, &str)], _); 8] = [
            (&from("https://wiki.example/page"), None),
            (&from("https://wiki.example"), None),
            (&from("https://wiki.example.attacker.example/"), Some(403)),
            (&[], None),
            (&embeds, Some(403)),
            (&[("sec-fetch-site", "cross-site"), ("sec-fetch-mode", "navigate")], None),
            (&[("sec-fetch-site", "same-origin"), ("sec-fetch-mode", "no-cors")], None),
            (&[("sec-fetch-site", "cross-site"), ("origin", "https://wiki.example")], None),
        ];
        for (fields, status) in cases {
            let all: Vec<(&str, &str)> = [("host", "localhost:8317")].iter().chain(fields).copied().collect();
            assert_eq!(refused("/v1/preview", &all), status, "{fields:?}");
        }
    }

    #[test]
    fn only_own_and_allowed_pages_may_send_requests() {
        let cases = [
            ("http://localhost:8317", None),
            ("https://localhost:8317", None),
            ("https://wiki.example", None),
            ("HTTPS://Wiki.example", None),
            ("http://wiki.example", Some(403)),
            ("https://wiki.example.attacker.example", Some(403)),
            ("http://localhost:3000", Some(403)),
            ("http://127.0.0.1:8317", Some(403)),
            ("null", Some(403)),
            ("", Some(403)),
        ];
        for (origin, status) in cases {
            let fields = [("host", "localhost:8317"), ("origin", origin)];
            assert_eq!(refused("/v1/jobs", &fields), status, "{origin}");
        }
    }

    #[test]
    fn settings_that_could_never_match_are_refused() {
        for host in ["", "http://farm", "farm/", "a b", "user@farm", "farm:port", "farm:"] {
            assert!(host.parse::<AllowedHost>().is_err(), "{host}");
        }
        for origin in ["", "ltc", "https://", "https://ltc/", "null", "*", "https://a@ltc"] {
            assert!(origin.parse::<AllowedOrigin>().is_err(), "{origin}");
        }
    }
}
