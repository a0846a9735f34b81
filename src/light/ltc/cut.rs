//! The integral of a distribution over the part of a light above the surface.
//!
//! A linearly transformed cosine ignores the surface. If its own horizon dips below the surface, a part of the
//! distribution is below the surface and reflects lights there. A cut distribution has the density zero below the
//! surface. Above the surface, it has the original density divided by `S`, the part of the distribution above the
//! surface. A direction `M c` is above the surface if `c . M^T z > 0`, so
//! ```text
//! S = (1 + cos t) / 2,    cos t = (M^T z)_z / |M^T z|
//! ```
//!
//! is the integral of the clamped cosine over a half space. `t` is the angle between the normals of the cosine and of
//! the half space. The part of the distribution over a light is the integral over the remaining outline. This outline
//! has straight edges and arcs of ellipses, cut first at the surface and then at the lobe's own horizon, and one more
//! edge along the surface. A part of an ellipse is not an ellipse, but its border is an arc of the same cone, whose
//! integral is known. So the result is exact for every shape.

#![allow(clippy::neg_cmp_op_on_partial_ord, reason = "NaN counts as what the comparison denies")]

use super::{
    CosineSpace,
    cone::{Cone, Turn, round},
};
use ltcforge_fit::{
    Clip, Sides,
    math::{Scalar, Triple, cross, dot, plus, scaled},
};

/// A distribution that is cut at the surface. Lights are in the tangent frame of the surface.
#[derive(Debug, Clone, Copy)]
pub struct AboveSurface<T> {
    space: CosineSpace<T>,
    per_part: T,
}

impl<T: Scalar> CosineSpace<T> {
    /// The distribution without the part below the surface. Domain: a distribution in the surface's tangent frame,
    /// normal +z, with a part above the surface.
    #[must_use]
    pub fn above_surface(self) -> AboveSurface<T> {
        AboveSurface { space: self, per_part: T::ONE / self.part_above().max(T::SHORTEST) }
    }

    /// The part of the distribution above the surface, in [0, 1].
    fn part_above(&self) -> T {
        // The heights of the columns of M up to a factor: M^T z.
        let [x, y, z] = self.rows;
        let [x, y, z] = [cross(y, z)[2], cross(z, x)[2], cross(x, y)[2]];
        let cosine = z / (x * x + y * y + z * z).sqrt().max(T::SHORTEST);
        let cosine = if self.determinant < T::ZERO { -cosine } else { cosine };
        T::of(0.5) * (T::ONE + cosine)
    }
}

/// The border of an ellipse `centre + cos t x + sin t y`, and its crossings with the surface.
struct Border<T> {
    cone: Cone<T>,
    height: T,
    /// The directions in which the border crosses the surface upwards and downwards, anticlockwise around the cone;
    /// `None` if the whole border is on one side.
    crossings: Option<[Triple<T>; 2]>,
}

/// The part of an outline above the surface, and the integral over its part above the lobe's horizon.
struct Outline<'a, T> {
    space: &'a CosineSpace<T>,
    clip: Clip<T>,
    /// The directions in which the outline crosses the surface downwards and upwards.
    leaves: Option<Triple<T>>,
    enters: Option<Triple<T>>,
}

impl<T: Scalar> AboveSurface<T> {
    /// The part of the distribution over a convex polygon, in [0, 1]. Zero for fewer than three vertices.
    #[must_use]
    pub fn polygon<V: Copy + Into<Triple<T>>>(&self, vertices: &[V], sides: Sides) -> T {
        let Some(last) = vertices.last() else { return T::ZERO };
        let mut previous = (*last).into();
        let mut outline = Outline::around(&self.space, previous);
        for vertex in vertices {
            let vertex = (*vertex).into();
            outline.edge(previous, vertex);
            previous = vertex;
        }
        let sum = outline.finish();
        // A matrix with a negative determinant reverses the polygon's winding.
        let lit = if self.space.determinant < T::ZERO { -sum } else { sum };
        self.scaled(if sides == Sides::Two { sum.abs() } else { lit })
    }

    /// Like [`CosineSpace::ellipse`], without the part of the light below the surface.
    #[must_use]
    pub fn ellipse<V: Into<Triple<T>>>(&self, centre: V, half_axes: [V; 2], sides: Sides) -> T {
        let (centre, half_axes) = (centre.into(), half_axes.map(V::into));
        if sides == Sides::One && !(dot(centre, cross(half_axes[0], half_axes[1])) < T::ZERO) {
            return T::ZERO;
        }
        self.border(centre, half_axes)
    }

    /// Like [`CosineSpace::sphere`], without the part of the light below the surface.
    #[must_use]
    pub fn sphere(&self, centre: impl Into<Triple<T>>, radius: T) -> T {
        let centre = centre.into();
        if dot(centre, centre) <= radius * radius {
            return T::ONE;
        }
        let (centre, half_axes) = CosineSpace::disk_of_sphere(centre, radius);
        self.border(centre, half_axes)
    }

    /// Like [`CosineSpace::line`], without the part of the light below the surface.
    #[must_use]
    pub fn line<V: Into<Triple<T>>>(&self, ends: [V; 2], width: T) -> T {
        let [a, b] = ends.map(V::into);
        let (a_is_up, b_is_up) = (a[2] > T::ZERO, b[2] > T::ZERO);
        if !a_is_up && !b_is_up {
            return T::ZERO;
        }
        // This is the point on the line, not only its direction, because the width does not scale with the point.
        let crossing = || scaled(crossing(a, b), T::ONE / (a[2] - b[2]).abs());
        let ends = [if a_is_up { a } else { crossing() }, if b_is_up { b } else { crossing() }];
        self.scaled(self.space.line(ends, width))
    }

    /// Like [`CosineSpace::tube`], without the part of the light below the surface.
    #[must_use]
    pub fn tube<V: Into<Triple<T>>>(&self, ends: [V; 2], radius: T) -> T {
        let ends = ends.map(V::into);
        let [[first_right, first_left], [second_right, second_left]] = match self.space.edges_of_tube(ends, radius) {
            Ok(touched) => touched,
            Err(nearest) => return self.sphere(nearest, radius),
        };
        let border = |end: Triple<T>| {
            let (centre, half_axes) = CosineSpace::disk_of_sphere(end, radius);
            Border::new(&self.space, centre, half_axes)
        };
        let (Some(first), Some(second)) = (border(ends[0]), border(ends[1])) else { return T::ZERO };
        let mut outline = Outline::around(&self.space, first_right);
        outline.edge(first_right, second_right);
        outline.arc(&second, second_right, second_left);
        outline.edge(second_left, first_left);
        outline.arc(&first, first_left, first_right);
        self.scaled(outline.finish())
    }

    fn border(&self, centre: Triple<T>, half_axes: [Triple<T>; 2]) -> T {
        let Some(border) = Border::new(&self.space, centre, half_axes) else { return T::ZERO };
        let covered = match border.crossings {
            Some([rise, dip]) => {
                let mut outline = Outline::around(&self.space, rise);
                outline.arc_above(&border, rise, dip);
                (outline.leaves, outline.enters) = (Some(dip), Some(rise));
                outline.finish()
            }
            None if border.height > T::ZERO => border.cone.covered(),
            None => T::ZERO,
        };
        self.scaled(covered)
    }

    fn scaled(&self, covered: T) -> T {
        (self.per_part * covered).max(T::ZERO).min(T::ONE)
    }
}

impl<T: Scalar> Border<T> {
    /// `None` if the ellipse has no solid angle.
    fn new(space: &CosineSpace<T>, centre: Triple<T>, [x, y]: [Triple<T>; 2]) -> Option<Self> {
        let cone = space.cone(centre, [x, y])?;
        // The height of the border is c + m cos(t - top) with m cos top = x_z, m sin top = y_z.
        let (height, most2) = (centre[2], x[2] * x[2] + y[2] * y[2]);
        let cut2 = most2 - height * height;
        let crossings = (cut2 > T::ZERO).then(|| {
            let across = cut2.sqrt();
            let at = |across: T| {
                let cos = (-height * x[2] - across * y[2]) / most2;
                let sin = (-height * y[2] + across * x[2]) / most2;
                let point = plus(centre, plus(scaled(x, cos), scaled(y, sin)));
                [point[0], point[1], T::ZERO]
            };
            let (dip, rise) = (at(across), at(-across));
            // The direction around the cone depends on the side from which the ellipse is seen, and on the sign of the
            // determinant.
            let turns = dot(centre, cross(x, y)) * space.determinant;
            if turns < T::ZERO { [dip, rise] } else { [rise, dip] }
        });
        Some(Self { cone, height, crossings })
    }
}

impl<'a, T: Scalar> Outline<'a, T> {
    fn around(space: &'a CosineSpace<T>, start: Triple<T>) -> Self {
        Self { space, clip: Clip::begin(space.of(start)), leaves: None, enters: None }
    }

    /// Adds an edge.
    fn edge(&mut self, a: Triple<T>, b: Triple<T>) {
        let (mut from, mut to) = (a, b);
        match (a[2] > T::ZERO, b[2] > T::ZERO) {
            (true, true) => {}
            (false, false) => return,
            (true, false) => {
                to = crossing(a, b);
                self.leaves = Some(to);
            }
            (false, true) => {
                from = crossing(a, b);
                self.enters = Some(from);
            }
        }
        self.edge_above(from, to);
    }

    fn edge_above(&mut self, from: Triple<T>, to: Triple<T>) {
        self.clip.go_to(self.space.of(from));
        self.clip.edge_to(self.space.of(to));
    }

    /// Adds the border of a cone, anticlockwise from `a` to `b`.
    fn arc(&mut self, border: &Border<T>, a: Triple<T>, b: Triple<T>) {
        let (begins_up, ends_up) = (a[2] > T::ZERO, b[2] > T::ZERO);
        let Some([rise, dip]) = border.crossings else {
            if border.height > T::ZERO {
                self.arc_above(border, a, b);
            }
            return;
        };
        let turn = |p: Triple<T>| -> Turn<T> { border.cone.turn_of(self.space.of(p)) };
        let from = turn(a);
        let reaches = |crossing: Triple<T>| round(from, turn(crossing)) < round(from, turn(b));
        let (leaves, enters) = match (begins_up, ends_up) {
            (true, false) => (true, false),
            (false, true) => (false, true),
            _ => (reaches(dip), reaches(rise)),
        };
        if leaves {
            self.leaves = Some(dip);
        }
        if enters {
            self.enters = Some(rise);
        }
        match (leaves, enters) {
            (false, false) if !begins_up => {}
            (true, true) if begins_up => {
                self.arc_above(border, a, dip);
                self.arc_above(border, rise, b);
            }
            _ => self.arc_above(border, if enters { rise } else { a }, if leaves { dip } else { b }),
        }
    }

    fn arc_above(&mut self, border: &Border<T>, from: Triple<T>, to: Triple<T>) {
        self.clip.go_to(self.space.of(from));
        border.cone.add_border(&mut self.clip, self.space.of(to));
    }

    /// Closes the outline along the surface and returns the integral.
    fn finish(mut self) -> T {
        if let (Some(leaves), Some(enters)) = (self.leaves, self.enters) {
            self.edge_above(leaves, enters);
        }
        self.clip.finish()
    }
}

/// The direction in which an edge crosses the surface. Its ends are on either side.
fn crossing<T: Scalar>(a: Triple<T>, b: Triple<T>) -> Triple<T> {
    let (below, above) = (b[2].abs(), a[2].abs());
    [a[0] * below + b[0] * above, a[1] * below + b[1] * above, T::ZERO]
}

#[cfg(test)]
mod tests;
