//! The method that engines use to read a picture on a light.

use super::readings::Reading;
use crate::CosineSpace;
use ltcforge_fit::math::{Scalar, Triple, cross, dot, minus, scaled};

/// The single reading of engines [Heitz et al. 2016]. It reads the point where the direction of the vector form factor
/// meets the light in cosine space. Its blur is `width` times the distance of the light's plane, divided by the square
/// root of the light's area in cosine space.
///
/// Domain: the corners of a rectangle relative to the shaded point. The third corner is not used.
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
    // The sides are oblique in cosine space.
    let part = |side: Triple<T>, other: Triple<T>| {
        let upright = cross(other, normal);
        (dot(from_corner, upright) / dot(side, upright)).max(T::ZERO).min(T::ONE)
    };
    let radius = width * distance.abs() / (area * area.sqrt());
    Reading { uv: [part(x, y), part(y, x)], radius, weight: T::ONE }
}
