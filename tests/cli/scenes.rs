//! `plan` for glTF files, and for each engine.

use std::{collections::BTreeMap, fs, path::Path};
#[cfg(target_os = "linux")]
use std::{io::Read as _, process::Stdio, thread, time::Duration};

use ltcforge::textures::Engine;
use serde_json::{Value, json};

#[cfg(target_os = "linux")]
use crate::common::command::ltcforge;
use crate::common::command::run;

fn json_of(text: &[u8]) -> Value {
    serde_json::from_slice(text).expect("JSON")
}

/// A GLB from the tests' scenes, with a change to its document.
fn changed(name: &str, change: impl Fn(&mut Value)) -> Vec<u8> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/scenes").join(name);
    let glb = fs::read(path).expect("a scene");
    let length = u32::from_le_bytes(glb[12..16].try_into().expect("four bytes")) as usize;
    let mut document = json_of(&glb[20..20 + length]);
    change(&mut document);
    let mut text = document.to_string().into_bytes();
    text.resize(text.len().next_multiple_of(4), b' ');
    let word = |bytes: usize| (bytes as u32).to_le_bytes();
    let rest = &glb[20 + length..];
    [&glb[..8], &word(20 + text.len() + rest.len()), &word(text.len()), b"JSON", &text, rest].concat()
}

/// Textures, coats and the views of a camera, up to a measured table.
#[test]
fn a_glb_of_textures_coats_and_a_camera_is_fitted_and_measured() {
    let folder = tempfile::tempdir().expect("a folder");
    let here = folder.path();
    let glb = changed("ClearCoatTest.glb", |document| {
        document["cameras"] = json!([{ "type": "perspective", "perspective": { "yfov": 0.9, "znear": 0.1 } }]);
        let nodes = document["nodes"].as_array_mut().expect("nodes");
        nodes.push(json!({ "camera": 0, "translation": [0.0, 0.0, 18.0] }));
        let camera = nodes.len() - 1;
        document["scenes"][0]["nodes"].as_array_mut().expect("roots").push(json!(camera));
    });
    fs::write(here.join("scene.glb"), glb).expect("a file");
    let output = run(here, ["--json", "plan", "scene.glb", "--bytes", "3000", "--fit", "-o", "ltc"]).exited(0);
    let plan = &json_of(output.stdout.as_bytes())["plan"];
    assert_eq!(plan["scene"]["cameras"], 1);
    let materials = plan["scene"]["materials"].as_array().expect("materials");
    let lobes = materials.iter().flat_map(|of| of["lobes"].as_array().into_iter().flatten());
    let coats: Vec<&Value> = lobes.filter(|lobe| lobe["kind"] == "clearcoat").collect();
    assert!(coats.len() >= 5 && coats.iter().any(|coat| coat["values"].as_u64() > Some(1)), "{coats:?}");
    let table = &plan["tables"][0];
    let number = |of: &Value| of.as_f64().expect("a number");
    assert!(number(&table["measured"]["bytes"]) <= 3000.0, "{}", table["measured"]);
    assert!((0.85..1.15).contains(&number(&table["measured"]["off_by"])), "{}", table["measured"]);
    assert!(number(&table["measured"]["error"]) <= number(&table["whole"]["error"]), "{}", table["whole"]);
    let picture = fs::read_to_string(here.join("ltc/plan.svg")).expect("a picture");
    assert!(picture.contains("more nodes cannot remove this error") && picture.contains("default table"));
}

/// The layout of a planned recipe is one that the engine supports, and its table can be exported to the engine.
#[test]
fn a_plan_for_each_engine_can_be_exported_to_it() {
    let folder = tempfile::tempdir().expect("a folder");
    let here = folder.path();
    fs::write(here.join("scene.json"), r#"{"materials": [{"alpha_x": 0.2, "alpha_y": 0.2}]}"#).expect("a list");
    let mut tables = BTreeMap::new();
    for engine in Engine::ALL {
        let name = engine.name();
        let table = tables.entry(engine.layout()).or_insert_with(|| {
            run(here, ["plan", "scene.json", "--for", name, "-o", name]).exited(0);
            let mut recipe = json_of(&fs::read(here.join(name).join("recipe.json")).expect("a recipe"));
            let picture = fs::read_to_string(here.join(name).join("plan.svg")).expect("a picture");
            assert!(picture.contains("more nodes cannot remove this error"), "{name}");
            // The least effort gives a table of the same form.
            recipe["fit"]["samples"] = json!(32);
            recipe["fit"]["directions"] = json!(4);
            fs::write(here.join("recipe.json"), recipe.to_string()).expect("a file");
            let fitted = run(here, ["fit", "recipe.json", "-o", "."]).exited(0);
            format!("{}.safetensors", fitted.last_line().trim_start_matches("sha256:"))
        });
        let report = run(here, ["--json", "export", table, "--for", name, "-o", name]).exited(0).stdout;
        let report = json_of(report.as_bytes());
        assert!(report["files"].as_array().is_some_and(|files| files.len() > 1), "{name}: {report}");
    }
}

/// The peak memory of a run in megabytes, as the system reports it during the run.
#[cfg(target_os = "linux")]
fn most_memory(here: &Path, args: &[&str]) -> u64 {
    let mut child = ltcforge(here, args).stdout(Stdio::piped()).spawn().expect("the binary runs");
    let status = format!("/proc/{}/status", child.id());
    let mut most = 0;
    loop {
        let output = fs::read_to_string(&status).unwrap_or_default();
        let line = output.lines().find_map(|line| line.strip_prefix("VmHWM:"));
        let kilobytes = line.and_then(|line| line.split_whitespace().next()?.parse::<u64>().ok());
        most = most.max(kilobytes.unwrap_or(0));
        if let Some(status) = child.try_wait().expect("a child") {
            let mut out = String::new();
            child.stdout.take().expect("stdout").read_to_string(&mut out).expect("text");
            assert!(status.success() && most > 0, "{status} {out}");
            return most / 1000;
        }
        thread::sleep(Duration::from_millis(5));
    }
}

/// A PNG of 1024 x 1024 texels. Its left quarter has one roughness, and the rest has another.
#[cfg(target_os = "linux")]
fn quarters(left: u8, right: u8) -> Vec<u8> {
    let row = [[0, left, 0].repeat(256), [0, right, 0].repeat(768)].concat();
    let mut out = Vec::new();
    let mut encoder = png::Encoder::new(&mut out, 1024, 1024);
    encoder.set_color(png::ColorType::Rgb);
    let mut writer = encoder.write_header().expect("a header");
    writer.write_image_data(&row.repeat(1024)).expect("texels");
    writer.finish().expect("an image");
    out
}

/// A GLB with a million triangles: 50 squares with 20,000 triangles and a texture each. The sides of square i are 1 + i
/// / 50.
#[cfg(target_os = "linux")]
fn million() -> Vec<u8> {
    let side = 101_u32;
    let corners: Vec<f32> = (0..side * side).flat_map(|i| [i % side, i / side].map(|k| k as f32 / 100.0)).collect();
    let positions: Vec<u8> = corners.chunks(2).flat_map(|at| [at[0], at[1], 0.0]).flat_map(f32::to_le_bytes).collect();
    let uv: Vec<u8> = corners.iter().flat_map(|x| x.to_le_bytes()).collect();
    let square = |i: u32| {
        let at = i / 100 * side + i % 100;
        [at, at + 1, at + side + 1, at, at + side + 1, at + side]
    };
    let order: Vec<u8> = (0..10_000).flat_map(square).flat_map(u32::to_le_bytes).collect();
    let images = (0..50).map(|i| quarters(20 + i, 120 + 2 * i));
    let (mut binary, mut views) = (Vec::new(), Vec::new());
    for bytes in [positions, uv, order].into_iter().chain(images) {
        views.push(json!({ "buffer": 0, "byteOffset": binary.len(), "byteLength": bytes.len() }));
        binary.extend(bytes);
        binary.resize(binary.len().next_multiple_of(4), 0);
    }
    let each = |of: fn(usize) -> Value| (0..50).map(of).collect::<Value>();
    let corners = side * side;
    let document = json!({
        "asset": { "version": "2.0" }, "buffers": [{ "byteLength": binary.len() }], "bufferViews": views,
        "accessors": [
            { "bufferView": 0, "componentType": 5126, "count": corners, "type": "VEC3" },
            { "bufferView": 1, "componentType": 5126, "count": corners, "type": "VEC2" },
            { "bufferView": 2, "componentType": 5125, "count": 60_000, "type": "SCALAR" },
        ],
        "images": each(|i| json!({ "bufferView": 3 + i })), "textures": each(|i| json!({ "source": i })),
        "materials": each(|i| json!({ "pbrMetallicRoughness": { "metallicRoughnessTexture": { "index": i } } })),
        "meshes": each(|i| {
            let attributes = json!({ "POSITION": 0, "TEXCOORD_0": 1 });
            json!({ "primitives": [{ "attributes": attributes, "indices": 2, "material": i }] })
        }),
        "nodes": each(|i| json!({ "mesh": i, "scale": [1.0 + i as f64 / 50.0, 1.0 + i as f64 / 50.0, 1.0] })),
    });
    let mut text = document.to_string().into_bytes();
    text.resize(text.len().next_multiple_of(4), b' ');
    let word = |bytes: usize| (bytes as u32).to_le_bytes();
    let head = [b"glTF".as_slice(), &word(2), &word(28 + text.len() + binary.len())].concat();
    [&head, word(text.len()).as_slice(), b"JSON", &text, &word(binary.len()), b"BIN\0", &binary].concat()
}

#[cfg(target_os = "linux")]
#[test]
fn a_million_triangles_and_fifty_textures_are_planned_within_500_megabytes() {
    let folder = tempfile::tempdir().expect("a folder");
    let here = folder.path();
    fs::write(here.join("scene.glb"), million()).expect("a file");
    let most = most_memory(here, &["plan", "scene.glb", "--threads", "2", "--bytes", "20000", "-o", "ltc"]);
    println!("{most} MB");
    assert!(most <= 500, "{most} MB");
    let scene = &json_of(&fs::read(here.join("ltc/plan.json")).expect("a plan"))["scene"];
    assert_eq!(scene["triangles"], 1_000_000);
    for (i, material) in scene["materials"].as_array().expect("materials").iter().enumerate() {
        let side = 1.0 + i as f64 / 50.0;
        let level = |of: usize| (of as f64 / 255.0) * (of as f64 / 255.0);
        for (alpha, part) in [(level(20 + i), 0.25), (level(120 + 2 * i), 0.75)] {
            let spots = material["lobes"][0]["spots"].as_array().expect("spots");
            let near = |spot: &&Value| spot["alpha"].as_f64().is_some_and(|of| (of - alpha).abs() < 1e-6);
            let weight = spots.iter().filter(near).filter_map(|spot| spot["weight"].as_f64()).sum::<f64>();
            let wanted = part * side * side;
            assert!((weight / wanted - 1.0).abs() < 0.01, "{i}: {weight} of {wanted}");
        }
    }
}
