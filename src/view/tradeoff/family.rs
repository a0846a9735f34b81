//! The family of recipes that a trade-off fits.

use ltcforge_files::recipe_document::{Preset, canonical_json, parse};
use ltcforge_fit::{FitSettings, Layout, PerAxis, Precision, Recipe};

/// How many recipes a family has.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Size {
    /// The presets and a few recipes around them.
    Quick,
    /// Enough recipes to calibrate predictions.
    Full,
}

/// Resolutions in a family, relative to the base recipe. They scale all axes.
const SCALES: [f64; 5] = [0.4, 0.6, 0.8, 1.25, 1.5];
/// Factors that scale one axis at a time.
const AXIS_SCALES: [f64; 2] = [0.6, 1.6];
/// Samples, directions and steps to try, in addition to those of the presets.
const EFFORTS: [(u32, u32, u32); 21] = [
    (64, 8, 30),
    (64, 16, 30),
    (128, 4, 30),
    (128, 8, 10),
    (128, 8, 15),
    (128, 8, 20),
    (128, 8, 60),
    (128, 16, 30),
    (128, 32, 60),
    (256, 8, 30),
    (256, 8, 60),
    (256, 16, 30),
    (256, 32, 60),
    (512, 8, 60),
    (512, 16, 30),
    (512, 16, 60),
    (1024, 8, 60),
    (1024, 16, 30),
    (1024, 16, 60),
    (1024, 32, 60),
    (2048, 16, 60),
];

/// The recipes around `base`, with its ranges, in a fixed order and without duplicates. The presets with the layout,
/// resolution and precision of `base` come first. Recipes and layouts that do not fit the ranges of `base` are omitted.
#[must_use]
pub fn family(base: &Recipe, size: Size, entry_limit: u64) -> Vec<Recipe> {
    let mut found = Collector { entry_limit, recipes: Vec::new() };
    let [draft, standard, paper, best] = Preset::ALL.map(Preset::fit);
    for fit in [draft, standard, paper, best] {
        found.add(with_fit(base, fit));
    }
    found.add(base.clone());
    let (scales, layout_fits): (&[f64], &[FitSettings]) = match size {
        Size::Quick => (&SCALES[1..3], &[draft]),
        Size::Full => (&SCALES, &[draft, standard]),
    };
    for scale in scales {
        for fit in layout_fits {
            found.add(with_fit(&scaled(base, [*scale; 4]), *fit));
        }
    }
    // The family keeps the ranges of `base`, and a list of materials has no ranges.
    let is_another = |layout: &&Layout| **layout != base.layout && !layout.is_of_materials();
    let other_layouts = Layout::ALL.iter().filter(is_another);
    let others: Vec<Recipe> = other_layouts.map(|layout| Recipe { layout: *layout, ..base.clone() }).collect();
    for other in &others {
        for fit in layout_fits {
            found.add(with_fit(other, *fit));
        }
    }
    let half = Recipe { precision: Precision::F16, ..base.clone() };
    found.add(with_fit(&half, layout_fits[layout_fits.len() - 1]));
    if size == Size::Quick {
        return found.recipes;
    }
    for (samples, directions, steps) in EFFORTS {
        found.add(with_fit(base, FitSettings { samples, directions, steps, ..draft }));
    }
    for scale in SCALES {
        for other in &others {
            found.add(with_fit(&scaled(other, [scale; 4]), draft));
        }
        found.add(with_fit(&scaled(&half, [scale; 4]), draft));
    }
    found.add(with_fit(&scaled(base, [SCALES[1]; 4]), paper));
    found.add(with_fit(&scaled(base, [SCALES[3]; 4]), paper));
    for other in &others {
        found.add(with_fit(other, paper));
    }
    for axis in 0..4 {
        for scale in AXIS_SCALES {
            let mut scales = [1.0; 4];
            scales[axis] = scale;
            found.add(with_fit(&scaled(base, scales), draft));
            for other in &others {
                found.add(with_fit(&scaled(other, scales), draft));
            }
        }
    }
    found.recipes
}

/// The recipe with the effort of `fit`. It keeps its metric, solver, seed and simplex.
fn with_fit(recipe: &Recipe, fit: FitSettings) -> Recipe {
    let FitSettings { metric, solver, seed, simplex, .. } = recipe.fit;
    Recipe { fit: FitSettings { metric, solver, seed, simplex, ..fit }, ..recipe.clone() }
}

/// The recipe with `scale` times as many nodes on each axis with more than one node.
fn scaled(recipe: &Recipe, scale: [f64; 4]) -> Recipe {
    let nodes = |n: u32, scale: f64| if n == 1 { 1 } else { ((f64::from(n) * scale).round() as u32).max(2) };
    let PerAxis { alpha, ratio, theta, phi } = recipe.resolution;
    let resolution = PerAxis {
        alpha: nodes(alpha, scale[0]),
        ratio: nodes(ratio, scale[1]),
        theta: nodes(theta, scale[2]),
        phi: nodes(phi, scale[3]),
    };
    Recipe { resolution, ..recipe.clone() }
}

/// A list of recipes without duplicates. Each recipe passes the checks for submitted recipes.
struct Collector {
    entry_limit: u64,
    recipes: Vec<Recipe>,
}

impl Collector {
    fn add(&mut self, recipe: Recipe) {
        let is_sound = parse(canonical_json(&recipe).as_bytes(), self.entry_limit).is_ok();
        if is_sound && !self.recipes.contains(&recipe) {
            self.recipes.push(recipe);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ltcforge_files::recipe_document::DEFAULT_ENTRY_LIMIT;

    fn base(document: &str) -> Recipe {
        parse(document.as_bytes(), DEFAULT_ENTRY_LIMIT).expect("a recipe")
    }

    #[test]
    fn a_family_starts_with_the_presets_varies_everything_and_has_no_duplicates() {
        let base = base(r#"{"preset":"paper"}"#);
        for size in [Size::Quick, Size::Full] {
            let found = family(&base, size, DEFAULT_ENTRY_LIMIT);
            let presets: Vec<FitSettings> = found[..4].iter().map(|recipe| recipe.fit).collect();
            assert_eq!(presets, Preset::ALL.map(Preset::fit));
            for (i, recipe) in found.iter().enumerate() {
                assert!(!found[..i].contains(recipe), "{recipe:?} is listed twice");
                assert_eq!(recipe.range, base.range);
            }
            for &layout in Layout::ALL.iter().filter(|of| of.only_ranges().is_none() && !of.is_of_materials()) {
                assert!(found.iter().any(|recipe| recipe.layout == layout));
            }
            assert!(found.iter().any(|recipe| recipe.entries() < base.entries() / 2));
        }
    }

    #[test]
    fn a_single_value_stays_one_node_and_recipes_over_the_limit_are_omitted() {
        let isotropic = base(
            r#"{"range":{"alpha":[0.01,0.5],"ratio":[1,1],"phi":[0,0]},"resolution":{"alpha":16,"theta":12},
                "fit":{"seed":7}}"#,
        );
        let found = family(&isotropic, Size::Full, 300);
        assert!(found.len() > 20, "{}", found.len());
        for recipe in found {
            assert_eq!((recipe.resolution.ratio, recipe.resolution.phi), (1, 1));
            assert!(recipe.entries() <= 300 && recipe.fit.seed == 7, "{recipe:?}");
        }
    }
}
