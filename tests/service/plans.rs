//! Plans over HTTP.

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
    assert!(text(&made["summary"][0]).starts_with("2 materials, 0 anisotropic"), "{made:#}");
    let fitted = server.fit(&table["recipe"].to_string());
    let manifest = server.get(&format!("/v1/tables/{fitted}/manifest")).with_status(200).json();
    assert_eq!(manifest["recipe_digest"], table["recipe_digest"]);

    let three = LIST.replacen("}, {", r#"}, {"alpha_x": 0.11, "alpha_y": 0.11}, {"#, 1);
    let given = plan("?any_nodes=true", three.as_bytes()).with_status(200).json();
    assert_eq!(given["plan"]["tables"][0]["recipe"]["nodes"]["alpha"], json!([0.05, 0.11, 0.2]), "{given:#}");

    let unmet = plan("?bytes=1", LIST.as_bytes()).with_status(422).json();
    assert_eq!(text(&unmet["type"]), "/problems/budget-unmet");
    assert_eq!(unmet["recipe"]["resolution"], json!({ "alpha": 2, "ratio": 1, "theta": 2, "phi": 1 }));
    for query in ["?bytes=0", "?error=-1", "?seconds=NaN", "?error=1&bytes=9", "?widths=1"] {
        plan(query, LIST.as_bytes()).with_status(400);
    }
}

#[test]
fn scenes_with_faults_are_told_all_of_them() {
    let folder = tempfile::tempdir().expect("a folder");
    let server = Server::start(folder.path(), &[]);
    let send = |kind: &str, body: &[u8]| server.request("POST", "/v1/plans", &[("content-type", kind)], Some(body));
    let list = br#"{"materials": [{"alpha_x": 2, "alpha_y": -1}, {"alpha_x": 0.5}]}"#;
    let told = send("application/json", list).with_status(422).json();
    assert_eq!(text(&told["type"]), "/problems/bad-plan");
    let pointers: Vec<&str> = told["errors"].as_array().expect("a list").iter().map(|e| text(&e["pointer"])).collect();
    assert_eq!(pointers, ["/materials/0/alpha_x", "/materials/0/alpha_y", "/materials/1"]);
    let outside = br#"{"buffers": [{"byteLength": 1, "uri": "../../etc/passwd"}], "nodes": [{}]}"#;
    let told = send("model/gltf-binary", outside).with_status(422).json();
    assert_eq!(text(&told["errors"][0]["pointer"]), "/buffers/0/uri", "{told:#}");
    send("image/png", LIST.as_bytes()).with_status(415);
}
