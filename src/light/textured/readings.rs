//! Where a prefiltered picture is read for a lobe.
//!
//! Across its longer axis a bump integrates to `(1 + t^2)^-1.5` along it, for t in radii; with `s = t / sqrt(1 + t^2)` that is
//! even in s. So the longer axis, as far as it lies within the rectangle and above the horizon, is divided evenly in s. Each
//! part is read once, with a round kernel as wide as the bump there, `radius (1 + t^2)^(1/2)`, and more by the gap to its neighbours. Because round
//! kernels spread along the axis too, t is in units of `sqrt(long radius^2 - short radius^2)`. The rest is left to weights: that
//! of a reading is the lobe over the bump at its place.

use super::{
    LightPyramid,
    bump::{Bump, dot2, step},
    rectangle::Rectangle,
};
use ltcforge_fit::{math::Scalar, named_list};

named_list! {
    /// How often a picture is read for a light.
    pub enum Readings {
        /// Four times.
        Four = "4",
        /// Once.
        One = "1",
        /// Twice.
        Two = "2",
        /// Six times.
        Six = "6",
    }
}

impl Readings {
    /// The number.
    #[must_use]
    pub fn count(self) -> usize {
        match self {
            Self::One => 1,
            Self::Two => 2,
            Self::Four => 4,
            Self::Six => 6,
        }
    }

    /// The factor on a bump's radius, and how much of the gap between two readings is added to it: about the best of a grid
    /// over the lights of docs/textured.md, where a tenth more or less changes little.
    fn widths(self) -> [f64; 2] {
        [if self == Self::One { 1.25 } else { 0.95 }, 0.35]
    }
}

/// The light of a lobe on the plane of a rectangle.
pub(super) trait Lobe<T> {
    /// The weight of a point's surroundings, divided by that of the lobe's bump there, up to a factor.
    fn weight(&self, bump: &Bump<T>, p: [T; 2]) -> T;
    /// How far a point is above where the lobe ends, up to a factor; linear.
    fn height(&self, p: [T; 2]) -> T;
}

/// One reading of a prefiltered picture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reading<T> {
    /// Where, in parts of the picture's width and height.
    pub uv: [T; 2],
    /// The radius of the kernel, over the root of the light's area.
    pub radius: T,
    /// How much it counts.
    pub weight: T,
}

/// The mean of readings of a picture, by their weights; black for none.
#[must_use]
pub fn colour(readings: &[Reading<f64>], pyramid: &LightPyramid) -> [f64; 3] {
    let (mut sum, mut weights) = ([0.0; 3], 0.0);
    let base = &pyramid.levels()[0];
    let texels = ((base.width() * base.height()) as f64).sqrt();
    for reading in readings {
        let texel = pyramid.fetch(reading.uv, LightPyramid::level_of(reading.radius * texels));
        weights += reading.weight;
        sum = [0, 1, 2].map(|channel| sum[channel] + reading.weight * texel[channel]);
    }
    if weights > 0.0 { sum.map(|sum| sum / weights) } else { sum }
}

/// So many units along an axis are endless.
const FAR: f64 = 1e4;
/// A lobe that is round has no axis; this part of its radius stands for the missing difference.
const ROUND: f64 = 1e-6;

/// The readings of a picture on a rectangle.
pub(super) fn readings<T: Scalar>(
    lobe: &impl Lobe<T>,
    rectangle: &Rectangle<T>,
    bump: &Bump<T>,
    number: Readings,
) -> Vec<Reading<T>> {
    let [long2, short2] = bump.radii2;
    let unit = (long2 - short2).max(T::of(ROUND * ROUND) * long2).sqrt();
    let along = bump.long.map(|x| x * unit);
    let [t0, t1] = within(lobe, rectangle, bump.middle, along);
    let [s0, s1] = [t0, t1].map(|t| t / (T::ONE + t * t).sqrt());
    let part = (s1 - s0) / T::of(number.count() as f64);
    let [of_radius, of_gap] = number.widths().map(T::of);
    let reading = |k: usize| {
        let s = s0 + part * T::of(k as f64 + 0.5);
        // Far out s has few digits left: where both ends are one, t is that.
        let t = (s / (T::ONE - s * s).max(T::of(1e-12)).sqrt()).max(t0).min(t1);
        let stretch2 = T::ONE + t * t;
        let gap = of_gap * unit * (part * stretch2 * stretch2.sqrt()).min(t1 - t0);
        let wanted = step(bump.middle, t, along);
        let p = rectangle.clamped(wanted);
        let moved = [wanted[0] - p[0], wanted[1] - p[1]];
        let radius2 = of_radius * of_radius * (short2 * stretch2 + gap * gap) + dot2(moved, moved);
        Reading {
            uv: [0, 1].map(|i| p[i] / rectangle.size[i]),
            radius: (radius2 / rectangle.area()).sqrt(),
            weight: lobe.weight(bump, p),
        }
    };
    (0..number.count()).map(reading).collect()
}

/// From where to where `middle + t along` is within the rectangle and above the lobe's end. Where nothing is, both are the
/// middle of what the one leaves and the other begins with.
fn within<T: Scalar>(lobe: &impl Lobe<T>, rectangle: &Rectangle<T>, middle: [T; 2], along: [T; 2]) -> [T; 2] {
    let far = T::of(FAR);
    let height = lobe.height(middle);
    let rise = lobe.height(step(middle, T::ONE, along)) - height;
    let [w, h] = rectangle.size;
    // Each is where a linear function is not negative.
    let borders = [
        (middle[0], along[0]),
        (w - middle[0], -along[0]),
        (middle[1], along[1]),
        (h - middle[1], -along[1]),
        (height, rise),
    ];
    let (mut from, mut to) = (-far, far);
    for (value, slope) in borders {
        let t = (-value / if slope.abs() > T::SHORTEST { slope } else { T::SHORTEST }).max(-far).min(far);
        if slope < T::ZERO {
            to = to.min(t);
        } else {
            from = from.max(t);
        }
    }
    let middle = T::of(0.5) * (from + to);
    if from > to { [middle, middle] } else { [from, to] }
}
