//! Shortened studies find the constants of the sources again, and print the tables of the docs.

use ltcforge::{
    Layout, Metric, Preset, Recipe, RecipeDocument as _, Solver,
    light::{NormalsRule, albedo::LOSS, normals::BULGE},
};
use ltcforge_studies::{
    albedo, arcs, best, expected,
    expected::Extent,
    formula, glass, l3, minimax, models,
    networks::{self, Numbers, Options},
    paths,
    tables::fitted,
    tabulated::{self, grouped},
};

const NUMBERS: &str = include_str!("../../src/light/normals/numbers.rs");
/// The shaders of the rules, ordered as [`NormalsRule::SHADED`].
const SHADERS: [&str; 3] = [
    include_str!("../../shaders/normals_balanced.wgsl"),
    include_str!("../../shaders/normals_fast.wgsl"),
    include_str!("../../shaders/normals_fine.wgsl"),
];
const NORMALS_PAGE: &str = include_str!("../../docs/normals.md");
const LIGHTS_PAGE: &str = include_str!("../../docs/lights.md");
const README: &str = include_str!("../../README.md");
const ISOTROPIC_PAGE: &str = include_str!("../isotropic.md");
const MATERIALS_PAGE: &str = include_str!("../../docs/materials.md");
const REFRACTION_PAGE: &str = include_str!("../../docs/refraction.md");

/// The printed numbers equal the numbers in the Rust source and in the shader.
#[test]
fn the_numbers_of_networks_are_printed_as_in_the_sources() {
    for (rule, shader) in NormalsRule::SHADED.into_iter().zip(SHADERS) {
        let numbers = Numbers::from(rule.network());
        let (units, outputs) = (networks::units(rule), networks::outputs(rule));
        assert_eq!((numbers.units.len(), numbers.outputs.len()), (units, outputs), "{rule}");
        for text in [numbers.as_rust(rule), numbers.as_wgsl(rule)] {
            assert!(NUMBERS.contains(&text) || shader.contains(&text), "{text}");
        }
    }
}

/// The printed numbers and polynomials equal those of the Rust source and of the shader.
#[test]
fn the_formula_of_an_ltc_is_printed_as_in_the_sources() {
    let words = |text: &str| text.split_whitespace().map(str::to_owned).collect::<Vec<_>>();
    let printed = words(&formula::as_rust(&formula::COEFFICIENTS));
    let source = words(include_str!("../../src/light/ltc/formula/numbers.rs"));
    assert!(source.ends_with(&printed), "{printed:?}");
    let shader = include_str!("../../shaders/ltc_formula.wgsl");
    let polynomials = formula::as_wgsl(&formula::COEFFICIENTS);
    for polynomial in polynomials.split_inclusive(";\n") {
        assert!(shader.contains(polynomial), "{polynomial}");
    }
}

/// On held-out lights, a short search comes close to the current numbers.
#[test]
fn a_short_search_comes_close_to_the_formula() {
    let found = formula::find(&formula::Options { lights: 150, steps: 15, seed: 51 });
    let [current, end] = found.held_out;
    println!("{end:.6}; current: {current:.6}; training: {:.6?}", found.training);
    assert!((0.85..1.5).contains(&(end / current)), "{end} {current}");
}

/// The found polynomials equal the polynomials of the shaders.
#[test]
fn the_polynomials_of_the_shaders_are_those_with_the_least_error() {
    let shaders = [
        (include_str!("../../shaders/ltc_rectangle.wgsl"), 2.6e-5),
        (include_str!("../../shaders/ltc_quadrant.wgsl"), 2.6e-5),
        (include_str!("../../shaders/normals_arcs.wgsl"), 1.3e-4),
        (include_str!("../../shaders/normals_arcs_rough.wgsl"), 8.5e-4),
    ];
    let rows = minimax::rows();
    assert_eq!(rows.len(), shaders.len());
    for ((name, numbers, error), (shader, most)) in rows.into_iter().zip(shaders) {
        for number in numbers {
            assert!(shader.contains(&number), "{name}: {number}");
        }
        assert!(error < most, "{name}: {error}");
    }
}

/// A search on other lights finds the current numbers, and the shader contains them.
#[test]
fn the_bulge_of_arcs_is_the_best_of_the_grid() {
    let found = arcs::find(400, 30);
    println!("{found:?}");
    assert!((0..2).all(|i| (found.bulge[i] - BULGE[i]).abs() < 0.25), "{found:?}");
    assert!(found.held_out[0] < 1.1 * found.held_out[1], "{found:?}");
    let shader = include_str!("../../shaders/normals_edge.wgsl");
    for (name, number) in [("least", BULGE[0]), ("more", BULGE[1])] {
        assert!(shader.contains(&format!("let {name} = {number} *")), "{name}: {number}");
    }
}

/// On held-out lights, a short search comes close to the current numbers.
#[test]
fn a_short_search_comes_close_to_the_numbers_of_networks() {
    for (rule, most) in [(NormalsRule::Fast, 1.3), (NormalsRule::Balanced, 2.5), (NormalsRule::Fine, 2.5)] {
        let found = networks::find(&Options { rule, lights: 6000, rounds: 40, starts: 2, seed: 71, refine: false });
        let ([current, end], training) = (found.held_out, found.training);
        println!("{rule}: {end:.6}; current: {current:.6}; training: {training:.6?}");
        assert!((0.85..most).contains(&(end / current)) && training[1] < most * training[0], "{rule}: {found:?}");
    }
}

/// A search that starts from the current numbers, on other lights, finds numbers of about the same error.
#[test]
fn a_refined_network_is_as_good_as_the_current_one() {
    for rule in [NormalsRule::Fast, NormalsRule::Balanced, NormalsRule::Fine] {
        let found = networks::find(&Options { rule, lights: 6000, rounds: 5, starts: 1, seed: 73, refine: true });
        assert!(found.numbers != Numbers::from(rule.network()), "{rule}");
        let change = found.held_out[1] / found.held_out[0];
        assert!((0.95..1.1).contains(&change) && found.training[1] < 1.02 * found.training[0], "{rule}: {found:?}");
    }
}

/// The found law and the current law both predict the error of held-out tables approximately.
#[test]
fn a_short_run_finds_the_expected_errors_of_tables() {
    expected::find(&[Layout::Reflected], &Extent::SHORT, |found| {
        println!("{found:.3?}");
        for ratios in &found.held_out {
            assert!(ratios.iter().all(|ratio| (0.75..1.35).contains(ratio)), "{found:?}");
        }
    })
    .expect("recipes");
}

/// The numbers in a cell of a Markdown table.
fn numbers(cell: &str) -> Vec<f64> {
    cell.split([' ', ',']).filter_map(|word| word.trim().parse().ok()).collect()
}

/// The rows of a Markdown text. The first `named` cells of a row are its name, followed by the first number of each
/// other cell.
fn table_rows(text: &str, named: usize) -> Vec<(String, Vec<f64>)> {
    let row = |line: &str| {
        let cells: Vec<&str> = line.strip_prefix("| ")?.strip_suffix(" |")?.split(" | ").collect();
        let (names, rest) = cells.split_at_checked(named)?;
        let firsts: Option<Vec<f64>> = rest.iter().map(|cell| numbers(cell).first().copied()).collect();
        Some((names.join(" | "), firsts?))
    };
    text.lines().filter_map(row).filter(|(_, numbers)| !numbers.is_empty()).collect()
}

/// Compares the rows of a document with the rows of the same name from a shortened study. Their means must agree
/// within `factor`. Returns the number of compared rows. The document need not have all rows of the study.
fn check_rows(document: &str, printed: &str, named: usize, factor: f64) -> usize {
    let (documented, printed) = (table_rows(document, named), table_rows(printed, named));
    let mut compared = 0;
    for (name, found) in &printed {
        let Some((_, wanted)) = documented.iter().find(|(other, _)| other == name) else { continue };
        compared += 1;
        assert_eq!(found.len(), wanted.len(), "{name}");
        for (found, wanted) in found.iter().zip(wanted) {
            assert!((1.0 / factor..factor).contains(&(found / wanted)), "{name}: {found} printed, {wanted} documented");
        }
    }
    compared
}

#[test]
fn the_documents_have_the_rows_of_model_normals() {
    let printed = models::tables(0.2).expect("a recipe");
    let (errors, light) = printed.split_once("docs/lights.md").expect("two documents");
    assert_eq!(check_rows(NORMALS_PAGE, errors, 1, 1.8), 8);
    // The names of rows contain the number of lights.
    let few = |text: &str| {
        text.replace(", 10000 |", " |").replace(", 3000 |", " |").replace(", 2000 |", " |").replace(", 600 |", " |")
    };
    assert_eq!(check_rows(&few(LIGHTS_PAGE), &few(light), 2, 1.8), 6);
}

#[test]
fn the_documents_have_the_smoothness_of_rule_balanced() {
    let found = paths::measure(1, 1.0, paths::by_rule(NormalsRule::Balanced));
    let rows = [
        ("| strips: relative error, p95 |", vec![found.strips]),
        ("| strips that lose over a tenth", vec![found.lost]),
        ("| growth to one side: p99; above .005 |", vec![found.to_one_side[0]]),
        ("| growth about the middle: p99, max |", found.about_middle[0].to_vec()),
        ("| the same for F0 = .04 |", found.about_middle[1].to_vec()),
    ];
    for (start, found) in rows {
        let row = NORMALS_PAGE.lines().find(|line| line.starts_with(start)).expect("a row");
        let cell = row.split(" | ").nth(2).expect("rule balanced").replace([';', '%'], " ");
        let percent = if row.contains("lose over") { 0.01 } else { 1.0 };
        for (found, documented) in found.into_iter().zip(numbers(&cell)) {
            let documented = percent * documented;
            assert!((found - documented).abs() < 0.04 * documented + 5e-5, "{start} {found} {documented}");
        }
    }
}

#[test]
fn the_documents_have_the_ratio_to_the_best_ltcs() {
    let recipe = Recipe::builder().preset(Preset::Draft).build().expect("a recipe");
    let found = best::compared(&recipe, 60);
    let row = README.lines().find(|line| line.starts_with("| preset `draft` |")).expect("a row");
    let ratio = numbers(row.rsplit(" | ").next().expect("a ratio"))[0];
    println!("{found:?}, documented {ratio}");
    assert!((found.ratio.mean - ratio).abs() < 0.06 && found.ratio.max < 3.0, "{found:?} {ratio}");
}

#[test]
fn the_documents_have_the_l3_distances() {
    let distance = |metric: Metric, solver: Solver| {
        let recipe =
            Recipe::builder().layout(Layout::Ltc2017).metric(metric).solver(solver).samples(128).directions(16);
        let recipe = recipe.steps(40).resolution("alpha", 32).resolution("theta", 32).build().expect("a recipe");
        l3::mean_distance(&fitted(&recipe), 60, 60)
    };
    let found = [distance(Metric::L3, Solver::NelderMead), distance(Metric::L3, Solver::Bfgs)];
    let documented = ["| `l3`, `nelder_mead` |", "| `l3`, `bfgs` |"].map(|start| {
        let row = ISOTROPIC_PAGE.lines().find(|line| line.starts_with(start)).expect("a row");
        numbers(row.split(" | ").nth(1).expect("a distance"))[0]
    });
    println!("{found:?}, documented {documented:?}");
    for (found, documented) in found.iter().zip(documented) {
        assert!((0.6..1.7).contains(&(found / documented)), "{found} {documented}");
    }
}

#[test]
fn differences_of_f32_through_glass_agree_with_the_document() {
    for row in glass::differences().lines() {
        assert!(REFRACTION_PAGE.lines().any(|line| line == row), "{row}");
    }
}

/// On held-out surfaces, a search over fewer surfaces finds a cubic as good as the current cubic. The library and the
/// shader have the printed numbers.
#[test]
fn the_albedo_is_as_good_as_the_cubic_of_a_search() {
    let found = albedo::find(&albedo::places(3000, false));
    let held_out = albedo::places(600, true);
    let errors = |numbers: [f64; 31]| albedo::errors_of(&held_out, &numbers);
    let (current, new) = (errors(LOSS), errors(found));
    println!("{current:?} {new:?}");
    assert!(current[0] < 1.1 * new[0] && current[0] < 0.007, "{current:?} {new:?}");
    assert!(include_str!("../../src/light/albedo.rs").contains(&albedo::as_rust(&LOSS)), "{}", albedo::as_rust(&LOSS));
    let shader = include_str!("../../shaders/ltc_albedo.wgsl");
    assert!(shader.contains(&albedo::as_wgsl(&LOSS)), "{}", albedo::as_wgsl(&LOSS));
    for row in albedo::materials().lines().filter(|line| line.starts_with("| ")) {
        assert!(MATERIALS_PAGE.contains(row), "{row}: cargo run --release -p ltcforge-studies -- albedo");
    }
}

/// The table fitted to a tabulated BRDF has about the error of the formula's table, and about that of the BRDF itself.
#[test]
fn a_brdf_given_as_numbers_has_the_errors_of_the_page() {
    let found = tabulated::find(Preset::Draft, 0.05).expect("the page's recipe");
    let [numbers, table, formula, _] = found.errors.map(|error| error.mean);
    println!("{}", found.text());
    assert!(table < 1.2 * formula && table < 1.2 * numbers && numbers < 0.01, "{table} {formula} {numbers}");
    let size = format!("{} values in {} bytes", grouped(found.values), grouped(found.file_bytes));
    assert!(MATERIALS_PAGE.contains(&size), "{size}");
}
