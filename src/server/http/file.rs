//! A file as an answer: all of it, a part of it, or nothing if the client has it.

use std::{
    io,
    ops::{Range, RangeInclusive},
    sync::Arc,
};

use axum::{
    body::{Body, Bytes},
    http::{HeaderMap, HeaderName, Method, StatusCode, header},
    response::{IntoResponse, Response},
};
use base64::{Engine as _, engine::general_purpose::STANDARD};
use futures_util::stream;
use http_range_header::{RangeUnsatisfiableError, parse_range_header};

use super::{
    api::Api, coding::Coding, conditional::EntityTag, connection::LEAST_BYTES, kind::ProblemKind, problem::Problem,
};
use crate::service::SHORT_BYTES;
use ltcforge_files::digest::Digest;

/// The bytes never change under their address, because the address has their digest or that of all they follow from.
pub(super) const FOREVER: &str = "public, max-age=31536000, immutable";

/// The bytes of a file.
#[derive(Debug)]
pub(super) enum Contents {
    /// In memory.
    Memory(Arc<Vec<u8>>),
    /// In the store, from where they are read as they are sent.
    Stored { api: Api, length: u64 },
}

impl Contents {
    fn length(&self) -> u64 {
        match self {
            Self::Memory(bytes) => bytes.len() as u64,
            Self::Stored { length, .. } => *length,
        }
    }

    /// A part of the contents of the file `digest`. The part lies within them.
    fn body(self, digest: Digest, part: Range<u64>) -> Body {
        match self {
            Self::Memory(bytes) => {
                Bytes::from_owner(Shared(bytes)).slice(part.start as usize..part.end as usize).into()
            }
            Self::Stored { api, .. } => Body::from_stream(stream::try_unfold(part, move |left| {
                let api = api.clone();
                async move { step(&api, digest, left).await }
            })),
        }
    }
}

/// In the extensions of an answer, the file in memory of which its body is all or a part: the connection may then send it
/// without copying it.
#[derive(Debug, Clone)]
pub(super) struct InMemory {
    pub(super) digest: Digest,
    pub(super) bytes: Arc<Vec<u8>>,
}

/// The next bytes of `left`, and what is left then.
async fn step(api: &Api, digest: Digest, left: Range<u64>) -> io::Result<Option<(Bytes, Range<u64>)>> {
    if left.is_empty() {
        return Ok(None);
    }
    let (from, length) = (left.start, SHORT_BYTES.min(left.end - left.start));
    let read = api.call(move |service| service.part(digest, from, length as usize)).await;
    // The connection ends before the announced length, which tells the client.
    let read = read.ok().flatten().filter(|read| !read.is_empty());
    let read = read.ok_or_else(|| io::Error::other(format!("{digest} cannot be read any more")))?;
    let next = from + read.len() as u64;
    Ok(Some((read.into(), next..left.end)))
}

/// A file and how it is sent.
#[derive(Debug)]
pub(super) struct File {
    /// The digest of the bytes as they are sent, which is their entity tag.
    pub(super) digest: Digest,
    pub(super) contents: Contents,
    pub(super) media_type: &'static str,
    /// The value of `Cache-Control`.
    pub(super) caching: &'static str,
    /// The name under which it is saved, of letters, digits, dots, hyphens and underscores; `None` for a file that is
    /// shown.
    pub(super) name: Option<String>,
    pub(super) coding: Coding,
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
    pub(super) fn respond(self, method: &Method, headers: &HeaderMap) -> Result<Response, Problem> {
        let coding = self.coding;
        let mut response = self.in_its_coding(method, headers)?;
        coding.tell(&mut response);
        Ok(response)
    }

    fn in_its_coding(self, method: &Method, headers: &HeaderMap) -> Result<Response, Problem> {
        let tag = EntityTag::strong(self.digest);
        tag.check_if_match(headers)?;
        let validators = [(header::ETAG, tag.as_str()), (header::CACHE_CONTROL, self.caching)];
        if tag.is_known_to(headers) {
            let mut response = (StatusCode::NOT_MODIFIED, validators).into_response();
            if method == Method::HEAD {
                // Otherwise the answer would say that the file is empty.
                response.headers_mut().insert(header::CONTENT_LENGTH, self.contents.length().into());
            }
            return Ok(response);
        }
        let length = self.contents.length();
        let representation = [
            (header::CONTENT_TYPE, self.media_type.to_owned()),
            (header::ACCEPT_RANGES, "bytes".to_owned()),
            (HeaderName::from_static("repr-digest"), sha_256(self.digest)),
        ];
        let attachment = self.name.as_ref().map(|name| format!("attachment; filename=\"{name}\""));
        let disposition = attachment.map(|value| [(header::CONTENT_DISPOSITION, value)]);
        // `Range` applies to GET only, and only if `If-Range` allows it.
        let applies = method == Method::GET && tag.allows_range(headers);
        let field = headers.get(header::RANGE).filter(|_| applies);
        let range = match field.map_or(Ok(None), |field| one_range(field.as_bytes(), length)) {
            Ok(range) => range,
            Err(refused) => {
                let content_range = [(header::CONTENT_RANGE, format!("bytes */{length}"))];
                return Ok((content_range, refused).into_response());
            }
        };
        let (status, content_range, part) = match range {
            None => (StatusCode::OK, None, 0..length),
            Some(range) => {
                let content_range = format!("bytes {}-{}/{length}", range.start(), range.end());
                (
                    StatusCode::PARTIAL_CONTENT,
                    Some([(header::CONTENT_RANGE, content_range)]),
                    *range.start()..range.end() + 1,
                )
            }
        };
        let content_length = [(header::CONTENT_LENGTH, (part.end - part.start).to_string())];
        let content_digest = self.content_digest(method, &part);
        let content_digest =
            content_digest.map(|digest| [(HeaderName::from_static("content-digest"), sha_256(digest))]);
        let in_memory = self.in_memory(method, &part);
        let body = self.contents.body(self.digest, part);
        let response =
            (status, validators, representation, disposition, content_range, content_digest, content_length, body);
        let mut response = response.into_response();
        if let Some(in_memory) = in_memory {
            response.extensions_mut().insert(in_memory);
        }
        Ok(response)
    }

    /// The file, if an answer has enough of its bytes from memory to make the kernel's copy worth it, and the file is short
    /// enough to have one.
    fn in_memory(&self, method: &Method, part: &Range<u64>) -> Option<InMemory> {
        match &self.contents {
            Contents::Memory(bytes)
                if method != Method::HEAD
                    && part.end - part.start >= LEAST_BYTES
                    && bytes.len() as u64 <= SHORT_BYTES =>
            {
                Some(InMemory { digest: self.digest, bytes: Arc::clone(bytes) })
            }
            _ => None,
        }
    }

    /// The digest of the bytes that an answer carries [RFC 9530, section 2]. An answer to `HEAD` carries none, and a part of
    /// a long file is not in memory to be hashed.
    fn content_digest(&self, method: &Method, part: &Range<u64>) -> Option<Digest> {
        if method == Method::HEAD {
            return None;
        }
        match &self.contents {
            _ if *part == (0..self.contents.length()) => Some(self.digest),
            Contents::Memory(bytes) if part.end - part.start <= SHORT_BYTES => {
                Some(Digest::of(&bytes[part.start as usize..part.end as usize]))
            }
            _ => None,
        }
    }
}

/// A digest as the fields `Repr-Digest` and `Content-Digest` have it.
fn sha_256(digest: Digest) -> String {
    format!("sha-256=:{}:", STANDARD.encode(digest.as_bytes()))
}

/// The range that a `Range` field asks for in a file of `length` bytes. `None` if it is not a single valid byte range:
/// then the field is ignored, as a server may.
///
/// # Errors
/// 416 if none of its bytes exist.
fn one_range(field: &[u8], length: u64) -> Result<Option<RangeInclusive<u64>>, Problem> {
    let parsed = str::from_utf8(field).ok().and_then(|text| parse_range_header(text).ok());
    let Some(ranges) = parsed.filter(|ranges| ranges.len() == 1) else { return Ok(None) };
    match ranges.validate(length) {
        Ok(ranges) => Ok(ranges.into_iter().next()),
        Err(RangeUnsatisfiableError::Unsatisfiable) => {
            let detail = format!("the file has {length} bytes; none of them is in the range");
            Err(Problem::new(ProblemKind::RangeNotSatisfiable, detail))
        }
        Err(_) => Ok(None),
    }
}

#[cfg(test)]
mod tests {
    use axum::http::HeaderValue;

    use super::*;

    const FILE: &[u8] = b"0123456789";

    fn file() -> File {
        let (digest, contents) = (Digest::of(FILE), Contents::Memory(Arc::new(FILE.to_vec())));
        let (name, coding) = (Some("ltc.ktx2".to_owned()), Coding::Identity);
        File { digest, contents, media_type: "image/ktx2", caching: FOREVER, name, coding }
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
        assert!(!request(&Method::HEAD, &[]).headers().contains_key("content-digest"), "it carries no content");

        let response = get(&[(header::RANGE, "bytes=10-")]);
        assert_eq!(response.status(), 416);
        assert_eq!(response.headers()[header::CONTENT_RANGE], "bytes */10");
    }

    #[test]
    fn the_kernel_gets_a_copy_of_files_of_64_kib_to_a_mebibyte_alone() {
        let is_copied = |length: usize, method: &Method, range: Option<&'static str>| {
            let headers = range.map(|range| (header::RANGE, HeaderValue::from_static(range)));
            let file = File { contents: Contents::Memory(Arc::new(vec![0; length])), ..file() };
            let response = file.respond(method, &headers.into_iter().collect()).expect("a response");
            response.extensions().get::<InMemory>().is_some()
        };
        for (length, copied) in [(65_535, false), (65_536, true), (1 << 20, true), ((1 << 20) + 1, false)] {
            assert_eq!(is_copied(length, &Method::GET, None), copied, "{length}");
        }
        assert!(!is_copied(65_536, &Method::HEAD, None));
        for (range, copied) in [("bytes=0-65535", true), ("bytes=0-65534", false)] {
            assert_eq!(is_copied(100_000, &Method::GET, Some(range)), copied, "{range}");
        }
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
            ("bytes=0-0", 0..=0),
            ("bytes=2-5", 2..=5),
            ("Bytes=2-", 2..=9),
            ("bytes=-3", 7..=9),
            ("bytes=-30", 0..=9),
            ("bytes=9-99999999999999999999999", 9..=9),
        ];
        for (field, part) in cases {
            assert_eq!(one_range(field.as_bytes(), 10).expect("bytes that exist"), Some(part), "{field}");
        }
    }

    #[test]
    fn bytes_beyond_the_end_are_refused() {
        for field in ["bytes=10-", "bytes=10-20", "bytes=-0", "bytes=99999999999999999999999-"] {
            let refused = one_range(field.as_bytes(), 10).expect_err(field);
            assert_eq!(refused.status(), 416, "{field}");
        }
        assert!(one_range(b"bytes=0-", 0).is_err());
    }

    #[test]
    fn anything_but_one_byte_range_is_ignored() {
        for field in
            ["", "bytes", "bytes=", "bytes=-", "bytes=5-2", "bytes=a-b", "bytes=0-1,4-5", "items=0-1", "bytes=+1-2"]
        {
            assert_eq!(one_range(field.as_bytes(), 10).expect("all bytes"), None, "{field}");
        }
    }
}
