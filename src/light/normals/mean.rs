//! The mean weight over a region of normals, from numbers of the region and a network's outputs.

use super::{
    arcs::AnglePerSine,
    outline::{Corner, Outline},
    view::{View, Weighted},
};
use ltcforge_fit::math::{Scalar, Triple, cross, dot, minus, plus, scaled};

/// The largest number of inputs of a network.
pub const INPUTS: usize = 12;
/// The number of outputs of a network.
pub const OUTPUTS: usize = 4;

/// A region of the visible normals: all normals that reflect a light, or a triangle of them.
#[derive(Debug, Clone, Copy)]
pub struct Region<T> {
    /// The part of the visible normals in the region; negative for a triangle that overlaps other triangles.
    pub part: T,
    /// The weight at the mean normal of the region.
    pub at_mean: T,
    /// Schlick's factor at the mean normal of the region, `(1 - wo . h)^5`.
    pub schlick: T,
    /// The weight at the mean rise of the corners; see `View::rise`.
    pub at_corners: T,
    /// For a triangle, the weight at the light's mean normal, which is its tip. For the whole region, the weight at its
    /// own mean normal.
    pub at_tip: T,
    /// The inputs of the network.
    pub inputs: [T; INPUTS],
}

impl<T: Scalar> Region<T> {
    /// The mean weight over the region, and the mean weight times Schlick's factor, from the outputs of a network.
    ///
    /// The mean is a blend of the weights at the mean normal, the corners and the tip, with shares from the network,
    /// plus a correction times the region's part. A small region has a single weight, independent of the network.
    #[must_use]
    pub fn mean(&self, [more, more_schlick, corners, tip]: [T; OUTPUTS]) -> [T; 2] {
        let known = self.at_mean + corners * (self.at_corners - self.at_mean) + tip * (self.at_tip - self.at_mean);
        let size = self.part.abs();
        let mean = (known + size * more).max(T::ZERO).min(T::ONE);
        [mean, (mean * self.schlick + size * more_schlick).max(T::ZERO).min(mean)]
    }
}

/// The whole region of a light. `flux` is the integral of `c x dc` around its image, with a sign that makes `visible`,
/// its part of the visible normals, positive.
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

/// The triangles between the mean normal of a light's region and the images of its edges. `edges` are the integrals of
/// the images. `to_part` is the factor from an integral's component along `A wo` to the part of the visible normals.
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

/// The larger and the smaller roughness.
fn roughness<T: Scalar>(view: &View<T>) -> [T; 2] {
    let [x, y] = view.alpha;
    [x.max(y), x.min(y)]
}
