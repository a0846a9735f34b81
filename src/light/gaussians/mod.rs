//! The light of GGX from one Gaussian on the sphere, without a table. It is the cheapest and the coarsest model.
//!
//! The lobe is one spherical Gaussian, round or stretched, times one weight for shadowing and one Fresnel factor [Wang
//! et al. 2009; Xu et al. 2013; Pettineo 2016, «SG Series Part 4»]:
//!
//! ```text
//! f(w) cos w  ~  W / (pi a1 a2) exp(-x^2 - y^2),    (x, y) = d in the basis t1, t2 of the plane,
//! d = w_p sqrt(2 / (1 + w . r)),   w_p = w - (w . r) r
//! ```
//!
//! `r` is the reflection of the view at a central normal. `t1` and `t2` are the movements of the reflection if this
//! normal tilts by one standard deviation. If they are perpendicular, their lengths are `a1` and `a2`. `d` is the
//! equal-area projection around `r`, of length `2 sin(angle / 2)`. In this projection, a spherical Gaussian
//! `exp(L (w . r - 1))` is exactly a Gaussian of the plane, with `L = 2 / a^2` (`lobe.rs`, `fit::lobe::gaussian`). The
//! error function maps the plane to a square, and a polygon's part of the Gaussian is an area there
//! (`fit::lobe::gaussian::covered`). The light of a spherical Gaussian is a convolution of two Gaussians
//! (`sg_light.rs`). `studies/gaussians.md` has the derivation and the errors.

mod lobe;
mod model;
mod sg_light;
#[cfg(test)]
mod tests;

pub use lobe::{Lobe, Warp};
pub(crate) use model::{ASG, SG};
pub use model::{by_gaussian, by_warp};
pub use sg_light::{SgLight, reflected_sg, reflected_sg_by};

pub use ltcforge_fit::lobe::gaussian::{Gaussian, SphericalGaussian};

use ltcforge_fit::{
    Sides,
    lobe::gaussian::covered,
    math::{Scalar, Triple},
};

/// The light of a polygon of radiance one that GGX reflects towards `wo`, computed with a Gaussian. Returns the light
/// for a Fresnel factor of one and the light weighted by Schlick's `(1 - wo . h)^5`, both in [0, 1].
///
/// The vertices of the convex polygon are relative to the shaded point in its tangent frame, normal +z. They run
/// clockwise as seen from the lit side. The part below the surface is cut off. Domain: `alpha` in [1e-5, 1], `wo` of
/// unit length with `z > 0`, finite vertices.
#[must_use]
pub fn reflected<T: Scalar>(
    gaussian: Gaussian,
    alpha: [T; 2],
    wo: Triple<T>,
    vertices: &[Triple<T>],
    sides: Sides,
) -> [T; 2] {
    reflected_around(Warp::Visible, gaussian, (alpha, wo), vertices, sides)
}

/// Like [`reflected`], with the Gaussian of a warp.
pub(crate) fn reflected_around<T: Scalar>(
    warp: Warp,
    gaussian: Gaussian,
    (alpha, wo): ([T; 2], Triple<T>),
    vertices: &[Triple<T>],
    sides: Sides,
) -> [T; 2] {
    let lobe = Lobe::new(gaussian, warp, alpha, wo);
    let covered = covered(&lobe.shape, vertices, sides);
    lobe.parts().map(|part| part * covered)
}

/// The reflected light of a polygon, like [`reflected`], for a given Gaussian. `parts` is the reflected light from all
/// directions of its plane together, for a Fresnel factor of one and weighted by Schlick's factor.
///
/// A table's Gaussian is cut at the horizon, so the first part can exceed one. The reflected light cannot.
#[must_use]
pub fn reflected_by<T: Scalar>(
    shape: &SphericalGaussian<T>,
    parts: [T; 2],
    vertices: &[Triple<T>],
    sides: Sides,
) -> [T; 2] {
    let covered = covered(shape, vertices, sides).min(T::ONE / parts[0].max(T::ONE));
    parts.map(|part| part * covered)
}
