//! Fields of every answer that tell browsers what it must not become, and to whose pages it may be shown.

use axum::{
    extract::Request,
    http::{HeaderName, HeaderValue, Method, StatusCode, header},
    response::{IntoResponse as _, Response},
};

use super::origin_policy::OriginPolicy;

/// What an answer has unless its handler says otherwise: it is of its stated type, no document that runs or frames
/// anything, and tells no other site where a link was.
const FIELDS: [(HeaderName, &str); 4] = [
    (header::X_CONTENT_TYPE_OPTIONS, "nosniff"),
    (header::CONTENT_SECURITY_POLICY, "default-src 'none'; frame-ancestors 'none'"),
    (header::REFERRER_POLICY, "no-referrer"),
    (header::X_FRAME_OPTIONS, "DENY"),
];

/// Methods and fields that pages of allowed origins may send, and the fields of answers that they may read.
const METHODS: &str = "GET, HEAD, POST, PUT, DELETE";
const SENT: &str = "Authorization, Content-Type, If-Match, If-None-Match, If-Range, Last-Event-ID, Range, X-Request-Id";
const READ: &str =
    "Accept-Ranges, Content-Digest, Content-Range, ETag, Location, Repr-Digest, Retry-After, X-Request-Id";

/// How long a browser may remember that it may ask, in seconds.
const REMEMBERED: &str = "600";

/// Adds the fields, and those of CORS for origins that the service was told to allow.
pub(super) async fn add<Answering: Future<Output = Response>>(
    policy: &OriginPolicy,
    request: Request,
    next: impl FnOnce(Request) -> Answering,
) -> Response {
    let origin = request.headers().get(header::ORIGIN).filter(|origin| policy.allows(origin)).cloned();
    // A browser asks before it sends what a form cannot, without the token.
    let asks = request.method() == Method::OPTIONS
        && request.headers().contains_key(header::ACCESS_CONTROL_REQUEST_METHOD)
        && origin.is_some();
    let mut response = if asks {
        let fields = [
            (header::ACCESS_CONTROL_ALLOW_METHODS, METHODS),
            (header::ACCESS_CONTROL_ALLOW_HEADERS, SENT),
            (header::ACCESS_CONTROL_MAX_AGE, REMEMBERED),
        ];
        (StatusCode::NO_CONTENT, fields).into_response()
    } else {
        next(request).await
    };
    let fields = response.headers_mut();
    for (name, value) in FIELDS {
        fields.entry(name).or_insert(HeaderValue::from_static(value));
    }
    if policy.allows_any() {
        fields.append(header::VARY, HeaderValue::from_static("Origin"));
    }
    if let Some(origin) = origin {
        fields.insert(header::ACCESS_CONTROL_ALLOW_ORIGIN, origin);
        fields.insert(header::ACCESS_CONTROL_EXPOSE_HEADERS, HeaderValue::from_static(READ));
    }
    response
}

#[cfg(test)]
mod tests {
    use axum::{Router, body::Body, routing::get};
    use hyper::service::Service as _;
    use hyper_util::service::TowerToHyperService;

    use super::*;

    async fn answer(method: &Method, fields: &[(HeaderName, &str)]) -> Response {
        let policy = OriginPolicy { hosts: vec![], origins: vec!["https://wiki.example".parse().expect("an origin")] };
        let app = TowerToHyperService::new(Router::new().route("/", get(|| async {})));
        let mut request = Request::builder().method(method).uri("/");
        for (name, value) in fields {
            request = request.header(name, *value);
        }
        let request = request.body(Body::empty()).expect("a request");
        add(&policy, request, async |request| app.call(request).await.expect("an answer")).await
    }

    #[tokio::test]
    async fn only_allowed_origins_get_fields_of_cors() {
        let asks = (header::ACCESS_CONTROL_REQUEST_METHOD, "DELETE");
        for (origin, is_allowed) in [("https://wiki.example", true), ("https://other.example", false)] {
            let origin_field = (header::ORIGIN, origin);
            let read = answer(&Method::GET, std::slice::from_ref(&origin_field)).await;
            let told = read.headers().get(header::ACCESS_CONTROL_ALLOW_ORIGIN);
            assert_eq!(told.is_some_and(|told| told == origin), is_allowed, "{origin}");
            assert_eq!(read.headers()[header::VARY], "Origin");
            assert_eq!(read.headers()[header::X_CONTENT_TYPE_OPTIONS], "nosniff");
            let preflight = answer(&Method::OPTIONS, &[origin_field, asks.clone()]).await;
            assert_eq!(preflight.status(), if is_allowed { 204 } else { 405 }, "{origin}");
            let methods = preflight.headers().contains_key(header::ACCESS_CONTROL_ALLOW_METHODS);
            assert_eq!(methods, is_allowed, "{origin}");
        }
        let plain = answer(&Method::OPTIONS, &[asks]).await;
        assert_eq!(plain.status(), 405, "without an origin it is a method as any other");
    }
}
