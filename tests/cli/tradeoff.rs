//! `ltcforge tradeoff`, with tables of a few entries.

use std::{collections::BTreeMap, fs};

use crate::common::command::{run, run_with_stdin};
use serde_json::Value;

/// Fits with few entries, which are fast with every effort.
const TINY: &str =
    r#"{"resolution":{"alpha":2,"ratio":2,"theta":2,"phi":2},"range":{"alpha":[0.2,0.5]},"terms":false}"#;

#[test]
fn a_small_family_is_written_in_three_formats() {
    let folder = tempfile::tempdir().expect("a folder");
    let arguments = ["tradeoff", "--recipe", "-", "--quick", "-o", "out", "--threads", "2"];
    let ended = run_with_stdin(folder.path(), arguments, TINY).exited(0);
    let read = |name: &str| fs::read_to_string(folder.path().join("out").join(name)).expect("a file");

    let document: Value = serde_json::from_str(&read("tradeoff.json")).expect("JSON");
    let rows = document["rows"].as_array().expect("rows");
    let csv = read("tradeoff.csv");
    let lines: Vec<Vec<&str>> = csv.lines().map(|line| line.split(',').collect()).collect();
    assert_eq!(lines.len(), rows.len() + 1);
    for (row, line) in rows.iter().zip(&lines[1..]) {
        let cells: BTreeMap<&str, &str> = lines[0].iter().copied().zip(line.iter().copied()).collect();
        assert_eq!(cells.len(), line.len());
        for name in ["recipe_digest", "layout", "precision"] {
            assert_eq!(cells[name], row[name], "{name}");
        }
        for name in ["samples", "directions", "steps", "entries", "bytes"] {
            assert_eq!(cells[name], row[name].to_string(), "{name}");
        }
        for name in
            ["seconds", "error_mean", "error_p95", "light_mean", "light_p95", "predicted_seconds", "predicted_error"]
        {
            let cell: f64 = cells[name].parse().expect("a number");
            assert!((cell - row[name].as_f64().expect("a number")).abs() <= 1e-4, "{name}: {cells:?}");
        }
        assert_eq!(cells["on_front_bytes"], row["on_front"]["bytes"].to_string());
    }
    let presets: Vec<&str> = rows.iter().filter_map(|row| row["preset"].as_str()).collect();
    assert_eq!(presets, ["draft", "standard", "paper", "best"]);
    // 16 entries of 9 numbers.
    assert_eq!(rows[0]["bytes"], 16 * 9 * 4);
    assert!(rows[0]["compact_bytes"].as_u64().is_some_and(|bytes| (100..1000).contains(&bytes)), "{document}");
    for front in ["seconds", "bytes", "base"] {
        assert!(rows.iter().any(|row| row["on_front"][front] == true), "{front}");
    }

    let svg = read("tradeoff.svg");
    assert!(svg.starts_with("<svg ") && svg.ends_with("</svg>\n"));
    assert!(!svg.contains("NaN") && !svg.contains("inf"));
    for preset in presets {
        assert_eq!(svg.matches(&format!(">{preset}</text>")).count(), 2, "{preset} must be in both panels");
        assert!(ended.stdout.contains(preset));
    }
    assert!(ended.stdout.contains("measured over predicted"), "{}", ended.stdout);
    models_are_measured(&document, &svg, &ended.stdout);
}

/// The same lights measure the table of preset `paper`, both fitted Gaussians, the three rules of the closed form, the LTC
/// by a formula, and both Gaussians in closed form.
#[track_caller]
fn models_are_measured(document: &Value, svg: &str, stdout: &str) {
    let models = &document["models"];
    assert_eq!(models["lights"], 2048);
    assert!((0.1..0.9).contains(&models["mean_energy"].as_f64().expect("a number")), "{models}");
    let rows = models["rows"].as_array().expect("rows");
    let names = [
        "ltc reflected",
        "sg reflected",
        "asg reflected",
        "normals balanced",
        "normals fast",
        "normals fine",
        "ltc-formula",
        "sg",
        "asg",
    ];
    assert_eq!(rows.len(), names.len());
    for (row, name) in rows.iter().zip(names) {
        let kind = if row["layout"].is_null() { &row["rule"] } else { &row["layout"] };
        let output = [row["model"].as_str().expect("a name"), kind.as_str().unwrap_or_default()].join(" ");
        assert_eq!(output.trim_end(), name);
        assert!(row["shader_bytes"].as_u64().expect("a number") > 1000, "{row}");
        assert_eq!(svg.matches(&format!(">{name}</text>")).count(), 2, "{name} must be in both charts of light");
        assert!(row["gpu_cost"]["instructions"].as_u64().expect("a number") > 200, "{row}");
        assert!(stdout.lines().any(|line| line.starts_with(name)), "{stdout}");
    }
    let error = |row: usize| rows[row]["light_error"]["mean"].as_f64().expect("a number");
    // The table only has sixteen entries. Rules with more normals are more accurate.
    assert!(error(0) > error(3) && error(4) > error(3) && error(3) > error(5), "{models}");
    assert!(error(7) > error(8) && error(8) > error(6) && error(6) > error(4), "{models}");
    let table = document["rows"].as_array().expect("rows").iter().find(|row| row["preset"] == "paper").expect("a row");
    assert_eq!(rows[0]["recipe_digest"], table["recipe_digest"]);
    assert_eq!(rows[0]["fit_seconds"], table["seconds"]);
    assert_eq!(rows[0]["light_error"]["mean"], table["light_mean"]);
    // Sixteen entries of twelve numbers.
    assert_eq!(rows[0]["gpu_bytes"], 16 * 12 * 4);
    assert!(rows[0]["file_bytes"].as_u64() > table["bytes"].as_u64(), "{models}");
    for row in &rows[3..] {
        for name in ["gpu_bytes", "file_bytes", "fit_seconds"] {
            assert_eq!(row[name].as_f64(), Some(0.0), "{name}: {row}");
        }
        assert!(row["recipe_digest"].is_null() && row["layout"].is_null(), "{row}");
    }
}

#[test]
fn bad_input_is_refused_before_anything_is_fitted() {
    let folder = tempfile::tempdir().expect("a folder");
    let refused = run_with_stdin(folder.path(), ["tradeoff", "--recipe", "-"], r#"{"colour":1}"#).exited(2);
    assert!(refused.stderr.contains("/colour"), "{}", refused.stderr);
    assert!(run(folder.path(), ["tradeoff", "--recipe", "finest"]).exited(2).stderr.contains("finest"));
    run(folder.path(), ["tradeoff", "--recipe", "./none.json"]).exited(1);
    run(folder.path(), ["tradeoff", "paper"]).exited(2);
    assert_eq!(fs::read_dir(folder.path()).expect("the folder").count(), 0);
}
