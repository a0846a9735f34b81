//! A name for each request: in its answer, and in every line that the log has of it.

use std::{
    collections::hash_map::RandomState,
    hash::{BuildHasher as _, Hasher as _},
    sync::{
        LazyLock,
        atomic::{AtomicU64, Ordering},
    },
};

use axum::{
    extract::Request,
    http::{HeaderMap, HeaderName, HeaderValue},
    middleware::Next,
    response::Response,
};
use tower_http::trace::MakeSpan;
use tracing::Span;

use super::access::without_tokens;

/// The field of requests and answers.
pub(super) const FIELD: HeaderName = HeaderName::from_static("x-request-id");

/// The longest name that a client, or the proxy before it, may have given.
const LONGEST: usize = 64;

/// Names of this process begin with it, so that those of two are not alike.
static PROCESS: LazyLock<u64> = LazyLock::new(|| RandomState::new().build_hasher().finish());

/// Requests that were named here.
static NAMED: AtomicU64 = AtomicU64::new(0);

/// The name that a request came with, if it is short and of letters, digits and `-_.`: it goes into the log as it is.
fn given(headers: &HeaderMap) -> Option<HeaderValue> {
    let mut fields = headers.get_all(FIELD).iter();
    let name = fields.next().filter(|_| fields.next().is_none())?;
    let is_plain = |byte: &u8| byte.is_ascii_alphanumeric() || b"-_.".contains(byte);
    (1..=LONGEST).contains(&name.len()).then_some(name).filter(|name| name.as_bytes().iter().all(is_plain)).cloned()
}

/// A name that no other request has.
fn new() -> HeaderValue {
    let name = format!("{:016x}-{:x}", *PROCESS, NAMED.fetch_add(1, Ordering::Relaxed));
    // Digits and a hyphen are always a field's value.
    HeaderValue::from_str(&name).unwrap_or(HeaderValue::from_static("-"))
}

/// The layer that names a request and its answer. It is outside of the one that logs.
pub(super) async fn name(mut request: Request, next: Next) -> Response {
    let name = given(request.headers()).unwrap_or_else(new);
    request.headers_mut().insert(FIELD, name.clone());
    let mut response = next.run(request).await;
    response.headers_mut().insert(FIELD, name);
    response
}

/// What the log has of a request in each of its lines.
#[derive(Debug, Clone, Copy)]
pub(super) struct NamedSpan;

impl<B> MakeSpan<B> for NamedSpan {
    fn make_span(&mut self, request: &axum::http::Request<B>) -> Span {
        let name = request.headers().get(FIELD).and_then(|name| name.to_str().ok()).unwrap_or_default();
        // A client may have put its token into any of them by a slip.
        let [id, method, uri] = [name, request.method().as_str(), &request.uri().to_string()].map(without_tokens);
        tracing::info_span!("request", id, method, uri)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_is_kept_if_it_is_short_and_plain() {
        let with = |names: &[&str]| {
            let mut headers = HeaderMap::new();
            for name in names {
                headers.append(FIELD, name.parse().expect("a field value"));
            }
            given(&headers).map(|name| name.to_str().expect("ASCII").to_owned())
        };
        assert_eq!(with(&["a-1_b.c"]).as_deref(), Some("a-1_b.c"));
        assert!(with(&[&"a".repeat(64)]).is_some());
        for refused in [&[][..], &[""], &["a b"], &["a", "a"], &["a\"b"], &["a;b"], &[&"a".repeat(65)]] {
            assert_eq!(with(refused), None, "{refused:?}");
        }
        assert_ne!(new(), new());
    }
}
