//! Tabulated BRDFs: from a file to a table, and the errors of missing or invalid files.

use std::fs;

use serde_json::Value;

use crate::common::command::{run, run_with_stdin};

/// The common part of two recipes: for the file, and for the model that it was made from.
const REST: &str = r#""resolution": {"alpha": 3, "theta": 4}, "range": {"alpha": [0.1, 1], "theta": [0, 1.4]},
    "fit": {"samples": 128, "directions": 8}}"#;

fn json(text: &str) -> Value {
    serde_json::from_str(text).expect("JSON")
}

#[test]
fn a_model_given_as_numbers_is_fitted_like_the_model() {
    let folder = tempfile::tempdir().expect("a folder");
    let here = folder.path();
    fs::create_dir(here.join("in")).expect("a folder");
    let made = run(here, ["tabulate", "oren_nayar", "--alpha", "0.1,0.3,0.6,1", "-o", "in/eon.safetensors"]).exited(0);
    let digest = made.last_line().to_owned();
    fs::write(here.join("in/recipe.json"), format!(r#"{{"brdf": "tabulated", "tabulated": "eon.safetensors", {REST}"#))
        .expect("a recipe");
    let fitted = run(here, ["fit", "in/recipe.json", "-o", "tables"]).exited(0);
    assert!(fitted.stderr.contains("exchanging view and light changes it by up to 0.00 %"), "{fitted:#?}");
    let table = fitted.last_line();
    let own =
        run_with_stdin(here, ["fit", "-", "-o", "tables"], &format!(r#"{{"brdf": "oren_nayar", {REST}"#)).exited(0);

    let apart = json(&run(here, ["diff", table, own.last_line(), "--json"]).exited(0).stdout);
    for (of, most) in [("matrix", 0.02), ("amplitude", 0.003), ("fresnel", 0.003)] {
        let mean = apart["difference"][of]["mean"].as_f64().expect("a number");
        assert!(mean < most && mean > 0.0, "{of}: {mean}");
    }
    let width = |side: &str| apart[side]["report"]["between"]["width"]["mean"].as_f64().expect("a number");
    assert!((width("a") - width("b")).abs() < 0.005, "{} {}", width("a"), width("b"));

    // The canonical recipe contains the digest of the file, and the file with this digest is found next to the table.
    // The bytes are equal.
    let recipe = format!(r#"{{"brdf": "tabulated", "tabulated": "{digest}", {REST}"#);
    let again = run_with_stdin(here, ["fit", "-", "-o", "tables"], &recipe).exited(0);
    assert_eq!(again.last_line(), table);
    let hex = table.trim_start_matches("sha256:");
    let manifest = json(&fs::read_to_string(here.join(format!("tables/{hex}.manifest.json"))).expect("a manifest"));
    assert_eq!(manifest["tabulated"]["file"], digest.as_str());
    assert_eq!(manifest["recipe"]["tabulated"], digest.as_str());
    assert!(
        manifest["tabulated"]["asymmetry"]["largest"].as_f64().is_some_and(|largest| largest < 1e-6),
        "{manifest:#}"
    );
    let refitted = run(here, ["verify", &format!("tables/{hex}.safetensors"), "--refit"]).exited(0);
    assert!(refitted.stdout.contains("gives the same bytes"), "{refitted:#?}");

    // The reference uses the file.
    let picture = ["preview", table, "-o", "strip.png", "--mode", "strip", "--size", "64", "--spp", "64"];
    let shown = run(here, picture.iter().chain(&["--alpha-x", "0.5", "--alpha-y", "0.5"])).exited(0);
    assert!(shown.stderr.contains("adapter: cpu"), "{shown:#?}");

    // Without the file, the table cannot be measured. Everything else works.
    fs::remove_file(here.join(format!("tables/{}.brdf.safetensors", digest.trim_start_matches("sha256:"))))
        .expect("the file");
    let commands = [
        &["report", table][..],
        &["plot", table, "error", "-o", "e.png"],
        &["light", "/dev/null", "--model", "ltc", "--table", table, "--truth"],
        &["diff", table, table],
        &picture,
    ];
    for command in commands {
        let refused = run(here, command).exited(1);
        assert!(refused.complaints()[0].contains("tabulated BRDF"), "{refused:#?}");
    }
    run(here, ["plot", table, "matrix", "-o", "m.png"]).exited(0);
    run(here, ["light", "/dev/null", "--model", "ltc", "--table", table]).exited(0);
    run(here, ["preview", table, "-o", "p.png", "--size", "64", "--adapter", "cpu"]).exited(0);
    run(here, ["verify", &format!("tables/{hex}.safetensors")]).exited(0);
}

#[test]
fn all_faults_of_recipe_and_file_are_reported_at_once_and_nothing_is_fitted() {
    let folder = tempfile::tempdir().expect("a folder");
    let here = folder.path();
    run(here, ["tabulate", "oren_nayar", "--alpha", "0.2", "-o", "b.safetensors"]).exited(0);
    let mut bytes = fs::read(here.join("b.safetensors")).expect("the file");
    // The last axis and the last value in the file. Its tensors follow the header, f64 before f32.
    let end = bytes.len();
    bytes[end - 4..].copy_from_slice(&f32::NAN.to_le_bytes());
    bytes[end - 8..end - 4].copy_from_slice(&(-1.0_f32).to_le_bytes());
    fs::write(here.join("b.safetensors"), bytes).expect("a file");
    let recipe = r#"{"brdf": "tabulated", "tabulated": "b.safetensors", "layout": "reflected", "terms": 1}"#;
    let refused = run_with_stdin(here, ["fit", "-", "-o", "out"], recipe).exited(2);
    let said =
        ["numbers are not finite; the first is NaN", "numbers are negative; the first is -1", "/layout: ", "/terms: "];
    for said in said {
        assert!(refused.stderr.contains(said), "{said}: {refused:#?}");
    }
    assert!(!here.join("out").exists());

    // If the file is missing, only this is reported. The file could be for anisotropic surfaces.
    let recipe = r#"{"brdf": "tabulated", "tabulated": "none.safetensors", "range": {"ratio": [0.4, 1]}, "resolution": {"phi": 3}}"#;
    let refused = run_with_stdin(here, ["fit", "-", "-o", "out"], recipe).exited(2);
    assert!(refused.complaints().len() == 1 && refused.stderr.contains("none.safetensors"), "{refused:#?}");

    let refused = run(here, ["tabulate", "ggx", "--alpha", "0.02", "-o", "c.safetensors"]).exited(2);
    assert!(refused.stderr.contains("reflect more than 1.001 of uniform light"), "{refused:#?}");
    assert!(!here.join("c.safetensors").exists());
}

/// GGX as numbers over azimuths and ratios. Its table equals that of the formula, for roughnesses and views in all
/// quadrants.
#[test]
fn an_anisotropic_model_given_as_numbers_is_fitted_like_the_model() {
    let folder = tempfile::tempdir().expect("a folder");
    let here = folder.path();
    let refused = run(here, ["tabulate", "charlie", "--ratio", "0.5,1", "-o", "c.safetensors"]).exited(2);
    assert!(refused.complaints()[0].contains("--ratio: brdf charlie is isotropic: leave it out"), "{refused:#?}");
    let nodes = ["--theta", "32", "--phi", "17", "--phi-o", "5"];
    let made = ["tabulate", "ggx", "--alpha", "0.4,0.8", "--ratio", "0.5,1", "-o", "g.safetensors", "--json"];
    let made = json(&run(here, made.iter().chain(&nodes)).exited(0).stdout);
    assert_eq!(made["shape"], serde_json::json!([2, 2, 24, 5, 32, 33]));

    let rest =
        r#""resolution": {"alpha": 2, "ratio": 2, "theta": 3, "phi": 3}, "fit": {"samples": 256, "directions": 16}}"#;
    let fit = |model: &str| run_with_stdin(here, ["fit", "-", "-o", "tables"], &format!("{{{model}, {rest}")).exited(0);
    let fitted = fit(r#""brdf": "tabulated", "tabulated": "g.safetensors""#);
    assert!(fitted.stderr.contains("% of its largest value, at alpha"), "{fitted:#?}");
    let table = fitted.last_line();
    let ranges =
        r#""layout": "kt2022", "range": {"alpha": [0.4, 0.8], "ratio": [0.5, 1], "theta": [0, 1.4661855412435194]}"#;
    let own = fit(ranges);
    let apart = json(&run(here, ["diff", table, own.last_line(), "--json"]).exited(0).stdout);
    for (of, most) in [("matrix", 0.006), ("amplitude", 0.006), ("fresnel", 0.001)] {
        let mean = apart["difference"][of]["mean"].as_f64().expect("a number");
        assert!(mean < most && mean > 0.0, "{of}: {mean}");
    }

    let output = json(&run(here, ["report", table, "--json"]).exited(0).stdout);
    let asymmetry = &output["asymmetry"];
    assert!(asymmetry["ratio"].is_number() && asymmetry["phi_o"].is_number(), "{output:#}");
    let picture = ["preview", table, "-o", "strip.png", "--mode", "strip", "--size", "64", "--spp", "64"];
    let shown = run(here, picture.iter().chain(&["--alpha-x", "0.4", "--alpha-y", "0.8"])).exited(0);
    assert!(shown.stderr.contains("adapter: cpu"), "{shown:#?}");
}
