//! Tests the error of a table between its nodes, where renderers read it, compared with the best fits.

use std::{ops::ControlFlow, sync::Arc};

use ltcforge::{
    files::recipe_document::{self, Preset},
    fit::{
        Configuration, Fitter, Plan, StopCheck, Table, assemble,
        brdf::Ggx,
        fit_shard,
        math::{direction, from_row_major, recurrence4},
    },
    view::preview::{Adapter, Mode, NamedScene, Preview, Scene, ShaderTable, TexelFormat},
};
use rayon::prelude::*;

/// The number of materials and views. They are distributed as artists set them.
const PLACES: usize = 48;

fn table(document: &str) -> Table {
    let plan = Plan::new(&recipe_document::parse(document.as_bytes(), 10_000).expect("a recipe"));
    let fit = |shard| fit_shard(&plan, shard, &mut |_| ControlFlow::Continue(())).expect("nothing stops it");
    let entries: Vec<_> = (0..plan.shards()).into_par_iter().flat_map_iter(fit).collect();
    assemble(&plan, &entries)
}

fn place(i: usize) -> Configuration {
    let [roughness, ratio, theta, phi] = recurrence4(i, [0.7, 0.2, 0.4, 0.9]);
    let alpha_x = (0.1 + 0.9 * roughness) * (0.1 + 0.9 * roughness);
    Configuration { alpha_x, alpha_y: alpha_x * (0.1 + 0.9 * ratio), theta: 1.5 * theta, phi: 1.57 * phi }
}

/// The errors of the table and of a separate fit, measured with the same held-out samples.
fn errors(table: &Table, at: &Configuration) -> [f64; 2] {
    let (ggx, wo) = (Ggx { alpha_x: at.alpha_x, alpha_y: at.alpha_y }, direction(at.theta, at.phi));
    let mut fitter = Fitter::new(&Preset::Paper.fit());
    let looked_up = fitter.error(&ggx, wo, &from_row_major(&table.lookup(at).matrix));
    let own =
        fitter.fit(&ggx, wo, 0, &mut StopCheck::new(&mut || ControlFlow::Continue(()))).expect("nothing stops it");
    [looked_up, own.error]
}

/// The sum of the table's errors divided by the sum of the fits' errors, and the largest ratio of a single pair.
fn excess(table: &Table) -> (f64, f64) {
    let all: Vec<[f64; 2]> = (0..PLACES).into_par_iter().map(|i| errors(table, &place(i))).collect();
    let [looked_up, own] = [0, 1].map(|k| all.iter().map(|pair| pair[k]).sum::<f64>());
    (looked_up / own - 1.0, all.iter().map(|[looked_up, own]| looked_up / own).fold(0.0, f64::max))
}

#[test]
fn draft_is_close_to_the_best_fit_between_its_nodes() {
    let (mean, worst) = excess(&table(r#"{"preset": "draft"}"#));
    assert!(mean < 0.18 && worst < 3.0, "{mean} {worst}");
}

#[test]
fn standard_is_closer_to_the_best_fit() {
    let (mean, worst) = excess(&table(r#"{"preset": "standard"}"#));
    assert!(mean < 0.11 && worst < 2.4, "{mean} {worst}");
}

/// The materials of KT et al. 2022, figure 14. docs/accuracy.md states the mean absolute error of their published
/// table.
#[test]
fn on_the_materials_of_figure_14_a_draft_has_smaller_errors_than_the_published_table() {
    const PUBLISHED: [f64; 4] = [0.00681, 0.02142, 0.02126, 0.05604];
    let table = Arc::new(ShaderTable::new(&table(r#"{"preset": "draft"}"#), TexelFormat::F32));
    let scene = Scene { mode: Mode::Difference, size: 64, spp: 1024, ..NamedScene::Figure14.scene() };
    let rendered = Preview::new(Adapter::Any).render(&table, &scene, &|| false).expect("a picture");
    for (error, published) in rendered.errors.iter().zip(PUBLISHED) {
        assert!(error.mean_absolute < 0.9 * published, "{error:?}: {published}");
    }
    assert_eq!(rendered.errors.len(), PUBLISHED.len());
}

/// Isotropic materials between the texels of a table for engines. The error of the table that engines ship is five
/// times the error of the best fits.
#[test]
fn an_isotropic_table_for_engines_is_close_to_the_best_fit_between_its_texels() {
    let table = table(r#"{"layout": "ltc2017"}"#);
    let isotropic = |i: usize| Configuration { alpha_y: place(i).alpha_x, phi: 0.0, ..place(i) };
    let all: Vec<[f64; 2]> = (0..PLACES).into_par_iter().map(|i| errors(&table, &isotropic(i))).collect();
    let mean = all.iter().map(|[looked_up, own]| looked_up / own).sum::<f64>() / all.len() as f64;
    assert!(mean < 1.1, "{mean}");
}

/// The bounds can fail: without the layout's reflection, the same fit has large interpolation errors.
#[test]
fn the_layout_of_the_published_table_has_large_errors_between_nodes() {
    let (mean, worst) = excess(&table(r#"{"preset": "draft", "layout": "kt2022"}"#));
    assert!(mean > 0.2 && worst > 3.0, "{mean} {worst}");
}
