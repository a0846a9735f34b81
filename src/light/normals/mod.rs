//! The light of a polygon on GGX, in the space of its normals: exact but for the weight of shadowing, and no table.
//!
//! The light reflected from a polygon P of radiance one, for a Fresnel factor of one, is
//!
//! ```text
//! integral over P of D(h) G2 / (4 cos_o) dwi = integral over H(P) of Dv(h) (G2 / G1) dh,   Dv = G1 (wo . h) D / cos_o
//! ```
//!
//! where H(P) are the half vectors `h = normalize(wo + wi)` [Walter et al. 2007]. With `c = normalize(A^-1 h)`,
//! `A = diag(alpha_x, alpha_y, 1)`, the normals of GGX are a clamped cosine, `D(h) h.z dh = c.z / pi dc`, and the
//! visible ones the projection of the hemisphere along `A wo` [Heitz 2018]. So the integral of `Dv` over a region is
//! the form factor of the region's image C(P) for a receiver with the normal `A wo`:
//!
//! ```text
//! V = 2 / (cos_o + |A wo|) (A wo) . F,     F = 1/(2 pi) closed integral of c x dc along the outline of C(P)
//! ```
//!
//! The edges of a light become arcs of cones of the second degree, over which the integral has a closed form
//! (`edge.rs`). The weight `G2 / G1`, and Schlick's fifth power, are smooth; they are averaged over the
//! triangles into which the region falls around its mean normal (`weight.rs`). `docs/normals.md` derives all of it.
//!
//! Every direction above the surface has its half vector above it and in front of the viewer, so a light is cut at the
//! surface and nowhere else.

mod cone;
mod edge;
mod model;
mod outline;
mod weight;

pub(super) use self::{cone::cos_of_third, edge::arc_bend, model::NormalsModel};
use self::{
    edge::{curved_part, shared},
    outline::{Corner, EdgeParts, Outline},
    weight::{Numbers, View, WeightedNormal},
};
pub use self::{model::by_normals, weight::Forms};
use ltcforge_fit::{
    Sides,
    math::{Scalar, Triple, cross, dot, minus, plus, scaled, unit},
    named_list,
};

named_list! {
    /// How the weight `G2 / G1` is averaged over a light. The integral of the visible normals is exact under each.
    pub enum WeightRule {
        /// Over the triangles between the mean normal and each edge, with a closed form for those of the edge on or
        /// near the horizon, which is split in four, or eight where it is wide.
        Fan = "fan",
        /// The weight of the mean normal.
        Mean = "mean",
        /// As [`Self::Fan`], each edge split in two and the one on or near the horizon in eight or sixteen.
        Fine = "fine",
    }
}

impl WeightRule {
    fn parts(self) -> EdgeParts {
        match self {
            Self::Mean => EdgeParts { edge: 1, horizon: 1 },
            Self::Fan => EdgeParts { edge: 1, horizon: 4 },
            Self::Fine => EdgeParts { edge: 2, horizon: 8 },
        }
    }

    /// The numbers of the triangles' means; [`Self::Mean`] has no triangles.
    #[must_use]
    pub fn forms(self) -> &'static Forms {
        match self {
            Self::Mean | Self::Fan => &FAN,
            Self::Fine => &FINE,
        }
    }
}

/// `ltcforge-studies weight` finds such numbers; so for [`FINE`].
const FAN: Forms = Forms {
    usual: [
        [0.01, 0.494, 0.326, -0.194],
        [0.091, -0.105, -0.051, 0.253],
        [0.643, -0.07, -0.335, -0.279],
        [0.069, 0.187, 0.02, -0.022],
        [0.272, -0.173, 0.133, -0.086],
        [0.32, -0.352, 0.276, 0.206],
    ],
    wide: [
        [-0.303, 0.484, 1.059, -0.565, -0.076, 0.531],
        [-0.001, 0.01, -0.078, 0.059, -0.017, 0.23],
        [1.146, -0.263, -0.744, 0.218, -0.263, -0.369],
        [0.03, 0.155, 0.259, -0.116, 0.01, -0.164],
        [0.484, -0.201, -0.096, 0.125, -0.012, -0.06],
        [0.698, -0.541, -0.123, 0.685, 0.103, -0.169],
    ],
    inner: [[0.078, -0.025, 0.422, -0.025, 0.051, -0.225], [-0.863, -0.268, 0.688, 0.266, 1.221, -0.86]],
};

const FINE: Forms = Forms {
    usual: [
        [0.952, -0.667, -1.181, 1.403],
        [0.077, -0.076, -0.007, 0.141],
        [0.129, 0.436, 0.083, -0.708],
        [0.074, 0.198, 0.0, -0.14],
        [0.303, -0.249, 0.105, 0.162],
        [0.297, -0.32, 0.311, 0.402],
    ],
    wide: [
        [0.061, 0.135, 0.495, -0.396, -0.247, 1.007],
        [-0.007, 0.017, -0.052, -0.014, 0.002, 0.246],
        [0.653, 0.23, -0.327, -0.132, -0.295, -0.367],
        [0.098, 0.13, 0.148, -0.114, -0.042, -0.109],
        [0.413, -0.148, -0.007, 0.102, 0.074, -0.133],
        [0.521, -0.351, 0.097, 0.526, 0.202, -0.225],
    ],
    inner: [[0.179, -0.041, 0.263, 0.041, 0.157, -0.296], [-0.736, -0.213, 0.534, 0.183, 0.869, -0.469]],
};

/// The light of a polygon of radiance one that GGX reflects towards `wo`: for a Fresnel factor of one, and its part
/// weighed by Schlick's `(1 - wo . h)^5`, both in [0, 1].
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
    reflected_with(rule.forms(), alpha, wo, vertices, sides, rule)
}

/// [`reflected`] with other numbers of the triangles' means than the rule's own.
#[must_use]
pub fn reflected_with<T: Scalar>(
    forms: &Forms,
    alpha: [T; 2],
    wo: Triple<T>,
    vertices: &[Triple<T>],
    sides: Sides,
    rule: WeightRule,
) -> [T; 2] {
    let view = View::new(alpha, wo);
    let outline = Outline::new(vertices, rule.parts(), alpha, wo);
    if outline.corners.len() < 3 {
        return [T::ZERO; 2];
    }
    let curved = curved_parts(&outline, alpha, wo);
    let flux = flux(&outline.corners, &curved);
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
        let fan = Fan {
            view: &view,
            numbers: Numbers::new(forms, &view, outline.wide),
            tip: mean_normal,
            to_part,
            at_tip: view.weight(mean_normal),
            sum: [T::ZERO; 2],
            positive: [T::ZERO; 3],
            unknown: T::ZERO,
        };
        fan.over(&outline, &curved, rule.parts()).total(to_part * seen)
    };
    // No weight is above one.
    let visible = (to_part * seen).max(T::ZERO).min(T::ONE);
    let energy = energy.max(T::ZERO).min(visible);
    [energy, fresnel.max(T::ZERO).min(energy)]
}

/// The contribution of each edge's image beyond its plane triangle. On the edge on or near the horizon, the parts of a
/// half, or of a quarter with rule [`WeightRule::Fine`], share one integral.
fn curved_parts<T: Scalar>(outline: &Outline<T>, alpha: [T; 2], wo: Triple<T>) -> Vec<Triple<T>> {
    let Outline { corners, setting, parts_per_integral, .. } = outline;
    let ends: Vec<&Corner<T>> = corners.iter().chain(corners.first()).collect();
    let normals: Vec<Triple<T>> = ends.iter().map(|corner| corner.c).collect();
    let mut curved = Vec::with_capacity(corners.len());
    while curved.len() < corners.len() {
        let i = curved.len();
        let end = i + if setting.contains(&i) { *parts_per_integral } else { 1 };
        share_among(&normals[i..=end], curved_part(alpha, wo, ends[i], ends[end]), &mut curved);
    }
    curved
}

/// Adds the contribution of each part between `normals` beyond its plane triangle, of the image of an edge whose
/// `whole` is known. The parts are a power of two.
fn share_among<T: Scalar>(normals: &[Triple<T>], whole: Triple<T>, curved: &mut Vec<Triple<T>>) {
    let last = normals.len() - 1;
    if last == 1 {
        curved.push(whole);
        return;
    }
    let middle = last / 2;
    let halves = shared([normals[0], normals[middle], normals[last]], whole);
    share_among(&normals[..=middle], halves[0], curved);
    share_among(&normals[middle..], halves[1], curved);
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
    let outline = Outline::new(vertices, EdgeParts { edge: 1, horizon: 1 }, alpha, wo);
    if outline.corners.len() < 3 {
        return T::ZERO;
    }
    let seen = dot(flux(&outline.corners, &curved_parts(&outline, alpha, wo)), view.stretched);
    T::of(2.0) * seen / ((wo[2] + view.length) * T::TAU)
}

/// The sum over the triangles between the mean normal and each edge's image: the exact part of the visible normals in
/// it, times the mean of their weights.
struct Fan<'a, T> {
    view: &'a View<T>,
    numbers: Numbers<T>,
    /// The mean normal, where all triangles meet, and its weight.
    tip: Triple<T>,
    at_tip: [T; 2],
    /// The factor from a form factor to a part of the visible normals.
    to_part: T,
    sum: [T; 2],
    /// The positive parts, and their contribution to the sum.
    positive: [T; 3],
    /// The part of triangles whose weight is unknown.
    unknown: T,
}

/// A triangle counts in full where its centroid reflects this part as far above the surface as the tip does, or
/// farther. A centroid is within the triangle, and so is what it reflects within the light's hemisphere, because the
/// normals that reflect above the surface form a convex cone; unless the image of the edge crosses the triangle's other
/// sides.
const LEAST_RISE: f64 = 0.125;

impl<T: Scalar> Fan<'_, T> {
    /// The centroid of a triangle, by the integral of its normals, and its part of the visible normals.
    ///
    /// A triangle that its edge's image divides into what runs on and what runs back has no centroid: the two cancel
    /// each other, the integral may be at a right angle to the tip, and the tip stands for it.
    fn centroid(&self, flux: Triple<T>) -> (Triple<T>, T) {
        let m = unit(flux);
        let share = (T::of(10.0) * dot(m, self.tip)).min(T::ONE).max(-T::ONE);
        let m = plus(scaled(m, share), scaled(self.tip, T::ONE - share.abs()));
        (m, self.to_part * dot(flux, self.view.stretched))
    }

    /// Adds a triangle by its centroid, its part of the visible normals and its mean weight.
    fn add(&mut self, m: Triple<T>, whole: T, mean: [T; 2]) {
        let known = self.view.rise(m) / (T::of(LEAST_RISE) * self.view.rise(self.tip)).max(T::of(1e-36));
        let known = known.max(T::ZERO).min(T::ONE);
        self.unknown = self.unknown + (T::ONE - known) * whole;
        let part = known * whole;
        let [energy, fresnel] = mean.map(|mean| part * mean);
        self.sum = [self.sum[0] + energy, self.sum[1] + fresnel];
        if part > T::ZERO {
            self.positive = plus(self.positive, [part, energy, fresnel]);
        }
    }

    /// The sum, for a light whose part of the visible normals is `visible`.
    ///
    /// Where the image bends around the mean normal, triangles reach beyond it, and those that run back take that away
    /// again. Their rules may differ by more than what they leave of each other, so there the mean weight is in part
    /// that of the positive triangles alone; so it is in triangles whose own is unknown.
    fn total(&self, visible: T) -> [T; 2] {
        let least = T::of(1e-18);
        let [part, energy, fresnel] = self.positive;
        let negative = (part + self.unknown - visible) / visible.max(least);
        let share = negative.max(T::ZERO).min(T::of(0.5));
        // The tip counts so little that it matters only where nothing else does.
        let tip = T::of(1e-6) * visible.max(least);
        let [at_tip, schlick] = self.at_tip;
        let per_part = (share * self.unknown + (T::ONE - share) * visible) / (part + tip);
        let of = |sum: T, positive: T, at_tip: T| share * sum + per_part * (positive + tip * at_tip);
        [of(self.sum[0], energy, at_tip), of(self.sum[1], fresnel, at_tip * schlick)]
    }

    /// The sum over all triangles. Those of the edge on or near the horizon count by its share, and what they are
    /// together as other edges by the rest.
    fn over(mut self, outline: &Outline<T>, curved: &[Triple<T>], parts: EdgeParts) -> Self {
        let (view, tip, Outline { corners, setting, share, .. }) = (self.view, self.tip, outline);
        let at_tip = view.sample(tip);
        let samples: Vec<WeightedNormal<T>> = corners.iter().map(|corner| view.sample(corner.c)).collect();
        let (mut joined, mut count, mut start) = ([T::ZERO; 3], 0, 0);
        for (i, curved) in curved.iter().enumerate() {
            let next = (i + 1) % corners.len();
            let (from, to) = (&corners[i], &corners[next]);
            let plane = cross(minus(from.c, tip), minus(to.c, tip));
            let flux = plus(plus(plane, *curved), minus(arc_bend(tip, from.c), arc_bend(tip, to.c)));
            let (m, part) = self.centroid(flux);
            let numbers = self.numbers;
            let on_edge =
                |start: usize, m| view.over_triangle(&numbers, tip, m, [at_tip, samples[start], samples[next]]);
            if !setting.contains(&i) {
                self.add(m, part, on_edge(i, m));
                continue;
            }
            self.add(m, *share * part, view.over_triangle_to_horizon(&numbers, tip, self.at_tip, m));
            if count == 0 {
                start = i;
            }
            (joined, count) = (plus(joined, flux), count + 1);
            if count * parts.edge as usize == setting.len() {
                let (m, part) = self.centroid(joined);
                self.add(m, (T::ONE - *share) * part, on_edge(start, m));
                (joined, count) = ([T::ZERO; 3], 0);
            }
        }
        self
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;
    use ltcforge_fit::math::direction;

    /// The parts of the edge on the horizon add up to its integral, and each is near its own, of walls that are seen at
    /// up to a right angle, and of some that fill half of all directions.
    #[test]
    fn parts_of_the_horizon_s_edge_share_its_integral() {
        let fraction = |i: u32, step: f64| (f64::from(i) * step).fract();
        for (widest, [mean, most]) in [(1.5, [5e-4, 0.06]), (3.0, [0.0025, 0.2])] {
            let (mut parts, mut off, mut farthest) = (0, 0.0, 0.0_f64);
            for i in 1..=2000 {
                let [a, b, c, d] =
                    [0.754_877_67, 0.569_840_29, 0.438_447_19, 0.309_016_99].map(|step| fraction(i, step));
                let alpha = [0.02 + 0.98 * a * a, 0.02 + 0.98 * b];
                let wo = direction(1.5 * c, TAU * d).to_array();
                let begin = TAU * fraction(i, 0.829);
                let end = begin + 0.1 + (widest - 0.1) * fraction(i, 0.671);
                let at = |angle: f64, z: f64| [angle.cos(), angle.sin(), z];
                let wall = [at(begin, -0.3), at(begin, 0.5), at(end, 0.5), at(end, -0.3)];
                let outline = Outline::new(&wall, EdgeParts { edge: 1, horizon: 4 }, alpha, wo);
                let curved = curved_parts(&outline, alpha, wo);
                let whole = Outline::new(&wall, EdgeParts { edge: 1, horizon: 1 }, alpha, wo);
                let flux = [&outline, &whole].map(|outline| flux(&outline.corners, &curved_parts(outline, alpha, wo)));
                let apart = minus(flux[0], flux[1]);
                assert!(dot(apart, apart).sqrt() < 1e-9, "{i}: {flux:?}");
                for part in outline.setting.clone() {
                    let corner = |i: usize| &outline.corners[i % outline.corners.len()];
                    let exact = curved_part(alpha, wo, corner(part), corner(part + 1));
                    let error = minus(curved[part], exact);
                    let error = dot(error, error).sqrt();
                    (parts, off, farthest) = (parts + 1, off + error, farthest.max(error));
                }
            }
            let off = off / f64::from(parts);
            println!("up to {widest}: {parts} parts, off by {off:.1e}, at most {farthest:.1e}");
            assert!(parts > 4000 && off < mean && farthest < most, "{widest}: {off} {farthest}");
        }
    }
}
