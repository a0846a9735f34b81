//! `verify --refit` and `diff`: whether a table is the result of its recipe, and how two tables differ.

use std::fs;

use ltcforge::{Digest, TableFile, files::container};
use serde_json::Value;

use crate::common::{
    SMALL,
    command::{run, run_with_stdin},
};

/// A folder with the table of [`SMALL`] and a table with another seed, and the names of both files.
fn two() -> (tempfile::TempDir, [String; 2]) {
    let folder = tempfile::tempdir().expect("a folder");
    let other = SMALL.replace(r#""steps":5"#, r#""steps":5,"seed":7"#);
    assert_ne!(other, SMALL);
    let names = [SMALL, &other].map(|recipe| {
        let fitted = run_with_stdin(folder.path(), ["fit", "-"], recipe).exited(0);
        let digest: Digest = fitted.last_line().parse().expect("a digest");
        format!("{}.safetensors", digest.hex())
    });
    (folder, names)
}

#[test]
fn a_table_is_refitted_and_a_table_with_other_numbers_is_rejected() {
    let (folder, [table, other]) = two();
    let here = folder.path();
    let output = run(here, ["verify", &table, &other, "--refit", "--threads", "1"]).exited(0);
    assert_eq!(output.stdout.matches("and fitting its recipe gives the same bytes").count(), 2, "{output:#?}");

    // The numbers of one table with the recipe of the other: a well-formed file that is not the result of its recipe.
    let read = |name: &str| TableFile::from_bytes(&fs::read(here.join(name)).expect("a file")).expect("a table");
    let forged = container::encode(read(&table).recipe(), read(&other).table()).expect("a file");
    fs::write(here.join("forged.safetensors"), &forged).expect("a file");
    run(here, ["verify", "forged.safetensors"]).exited(0);
    let refused = run(here, ["verify", "forged.safetensors", "--refit"]).exited(3);
    let right = format!("sha256:{}", table.replace(".safetensors", ""));
    for said in ["forged.safetensors: ", &Digest::of(&forged).to_string(), &right] {
        assert!(refused.complaints()[0].contains(said), "{said}: {refused:#?}");
    }
    let refused = run(here, ["verify", &table, "--refit", "--entry-limit", "3"]).exited(2);
    assert!(refused.stderr.contains("16 entries"), "{refused:#?}");
}

#[test]
fn files_of_an_export_are_made_again_from_their_recipe() {
    let (folder, [table, other]) = two();
    let here = folder.path();
    for (words, out) in [(["--for", "wgpu"], "wgpu"), (["--container", "compact-js"], "compact")] {
        run(here, ["export", &table, "--out", out].iter().chain(&words)).exited(0);
        let output = run(here, ["verify", out, "--refit"]).exited(0);
        let right = format!("{out}/ltcforge.json: ok, sha256:{}", table.replace(".safetensors", ""));
        assert!(output.stdout.starts_with(&right) && output.stdout.contains("its recipe gives"), "{output:#?}");
    }
    run(here, ["verify", "wgpu/ltcforge.json"]).exited(0);
    let refused = run(here, ["verify", "wgpu", "--digest", &other.replace(".safetensors", "")]).exited(3);
    assert!(refused.complaints()[0].contains("the table is"), "{refused:#?}");

    let manifest = here.join("wgpu/ltcforge.json");
    let text = fs::read_to_string(&manifest).expect("a manifest");
    let document: Value = serde_json::from_str(&text).expect("JSON");
    let first = here.join("wgpu").join(document["files"][0]["path"].as_str().expect("a path"));
    let bytes = fs::read(&first).expect("a file");
    let broken: Vec<u8> = bytes.iter().rev().copied().collect();
    fs::write(&first, &broken).expect("a file");
    let refused = run(here, ["verify", "wgpu"]).exited(3);
    assert!(refused.complaints()[0].contains("with sha256"), "{refused:#?}");
    // If the manifest was changed as well, only the fit reveals the change.
    let forged = text.replace(&Digest::of(&bytes).hex(), &Digest::of(&broken).hex());
    fs::write(&manifest, forged).expect("a manifest");
    run(here, ["verify", "wgpu"]).exited(0);
    let refused = run(here, ["verify", "wgpu", "--refit"]).exited(3);
    assert!(refused.complaints()[0].contains("has other bytes"), "{refused:#?}");
    fs::write(&first, &bytes).expect("a file");

    let mut elsewhere = document.clone();
    elsewhere["recipe"]["fit"]["steps"] = 4.into();
    let mut without = document.clone();
    without.as_object_mut().expect("an object").remove("recipe");
    let mut outside = document.clone();
    outside["files"][0]["path"] = "../x".into();
    for (changed, words, output) in [
        (elsewhere, &["verify", "wgpu", "--refit"][..], "fitting their recipe gives"),
        (without, &["verify", "wgpu", "--refit"], "the manifest has no recipe"),
        (outside, &["verify", "wgpu"], "is outside the manifest's folder"),
        (Value::Null, &["verify", "wgpu"], "not a manifest"),
    ] {
        fs::write(&manifest, changed.to_string()).expect("a manifest");
        let refused = run(here, words).exited(3);
        assert!(refused.complaints()[0].contains(output), "{output}: {refused:#?}");
    }
}

#[test]
fn two_tables_are_compared_by_lookups_and_errors() {
    let (folder, [table, other]) = two();
    let here = folder.path();
    let output = |a: &str, b: &str| -> Value {
        let printed = run(here, ["diff", a, b, "--json"]).exited(0);
        serde_json::from_str(&printed.stdout).expect("JSON")
    };
    let same = output(&table, &table);
    assert_eq!(same["same_bytes"], true);
    assert_eq!(same["difference"]["amplitude"]["max"], 0.0);
    let apart = output(&table, &other);
    assert_eq!(apart["same_bytes"], false);
    let max = apart["difference"]["matrix"]["max"].as_f64().expect("a number");
    let mean = apart["difference"]["matrix"]["mean"].as_f64().expect("a number");
    assert!(1e-4 < max && max < 1.0 && mean < max, "{}", apart["difference"]);
    // `diff` and `report` must print the same figures.
    let report = run(here, ["report", &other, "--json"]).exited(0);
    let report: Value = serde_json::from_str(&report.stdout).expect("JSON");
    assert_eq!(apart["b"]["report"], report["report"]);
    assert_ne!(apart["a"]["report"], apart["b"]["report"]);

    let text = run(here, ["diff", &table, &other]).exited(0).stdout;
    for said in ["matrix, of its norm", "amplitude", "Fresnel term", "error between nodes", &table, &other] {
        assert!(text.contains(said), "{said} is not in {text}");
    }
    assert!(run(here, ["diff", &table, &table]).exited(0).stdout.contains("the same bytes\n"));
}

#[test]
fn a_published_table_is_compared_and_a_wrong_shape_is_rejected() {
    let (folder, [table, _]) = two();
    let here = folder.path();
    let npy = |shape: &str, numbers: usize| {
        let head = format!("{{'descr': '<f4', 'fortran_order': False, 'shape': ({shape}), }}\n");
        let length = u16::try_from(head.len()).expect("a short head").to_le_bytes();
        let identity = [1.0_f32, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0];
        let data: Vec<u8> = identity.iter().cycle().take(numbers).flat_map(|x| x.to_le_bytes()).collect();
        [b"\x93NUMPY\x01\x00".as_slice(), &length, head.as_bytes(), &data].concat()
    };
    fs::write(here.join("round.npy"), npy("2, 2, 2, 2, 3, 3", 16 * 9)).expect("a file");
    let printed = run(here, ["diff", &table, "round.npy", "--points", "64", "--json"]).exited(0);
    let output: Value = serde_json::from_str(&printed.stdout).expect("JSON");
    assert!(output["difference"]["amplitude"].is_null(), "{output}");
    assert!(output["difference"]["matrix"]["max"].as_f64().is_some_and(|max| max > 0.1), "{output}");

    let wrong = [
        ("2, 2, 2, 3, 3", 8 * 9, "[alpha, ratio, theta, phi, 3, 3]"),
        ("2, 2, 2, 2, 3, 3", 15 * 9, "the shape needs 576"),
        ("2, 2, 2, 1, 3, 3", 8 * 9, "2 to 16384 nodes on each axis"),
    ];
    for (shape, numbers, said) in wrong {
        fs::write(here.join("wrong.npy"), npy(shape, numbers)).expect("a file");
        let count = fs::read_dir(here).expect("the folder").count();
        let export = ["export", "wrong.npy", "--layout", "kt2022", "--container", "ktx2", "--out", "out"];
        for words in [&["diff", &table, "wrong.npy"][..], &["lock", "metal", "wrong.npy"], &export] {
            let refused = run(here, words).exited(3);
            assert!(refused.complaints()[0].contains("wrong.npy: "), "{refused:#?}");
            assert!(words[0] == "lock" || refused.stderr.contains(said), "{said}: {refused:#?}");
        }
        assert_eq!(fs::read_dir(here).expect("the folder").count(), count, "{shape}");
    }
}
