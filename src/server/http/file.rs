//! Files as responses: the whole file, a range of it, or 304 if the client has it.

use std::ops::Range;

use axum::{
    body::Bytes,
    http::{HeaderMap, HeaderName, Method, StatusCode, header},
    response::IntoResponse,
};
use base64::{Engine as _, engine::general_purpose::STANDARD};
use serde::Serialize;

use super::{
    api::Api,
    error,
    etag::EntityTag,
    extract::Asked,
    kind::ProblemKind,
    problem::{Answer, Problem},
};
use crate::service::{FileKind, Service};
use ltcforge_files::{digest::Digest, tabulated::kept_name};

/// `Cache-Control` of bytes that never change at their address. The address contains their digest, or the digests of
/// everything that determines them.
pub(super) const FOREVER: &str = "public, max-age=31536000, immutable";
/// `Cache-Control` of bytes that change with the version of the program.
pub(super) const ONE_DAY: &str = "public, max-age=86400";
/// `Cache-Control` of bytes that may change at any time.
pub(super) const REVALIDATE: &str = "no-cache";

/// A file in memory with the fields of its response.
#[derive(Debug)]
pub(super) struct File {
    /// The digest of the bytes, which is also the entity tag.
    pub(super) digest: Digest,
    pub(super) bytes: Bytes,
    pub(super) media_type: &'static str,
    /// The value of `Cache-Control`.
    pub(super) caching: &'static str,
    /// The file name for downloads, without characters that need quoting; `None` if browsers should show the file.
    pub(super) name: Option<String>,
}

impl File {
    /// A JSON document.
    pub(super) fn json(document: &impl Serialize) -> Result<Self, Problem> {
        let bytes = Bytes::from(serde_json::to_vec(document).map_err(|error| error::internal(&error))?);
        let digest = Digest::of(&bytes);
        Ok(Self { digest, bytes, media_type: "application/json", caching: ONE_DAY, name: None })
    }

    /// Responds with the file, a range of it, or 304. Evaluates conditions in the order of RFC 9110, section 13.2.2.
    pub(super) fn respond(self, method: &Method, headers: &HeaderMap) -> Answer {
        let tag = EntityTag::strong(self.digest);
        tag.check_if_match(headers)?;
        let length = self.bytes.len();
        let validators = [(header::ETAG, tag.as_str()), (header::CACHE_CONTROL, self.caching)];
        if tag.is_known_to(headers) {
            // A response to `HEAD` without a length would mean an empty file.
            let length = (method == Method::HEAD).then(|| [(header::CONTENT_LENGTH, length.to_string())]);
            return Ok((StatusCode::NOT_MODIFIED, validators, length, ()).into_response());
        }
        // `Range` applies to GET only, and only if `If-Range` allows it.
        let field = headers.get(header::RANGE).and_then(|field| field.to_str().ok());
        let field = field.filter(|_| method == Method::GET && tag.allows_range(headers));
        let (status, part) = match field.and_then(|field| one_range(field, length)) {
            None => (StatusCode::OK, 0..length),
            Some(part) if part.is_empty() => {
                let detail = format!("the file has {length} bytes, and the requested range is outside of it");
                let problem = Problem::new(ProblemKind::RangeNotSatisfiable, detail);
                return Ok(([(header::CONTENT_RANGE, format!("bytes */{length}"))], problem).into_response());
            }
            Some(part) => (StatusCode::PARTIAL_CONTENT, part),
        };
        let representation = [
            (header::CONTENT_TYPE, self.media_type.to_owned()),
            (header::ACCEPT_RANGES, "bytes".to_owned()),
            (header::CONTENT_LENGTH, part.len().to_string()),
            (HeaderName::from_static("repr-digest"), sha_256(self.digest)),
        ];
        let disposition =
            self.name.map(|name| [(header::CONTENT_DISPOSITION, format!("attachment; filename=\"{name}\""))]);
        let content_range = (status == StatusCode::PARTIAL_CONTENT)
            .then(|| [(header::CONTENT_RANGE, format!("bytes {}-{}/{length}", part.start, part.end - 1))]);
        // A response to `HEAD` has no content [RFC 9530, section 2].
        let body = self.bytes.slice(part);
        let content_digest = (method != Method::HEAD).then(|| {
            let digest = if body.len() == length { self.digest } else { Digest::of(&body) };
            [(HeaderName::from_static("content-digest"), sha_256(digest))]
        });
        Ok((status, validators, representation, disposition, content_range, content_digest, body).into_response())
    }
}

/// A digest in the format of `Repr-Digest` and `Content-Digest`.
fn sha_256(digest: Digest) -> String {
    format!("sha-256=:{}:", STANDARD.encode(digest.as_bytes()))
}

/// The bytes that a `Range` field requests from a file of `length` bytes. The result is empty if they are outside of
/// the file. It is `None` if the field is not exactly one valid byte range; a server may ignore such a field.
fn one_range(field: &str, length: usize) -> Option<Range<usize>> {
    let (unit, range) = field.split_once('=')?;
    let (first, last) = range.trim().split_once('-').filter(|_| unit.eq_ignore_ascii_case("bytes"))?;
    let number = |text: &str| {
        let is_number = !text.is_empty() && text.bytes().all(|byte| byte.is_ascii_digit());
        // A number that is too large for `usize` is outside of the file.
        is_number.then(|| text.parse().unwrap_or(usize::MAX))
    };
    let part = match (first, last) {
        ("", last) => length.saturating_sub(number(last)?)..length,
        (first, "") => number(first)?..length,
        (first, last) => number(first)?..number(last).filter(|last| Some(*last) >= number(first))?.saturating_add(1),
    };
    Some(part.start.min(length)..part.end.min(length))
}

/// The media type for the extension of a file name.
pub(super) fn media_type(name: &str) -> &'static str {
    match name.rsplit('.').next().unwrap_or_default() {
        "html" => "text/html; charset=utf-8",
        "css" => "text/css; charset=utf-8",
        "js" => "text/javascript; charset=utf-8",
        "svg" => "image/svg+xml",
        "txt" | "h" | "rs" | "cs" | "wgsl" | "glsl" => "text/plain; charset=utf-8",
        "json" => "application/json",
        "ktx2" => "image/ktx2",
        "dds" => "image/vnd.ms-dds",
        "exr" => "image/x-exr",
        "npz" => "application/zip",
        _ => "application/octet-stream",
    }
}

/// `GET` and `HEAD` of a stored file. The service has verified its bytes against the digest.
pub(super) async fn stored(api: &Api, kind: FileKind, digest: Digest, asked: &Asked) -> Answer {
    let bytes = match api.service.cached_file(kind, digest) {
        Some(bytes) => Some(bytes),
        None => api.read(move |service| service.file(kind, digest)).await?,
    };
    let (name, bytes) = match (kind, bytes) {
        (FileKind::Table, Some(bytes)) => (format!("{}.safetensors", digest.hex()), bytes),
        (_, Some(bytes)) => (kept_name(digest.as_bytes()), bytes),
        (FileKind::Table, None) => return Err(absent(api, digest).await),
        (_, None) => {
            let detail = format!("no BRDF with the digest {digest} is stored");
            return Err(Problem::new(ProblemKind::UnknownBrdf, detail));
        }
    };
    let media_type = "application/octet-stream";
    File { digest, bytes, media_type, caching: FOREVER, name: Some(name) }.respond(&asked.method, &asked.headers)
}

/// The problem for a table that is not stored. If a known job fitted the table, the problem contains its recipe.
pub(super) async fn absent(api: &Api, digest: Digest) -> Problem {
    match api.call(move |service| service.job_of_table(digest)).await {
        Err(problem) => problem,
        Ok(None) => Problem::new(ProblemKind::UnknownTable, format!("no table with the digest {digest} is stored")),
        Ok(Some(job)) => {
            let detail = format!("the table {digest} was removed; submit its recipe to fit it again");
            let problem = Problem::new(ProblemKind::RemovedTable, detail);
            serde_json::from_str(&job.recipe).into_iter().fold(problem, Problem::with_recipe)
        }
    }
}

/// Deletes a stored file if `If-Match` allows its entity tag.
pub(super) async fn delete<E: Into<Problem> + Send + 'static>(
    api: &Api,
    digest: Digest,
    headers: &HeaderMap,
    delete: impl FnOnce(&Service) -> Result<(), E> + Send + 'static,
) -> Answer {
    let tag = EntityTag::strong(digest);
    tag.check_if_match(headers)?;
    api.call(delete).await?;
    Ok((StatusCode::NO_CONTENT, [(header::ETAG, tag.as_str())]).into_response())
}

#[cfg(test)]
mod tests {
    use axum::{http::HeaderValue, response::Response};

    use super::*;

    const FILE: &[u8] = b"0123456789";

    fn file() -> File {
        let (digest, bytes, name) = (Digest::of(FILE), Bytes::from_static(FILE), Some("ltc.ktx2".to_owned()));
        File { digest, bytes, media_type: "image/ktx2", caching: FOREVER, name }
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
    async fn the_whole_file_carries_its_hash_in_each_form() {
        let response = get(&[]);
        assert_eq!(response.status(), 200);
        let digest = Digest::of(FILE);
        let headers = response.headers();
        assert_eq!(headers[header::ETAG], format!("\"{digest}\""));
        // `printf 0123456789 | openssl dgst -sha256 -binary | base64`
        assert_eq!(headers["repr-digest"], "sha-256=:hNiYd/DUBB77a/kaFvAkjy/Vc+avBcGflr7bn4gveII=:");
        assert_eq!(headers["content-digest"], headers["repr-digest"]);
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
        // `printf 234 | openssl dgst -sha256 -binary | base64`
        assert_eq!(response.headers()["content-digest"], "sha-256=:EUvRUfj7DFhkLSFw2krn18V5dyYKwsyJBTBsq2sqyrw=:");
        assert_eq!(response.headers()["repr-digest"], get(&[]).headers()["repr-digest"]);
        assert_eq!(body(response).await, "234");
        assert!(!request(&Method::HEAD, &[]).headers().contains_key("content-digest"), "HEAD has no content");

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

    #[test]
    fn one_range_is_cut_to_the_file() {
        let cases = [
            ("bytes=0-0", 0..1),
            ("bytes=2-5", 2..6),
            ("Bytes=2-", 2..10),
            ("bytes=-3", 7..10),
            ("bytes=-30", 0..10),
            ("bytes=9-99999999999999999999999", 9..10),
        ];
        for (field, part) in cases {
            assert_eq!(one_range(field, 10), Some(part), "{field}");
        }
        for field in ["bytes=10-", "bytes=10-20", "bytes=-0", "bytes=99999999999999999999999-"] {
            assert_eq!(one_range(field, 10), Some(10..10), "{field}");
        }
        assert_eq!(one_range("bytes=0-", 0), Some(0..0));
        for field in
            ["", "bytes", "bytes=", "bytes=-", "bytes=5-2", "bytes=a-b", "bytes=0-1,4-5", "items=0-1", "bytes=+1-2"]
        {
            assert_eq!(one_range(field, 10), None, "{field}");
        }
    }
}
