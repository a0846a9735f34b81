//! A WGSL shader for other renderers, with a comment that explains it.

use super::{language::Language, lit_by::LitBy, sources::ported, stamp::stamped};

/// The WGSL shader for light by a table of a layout, or without a table.
///
/// It starts with a comment that explains how to call it and lists values that a port must reproduce.
#[must_use]
pub fn wgsl(lit_by: impl Into<LitBy>) -> String {
    let lit_by = lit_by.into();
    stamped(&lit_by.comment(Language::Wgsl), &ported(lit_by))
}
