//! How configurations map to entries, and how a stored matrix maps to `M`.

use serde::{Deserialize, Serialize};

/// The layouts a table can be fitted for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Layout {
    /// Uniform axes; `M` with a third column of unit length [KT et al. 2022, sections 6 to 8].
    Kt2022,
    /// Nodes denser where lobes change faster; the matrix between the lobe and its [`super::Reflection`], with a third
    /// column of unit length, and terms in proportion to the reflection's.
    Reflected,
}
