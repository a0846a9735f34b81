//! Tests the page of `ltcforge serve` in a browser, used like people use it.
//!
//! `node` runs each script of this folder in Chromium, with its own service. `make test` installs the dependencies.
//! Without them, the tests report that they are skipped. `UPDATE_PICTURES=1 cargo test --test product page::looks --
//! --ignored` writes screenshots of every page to `target/page`, at three widths and in both themes.

use std::{env, fs, path::Path};

use serde_json::{Value, json};

use crate::common::browser;

/// The output of a script. The browser must not report anything: no errors of scripts or of the console, and no
/// violations of the Content-Security-Policy.
fn script(file: &str, args: &[&str]) -> Option<Value> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/page");
    let output: Value = browser::script(&folder, file, args)?;
    assert_eq!(output["complaints"], json!([]), "{output:#}");
    Some(output)
}

#[test]
fn jobs_are_submitted_watched_and_cancelled_and_failures_are_explained() {
    let Some(seen) = script("jobs.js", &[]) else { return };
    let document = json!({
        "preset": "draft", "resolution": { "alpha": 2, "ratio": 2, "theta": 2, "phi": 2 },
        "fit": { "samples": 64, "directions": 4, "steps": 5 },
    });
    assert_eq!((&seen["document"], &seen["reloaded"]), (&document, &document));
    assert!(seen["digest"].as_str().is_some_and(|digest| digest.starts_with("sha256:")), "{seen:#}");
    assert_eq!(seen["table"], seen["digest"]);
    assert_eq!(seen["exported"]["saved"], seen["exported"]["digest"]);
    assert_eq!(seen["cancelled"], "cancelled");
    let [listed, shown] = [0, 1].map(|i| seen["reasons"][i].as_str().unwrap_or_default());
    assert!(listed.contains("Not a directory"), "{seen:#}");
    assert_eq!(shown, format!("The storage failed: {listed}"));
}

#[test]
#[ignore = "make test-all runs it"]
fn faults_appear_next_to_their_fields() {
    let Some(seen) = script("faults.js", &[]) else { return };
    assert_eq!(seen["shown"], json!({ "samples": "3", "invalid": "true", "directions": "8" }), "{seen:#}");
    assert_eq!((&seen["isRefused"], &seen["left"], &seen["jobs"]), (&json!(true), &json!(""), &json!(0)), "{seen:#}");
    let roughnesses = &seen["roughnesses"];
    let list = json!([{ "alpha_x": 0.4, "alpha_y": 0.1 }, { "alpha": 0.09 }, { "alpha": 0.3, "ratio": 0.5 }]);
    assert_eq!((&roughnesses["isHidden"], &roughnesses["materials"]), (&json!(true), &list), "{seen:#}");
    assert_eq!(
        (&roughnesses["text"], &roughnesses["resolution"]),
        (&json!("0.4 / 0.1, 0.09, 0.3 × 0.5"), &json!(null))
    );
    let json = &seen["json"];
    assert_eq!((&json["fields"], &json["isTaken"]), (&json!(["nelder_mead", true]), &json!(true)), "{seen:#}");
    assert!(json["malformed"][0].as_str().is_some_and(|fault| fault.starts_with("This is not JSON: ")), "{seen:#}");
    assert_eq!(json["malformed"][1], true, "{seen:#}");
    assert!(roughnesses["item"].as_str().is_some_and(|fault| fault.contains("null is not a number")), "{seen:#}");
}

#[test]
#[ignore = "make test-all runs it"]
fn a_recipe_is_forecast_and_planned_for_a_scene() {
    let Some(seen) = script("planning.js", &[]) else { return };
    assert_eq!((&seen["others"], &seen["shown"]), (&json!([]), &json!("1, 0.04 × 4")), "{seen:#}");
    assert_eq!(seen["weighed"], json!([{ "f0": 1 }, { "f0": 0.04, "weight": 8 }, { "f0": 0.5 }]), "{seen:#}");
    assert!(seen["fault"].as_str().is_some_and(|fault| fault.contains("null is not a number")), "{seen:#}");
    // The ranges contain exactly the material's alpha. An isotropic scene has one ratio.
    let range = |of: &str, axis: &str| seen[of]["range"][axis].clone();
    assert_eq!(range("planned", "alpha"), json!([0.3, 0.3]), "{seen:#}");
    assert_eq!(range("round", "ratio"), json!([1, 1]), "{seen:#}");
    assert!(seen["refused"].as_str().is_some_and(|fault| fault.starts_with("broken.glb: ")), "{seen:#}");
}

#[test]
#[ignore = "make test-all runs it"]
fn a_token_is_requested_sent_with_every_request_and_never_stored() {
    let Some(seen) = script("token.js", &[]) else { return };
    assert_eq!((&seen["others"], &seen["saved"]), (&json!([]), &seen["digest"]), "{seen:#}");
    assert!(seen["name"].as_str().is_some_and(|name| name.ends_with(".safetensors")), "{seen:#}");
    assert_eq!((&seen["dialogs"], &seen["later"], &seen["kept"]), (&json!(1), &json!(0), &json!(0)), "{seen:#}");
    assert_eq!(seen["violations"], json!([]), "{seen:#}");
    assert!(seen["without"].as_str().is_some_and(|shown| shown.contains("token")), "{seen:#}");
}

#[test]
#[ignore = "make test-all runs it"]
fn tables_are_searched_sorted_labelled_compared_and_varied_and_their_maps_read() {
    let Some(seen) = script("tables.js", &[]) else { return };
    assert_eq!((&seen["isNewestFirst"], &seen["empty"]), (&json!(true), &json!(true)), "{seen:#}");
    let written = json!(["10 kB", "1.0 MB", "1.5 MB", "1 min 0 s", "2 min 0 s", "1 h 0 min", "1 d"]);
    assert_eq!(seen["written"], written, "{seen:#}");
    // Both tables have equally many entries, so no number of entries is the best.
    let marked = seen["marked"].as_array().expect("rows");
    assert!(marked.iter().all(|row| row == "Size" || row == "Entries"), "{seen:#}");
    assert!(seen["named"][1].as_str().is_some_and(|name| name.contains("alpha 0.2 to 0.5")), "{seen:#}");
    let labelled = seen["labelled"].as_array().expect("texts");
    assert_eq!((&labelled[0], &labelled[3]), (&json!("Blue plastic"), &json!("Blue plastic")), "{seen:#}");
    assert!(labelled.iter().all(|text| text.as_str().is_some_and(|text| text.starts_with("Blue plastic"))), "{seen:#}");
    let lookup = json!({
        "row": ["dfg · ggx · karis · 4 × 5 · f32", 0], "links": ["Fit a variation"], "hasMean": true,
        "file": "dfg.ktx2", "fields": 0,
    });
    assert_eq!(seen["lookup"], lookup);
    for column in ["Lobe error", "Light error", "Size"] {
        let [rising, falling] = [0, 1].map(|i| {
            let figures = seen["sorted"][column][i]["figures"].as_array().expect("figures");
            figures.iter().map(|figure| figure.as_f64().expect("a number")).collect::<Vec<_>>()
        });
        let orders = [0, 1].map(|i| &seen["sorted"][column][i]["order"]);
        assert_eq!(orders, ["ascending", "descending"], "{column}");
        assert!(rising.is_sorted() && falling.iter().rev().is_sorted() && rising[0] < rising[2], "{column}: {seen:#}");
    }
    let found = json!({
        "F16": [[2], "1 of 3"], "ggx f16": [[2], "1 of 3"], "digest": [[0], "1 of 3"], "f16 kt2022": [[], "0 of 3"],
        "": [[0, 1, 2], "3"],
    });
    assert_eq!(seen["found"], found);
    let winners = seen["winners"].as_array().expect("rows");
    assert_eq!(winners.len(), 4);
    for row in winners {
        assert_eq!(row[1], row[2], "{row}");
    }
    assert_eq!(seen["varied"], json!({ "isWhole": true, "precision": "f16", "samples": "64" }));
    for way in ["hovered", "keyed"] {
        let [shown, wanted] = [0, 1].map(|i| seen[way][i].as_str().unwrap_or_default());
        assert!(shown.starts_with("alpha ") && shown.ends_with(wanted), "{way}: {seen:#}");
    }
    assert_eq!((&seen["isBrightest"], &seen["isDarkest"]), (&json!(true), &json!(true)), "{seen:#}");
    assert!(seen["spread"].as_f64().is_some_and(|shades| shades > 100.0), "{seen:#}");
}

#[test]
#[ignore = "make test-all runs it"]
fn every_open_page_notices_a_stopped_service_and_survives_its_restart() {
    let Some(seen) = script("outage.js", &[]) else { return };
    assert_eq!(seen["others"], json!([]), "{seen:#}");
}

/// Largest difference of a byte between the viewer and previews. Graphics drivers round differently.
const OFF: f64 = 2.0;

/// Largest relative difference of the total light between the references of the viewer and of previews.
const REFERENCE_OFF: f64 = 0.01;

/// Largest size of the viewer's sources and shaders, compressed.
const VIEWER_BYTES: f64 = 120_000.0;

/// Largest relative difference of the mean error that the viewer shows from that of `ltcforge light --truth`.
const ERROR_OFF: f64 = 0.05;

/// Largest relative difference of the bytes of the shader ball, between `normals` and the reference.
const BALL_OFF: f64 = 0.01;

/// Largest mean difference of bytes between a table for engines and our table, for an isotropic surface.
const ENGINES_OFF: f64 = 1.5;

#[test]
#[ignore = "make test-all runs it"]
fn the_viewer_agrees_with_previews() {
    let Some(seen) = script("viewer.js", &[]) else { return };
    let number = |of: &str, name: &str| seen[of][name].as_f64().unwrap_or_else(|| panic!("{of} {name}: {seen:#}"));
    let scenes = seen["off"].as_object().expect("numbers by scene");
    assert_eq!(scenes.len(), 24, "{seen:#}");
    for scene in scenes.keys() {
        assert!(number("off", scene) <= OFF, "{scene}: {seen:#}");
        assert!(number("bright", scene) > 40.0, "{scene}: nothing is visible: {seen:#}");
    }
    for light in ["rectangle", "disk", "tube", "sheen"] {
        assert!(number("reference", light).abs() < REFERENCE_OFF, "{light}: {seen:#}");
    }
    for light in ["round", "sphere"] {
        assert!(number("engines", light) < ENGINES_OFF, "{light}: {seen:#}");
    }
    assert!(number("engines", "brushed") > 2.0 * number("engines", "round"), "{seen:#}");
    assert!(seen["same"].as_f64().is_some_and(|bytes| bytes <= 1.0), "a difference of zero must be grey: {seen:#}");
    assert_eq!(seen["beside"], "closed form: normals");
    let tables = seen["tables"].as_array().expect("a list");
    assert!(!tables.iter().any(|table| table == "table normals") && tables.len() > 3, "{tables:?}");
    assert_eq!(seen["isExplained"], true, "the comparison of two scattering models must be explained");
}

#[test]
#[ignore = "make test-all runs it"]
fn pictures_on_lights_agree_with_the_command() {
    let Some(seen) = script("pictured.js", &[]) else { return };
    let number = |of: &str, name: &str| seen[of][name].as_f64().unwrap_or_else(|| panic!("{of} {name}: {seen:#}"));
    for scene in ["normals", "sharp", "table", "second"] {
        assert!(number("off", scene) <= OFF, "{scene}: {seen:#}");
    }
    for scene in ["normals", "sharp", "table"] {
        assert!(number("bright", scene) > 100.0, "{scene}: nothing is visible: {seen:#}");
    }
    // All bytes are above 90, so rounding changes them by at most 1 %.
    for channel in 0..3 {
        let [least, most] = [0, 1].map(|i| seen["engines"][channel][i].as_f64().expect("a factor"));
        assert!(least > 0.2 && most < 0.8 && most / least < 1.05, "{seen:#}");
    }
    assert!(seen["reference"].as_f64().is_some_and(|apart| apart.abs() < REFERENCE_OFF), "{seen:#}");
    // The mean error below the picture, and the mean error of `--truth` over the picture.
    for model in ["normals", "ltc-formula", "table"] {
        let [told, wanted] = [0, 1].map(|i| seen["errors"][model][i].as_f64().expect("an error"));
        assert!(wanted > 1e-3 && (told / wanted - 1.0).abs() < ERROR_OFF, "{model}: {seen:#}");
    }
    assert!(number("opened", "off") <= 1.0, "{seen:#}");
    assert_eq!((&seen["opened"]["linked"], &seen["colours"]), (&json!(false), &json!(["blue", "red"])), "{seen:#}");
    assert_eq!(seen["refused"], "no.png: this browser cannot show the file; open another image or video");
    assert_eq!((&seen["moves"], &seen["stops"], &seen["kept"]), (&json!(true), &json!(true), &json!(true)), "{seen:#}");
    assert_eq!(seen["again"], "disc");
}

#[test]
#[ignore = "make test-all runs it"]
fn the_viewer_is_used_and_its_link_contains_the_scene() {
    let Some(seen) = script("viewing.js", &[]) else { return };
    assert_eq!((&seen["kept"], &seen["linked"]), (&json!(true), &json!(true)), "{seen:#}");
    // A wheel step of 200 pixels is a factor of exp(0.2). Two keys zoom in by 0.5 each.
    let gestures = &seen["gestures"];
    assert_eq!((&gestures["zoomed"], &gestures["scrolled"]), (&json!(10.99), &json!(0)), "{seen:#}");
    assert_eq!(gestures["keys"][0], json!(9.99), "{seen:#}");
    assert_eq!((&gestures["keys"][2], &gestures["border"]), (&json!(0.55), &json!(0.75)), "{seen:#}");
    assert_eq!(gestures["reset"], json!([9, 0, 0.2]), "{seen:#}");
    // Fingers twice as far apart halve the distance.
    assert!((gestures["pinched"].as_f64().unwrap_or_default() - 4.5).abs() < 0.2, "{seen:#}");
    let shadows = ["off", "4"].map(|way| seen["shadows"][way].as_f64().unwrap_or_default());
    assert!(shadows[0] > 0.05 && shadows[1] < 0.3 * shadows[0], "{seen:#}");
    // The tip of the handle follows the pointer, except for the curvature of its way.
    for (axis, wanted) in [-25.0, 25.0].into_iter().enumerate() {
        let moved = gestures["turned"][axis].as_f64().unwrap_or_default();
        assert!((moved - wanted).abs() < 8.0, "{seen:#}");
    }
    assert_eq!((&seen["outlines"], &seen["left"], &seen["restored"]), (&json!(2), &json!(1), &json!(0)), "{seen:#}");
    assert!(seen["refused"].as_str().is_some_and(|reason| reason.contains("oren_nayar")), "{seen:#}");
    assert!(seen["ofList"].as_str().is_some_and(|name| name.starts_with("Left: table")), "{seen:#}");
}

#[test]
#[ignore = "make test-all runs it"]
fn the_shader_ball_is_smooth_and_its_link_contains_it() {
    let Some(seen) = script("ball.js", &[]) else { return };
    let number = |name: &str| seen[name].as_f64().unwrap_or_else(|| panic!("{name}: {seen:#}"));
    // The ball fits into the unit sphere. Each normal is close to the flat normal, and perpendicular to the tangent.
    assert!(number("radius") <= 1.0 && number("radius") > 0.9, "{seen:#}");
    assert!(number("cosine") > 0.9 && number("skew") < 1e-6 && number("length") < 1e-6, "{seen:#}");
    assert_eq!((&seen["linked"], &seen["kept"]), (&json!(true), &json!("shader_ball")), "{seen:#}");
    let [ball, foot, beside, corner] = [0, 1, 2, 3].map(|i| seen["places"][i].as_f64().expect("a byte"));
    assert!(ball > 100.0 && foot > 50.0, "{seen:#}");
    assert!((beside - corner).abs() < 0.5, "{seen:#}");
    assert!((number("ratio") - 1.0).abs() < BALL_OFF, "{seen:#}");
}

#[test]
#[ignore = "make test-all runs it"]
fn a_dropped_gltf_file_is_shown_with_its_own_materials() {
    let Some(seen) = script("mesh.js", &[]) else { return };
    assert_eq!(seen["note"], "36,864 triangles, 1 material", "{seen:#}");
    assert!(seen["bright"].as_f64().is_some_and(|byte| byte > 100.0), "nothing is visible: {seen:#}");
    // Flat triangles differ from the sphere by 1e-4.
    for apart in ["apart", "from_cpu"] {
        assert!(seen[apart].as_f64().is_some_and(|bytes| bytes <= OFF), "{apart}: {seen:#}");
    }
    let parts = [
        ["accessors/0 has 99 elements", "primitives/1/attributes/POSITION is missing"],
        ["bad2.glb", "in another file, «sphere.bin»"],
        ["bad3.glb", "neither a GLB nor"],
        ["bad4.glb", "nodes/0 is nested 65 levels deep"],
        ["bad5.glb", "KHR_draco_mesh_compression"],
    ];
    for (i, wanted) in parts.iter().enumerate() {
        let fault = seen["faults"][i].as_str().unwrap_or_default();
        assert!(wanted.iter().all(|part| fault.contains(part)), "{fault}");
    }
}

#[test]
fn a_scene_dropped_on_any_page_is_lit_planned_and_packed_for_an_engine() {
    let Some(seen) = script("drop.js", &[]) else { return };
    assert!(seen["size"].as_f64().is_some_and(|bytes| bytes > 50_000.0 && bytes < VIEWER_BYTES), "{seen:#}");
    assert_eq!(
        (&seen["advised"], &seen["reloaded"]),
        (&json!("Left: closed form: normals, rule fast"), &json!("engines"))
    );
    assert!((0..2).all(|i| seen["errors"][i].as_f64().is_some_and(|error| error < 0.2)), "{seen:#}");
    assert_eq!(seen["light"], json!([0, 0, 3, 0.5, 0.25]), "{seen:#}");
    let digest = seen["digest"].as_str().unwrap_or_default();
    assert!(seen["sentence"].as_str().is_some_and(|text| text.contains("1 material")), "{seen:#}");
    let material = seen["material"].as_str().unwrap_or_default();
    assert!(material.starts_with("blue plastic\t0.5\t") && material.ends_with(" %"), "{seen:#}");
    assert!(seen["blue"][1].as_u64() > seen["blue"][0].as_u64().map(|red| red + 20), "{seen:#}");
    // The ball of the material is blue in both halves: by the table and by the truth.
    for half in 0..2 {
        let [red, blue] = [0, 2].map(|channel| seen["halves"][half][channel].as_u64().expect("a byte"));
        assert!(blue > red + 20, "{seen:#}");
    }
    assert_eq!((&seen["violations"], &seen["name"]), (&json!([]), &json!("ball-wgpu.zip")), "{seen:#}");
    let names: Vec<&str> = seen["names"].as_array().expect("names").iter().filter_map(Value::as_str).collect();
    assert!(["README.md", "ltc.json", "ltcforge.json"].iter().all(|name| names.contains(name)), "{seen:#}");
    assert!(names.iter().any(|name| name.starts_with("include/ltc-")), "{seen:#}");
    assert!(seen["readme"].as_str().is_some_and(|text| text.contains(digest)) && digest.len() > 64, "{seen:#}");
    assert_eq!(
        seen["keyed"],
        json!({ "table": "engines", "against": "ltc-formula", "split": "0.55", "saved": "keys-wgpu.zip" }),
        "{seen:#}"
    );
    assert!(seen["missing"].as_str().is_some_and(|text| text.contains("This link shows ball.glb")), "{seen:#}");
}

#[test]
#[ignore = "make test-all runs it"]
fn a_dropped_scene_is_packed_for_every_engine() {
    let Some(seen) = script("packed.js", &[]) else { return };
    for (engine, layout, file, language) in [
        ("three", "ltc2017", "ltc.js", "glsl"),
        ("babylon", "ltc2017", "areaLights/areaLightsLTC.bin", "glsl"),
        ("playcanvas", "ltc2017", "area-light-luts.json", "glsl"),
        ("bevy", "ltc2017", "ltc.ktx2", "wgsl"),
        ("godot", "godot", "ltc_lut1.dds", "glsl"),
        ("hdrp", "hdrp", "LtcData.BRDF_GGX.cs", "hlsl"),
        ("o3de", "ltc2016", "ltc_mat_lutrgba32f.dds", "hlsl"),
        ("wgpu", "reflected", "ltc_terms.ktx2", "wgsl"),
    ] {
        let archive = &seen["archives"][engine];
        let names: Vec<&str> = archive["names"].as_array().expect("names").iter().filter_map(Value::as_str).collect();
        let include = format!("include/normals-fine.{language}");
        assert!(names.contains(&file) && names.contains(&include.as_str()), "{engine}: {names:?}");
        assert_eq!(archive["layout"], layout, "{engine}");
        assert!(archive["readme"].as_str().is_some_and(|text| text.contains("planned for this scene")), "{engine}");
    }
}

#[test]
#[ignore = "make test-all runs it"]
fn textures_of_a_gltf_file_are_shown_or_reported_as_not_shown() {
    let Some(seen) = script("textures.js", &[]) else { return };
    let number = |name: &str| seen[name].as_f64().unwrap_or_else(|| panic!("{name}: {seen:#}"));
    // An image of one colour has the same effect as a factor, both as PNG and, up to rounding, as JPEG.
    assert!(number("bright") > 60.0 && number("constant") <= OFF && number("jpeg") <= 2.0 * OFF, "{seen:#}");
    // The red left half of the texture is on the right of the image.
    assert!(seen["halves"][0].as_f64() < Some(0.45) && seen["halves"][1].as_f64() > Some(0.52), "{seen:#}");
    // Normals that lean upwards move the highlight downwards, with and without tangents in the file.
    assert!(number("moved") > 4.0 && number("derived") <= OFF, "{seen:#}");
    let notes = seen["notes"].as_str().unwrap_or_default();
    for note in [
        "baseColorTexture is not shown: images/0 is neither PNG nor JPEG",
        "metallicRoughnessTexture is not shown: images/1 has 65536 x 1 pixels; the limit is 4096",
        "normalTexture is not shown: images/2 cannot be decoded",
        "only base colour, metallic-roughness and normal textures",
    ] {
        assert!(notes.contains(note), "{note}: {notes}");
    }
    let beside = seen["beside"].as_str().unwrap_or_default();
    for note in ["images/0 is not inside the file", "it uses TEXCOORD_1", "KHR_texture_transform is not supported"] {
        assert!(beside.contains(note), "{note}: {beside}");
    }
}

#[test]
#[ignore = "make test-all runs it"]
fn looks_right_in_both_themes_at_every_width_and_below_a_prefix() {
    let pictures = Path::new(env!("CARGO_MANIFEST_DIR")).join("target/page");
    let pictures = pictures.to_string_lossy();
    let args: &[&str] = if env::var_os("UPDATE_PICTURES").is_some() {
        fs::create_dir_all(&*pictures).expect("a folder");
        &["--pictures", &pictures]
    } else {
        &[]
    };
    let Some(seen) = script("looks.js", args) else { return };
    for faults in ["violations", "wide", "small", "moving"] {
        assert_eq!(seen[faults], json!([]), "{faults}");
    }
    assert_eq!(seen["looked"], 96, "twelve pages, four widths, two themes");
    assert_eq!(seen["behind"], json!({ "link": "/tools/ltc/v1/tables/s", "status": 200 }));
}
