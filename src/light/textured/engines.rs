//! How engines read a picture on a light.

use super::readings::Reading;
use crate::CosineSpace;
use ltcforge_fit::math::{Scalar, Triple, cross, dot, minus, scaled};

/// The one reading of engines [Heitz et al. 2016]: where the direction of the vector form factor meets the light in the
/// space of the cosine, blurred by the distance of the light's plane over the root of its area there, times `width`.
///
/// Domain: the corners of a rectangle around the shaded point; the third is not read.
#[must_use]
pub fn engines_reading<T: Scalar>(
    space: &CosineSpace<T>,
    form_factor: Triple<T>,
    corners: &[Triple<T>; 4],
    width: T,
) -> Reading<T> {
    let [corner, x, y] =
        [corners[0], minus(corners[1], corners[0]), minus(corners[3], corners[0])].map(|v| space.of(v));
    let normal = cross(x, y);
    let area = dot(normal, normal).sqrt().max(T::SHORTEST);
    let distance = dot(normal, corner);
    let descent = dot(normal, form_factor);
    let met = scaled(form_factor, distance / if descent.abs() > T::SHORTEST { descent } else { T::SHORTEST });
    let from_corner = minus(met, corner);
    // The sides are oblique there.
    let part = |side: Triple<T>, other: Triple<T>| {
        let upright = cross(other, normal);
        (dot(from_corner, upright) / dot(side, upright)).max(T::ZERO).min(T::ONE)
    };
    let radius = width * distance.abs() / (area * area.sqrt());
    Reading { uv: [part(x, y), part(y, x)], radius, weight: T::ONE }
}
