//! Lookup tables with the binary.

use std::fs;

use ltcforge::Digest;
use serde_json::Value;

use crate::common::command::{run, run_with_stdin};

#[test]
fn a_dfg_table_is_fitted_measured_and_exported() {
    let folder = tempfile::tempdir().expect("a folder");
    let fitted = run(folder.path(), ["fit", "dfg", "-o", "tables"]).exited(0);
    let digest: Digest = fitted.last_line().parse().expect("a digest");
    let again = run_with_stdin(folder.path(), ["fit", "-", "-o", "again"], r#"{"table": "dfg"}"#).exited(0);
    assert_eq!(again.last_line(), digest.to_string());
    let name = digest.hex()[..12].to_owned();
    let report = run(folder.path(), ["--json", "report", name.as_str()]).exited(0);
    let report: Value = serde_json::from_str(&report.stdout).expect("JSON");
    let error = &report["report"]["stored"];
    assert!(error["mean"].as_f64() < Some(3e-4) && error["max"].as_f64() < Some(4e-3), "{report}");
    run(folder.path(), ["export", name.as_str(), "--for", "bevy", "-o", "brdf"]).exited(0);
    assert!(fs::read(folder.path().join("brdf/dfg.ktx2")).expect("a file").starts_with(b"\xabKTX 20\xbb"));
    run(folder.path(), ["export", name.as_str(), "--container", "npy", "--precision", "half", "-o", "npy"]).exited(0);
    let refused = run(folder.path(), ["export", name.as_str(), "--for", "playcanvas", "-o", "other"]).exited(2);
    assert!(
        refused.stderr.contains("lookup tables have no export «playcanvas»; engines: three, "),
        "{}",
        refused.stderr
    );
    run(folder.path(), ["export", name.as_str(), "--for", "blender", "-o", "blender"]).exited(0);
    assert!(folder.path().join("blender/brdf_ggx.inc").exists());
    let refused = run(folder.path(), ["preview", name.as_str(), "-o", "sphere.png"]).exited(2);
    assert!(refused.stderr.contains("lookup table"), "{}", refused.stderr);
    run(folder.path(), ["plot", name.as_str(), "error", "-o", "errors.png"]).exited(0);
    assert!(fs::read(folder.path().join("errors.png")).expect("a picture").starts_with(b"\x89PNG"));
    let lock = ["lock", "brdf", "--recipe", "dfg", "--for", "three", "--out", "assets/brdf"];
    run(folder.path(), lock).exited(0);
    assert!(folder.path().join("assets/brdf/DFGLUTData.js").exists());
    run(folder.path(), ["pull"]).exited(0);
    run(folder.path(), ["verify", "--refit", "brdf/ltcforge.json"]).exited(0);
}

#[test]
fn a_table_of_three_axes_is_locked_as_textures() {
    let folder = tempfile::tempdir().expect("a folder");
    let recipe = r#"{"table": "transmission", "resolution": {"ior": 2, "roughness": 2, "cos_theta": 2}}"#;
    fs::write(folder.path().join("recipe.json"), recipe).expect("a recipe");
    let lock = |words: &[&str]| {
        run(folder.path(), [&["lock", "glass", "--recipe", "recipe.json", "--out", "glass"], words].concat())
    };
    let refused = lock(&["--for", "three"]).exited(2).stderr;
    assert!(refused.contains("three has no file of table transmission"), "{refused}");
    lock(&["--container", "ktx2", "--precision", "half"]).exited(0);
    run(folder.path(), ["pull"]).exited(0);
    run(folder.path(), ["verify", "--refit", "glass/ltcforge.json", "glass.safetensors"]).exited(0);
    fs::write(folder.path().join("glass/transmission.ktx2"), "other").expect("a file");
    run(folder.path(), ["verify", "glass/ltcforge.json"]).exited(3);
}
