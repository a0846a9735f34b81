//! Arcs of circles of directions.

use super::interface::Interface;
use ltcforge_fit::math::{Scalar, Triple, cross, dot, minus, plus, scaled, unit};

/// The smallest squared sum of an arc's two radii, relative to the squared radius. For a smaller sum, the midpoint
/// comes from the perpendicular direction.
const OPPOSITE2: f64 = 1e-3;
/// The smallest cosine of half an arc's angle for which its standard form is used.
const HALF_COSINE: f64 = 0.02;

/// The directions with `axis . w = offset`. On its inner side `axis . w > offset`.
#[derive(Debug, Clone, Copy)]
pub(super) struct Circle<T> {
    pub(super) axis: Triple<T>,
    pub(super) offset: T,
}

/// The origin of an arc.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum ArcKind {
    /// An edge of the light, which is a great arc.
    Edge,
    /// The edge along the surface of a light that is cut there, which is a great arc.
    Surface,
    /// `h.z = 0`: normals parallel to the surface.
    Horizon,
    /// `wo . h = 0`, for `eta > 1`: normals perpendicular to the view.
    Grazing,
    /// `wi . h = 0`, for `eta < 1`: the onset of total internal reflection.
    Critical,
}

/// The part of a circle that an arc covers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Extent {
    /// At most half.
    Short,
    /// More than half.
    Wide,
    /// The whole circle. Both ends are the same point.
    Whole,
}

/// An arc of a circle, counterclockwise about its axis.
#[derive(Debug, Clone, Copy)]
pub(super) struct Arc<T> {
    pub(super) circle: Circle<T>,
    pub(super) from: Triple<T>,
    pub(super) to: Triple<T>,
    pub(super) kind: ArcKind,
    pub(super) extent: Extent,
}

impl<T: Scalar> Circle<T> {
    /// The depth of a direction on the inner side; negative on the outer side.
    pub(super) fn depth(&self, w: Triple<T>) -> T {
        dot(self.axis, w) - self.offset
    }

    /// The centre of the circle, inside of the sphere.
    pub(super) fn middle(&self) -> Triple<T> {
        scaled(self.axis, self.offset)
    }

    /// The radius.
    pub(super) fn radius(&self) -> T {
        (T::ONE - self.offset * self.offset).max(T::ZERO).sqrt()
    }
}

impl<T: Scalar> Arc<T> {
    /// The direction halfway along the arc.
    pub(super) fn middle(&self) -> Triple<T> {
        let middle = self.circle.middle();
        let [a, b] = self.radii();
        let sum = plus(a, b);
        let radius = dot(a, a).sqrt();
        let towards = if dot(sum, sum) > T::of(OPPOSITE2) * radius * radius {
            unit(if self.extent == Extent::Short { sum } else { scaled(sum, -T::ONE) })
        } else {
            unit(cross(self.circle.axis, minus(a, b)))
        };
        plus(middle, scaled(towards, radius))
    }

    /// The ends relative to the circle's centre.
    fn radii(&self) -> [Triple<T>; 2] {
        let middle = self.circle.middle();
        [minus(self.from, middle), minus(self.to, middle)]
    }

    /// The control point of the arc's image in standard form; `None` for an arc of nearly half a circle or more.
    ///
    /// An arc around m with the radii a and b is
    /// `m + ((1-t)^2 a + 2 t (1-t) (a + b) / (2 k) + t^2 b) / ((1-t)^2 + 2 t (1-t) k + t^2)`, where `k` is the cosine
    /// of half its angle. Up to length, its image has the control points `sigma A^-1 (wo + eta (m + a))`,
    /// `sigma A^-1 (k wo + eta (k m + (a + b) / (2 k)))` and `sigma A^-1 (wo + eta (m + b))`. In standard form the ends
    /// have unit length.
    pub(super) fn control(&self, interface: &Interface<T>) -> Option<Triple<T>> {
        let k = self.half_cosine()?;
        let [a, b] = self.radii();
        let control = plus(scaled(self.circle.middle(), k), scaled(plus(a, b), T::of(0.5) / k));
        let [x, y] = self.end_roots(interface);
        Some(scaled(interface.normal(k, control), T::ONE / (x * y)))
    }

    /// The cosine of half the arc's angle; `None` if it is near zero or negative.
    fn half_cosine(&self) -> Option<T> {
        let [a, b] = self.radii();
        let sum = plus(a, b);
        let k = T::of(0.5) * (dot(sum, sum) / dot(a, a)).sqrt();
        (self.extent == Extent::Short && k > T::of(HALF_COSINE)).then_some(k)
    }

    /// The square roots of the lengths of the ends' normals.
    fn end_roots(&self, interface: &Interface<T>) -> [T; 2] {
        [self.from, self.to].map(|w| {
            let normal = interface.normal(T::ONE, w);
            dot(normal, normal).sqrt().max(T::SHORTEST).sqrt()
        })
    }

    /// The direction whose image is at the middle parameter of the image's standard form.
    fn standard_middle(&self, interface: &Interface<T>) -> Triple<T> {
        let Some(k) = self.half_cosine() else { return self.middle() };
        let [a, b] = self.radii();
        // In standard form the ends have unit length, which swaps the roots: each end gets the other end's root.
        let [y, x] = self.end_roots(interface);
        let sum = plus(plus(scaled(a, x * x), scaled(b, y * y)), scaled(plus(a, b), x * y / k));
        let weight = x * x + T::of(2.0) * x * y * k + y * y;
        unit(plus(self.circle.middle(), scaled(sum, T::ONE / weight)))
    }

    /// Appends the arc in `parts` pieces, a power of two. Each split halves the parameter interval of the piece's image
    /// in standard form.
    pub(super) fn split(&self, interface: &Interface<T>, parts: u32, into: &mut Vec<Self>) {
        if parts < 2 {
            into.push(*self);
            return;
        }
        let middle = self.standard_middle(interface);
        Self { to: middle, extent: Extent::Short, ..*self }.split(interface, parts / 2, into);
        Self { from: middle, extent: Extent::Short, ..*self }.split(interface, parts / 2, into);
    }
}
