//! Exports a table to the files of engines with the binary.

use std::{
    collections::BTreeMap,
    fs,
    path::{Path, PathBuf},
    process::Command,
};

use ltcforge::{Digest, textures::TextureContainer};
use serde_json::Value;

use crate::common::{
    SMALL,
    command::{run, run_with_stdin},
};

/// A folder with a table of layout `reflected`, and the table's path in this folder.
fn folder_with_table() -> (tempfile::TempDir, String) {
    let folder = tempfile::tempdir().expect("a folder");
    let fitted = run_with_stdin(folder.path(), ["fit", "-", "-o", "."], SMALL).exited(0);
    let digest: Digest = fitted.last_line().parse().expect("a digest");
    (folder, format!("{}.safetensors", digest.hex()))
}

/// The output of `--json`. Checks it against the written files.
fn json_output(folder: &Path, printed: &str) -> Value {
    let output: Value = serde_json::from_str(printed).expect("JSON");
    let files = output["files"].as_array().expect("files");
    assert!(!files.is_empty());
    for file in files {
        let bytes = fs::read(folder.join(file["file"].as_str().expect("a path"))).expect("the file");
        assert_eq!(file["bytes"], bytes.len());
        assert_eq!(file["sha256"], Digest::of(&bytes).hex());
    }
    output
}

#[test]
fn our_own_shader_gets_textures_and_the_contents_of_its_buffers() {
    let (folder, table) = folder_with_table();
    let here = folder.path();
    let printed = run(here, ["export", &table, "--for", "wgpu", "-o", "a/b", "--json"]).exited(0);
    let output = json_output(here, &printed.stdout);
    assert_eq!(output["layout"], "reflected");
    let names: Vec<&str> =
        output["files"].as_array().expect("files").iter().filter_map(|f| f["file"].as_str()).collect();
    let expected = ["ltc_matrix_a.ktx2", "ltc_matrix_b.ktx2", "ltc_terms.ktx2", "ltc.json", "ltcforge.json"];
    assert_eq!(names, expected.map(|name| format!("a/b/{name}")));

    // A KTX2 file: a 3D texture with the size and the numbers of the table.
    let reader = ktx2::Reader::new(fs::read(here.join("a/b/ltc_terms.ktx2")).expect("a file")).expect("KTX2");
    let header = reader.header();
    assert_eq!([header.pixel_width, header.pixel_height, header.pixel_depth], [2, 4, 2]);
    let about = reader.key_value_data().find(|(key, _)| *key == "ltcforge").expect("about").1;
    let about = String::from_utf8_lossy(about);
    for said in ["table sha256:", "recipe sha256:", "of the lobe's width", "CC0-1.0", "nodes of alpha: "] {
        assert!(about.contains(said), "{said} is not in {about}");
    }

    // Without `--json`, the output has a line for each file and each step. The bytes of the files are the same.
    let again = run(here, ["export", &table, "--for", "wgpu", "-o", "again", "--threads", "1"]).exited(0);
    assert!(again.stdout.starts_with("again/ltc_matrix_a.ktx2  "), "{}", again.stdout);
    assert!(again.stdout.contains("Binding 0 is ltc_table"), "{}", again.stdout);
    for name in expected {
        assert!(fs::read(here.join("a/b").join(name)).ok() == fs::read(here.join("again").join(name)).ok(), "{name}");
    }
}

#[test]
fn each_format_is_written() {
    let (folder, table) = folder_with_table();
    let here = folder.path();
    for container in TextureContainer::ALL {
        for precision in ["half", "float"] {
            let words = ["export", &table, "--layout", "reflected", "--container", container.name()];
            let more = ["--precision", precision, "-o", "out", "--json"];
            let output = json_output(here, &run(here, words.iter().chain(&more)).exited(0).stdout);
            let relative = output["files"][0]["rounding"]["relative"].as_f64().expect("a number");
            assert!((precision == "half") == (relative > 0.0) && relative < 1e-3, "{container} {precision}: {output}");
        }
    }
}

/// `export` prints the error of the compact form. Every command that reads tables can read it.
#[test]
fn a_compact_table_has_few_bytes_and_can_be_read() {
    let (folder, table) = folder_with_table();
    let here = folder.path();
    for (container, names) in [
        ("compact", &["out/ltc.compact", "out/ltcforge.json"][..]),
        ("compact-js", &["out/ltc.compact.js", "out/ltcforge.json"]),
        ("compact-rust", &["out/ltc.compact", "out/ltc.compact.rs", "out/ltcforge.json"]),
        ("compact-wgsl", &["out/ltc.compact", "out/ltc.compact.wgsl", "out/ltcforge.json"]),
    ] {
        let output = json_output(
            here,
            &run(here, ["export", &table, "--container", container, "-o", "out", "--json"]).exited(0).stdout,
        );
        let files: Vec<&str> =
            output["files"].as_array().expect("files").iter().filter_map(|f| f["file"].as_str()).collect();
        assert_eq!((files.as_slice(), &output["layout"]), (names, &Value::from("reflected")));
        for name in ["mean", "p95"] {
            let [of_table, of_form] = ["table", "decoded"].map(|of| output["compared"][of][name].as_f64());
            let [of_table, of_form] = [of_table, of_form].map(|error| error.expect("a number"));
            assert!(of_table > 0.0 && of_form < 1.05 * of_table, "{output}");
        }
    }
    let said = run(here, ["export", &table, "--container", "compact", "-o", "out"]).exited(0).stdout;
    assert!(said.contains("decoded mean 0.") && said.contains("table mean 0."), "{said}");
    let text = fs::read_to_string(here.join("out/ltc.compact.js")).expect("a file");
    for said in ["// table sha256:", "// recipe sha256:", "mean error", "CC0-1.0", "export function createTextures"] {
        assert!(text.contains(said), "{said} is not in {text}");
    }
    let bytes = fs::read(here.join("out/ltc.compact")).expect("a file");
    run(here, ["report", "out/ltc.compact", "--points", "8"]).exited(0);

    fs::write(here.join("short.compact"), &bytes[..bytes.len() - 9]).expect("a file");
    fs::write(here.join("long.compact"), [bytes.as_slice(), b"x"].concat()).expect("a file");
    for (words, code, said) in [
        (&["report", "short.compact"][..], 3, "short.compact: the bytes end too early"),
        (&["report", "long.compact"], 3, "long.compact: 1 bytes follow the end"),
        (&["export", &table, "--container", "compact", "--layout", "kt2022", "-o", "no"], 2, "the table's own layout"),
    ] {
        let refused = run(here, words).exited(code);
        assert!(refused.complaints()[0].contains(said), "{said} is not in {}", refused.stderr);
    }
    assert!(!here.join("no").exists());
}

/// The shader code itself contains a table of isotropic surfaces.
#[test]
fn a_shader_needs_no_texture_for_isotropic_tables() {
    let (folder, anisotropic) = folder_with_table();
    let here = folder.path();
    let recipe = r#"{"preset":"draft","resolution":{"alpha":32,"ratio":1,"theta":32,"phi":1},
                     "range":{"ratio":[1,1],"phi":[0,0]}}"#;
    let fitted = run_with_stdin(here, ["fit", "-", "-o", "."], recipe).exited(0);
    let digest: Digest = fitted.last_line().parse().expect("a digest");
    let table = format!("{}.safetensors", digest.hex());
    let words = ["shader", "--language", "glsl-es", "--without-textures"];
    let output = run(here, words.iter().chain(&[table.as_str(), "-o", "light.glsl", "--json"])).exited(0);
    let output: Value = serde_json::from_str(&output.stdout).expect("JSON");
    assert_eq!((&output["coefficients"], &output["table"]), (&Value::from(600), &Value::from(digest.to_string())));
    // A draft with few nodes. The error of a finer table is in docs/layouts.md.
    assert!(output["error"].as_f64().is_some_and(|error| error < 0.06), "{output}");
    let text = fs::read_to_string(here.join("light.glsl")).expect("a file");
    for said in [
        "table sha256:",
        "CC0-1.0",
        "mean error in widths of the lobe: polynomials 0.",
        "ltc_lookup(",
        "ltc_rectangle(",
    ] {
        assert!(text.contains(said), "{said} is not in {text}");
    }
    let cases: [(&str, &[&str], &str); 3] = [
        (&anisotropic, &[], "it must have only ratio 1"),
        (&table, &["--as", "example"], "needs --as include"),
        (&table, &["--model", "normals"], "need --model ltc"),
    ];
    for (table, more, said) in cases {
        let refused = run(here, words.iter().copied().chain([table]).chain(more.iter().copied())).exited(2);
        assert!(refused.complaints()[0].contains(said), "{said} is not in {}", refused.stderr);
    }
}

#[test]
fn failed_exports_print_one_line_and_write_no_file() {
    let (folder, table) = folder_with_table();
    let here = folder.path();
    fs::write(here.join("file"), "old").expect("a file");
    let kt2022 = "{\"layout\": \"kt2022\"}";
    let formats = ["--container", "ktx2"];
    let flat = [1.0, 2.0, 3.0, 2.0, 4.0, 6.0, 0.0, 0.0, 1.0_f32].map(f32::to_le_bytes).concat();
    let header = "{'descr': '<f4', 'fortran_order': False, 'shape': (2, 2, 2, 2, 3, 3), }\n";
    let length = u16::try_from(header.len()).expect("short").to_le_bytes();
    let npy = [b"\x93NUMPY\x01\x00", length.as_slice(), header.as_bytes(), &flat.repeat(16)].concat();
    fs::write(here.join("flat.npy"), npy).expect("a file");
    let cases: [(&[&str], i32, &str); 8] = [
        (&[&table, "-o", "out"], 2, "--container ktx2 needs --layout: "),
        (&["flat.npy", "--layout", "kt2022", "-o", "out"], 2, "16 entries have matrices without an inverse"),
        (&[&table, "--layout", "kt2022", "-o", "out"], 2, kt2022),
        (&[&table, "--layout", "cubic", "-o", "out"], 2, "«cubic»"),
        (&[&table, "--layout", "reflected", "-o", "file"], 1, "file: cannot write to this folder"),
        (&[&table, "--layout", "reflected", "-o", "file/below"], 1, "file/below: cannot write to this folder"),
        (&[&table, "--layout", "reflected", "-o", "/proc/none"], 1, "/proc/none: cannot write to this folder"),
        (&["./none", "--layout", "reflected", "-o", "out"], 1, "./none"),
    ];
    for (words, code, said) in cases {
        let refused = run(here, ["export"].iter().chain(words).chain(&formats)).exited(code);
        assert_eq!(refused.complaints().len(), 1, "{refused:#?}");
        assert!(refused.complaints()[0].contains(said), "{said} is not in {}", refused.stderr);
    }
    assert_eq!(fs::read(here.join("file")).expect("the file"), b"old");
    assert!(!here.join("out").exists());

    // There is a folder in place of a file.
    fs::create_dir_all(here.join("taken/ltc_matrix_b.ktx2")).expect("a folder in the way");
    let refused = run(here, ["export", &table, "--for", "wgpu", "-o", "taken"]).exited(1);
    assert!(refused.complaints()[0].starts_with("taken/ltc_matrix_b.ktx2: "), "{}", refused.stderr);
}

/// Exports a table of an engine's layout to all engines with this layout. Other engines reject it.
#[test]
fn engines_get_tables_of_their_layouts() {
    let folder = tempfile::tempdir().expect("a folder");
    let here = folder.path();
    for (layout, engines) in [
        (
            "ltc2017",
            &[
                ("three", "ltc.js"),
                ("babylon", "areaLights/areaLightsLTC.bin"),
                ("playcanvas", "area-light-luts.json"),
                ("bevy", "ltc.ktx2"),
            ][..],
        ),
        ("godot", &[("godot", "ltc_lut1.dds")]),
        ("ltc2016", &[("o3de", "ltc_mat_lutrgba32f.dds")]),
        ("hdrp", &[("hdrp", "LtcData.BRDF_GGX.cs")]),
    ] {
        let recipe =
            format!(r#"{{"preset": "draft", "layout": "{layout}", "fit": {{"samples": 64, "directions": 4}}}}"#);
        let fitted = run_with_stdin(here, ["fit", "-", "-o", "."], &recipe).exited(0);
        let table = fitted.last_line();
        for (engine, file) in engines {
            let printed = run(here, ["export", table, "--for", engine, "-o", engine, "--json"]).exited(0);
            let output = json_output(here, &printed.stdout);
            assert_eq!(output["layout"], layout);
            assert!(here.join(engine).join(file).exists(), "{engine}: no {file}");
        }
        run(here, ["export", table, "--for", "wgpu", "-o", "wgpu"]).exited(0);
        let other = if layout == "godot" { "three" } else { "godot" };
        let refused = run(here, ["export", table, "--for", other, "-o", "none"]).exited(2);
        assert!(refused.complaints()[0].contains(layout), "{}", refused.stderr);
        assert!(!here.join("none").exists());
    }
}

/// All files below a folder, with paths relative to it.
fn files_below(folder: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let mut found = BTreeMap::new();
    let mut folders = vec![folder.to_owned()];
    while let Some(next) = folders.pop() {
        for entry in fs::read_dir(next).expect("a folder") {
            let path = entry.expect("an entry").path();
            if path.is_dir() {
                folders.push(path);
            } else {
                let bytes = fs::read(&path).expect("a file");
                found.insert(path.strip_prefix(folder).expect("a path below").to_owned(), bytes);
            }
        }
    }
    found
}

/// The files that people copy are those of this version: see `make ready`.
#[test]
fn the_ready_made_files_are_current() {
    let ready = Path::new(env!("CARGO_MANIFEST_DIR")).join("ready");
    let folder = tempfile::tempdir().expect("a folder");
    let mut command = Command::new(ready.join("make.sh"));
    let made = command.arg(folder.path()).env("LTCFORGE", env!("CARGO_BIN_EXE_ltcforge")).output().expect("a shell");
    assert!(made.status.success(), "{}", String::from_utf8_lossy(&made.stderr));
    let (made, mut kept) = (files_below(folder.path()), files_below(&ready));
    assert!(kept.values().map(Vec::len).sum::<usize>() <= 645_000);
    for written in ["README.md", "make.sh"] {
        kept.remove(Path::new(written)).expect(written);
    }
    assert_eq!(made.keys().collect::<Vec<_>>(), kept.keys().collect::<Vec<_>>(), "run make ready");
    for (path, bytes) in &made {
        assert!(kept[path] == *bytes, "{}: run make ready", path.display());
    }
}
