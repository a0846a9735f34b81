//! What to fit: a complete, checked description from which every byte of a table follows.
//!
//! Invariant: no defaults and no JSON here; [`crate::files::recipe`] reads documents and fills presets in.

use serde::{Deserialize, Serialize};

use crate::fit::ltc::{Layout, PerAxis};

/// Version of the fitter. Raised whenever the same recipe gives other bytes.
pub const FITTER_VERSION: u32 = 2;

/// The scattering model that is fitted.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum BrdfKind {
    /// Anisotropic GGX with height-correlated Smith masking.
    Ggx,
}

/// The distance between lobe and LTC that the fit minimises.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Metric {
    /// Sliced Wasserstein-1 distance [KT et al. 2022, equation 9].
    Sw1,
}

/// How the distance is minimised.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Solver {
    /// BFGS on the seven free numbers, over fixed low-discrepancy samples.
    Bfgs,
    /// Stochastic gradient descent on all nine, over random samples [KT et al. 2022, Algorithm 3].
    Sgd,
}

/// Number format of the stored table.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Precision {
    /// IEEE 754 binary32.
    F32,
    /// IEEE 754 binary16, what textures of half floats hold.
    F16,
}

/// How hard each entry is fitted.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FitSettings {
    /// What is minimised.
    pub metric: Metric,
    /// How.
    pub solver: Solver,
    /// Samples of the LTC in each evaluation.
    pub samples: u32,
    /// Directions that the samples are projected on.
    pub directions: u32,
    /// Most steps (solver `bfgs` stops earlier when it has converged; `sgd` takes all).
    pub steps: u32,
    /// Shifts the sample sequences of `bfgs`, seeds the generator of `sgd`.
    pub seed: u64,
}

/// A complete recipe. Equal recipes give equal bytes.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Recipe {
    /// [`FITTER_VERSION`] that the recipe is meant for.
    pub fitter: u32,
    /// Scattering model.
    pub brdf: BrdfKind,
    /// Layout of the table.
    pub layout: Layout,
    /// Nodes on each axis.
    pub resolution: PerAxis<u32>,
    /// Lowest and highest value on each axis.
    pub range: PerAxis<[f64; 2]>,
    /// Fit settings.
    pub fit: FitSettings,
    /// Whether amplitude and Fresnel terms are stored.
    pub terms: bool,
    /// Number format of the table.
    pub precision: Precision,
}

impl Recipe {
    /// Entries of the table: the product of the resolutions.
    #[must_use]
    pub fn entries(&self) -> u64 {
        // Four u32 do not overflow u128, and a recipe past the entry limit never gets here; saturating keeps
        // the bare function total.
        let product: u128 = self.resolution.named().iter().map(|(_, n)| u128::from(**n)).product();
        u64::try_from(product).unwrap_or(u64::MAX)
    }
}
