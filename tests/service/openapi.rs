//! Checks that `openapi.yaml` agrees with the router and is consistent.

use std::collections::BTreeSet;

use crate::common::{
    openapi::{DOCUMENT, METHODS, faults, resolve},
    server::Server,
};
use serde_json::Value;

fn documented() -> BTreeSet<String> {
    let items = DOCUMENT["paths"].as_object().expect("paths");
    let calls = items.iter().flat_map(|(path, item)| {
        let methods = METHODS.into_iter().filter(|method| item.get(method).is_some());
        methods.map(move |method| format!("{} {path}", method.to_uppercase()))
    });
    calls.collect()
}

#[test]
fn router_and_file_name_the_same_calls() {
    let routed: BTreeSet<String> =
        ltcforge::server::http::ROUTES.iter().map(|route| format!("{} {}", route.method, route.path)).collect();
    assert_eq!(routed, documented());
}

#[test]
fn every_documented_call_is_answered_by_its_own_handler() {
    let folder = tempfile::tempdir().expect("a folder");
    let server = Server::start(folder.path(), &[]);
    for call in documented() {
        let (method, path) = call.split_once(' ').expect("a method and a path");
        // The values are well-formed, but nothing with these values exists.
        let path = path.replace("{id}", &"0".repeat(32)).replace("{digest}", &"0".repeat(64));
        let path = path.replace("/page/{folder}/{file}", "/page/pages/new.js").replace("{export}", "wgpu");
        let path = path.replace("{folder}", "a").replace("{file}", "icon.svg");
        let answer = server.request(method, &path, &[], (method == "POST").then_some(b"[]"));
        assert_ne!(answer.status, 405, "{call}");
        let problem: Value = serde_json::from_slice(&answer.body).unwrap_or_default();
        assert_ne!(problem["type"], "/problems/no-such-path", "{call}");
    }
    for path in ["/page", "/v1", "/v1/previews", "/v1/jobs/", "/healthz/x"] {
        assert_eq!(server.get(path).with_status(404).json()["type"], "/problems/no-such-path", "{path}");
    }
    let served = server.get("/openapi.yaml").with_status(200).body;
    assert_eq!(served, include_bytes!("../../openapi.yaml"));
}

#[test]
fn a_wrong_method_gets_the_allowed_methods() {
    let folder = tempfile::tempdir().expect("a folder");
    let server = Server::start(folder.path(), &[]);
    let cases = [
        ("PUT", "/v1/jobs", "POST, GET, HEAD"),
        ("DELETE", "/v1/tables", "GET, HEAD"),
        ("POST", "/healthz", "GET, HEAD"),
    ];
    for (method, path, allowed) in cases {
        let answer = server.request(method, path, &[], None).with_status(405);
        assert_eq!(answer.header("allow"), Some(allowed), "{method} {path}");
    }
}

/// Calls `visit` with every object in `value` and its key.
fn visit(key: &str, value: &'static Value, see: &mut dyn FnMut(&str, &'static Value)) {
    match value {
        Value::Object(members) => {
            see(key, value);
            for (key, member) in members {
                visit(key, member, see);
            }
        }
        Value::Array(items) => items.iter().for_each(|item| visit(key, item, see)),
        _ => {}
    }
}

#[test]
fn every_reference_resolves() {
    let mut references = 0;
    visit("", &DOCUMENT, &mut |_, object| {
        if object.get("$ref").is_some() {
            references += 1;
            assert!(resolve(object).is_object(), "{object}");
        }
    });
    assert!(references > 50, "{references} references were found");
}

#[test]
fn every_example_is_valid_under_its_schema() {
    let mut checked = 0;
    visit("", &DOCUMENT, &mut |_, object| {
        let Some(schema) = object.get("schema") else { return };
        let named = object.get("examples").and_then(Value::as_object).into_iter().flatten();
        let examples = object.get("example").into_iter().chain(named.map(|(_, example)| &example["value"]));
        for example in examples {
            checked += 1;
            assert_eq!(faults(schema, example), [""; 0], "{example:#}");
        }
    });
    assert!(checked > 15, "{checked} examples were found");
}

/// An example of a parameter counts too.
#[test]
fn every_call_has_a_short_summary_and_an_example() {
    for (path, item) in DOCUMENT["paths"].as_object().expect("paths") {
        for (method, call) in METHODS.into_iter().filter_map(|method| Some((method, item.get(method)?))) {
            let words = call["summary"].as_str().expect("a summary").split_whitespace().count();
            assert!((2..=10).contains(&words), "{method} {path}: {words} words");
            let mut examples = 0;
            let mut count = |_: &str, object: &'static Value| {
                examples += usize::from(resolve(object).get("example").is_some());
            };
            visit("", call, &mut count);
            visit("", &item["parameters"], &mut count);
            assert!(examples > 0, "{method} {path} has no example");
        }
    }
}

#[test]
fn a_broken_schema_would_be_noticed() {
    // The check itself rejects a response with a missing field, and a response with an additional field.
    let job = &DOCUMENT["paths"]["/v1/jobs"]["post"]["responses"]["202"]["content"]["application/json"];
    let mut lacking = job["example"].clone();
    lacking.as_object_mut().expect("a job").remove("attempts");
    assert_ne!(faults(&job["schema"], &lacking), [""; 0]);
    let mut more = job["example"].clone();
    more["colour"] = "red".into();
    assert_ne!(faults(&job["schema"], &more), [""; 0]);
    let mut early = job["example"].clone();
    early["table"] = early["recipe_digest"].clone();
    assert_ne!(faults(&job["schema"], &early), [""; 0], "a queued job has no table");
}
