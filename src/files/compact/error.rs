//! Errors of compact forms.

use ltcforge_fit::{BrdfKind, LobeModel};

/// The table has no compact form, or the bytes are not a compact form.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum CompactError {
    /// The bytes do not begin with the magic bytes.
    #[error("not a compact table of version 1")]
    Magic,
    /// The bytes end too early.
    #[error("the bytes end too early")]
    Short,
    /// There are bytes after the end.
    #[error("{bytes} bytes follow the end")]
    Long {
        /// The number of bytes.
        bytes: usize,
    },
    /// A field of the header is invalid.
    #[error("{field} is {value}; allowed: {allowed}")]
    Field {
        /// The name of the field.
        field: String,
        /// The value of the field.
        value: String,
        /// The allowed values.
        allowed: String,
    },
    /// The nodes are not those that the table's layout has over a range.
    #[error("the nodes of {axis} are not those of layout {layout} from {low} to {high}")]
    Nodes {
        /// The axis.
        axis: &'static str,
        /// The layout of the table.
        layout: String,
        /// The first node.
        low: String,
        /// The last node.
        high: String,
    },
    /// The readers of the layout need more digits than the steps provide.
    #[error(
        "layout {layout} has no compact form: it scales the matrices of sharp surfaces by numbers that nearly vanish; \
         layouts reflected, kt2022 and ltc2017 have one"
    )]
    Layout {
        /// The layout.
        layout: String,
    },
    /// The form stores lobes relative to a reflection, and the lobes of the scattering model do not follow it.
    #[error("the compact form stores lobes relative to the reflection, but lobes of brdf {brdf} do not follow it")]
    Reflection {
        /// The scattering model.
        brdf: BrdfKind,
    },
    /// There is no decoder for the lobe model.
    #[error(
        "the compact form supports lobe ltc, but the table has lobe {lobe}: use the table file or textures instead"
    )]
    Lobe {
        /// The lobe model.
        lobe: LobeModel,
    },
    /// The numbers of a channel are too large.
    #[error("channel {channel} has a number that is too large for its steps")]
    Large {
        /// The number of the channel.
        channel: usize,
    },
    /// Some matrices have a determinant that is not positive. The form cannot store them.
    #[error(
        "{count} entries have matrices whose determinant is not positive, which the compact form cannot store; the first is \
         entry {entry}, {place}"
    )]
    Determinants {
        /// The number of these entries.
        count: usize,
        /// The index of the first of these entries.
        entry: usize,
        /// The place of the first of these entries.
        place: String,
    },
    /// The form is too inaccurate even with the finest steps.
    #[error(
        "with the finest steps, the mean error between nodes grows from {table} to {decoded} of the lobe's width; at most \
         1 % more is allowed"
    )]
    Inexact {
        /// The error of the table.
        table: String,
        /// The error of the form.
        decoded: String,
    },
    /// An entry has a number that is not finite.
    #[error("entry {entry} has a number that is not finite")]
    Entry {
        /// The index of the entry.
        entry: usize,
    },
}

impl CompactError {
    pub(super) fn field(field: String, value: &dyn std::fmt::Display, allowed: &str) -> Self {
        Self::Field { field, value: value.to_string(), allowed: allowed.to_owned() }
    }
}
