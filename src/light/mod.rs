//! What a surface reflects of an area light, by each model: a table of LTCs, or the closed form in the space of normals;
//! and the truth, by quadrature.
//!
//! Invariant: `light` fits nothing and reads no file.

pub mod normals;

use crate::fit::named_list::named_list;

named_list! {
    /// What stands for GGX where it is lit.
    pub enum LightModel {
        /// A table of Linearly Transformed Cosines.
        Ltc = "ltc",
        /// The closed form in the space of normals.
        Normals = "normals",
    }
}
