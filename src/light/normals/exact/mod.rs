//! The exact integral over the image of a light's edge. It is the reference for the arcs of great circles.

mod cone;
mod edge;

pub(crate) use cone::cos_of_third;

use self::edge::curved_part;
use super::{outline::Corner, view::View};
use ltcforge_fit::math::{Scalar, Triple, cross, minus, plus};

/// The integral of `c x dc` along the images of all edges. The part under the chords is summed around the first corner,
/// where it is small for a small light.
pub(super) fn flux<T: Scalar>(view: &View<T>, corners: &[Corner<T>]) -> Triple<T> {
    let origin = corners[0].c;
    beyond_chords(view, corners).fold([T::ZERO; 3], |sum, (from, to, beyond)| {
        plus(sum, plus(beyond, cross(minus(from.c, origin), minus(to.c, origin))))
    })
}

/// The corners of each edge, and its integral without the chord's part `a x c`.
fn beyond_chords<'a, T: Scalar>(
    view: &'a View<T>,
    corners: &'a [Corner<T>],
) -> impl Iterator<Item = (&'a Corner<T>, &'a Corner<T>, Triple<T>)> {
    let ends = corners.iter().zip(corners.iter().cycle().skip(1));
    ends.map(|(from, to)| (from, to, curved_part(view.alpha, view.wo, from, to)))
}
