//! The tables of docs/textured.md: lights with pictures, read as engines do, by the kernel of a table, and by
//! `normals`.

mod cases;
mod engines;
mod pictures;
mod profiles;
pub mod scenes;
mod single;
#[cfg(test)]
mod tests;

use std::fmt::Write as _;

pub use self::profiles::profiles;
use ltcforge::{
    Layout, Preset, Recipe, RecipeDocument as _,
    fit::{Configuration, Ltc, Table, math::from_row_major},
    light::{
        CosineSpace, NormalsRule, ReflectedLight, by_table,
        textured::{LightPyramid, Readings, TexturedLight, TexturedReflection, colour, engines_reading},
    },
};
use rayon::prelude::*;

use self::{
    cases::{Case, SETS, cases},
    engines::Engine,
    pictures::Pictures,
};
use crate::{
    lights::Spread,
    markdown::{short, spread},
    tables::fitted,
};

/// Factors on the width of the engines' read. Mip levels differ between engines, and docs/textured.md shows the best
/// factor.
const WIDTHS: [f64; 3] = [1.0, 1.4, 2.0];

/// The light of each channel of a case, for one method.
type Way<'a> = Box<dyn Fn(&Case) -> Vec<f64> + Sync + 'a>;

/// The table of docs/textured.md, with `lights` cases per set.
///
/// # Errors
/// None, because both recipes are valid.
pub fn tables(lights: usize) -> Result<String, ltcforge::Error> {
    let table = fitted(&Recipe::builder().preset(Preset::Paper).build()?);
    let isotropic = fitted(&Recipe::builder().preset(Preset::Paper).layout(Layout::Ltc2017).build()?);
    Ok(tables_of([&table, &isotropic], lights))
}

/// The table of docs/textured.md, measured with a table of LTCs and an isotropic table of engines.
///
/// # Panics
/// Never: all drawn lights are valid.
#[must_use]
pub fn tables_of([table, isotropic]: [&Table; 2], lights: usize) -> String {
    let pictures: Vec<Pictures> = cases::FORMS.into_par_iter().map(Pictures::new).collect();
    let sets = SETS.map(|set| cases(set, lights, &pictures));
    let mut out = format!("docs/textured.md, {lights} lights a set, mean / 95th percentile / largest error:\n\n| |");
    // Writing to a String cannot fail.
    for (set, cases) in SETS.iter().zip(&sets) {
        let channels = cases.iter().flat_map(|case| &case.truth);
        let count = channels.clone().count() as f64;
        let _ = write!(out, " {} (mean {}) |", set.name(), short(channels.sum::<f64>() / count, 3));
    }
    let _ = writeln!(out, "\n|---|{}", "---|".repeat(SETS.len()));
    for (name, way) in ways([table, isotropic], &pictures) {
        let _ = write!(out, "| {name} |");
        for cases in &sets {
            let errors = cases.par_iter().flat_map_iter(|case| {
                let found = way(case);
                found.into_iter().zip(&case.truth).map(|(found, truth)| (found - truth).abs()).collect::<Vec<_>>()
            });
            let _ = write!(out, " {} |", spread(Spread::of(errors.collect())));
        }
        out += "\n";
    }
    out
}

/// All methods with their names.
fn ways<'a>([table, isotropic]: [&'a Table; 2], pictures: &'a [Pictures]) -> Vec<(String, Way<'a>)> {
    let mut ways: Vec<(String, Way<'a>)> = Vec::new();
    ways.push((
        "mean of the picture".to_owned(),
        Box::new(|case| {
            let energy = ltcforge::light::by_normals(&case.at, case.light.polygon(), NormalsRule::Balanced);
            let energy = energy.expect("a surface").energy;
            let pyramids = pictures[case.form].pyramids.iter();
            pyramids
                .flat_map(|pyramid| {
                    pyramid.levels()[pyramid.levels().len() - 1].texels()[0].map(|x| energy * f64::from(x))
                })
                .collect()
        }),
    ));
    for engine in Engine::ALL {
        let way = move |case: &Case| {
            pictures[case.form].channels(|pyramid| engine.by_isotropic(isotropic, &case.at, &case.light, pyramid))
        };
        ways.push((format!("{}, isotropic LTC", engine.name()), Box::new(way)));
    }
    for engine in Engine::ALL {
        let way = move |case: &Case| {
            pictures[case.form].channels(|pyramid| engine.by_table(table, &case.at, &case.light, pyramid))
        };
        ways.push((format!("LTC, reading of {}", engine.name()), Box::new(way)));
    }
    for width in WIDTHS {
        let way = move |case: &Case| {
            pictures[case.form].channels(|pyramid| by_engines_reading(table, &case.at, &case.light, pyramid, width))
        };
        ways.push((format!("LTC, engines' reading, width x {width}"), Box::new(way)));
    }
    for number in [Readings::One, Readings::Four] {
        ways.push((
            format!("LTC, its own kernel, {number}"),
            Box::new(move |case| {
                pictures[case.form].channels(|pyramid| single::by_table(table, &case.at, &case.light, pyramid, number))
            }),
        ));
    }
    for (rule, number) in [
        (NormalsRule::Balanced, Readings::One),
        (NormalsRule::Balanced, Readings::Two),
        (NormalsRule::Balanced, Readings::Four),
        (NormalsRule::Balanced, Readings::Six),
        (NormalsRule::Fast, Readings::Four),
        (NormalsRule::Fine, Readings::Four),
    ] {
        ways.push((
            format!("`normals`, `{rule}`, {number}"),
            Box::new(move |case| {
                pictures[case.form]
                    .channels(|pyramid| single::by_normals(&case.at, &case.light, pyramid, (rule, number)))
            }),
        ));
    }
    ways
}

/// One read of the picture, where the direction of the vector form factor meets the light.
fn by_engines_reading(
    table: &Table,
    at: &Configuration,
    light: &TexturedLight,
    pyramid: &LightPyramid,
    width: f64,
) -> TexturedReflection {
    let light = light.polygon();
    let ltc = Ltc::new(from_row_major(&table.lookup(at).matrix)).expect("an LTC");
    let corners = [0, 1, 2, 3].map(|i| light.vertices()[i].to_array());
    let form_factor = ltc.vector_form_factor(light.vertices()).to_array();
    let reading = engines_reading(&CosineSpace::from(&ltc), form_factor, &corners, width);
    let ReflectedLight { energy, fresnel } = by_table(table, at, light).expect("a surface");
    let colour = colour(&[reading], pyramid);
    TexturedReflection {
        energy: colour.map(|channel| energy * channel),
        fresnel: colour.map(|channel| fresnel * channel),
    }
}
