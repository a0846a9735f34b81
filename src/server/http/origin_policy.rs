//! The names that the service answers to, and the web pages whose requests it serves.
//!
//! A browser lets any page send requests to any address. Two fields of a request say where it comes from. `Host` is the
//! name that the page was told to ask for: an attacker's domain may resolve to this machine, and its pages then count
//! as the service's own (DNS rebinding). `Origin` is the site of the page that sends the request.

use std::{fmt, net::IpAddr, str::FromStr};

use axum::{
    extract::Request,
    http::{HeaderMap, HeaderValue, Version, header, uri::Authority},
    response::{IntoResponse as _, Response},
};

use super::{connection::LocalAddress, kind::ProblemKind, problem::Problem};

/// Names and origins that the service serves beyond its own.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct OriginPolicy {
    /// Names by which clients may call the service.
    pub hosts: Vec<AllowedHost>,
    /// Origins of web pages that may send requests.
    pub origins: Vec<AllowedOrigin>,
}

/// A name or an address in lower case, an IPv6 address in brackets; with a port if it stands for that one only.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct AllowedHost {
    name: String,
    port: Option<u16>,
}

/// The origin of a web page: scheme, host, and port if it is not the usual one.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct AllowedOrigin(String);

impl FromStr for AllowedHost {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        host(text).ok_or_else(|| {
            let form = "a host is a name or an address, such as farm.example or farm.example:8317";
            format!("«{text}» is not a host: {form}")
        })
    }
}

impl FromStr for AllowedOrigin {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let is_origin = text.split_once("://").is_some_and(|(scheme, authority)| {
            !scheme.is_empty() && scheme.bytes().all(|byte| byte.is_ascii_alphanumeric()) && host(authority).is_some()
        });
        is_origin.then(|| Self(text.to_ascii_lowercase())).ok_or_else(|| {
            let form = "an origin is a scheme and a host without a path, such as https://farm.example";
            format!("«{text}» is not an origin: {form}")
        })
    }
}

impl fmt::Display for AllowedHost {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.name)?;
        self.port.map_or(Ok(()), |port| write!(f, ":{port}"))
    }
}

/// Host and port of an authority. An authority may also have a user and a port that is not a number; a host has
/// neither.
fn host(text: &str) -> Option<AllowedHost> {
    let authority: Authority = text.parse().ok()?;
    let host = AllowedHost { name: authority.host().to_ascii_lowercase(), port: authority.port_u16() };
    (!host.name.is_empty() && host.to_string().eq_ignore_ascii_case(text)).then_some(host)
}

impl OriginPolicy {
    /// Whether a request is for this service, and not sent by a page of another site.
    ///
    /// # Errors
    /// The problem to answer with: 400, 421 or 403.
    fn check(&self, request: &Request) -> Result<(), Problem> {
        let local = request.extensions().get::<LocalAddress>().copied();
        let host = requested_host(request)?;
        if let Some(host) = &host {
            self.check_host(host, local)?;
        }
        let mut origins = request.headers().get_all(header::ORIGIN).iter();
        let Some(origin) = origins.next() else {
            return self.check_embedding(request.headers());
        };
        if origins.next().is_some() {
            return Err(Problem::new(ProblemKind::BadRequest, "the request has more than one Origin field"));
        }
        let origin = String::from_utf8_lossy(origin.as_bytes()).to_ascii_lowercase();
        // A page that the service has served itself, or a proxy in front of it.
        let own = host.is_some_and(|host| [format!("http://{host}"), format!("https://{host}")].contains(&origin));
        if own || self.origins.iter().any(|allowed| allowed.0 == origin) {
            return Ok(());
        }
        let detail = format!(
            "pages of «{origin}» may not send requests to this service; \
             `ltcforge serve --allow-origin` allows an origin"
        );
        Err(Problem::new(ProblemKind::ForeignOrigin, detail))
    }

    /// Refuses requests by which a page of another site embeds an image or the like: browsers send no origin with them,
    /// but these fields. Links are served, and a page of an allowed origin may embed.
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
        let detail = "pages of another site may link to this service, but not embed what it makes; \
                      `ltcforge serve --allow-origin` allows an origin";
        Err(Problem::new(ProblemKind::ForeignOrigin, detail))
    }

    /// Whether pages of any other origin may send requests.
    pub(super) fn allows_any(&self) -> bool {
        !self.origins.is_empty()
    }

    /// Whether pages of this origin may send requests although the service has not served them.
    pub(super) fn allows(&self, origin: &HeaderValue) -> bool {
        self.origins.iter().any(|allowed| allowed.0.as_bytes().eq_ignore_ascii_case(origin.as_bytes()))
    }

    fn check_host(&self, host: &AllowedHost, local: Option<LocalAddress>) -> Result<(), Problem> {
        let is_own = local.is_some_and(|local| is_own(host, local));
        let is_allowed = |allowed: &AllowedHost| {
            allowed.name == host.name && allowed.port.is_none_or(|port| host.port.unwrap_or(80) == port)
        };
        if is_own || self.hosts.iter().any(is_allowed) {
            return Ok(());
        }
        let detail =
            format!("«{host}» is not a name of this service; `ltcforge serve --allow-host {}` adds it", host.name);
        Err(Problem::new(ProblemKind::WrongHost, detail))
    }
}

/// Whether a host is the address at which the request arrived. On a loopback address, all loopback addresses and
/// `localhost` are the same.
fn is_own(host: &AllowedHost, LocalAddress(local): LocalAddress) -> bool {
    let ip = local.ip().to_canonical();
    let literal = host.name.trim_start_matches('[').trim_end_matches(']').parse::<IpAddr>();
    let is_same = match literal {
        Ok(literal) => literal.to_canonical() == ip || (literal.is_loopback() && ip.is_loopback()),
        Err(_) => host.name == "localhost" && ip.is_loopback(),
    };
    is_same && host.port.unwrap_or(80) == local.port()
}

/// The host that a request is for: that of an absolute URI, which clients send to a proxy, or else the field `Host`.
/// `None` if it has neither, which only HTTP/1.0 allows.
fn requested_host(request: &Request) -> Result<Option<AllowedHost>, Problem> {
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

/// Refuses requests by [`OriginPolicy::check`].
pub(super) async fn check<Answering: Future<Output = Response>>(
    policy: &OriginPolicy,
    request: Request,
    next: impl FnOnce(Request) -> Answering,
) -> Response {
    match policy.check(&request) {
        Ok(()) => next(request).await,
        Err(problem) => problem.into_response(),
    }
}

#[cfg(test)]
mod tests {
    use axum::body::Body;

    use super::*;

    /// The status with which a request is refused, `None` if it is served.
    fn refused(local: &str, uri: &str, fields: &[(&str, &str)]) -> Option<u16> {
        let policy = OriginPolicy {
            hosts: vec!["farm".parse().expect("a host"), "[2001:db8::1]:80".parse().expect("a host")],
            origins: vec!["https://wiki.example".parse().expect("an origin")],
        };
        let mut request = Request::builder().uri(uri);
        for (name, value) in fields {
            request = request.header(*name, *value);
        }
        let mut request = request.body(Body::empty()).expect("a request");
        request.extensions_mut().insert(LocalAddress(local.parse().expect("an address")));
        policy.check(&request).err().map(|problem| problem.status().as_u16())
    }

    const LOOPBACK: &str = "127.0.0.1:8317";
    const LAN: &str = "10.0.0.5:8317";

    #[test]
    fn a_service_answers_to_its_own_address_and_to_allowed_names() {
        let cases = [
            (LOOPBACK, "127.0.0.1:8317", None),
            (LOOPBACK, "localhost:8317", None),
            (LOOPBACK, "LocalHost:8317", None),
            (LOOPBACK, "[::1]:8317", None),
            (LOOPBACK, "localhost", Some(421)),
            (LOOPBACK, "localhost:80", Some(421)),
            (LOOPBACK, "10.0.0.5:8317", Some(421)),
            (LOOPBACK, "attacker.example:8317", Some(421)),
            (LOOPBACK, "localhost.attacker.example:8317", Some(421)),
            ("127.0.0.1:80", "localhost", None),
            ("[::ffff:127.0.0.1]:8317", "localhost:8317", None),
            (LAN, "10.0.0.5:8317", None),
            (LAN, "10.0.0.6:8317", Some(421)),
            (LAN, "localhost:8317", Some(421)),
            (LAN, "attacker.example:8317", Some(421)),
            (LAN, "farm:8317", None),
            (LAN, "FARM", None),
            (LAN, "farm.example", Some(421)),
            (LAN, "[2001:db8::1]", None),
            (LAN, "[2001:db8::1]:8317", Some(421)),
            (LAN, "user@farm", Some(400)),
            (LAN, "farm:port", Some(400)),
            (LAN, "farm/x", Some(400)),
            (LAN, "", Some(400)),
        ];
        for (local, host, status) in cases {
            assert_eq!(refused(local, "/healthz", &[("host", host)]), status, "{host} at {local}");
        }
    }

    #[test]
    fn a_request_says_once_for_whom_it_is() {
        assert_eq!(refused(LOOPBACK, "/", &[]), Some(400));
        assert_eq!(refused(LOOPBACK, "/", &[("host", "localhost:8317"), ("host", "farm")]), Some(400));
        let own = [("host", "localhost:8317"), ("origin", "http://localhost:8317")];
        assert_eq!(refused(LOOPBACK, "/", &own), None);
        for second in ["http://attacker.example", "http://localhost:8317"] {
            assert_eq!(refused(LOOPBACK, "/", &[own[0], own[1], ("origin", second)]), Some(400), "{second}");
        }
        // The name in an absolute URI is the one that counts.
        let host = [("host", "localhost:8317")];
        assert_eq!(refused(LOOPBACK, "http://attacker.example/", &host), Some(421));
        assert_eq!(refused(LOOPBACK, "http://localhost:8317/", &host), None);
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
            assert_eq!(refused(LOOPBACK, "/v1/preview", &all), status, "{fields:?}");
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
            assert_eq!(refused(LOOPBACK, "/v1/jobs", &fields), status, "{origin}");
        }
    }

    #[test]
    fn settings_that_could_never_match_are_refused() {
        for host in ["", "http://farm", "farm/", "a b", "user@farm", "farm:port", "farm:"] {
            assert!(host.parse::<AllowedHost>().is_err(), "{host}");
        }
        for origin in ["", "farm", "https://", "https://farm/", "null", "*", "https://a@farm"] {
            assert!(origin.parse::<AllowedOrigin>().is_err(), "{origin}");
        }
    }
}
