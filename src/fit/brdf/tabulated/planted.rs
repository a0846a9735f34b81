//! A known BRDF as numbers.

use std::sync::Arc;

use super::{TabulatedAxes, TabulatedBrdf};
use crate::brdf::{BrdfKind, BrdfModel, TabulatedFile};

/// Oren-Nayar's reflection as numbers.
///
/// # Panics
/// Never: the numbers are valid.
#[must_use]
pub fn planted() -> BrdfModel {
    let brdf = TabulatedBrdf::tabulate(BrdfKind::OrenNayar, TabulatedAxes::spread(vec![0.05, 0.3, 1.0], 48, 24))
        .expect("a BRDF");
    BrdfModel::tabulated(TabulatedFile::new([7; 32], Arc::new(brdf)))
}
