//! Content codings [RFC 9110, sections 8.4 and 12.5.3]: a file as it is, or by zstd.

use axum::{
    http::{HeaderMap, HeaderValue, StatusCode, header},
    response::Response,
};

use super::conditional::EntityTag;
use ltcforge_files::digest::Digest;

/// The coding in which a file is sent, and whether there is a choice.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Coding {
    /// As it is, to every client.
    Fixed,
    /// As it is, to this client.
    Identity,
    /// Compressed, to this client. The digest and the contents of the file are those of the compressed bytes.
    Zstd,
}

impl Coding {
    /// Adds the fields that tell it.
    pub(super) fn tell(self, response: &mut Response) {
        if self == Self::Zstd && response.status() == StatusCode::OK {
            response.headers_mut().insert(header::CONTENT_ENCODING, HeaderValue::from_static("zstd"));
        }
        if self != Self::Fixed {
            response.headers_mut().append(header::VARY, HeaderValue::from_static("accept-encoding"));
        }
    }
}

/// Whether a request is better answered with the file `digest` compressed. Parts are parts of the file as it is, and so is
/// what a client has or insists on by its entity tag.
pub(super) fn wants_zstd(digest: Digest, headers: &HeaderMap) -> bool {
    accepts_zstd(headers) && !headers.contains_key(header::RANGE) && !EntityTag::strong(digest).is_named_in(headers)
}

/// Whether the request names zstd, with at least the weight that it gives the file as it is. `*` does not count: the file
/// as it is suits every client.
fn accepts_zstd(headers: &HeaderMap) -> bool {
    let (mut zstd, mut identity) = (0.0, 0.0);
    for field in headers.get_all(header::ACCEPT_ENCODING) {
        for item in field.to_str().unwrap_or_default().split(',') {
            let (name, weight) = item.split_once(';').map_or((item, 1.0), |(name, rest)| (name, weight(rest)));
            let name = name.trim();
            if name.eq_ignore_ascii_case("zstd") {
                zstd = weight;
            } else if name.eq_ignore_ascii_case("identity") {
                identity = weight;
            }
        }
    }
    zstd > 0.0 && zstd >= identity
}

/// The weight that `text` has, such as `q=0.5`. One that is malformed counts as 0.
fn weight(text: &str) -> f64 {
    let digits = text.trim().strip_prefix(['q', 'Q']).and_then(|rest| rest.strip_prefix('='));
    let digits = digits.filter(|digits| digits.bytes().all(|byte| byte.is_ascii_digit() || byte == b'.'));
    digits.and_then(|digits| digits.parse().ok()).filter(|weight| (0.0..=1.0).contains(weight)).unwrap_or(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn accepting(fields: &[&'static str]) -> HeaderMap {
        fields.iter().map(|field| (header::ACCEPT_ENCODING, HeaderValue::from_static(field))).collect()
    }

    #[test]
    fn zstd_is_sent_to_whom_names_it() {
        for fields in [
            &["zstd"][..],
            &["gzip, deflate, br, zstd"],
            &["ZStd;q=0.001"],
            &["gzip;q=1.0 ,\tzstd ; Q=1.000"],
            &["gzip", "zstd"],
            &["zstd, identity"],
            &["identity;q=0.5, zstd;q=0.5"],
            &["*;q=0, zstd"],
        ] {
            assert!(accepts_zstd(&accepting(fields)), "{fields:?}");
        }
        for fields in [
            &[][..],
            &[""],
            &["identity"],
            &["gzip, br"],
            &["*"],
            &["zstd;q=0"],
            &["zstd;q=0.000"],
            &["zstd;q=0.4, identity;q=0.5"],
            &["zstd;q=2"],
            &["zstd;q=-1"],
            &["zstd;q=NaN"],
            &["zstd;q="],
            &["zstd;level=1"],
            &["zstandard"],
        ] {
            assert!(!accepts_zstd(&accepting(fields)), "{fields:?}");
        }
    }

    #[test]
    fn a_range_and_the_tag_of_the_file_ask_for_it_as_it_is() {
        let (own, other) = (Digest::of(b"own"), Digest::of(b"other"));
        for (name, value, wants) in [
            (header::RANGE, "bytes=0-1".to_owned(), false),
            (header::IF_NONE_MATCH, format!("\"{own}\""), false),
            (header::IF_NONE_MATCH, format!("\"{other}\""), true),
            (header::IF_MATCH, format!("\"{other}\", \"{own}\""), false),
            (header::IF_MATCH, format!("\"{other}\""), true),
        ] {
            let mut headers = accepting(&["zstd"]);
            headers.insert(&name, value.parse().expect("a field"));
            assert_eq!(wants_zstd(own, &headers), wants, "{name}: {value}");
        }
    }
}
