//! An LTC of anisotropic GGX by a formula, without a table. `docs/formula.md` derives it.
//!
//! A light direction `w` and a view `o` have the half vector `h ~ w + |w| o`. Stretched by `A^-1`, GGX's visible normals
//! are nearly a clamped cosine around the central visible normal `c`. The map from `w` to the stretched normal is linear
//! except for `|w|`. `rho . w` replaces `|w|`: its tangent at the direction `r` in which `c` reflects the view.
//!
//! ```text
//! M^-1 = U R^T A^-1 (I + o rho^T),   A = diag(alpha_x, alpha_y, 1),   R: the least rotation from z to c
//! ```
//!
//! `U` and the corrections of `rho` are small polynomials. Their coefficients come from a search (`ltcforge-studies --
//! formula`).

mod model;
mod numbers;

use super::CosineSpace;
use crate::normals::view::View;
use ltcforge_fit::math::{Scalar, Triple, cross, dot, plus, scaled, unit};

pub(crate) use model::FormulaModel;
pub use numbers::COEFFICIENTS;

/// Inputs of the polynomials. Each term is a coefficient times two inputs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Feature {
    /// The number one.
    One,
    /// The larger roughness.
    Larger,
    /// The smaller roughness.
    Smaller,
    /// The roughness along the axis of the row.
    Axis,
    /// The view's height in the space where the surface is a hemisphere.
    Mu,
    /// The length of the stretched view.
    Length,
    /// The cosine of the angle of incidence at the central visible normal.
    Cosine,
    /// The weight of shadowing, G2 / G1, at `r`.
    Weight,
    /// The height of `r` in the space where the surface is a hemisphere.
    Rise,
    /// The fraction of the reflected light due to Schlick's `(f90 - f0)` term.
    Share,
}

/// Number of inputs.
const FEATURES: usize = 10;

/// The polynomials, in the order of their coefficients.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Polynomial {
    /// The logarithm of the stretch of a row of `U`.
    Stretch,
    /// The tilt of a row of `U`.
    Tilt,
    /// The stretch of `U` along the plane of `c`.
    Along,
    /// The last row of `U`.
    Row,
    /// Scale of `r` in `rho`, minus one, divided by the larger roughness.
    Swell,
    /// Offset of `rho` along z, divided by the larger roughness and by `1 - c.z`.
    Lift,
    /// Correction of the amplitude, divided by the larger roughness.
    ByLarger,
    /// Correction of the amplitude, divided by the smaller roughness.
    BySmaller,
    /// The base of Schlick's power, plus the cosine. Nearly one for smooth surfaces.
    Incidence,
}

use Feature::{Axis, Cosine, Larger, Length, Mu, One, Rise, Share, Smaller, Weight};

impl Polynomial {
    /// All polynomials, in the order of their coefficients.
    pub const ALL: [Self; 9] = [
        Self::Stretch,
        Self::Tilt,
        Self::Along,
        Self::Row,
        Self::Swell,
        Self::Lift,
        Self::ByLarger,
        Self::BySmaller,
        Self::Incidence,
    ];

    /// The terms of the polynomial: products of two inputs.
    #[must_use]
    pub const fn products(self) -> &'static [[Feature; 2]] {
        match self {
            Self::Stretch => &[[Axis, Axis], [Axis, Mu], [Axis, Smaller], [Axis, Larger], [Axis, One]],
            Self::Tilt => {
                &[[Axis, Axis], [Axis, Mu], [Mu, One], [Cosine, Length], [Cosine, Rise], [Rise, One], [Share, One]]
            }
            Self::Along => {
                &[[Larger, Larger], [Larger, One], [Mu, Mu], [Weight, One], [Rise, One], [Share, Rise], [Share, One]]
            }
            Self::Row => &[[One, One], [Rise, One], [Mu, One], [Length, Cosine], [Length, One], [Weight, One]],
            Self::Swell => {
                &[[Larger, Length], [Larger, Cosine], [Smaller, Length], [Mu, Cosine], [Length, Rise], [Length, One]]
            }
            Self::Lift => &[[Mu, Mu], [Rise, Rise], [Share, Cosine], [Share, One]],
            Self::ByLarger => {
                &[[Larger, Larger], [Larger, Weight], [Smaller, Smaller], [Mu, Mu], [Mu, Rise], [One, One]]
            }
            Self::BySmaller => &[[Larger, Mu], [Smaller, Mu], [Smaller, Rise], [Smaller, One], [Rise, One], [One, One]],
            Self::Incidence => &[
                [Mu, Weight],
                [Mu, Smaller],
                [Mu, One],
                [Smaller, Cosine],
                [Smaller, Smaller],
                [Larger, Length],
                [Weight, One],
            ],
        }
    }

    /// The index of its first coefficient.
    #[must_use]
    pub const fn start(self) -> usize {
        let (mut i, mut start) = (0, 0);
        while Self::ALL[i] as usize != self as usize {
            start += Self::ALL[i].products().len();
            i += 1;
        }
        start
    }
}

/// Number of coefficients.
pub const COUNT: usize = Polynomial::Incidence.start() + Polynomial::Incidence.products().len();

/// The inputs for a surface and view.
struct Features<T>([T; FEATURES]);

impl<T: Scalar> Features<T> {
    fn at(&self, feature: Feature) -> T {
        self.0[feature as usize]
    }

    fn with(mut self, feature: Feature, value: T) -> Self {
        self.0[feature as usize] = value;
        self
    }

    fn sum(&self, polynomial: Polynomial, numbers: &[f64; COUNT]) -> T {
        let products = polynomial.products().iter().zip(&numbers[polynomial.start()..]);
        products.fold(T::ZERO, |sum, ([a, b], number)| sum + T::of(*number) * self.at(*a) * self.at(*b))
    }
}

/// The lobe of a surface seen from one direction.
#[derive(Debug, Clone, Copy)]
pub struct FormulaLobe<T> {
    /// The map to the space of the clamped cosine.
    pub space: CosineSpace<T>,
    /// The reflected part of uniform light: for a Fresnel factor of one, and weighted by Schlick's factor.
    pub parts: [T; 2],
}

impl<T: Scalar> FormulaLobe<T> {
    /// The lobe of a material with reflectance `f0` at normal and `f90` at grazing incidence. Equal numbers give the
    /// lobe for a Fresnel factor of one. Domain: `alpha` in [1e-5, 1]; `wo` of unit length. `wo.z` is raised to 1e-4.
    #[must_use]
    pub fn new(alpha: [T; 2], wo: Triple<T>, fresnel: [T; 2]) -> Self {
        Self::by(&COEFFICIENTS, alpha, wo, fresnel)
    }

    /// The lobe with other coefficients.
    #[must_use]
    pub fn by(numbers: &[f64; COUNT], alpha: [T; 2], wo: Triple<T>, [f0, f90]: [T; 2]) -> Self {
        let wo = [wo[0], wo[1], wo[2].max(T::of(1e-4))];
        let view = View::new(alpha, wo);
        let mu = wo[2] / view.length;
        let stretched = scaled(view.stretched, T::ONE / view.length);
        let c = unit([stretched[0], stretched[1], stretched[2] + T::ONE]);
        let h = unit([alpha[0] * c[0], alpha[1] * c[1], c[2]]);
        let cosine = dot(wo, h);
        let r = plus(scaled(h, cosine + cosine), scaled(wo, -T::ONE));
        let up = r[2].max(T::of(1e-4));
        let image = [alpha[0] * r[0], alpha[1] * r[1], r[2]];
        let rise = up / dot(image, image).sqrt();
        let weight = (T::ONE + mu) * rise / (rise + mu);
        let larger = alpha[0].max(alpha[1]);
        let mut features = Features([T::ZERO; FEATURES])
            .with(One, T::ONE)
            .with(Larger, larger)
            .with(Smaller, alpha[0].min(alpha[1]))
            .with(Mu, mu)
            .with(Length, view.length)
            .with(Cosine, cosine)
            .with(Weight, weight)
            .with(Rise, rise);
        let sum = |features: &Features<T>, polynomial| features.sum(polynomial, numbers);
        let [by_larger, by_smaller] = [Polynomial::ByLarger, Polynomial::BySmaller].map(|part| sum(&features, part));
        let correction = larger * by_larger + features.at(Smaller) * by_smaller;
        let amplitude = (weight * weight + correction).max(T::ZERO).min(T::ONE);
        let incidence = (sum(&features, Polynomial::Incidence) - cosine).max(T::ZERO).min(T::ONE);
        let square = incidence * incidence;
        let schlick = amplitude * (square * square * incidence);
        let weighed = (f90 - f0).max(T::ZERO) * schlick;
        features = features.with(Share, weighed / (f0 * amplitude + weighed).max(T::of(1e-30)));

        let swell = T::ONE + larger * sum(&features, Polynomial::Swell);
        let lift = larger * sum(&features, Polynomial::Lift) * (T::ONE - c[2]);
        let mut rho = scaled(r, swell);
        rho[2] = rho[2] + lift;
        // The determinant is a multiple of 1 + rho . o. Without corrections, it is 2 cosine^2.
        let lacking = cosine * cosine - (T::ONE + dot(rho, wo));
        let rho = plus(rho, scaled(wo, lacking.max(T::ZERO)));
        // The columns of R; the third is c.
        let k = T::ONE / (T::ONE + c[2]);
        let xy = -(c[0] * c[1] * k);
        let columns = [[T::ONE - c[0] * c[0] * k, xy, -c[0]], [xy, T::ONE - c[1] * c[1] * k, -c[1]]];
        let [along, last] = [Polynomial::Along, Polynomial::Row].map(|polynomial| sum(&features, polynomial));
        let upper = |axis: usize| {
            let features = Features(features.0).with(Axis, alpha[axis]);
            let tilt = c[axis] * sum(&features, Polynomial::Tilt);
            let mut row = [along * c[axis] * c[0], along * c[axis] * c[1], tilt];
            row[axis] = row[axis] + sum(&features, Polynomial::Stretch).exp();
            row
        };
        let u = [upper(0), upper(1), [last * c[0], last * c[1], T::ONE]];
        let rows = u.map(|[x, y, z]| {
            let [x, y, z] = plus(plus(scaled(columns[0], x), scaled(columns[1], y)), scaled(c, z));
            let row = [x / alpha[0], y / alpha[1], z];
            plus(row, scaled(rho, dot(row, wo)))
        });
        // The determinant of the rows would be lost in rounding errors for sharp lobes.
        let determinant = dot(u[2], cross(u[0], u[1])) / (alpha[0] * alpha[1]) * (T::ONE + dot(rho, wo));
        Self { space: CosineSpace::with_determinant(rows, determinant), parts: [amplitude, schlick] }
    }
}
