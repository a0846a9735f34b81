//! The parameters on the axes of a lookup table, and where its texels are.

use serde::{Deserialize, Serialize};

use crate::{layout::Spacing, math::cbrt, named_list};

/// The smallest alpha of a value. Smoother surfaces have the value of this alpha.
pub(super) const LEAST_ALPHA: f64 = 1e-4;
/// The smallest cosine of a value. Lower views have the value of this cosine.
pub(super) const LEAST_COSINE: f64 = 1e-3;

/// The smallest cosine of the domain in which errors are stated.
pub(super) const DOMAIN_COSINE: f64 = 0.01;
/// Cells have more places in the first of this many parts of an axis, if they have more than [`FEWEST`].
const DENSE: usize = 4;
/// The position of places of a report in their intervals, `2 - (1 + sqrt 5) / 2`. It is irrational, so they are not the
/// places of a fit.
const OFFSET: f64 = 0.381_966_011_250_105;
/// The smallest number of places in a cell.
pub(super) const FEWEST: usize = 2;

named_list! {
    /// The parameter on the axis of roughness.
    pub enum RoughnessAxis {
        /// The cube root of alpha.
        CubeRoot = "cube_root",
        /// Perceptual roughness, the square root of alpha.
        Perceptual = "perceptual",
        /// GGX alpha.
        Alpha = "alpha",
    }
}

named_list! {
    /// The parameter on the axis of the view.
    pub enum CosineAxis {
        /// The cube root of the cosine.
        CubeRoot = "cube_root",
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
    pub enum Texels {
        /// At the centres of the outer texels.
        Corners = "corners",
        /// At the edges of the texture. Lookups within half a texel of an edge are clamped.
        Centres = "centres",
    }
}

/// The parameters of the texels of a table.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct LutAxes {
    /// The parameter on the axis of roughness.
    pub roughness: RoughnessAxis,
    /// The parameter on the axis of the view.
    pub cos_theta: CosineAxis,
    /// Where the parameters 0 and 1 are.
    pub texels: Texels,
}

impl Default for RoughnessAxis {
    fn default() -> Self {
        Self::ALL[0]
    }
}

impl Default for CosineAxis {
    fn default() -> Self {
        Self::ALL[0]
    }
}

impl Default for Texels {
    fn default() -> Self {
        Self::ALL[0]
    }
}

impl RoughnessAxis {
    /// Alpha at a parameter in [0, 1].
    #[must_use]
    pub fn alpha(self, x: f64) -> f64 {
        let alpha = match self {
            Self::CubeRoot => x * x * x,
            Self::Perceptual => x * x,
            Self::Alpha => x,
        };
        alpha.clamp(LEAST_ALPHA, 1.0)
    }

    /// The parameter of an alpha.
    #[must_use]
    pub fn of_alpha(self, alpha: f64) -> f64 {
        match self {
            Self::CubeRoot => cbrt(alpha),
            Self::Perceptual => alpha.sqrt(),
            Self::Alpha => alpha,
        }
    }
}

impl CosineAxis {
    /// The cosine at a parameter in [0, 1].
    #[must_use]
    pub fn cosine(self, x: f64) -> f64 {
        let cosine = match self {
            Self::CubeRoot => x * x * x,
            Self::Root => x * x,
            Self::Cosine => x,
            Self::Complement => 1.0 - x * x,
        };
        cosine.clamp(LEAST_COSINE, 1.0)
    }

    /// The parameter of a cosine.
    #[must_use]
    pub fn of_cosine(self, cosine: f64) -> f64 {
        match self {
            Self::CubeRoot => cbrt(cosine),
            Self::Root => cosine.sqrt(),
            Self::Cosine => cosine,
            Self::Complement => (1.0 - cosine).max(0.0).sqrt(),
        }
    }
}

/// A parameter in [0, 1] on an axis of a table.
#[derive(Debug, Clone, Copy)]
pub(super) enum Parameter {
    /// Roughness, with the smallest alpha of the domain in which errors are stated.
    Roughness(RoughnessAxis, f64),
    Cosine(CosineAxis),
    /// The index of refraction `n` from 1 to 3, by the cube root of `2 (n - 1) / (n + 1)`, because the albedo for low views
    /// is steep near an index of one.
    Index,
    /// An axis of layout `reflected`, with the value at parameter 1 relative to that of the spacing, and the domain.
    Spaced(Spacing, f64, [f64; 2]),
}

impl Parameter {
    /// Alpha, the cosine, the index, or the value of layout `reflected`.
    pub(super) fn value(self, x: f64) -> f64 {
        match self {
            Self::Roughness(axis, _) => axis.alpha(x),
            Self::Cosine(axis) => axis.cosine(x),
            Self::Index => (2.0 + x * x * x) / (2.0 - x * x * x),
            Self::Spaced(spacing, whole, _) => spacing.value(x) * whole,
        }
    }

    /// The parameter of a value.
    pub(super) fn of(self, value: f64) -> f64 {
        match self {
            Self::Roughness(axis, _) => axis.of_alpha(value),
            Self::Cosine(axis) => axis.of_cosine(value),
            Self::Index => cbrt(2.0 * (value - 1.0) / (value + 1.0)),
            Self::Spaced(spacing, whole, _) => spacing.invert(value / whole),
        }
    }

    /// The ends of the domain in which errors are stated. Cosines are from .01.
    pub(super) fn domain(self) -> [f64; 2] {
        let ends = match self {
            Self::Roughness(_, least) => [least, 1.0],
            Self::Cosine(_) => [DOMAIN_COSINE, 1.0],
            Self::Index => [1.0, 3.0],
            Self::Spaced(_, _, domain) => domain,
        };
        let ends = ends.map(|end| self.of(end));
        [ends[0].min(ends[1]), ends[0].max(ends[1])]
    }

    /// `count` evenly spaced parameters within the domain, and its ends. None except the ends is a place of a fit.
    pub(super) fn even(self, count: usize) -> Vec<f64> {
        let [from, to] = self.domain();
        let inner = (0..count).map(|i| from + (to - from) * (i as f64 + OFFSET) / count as f64);
        [from].into_iter().chain(inner).chain([to]).collect()
    }

    /// The parameters at which values are computed for a fit, in rising order: `per_texel` in each cell between texels,
    /// twice as many near smooth surfaces and low views, with all texels; for one in each cell, three in two cells. The
    /// nearest two are moved onto the ends of the domain.
    pub(super) fn places(self, filter: Texels, texels: usize, per_texel: usize) -> Vec<f64> {
        let is_falling = self.value(0.0) > self.value(1.0);
        let cells = if filter == Texels::Corners { texels - 1 } else { texels };
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
        for end in self.domain() {
            let after = places.partition_point(|x| *x < end).clamp(1, places.len() - 1);
            let nearest = if end - places[after - 1] < places[after] - end { after - 1 } else { after };
            places[nearest] = end;
        }
        places
    }
}

/// A place of a fit on an axis.
#[derive(Debug)]
pub(super) struct AxisPlace {
    /// The texel below.
    pub(super) below: usize,
    /// The weight of the next texel.
    pub(super) next: f64,
    /// The length of the axis for which the place stands. Zero outside the domain.
    pub(super) weight: f64,
}

/// An axis of a fit.
#[derive(Debug)]
pub(super) struct Axis {
    /// The number of texels.
    pub(super) texels: usize,
    /// The places at which values are known.
    pub(super) places: Vec<AxisPlace>,
}

impl Axis {
    /// The axes of a recipe's grid, with places at `parameters`.
    pub(super) fn all(grid: Vec<(Parameter, usize)>, filter: Texels, parameters: &[Vec<f64>]) -> Vec<Self> {
        let axes = grid.into_iter().zip(parameters);
        axes.map(|((parameter, texels), places)| Self::new(parameter, filter, texels, places)).collect()
    }

    /// The axis with places at `parameters`.
    fn new(parameter: Parameter, filter: Texels, texels: usize, parameters: &[f64]) -> Self {
        let [from, to] = parameter.domain();
        let last = parameters.len() - 1;
        let places = parameters.iter().enumerate().map(|(i, x)| {
            let (below, next) = filter.filter(*x, texels);
            let length = parameters[(i + 1).min(last)] - parameters[i.saturating_sub(1)];
            let weight = if (from..=to).contains(x) { length * last as f64 } else { 0.0 };
            AxisPlace { below, next, weight }
        });
        Self { texels, places: places.collect() }
    }
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
