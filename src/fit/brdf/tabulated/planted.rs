//! Known BRDFs in tabulated form.

use std::sync::{Arc, LazyLock};

use super::{TabulatedAxes, TabulatedBrdf};
use crate::brdf::{BrdfKind, BrdfModel, TabulatedFile};

/// A tabulated Oren-Nayar reflection.
///
/// # Panics
/// Never: the values are valid.
#[must_use]
pub fn planted() -> BrdfModel {
    let brdf = TabulatedBrdf::tabulate(BrdfKind::OrenNayar, TabulatedAxes::spread(vec![0.05, 0.3, 1.0], 48, 24))
        .expect("a BRDF");
    BrdfModel::tabulated(TabulatedFile::new([7; 32], Arc::new(brdf)))
}

/// A tabulated anisotropic GGX with two roughnesses and two ratios.
///
/// # Panics
/// Never: the values are valid.
#[must_use]
pub fn planted_anisotropic() -> BrdfModel {
    static PLANTED: LazyLock<BrdfModel> = LazyLock::new(|| {
        let axes = TabulatedAxes::spread(vec![0.4, 1.0], 32, 13).with_azimuths(vec![0.5, 1.0], 9);
        let brdf = TabulatedBrdf::tabulate(BrdfKind::Ggx, axes).expect("a BRDF");
        BrdfModel::tabulated(TabulatedFile::new([9; 32], Arc::new(brdf)))
    });
    PLANTED.clone()
}
