//! The efforts for fitting a candidate: the presets, and more efforts between and around them.

use crate::front::front;
use ltcforge_files::recipe_document::Preset;
use ltcforge_fit::{FitSettings, Recipe, expectation, fit_seconds};

/// Samples and directions that are tried in addition to the presets.
const SAMPLES: [u32; 9] = [64, 96, 128, 192, 256, 384, 512, 1024, 2048];
const DIRECTIONS: [u32; 5] = [4, 8, 16, 32, 48];

/// The efforts for tables like `base`, with its seed, by ascending time. Each effort has less expected error than all
/// faster efforts.
pub(crate) fn efforts(base: &Recipe) -> Vec<FitSettings> {
    let row = |samples: u32| DIRECTIONS.map(|directions| FitSettings { samples, directions, ..Preset::Standard.fit() });
    let all = SAMPLES.into_iter().flat_map(row).chain(Preset::ALL.map(Preset::fit));
    let priced = |fit: FitSettings| {
        let recipe = Recipe { fit: FitSettings { seed: base.fit.seed, ..fit }, ..base.clone() };
        (fit_seconds(&recipe), added_error(&recipe), recipe.fit)
    };
    front(all.map(priced).collect()).collect()
}

/// The expected error that the limits on samples and directions add.
pub(crate) fn added_error(recipe: &Recipe) -> f64 {
    let endless = FitSettings { samples: u32::MAX, directions: u32::MAX, ..recipe.fit };
    expectation(recipe).error - expectation(&Recipe { fit: endless, ..recipe.clone() }).error
}

/// An effort in words: its preset, or its numbers.
pub(crate) fn in_words(fit: &FitSettings) -> String {
    let preset = Preset::ALL.into_iter().find(|preset| FitSettings { seed: fit.seed, ..preset.fit() } == *fit);
    let numbers = || format!("{} samples x {} directions", fit.samples, fit.directions);
    preset.map_or_else(numbers, |preset| format!("preset {}", preset.name()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use ltcforge_files::recipe_document::{DEFAULT_ENTRY_LIMIT, parse};

    #[test]
    fn each_effort_takes_longer_than_the_one_before_and_has_less_error() {
        let base = parse(b"{}", DEFAULT_ENTRY_LIMIT).expect("a recipe");
        let found = efforts(&base);
        let priced = |fit: &FitSettings| {
            let recipe = Recipe { fit: *fit, ..base.clone() };
            (fit_seconds(&recipe), added_error(&recipe))
        };
        assert!(found.len() > Preset::ALL.len(), "{found:?}");
        for pair in found.windows(2) {
            let [first, second] = [&pair[0], &pair[1]].map(priced);
            assert!(first.0 < second.0 && first.1 > second.1, "{pair:?}");
        }
        assert_eq!(in_words(&Preset::Best.fit()), "preset best");
    }
}
