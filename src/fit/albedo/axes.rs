//! The parameters on the axes of a lookup table, and where its texels are.

use serde::{Deserialize, Serialize};

use crate::named_list;

/// The smallest alpha of a value. Smoother surfaces have the value of this alpha.
const LEAST_ALPHA: f64 = 1e-4;
/// The smallest cosine of a value. Lower views have the value of this cosine.
const LEAST_COSINE: f64 = 1e-3;

named_list! {
    /// The parameter on the axis of roughness.
    pub enum RoughnessAxis {
        /// Perceptual roughness, the square root of alpha.
        Perceptual = "perceptual",
        /// GGX alpha.
        Alpha = "alpha",
    }
}

named_list! {
    /// The parameter on the axis of the view.
    pub enum CosineAxis {
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
        let alpha = if self == Self::Perceptual { x * x } else { x };
        alpha.clamp(LEAST_ALPHA, 1.0)
    }

    /// The parameter of an alpha.
    #[must_use]
    pub fn of_alpha(self, alpha: f64) -> f64 {
        if self == Self::Perceptual { alpha.sqrt() } else { alpha }
    }
}

impl CosineAxis {
    /// The cosine at a parameter in [0, 1].
    #[must_use]
    pub fn cosine(self, x: f64) -> f64 {
        let cosine = match self {
            Self::Cosine => x,
            Self::Root => x * x,
            Self::Complement => 1.0 - x * x,
        };
        cosine.clamp(LEAST_COSINE, 1.0)
    }

    /// The parameter of a cosine.
    #[must_use]
    pub fn of_cosine(self, cosine: f64) -> f64 {
        match self {
            Self::Cosine => cosine,
            Self::Root => cosine.sqrt(),
            Self::Complement => (1.0 - cosine).max(0.0).sqrt(),
        }
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
