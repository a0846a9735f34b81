//! Tabulated BRDFs over HTTP: sent, named, kept.

use std::fs;

use crate::common::{
    command::run,
    server::{Server, text},
};

const OCTETS: (&str, &str) = ("content-type", "application/octet-stream");

/// The recipe of a file, small and with one row of views.
fn recipe(name: &str) -> String {
    format!(
        r#"{{"brdf": "tabulated", "tabulated": "{name}", "resolution": {{"alpha": 2, "theta": 3}},
            "fit": {{"samples": 64, "directions": 4, "steps": 5}}}}"#
    )
}

#[test]
fn a_file_that_was_sent_is_fitted_and_survives_a_kill() {
    let folder = tempfile::tempdir().expect("a folder");
    let (here, data) = (folder.path(), folder.path().join("data"));
    let made = run(here, ["tabulate", "oren_nayar", "--alpha", "0.2,1", "-o", "eon.safetensors"]).exited(0);
    let digest = made.last_line().to_owned();
    let bytes = fs::read(here.join("eon.safetensors")).expect("the file");
    let server = Server::start(&data, &[]);

    let early = server.submit(&recipe(&digest)).with_status(422).json();
    assert!(text(&early["errors"][0]["detail"]).contains("send its file to /v1/brdfs first"), "{early:#}");
    let path = server.submit(&recipe("eon.safetensors")).with_status(422).json();
    assert!(text(&path["errors"][0]["detail"]).contains("is not a digest: send the file to /v1/brdfs"), "{path:#}");

    let sent = server.request("POST", "/v1/brdfs", &[OCTETS], Some(&bytes)).with_status(201);
    assert_eq!(sent.header("location"), Some(format!("/v1/brdfs/{digest}").as_str()));
    let stored = sent.json();
    assert_eq!((text(&stored["digest"]), &stored["shape"]), (&*digest, &serde_json::json!([2, 36, 48, 32])));
    server.request("POST", "/v1/brdfs", &[OCTETS], Some(&bytes)).with_status(200);
    assert_eq!(server.get(&format!("/v1/brdfs/{digest}")).with_status(200).body, bytes);

    let table = server.fit(&recipe(&digest));
    let manifest = server.get(&format!("/v1/tables/{table}/manifest")).with_status(200).json();
    assert_eq!(text(&manifest["tabulated"]["file"]), digest);
    assert_eq!(text(&manifest["recipe"]["tabulated"]), digest);
    // A table is no BRDF, and a BRDF no table.
    server.get(&format!("/v1/brdfs/{table}")).with_status(404);
    let picture = format!("/v1/preview?table={table}&mode=strip&size=64&spp=16&alpha_x=0.5&alpha_y=0.5");
    server.get(&picture).with_status(200);
    server.kill();

    let server = Server::start(&data, &[]);
    assert_eq!(server.get(&format!("/v1/brdfs/{digest}")).with_status(200).body, bytes);
    // The command line sends the file that a recipe names by its path.
    fs::write(here.join("recipe.json"), recipe("eon.safetensors").replace("64", "65")).expect("a recipe");
    let watched = run(here, ["--server", &server.url, "jobs", "submit", "recipe.json", "--watch"]).exited(0);
    assert_ne!(watched.last_line(), table);
    server.get(&format!("/v1/tables/{}", watched.last_line())).with_status(200);
    let refused = run(here, ["tabulate", "oren_nayar", "-o", "other.safetensors"]).exited(0);
    fs::write(here.join("recipe.json"), recipe("other.safetensors").replace(r#""alpha": 2"#, r#""alpha": 2000"#))
        .expect("a recipe");
    let refused = (refused, run(here, ["--server", &server.url, "jobs", "submit", "recipe.json"]).exited(2));
    assert!(refused.1.stderr.contains("/resolution/alpha"), "{refused:#?}");
}

#[test]
fn a_bad_file_is_refused_with_all_its_faults() {
    let folder = tempfile::tempdir().expect("a folder");
    let server = Server::start(folder.path(), &[]);
    let refused = server.request("POST", "/v1/brdfs", &[OCTETS], Some(b"{}")).with_status(422).json();
    assert_eq!(text(&refused["type"]), "/problems/bad-brdf");
    let header = br#"{"phi":{"dtype":"F32","shape":[1],"data_offsets":[0,4]},"value":{"dtype":"I32","shape":[1],"data_offsets":[4,8]}}"#;
    let bytes = [&(header.len() as u64).to_le_bytes(), &header[..], &[0; 8]].concat();
    let refused = server.request("POST", "/v1/brdfs", &[OCTETS], Some(&bytes)).with_status(422).json();
    let told: Vec<&str> =
        refused["errors"].as_array().expect("faults").iter().map(|error| text(&error["detail"])).collect();
    for said in
        ["tensor «theta_o»: missing", "tensor «theta_i»: missing", "tensor «value»: type I32", "tensor «phi»: 1 nodes"]
    {
        assert!(told.iter().any(|told| told.starts_with(said)), "{said}: {told:?}");
    }
    server.request("POST", "/v1/brdfs", &[("content-type", "application/json")], Some(&bytes)).with_status(415);
    server.get(&format!("/v1/brdfs/{}", "0".repeat(64))).with_status(404);
}
