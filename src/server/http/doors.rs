//! A layer for every request. It assigns an id and a log span, rejects forbidden requests, and adds the fields that all
//! responses have.

use std::{
    collections::hash_map::RandomState,
    hash::{BuildHasher as _, Hasher as _},
    sync::{
        Arc, LazyLock,
        atomic::{AtomicU64, Ordering},
    },
    time::{Duration, Instant},
};

use axum::{
    extract::{Request, State},
    http::{HeaderMap, HeaderName, HeaderValue, Method, StatusCode, header},
    middleware::Next,
    response::{IntoResponse as _, Response},
};
use tokio::sync::Semaphore;
use tracing::Instrument as _;

use super::{
    access,
    etag::check_untagged,
    kind::ProblemKind,
    origins::Origins,
    problem::Problem,
    tokens::{TokenFile, without_tokens},
};

/// `Retry-After` if too many requests are being served.
const RETRY: Duration = Duration::from_secs(2);

/// Header fields of every response, unless the handler sets them. They forbid sniffing, scripts, frames and referrers.
const FIELDS: [(HeaderName, &str); 4] = [
    (header::X_CONTENT_TYPE_OPTIONS, "nosniff"),
    (header::CONTENT_SECURITY_POLICY, "default-src 'none'; frame-ancestors 'none'"),
    (header::REFERRER_POLICY, "no-referrer"),
    (header::X_FRAME_OPTIONS, "DENY"),
];

/// The response to a CORS preflight request of an allowed origin. Browsers may cache it for ten minutes.
const PREFLIGHT: [(HeaderName, &str); 3] = [
    (header::ACCESS_CONTROL_ALLOW_METHODS, "GET, HEAD, POST, DELETE"),
    (
        header::ACCESS_CONTROL_ALLOW_HEADERS,
        "Authorization, Content-Type, If-Match, If-None-Match, If-Range, Last-Event-ID, Range, X-Request-Id",
    ),
    (header::ACCESS_CONTROL_MAX_AGE, "600"),
];

/// Response fields that pages of allowed origins may read.
const READABLE: &str =
    "Accept-Ranges, Content-Digest, Content-Range, ETag, Location, Repr-Digest, Retry-After, X-Request-Id";

const REQUEST_ID: HeaderName = HeaderName::from_static("x-request-id");

/// Maximum length of a request id from a client or proxy.
const LONGEST_ID: usize = 64;

/// The checks that can reject a request.
#[derive(Debug)]
pub(super) struct Doors {
    pub(super) origins: Origins,
    pub(super) tokens: Arc<TokenFile>,
    pub(super) requests: Semaphore,
    /// Maximum number of concurrent requests.
    pub(super) limit: usize,
}

/// The layer. At the default log level it logs nothing. The log lines of a request contain its span.
pub(super) async fn pass(State(doors): State<Arc<Doors>>, request: Request, next: Next) -> Response {
    let id = given_id(request.headers()).unwrap_or_else(new_id);
    // A client may have put its token into the URI by mistake.
    let uri = without_tokens(&request.uri().to_string());
    let span = tracing::info_span!("request", id = without_tokens(&id), method = %request.method(), uri);
    let started = Instant::now();
    let origin = request.headers().get(header::ORIGIN).filter(|origin| doors.origins.allows(origin)).cloned();
    let is_preflight = request.method() == Method::OPTIONS
        && request.headers().contains_key(header::ACCESS_CONTROL_REQUEST_METHOD)
        && origin.is_some();
    let mut response = if is_preflight {
        (StatusCode::NO_CONTENT, PREFLIGHT).into_response()
    } else {
        doors.answer(request, next).instrument(span.clone()).await
    };
    span.in_scope(|| tracing::debug!(status = response.status().as_u16(), elapsed = ?started.elapsed(), "answered"));
    let fields = response.headers_mut();
    for (name, value) in FIELDS {
        fields.entry(name).or_insert(HeaderValue::from_static(value));
    }
    // All characters of an id are allowed in a header field.
    fields.insert(REQUEST_ID, HeaderValue::from_str(&id).unwrap_or(HeaderValue::from_static("-")));
    if doors.origins.allows_any() {
        fields.append(header::VARY, HeaderValue::from_static("Origin"));
    }
    if let Some(origin) = origin {
        fields.insert(header::ACCESS_CONTROL_ALLOW_ORIGIN, origin);
        fields.insert(header::ACCESS_CONTROL_EXPOSE_HEADERS, HeaderValue::from_static(READABLE));
    }
    response
}

impl Doors {
    async fn answer(&self, mut request: Request, next: Next) -> Response {
        let tokens = self.tokens.current();
        let (path, headers) = (request.uri().path(), request.headers());
        let checked = self.origins.check(&request).and_then(|()| {
            let caller = access::admit(&tokens, request.method(), path, headers)?;
            // Open paths respond from memory, so a probe succeeds even on a busy service.
            let place = if access::is_open(path) { None } else { Some(self.place()?) };
            Ok((caller, place))
        });
        let (caller, _place) = match checked {
            Ok(checked) => checked,
            Err(problem) => return problem.into_response(),
        };
        if let Some(caller) = caller {
            request.extensions_mut().insert(caller);
        }
        let untagged = check_untagged(request.headers());
        let mut response = next.run(request).await;
        // Preconditions only apply to successful requests [RFC 9110, section 13.2.1].
        if let Err(problem) = untagged
            && response.status().is_success()
            && !response.headers().contains_key(header::ETAG)
        {
            return problem.into_response();
        }
        // Shared caches must not store responses that need a token.
        if !tokens.is_empty()
            && let Some(field) = response.headers_mut().get_mut(header::CACHE_CONTROL)
            && let Some(rest) = field.to_str().ok().and_then(|text| text.strip_prefix("public"))
            && let Ok(private) = format!("private{rest}").parse()
        {
            *field = private;
        }
        response
    }

    /// A permit to serve one more request.
    fn place(&self) -> Result<tokio::sync::SemaphorePermit<'_>, Problem> {
        self.requests.try_acquire().map_err(|_| {
            let limit = self.limit;
            let detail = format!("{limit} requests are being served, which is the limit; `--requests` raises it");
            Problem::new(ProblemKind::Busy, detail).with_retry_after(RETRY)
        })
    }
}

/// The id in `X-Request-Id`, if there is exactly one such field, and the id is short and has only letters, digits
/// and `-_.`.
fn given_id(headers: &HeaderMap) -> Option<String> {
    let mut fields = headers.get_all(REQUEST_ID).iter();
    let id = fields.next().filter(|_| fields.next().is_none())?.to_str().ok()?;
    let is_plain = |byte: u8| byte.is_ascii_alphanumeric() || b"-_.".contains(&byte);
    ((1..=LONGEST_ID).contains(&id.len()) && id.bytes().all(is_plain)).then(|| id.to_owned())
}

/// A unique id: a random number of this process, and a counter.
fn new_id() -> String {
    static PROCESS: LazyLock<u64> = LazyLock::new(|| RandomState::new().build_hasher().finish());
    static COUNT: AtomicU64 = AtomicU64::new(0);
    format!("{:016x}-{:x}", *PROCESS, COUNT.fetch_add(1, Ordering::Relaxed))
}

#[cfg(test)]
mod tests {
    use axum::{Router, body::Body, middleware::from_fn_with_state, routing::get};
    use hyper::service::Service as _;
    use hyper_util::service::TowerToHyperService;

    use super::*;

    async fn answer(requests: usize, path: &str, method: &Method, fields: &[(HeaderName, &str)]) -> Response {
        let origins = Origins { hosts: vec![], origins: vec!["https://wiki.example".parse().expect("an origin")] };
        let doors = Doors { origins, tokens: Arc::default(), requests: Semaphore::new(requests), limit: requests };
        let app = Router::new().route(path, get(|| async {})).layer(from_fn_with_state(Arc::new(doors), pass));
        let mut request = Request::builder().method(method).uri(path).header(header::HOST, "localhost");
        for (name, value) in fields {
            request = request.header(name, *value);
        }
        let request = request.body(Body::empty()).expect("a request");
        TowerToHyperService::new(app).call(request).await.expect("an answer")
    }

    #[tokio::test]
    async fn only_allowed_origins_get_fields_of_cors() {
        let asks = (header::ACCESS_CONTROL_REQUEST_METHOD, "DELETE");
        for (origin, is_allowed) in [("https://wiki.example", true), ("https://other.example", false)] {
            let origin_field = (header::ORIGIN, origin);
            let read = answer(1, "/x", &Method::GET, std::slice::from_ref(&origin_field)).await;
            let allowed = read.headers().get(header::ACCESS_CONTROL_ALLOW_ORIGIN);
            assert_eq!(allowed.is_some_and(|allowed| allowed == origin), is_allowed, "{origin}");
            assert_eq!(read.status(), if is_allowed { 200 } else { 403 }, "{origin}");
            assert_eq!(read.headers()[header::VARY], "Origin");
            assert_eq!(read.headers()[header::X_CONTENT_TYPE_OPTIONS], "nosniff");
            let preflight = answer(1, "/x", &Method::OPTIONS, &[origin_field, asks.clone()]).await;
            assert_eq!(preflight.status(), if is_allowed { 204 } else { 403 }, "{origin}");
            let methods = preflight.headers().contains_key(header::ACCESS_CONTROL_ALLOW_METHODS);
            assert_eq!(methods, is_allowed, "{origin}");
        }
        let plain = answer(1, "/x", &Method::OPTIONS, &[asks]).await;
        assert_eq!(plain.status(), 405, "without an origin, OPTIONS is an ordinary method");
    }

    #[tokio::test]
    async fn a_busy_service_answers_probes_and_tells_others_when_to_come_back() {
        let busy = answer(0, "/v1/jobs", &Method::GET, &[]).await;
        assert_eq!((busy.status().as_u16(), &busy.headers()[header::RETRY_AFTER]), (503, &HeaderValue::from(2)));
        assert_eq!(answer(0, "/healthz", &Method::GET, &[]).await.status(), 200);
    }

    #[tokio::test]
    async fn a_precondition_fails_on_an_answer_without_a_tag() {
        let tagged = answer(1, "/x", &Method::GET, &[(header::IF_MATCH, "\"x\"")]).await;
        assert_eq!(tagged.status(), 412);
        assert_eq!(answer(1, "/x", &Method::GET, &[(header::IF_MATCH, "*")]).await.status(), 200);
    }

    #[test]
    fn an_id_is_kept_if_it_is_short_and_plain() {
        let with = |ids: &[&str]| {
            let mut headers = HeaderMap::new();
            for id in ids {
                headers.append(REQUEST_ID, id.parse().expect("a field value"));
            }
            given_id(&headers)
        };
        assert_eq!(with(&["a-1_b.c"]).as_deref(), Some("a-1_b.c"));
        assert!(with(&[&"a".repeat(64)]).is_some());
        for refused in [&[][..], &[""], &["a b"], &["a", "a"], &["a\"b"], &["a;b"], &[&"a".repeat(65)]] {
            assert_eq!(with(refused), None, "{refused:?}");
        }
        assert_ne!(new_id(), new_id());
    }
}
