//! The exact integral over the image of a light's edge, to which the arcs of great circles are held.

mod cone;
mod edge;

pub(crate) use cone::cos_of_third;

use self::edge::curved_part;
use super::{outline::Corner, view::View};
use ltcforge_fit::math::{Scalar, Triple, cross, minus, plus};

/// The integral of `c x dc` along each edge's image.
pub(super) fn edges<T: Scalar>(view: &View<T>, corners: &[Corner<T>]) -> Vec<Triple<T>> {
    beyond_chords(view, corners).map(|(from, to, beyond)| plus(beyond, cross(from.c, minus(to.c, from.c)))).collect()
}

/// Their sum. What lies under the chords is summed up around the first corner, where it is small for a small light.
pub(super) fn flux<T: Scalar>(view: &View<T>, corners: &[Corner<T>]) -> Triple<T> {
    let origin = corners[0].c;
    beyond_chords(view, corners).fold([T::ZERO; 3], |sum, (from, to, beyond)| {
        plus(sum, plus(beyond, cross(minus(from.c, origin), minus(to.c, origin))))
    })
}

/// Each edge's corners, and its integral beyond that of the chord, `a x c`.
fn beyond_chords<'a, T: Scalar>(
    view: &'a View<T>,
    corners: &'a [Corner<T>],
) -> impl Iterator<Item = (&'a Corner<T>, &'a Corner<T>, Triple<T>)> {
    let ends = corners.iter().zip(corners.iter().cycle().skip(1));
    ends.map(|(from, to)| (from, to, curved_part(view.alpha, view.wo, from, to)))
}
