//! Recipes: complete, checked descriptions of a fit. They determine every byte of a table.
//!
//! Invariant: no defaults and no JSON. `ltcforge_files::recipe_document` reads documents and fills in presets.

use serde::{Serialize, Serializer};

use super::{
    axes::PerAxis,
    brdf::{BrdfKind, BrdfModel},
    given::GivenNodes,
    layout::{Layout, Precision},
    lobe::LobeModel,
    metric::Metric,
    solver::{Simplex, Solver},
};

/// Version of the fitter. It increases whenever a recipe gives different bytes than before.
pub const FITTER_VERSION: u32 = 4;

/// The effort and method of the fit.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct FitSettings {
    /// The distance that the fit minimises.
    #[doc(hidden)]
    pub metric: Metric,
    /// The method of minimisation.
    #[doc(hidden)]
    pub solver: Solver,
    /// Samples of the LTC in each evaluation.
    #[doc(hidden)]
    pub samples: u32,
    /// Directions of the projections.
    #[doc(hidden)]
    pub directions: u32,
    /// The largest number of steps. Solver `bfgs` stops earlier if it has converged; `sgd` takes all steps.
    #[doc(hidden)]
    pub steps: u32,
    /// Shifts the sample sequences of `bfgs`, and seeds the generator of `sgd`.
    #[doc(hidden)]
    pub seed: u64,
    /// The settings of a solver with a simplex. The canonical form contains them only for such a solver, so the digests
    /// of older recipes do not change.
    #[serde(flatten, skip_serializing_if = "Option::is_none")]
    #[doc(hidden)]
    pub simplex: Option<Simplex>,
}

/// The terms stored with the lobes. In a recipe they are `true`, `false` or `"f82"`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StoredTerms {
    /// No terms.
    None,
    /// Amplitude and Fresnel term, for Schlick's Fresnel factor.
    Schlick,
    /// Amplitude, Fresnel term and edge term, for metals with the F82 factor.
    F82,
}

impl StoredTerms {
    /// The name of [`StoredTerms::F82`]. The other variants are `true` and `false` in a recipe.
    pub const F82_NAME: &'static str = "f82";

    /// The number of terms.
    #[must_use]
    pub fn count(self) -> usize {
        match self {
            Self::None => 0,
            Self::Schlick => 2,
            Self::F82 => 3,
        }
    }

    /// True if any terms are stored.
    #[must_use]
    pub fn any(self) -> bool {
        self != Self::None
    }
}

impl Serialize for StoredTerms {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::F82 => serializer.serialize_str(Self::F82_NAME),
            _ => serializer.serialize_bool(self.any()),
        }
    }
}

/// A complete recipe. Equal recipes give equal bytes.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Recipe {
    /// The [`FITTER_VERSION`] for which the recipe was written.
    #[doc(hidden)]
    pub fitter: u32,
    /// Scattering model: the field `brdf`, and `tabulated` for a tabulated BRDF.
    #[serde(flatten)]
    #[doc(hidden)]
    pub brdf: BrdfModel,
    /// The distribution that represents a lobe. The canonical form names it only if it is not the default, so the
    /// digests of older recipes do not change.
    #[serde(skip_serializing_if = "LobeModel::is_default")]
    #[doc(hidden)]
    pub lobe: LobeModel,
    /// Layout of the table.
    #[doc(hidden)]
    pub layout: Layout,
    /// The number of nodes on each axis.
    #[doc(hidden)]
    pub resolution: PerAxis<u32>,
    /// The lowest and highest value on each axis.
    #[doc(hidden)]
    pub range: PerAxis<[f64; 2]>,
    /// Explicit nodes, and materials. If an axis has explicit nodes, its range and resolution are the ends and the
    /// number of the nodes. With materials, the resolution of the ratio is 1. The canonical form contains `nodes` and
    /// `materials` only if the recipe lists any, so the digests of older recipes do not change.
    #[serde(flatten)]
    #[doc(hidden)]
    pub given: GivenNodes,
    /// Fit settings.
    #[doc(hidden)]
    pub fit: FitSettings,
    /// The stored terms.
    #[doc(hidden)]
    pub terms: StoredTerms,
    /// Number format of the table.
    #[doc(hidden)]
    pub precision: Precision,
}

impl FitSettings {
    /// The distance that the fit minimises.
    #[must_use]
    pub fn metric(&self) -> Metric {
        self.metric
    }

    /// The method of minimisation.
    #[must_use]
    pub fn solver(&self) -> Solver {
        self.solver
    }

    /// Samples of the LTC in each evaluation.
    #[must_use]
    pub fn samples(&self) -> u32 {
        self.samples
    }

    /// Directions of the projections.
    #[must_use]
    pub fn directions(&self) -> u32 {
        self.directions
    }

    /// The largest number of steps.
    #[must_use]
    pub fn steps(&self) -> u32 {
        self.steps
    }

    /// Seed of the sample sequences.
    #[must_use]
    pub fn seed(&self) -> u64 {
        self.seed
    }

    /// The settings of a solver with a simplex.
    #[must_use]
    pub fn simplex(&self) -> Option<Simplex> {
        self.simplex
    }
}

/// The fields of a recipe. They are read-only; a changed recipe is a new recipe.
impl Recipe {
    /// Scattering model.
    #[must_use]
    pub fn brdf(&self) -> BrdfKind {
        self.brdf.kind()
    }

    /// The scattering model, including the file of a tabulated BRDF.
    #[must_use]
    pub fn model(&self) -> &BrdfModel {
        &self.brdf
    }

    /// The distribution that represents a lobe.
    #[must_use]
    pub fn lobe(&self) -> LobeModel {
        self.lobe
    }

    /// Layout of the table.
    #[must_use]
    pub fn layout(&self) -> Layout {
        self.layout
    }

    /// The number of nodes on each axis.
    #[must_use]
    pub fn resolution(&self) -> PerAxis<u32> {
        self.resolution
    }

    /// The lowest and highest value on each axis.
    #[must_use]
    pub fn range(&self) -> PerAxis<[f64; 2]> {
        self.range
    }

    /// Explicit nodes.
    #[must_use]
    pub fn given(&self) -> &GivenNodes {
        &self.given
    }

    /// The effort and method of the fit.
    #[must_use]
    pub fn fit(&self) -> FitSettings {
        self.fit
    }

    /// The version of the fitter for which the recipe was written.
    #[must_use]
    pub fn fitter(&self) -> u32 {
        self.fitter
    }

    /// The stored terms.
    #[must_use]
    pub fn terms(&self) -> StoredTerms {
        self.terms
    }

    /// Number format of the table.
    #[must_use]
    pub fn precision(&self) -> Precision {
        self.precision
    }

    /// False if the lobes of the scattering model are LTCs and the table stores LTCs. The table then needs no fit.
    #[must_use]
    pub fn is_searched(&self) -> bool {
        !(self.lobe == LobeModel::Ltc && self.brdf.kind().is_ltc())
    }

    /// Ascending nodes of each axis of the table.
    #[must_use]
    pub fn nodes(&self) -> PerAxis<Vec<f64>> {
        self.given.in_place_of(self.layout.nodes(&self.range, &self.resolution))
    }

    /// How many numbers an entry has: one or two matrices, and the terms.
    #[must_use]
    pub fn entry_numbers(&self) -> u64 {
        let matrices = if self.brdf.fresnel().second().is_some() { 2 } else { 1 };
        9 * matrices + self.terms.count() as u64
    }

    /// Bytes of the table's matrices and terms, as on a GPU.
    #[must_use]
    pub fn bytes(&self) -> u64 {
        let width = match self.precision {
            Precision::F32 => 4,
            Precision::F16 => 2,
        };
        self.entries().saturating_mul(self.entry_numbers() * width)
    }

    /// Entries of the table: the product of the resolutions.
    #[must_use]
    pub fn entries(&self) -> u64 {
        // The product of four u32 fits u128. For a recipe within the entry limit, the product fits u64. The conversion
        // saturates, so this function never fails.
        let product: u128 = self.resolution.named().iter().map(|(_, n)| u128::from(**n)).product();
        u64::try_from(product).unwrap_or(u64::MAX)
    }
}
