//! The light of a spherical Gaussian.

use super::{Gaussian, Lobe, SphericalGaussian, Warp};
use ltcforge_fit::math::{Scalar, Triple, dot};

/// A light of radiance `amplitude exp(sharpness (w . axis - 1))`, as lightmaps and probes store it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SgLight<T> {
    /// The direction of its centre in the tangent frame of the surface, of unit length.
    pub axis: Triple<T>,
    /// The sharpness, above 0.
    pub sharpness: T,
    /// The radiance at its centre.
    pub amplitude: T,
}

/// The light of a spherical Gaussian that GGX reflects towards `wo`, computed with a Gaussian. Returns the light for a
/// Fresnel factor of one and the light weighted by Schlick's `(1 - wo . h)^5`.
///
/// The whole sphere counts, including directions below the surface. Domain: as for [`super::reflected`]; a sharpness
/// above 0.
#[must_use]
pub fn reflected_sg<T: Scalar>(gaussian: Gaussian, alpha: [T; 2], wo: Triple<T>, light: &SgLight<T>) -> [T; 2] {
    let lobe = Lobe::new(gaussian, Warp::Visible, alpha, wo);
    reflected_sg_by(&lobe.shape, lobe.parts(), light)
}

/// The reflected light of a spherical Gaussian, like [`reflected_sg`], for a given Gaussian. `parts` is the reflected
/// light from all directions together.
///
/// In the plane around the Gaussian's axis, the light is `exp(-L d^2 / 2)` around its own centre `d`, and the inner
/// product is the value of the convolution there. With `X` the rows of the Gaussian, `v = X d` and
/// `K = 1 + 2 / L X X^T`:
///
/// ```text
/// W a (2 / L) sqrt(det X X^T / det K) exp(-v K^-1 v)
/// ```
///
/// This is the formula of Xu et al. for an anisotropic Gaussian, without its cosine, in any basis.
#[must_use]
pub fn reflected_sg_by<T: Scalar>(shape: &SphericalGaussian<T>, parts: [T; 2], light: &SgLight<T>) -> [T; 2] {
    let [x, y] = shape.rows;
    let width = T::of(2.0) / light.sharpness;
    let [xx, xy, yy] = [dot(x, x), dot(x, y), dot(y, y)].map(|product| width * product);
    // det K = 1 + tr + det (2 / L X X^T). The last term is the square of the area.
    let area = width * shape.peak() * T::of(0.5) * T::TAU;
    let determinant = T::ONE + xx + yy + area * area;
    let [u, v] = shape.at(light.axis);
    let far = ((T::ONE + yy) * u * u - (xy + xy) * u * v + (T::ONE + xx) * v * v) / determinant;
    let covered = light.amplitude * area / determinant.sqrt() * (-far).exp();
    parts.map(|part| part * covered)
}
