//! The fields of a document in JSON Schema, for forms: allowed names, and bounds that do not depend on other fields.

use serde_json::{Value, json};

use super::{
    axes::{DOMAIN, MOST_NODES},
    document::{DIRECTIONS, MOST_SEED, SAMPLES, STEPS},
    preset::Preset,
};
use ltcforge_fit::{BrdfKind, Layout, LobeModel, Metric, Precision, SecondLobe, Shear, Solver, Start, StoredTerms};

/// The schema of a recipe document: an object with `properties`, each with `enum`, or with `type` and its bounds.
#[must_use]
pub fn schema() -> Value {
    let integer = |low: u32, high: u64| json!({ "type": "integer", "minimum": low, "maximum": high });
    let bounded = |[low, high]: [u32; 2]| integer(low, high.into());
    let nodes = integer(1, MOST_NODES.into());
    let number = |[low, high]: [f64; 2]| json!({ "type": "number", "minimum": low, "maximum": high });
    let interval = |ends: [f64; 2]| json!({ "type": "array", "items": number(ends) });
    let mut fresnel = vec!["one"];
    fresnel.extend(SecondLobe::ALL.map(SecondLobe::name));
    json!({
        "type": "object",
        "properties": {
            "preset": { "enum": Preset::ALL.map(Preset::name) },
            "brdf": { "enum": BrdfKind::ALL },
            "fresnel": { "anyOf": [{ "enum": fresnel }, { "type": "array", "items": { "type": "object" } }] },
            "lobe": { "enum": LobeModel::ALL },
            "layout": { "enum": Layout::ALL },
            "materials": { "type": "array", "items": { "type": "object" } },
            "resolution": {
                "type": "object",
                "properties": { "alpha": nodes, "ratio": nodes, "theta": nodes, "phi": nodes },
            },
            "range": {
                "type": "object",
                "properties": {
                    "alpha": interval(DOMAIN.alpha), "ratio": interval(DOMAIN.ratio),
                    "theta": interval(DOMAIN.theta), "phi": interval(DOMAIN.phi),
                },
            },
            "fit": {
                "type": "object",
                "properties": {
                    "metric": { "enum": Metric::ALL },
                    "solver": { "enum": Solver::ALL },
                    "samples": bounded(SAMPLES),
                    "directions": bounded(DIRECTIONS),
                    "steps": bounded(STEPS),
                    "seed": integer(0, MOST_SEED),
                    "shear": { "enum": Shear::ALL },
                    "start": { "enum": Start::ALL },
                },
            },
            "terms": { "enum": [true, false, StoredTerms::F82_NAME] },
            "precision": { "enum": Precision::ALL },
        },
    })
}

#[cfg(test)]
mod tests {
    use super::super::{DEFAULT_ENTRY_LIMIT, RecipeError, parse};
    use super::*;

    /// The errors of a document with one member.
    fn faults(group: &str, field: &str, value: &Value) -> String {
        let own = json!({ field: value });
        let document = if group.is_empty() { own } else { json!({ group: own }) };
        match parse(document.to_string().as_bytes(), DEFAULT_ENTRY_LIMIT) {
            Ok(_) => String::new(),
            Err(RecipeError::Faults(faults)) => format!("{faults:?}"),
            Err(error) => panic!("{document}: {error}"),
        }
    }

    #[test]
    fn documents_take_every_name_and_bound_of_the_schema_and_no_other() {
        let schema = schema();
        let properties = &schema["properties"];
        let mut names = 0;
        for (group, fields) in [("", properties), ("fit", &properties["fit"]["properties"])] {
            for (field, of_field) in fields.as_object().expect("fields") {
                let choices = if field == "fresnel" { &of_field["anyOf"][0] } else { of_field };
                for name in choices["enum"].as_array().into_iter().flatten() {
                    let faults = faults(group, field, name);
                    assert!(!faults.contains("is not one of") && !faults.contains("is neither"), "{field}: {faults}");
                    names += 1;
                }
                if of_field["type"] == "integer" {
                    let [low, high] = ["minimum", "maximum"].map(|end| of_field[end].as_u64().expect("a number"));
                    for (value, is_taken) in [(low, true), (high, true), (high + 1, false)] {
                        let faults = faults(group, field, &json!(value));
                        assert_eq!(!faults.contains("is not a whole number"), is_taken, "{field} {value}: {faults}");
                    }
                }
            }
        }
        assert!(names > 30, "{names}");
        assert!(faults("", "layout", &json!("none")).contains("is not one of"));
    }
}
