//! Recipes: complete, checked descriptions of a fit, from which every byte of a table follows.
//!
//! Invariant: no defaults and no JSON here; `ltcforge_files::recipe_document` reads documents and fills presets in.

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

/// Version of the fitter. Raised whenever the same recipe gives other bytes.
pub const FITTER_VERSION: u32 = 4;

/// How hard each entry is fitted.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct FitSettings {
    /// The distance that is minimised.
    #[doc(hidden)]
    pub metric: Metric,
    /// The method that minimises it.
    #[doc(hidden)]
    pub solver: Solver,
    /// Samples of the LTC in each evaluation.
    #[doc(hidden)]
    pub samples: u32,
    /// Directions that the samples are projected on.
    #[doc(hidden)]
    pub directions: u32,
    /// Most steps (solver `bfgs` stops earlier when it has converged; `sgd` takes all).
    #[doc(hidden)]
    pub steps: u32,
    /// Shifts the sample sequences of `bfgs`, seeds the generator of `sgd`.
    #[doc(hidden)]
    pub seed: u64,
    /// The choices of a solver with a simplex. The canonical form names them with such a solver only, so that recipes
    /// keep their digests.
    #[serde(flatten, skip_serializing_if = "Option::is_none")]
    #[doc(hidden)]
    pub simplex: Option<Simplex>,
}

/// The terms that are stored beside the lobes. In a recipe they are `true`, `false` or `"f82"`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StoredTerms {
    /// None.
    None,
    /// Amplitude and Fresnel term, for Schlick's Fresnel factor.
    Schlick,
    /// The edge term as well, for metals by F82.
    F82,
}

impl StoredTerms {
    /// The name of [`StoredTerms::F82`]; the others are `true` and `false`.
    pub const F82_NAME: &'static str = "f82";

    /// How many there are.
    #[must_use]
    pub fn count(self) -> usize {
        match self {
            Self::None => 0,
            Self::Schlick => 2,
            Self::F82 => 3,
        }
    }

    /// Whether there are any.
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
    /// [`FITTER_VERSION`] that the recipe is meant for.
    #[doc(hidden)]
    pub fitter: u32,
    /// Scattering model: the fields `brdf` and, for a tabulated one, `tabulated`.
    #[serde(flatten)]
    #[doc(hidden)]
    pub brdf: BrdfModel,
    /// The distribution that stands for a lobe. The canonical form names it only where it is not the default, so that
    /// recipes keep their digests.
    #[serde(skip_serializing_if = "LobeModel::is_default")]
    #[doc(hidden)]
    pub lobe: LobeModel,
    /// Layout of the table.
    #[doc(hidden)]
    pub layout: Layout,
    /// Nodes on each axis.
    #[doc(hidden)]
    pub resolution: PerAxis<u32>,
    /// Lowest and highest value on each axis.
    #[doc(hidden)]
    pub range: PerAxis<[f64; 2]>,
    /// Nodes that are given one by one, and materials: range and resolution of their axes are their ends and their number; materials
    /// have one ratio each. The canonical form names them, as `nodes` and `materials`, only where there are some, so that
    /// recipes keep their digests.
    #[serde(flatten)]
    #[doc(hidden)]
    pub given: GivenNodes,
    /// Fit settings.
    #[doc(hidden)]
    pub fit: FitSettings,
    /// The terms that are stored.
    #[doc(hidden)]
    pub terms: StoredTerms,
    /// Number format of the table.
    #[doc(hidden)]
    pub precision: Precision,
}

impl FitSettings {
    /// The distance that is minimised.
    #[must_use]
    pub fn metric(&self) -> Metric {
        self.metric
    }

    /// The method that minimises it.
    #[must_use]
    pub fn solver(&self) -> Solver {
        self.solver
    }

    /// Samples of the LTC in each evaluation.
    #[must_use]
    pub fn samples(&self) -> u32 {
        self.samples
    }

    /// Directions that the samples are projected on.
    #[must_use]
    pub fn directions(&self) -> u32 {
        self.directions
    }

    /// Most steps.
    #[must_use]
    pub fn steps(&self) -> u32 {
        self.steps
    }

    /// Seed of the sample sequences.
    #[must_use]
    pub fn seed(&self) -> u64 {
        self.seed
    }

    /// The choices of a solver with a simplex.
    #[must_use]
    pub fn simplex(&self) -> Option<Simplex> {
        self.simplex
    }
}

/// The fields of a recipe. They cannot be changed; a different recipe is built anew.
impl Recipe {
    /// Scattering model.
    #[must_use]
    pub fn brdf(&self) -> BrdfKind {
        self.brdf.kind()
    }

    /// The scattering model with the file that a tabulated one is of.
    #[must_use]
    pub fn model(&self) -> &BrdfModel {
        &self.brdf
    }

    /// The distribution that stands for a lobe.
    #[must_use]
    pub fn lobe(&self) -> LobeModel {
        self.lobe
    }

    /// Layout of the table.
    #[must_use]
    pub fn layout(&self) -> Layout {
        self.layout
    }

    /// Nodes on each axis.
    #[must_use]
    pub fn resolution(&self) -> PerAxis<u32> {
        self.resolution
    }

    /// Lowest and highest value on each axis.
    #[must_use]
    pub fn range(&self) -> PerAxis<[f64; 2]> {
        self.range
    }

    /// Nodes that are given one by one.
    #[must_use]
    pub fn given(&self) -> &GivenNodes {
        &self.given
    }

    /// How hard each entry is fitted.
    #[must_use]
    pub fn fit(&self) -> FitSettings {
        self.fit
    }

    /// Version of the fitter that the recipe is meant for.
    #[must_use]
    pub fn fitter(&self) -> u32 {
        self.fitter
    }

    /// The terms that are stored.
    #[must_use]
    pub fn terms(&self) -> StoredTerms {
        self.terms
    }

    /// Number format of the table.
    #[must_use]
    pub fn precision(&self) -> Precision {
        self.precision
    }

    /// Whether its entries are searched for: not where the scattering model's lobes are of the table's lobe model.
    #[must_use]
    pub fn is_searched(&self) -> bool {
        !(self.lobe == LobeModel::Ltc && self.brdf.kind().is_ltc())
    }

    /// Ascending nodes of each axis of the table.
    #[must_use]
    pub fn nodes(&self) -> PerAxis<Vec<f64>> {
        self.given.in_place_of(self.layout.nodes(&self.range, &self.resolution))
    }

    /// Numbers of an entry: those of one matrix or two, and the terms.
    #[must_use]
    pub fn entry_numbers(&self) -> u64 {
        let matrices = if self.brdf.fresnel().second().is_some() { 2 } else { 1 };
        9 * matrices + self.terms.count() as u64
    }

    /// Bytes of the table's matrices and terms, as they lie on a GPU.
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
        // The product of four u32 fits u128. No recipe past the entry limit gets here; the conversion to u64 saturates
        // so that this function cannot fail for any caller.
        let product: u128 = self.resolution.named().iter().map(|(_, n)| u128::from(**n)).product();
        u64::try_from(product).unwrap_or(u64::MAX)
    }
}
