//! `ltcforge tradeoff`, on tables of a few entries.

use std::{collections::BTreeMap, fs};

use crate::common::command::{run, run_with_stdin};
use serde_json::Value;

/// Little to fit, whatever the effort.
const TINY: &str =
    r#"{"resolution":{"alpha":2,"ratio":2,"theta":2,"phi":2},"range":{"alpha":[0.2,0.5]},"terms":false}"#;

#[test]
fn a_small_family_is_written_three_times_over() {
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
        for name in ["seconds", "error_mean", "error_p95", "predicted_seconds", "predicted_error"] {
            let cell: f64 = cells[name].parse().expect("a number");
            assert!((cell - row[name].as_f64().expect("a number")).abs() <= 1e-4, "{name}: {cells:?}");
        }
        assert_eq!(cells["on_front_bytes"], row["on_front"]["bytes"].to_string());
    }
    let presets: Vec<&str> = rows.iter().filter_map(|row| row["preset"].as_str()).collect();
    assert_eq!(presets, ["draft", "standard", "paper", "best"]);
    // 16 entries of 9 numbers.
    assert_eq!(rows[0]["bytes"], 16 * 9 * 4);
    for front in ["seconds", "bytes", "base"] {
        assert!(rows.iter().any(|row| row["on_front"][front] == true), "{front}");
    }

    let svg = read("tradeoff.svg");
    assert!(svg.starts_with("<svg ") && svg.ends_with("</svg>\n"));
    assert!(!svg.contains("NaN") && !svg.contains("inf"));
    for preset in presets {
        assert_eq!(svg.matches(&format!(">{preset}</text>")).count(), 2, "{preset} stands in both panels");
        assert!(ended.stdout.contains(preset));
    }
    assert!(ended.stdout.contains("measured over predicted"), "{}", ended.stdout);
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
