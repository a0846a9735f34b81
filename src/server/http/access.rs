//! The scope that each call needs, and the token of a request.
//!
//! Invariant: if the service has tokens, every request needs one, except on paths of [`is_open`]. This includes
//! requests from this machine, because a proxy may have sent them.

use std::sync::Arc;

use axum::http::{HeaderMap, Method, header};

use super::{
    kind::ProblemKind,
    problem::Problem,
    tokens::{Scope, Token, Tokens},
};

/// Paths that need no token: probes, and the files of the page, because browsers send no token with links or scripts.
pub(super) fn is_open(path: &str) -> bool {
    ["/healthz", "/readyz", "/"].contains(&path) || path.starts_with("/page/")
}

/// The token of an accepted request. Handlers get it from the request's extensions.
#[derive(Debug, Clone)]
pub(super) struct Caller(pub(super) Arc<Token>);

/// The scope that a call needs. Calls that delete tables or BRDFs need `admin`, because other users may need the files.
fn needed(method: &Method, path: &str) -> Scope {
    match *method {
        Method::GET | Method::HEAD => Scope::Read,
        // The response depends only on the body, and nothing is stored.
        Method::POST if ["/v1/recipes", "/v1/plans"].contains(&path) => Scope::Read,
        Method::POST => Scope::Submit,
        Method::DELETE if path.starts_with("/v1/jobs/") => Scope::Submit,
        _ => Scope::Admin,
    }
}

/// The secret in `Authorization: Bearer SECRET`, if the request has exactly one `Authorization` field.
fn secret(headers: &HeaderMap) -> Option<&[u8]> {
    let mut fields = headers.get_all(header::AUTHORIZATION).iter();
    let field = fields.next().filter(|_| fields.next().is_none())?.as_bytes();
    let (scheme, secret) = field.split_at_checked(7)?;
    scheme.eq_ignore_ascii_case(b"bearer ").then(|| secret.trim_ascii())
}

/// Checks the token of a request. Returns the caller, or `None` if no token is needed.
///
/// # Errors
/// 401 if the token is missing or unknown, 403 if its scope does not allow the call.
pub(super) fn admit(
    tokens: &Tokens,
    method: &Method,
    path: &str,
    headers: &HeaderMap,
) -> Result<Option<Caller>, Problem> {
    if tokens.is_empty() || is_open(path) {
        return Ok(None);
    }
    let Some(token) = secret(headers).and_then(|secret| tokens.find(secret)) else {
        let given = if headers.contains_key(header::AUTHORIZATION) { "is unknown" } else { "is missing" };
        let detail = format!("the token {given}; send `Authorization: Bearer TOKEN`; ask the operator for a token");
        return Err(Problem::new(ProblemKind::NoToken, detail));
    };
    let needed = needed(method, path);
    if token.scope < needed {
        let (name, scope, needed) = (&token.name, token.scope.name(), needed.name());
        let detail = format!("the token «{name}» has the scope {scope}; this call needs {needed}");
        return Err(Problem::new(ProblemKind::OutOfScope, detail));
    }
    Ok(Some(Caller(Arc::clone(token))))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::http::tokens::TOKEN_BYTES;

    fn status(tokens: &Tokens, call: (&Method, &str), authorization: &[&str]) -> Option<u16> {
        let mut headers = HeaderMap::new();
        for field in authorization {
            headers.append(header::AUTHORIZATION, field.parse().expect("a field value"));
        }
        admit(tokens, call.0, call.1, &headers).err().map(|problem| problem.status().as_u16())
    }

    #[test]
    fn each_call_needs_its_scope() {
        let made =
            Scope::ALL.map(|scope| Token::new(scope.name(), scope, &[scope as u8; TOKEN_BYTES]).expect("a name"));
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
            assert_eq!(status(&Tokens::default(), call, &[]), None, "without tokens, anyone may call");
        }
        let call = (&Method::GET, "/v1/jobs");
        assert_eq!(status(&tokens, call, &[&format!("bearer  {read}")]), None, "the scheme is case-insensitive");
        for refused in [format!("Basic {read}"), read.clone(), format!("Bearer {read}x"), "Bearer ".to_owned()] {
            assert_eq!(status(&tokens, call, &[&refused]), Some(401), "{refused}");
        }
        let twice = format!("Bearer {read}");
        assert_eq!(status(&tokens, call, &[&twice, &twice]), Some(401), "two fields are rejected");
    }
}
