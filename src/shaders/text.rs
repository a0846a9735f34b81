//! A shader for other renderers in WGSL, under the comment that explains it.

use super::{
    gaussians_header::gaussians_header, gaussians_table_header::gaussians_table_header, header::header,
    language::Language, lit_by::LitBy, normals_header::normals_header, sources::ported,
};

/// The shader that lights by a table of some layout, or without one, in WGSL as it is written here.
///
/// It begins with a comment that explains how to call it and lists values that a port has to reproduce.
#[must_use]
pub fn wgsl(lit_by: impl Into<LitBy>) -> String {
    let lit_by = lit_by.into();
    format!("{}\n{}", comment(Language::Wgsl, lit_by), ported(lit_by))
}

/// The comment at the top of the shader in `language`.
#[must_use]
pub fn comment(language: Language, lit_by: LitBy) -> String {
    match lit_by {
        LitBy::Table(layout) => header(language, layout),
        LitBy::Normals => normals_header(language),
        LitBy::Gaussian(_) => gaussians_header(language),
        LitBy::GaussianTable(_, layout) => gaussians_table_header(language, layout),
    }
}
