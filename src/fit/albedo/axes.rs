//! The axes of a lookup table: their parameters, their texels, and the places at which values are known.

use std::f64::consts::FRAC_PI_2;

use serde::{Deserialize, Serialize};

use crate::{
    axes::PerAxis,
    layout::{Layout, Spacing},
    math::cbrt,
    named_list,
};

/// Cells have more places in the first of this many parts of an axis, if they have more than [`FEWEST`].
const DENSE: usize = 4;
/// The position of places of a report in their intervals, `2 - (1 + sqrt 5) / 2`. It is irrational, so they are not the
/// places of a fit.
const OFFSET: f64 = 0.381_966_011_250_105;
/// The smallest number of places in a cell.
pub(super) const FEWEST: usize = 2;

/// A map from parameters in [0, 1] to values, and its inverse.
pub(super) type Curve = [fn(f64) -> f64; 2];

/// The index of refraction `n` by the cube root of `2 (n - 1) / (n + 1)`, because the albedo for low views is steep
/// near an index of one.
pub(super) const INDEX: Curve = [|x| (2.0 + x * x * x) / (2.0 - x * x * x), |n| cbrt(2.0 * (n - 1.0) / (n + 1.0))];
/// The axes of layout `reflected`.
pub(super) const ALPHA: Curve = [|x| reflected().alpha.value(x), |alpha| reflected().alpha.invert(alpha)];
pub(super) const RATIO: Curve = [|x| reflected().ratio.value(x), |ratio| reflected().ratio.invert(ratio)];
pub(super) const THETA: Curve = [|x| reflected().theta.value(x), |theta| reflected().theta.invert(theta)];
pub(super) const PHI: Curve = [|x| x * FRAC_PI_2, |phi| phi / FRAC_PI_2];

fn reflected() -> PerAxis<Spacing> {
    Layout::Reflected.rules().spacing()
}

named_list! {
    /// The parameter on the axis of roughness or of the view.
    #[derive(Default)]
    pub enum AxisParameter {
        /// The cube root of alpha or of the cosine.
        #[default]
        CubeRoot = "cube_root",
        /// Perceptual roughness, the square root of alpha.
        Perceptual = "perceptual",
        /// GGX alpha.
        Alpha = "alpha",
        /// The square root of the cosine.
        Root = "root",
        /// The cosine between view and normal.
        Cosine = "cosine",
        /// The square root of one minus the cosine.
        Complement = "complement",
    }
}

named_list! {
    /// Where the parameters 0 and 1 are in a texture.
    #[derive(Default)]
    pub enum Texels {
        /// At the centres of the outer texels.
        #[default]
        Corners = "corners",
        /// At the edges of the texture. Lookups within half a texel of an edge are clamped.
        Centres = "centres",
    }
}

/// The parameters of the texels of a table.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct LutAxes {
    /// One of [`AxisParameter::ROUGHNESS`].
    pub roughness: AxisParameter,
    /// One of [`AxisParameter::COS_THETA`].
    pub cos_theta: AxisParameter,
    /// Where the parameters 0 and 1 are.
    pub texels: Texels,
}

impl AxisParameter {
    /// The parameters of roughness, the default first.
    pub const ROUGHNESS: [Self; 3] = [Self::CubeRoot, Self::Perceptual, Self::Alpha];
    /// The parameters of the view, the default first.
    pub const COS_THETA: [Self; 4] = [Self::CubeRoot, Self::Root, Self::Cosine, Self::Complement];

    /// Alpha or the cosine as a function of the parameter.
    pub(super) fn curve(self) -> Curve {
        match self {
            Self::CubeRoot => [|x| x * x * x, cbrt],
            Self::Perceptual | Self::Root => [|x| x * x, f64::sqrt],
            Self::Alpha | Self::Cosine => [|x| x, |value| value],
            Self::Complement => [|x| 1.0 - x * x, |cosine| (1.0 - cosine).max(0.0).sqrt()],
        }
    }
}

/// An axis of a table.
#[derive(Debug, Clone)]
pub(super) struct Axis {
    pub(super) name: &'static str,
    curve: Curve,
    /// The parameters at the ends of the domain in which errors are stated.
    domain: [f64; 2],
    filter: Texels,
    /// The number of texels.
    pub(super) texels: usize,
    /// The parameters of the places at which values are known, in rising order.
    pub(super) places: Vec<f64>,
}

impl Axis {
    /// An axis without places. `domain` has the values at its ends.
    pub(super) fn new(name: &'static str, curve: Curve, domain: [f64; 2], filter: Texels, texels: usize) -> Self {
        let [one, other] = domain.map(curve[1]);
        Self { name, curve, domain: [one.min(other), one.max(other)], filter, texels, places: vec![] }
    }

    /// The value at a parameter.
    pub(super) fn value(&self, x: f64) -> f64 {
        self.curve[0](x)
    }

    /// The parameter of a value.
    pub(super) fn parameter(&self, value: f64) -> f64 {
        self.curve[1](value)
    }

    /// The texel below a parameter and the weight of the next texel.
    pub(super) fn filter(&self, x: f64) -> (usize, f64) {
        self.filter.filter(x, self.texels)
    }

    /// The length of the axis for which a place stands, relative to the mean. Zero outside the domain.
    pub(super) fn weight(&self, place: usize) -> f64 {
        let (last, [from, to]) = (self.places.len() - 1, self.domain);
        let length = self.places[(place + 1).min(last)] - self.places[place.saturating_sub(1)];
        if (from..=to).contains(&self.places[place]) { length * last as f64 } else { 0.0 }
    }

    /// The parameters of the texels.
    pub(super) fn texel_centres(&self) -> Vec<f64> {
        (0..self.texels).map(|i| self.filter.parameter(i, self.texels)).collect()
    }

    /// `count` evenly spaced parameters within the domain, and its ends. None except the ends is a place of a fit.
    pub(super) fn even(&self, count: usize) -> Vec<f64> {
        let [from, to] = self.domain;
        let inner = (0..count).map(|i| from + (to - from) * (i as f64 + OFFSET) / count as f64);
        [from].into_iter().chain(inner).chain([to]).collect()
    }

    /// The parameters at which values are computed for a fit, in rising order: `per_texel` in each cell between texels,
    /// twice as many near smooth surfaces and low views, with all texels; for one in each cell, three in two cells. The
    /// nearest two are moved onto the ends of the domain.
    pub(super) fn fit_places(&self, per_texel: usize) -> Vec<f64> {
        let is_falling = self.value(0.0) > self.value(1.0);
        let cells = if self.filter == Texels::Corners { self.texels - 1 } else { self.texels };
        let within = |cell: usize| {
            let from_dense_end = if is_falling { cells - 1 - cell } else { cell };
            let is_dense = per_texel > FEWEST && DENSE * from_dense_end < cells;
            let steps = if is_dense { 2 * per_texel } else { per_texel };
            (0..steps).map(move |i| (cell as f64 + i as f64 / steps as f64) / cells as f64)
        };
        let mut places: Vec<f64> = if per_texel < FEWEST {
            let steps = (cells * 3).div_ceil(2);
            (0..=steps).map(|i| i as f64 / steps as f64).collect()
        } else {
            (0..cells).flat_map(within).chain([1.0]).collect()
        };
        for end in self.domain {
            let after = places.partition_point(|x| *x < end).clamp(1, places.len() - 1);
            let nearest = if end - places[after - 1] < places[after] - end { after - 1 } else { after };
            places[nearest] = end;
        }
        places
    }
}

/// The number of places on all axes together.
pub(super) fn count(axes: &[Axis]) -> usize {
    axes.iter().map(|axis| axis.places.len()).product()
}

impl Texels {
    /// The texel below a parameter and the weight of the next texel, as linear filters compute them with clamped
    /// edges. Domain: `texels` is at least 2.
    #[must_use]
    pub fn filter(self, x: f64, texels: usize) -> (usize, f64) {
        let last = (texels - 1) as f64;
        let at = match self {
            Self::Centres => (x * texels as f64 - 0.5).clamp(0.0, last),
            Self::Corners => x.clamp(0.0, 1.0) * last,
        };
        let below = (at as usize).min(texels - 2);
        (below, at - below as f64)
    }

    /// The parameter at a texel.
    #[must_use]
    pub fn parameter(self, texel: usize, texels: usize) -> f64 {
        match self {
            Self::Centres => (texel as f64 + 0.5) / texels as f64,
            Self::Corners => texel as f64 / (texels - 1) as f64,
        }
    }
}
