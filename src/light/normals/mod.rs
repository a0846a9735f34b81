//! The light of a polygon on GGX, in the space of its normals: exact but for the weight of shadowing, and no table.
//!
//! The light reflected from a polygon P of radiance one, for a Fresnel factor of one, is
//!
//! ```text
//! integral over P of D(h) G2 / (4 cos_o) dwi = integral over H(P) of Dv(h) (G2 / G1) dh,   Dv = G1 (wo . h) D / cos_o
//! ```
//!
//! where H(P) are the half vectors `h = normalize(wo + wi)` [Walter et al. 2007]. With `c = normalize(A^-1 h)`,
//! `A = diag(alpha_x, alpha_y, 1)`, the normals of GGX are a clamped cosine, `D(h) h.z dh = c.z / pi dc`, and the visible
//! ones the projection of the hemisphere along `A wo` [Heitz 2018]. So the integral of `Dv` over a region is the form
//! factor of the region's image C(P) for a receiver with the normal `A wo`:
//!
//! ```text
//! V = 2 / (cos_o + |A wo|) (A wo) . F,     F = 1/(2 pi) closed integral of c x dc along the outline of C(P)
//! ```
//!
//! The edges of a light become arcs of cones of the second degree, over which the integral is elementary
//! (`edge.rs`). The weight `G2 / G1`, and Schlick's fifth power, are smooth; they are averaged over the
//! triangles into which the region falls around its mean normal (`weight.rs`). `docs/normals.md` derives all of it.
//!
//! Every direction above the surface has its half vector above it and in front of the viewer, so a light is cut at the
//! surface and nowhere else.

mod cone;
mod edge;
mod eigen;
mod outline;
mod weight;

pub(super) use self::{
    cone::{Cone, ConeArc},
    edge::arc_bend,
};
use self::{
    edge::curved_part,
    outline::{Corner, Parts, cut_share, outline},
    weight::{Sample, Shares, View},
};
use crate::fit::{
    Sides,
    math::{Scalar, Triple, cross, dot, minus, plus, scaled, unit},
    named_list::named_list,
};

named_list! {
    /// How the weight `G2 / G1` is averaged over a light. The integral of the visible normals is exact under each.
    pub enum WeightRule {
        /// Over the triangles between the mean normal and each edge, with a closed form for those on the horizon, which is
        /// split in four.
        Fan = "fan",
        /// The weight of the mean normal.
        Mean = "mean",
        /// As [`Self::Fan`], each edge split in two and the horizon in eight.
        Fine = "fine",
    }
}

impl WeightRule {
    fn parts(self) -> Parts {
        match self {
            Self::Mean => Parts { edge: 1, horizon: 1 },
            Self::Fan => Parts { edge: 1, horizon: 4 },
            Self::Fine => Parts { edge: 2, horizon: 8 },
        }
    }

    fn shares(self) -> Shares {
        match self {
            Self::Mean | Self::Fan => Shares { outer: 0.3, tip: 0.2, corner: 0.08, horizon_rate: 0.155 },
            Self::Fine => Shares { outer: 0.2, tip: 0.1, corner: 0.04, horizon_rate: 0.145 },
        }
    }
}

/// What GGX reflects of a polygon of radiance one towards `wo`: for a Fresnel factor of one, and its part weighed by
/// Schlick's `(1 - wo . h)^5`, both in [0, 1].
///
/// The vertices of the convex polygon are relative to the shaded point in its tangent frame, normal +z; the lit side is
/// that from which they run clockwise. Domain: `alpha` in [1e-5, 1], `wo` of length one with `z > 0`, finite vertices.
#[must_use]
pub fn reflected<T: Scalar>(
    alpha: [T; 2],
    wo: Triple<T>,
    vertices: &[Triple<T>],
    sides: Sides,
    rule: WeightRule,
) -> [T; 2] {
    let view = View::new(alpha, wo);
    let corners = outline(vertices, rule.parts(), alpha, wo);
    if corners.len() < 3 {
        return [T::ZERO; 2];
    }
    let curved = curved_parts(&corners, alpha, wo);
    let flux = flux(&corners, &curved);
    let seen = dot(flux, view.stretched);
    let side = if seen < T::ZERO { -T::ONE } else { T::ONE };
    if sides == Sides::One && seen < T::ZERO {
        return [T::ZERO; 2];
    }
    let to_part = side * T::of(2.0) / ((wo[2] + view.length) * T::TAU);
    let mean_normal = unit(scaled(flux, side));
    let [energy, fresnel] = if rule == WeightRule::Mean {
        let [weight, schlick] = view.weight(mean_normal);
        [to_part * seen * weight, to_part * seen * weight * schlick]
    } else {
        let fan = Fan { view: &view, shares: rule.shares(), tip: mean_normal, to_part, sum: [T::ZERO; 2] };
        fan.over(&corners, &curved, rule.parts(), cut_share(vertices))
    };
    // No weight is above one. Where triangles lie upon each other, as in a sliver along the horizon, their rules may differ
    // by more than what they leave of each other.
    let visible = (to_part * seen).max(T::ZERO).min(T::ONE);
    let energy = energy.max(T::ZERO).min(visible);
    [energy, fresnel.max(T::ZERO).min(energy)]
}

/// What the image of each edge adds beyond its plane triangle.
fn curved_parts<T: Scalar>(corners: &[Corner<T>], alpha: [T; 2], wo: Triple<T>) -> Vec<Triple<T>> {
    let ends = corners.iter().zip(corners.iter().cycle().skip(1));
    ends.map(|(from, to)| curved_part(alpha, wo, from, to)).collect()
}

/// F times a turn: its plane part around the first corner.
fn flux<T: Scalar>(corners: &[Corner<T>], curved: &[Triple<T>]) -> Triple<T> {
    let origin = corners[0].c;
    let ends = corners.iter().zip(corners.iter().cycle().skip(1));
    ends.zip(curved).fold([T::ZERO; 3], |sum, ((from, to), curved)| {
        plus(sum, plus(*curved, cross(minus(from.c, origin), minus(to.c, origin))))
    })
}

/// V: the part of the visible normals that a polygon's light is reflected at, positive where it is lit, negative
/// where it is seen from behind.
#[cfg(test)]
pub(super) fn visible<T: Scalar>(alpha: [T; 2], wo: Triple<T>, vertices: &[Triple<T>]) -> T {
    let view = View::new(alpha, wo);
    let corners = outline(vertices, Parts { edge: 1, horizon: 1 }, alpha, wo);
    if corners.len() < 3 {
        return T::ZERO;
    }
    let seen = dot(flux(&corners, &curved_parts(&corners, alpha, wo)), view.stretched);
    T::of(2.0) * seen / ((wo[2] + view.length) * T::TAU)
}

/// The sum over the triangles between the mean normal and each edge's image: the exact part of the visible normals in it,
/// times the mean of their weights.
struct Fan<'a, T> {
    view: &'a View<T>,
    shares: Shares,
    /// The mean normal, where all triangles meet.
    tip: Triple<T>,
    /// What makes a form factor a part of the visible normals.
    to_part: T,
    sum: [T; 2],
}

impl<T: Scalar> Fan<'_, T> {
    /// Adds a triangle, by the integral of its normals, as `times` of one, weighed by what `mean` says of its centroid.
    fn add(&mut self, flux: Triple<T>, times: T, mean: impl FnOnce(&View<T>, Shares, Triple<T>) -> [T; 2]) {
        let centroid = unit(flux);
        let centroid = if dot(centroid, self.tip) < T::ZERO { scaled(centroid, -T::ONE) } else { centroid };
        let part = self.to_part * times * dot(flux, self.view.stretched);
        let [energy, fresnel] = mean(self.view, self.shares, centroid);
        self.sum = [self.sum[0] + part * energy, self.sum[1] + part * fresnel];
    }

    /// The sum over all triangles. Those of the horizon count by `cut`, and what they are together as edges of the light
    /// by the rest.
    fn over(mut self, corners: &[Corner<T>], curved: &[Triple<T>], parts: Parts, cut: T) -> [T; 2] {
        let tip = self.tip;
        let (at_tip, tip_sample) = (self.view.weight(tip), self.view.sample(tip));
        let samples: Vec<Sample<T>> = corners.iter().map(|corner| self.view.sample(corner.c)).collect();
        let (mut joined, mut count, mut start) = ([T::ZERO; 3], 0, 0);
        for (i, curved) in curved.iter().enumerate() {
            let next = (i + 1) % corners.len();
            let (from, to) = (&corners[i], &corners[next]);
            let plane = cross(minus(from.c, tip), minus(to.c, tip));
            let flux = plus(plus(plane, *curved), minus(arc_bend(tip, from.c), arc_bend(tip, to.c)));
            let on_edge = |start: usize| {
                let samples = [tip_sample, samples[start], samples[next]];
                move |view: &View<T>, shares, centroid| view.over_triangle(shares, tip, centroid, samples)
            };
            if !(from.is_on_horizon() && to.is_on_horizon()) {
                self.add(flux, T::ONE, on_edge(i));
                continue;
            }
            self.add(flux, cut, |view, shares, centroid| view.over_triangle_to_horizon(shares, tip, at_tip, centroid));
            if count == 0 {
                start = i;
            }
            (joined, count) = (plus(joined, flux), count + 1);
            if count * parts.edge == parts.horizon {
                self.add(joined, T::ONE - cut, on_edge(start));
                (joined, count) = ([T::ZERO; 3], 0);
            }
        }
        self.sum
    }
}
