//! Entity tags and conditional requests [RFC 9110, sections 8.8 and 13].

use axum::http::HeaderMap;
use headers::{ETag, HeaderMapExt as _, IfMatch, IfNoneMatch, IfRange};

use super::{kind::ProblemKind, problem::Problem};

/// A strong entity tag with its quotes, such as `"sha256:…"`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct EntityTag(String);

impl EntityTag {
    /// The tag of a representation. `name` is unique and contains no quotes.
    pub(super) fn strong(name: impl std::fmt::Display) -> Self {
        Self(format!("\"{name}\""))
    }

    /// The tag in the format of a header field.
    pub(super) fn as_str(&self) -> &str {
        &self.0
    }

    /// Whether `condition` holds for the tag.
    fn meets(&self, condition: impl FnOnce(&ETag) -> bool) -> bool {
        self.0.parse().is_ok_and(|tag| condition(&tag))
    }

    /// Checks `If-Match`, by strong comparison.
    ///
    /// # Errors
    /// 412 if `If-Match` does not list the tag.
    pub(super) fn check_if_match(&self, headers: &HeaderMap) -> Result<(), Problem> {
        match headers.typed_get::<IfMatch>() {
            Some(field) if !self.meets(|tag| field.precondition_passes(tag)) => {
                let detail = format!("the entity tag is {}, which If-Match does not list", self.0);
                Err(Problem::new(ProblemKind::PreconditionFailed, detail))
            }
            _ => Ok(()),
        }
    }

    /// Whether `If-None-Match` says that the client has this representation, by weak comparison.
    pub(super) fn is_known_to(&self, headers: &HeaderMap) -> bool {
        let field = headers.typed_get::<IfNoneMatch>();
        field.is_some_and(|field| self.meets(|tag| !field.precondition_passes(tag)))
    }

    /// Whether `If-Range` allows a range, by strong comparison. A date never matches, because no representation has a
    /// date.
    pub(super) fn allows_range(&self, headers: &HeaderMap) -> bool {
        match headers.typed_try_get::<IfRange>() {
            Ok(Some(field)) => self.meets(|tag| !field.is_modified(Some(tag), None)),
            Ok(None) => true,
            Err(_) => false,
        }
    }
}

/// Checks `If-Match` for a resource without an entity tag. Only `*` matches. Calls that change data check this before
/// the change.
///
/// # Errors
/// 412 if `If-Match` lists an entity tag.
pub(super) fn check_untagged(headers: &HeaderMap) -> Result<(), Problem> {
    match headers.typed_get::<IfMatch>() {
        Some(field) if !field.is_any() => {
            let detail = "this resource has no entity tag; send If-Match: * or no If-Match";
            Err(Problem::new(ProblemKind::PreconditionFailed, detail))
        }
        _ => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use axum::http::{HeaderName, HeaderValue, header};

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
        for allowed in [&[][..], &[(header::IF_MATCH, "*")]] {
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
        for other in [r#"W/"sha256:ab""#, r#""sha256:cd""#, "sha256:ab", "Thu, 01 Jan 1970 00:00:00 GMT"] {
            assert!(!tag.allows_range(&headers(&[(header::IF_RANGE, other)])), "{other}");
        }
    }
}
