//! Tables of listed materials, and tables with explicit nodes.

use serde_json::Value;

use crate::common::command::{run, run_with_stdin};

const FIT: &str = r#""fit": {"samples": 64, "directions": 4, "steps": 5}, "resolution": {"theta": 4, "phi": 3}"#;

/// Fits a recipe in a folder, and returns the table's digest.
fn fitted(folder: &std::path::Path, fields: &str) -> String {
    let recipe = format!("{{{fields}, {FIT}}}");
    run_with_stdin(folder, ["fit", "-", "-o", "."], &recipe).exited(0).last_line().to_owned()
}

#[test]
fn a_material_is_looked_up_by_its_number() {
    let folder = tempfile::tempdir().expect("a folder");
    let here = folder.path();
    let list = r#""layout": "materials", "materials": [{"alpha": 0.5}, {"alpha_x": 0.4, "alpha_y": 0.1}]"#;
    let table = fitted(here, list);
    let by_number = ["lookup", &table, "--tables", ".", "--points", "-", "--material", "1"];
    let views = run_with_stdin(here, by_number, "theta,phi\n0.7,2\n1.2,0\n").exited(0).stdout;
    let by_roughness = ["lookup", &table, "--tables", ".", "--points", "-"];
    let points = run_with_stdin(here, by_roughness, "0.4,0.1,0.7,2\n0.4,0.1,1.2,0\n").exited(0).stdout;
    assert_eq!(views, points);
    let missing = run_with_stdin(here, [&by_number[..7], &["2"]].concat(), "0,0\n").exited(2).stderr;
    assert!(missing.contains("--material 2: use 0 to 1"), "{missing}");
    let refused = run_with_stdin(here, by_number, "0.4,0.1,0.7,2\n").exited(2).stderr;
    assert!(refused.contains("line 1: 4 fields; the view of a material has two: theta,phi"), "{refused}");

    let report: Value = serde_json::from_str(
        &run(here, ["report", &table, "--tables", ".", "--points", "16", "--json"]).exited(0).stdout,
    )
    .expect("JSON");
    assert!(report["report"]["between"]["width"]["mean"].as_f64().is_some_and(|error| error < 0.3), "{report}");
    let picture = ["preview", &table, "--tables", ".", "-o", "lit.png", "--size", "64", "--adapter", "cpu"];
    run(here, picture).exited(0);
    run(here, ["plot", &table, "matrix", "--tables", ".", "-o", "matrix.png"]).exited(0);
    let compact =
        run(here, ["export", &table, "--tables", ".", "--container", "compact", "-o", "small"]).exited(2).stderr;
    assert!(compact.contains("materials"), "{compact}");
    run(here, ["export", &table, "--tables", ".", "--for", "wgpu", "-o", "textures"]).exited(0);

    let grid = fitted(here, r#""layout": "reflected", "range": {"alpha": [0.5, 0.5], "ratio": [1, 1]}"#);
    let refused = run_with_stdin(here, ["lookup", &grid, "--tables", ".", "--points", "-", "--material", "0"], "0,0\n");
    let output = refused.exited(2).stderr;
    assert!(output.contains("--material needs layout materials; this table has layout reflected"), "{output}");
}

#[test]
fn a_shader_text_contains_explicit_nodes() {
    let folder = tempfile::tempdir().expect("a folder");
    let here = folder.path();
    let uneven = fitted(here, r#""nodes": {"alpha": [0.04, 0.09, 0.25], "ratio": [1]}"#);
    let text = run(here, ["shader", "--language", "glsl", "--nodes", &uneven, "--tables", "."]).exited(0).stdout;
    assert!(text.contains("LTC_NODES_OF_ALPHA") && text.contains(&uneven[..20]), "{text}");
    run(here, ["export", &uneven, "--tables", ".", "--for", "wgpu", "-o", "textures"]).exited(0);
    let even = fitted(here, r#""nodes": {"alpha": [0.04, 0.25], "ratio": [1]}"#);
    let output = run(here, ["shader", "--language", "glsl", "--nodes", &even, "--tables", "."]).exited(2).stderr;
    assert!(output.contains("the table has the nodes of layout reflected: use --layout reflected"), "{output}");
    let words = ["shader", "--language", "glsl", "--nodes", &uneven, "--tables", ".", "--model", "normals"];
    assert!(run(here, words).exited(2).stderr.contains("--nodes and --without-textures need --model ltc"));
}
