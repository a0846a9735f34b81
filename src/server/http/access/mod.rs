//! Who may call: tokens and what they allow, and the door that asks for one.
//!
//! Invariant: where there are tokens, no request but those of [`is_open`] passes without one, wherever it comes from: a proxy
//! on this machine brings the requests of others.

mod rates;
mod standing;
mod tokens;
mod watched;

use std::{net::IpAddr, sync::Arc};

use axum::{
    extract::Request,
    http::{HeaderMap, HeaderValue, Method, header},
    response::{IntoResponse as _, Response},
};

use self::rates::Asking;
pub(super) use self::{rates::Rates, tokens::without_tokens};
pub use self::{
    standing::Standing,
    tokens::{KeptToken, Scope, TOKEN_BYTES, Tokens},
    watched::{TokenFileError, WatchedTokens},
};
use super::{connection::RemoteAddress, kind::ProblemKind, problem::Problem};
use crate::queue::Submitter;

/// Whether a path tells nothing but whether the service works, for probes, or is a file of the page, which is part of the
/// program: browsers send no token with a link or a script.
fn is_open(path: &str) -> bool {
    ["/healthz", "/readyz", "/"].contains(&path) || path.starts_with("/page/")
}

/// Whom the token names that a request came with.
#[derive(Debug, Clone)]
pub(super) struct Caller(pub(super) Arc<Submitter>);

/// Whether a path is that of pins: of one of a table, or of those of a lock file.
fn is_of_pins(path: &str) -> bool {
    path.starts_with("/v1/pins/") || path.strip_prefix("/v1/tables/").is_some_and(|rest| rest.contains("/pins/"))
}

/// What a call needs. A method that is in neither list changes what others may use.
fn needed(method: &Method, path: &str) -> Scope {
    match *method {
        Method::GET | Method::HEAD => Scope::Read,
        // What these answer is computed of the body, and nothing is kept.
        Method::POST if ["/v1/recipes", "/v1/plans"].contains(&path) => Scope::Read,
        Method::POST => Scope::Submit,
        Method::DELETE if path.starts_with("/v1/jobs/") => Scope::Submit,
        Method::PUT | Method::DELETE if is_of_pins(path) => Scope::Submit,
        _ => Scope::Admin,
    }
}

/// The secret of `Authorization: Bearer SECRET`, if there is one such field.
fn secret(headers: &HeaderMap) -> Option<&[u8]> {
    let mut fields = headers.get_all(header::AUTHORIZATION).iter();
    let field = fields.next().filter(|_| fields.next().is_none())?.as_bytes();
    let (scheme, secret) = field.split_at_checked(7)?;
    scheme.eq_ignore_ascii_case(b"bearer ").then(|| secret.trim_ascii())
}

/// The caller that a request's token names.
///
/// # Errors
/// The problem to answer with: 401 or 403.
fn admit(tokens: &Tokens, method: &Method, path: &str, headers: &HeaderMap) -> Result<Option<Caller>, Problem> {
    if tokens.is_empty() || is_open(path) {
        return Ok(None);
    }
    let Some((by, scope)) = secret(headers).and_then(|secret| tokens.find(secret)) else {
        let given = if headers.contains_key(header::AUTHORIZATION) {
            "is not one that the service knows"
        } else {
            "is missing"
        };
        let detail =
            format!("the token {given}; send `Authorization: Bearer TOKEN`, and ask who runs the service for one");
        return Err(Problem::new(ProblemKind::NoToken, detail));
    };
    let needed = needed(method, path);
    if scope < needed {
        let (name, scope, needed) = (&by.name, scope.name(), needed.name());
        let detail = format!("the token «{name}» has the scope {scope}; this call needs {needed}");
        return Err(Problem::new(ProblemKind::OutOfScope, detail));
    }
    Ok(Some(Caller(Arc::clone(by))))
}

/// Who may call, and how often.
#[derive(Debug)]
pub(super) struct Access {
    pub(super) tokens: Arc<WatchedTokens>,
    /// `None` where requests are not counted.
    pub(super) rates: Option<Rates>,
}

impl Access {
    /// Counts a request for its caller, or for its address if it has no token that is known.
    fn count(&self, admitted: &Result<Option<Caller>, Problem>, request: &Request) -> Result<(), Problem> {
        let Some(rates) = self.rates.as_ref().filter(|_| !is_open(request.uri().path())) else { return Ok(()) };
        let asking = match admitted {
            Ok(Some(Caller(by))) => Asking::Token(Arc::clone(by)),
            _ => Asking::Address(address(request)),
        };
        rates.count(&asking)
    }
}

/// Where a request comes from; without a connection, as in tests, from nowhere.
fn address(request: &Request) -> IpAddr {
    let remote = request.extensions().get::<RemoteAddress>();
    remote.map_or(IpAddr::V4(std::net::Ipv4Addr::UNSPECIFIED), |RemoteAddress(address)| *address)
}

/// Refuses requests by [`admit`] and those that come too often, and keeps answers for one caller out of caches for
/// all.
pub(super) async fn check<Answering: Future<Output = Response>>(
    access: &Access,
    mut request: Request,
    next: impl FnOnce(Request) -> Answering,
) -> Response {
    let current = access.tokens.current();
    let admitted = admit(&current, request.method(), request.uri().path(), request.headers());
    let admitted = access.count(&admitted, &request).and(admitted);
    let mut response = match admitted {
        Ok(caller) => {
            if let Some(caller) = caller {
                request.extensions_mut().insert(caller);
            }
            next(request).await
        }
        Err(problem) => {
            let mut response = problem.into_response();
            if response.status() == 401 {
                let scheme = HeaderValue::from_static("Bearer realm=\"ltcforge\"");
                response.headers_mut().insert(header::WWW_AUTHENTICATE, scheme);
            }
            response
        }
    };
    if !current.is_empty()
        && let Some(field) = response.headers_mut().get_mut(header::CACHE_CONTROL)
        && let Some(rest) = field.to_str().ok().and_then(|text| text.strip_prefix("public"))
        && let Ok(private) = format!("private{rest}").parse()
    {
        *field = private;
    }
    response
}

#[cfg(test)]
mod tests {
    use super::*;

    fn status(tokens: &Tokens, call: (&Method, &str), authorization: &[&str]) -> Option<u16> {
        let mut headers = HeaderMap::new();
        for field in authorization {
            headers.append(header::AUTHORIZATION, field.parse().expect("a field value"));
        }
        admit(tokens, call.0, call.1, &headers).err().map(|problem| problem.status().as_u16())
    }

    #[test]
    fn each_call_needs_its_scope() {
        let made = Scope::ALL.map(|scope| {
            KeptToken::new(scope.name(), scope, Standing::default(), &[scope as u8; TOKEN_BYTES]).expect("a name")
        });
        let [(read, _), (submit, _), (admin, _)] = &made;
        let tokens = Tokens::of(&[("", &made.clone().map(|(_, kept)| kept.to_string()).join("\n"))]).expect("tokens");
        let id = "/v1/jobs/17ef825cea151d3d007a00aaeea2fd86";
        let calls = [
            ((&Method::GET, "/v1/jobs"), [Some(401), None, None, None]),
            ((&Method::HEAD, "/v1/tables/x"), [Some(401), None, None, None]),
            ((&Method::GET, "/metrics"), [Some(401), None, None, None]),
            ((&Method::POST, "/v1/jobs"), [Some(401), Some(403), None, None]),
            ((&Method::POST, "/v1/brdfs"), [Some(401), Some(403), None, None]),
            ((&Method::DELETE, id), [Some(401), Some(403), None, None]),
            ((&Method::DELETE, "/v1/brdfs/x"), [Some(401), Some(403), Some(403), None]),
            ((&Method::PUT, "/v1/jobs"), [Some(401), Some(403), Some(403), None]),
            ((&Method::DELETE, "/v1/tables/x"), [Some(401), Some(403), Some(403), None]),
            ((&Method::PUT, "/v1/tables/x/pins/y"), [Some(401), Some(403), None, None]),
            ((&Method::DELETE, "/v1/tables/x/pins/y"), [Some(401), Some(403), None, None]),
            ((&Method::GET, "/v1/tables/x/pins"), [Some(401), None, None, None]),
            ((&Method::PUT, "/v1/pins/y"), [Some(401), Some(403), None, None]),
            ((&Method::GET, "/healthz"), [None; 4]),
            ((&Method::GET, "/readyz"), [None; 4]),
            ((&Method::GET, "/healthz/x"), [Some(401), None, None, None]),
            ((&Method::POST, "/v1/recipes"), [Some(401), None, None, None]),
            ((&Method::POST, "/v1/plans"), [Some(401), None, None, None]),
            ((&Method::POST, "/v1/plans/x"), [Some(401), Some(403), None, None]),
            ((&Method::GET, "/"), [None; 4]),
            ((&Method::GET, "/page/main.js"), [None; 4]),
            ((&Method::GET, "/page"), [Some(401), None, None, None]),
            ((&Method::GET, "//"), [Some(401), None, None, None]),
        ];
        for (call, statuses) in calls {
            let bearer = [read, submit, admin].map(|secret| format!("Bearer {secret}"));
            let with = [&[][..], &[bearer[0].as_str()], &[bearer[1].as_str()], &[bearer[2].as_str()]];
            assert_eq!(with.map(|fields| status(&tokens, call, fields)), statuses, "{call:?}");
            assert_eq!(status(&Tokens::default(), call, &[]), None, "without tokens anyone may");
        }
        let call = (&Method::GET, "/v1/jobs");
        assert_eq!(status(&tokens, call, &[&format!("bearer  {read}")]), None, "the scheme has no case");
        for refused in [format!("Basic {read}"), read.clone(), format!("Bearer {read}x"), "Bearer ".to_owned()] {
            assert_eq!(status(&tokens, call, &[&refused]), Some(401), "{refused}");
        }
        let twice = format!("Bearer {read}");
        assert_eq!(status(&tokens, call, &[&twice, &twice]), Some(401), "two fields name nobody");
    }
}
