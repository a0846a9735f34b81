//! Checks that the example recipes in `docs/recipes` have the sizes and errors that `docs/recipe.md` states.

use std::{fs, ops::ControlFlow, path::Path};

use ltcforge::{
    files::{container, recipe_document},
    fit::{
        Configuration, Fitter, Plan, Recipe, Table, assemble,
        brdf::Ggx,
        fit_shard,
        math::{direction, from_row_major, recurrence4},
    },
};
use rayon::prelude::*;

/// An example, with a preset that is fast enough for a test.
fn example(name: &str) -> Recipe {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/recipes").join(name);
    let text = fs::read_to_string(path).expect("an example");
    assert!(text.contains(r#""preset": "paper""#), "{text}");
    parse(&text.replace("paper", "standard"))
}

fn parse(text: &str) -> Recipe {
    recipe_document::parse(text.as_bytes(), 10_000).expect("a recipe")
}

fn fitted(recipe: &Recipe) -> Table {
    let plan = Plan::new(recipe);
    let fit = |shard| fit_shard(&plan, shard, &mut |_| ControlFlow::Continue(())).expect("nothing stops it");
    let entries: Vec<_> = (0..plan.shards()).into_par_iter().flat_map_iter(fit).collect();
    assemble(&plan, &entries)
}

fn bytes(recipe: &Recipe, table: &Table) -> usize {
    container::encode(recipe, table).expect("a file").len()
}

#[test]
fn a_table_of_a_range_is_smaller_and_not_less_accurate() {
    let whole = parse("{}");
    let whole_table = fitted(&whole);
    let brushed = example("brushed-metal.json");
    let brushed_table = fitted(&brushed);
    assert!(4 * bytes(&brushed, &brushed_table) < bytes(&whole, &whole_table));

    let range = brushed.range();
    let error = |table: &Table| mean_error(table, [range.alpha, range.ratio, range.theta, range.phi]);
    let (part, all) = (error(&brushed_table), error(&whole_table));
    assert!(part < all, "{part} {all}");
}

#[test]
fn a_table_of_isotropic_surfaces_has_a_hundredth_of_the_size() {
    let (whole, isotropic) = (parse("{}"), example("isotropic.json"));
    let table = fitted(&isotropic);
    // Only the sizes of the numbers are compared, because all tables have headers of similar length.
    let numbers = |recipe: &Recipe, bytes_each: u64| recipe.entries() * 11 * bytes_each;
    assert!(100 * numbers(&isotropic, 2) < numbers(&whole, 4));
    let error = mean_error(&table, [[0.01, 1.0], [1.0, 1.0], [0.0, 1.55], [0.0, 6.2]]);
    assert!(error < 0.05, "{error}");
}

/// Mean error relative to alpha, over 200 configurations in the ranges of alpha, ratio, theta and phi. The width of a
/// lobe is proportional to alpha.
fn mean_error(table: &Table, ranges: [[f64; 2]; 4]) -> f64 {
    let settings = parse(r#"{"preset": "paper"}"#).fit();
    let errors = (0..200).into_par_iter().map_init(
        || Fitter::new(&settings),
        |fitter, i| {
            let u = recurrence4(i, [0.1, 0.3, 0.6, 0.8]);
            let [alpha, ratio, theta, phi]: [f64; 4] =
                std::array::from_fn(|k| ranges[k][0] + (ranges[k][1] - ranges[k][0]) * u[k]);
            let (alpha_x, alpha_y) = (alpha, alpha * ratio);
            let found = table.lookup(&Configuration { alpha_x, alpha_y, theta, phi });
            let m = from_row_major(&found.matrix);
            fitter.error(&Ggx { alpha_x, alpha_y }, direction(theta, phi), &m) / alpha
        },
    );
    let errors: Vec<f64> = errors.collect();
    errors.iter().sum::<f64>() / errors.len() as f64
}
