//! Tables, BRDFs and polygons with known numbers, for tests of other crates.

pub use super::{
    brdf::{planted_anisotropic, planted_tabulated},
    lobe::ltc::cases::{self, mirror_like, quadrature as polygon_quadrature, random_cases},
    table::planted_isotropic,
};
