//! Checks that the figures in the README equal the results of the current fitter.

use std::{fs, ops::ControlFlow, path::Path};

use ltcforge::{
    files::recipe_document,
    fit::{Plan, fit_plan, report},
};

/// Number of points in the command of the README.
const POINTS: usize = 1024;

/// Mean, p95 and maximum in per cent, from the row for `table` in the README.
fn row<'a>(readme: &'a str, table: &str) -> Vec<&'a str> {
    let mut rows = readme.lines().filter_map(|line| line.strip_prefix(&format!("| {table} | ")));
    let row = rows.next().unwrap_or_else(|| panic!("the README has no row of {table}"));
    row.split(" | ").filter_map(|cell| cell.strip_suffix(" %")).collect()
}

#[test]
fn the_readme_has_the_errors_of_the_current_draft() {
    let readme = fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("README.md")).expect("the README");
    assert!(readme.contains(&format!("`ltcforge report TABLE --points {POINTS}`")));
    let recipe = recipe_document::parse(br#"{"preset": "draft"}"#, 10_000).expect("a recipe");
    let table = fit_plan(&Plan::new(&recipe), &|_| ControlFlow::Continue(())).expect("nothing stops it");
    let width = report(&table, &recipe.range(), POINTS).between.width;
    let measured = [width.mean, width.p95, width.max].map(|part| format!("{:.1}", 100.0 * part));
    assert_eq!(row(&readme, "preset `draft`"), measured);
}
