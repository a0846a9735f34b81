//! Entity tags and conditional requests [RFC 9110, sections 8.8 and 13].

use axum::{
    extract::Request,
    http::{HeaderMap, header},
    middleware::Next,
    response::{IntoResponse as _, Response},
};

use super::{kind::ProblemKind, problem::Problem};

/// A strong entity tag with its quotes, such as `"sha256:…"`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct EntityTag(String);

impl EntityTag {
    /// The tag of the representation that `name` identifies. `name` contains no quotes.
    pub(super) fn strong(name: impl std::fmt::Display) -> Self {
        Self(format!("\"{name}\""))
    }

    /// The tag as a header field has it.
    pub(super) fn as_str(&self) -> &str {
        &self.0
    }

    /// Checks `If-Match`, by strong comparison.
    ///
    /// # Errors
    /// 412 if the client asks for another representation only.
    pub(super) fn check_if_match(&self, headers: &HeaderMap) -> Result<(), Problem> {
        if if_match_allows(headers, |tag| tag == self.0) {
            return Ok(());
        }
        let detail = format!("the entity tag is {}, which If-Match does not list", self.0);
        Err(Problem::new(ProblemKind::PreconditionFailed, detail))
    }

    /// Whether `If-None-Match` says that the client has this representation, by weak comparison.
    pub(super) fn is_known_to(&self, headers: &HeaderMap) -> bool {
        let fields = headers.get_all(header::IF_NONE_MATCH).iter();
        fields.filter_map(|field| field.to_str().ok()).flat_map(tags).any(|tag| {
            let tag = tag.strip_prefix("W/").unwrap_or(tag);
            tag == "*" || tag == self.0
        })
    }

    /// Whether `If-Range` allows a range to be served, by strong comparison. A date never matches: no representation
    /// has one.
    pub(super) fn allows_range(&self, headers: &HeaderMap) -> bool {
        headers.get(header::IF_RANGE).is_none_or(|field| field.as_bytes() == self.0.as_bytes())
    }
}

/// Checks `If-Match` for what is there and has no entity tag: only `*` matches it. A call that changes anything asks this
/// before it does.
///
/// # Errors
/// 412 if the client asks for an entity tag.
pub(super) fn check_untagged(headers: &HeaderMap) -> Result<(), Problem> {
    if if_match_allows(headers, |_| false) {
        return Ok(());
    }
    let detail = "this has no entity tag; of If-Match, only * matches it";
    Err(Problem::new(ProblemKind::PreconditionFailed, detail))
}

/// The layer that answers 412 in place of a success without an entity tag, by [`check_untagged`]. Only success counts:
/// preconditions of other requests are ignored [RFC 9110, section 13.2.1].
pub(super) async fn require_if_match(request: Request, next: Next) -> Response {
    let checked = check_untagged(request.headers());
    let response = next.run(request).await;
    match checked {
        Err(problem) if response.status().is_success() && !response.headers().contains_key(header::ETAG) => {
            problem.into_response()
        }
        _ => response,
    }
}

/// Whether there is no `If-Match`, or it lists `*` or a tag that `is_own`.
fn if_match_allows(headers: &HeaderMap, is_own: impl Fn(&str) -> bool) -> bool {
    let mut fields = headers.get_all(header::IF_MATCH).iter().peekable();
    fields.peek().is_none()
        || fields.filter_map(|field| field.to_str().ok()).flat_map(tags).any(|tag| tag == "*" || is_own(tag))
}

/// The members of a list of entity tags. The service's own tags contain no comma, so a foreign tag that is split within
/// its quotes yields pieces that match nothing.
fn tags(field: &str) -> impl Iterator<Item = &str> {
    field.split(',').map(str::trim)
}

#[cfg(test)]
mod tests {
    use axum::http::{HeaderName, HeaderValue};

    use super::*;

    fn headers(fields: &[(HeaderName, &'static str)]) -> HeaderMap {
        let mut headers = HeaderMap::new();
        for (name, value) in fields {
            headers.append(name, HeaderValue::from_static(value));
        }
        headers
    }

    #[test]
    fn if_none_match_compares_weakly_over_all_members() {
        let tag = EntityTag::strong("sha256:ab");
        for known in [r#""sha256:ab""#, r#"W/"sha256:ab""#, r#""x" , "sha256:ab""#, "*"] {
            assert!(tag.is_known_to(&headers(&[(header::IF_NONE_MATCH, known)])), "{known}");
        }
        for other in [r#""sha256:cd""#, "sha256:ab", "", r#""*""#] {
            assert!(!tag.is_known_to(&headers(&[(header::IF_NONE_MATCH, other)])), "{other}");
        }
        let two_fields = [(header::IF_NONE_MATCH, r#""x""#), (header::IF_NONE_MATCH, r#""sha256:ab""#)];
        assert!(tag.is_known_to(&headers(&two_fields)));
        assert!(!tag.is_known_to(&HeaderMap::new()));
    }

    #[test]
    fn if_match_compares_strongly_over_all_members() {
        let tag = EntityTag::strong("sha256:ab");
        assert!(tag.check_if_match(&HeaderMap::new()).is_ok());
        for wanted in [r#""sha256:ab""#, r#""x" , "sha256:ab""#, "*"] {
            assert!(tag.check_if_match(&headers(&[(header::IF_MATCH, wanted)])).is_ok(), "{wanted}");
        }
        for other in [r#"W/"sha256:ab""#, r#""sha256:cd""#, "", r#""*""#] {
            let problem = tag.check_if_match(&headers(&[(header::IF_MATCH, other)])).expect_err(other);
            assert_eq!(problem.status().as_u16(), 412, "{other}");
        }
    }

    #[test]
    fn only_a_star_matches_what_has_no_tag() {
        for allowed in [&[][..], &[(header::IF_MATCH, "*")], &[(header::IF_MATCH, r#""x""#), (header::IF_MATCH, "*")]] {
            assert!(check_untagged(&headers(allowed)).is_ok(), "{allowed:?}");
        }
        for other in [r#""x""#, "", r#""*""#] {
            let problem = check_untagged(&headers(&[(header::IF_MATCH, other)])).expect_err(other);
            assert_eq!(problem.status().as_u16(), 412, "{other}");
        }
    }

    #[test]
    fn if_range_compares_strongly() {
        let tag = EntityTag::strong("sha256:ab");
        assert!(tag.allows_range(&HeaderMap::new()));
        assert!(tag.allows_range(&headers(&[(header::IF_RANGE, r#""sha256:ab""#)])));
        for other in [r#"W/"sha256:ab""#, r#""sha256:cd""#, "Thu, 01 Jan 1970 00:00:00 GMT"] {
            assert!(!tag.allows_range(&headers(&[(header::IF_RANGE, other)])), "{other}");
        }
    }
}
