//! How hard the entries of a candidate may be fitted: the presets, and what lies between and around them.

use ltcforge_files::recipe_document::Preset;
use ltcforge_fit::{FitSettings, Recipe, expectation, fit_seconds};

/// Samples and directions that are tried beside those of the presets.
const SAMPLES: [u32; 9] = [64, 96, 128, 192, 256, 384, 512, 1024, 2048];
const DIRECTIONS: [u32; 5] = [4, 8, 16, 32, 48];

/// The efforts of which none is both faster and expected to have less error than another, ascending in time, for tables like
/// `base`; with its seed.
pub(crate) fn efforts(base: &Recipe) -> Vec<FitSettings> {
    let seed = base.fit.seed;
    let of = |samples: u32| DIRECTIONS.map(|directions| FitSettings { samples, directions, ..Preset::Standard.fit() });
    let all = SAMPLES.into_iter().flat_map(of).chain(Preset::ALL.map(Preset::fit));
    let priced = |fit: FitSettings| {
        let recipe = Recipe { fit: FitSettings { seed, ..fit }, ..base.clone() };
        (fit_seconds(&recipe), added_error(&recipe), recipe.fit)
    };
    let mut priced: Vec<(f64, f64, FitSettings)> = all.map(priced).collect();
    priced.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
    let mut least = f64::INFINITY;
    priced.retain(|(_, error, _)| {
        let is_better = *error < least;
        least = least.min(*error);
        is_better
    });
    priced.into_iter().map(|(_, _, fit)| fit).collect()
}

/// The error that a bound of effort adds, by the expectation: over that of a fit without one.
pub(crate) fn added_error(recipe: &Recipe) -> f64 {
    let endless = FitSettings { samples: u32::MAX, directions: u32::MAX, ..recipe.fit };
    expectation(recipe).error - expectation(&Recipe { fit: endless, ..recipe.clone() }).error
}

/// An effort in words: the preset that it is, or its numbers.
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
    fn each_effort_takes_longer_than_the_one_before_and_is_better() {
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
