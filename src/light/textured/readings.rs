//! Chooses the points where a prefiltered picture is read for a lobe.
//!
//! The integral of a bump across its longer axis is `(1 + t^2)^-1.5` as a function of t, the position along the axis in
//! radii. As a density in `s = t / sqrt(1 + t^2)` it is constant. So the part of the longer axis within the rectangle
//! and above the horizon is divided evenly in s. Each part has one reading, with a round kernel as wide as the bump
//! there, `radius (1 + t^2)^(1/2)`, plus a part of the gap to its neighbours. Round kernels also spread along the axis,
//! so t is in units of `sqrt(long radius^2 - short radius^2)`. Weights correct the rest: the weight of a reading is the
//! lobe divided by the bump at its point.

use super::{
    LightPyramid,
    bump::{Bump, dot2, step},
    rectangle::Rectangle,
};
use ltcforge_fit::{math::Scalar, named_list};

named_list! {
    /// The number of readings of a picture for a light.
    pub enum Readings {
        /// Four readings.
        Four = "4",
        /// One reading.
        One = "1",
        /// Two readings.
        Two = "2",
        /// Six readings.
        Six = "6",
    }
}

impl Readings {
    /// The number of readings.
    #[must_use]
    pub fn count(self) -> usize {
        match self {
            Self::One => 1,
            Self::Two => 2,
            Self::Four => 4,
            Self::Six => 6,
        }
    }

    /// The factor of a bump's radius, and the part of the gap between two readings that is added to the radius. A grid
    /// search over the lights of docs/textured.md found values close to these. A change by a tenth has little effect.
    fn widths(self) -> [f64; 2] {
        [if self == Self::One { 1.25 } else { 0.95 }, 0.35]
    }
}

/// The light of a lobe on the plane of a rectangle.
pub(super) trait Lobe<T> {
    /// The density of the lobe at a point, divided by the lobe's bump there, up to a factor.
    fn weight(&self, bump: &Bump<T>, p: [T; 2]) -> T;
    /// The height of a point above the plane that bounds the lobe, up to a factor; a linear function.
    fn height(&self, p: [T; 2]) -> T;
}

/// One reading of a prefiltered picture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reading<T> {
    /// The point, in parts of the picture's width and height.
    pub uv: [T; 2],
    /// The radius of the kernel, divided by the square root of the light's area.
    pub radius: T,
    /// The weight of the reading.
    pub weight: T,
}

/// The weighted mean of readings of a picture; black without readings.
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

/// The absolute value of t that counts as infinite.
const FAR: f64 = 1e4;
/// The smallest difference of the radii, relative to the longer radius. A round bump has no axis.
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
        // For large t, s has few digits. If both ends are equal, t is clamped to them.
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

/// The interval of t in which `middle + t along` is within the rectangle and above the plane that bounds the lobe. If
/// it is empty, both ends are the midpoint between the two bounds.
fn within<T: Scalar>(lobe: &impl Lobe<T>, rectangle: &Rectangle<T>, middle: [T; 2], along: [T; 2]) -> [T; 2] {
    let far = T::of(FAR);
    let height = lobe.height(middle);
    let rise = lobe.height(step(middle, T::ONE, along)) - height;
    let [w, h] = rectangle.size;
    // Each border is where a linear function becomes zero; inside it is positive.
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
