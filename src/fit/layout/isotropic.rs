//! The layouts of isotropic tables. Engines read `ltc2017`, `ltc2016`, `godot` and `hdrp`. Layouts `inverse` and
//! `matrix33` are only for comparison; no engine reads them.
//!
//! All are tables over perceptual roughness `u = sqrt(alpha)`, from 0 to 1, and the view's polar angle, from the normal
//! to the horizon. Nodes are evenly spaced in `u`, and in theta or `sqrt(1 - cos theta)`. Ratio and phi have one node.
//! The lobe is symmetric about the plane of incidence, so five numbers of a matrix are not zero:
//!
//! ```text
//!     | m00  0  m02 |
//! M = |  0  m11  0  |,   and M^-1 has the same form
//!     | m20  0  m22 |
//! ```
//!
//! A lookup interpolates the stored numbers between the four nodes around a point, as an engine's sampler does. It
//! inverts the result if `M^-1` is stored.
//!
//! Nodes are at the texel centres of the engines; `inverse` and `matrix33` have the nodes of `ltc2017`. The first
//! roughness is 0, and the last view is at the horizon. The lobes of these nodes are fitted at the smallest roughness
//! and the most grazing view that the fit allows.

use std::f64::consts::FRAC_PI_2;

use glam::{DMat3, DVec3, Mat3, Vec3};

use super::{
    precision::Precision,
    rules::{FreeNumbers, Interpolation, LayoutRules, LayoutShader, LobeNumbers, ShaderNumbers},
    shader_axes::{ShaderAxes, ShaderPlace},
    spacing::Spacing,
};
use crate::{
    axes::PerAxis,
    brdf::{LobeTerms, Mirrors},
    lobe::ltc::align,
    math::quadrant,
};

/// Nodes are evenly spaced in `sqrt(1 - cos theta)`. Stores `M^-1` divided by its middle element.
pub(super) const LTC2017: Isotropic = Isotropic {
    stored: Stored::InverseOver { divisor: [1, 1] },
    side: 64,
    theta: Spacing::Versine,
    number: 2,
    interpolation: [0.045, 6.0, 17.0],
};
/// Nodes are evenly spaced in theta. Stores `M^-1` divided by its first element.
pub(super) const LTC2016: Isotropic = Isotropic {
    stored: Stored::InverseOver { divisor: [0, 0] },
    side: 32,
    theta: Spacing::Even,
    number: 3,
    interpolation: [0.04, 11.0, 11.0],
};
/// Nodes are evenly spaced in theta. Stores `M` with a third column of unit length.
pub(super) const GODOT: Isotropic =
    Isotropic { stored: Stored::Matrix, side: 64, theta: Spacing::Even, number: 4, interpolation: [0.039, 5.4, 2.1] };
/// Nodes are evenly spaced in `sqrt(1 - cos theta)`. Stores `M^-1` divided by its last element.
pub(super) const HDRP: Isotropic = Isotropic {
    stored: Stored::InverseOver { divisor: [2, 2] },
    side: 64,
    theta: Spacing::Versine,
    number: 5,
    interpolation: [0.05, 14.0, 4.0],
};
/// Nodes are evenly spaced in `sqrt(1 - cos theta)`. Stores the inverse of an `M` with a third column of unit length.
///
/// The error is assumed to depend on the nodes as in [`HDRP`]. With 64 x 64 nodes, the measured error is two thirds of
/// the prediction.
pub(super) const INVERSE: Isotropic = Isotropic {
    stored: Stored::Inverse,
    side: 64,
    theta: Spacing::Versine,
    number: 6,
    interpolation: [0.05, 14.0, 4.0],
};
/// Nodes are evenly spaced in `sqrt(1 - cos theta)`. Stores `M` divided by its last element.
///
/// The error is assumed to depend on the nodes as in [`HDRP`]. The prediction is right for 64 x 64 nodes and too small
/// for fewer nodes.
pub(super) const MATRIX33: Isotropic = Isotropic {
    stored: Stored::MatrixOverLast,
    side: 64,
    theta: Spacing::Versine,
    number: 7,
    interpolation: [0.05, 14.0, 4.0],
};

/// The form in which an entry stores `M`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Stored {
    /// `M` with a third column of unit length.
    Matrix,
    /// `M` divided by its last element.
    MatrixOverLast,
    /// The inverse of an `M` with a third column of unit length.
    Inverse,
    /// `M^-1`, divided by its element at this column and row.
    InverseOver { divisor: [usize; 2] },
}

impl Stored {
    fn is_inverse(self) -> bool {
        match self {
            Self::Matrix | Self::MatrixOverLast => false,
            Self::Inverse | Self::InverseOver { .. } => true,
        }
    }
}

/// A layout of isotropic tables.
pub(super) struct Isotropic {
    stored: Stored,
    /// Texels along each side of the engines' tables.
    side: u32,
    /// The spacing of the theta nodes and of the interpolation weights in theta.
    theta: Spacing,
    number: u32,
    /// The limit, and the errors that steps of alpha and theta add: see [`Interpolation`].
    interpolation: [f64; 3],
}

/// The largest stored number, within the range of half floats. In some layouts, sharp lobes near the horizon would have
/// larger numbers.
const MOST: f64 = 60_000.0;

impl Isotropic {
    /// The smallest number on the diagonal of a stored matrix. The number format stores it without a loss of precision.
    fn least(precision: Precision) -> f64 {
        match precision {
            Precision::F32 => 1e-30,
            Precision::F16 => 1.0 / 16_384.0,
        }
    }
}

impl LayoutRules for Isotropic {
    /// The size of the engines' tables.
    fn default_resolution(&self) -> PerAxis<u32> {
        PerAxis { alpha: self.side, ratio: 1, theta: self.side, phi: 1 }
    }

    fn spacing(&self) -> PerAxis<Spacing> {
        PerAxis { alpha: Spacing::Squared, ratio: Spacing::Even, theta: self.theta, phi: Spacing::Even }
    }

    fn nodes(&self, range: &PerAxis<[f64; 2]>, n: &PerAxis<u32>) -> PerAxis<Vec<f64>> {
        let PerAxis { alpha, ratio, theta, phi } = self.spacing();
        PerAxis {
            alpha: alpha.divide(range.alpha, n.alpha),
            ratio: ratio.divide(range.ratio, n.ratio),
            theta: theta.divide(range.theta, n.theta),
            phi: phi.divide(range.phi, n.phi),
        }
    }

    fn only_ranges(&self) -> Option<PerAxis<[f64; 2]>> {
        Some(PerAxis { alpha: [0.0, 1.0], ratio: [1.0, 1.0], theta: [0.0, FRAC_PI_2], phi: [0.0, 0.0] })
    }

    fn weights(&self) -> PerAxis<Spacing> {
        self.spacing()
    }

    fn place_in_shader(&self, axes: &ShaderAxes, alpha: f32, _: f32, wo: Vec3) -> ShaderPlace {
        let theta = match self.theta {
            Spacing::Versine => (wo.truncate().length_squared() / (1.0 + wo.z.max(0.0))).sqrt(),
            _ => quadrant(wo.truncate().length(), wo.z),
        };
        axes.place([alpha.sqrt(), axes.start[1], theta, axes.start[3]])
    }

    fn flattest(&self, precision: Precision) -> f64 {
        match precision {
            Precision::F32 => 1e-5,
            Precision::F16 => 1.0 / 256.0,
        }
    }

    fn store(&self, place: &PerAxis<f64>, lobe: &LobeNumbers, mirrors: Mirrors, precision: Precision) -> LobeNumbers {
        let m = align(&lobe.matrix, mirrors, self.flattest(precision));
        let matrix = if self.stored.is_inverse() { inverse(&m) } else { m };
        let matrix = matrix * (1.0 / self.norm(&matrix));
        self.limited(LobeNumbers { matrix, terms: self.store_terms(place, lobe.terms) }, precision)
    }

    fn free_numbers(&self) -> Option<FreeNumbers> {
        let fixed = match self.stored {
            Stored::Matrix | Stored::Inverse => None,
            Stored::MatrixOverLast => Some([2, 2]),
            Stored::InverseOver { divisor } => Some(divisor),
        };
        Some(FreeNumbers { is_inverse: self.stored.is_inverse(), fixed })
    }

    fn limited(&self, mut stored: LobeNumbers, precision: Precision) -> LobeNumbers {
        let least = Self::least(precision);
        for axis in 0..3 {
            let column = stored.matrix.col_mut(axis);
            *column = column.clamp(DVec3::splat(-MOST), DVec3::splat(MOST));
            column[axis] = column[axis].max(least);
        }
        stored
    }

    fn norm(&self, stored: &DMat3) -> f64 {
        match self.stored {
            Stored::Matrix => stored.z_axis.length(),
            Stored::MatrixOverLast => stored.z_axis.z,
            // The reciprocal of the length of the inverse's third column, (-b, 0, a) / (a d - b e).
            Stored::Inverse => {
                let (a, e, b, d) = (stored.x_axis.x, stored.x_axis.z, stored.z_axis.x, stored.z_axis.z);
                (a * d - b * e).abs() / (a * a + b * b).sqrt()
            }
            Stored::InverseOver { divisor: [column, row] } => stored.col(column)[row],
        }
    }

    fn store_terms(&self, _: &PerAxis<f64>, terms: LobeTerms) -> LobeTerms {
        terms
    }

    fn restore(&self, _: &PerAxis<f64>, stored: &LobeNumbers) -> LobeNumbers {
        let matrix = if self.stored.is_inverse() { inverse(&stored.matrix) } else { stored.matrix };
        LobeNumbers { matrix, terms: stored.terms }
    }

    fn restore_in_shader(&self, stored: &ShaderNumbers, _: f32, _: f32, _: Vec3) -> ShaderNumbers {
        let Mat3 { x_axis: x, y_axis: y, z_axis: z } = stored.matrix;
        // Keeps the numbers in the plane of incidence, and the number perpendicular to the plane.
        let plane = Mat3::from_cols(Vec3::new(x.x, 0.0, x.z), Vec3::Y * y.y, Vec3::new(z.x, 0.0, z.z));
        let matrix = if self.stored.is_inverse() { inverse_in_shader(&plane) } else { plane };
        ShaderNumbers { matrix, ..*stored }
    }

    // Measured on tables of 12 to 64 nodes per axis, fitted with 64 samples and 8 directions. A few lobes near the
    // smallest roughness and near the horizon cause most of the error of coarse tables, so predictions are accurate
    // only to a factor of two.
    fn interpolation(&self) -> Interpolation {
        let [limit, alpha, theta] = self.interpolation;
        Interpolation { limit, step: PerAxis { alpha, ratio: 0.0, theta, phi: 0.0 } }
    }

    fn shader(&self) -> LayoutShader {
        LayoutShader {
            sources: &[ltcforge_wgsl::LAYOUT_ISOTROPIC],
            restore: if self.stored.is_inverse() { "ltc_restore_inverse" } else { "ltc_restore_matrix" },
            place: match self.theta {
                Spacing::Versine => "ltc_steps_versine",
                _ => "ltc_steps_roughness",
            },
            is_isotropic: true,
            number: self.number,
        }
    }
}

/// The inverse of a matrix that is symmetric about the plane of incidence, with a third column of unit length:
///
/// ```text
/// | d   0   -b |
/// | 0  det/c 0 | / sqrt(b^2 + a^2),   det = a d - b e,   of   | a 0 b |
/// | -e  0    a |                                              | 0 c 0 |
///                                                             | e 0 d |
/// ```
fn inverse(n: &DMat3) -> DMat3 {
    let (a, e, b, c, d) = (n.x_axis.x, n.x_axis.z, n.z_axis.x, n.y_axis.y, n.z_axis.z);
    let scale = 1.0 / (a * a + b * b).sqrt();
    DMat3::from_cols_array(&[d, 0.0, -e, 0.0, (a * d - b * e) / c, 0.0, -b, 0.0, a]) * scale
}

/// [`inverse`] in f32.
fn inverse_in_shader(n: &Mat3) -> Mat3 {
    let (a, e, b, c, d) = (n.x_axis.x, n.x_axis.z, n.z_axis.x, n.y_axis.y, n.z_axis.z);
    let scale = 1.0 / (a * a + b * b).sqrt();
    Mat3::from_cols_array(&[d, 0.0, -e, 0.0, (a * d - b * e) / c, 0.0, -b, 0.0, a]) * scale
}
