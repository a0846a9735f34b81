//! Tests forecasts for recipes that are not submitted yet.

use serde_json::Value;

use crate::common::{
    SMALL,
    server::{Server, text},
};

#[test]
fn the_forecast_of_a_recipe_agrees_with_its_job() {
    let folder = tempfile::tempdir().expect("a folder");
    let server = Server::start(folder.path(), &[]);
    let foresee = |recipe: &str| {
        let fields = [("content-type", "application/json")];
        server.request("POST", "/v1/recipes", &fields, Some(recipe.as_bytes())).with_status(200).json()
    };
    let before = foresee(SMALL);
    assert_eq!((before["entries"].as_u64(), before["table"].is_null()), (Some(16), true), "{before:#}");
    assert_eq!(server.get("/v1/jobs").json()["items"], serde_json::json!([]), "a job was started");
    let job = server.submit(SMALL).with_status(202).json();
    for same in ["/recipe", "/recipe_digest", "/expected/error"] {
        assert!(
            before.pointer(same).is_some_and(|value| Some(value) == job.pointer(same)),
            "{same}: {before:#} {job:#}"
        );
    }
    // The predicted seconds may differ, because the worker may have measured its speed in the meantime.
    assert!(before["expected"]["seconds"].as_f64().is_some_and(|seconds| seconds > 0.0), "{before:#}");
    let done = server.finished(text(&job["id"]));
    // The forecast must equal the number of bytes of the matrix and term tensors in the file.
    let file = server.get(&format!("/v1/tables/{}", text(&done["table"]))).with_status(200).body;
    let (length, rest) = file.split_at(8);
    let length = u64::from_le_bytes(length.try_into().expect("eight bytes")) as usize;
    let header: Value = serde_json::from_slice(&rest[..length]).expect("JSON");
    let bytes_of = |name: &str| {
        let offsets = |i: usize| header[name]["data_offsets"][i].as_u64().expect("an offset");
        offsets(1) - offsets(0)
    };
    let bytes: u64 = ["matrix", "amplitude", "fresnel"].map(bytes_of).iter().sum();
    assert_eq!(before["expected"]["bytes"].as_u64(), Some(bytes), "{before:#}");
    assert_eq!(foresee(SMALL)["table"], done["table"]);
}

#[test]
fn the_forecast_of_an_invalid_recipe_has_the_faults_of_its_rejection() {
    let folder = tempfile::tempdir().expect("a folder");
    let server = Server::start(folder.path(), &["--job-seconds", "1"]);
    let cases = [
        (r#"{"colour": 1, "fit": {"samples": 3}}"#, "/problems/bad-recipe", false),
        (r#"{"preset": "best"}"#, "/problems/too-expensive", true),
    ];
    for (recipe, kind, is_complete) in cases {
        let foreseen = server.request("POST", "/v1/recipes", &[], Some(recipe.as_bytes())).with_status(200).json();
        let refused = server.submit(recipe).with_status(422).json();
        assert_eq!(foreseen["problem"], refused, "{recipe}");
        assert_eq!(refused["type"], kind, "{recipe}");
        assert_eq!(foreseen["recipe"].is_object(), is_complete, "{recipe}");
        assert_eq!(foreseen["expected"].is_object(), is_complete, "{recipe}");
    }
    server.request("POST", "/v1/recipes", &[], Some(b"{")).with_status(400);
}
