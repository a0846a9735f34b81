//! A file in memory as an answer: whole, a part of it, or what the client has already.

use std::sync::Arc;

use axum::{
    body::{Body, Bytes},
    http::{HeaderMap, HeaderValue, Method, Response as HttpResponse, StatusCode, header, response::Builder},
    response::{IntoResponse, Response},
};
use base64::{Engine as _, engine::general_purpose::STANDARD};

use super::{
    conditional::EntityTag,
    error,
    kind::ProblemKind,
    problem::Problem,
    range::{self, Requested},
};
use ltcforge_files::digest::Digest;

/// The bytes never change under their address, because the address has their digest or that of all they follow from.
pub(super) const FOREVER: &str = "public, max-age=31536000, immutable";

/// A file and how it is sent.
#[derive(Debug)]
pub(super) struct File {
    /// The digest of the bytes, which is their entity tag.
    pub(super) digest: Digest,
    pub(super) bytes: Arc<Vec<u8>>,
    pub(super) media_type: &'static str,
    /// The value of `Cache-Control`.
    pub(super) caching: &'static str,
    /// The name under which it is saved, of letters, digits, dots, hyphens and underscores; none for what is shown.
    pub(super) name: Option<String>,
}

/// Shares the service's copy of a file with the response instead of making another.
struct Shared(Arc<Vec<u8>>);

impl AsRef<[u8]> for Shared {
    fn as_ref(&self) -> &[u8] {
        &self.0
    }
}

impl File {
    /// The file, a part of it, or 304 if the client has it; conditions are evaluated in the order of RFC 9110, section
    /// 13.2.2.
    pub(super) fn respond(&self, method: &Method, headers: &HeaderMap) -> Result<Response, Problem> {
        let tag = EntityTag::strong(self.digest);
        tag.check_if_match(headers)?;
        if tag.is_known_to(headers) {
            return finish(self.validators(StatusCode::NOT_MODIFIED, &tag), Body::empty());
        }
        let bytes = Bytes::from_owner(Shared(Arc::clone(&self.bytes)));
        let length = bytes.len();
        match requested(&tag, method, headers, length) {
            Requested::Whole => finish(self.representation(StatusCode::OK, &tag), Body::from(bytes)),
            Requested::Part(part) => {
                let content_range = format!("bytes {}-{}/{length}", part.start, part.end - 1);
                let head = self.representation(StatusCode::PARTIAL_CONTENT, &tag);
                finish(head.header(header::CONTENT_RANGE, content_range), Body::from(bytes.slice(part)))
            }
            Requested::Unsatisfiable => {
                let detail = format!("the file has {length} bytes; none of them is in the range");
                let mut response = Problem::new(ProblemKind::RangeNotSatisfiable, detail).into_response();
                if let Ok(content_range) = HeaderValue::from_str(&format!("bytes */{length}")) {
                    response.headers_mut().insert(header::CONTENT_RANGE, content_range);
                }
                Ok(response)
            }
        }
    }

    fn validators(&self, status: StatusCode, tag: &EntityTag) -> Builder {
        HttpResponse::builder()
            .status(status)
            .header(header::ETAG, tag.as_str())
            .header(header::CACHE_CONTROL, self.caching)
    }

    fn representation(&self, status: StatusCode, tag: &EntityTag) -> Builder {
        let head = self
            .validators(status, tag)
            .header(header::CONTENT_TYPE, self.media_type)
            .header(header::ACCEPT_RANGES, "bytes")
            .header("repr-digest", format!("sha-256=:{}:", STANDARD.encode(self.digest.as_bytes())));
        match &self.name {
            Some(name) => head.header(header::CONTENT_DISPOSITION, format!("attachment; filename=\"{name}\"")),
            None => head,
        }
    }
}

/// `Range` applies to GET only, and only if `If-Range` allows it.
fn requested(tag: &EntityTag, method: &Method, headers: &HeaderMap, length: usize) -> Requested {
    match headers.get(header::RANGE).and_then(|field| field.to_str().ok()) {
        Some(field) if method == Method::GET && tag.allows_range(headers) => range::parse(field, length),
        _ => Requested::Whole,
    }
}

fn finish(head: Builder, body: Body) -> Result<Response, Problem> {
    head.body(body).map_err(|error| error::internal(&error))
}

#[cfg(test)]
mod tests {
    use axum::http::HeaderName;

    use super::*;

    const FILE: &[u8] = b"0123456789";

    fn file() -> File {
        let (digest, bytes) = (Digest::of(FILE), Arc::new(FILE.to_vec()));
        File { digest, bytes, media_type: "image/ktx2", caching: FOREVER, name: Some("ltc.ktx2".to_owned()) }
    }

    fn get(fields: &[(HeaderName, &str)]) -> Response {
        request(&Method::GET, fields)
    }

    fn request(method: &Method, fields: &[(HeaderName, &str)]) -> Response {
        let fields =
            fields.iter().map(|(name, value)| (name.clone(), HeaderValue::from_str(value).expect("a field value")));
        file().respond(method, &fields.collect()).expect("a response")
    }

    async fn body(response: Response) -> Bytes {
        axum::body::to_bytes(response.into_body(), usize::MAX).await.expect("a body in memory")
    }

    #[tokio::test]
    async fn the_whole_file_carries_its_hash_three_times() {
        let response = get(&[]);
        assert_eq!(response.status(), 200);
        let digest = Digest::of(FILE);
        let headers = response.headers();
        assert_eq!(headers[header::ETAG], format!("\"{digest}\""));
        // `printf 0123456789 | openssl dgst -sha256 -binary | base64`
        assert_eq!(headers["repr-digest"], "sha-256=:hNiYd/DUBB77a/kaFvAkjy/Vc+avBcGflr7bn4gveII=:");
        assert_eq!(headers[header::CONTENT_DISPOSITION], "attachment; filename=\"ltc.ktx2\"");
        assert_eq!(
            (&headers[header::CONTENT_TYPE], &headers[header::CACHE_CONTROL]),
            (&"image/ktx2".parse().unwrap(), &FOREVER.parse().unwrap())
        );
        assert_eq!(body(response).await, FILE);
    }

    #[tokio::test]
    async fn a_client_that_has_the_file_gets_304() {
        let tag = format!("\"{}\"", Digest::of(FILE));
        // If-None-Match takes precedence over Range.
        let response = get(&[(header::IF_NONE_MATCH, &tag), (header::RANGE, "bytes=0-1")]);
        assert_eq!(response.status(), 304);
        assert_eq!(response.headers()[header::ETAG], tag);
        assert_eq!(body(response).await, "");
    }

    #[test]
    fn another_version_than_the_wanted_one_is_412() {
        let tag = format!("\"{}\"", Digest::of(FILE));
        assert_eq!(get(&[(header::IF_MATCH, &tag)]).status(), 200);
        let headers = HeaderMap::from_iter([
            (header::IF_MATCH, HeaderValue::from_static("\"other\"")),
            // If-Match takes precedence over If-None-Match.
            (header::IF_NONE_MATCH, HeaderValue::from_str(&tag).expect("a field value")),
        ]);
        let refused = file().respond(&Method::GET, &headers);
        assert_eq!(refused.expect_err("another version").status(), 412);
    }

    #[tokio::test]
    async fn a_part_names_its_range() {
        let response = get(&[(header::RANGE, "bytes=2-4")]);
        assert_eq!(response.status(), 206);
        assert_eq!(response.headers()[header::CONTENT_RANGE], "bytes 2-4/10");
        assert_eq!(body(response).await, "234");

        let response = get(&[(header::RANGE, "bytes=10-")]);
        assert_eq!(response.status(), 416);
        assert_eq!(response.headers()[header::CONTENT_RANGE], "bytes */10");
    }

    #[test]
    fn a_range_counts_only_on_get_and_under_its_own_tag() {
        let range = (header::RANGE, "bytes=2-4");
        let tag = format!("\"{}\"", Digest::of(FILE));
        assert_eq!(get(&[range.clone(), (header::IF_RANGE, &tag)]).status(), 206);
        assert_eq!(get(&[range.clone(), (header::IF_RANGE, "\"other\"")]).status(), 200);
        assert_eq!(request(&Method::HEAD, &[range]).status(), 200);
    }
}
