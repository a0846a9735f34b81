//! An LTC on the plane of a light.
//!
//! In the space where the distribution is the clamped cosine, a piece of the light's plane at P has the weight
//! `z / |P|^4` times its area. `|P|^2` is exactly quadratic on the plane, so `|P|^-4` is exactly a bump. Its centre is
//! the foot of the perpendicular from the shaded point. Its radii are the distance of the foot, mapped back to the
//! light.

use super::{
    bump::{Bump, across, dot2, eigen, step},
    readings::Lobe,
    rectangle::Rectangle,
};
use crate::CosineSpace;
use ltcforge_fit::math::{Scalar, dot};

/// The cosine assumed for points on or below the horizon. It keeps the sum of weights positive.
const LEAST_COSINE: f64 = 1e-6;
/// The lower limit of the smaller eigenvalue, relative to the larger one. It limits the longer axis to a length that
/// f32 resolves.
const LEAST_RATIO: f64 = 1e-7;
/// The smallest eigenvalue, times the light's area divided by the squared distance of its first corner. Below it a bump
/// is practically infinite. Fitted tables reach neither limit.
const LEAST_SECOND: f64 = 1e-8;

/// The light of an LTC on the plane of a rectangle.
pub(super) struct CosineLobe<'a, T> {
    space: &'a CosineSpace<T>,
    rectangle: &'a Rectangle<T>,
}

impl<'a, T: Scalar> CosineLobe<'a, T> {
    pub(super) fn new(space: &'a CosineSpace<T>, rectangle: &'a Rectangle<T>) -> Self {
        Self { space, rectangle }
    }

    /// The bump `|P|^-4`. With the sides `e`, `|P|^2 = |corner|^2 + 2 corner . e x + x . G x`, `G = e . e`.
    pub(super) fn bump(&self) -> Bump<T> {
        let [x, y] = self.rectangle.axes.map(|axis| self.space.of(axis));
        let corner = self.space.of(self.rectangle.corner);
        let (values, long) = eigen([dot(x, x), dot(x, y), dot(y, y)]);
        let least =
            (T::of(LEAST_RATIO) * values[1]).max(T::of(LEAST_SECOND) * dot(corner, corner) / self.rectangle.area());
        let [w1, w2] = values.map(|value| value.max(least).max(T::SHORTEST));
        let fall = [-dot(corner, x), -dot(corner, y)];
        let short = across(long);
        let middle = step(step([T::ZERO; 2], dot2(fall, long) / w1, long), dot2(fall, short) / w2, short);
        let foot = self.space.of(self.rectangle.at(middle));
        let distance2 = dot(foot, foot).max(T::SHORTEST);
        Bump { middle, long, radii2: [distance2 / w1, distance2 / w2] }
    }
}

impl<T: Scalar> Lobe<T> for CosineLobe<'_, T> {
    /// `z / |P|^4` divided by the bump. The bump is `|P|^-4` up to a factor, so only z remains.
    fn weight(&self, _: &Bump<T>, p: [T; 2]) -> T {
        let p = self.space.of(self.rectangle.at(p));
        p[2].max(T::ZERO) + T::of(LEAST_COSINE) * dot(p, p).sqrt().max(T::SHORTEST)
    }

    /// The height above the distribution's own horizon, which bounds the light.
    fn height(&self, p: [T; 2]) -> T {
        self.space.of(self.rectangle.at(p))[2]
    }
}
