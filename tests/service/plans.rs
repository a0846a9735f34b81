//! Tests plans over HTTP.

use std::{thread, time::Duration};

use serde_json::json;

use crate::common::server::{Server, text};

const LIST: &str =
    r#"{"materials": [{"name": "steel", "alpha_x": 0.2, "alpha_y": 0.2}, {"alpha_x": 0.05, "alpha_y": 0.05}]}"#;

#[test]
fn a_list_of_materials_gives_a_recipe_that_can_be_submitted() {
    let folder = tempfile::tempdir().expect("a folder");
    let server = Server::start(folder.path(), &[]);
    let plan = |query: &str, body: &[u8]| {
        server.request("POST", &format!("/v1/plans{query}"), &[("content-type", "application/json")], Some(body))
    };
    let made = plan("?bytes=2000", LIST.as_bytes()).with_status(200).json();
    let table = &made["plan"]["tables"][0];
    assert!(table["predicted"]["bytes"].as_u64().is_some_and(|bytes| bytes <= 2000), "{made:#}");
    assert_eq!(table["recipe"]["range"]["alpha"], json!([0.05, 0.2]));
    assert_eq!(made, plan("?bytes=2000", LIST.as_bytes()).with_status(200).json());
    assert!(text(&made["summary"][0]).starts_with("2 materials, seen from all directions. "), "{made:#}");
    let fitted = server.fit(&table["recipe"].to_string());
    let manifest = server.get(&format!("/v1/tables/{fitted}/manifest")).with_status(200).json();
    assert_eq!(manifest["recipe_digest"], table["recipe_digest"]);

    let three = LIST.replacen("}, {", r#"}, {"alpha_x": 0.11, "alpha_y": 0.11}, {"#, 1);
    let given = plan("?any_nodes=true", three.as_bytes()).with_status(200).json();
    assert_eq!(given["plan"]["tables"][0]["recipe"]["nodes"]["alpha"], json!([0.05, 0.11, 0.2]), "{given:#}");

    let unmet = plan("?bytes=1", LIST.as_bytes()).with_status(422).json();
    assert_eq!(text(&unmet["type"]), "/problems/budget-unmet");
    assert_eq!(unmet["recipe"]["resolution"], json!({ "alpha": 2, "ratio": 1, "theta": 2, "phi": 1 }));
    for query in ["?bytes=0", "?error=-1", "?seconds=NaN", "?error=1&bytes=9", "?widths=1", "?registers=x"] {
        plan(query, LIST.as_bytes()).with_status(400);
    }
}

#[test]
fn all_faults_of_a_scene_are_reported() {
    let folder = tempfile::tempdir().expect("a folder");
    let server = Server::start(folder.path(), &[]);
    let send = |kind: &str, body: &[u8]| server.request("POST", "/v1/plans", &[("content-type", kind)], Some(body));
    let list = br#"{"materials": [{"alpha_x": 2, "alpha_y": -1}, {"alpha_x": 0.5}]}"#;
    let reply = send("application/json", list).with_status(422).json();
    assert_eq!(text(&reply["type"]), "/problems/bad-plan");
    let pointers: Vec<&str> = reply["errors"].as_array().expect("a list").iter().map(|e| text(&e["pointer"])).collect();
    assert_eq!(pointers, ["/materials/0/alpha_x", "/materials/0/alpha_y", "/materials/1"]);
    let bare = send("application/json", br#" [{"alpha_x": 0.3, "alpha_y": 0.2}]"#).with_status(422).json();
    assert!(text(&bare["errors"][0]["detail"]).starts_with("a bare list; the document must be {"), "{bare:#}");
    let outside = br#"{"buffers": [{"byteLength": 1, "uri": "../../etc/passwd"}], "nodes": [{}]}"#;
    let reply = send("model/gltf-binary", outside).with_status(422).json();
    assert_eq!(text(&reply["errors"][0]["pointer"]), "/buffers/0/uri", "{reply:#}");
    let other = send("image/png", LIST.as_bytes()).with_status(415).json();
    assert!(text(&other["detail"]).contains("send model/gltf-binary, application/json"), "{other:#}");
}

/// A GLB with one triangle of rough plastic.
fn triangle() -> Vec<u8> {
    let corners: [f32; 9] = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0];
    let binary: Vec<u8> = corners.iter().flat_map(|x| x.to_le_bytes()).collect();
    let document = json!({
        "asset": { "version": "2.0" }, "nodes": [{ "mesh": 0 }],
        "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0 }, "material": 0 }] }],
        "materials": [{ "name": "rubber", "pbrMetallicRoughness": { "roughnessFactor": 0.8, "metallicFactor": 0 } }],
        "accessors": [{ "bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3" }],
        "bufferViews": [{ "buffer": 0, "byteLength": binary.len() }], "buffers": [{ "byteLength": binary.len() }],
    });
    let mut text = document.to_string().into_bytes();
    text.resize(text.len().next_multiple_of(4), b' ');
    let length = |bytes: &[u8]| (bytes.len() as u32).to_le_bytes();
    let chunks = [&length(&text)[..], b"JSON", &text, &length(&binary), b"BIN\0", &binary].concat();
    [b"glTF\x02\0\0\0", &(12 + chunks.len() as u32).to_le_bytes()[..], &chunks].concat()
}

#[test]
fn a_scene_in_one_file_is_planned_for() {
    let folder = tempfile::tempdir().expect("a folder");
    let server = Server::start(folder.path(), &[]);
    let send = |query: &str| {
        let field = [("content-type", "model/gltf-binary")];
        server.request("POST", &format!("/v1/plans{query}"), &field, Some(&triangle())).with_status(200).json()
    };
    let made = send("?bytes=500");
    assert_eq!(made["plan"]["scene"]["triangles"], json!(1));
    assert_eq!(made["plan"]["scene"]["materials"][0]["name"], json!("rubber"));
    let recipe = &made["plan"]["tables"][0]["recipe"];
    assert_eq!(recipe["fresnel"], json!([{ "f0": 0.04, "weight": 1 }]));
    server.fit(&recipe.to_string());
    let bare = send("?bytes=500&no_terms=true&registers=64");
    assert_eq!(bare["plan"]["tables"][0]["recipe"]["terms"], json!(false));
    assert_eq!(bare["plan"]["tables"][0]["rule"], json!("fast"));
    let engine = send("?engine=three");
    assert_eq!(engine["plan"]["tables"][0]["recipe"]["layout"], json!("ltc2017"));
    let field = [("content-type", "model/gltf-binary")];
    let other = server.request("POST", "/v1/plans?engine=cry", &field, Some(&triangle())).with_status(400).json();
    assert!(text(&other["detail"]).starts_with("engine=cry: must be one of three, "), "{other:#}");
}

#[test]
fn scenes_that_are_too_long_or_too_many_are_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    let server = Server::start(folder.path(), &["--client-seconds", "1"]);
    let send = |body: &[u8]| server.request("POST", "/v1/plans", &[("content-type", "application/json")], Some(body));
    let long = send(&vec![b' '; (1 << 20) + 1]).with_status(413).json();
    assert_eq!(text(&long["type"]), "/problems/body-too-large");
    // Two plans run at the same time. Each takes longer than the third request waits.
    let seven = include_bytes!("../../docs/plan/seven.json");
    thread::scope(|scope| {
        let first = [(); 2].map(|()| scope.spawn(|| send(seven)));
        thread::sleep(Duration::from_millis(200));
        let reply = send(LIST.as_bytes()).with_status(503).json();
        assert!(text(&reply["detail"]).contains("2 files are being received already"), "{reply:#}");
        for answer in first {
            answer.join().expect("an answer").with_status(200);
        }
    });
}
