//! The mean weight over the visible normals that reflect a light, from values of their region and a network's outputs.

use super::{NormalsRule, view::View};
use ltcforge_fit::math::{Scalar, Triple, dot, minus};

/// The largest number of inputs of a network.
pub const INPUTS: usize = 12;
/// The number of outputs of a network.
pub const OUTPUTS: usize = 5;

/// The visible normals that reflect a light. The weight and Schlick's factor are known at their mean and along their
/// outline.
#[derive(Debug, Clone, Copy)]
pub struct Region<T> {
    /// The part V of the visible normals that reflect the light.
    pub visible: T,
    /// The integral of `c x dc` around the image. It points along the mean normal.
    pub flux: Triple<T>,
    /// The weight at the mean normal.
    pub at_mean: T,
    /// Schlick's factor at the mean normal, `(1 - wo . h)^5`.
    pub schlick: T,
    /// The weight at the mean rise of the outline; see `View::rise`.
    pub at_rise: T,
    /// The mean weight of the outline, and its mean Schlick factor.
    pub outline: [T; 2],
    /// The extent of the region, from 0 for a small one to 1.
    pub extent: T,
    /// The inputs of the network.
    pub inputs: [T; INPUTS],
}

impl<T: Scalar> Region<T> {
    /// The mean weight over the region, and the mean weight times Schlick's factor, from the outputs of a network.
    ///
    /// The mean is a blend of the weights at the mean normal and along the outline, plus a correction proportional to
    /// the extent. The result needs no clamp, which would draw contours into highlights. For a small region all weights
    /// are equal and the network has no influence.
    #[must_use]
    pub fn mean(&self, [at_mean, more, more_schlick, at_outline, schlick_at_outline]: [T; OUTPUTS]) -> [T; 2] {
        let moved = |x: T, more: T| x * (T::ONE + self.extent * bounded(more) * (T::ONE - x));
        let blend = |a: T, b: T, share: T| a + share * (b - a);
        let outline = blend(self.at_rise, self.outline[0], share(at_outline));
        let weight = moved(blend(outline, self.at_mean, share(at_mean)), more);
        let half = T::of(0.5);
        let schlick = blend(self.schlick, self.outline[1], half + half * bounded(schlick_at_outline));
        [weight, weight * moved(schlick, more_schlick)]
    }
}

/// A smooth step from 0 to 1.
fn share<T: Scalar>(x: T) -> T {
    let x = x.max(T::ZERO).min(T::ONE);
    x * x * (T::of(3.0) - x - x)
}

/// A smooth function with values between -1 and 1.
fn bounded<T: Scalar>(x: T) -> T {
    x / (T::ONE + x.abs())
}

/// Sums over the outline of a region, weighted by the size of each edge among the visible normals.
#[derive(Debug, Clone, Copy)]
pub(super) struct Outlined<T> {
    /// The sum of the sizes.
    size: T,
    /// Sums of the weight, its square, the rise, and the weight times Schlick's factor. An edge on the horizon adds
    /// zeros.
    sums: [T; 4],
}

impl<T: Scalar> Outlined<T> {
    pub(super) const NONE: Self = Self { size: T::ZERO, sums: [T::ZERO; 4] };

    /// Adds the image of an edge, which begins at `from`. `samples` are points on or near the image.
    pub(super) fn add(&mut self, view: &View<T>, from: Triple<T>, middle: Triple<T>, samples: &[Triple<T>]) {
        let half = minus(middle, from);
        // Rounding can move the middle of a long edge beyond the visible normals.
        let size = dot(half, half).sqrt() * dot(middle, view.stretched).max(T::ZERO);
        self.size = self.size + size;
        let each = size / T::of(samples.len().max(1) as f64);
        for sample in samples {
            let at = view.at(*sample);
            let rise = view.rise(view.reflected(*sample));
            let of = [at.weight, at.weight * at.weight, rise, at.weight * fifth(at.incidence)];
            self.sums = std::array::from_fn(|i| self.sums[i] + each * of[i]);
        }
    }

    fn means(&self) -> [T; 4] {
        let per_size = T::ONE / self.size.max(T::of(1e-20));
        self.sums.map(|sum| sum * per_size)
    }
}

/// The region of a light by the outline of its image. `flux` is the integral of `c x dc` around the image, with a sign
/// that makes `visible`, its part of the visible normals, positive.
pub(super) fn by_outline<T: Scalar>(
    view: &View<T>,
    outlined: &Outlined<T>,
    flux: Triple<T>,
    visible: T,
    rule: NormalsRule,
) -> Region<T> {
    let at = view.at(flux);
    let [weight, square, rise, schlick] = outlined.means();
    let at_rise = view.weight_of(rise);
    let [larger, smaller] = roughness(view);
    let size2 = outlined.size * outlined.size;
    let start = [visible, view.rise, at.weight, at.incidence, larger, smaller, at_rise, weight];
    let (extent, rest) = if rule == NormalsRule::Balanced {
        (size2, [outlined.size, T::ZERO, T::ZERO, T::ZERO])
    } else {
        let extent = size2 + T::of(3.0) * visible;
        let per_length = T::ONE / dot(flux, flux).max(T::of(1e-30)).sqrt();
        let along = dot(flux, view.stretched) * per_length / view.length;
        let spread = (square - weight * weight).max(T::ZERO).sqrt();
        (extent, [extent / (extent + T::ONE), flux[2].abs() * per_length, along, spread])
    };
    let mut inputs = [T::ZERO; INPUTS];
    inputs[..8].copy_from_slice(&start);
    inputs[8..].copy_from_slice(&rest);
    Region {
        visible,
        flux,
        at_mean: at.weight,
        schlick: fifth(at.incidence),
        at_rise,
        outline: [weight, schlick / (weight + T::of(1e-6))],
        extent: extent / (extent + T::ONE),
        inputs,
    }
}

/// The region of a light by its corners, without samples of the outline.
pub(super) fn by_corners<T: Scalar>(view: &View<T>, vertices: &[Triple<T>], flux: Triple<T>, visible: T) -> Region<T> {
    let at = view.at(flux);
    let rise = vertices.iter().fold(T::ZERO, |sum, v| sum + view.rise(*v)) / T::of(vertices.len() as f64);
    let at_rise = view.weight_of(rise);
    let schlick = fifth(at.incidence);
    let per_length = T::ONE / dot(flux, flux).max(T::of(1e-30)).sqrt();
    let [larger, smaller] = roughness(view);
    let mut inputs = [T::ZERO; INPUTS];
    let upright = flux[2].abs() * per_length;
    inputs[..8].copy_from_slice(&[visible, view.rise, at.weight, at.incidence, upright, larger, smaller, at_rise]);
    Region { visible, flux, at_mean: at.weight, schlick, at_rise, outline: [at_rise, schlick], extent: visible, inputs }
}

/// Schlick's factor from `1 - wo . h`.
fn fifth<T: Scalar>(incidence: T) -> T {
    let square = incidence * incidence;
    square * square * incidence
}

/// The larger and the smaller roughness.
fn roughness<T: Scalar>(view: &View<T>) -> [T; 2] {
    let [x, y] = view.alpha;
    [x.max(y), x.min(y)]
}
