//! Why a table has no compact form, or bytes are no compact form.

use ltcforge_fit::{BrdfKind, LobeModel};

/// Why a table has no compact form, or bytes are no compact form.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum CompactError {
    /// Other bytes at the beginning.
    #[error("not a compact table of version 1")]
    Magic,
    /// The bytes end too early.
    #[error("the bytes end too early")]
    Short,
    /// Bytes after the end.
    #[error("{bytes} bytes follow the end")]
    Long {
        /// How many.
        bytes: usize,
    },
    /// A field of the header that no table has.
    #[error("{field} is {value}; allowed: {allowed}")]
    Field {
        /// Which.
        field: String,
        /// Its value.
        value: String,
        /// The allowed values.
        allowed: String,
    },
    /// Nodes that are not those of the table's layout over a range.
    #[error("the nodes of {axis} are not those of layout {layout} from {low} to {high}")]
    Nodes {
        /// The axis.
        axis: &'static str,
        /// The table's layout.
        layout: String,
        /// The first node.
        low: String,
        /// The last node.
        high: String,
    },
    /// A layout whose readers need more digits than the steps leave.
    #[error(
        "layout {layout} has no compact form: it scales the matrices of sharp surfaces by numbers that nearly vanish; \
         layouts reflected, kt2022 and ltc2017 have one"
    )]
    Layout {
        /// The layout.
        layout: String,
    },
    /// A scattering model whose lobes are not near the reflection that the form stores them relative to.
    #[error("the compact form stores lobes relative to a reflection, which those of brdf {brdf} do not follow")]
    Reflection {
        /// The scattering model.
        brdf: BrdfKind,
    },
    /// A lobe model without decoders.
    #[error(
        "the compact form is for lobe ltc, and the table has lobe {lobe}: its file and its textures serve in place"
    )]
    Lobe {
        /// The lobe model.
        lobe: LobeModel,
    },
    /// A channel whose numbers are too large.
    #[error("channel {channel} has a number that is too large to be rounded to steps")]
    Large {
        /// Its number.
        channel: usize,
    },
    /// Entries whose determinants are not positive, of which the form has none.
    #[error(
        "{count} entries have matrices whose determinant is not positive, which the compact form cannot hold; the first is \
         entry {entry}, {place}"
    )]
    Determinants {
        /// How many.
        count: usize,
        /// The index of the first.
        entry: usize,
        /// Where it is.
        place: String,
    },
    /// A table that the form does not come near to, however fine its steps.
    #[error(
        "with the finest steps the mean error between nodes is {decoded} of the lobe's width, of the table {table}; at most \
         1 % more is allowed"
    )]
    Inexact {
        /// The table's error.
        table: String,
        /// That of the form.
        decoded: String,
    },
    /// An entry whose numbers are not finite.
    #[error("entry {entry} has a number that is not finite")]
    Entry {
        /// Its index.
        entry: usize,
    },
}

impl CompactError {
    pub(super) fn field(field: String, value: &dyn std::fmt::Display, allowed: &str) -> Self {
        Self::Field { field, value: value.to_string(), allowed: allowed.to_owned() }
    }
}
