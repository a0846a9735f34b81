//! Named combinations of speed and accuracy.

use ltcforge_fit::FitSettings;
use ltcforge_fit::{Metric, Solver};

/// A named set of fit settings. All other fields of a recipe have one default for all presets.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Preset {
    /// For experiments.
    Draft,
    /// For work in progress.
    Standard,
    /// For a table to ship, as large as in the paper.
    Paper,
    /// For the best table, if fitting may take minutes.
    Best,
}

impl Preset {
    /// All presets, fastest first.
    pub const ALL: [Self; 4] = [Self::Draft, Self::Standard, Self::Paper, Self::Best];

    /// The name in a recipe.
    #[must_use]
    pub fn name(self) -> &'static str {
        ["draft", "standard", "paper", "best"][self as usize]
    }

    /// The preset with a name.
    #[must_use]
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|preset| preset.name() == name)
    }

    /// The fit settings of the preset.
    #[must_use]
    pub fn fit(self) -> FitSettings {
        let (samples, directions, steps) = match self {
            Self::Draft => (192, 8, 30),
            Self::Standard => (384, 16, 60),
            Self::Paper => (512, 32, 60),
            Self::Best => (2048, 48, 120),
        };
        FitSettings { metric: Metric::Sw1, solver: Solver::Bfgs, samples, directions, steps, seed: 0, simplex: None }
    }
}
