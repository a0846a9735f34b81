//! The mean weight over a region of normals: numbers of the region, and the mean by a network's outputs.

use super::{
    arcs::AnglePerSine,
    outline::{Corner, Outline},
    view::{View, Weighted},
};
use ltcforge_fit::math::{Scalar, Triple, cross, dot, minus, plus, scaled};

/// How many inputs a network has at most.
pub const INPUTS: usize = 12;
/// How many outputs it has.
pub const OUTPUTS: usize = 4;

/// A region of the visible normals: all those that reflect a light, or a triangle of them.
#[derive(Debug, Clone, Copy)]
pub struct Region<T> {
    /// Its part of the visible normals; negative for a triangle that others overlap.
    pub part: T,
    /// The weight of its mean normal.
    pub at_mean: T,
    /// Schlick's factor of its mean normal, `(1 - wo . h)^5`.
    pub schlick: T,
    /// The weight of its corners: of their mean rise.
    pub at_corners: T,
    /// The weight of the light's mean normal, which is a corner of a triangle; of the whole region that of its own.
    pub at_tip: T,
    /// The inputs of its network.
    pub inputs: [T; INPUTS],
}

impl<T: Scalar> Region<T> {
    /// The mean weight over the region, and that times Schlick's factor, by the outputs of a network.
    ///
    /// The mean is that of the mean normal, of the corners and of the tip, by shares that a network tells, and what it
    /// adds to them times the region's part. A small region has one weight, whatever the network.
    #[must_use]
    pub fn mean(&self, [more, more_schlick, corners, tip]: [T; OUTPUTS]) -> [T; 2] {
        let known = self.at_mean + corners * (self.at_corners - self.at_mean) + tip * (self.at_tip - self.at_mean);
        let size = self.part.abs();
        let mean = (known + size * more).max(T::ZERO).min(T::ONE);
        [mean, (mean * self.schlick + size * more_schlick).max(T::ZERO).min(mean)]
    }
}

/// The whole region of a light whose integral of `c x dc` around the image is `flux`, turned so that its part V of the
/// visible normals is positive.
pub(super) fn whole<T: Scalar>(view: &View<T>, vertices: &[Triple<T>], flux: Triple<T>, visible: T) -> Region<T> {
    let at = view.at(flux);
    let per_length = T::ONE / dot(flux, flux).max(T::of(1e-30)).sqrt();
    let rises = || vertices.iter().map(|v| view.rise(*v));
    let count = T::of(vertices.len() as f64);
    let mean_rise = rises().fold(T::ZERO, |sum, rise| sum + rise) / count;
    let mean_square = rises().fold(T::ZERO, |sum, rise| sum + rise * rise) / count;
    let lowest = rises().fold(T::ONE, T::min);
    let highest = rises().fold(T::ZERO, T::max);
    let at_corners = view.weight_of(mean_rise);
    let [larger, smaller] = roughness(view);
    Region {
        part: visible,
        at_mean: at.weight,
        schlick: schlick(&at),
        at_corners,
        at_tip: at.weight,
        inputs: [
            visible,
            view.rise,
            at.weight,
            at.incidence,
            flux[2].abs() * per_length,
            larger,
            smaller,
            at_corners,
            dot(flux, view.stretched) * per_length / view.length,
            lowest,
            highest,
            mean_square,
        ],
    }
}

/// The triangles between the mean normal of a light's region and the images of its edges, whose integrals are `edges`,
/// by their parts of the visible normals: `to_part` is the factor from an integral's part along `A wo`.
pub(super) fn triangles<T: Scalar>(
    view: &View<T>,
    outline: &Outline<T>,
    psi: &AnglePerSine,
    edges: &[Triple<T>],
    tip: Triple<T>,
    to_part: T,
) -> Vec<Region<T>> {
    let at_tip = view.at(tip).weight;
    let [larger, smaller] = roughness(view);
    let spoke = |corner: &Corner<T>| scaled(cross(tip, corner.c), psi.between(tip, corner.c));
    let triangle = |((from, to), edge): ((&Corner<T>, &Corner<T>), &Triple<T>)| {
        let flux = plus(*edge, minus(spoke(from), spoke(to)));
        let part = to_part * dot(flux, view.stretched);
        let is_back = (part < T::ZERO) != (to_part < T::ZERO);
        let length = dot(flux, flux).max(T::of(1e-30)).sqrt();
        let m = scaled(flux, if is_back { -T::ONE } else { T::ONE } / length);
        let at = view.at(m);
        let rises = [view.rise(from.w), view.rise(to.w)];
        let at_corners = view.weight_of(T::of(0.5) * (rises[0] + rises[1]));
        Region {
            part,
            at_mean: at.weight,
            schlick: schlick(&at),
            at_corners,
            at_tip,
            inputs: [
                part.abs(),
                at.weight,
                at.incidence,
                at_corners,
                dot(m, tip),
                dot(m, plus(from.c, to.c)),
                m[2].abs(),
                (rises[0] - rises[1]).abs(),
                view.rise,
                larger,
                smaller,
                at_tip,
            ],
        }
    };
    outline.edges().zip(edges).map(triangle).collect()
}

fn schlick<T: Scalar>(at: &Weighted<T>) -> T {
    let m2 = at.incidence * at.incidence;
    m2 * m2 * at.incidence
}

/// The larger roughness and the smaller.
fn roughness<T: Scalar>(view: &View<T>) -> [T; 2] {
    let [x, y] = view.alpha;
    [x.max(y), x.min(y)]
}
