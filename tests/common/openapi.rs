//! Checks of responses against `openapi.yaml`.

use std::sync::LazyLock;

use serde_json::{Value, json};

use super::server::Answer;

/// The document.
pub(crate) static DOCUMENT: LazyLock<Value> =
    LazyLock::new(|| serde_saphyr::from_str(include_str!("../../openapi.yaml")).expect("openapi.yaml is YAML"));

/// The methods that can be in a path item.
pub(crate) const METHODS: [&str; 7] = ["get", "head", "post", "put", "patch", "delete", "options"];

/// The schema `value`, or the schema that it refers to.
pub(crate) fn resolve(value: &'static Value) -> &'static Value {
    match value["$ref"].as_str() {
        Some(reference) => {
            let pointer = reference.strip_prefix('#').expect("a reference into the file");
            DOCUMENT.pointer(pointer).unwrap_or_else(|| panic!("{reference} leads nowhere"))
        }
        None => value,
    }
}

/// The validation errors of `instance` under `schema`, a schema of the document.
pub(crate) fn faults(schema: &Value, instance: &Value) -> Vec<String> {
    let whole = json!({
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "allOf": [schema],
        "components": DOCUMENT["components"],
    });
    let validator = jsonschema::options().should_validate_formats(true).build(&whole).expect("a valid schema");
    validator.iter_errors(instance).map(|error| format!("{}: {error}", error.instance_path())).collect()
}

/// Checks status, content type, header fields and body of a response against the document.
#[track_caller]
pub(crate) fn check(method: &str, path: &str, answer: &Answer) {
    let call = format!("{method} {path} -> {}", answer.status);
    let path = path.split('?').next().unwrap_or_default();
    let item = DOCUMENT["paths"].as_object().expect("paths").iter().find(|(template, _)| matches(template, path));
    let operation = item.map(|(_, item)| match (method, &item["head"]) {
        // HEAD has the responses of GET unless it has its own entry.
        ("HEAD", Value::Null) => &item["get"],
        _ => &item[method.to_lowercase()],
    });
    let response = if let Some(operation) = operation.filter(|operation| !operation.is_null()) {
        match &operation["responses"][answer.status.to_string()] {
            // Responses that every call can have.
            Value::Null => resolve(&DOCUMENT["x-any-path"][answer.status.to_string()]),
            own => resolve(own),
        }
    } else {
        // Calls that are not in the document get a problem response, as its introduction states.
        let expected = if item.is_none() { 404 } else { 405 };
        assert_eq!(answer.status, expected, "{call}: not in the file");
        resolve(&DOCUMENT["components"]["responses"]["NotFound"])
    };
    assert!(response.is_object(), "{call}: this status is not in the file");
    check_fields(&call, response, answer);
    if method != "HEAD" {
        check_body(&call, response, answer);
    }
}

fn check_fields(call: &str, response: &'static Value, answer: &Answer) {
    for (name, field) in response["headers"].as_object().into_iter().flatten() {
        let field = resolve(field);
        match answer.header(&name.to_lowercase()) {
            None => assert_ne!(field["required"], true, "{call}: no {name}"),
            Some(value) => {
                let instance = match field["schema"]["type"].as_str() {
                    Some("integer") => json!(value.parse::<i64>().ok()),
                    _ => json!(value),
                };
                assert_eq!(faults(&field["schema"], &instance), [""; 0], "{call}: {name}: {value}");
            }
        }
    }
}

fn check_body(call: &str, response: &Value, answer: &Answer) {
    let Some(content) = response["content"].as_object() else {
        assert!(answer.body.is_empty(), "{call}: a body that is not in the file");
        return;
    };
    let media_type = answer.header("content-type").unwrap_or_default().split(';').next().unwrap_or_default();
    let media = content.get(media_type).unwrap_or_else(|| panic!("{call}: {media_type} is not in the file"));
    if media_type.ends_with("json") {
        let body = answer.json();
        assert_eq!(faults(&media["schema"], &body), [""; 0], "{call}: {body:#}");
    }
}

/// Whether `path` is an instance of `template`.
fn matches(template: &str, path: &str) -> bool {
    let (mut template, mut path) = (template.split('/'), path.split('/'));
    loop {
        match (template.next(), path.next()) {
            (None, None) => return true,
            (Some(pattern), Some(segment)) if pattern == segment || pattern.starts_with('{') => {}
            _ => return false,
        }
    }
}
