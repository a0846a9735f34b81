//! A shader for other renderers in WGSL, under the comment that explains it.

use super::{language::Language, lit_by::LitBy, sources::ported, stamp::stamped};

/// The shader that lights by a table of some layout, or without one, in WGSL as it is written here.
///
/// It begins with a comment that explains how to call it and lists values that a port has to reproduce.
#[must_use]
pub fn wgsl(lit_by: impl Into<LitBy>) -> String {
    let lit_by = lit_by.into();
    stamped(&lit_by.comment(Language::Wgsl), &ported(lit_by))
}
