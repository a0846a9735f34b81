//! Materials other than ideal metals, over HTTP: dielectrics with two lobes, fuzz, metals with F82, and pictures of
//! these materials.

use crate::common::server::{Server, text};

/// The recipe of a table with few entries, with additional fields.
fn tiny(fields: &str) -> String {
    format!(
        r#"{{"preset": "draft", "resolution": {{"alpha": 3, "ratio": 1, "theta": 3, "phi": 1}}, "range": {{"ratio": [1, 1], "phi": [0, 0]}},
            {fields}}}"#
    )
}

#[test]
fn tables_of_other_materials_are_fitted_measured_and_served() {
    let folder = tempfile::tempdir().expect("a folder");
    let server = Server::start(folder.path(), &[]);
    let fuzz = r#"{"brdf": "fuzz", "layout": "ltc2017", "preset": "draft", "resolution": {"alpha": 3, "theta": 3}}"#;
    let cases = [
        (tiny(r#""fresnel": "two_lobes""#), "matrix_2", Some(0.001)),
        (tiny(r#""fresnel": "blended_lobes""#), "matrix_2", Some(0.04)),
        (tiny(r#""fresnel": [{"f0": 0.04, "weight": 1}]"#), "matrix", None),
        (tiny(r#""terms": "f82""#), "edge", None),
        (fuzz.to_owned(), "matrix", None),
    ];
    for (recipe, tensor, f0) in cases {
        let digest = server.fit(&recipe);
        let manifest = server.get(&format!("/v1/tables/{digest}/manifest")).with_status(200).json();
        assert_eq!(manifest["report"]["second"]["f0"].as_f64(), f0, "{recipe}: {manifest:#}");
        let file = server.get(&format!("/v1/tables/{digest}")).with_status(200).body;
        let length = usize::try_from(u64::from_le_bytes(file[..8].try_into().expect("8 bytes"))).expect("a length");
        let header: serde_json::Value = serde_json::from_slice(&file[8..8 + length]).expect("a header");
        assert!(header[tensor].is_object(), "{recipe}: {header:#}");
    }
}

/// Every parameter changes the picture. Errors name the invalid parameter.
#[test]
fn previews_support_materials_cuts_and_compensation() {
    let folder = tempfile::tempdir().expect("a folder");
    let server = Server::start(folder.path(), &[]);
    let digest = server.fit(&tiny(r#""fresnel": "two_lobes""#));
    let picture = |query: &str| server.get(&format!("/v1/preview?table={digest}&scene=horizon&size=64&{query}"));
    let plain = picture("alpha_x=0.5&alpha_y=0.5").with_status(200).body;
    for change in [
        "alpha_x=0.5&alpha_y=0.5&cut=true",
        "alpha_x=0.5&alpha_y=0.5&compensate=true",
        "alpha_x=0.5&alpha_y=0.5&f0=0.04,0.04,0.04",
        "material=gltf:roughnessFactor=0.3,anisotropyStrength=0.5",
    ] {
        let changed = picture(change).with_status(200).body;
        assert!(changed != plain, "{change} changes nothing");
    }
    for wrong in ["material=gltf:shine=1", "material=chrome:roughness=1", "f0=1.5,0,0", "cut=perhaps"] {
        let refused = picture(wrong).with_status(422).json();
        let (name, _) = wrong.split_once('=').expect("a parameter");
        assert!(text(&refused["errors"][0]["parameter"]) == name, "{refused:#}");
    }
}
