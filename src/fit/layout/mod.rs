//! Layouts, one file each: where a table's nodes lie, what an entry stores of its lobe, and how a lookup undoes that.
//!
//! A new layout needs a file, a part of the shader, and a line in [`Layout`].
//!
//! Invariant: a layout knows nothing of how a lobe was fitted.

mod kt2022;
mod precision;
mod reflected;
mod reflection;
mod rules;
mod spacing;

pub use precision::Precision;
pub use reflection::Reflection;
#[cfg(feature = "render")]
pub(crate) use rules::ShaderNumbers;
pub(crate) use rules::{Interpolation, LayoutRules, LobeNumbers};
pub use spacing::{ALPHA_FLOOR, RATIO_FLOOR, THETA_CEILING};

use super::{axes::PerAxis, named_list::named_list};

named_list! {
    /// How configurations map to entries, and how a stored matrix maps to `M`.
    pub enum Layout: LayoutRules {
        /// Nodes denser where lobes change faster; the matrix between the lobe and its [`Reflection`], with a third
        /// column of unit length, and terms in proportion to the reflection's.
        Reflected = "reflected" => reflected::Rules,
        /// Uniform axes; `M` with a third column of unit length [KT et al. 2022, sections 6 to 8].
        Kt2022 = "kt2022" => kt2022::Rules,
    }
}

impl Layout {
    /// Ascending nodes of each axis for a range and a resolution.
    #[must_use]
    pub fn nodes(self, range: &PerAxis<[f64; 2]>, resolution: &PerAxis<u32>) -> PerAxis<Vec<f64>> {
        self.rules().nodes(range, resolution)
    }

    /// The step between neighbouring nodes of each axis, in the variable in which they are evenly spaced, as a part of
    /// the whole domain: 1 for two nodes at the domain's ends, 0 for a single node.
    pub(crate) fn steps(self, range: &PerAxis<[f64; 2]>, resolution: &PerAxis<u32>) -> PerAxis<f64> {
        spacing::steps(&self.rules().spacing(), range, resolution)
    }
}
