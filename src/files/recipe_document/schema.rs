//! The fields of a recipe for programs that show a form: their names, defaults and bounds.

use serde_json::{Map, Value, json};

use super::{
    Preset,
    axes::{DOMAIN, MOST_NODES},
    document::{DIRECTIONS, MOST_SEED, SAMPLES, STEPS},
};
use ltcforge_fit::{BrdfKind, Layout, LobeModel, Metric, Precision, SecondLobe, Shear, Solver, Start, StoredTerms};

/// The fields by their JSON pointers: `choices`, or `minimum` and `maximum`, and the `default`. Fields whose default depends
/// on others have none here. `presets` are the members of `/fit` that each preset stands for. Names of BRDFs that need a file
/// are in `tabulated`.
#[must_use]
pub fn schema() -> Value {
    let presets: Map<String, Value> =
        Preset::ALL.into_iter().map(|preset| (preset.name().to_owned(), json!(preset.fit()))).collect();
    let fit = Preset::Standard.fit();
    let mut fields = Map::new();
    let mut choice = |pointer: &str, choices: Value, default: Value| {
        fields.insert(pointer.to_owned(), json!({ "choices": choices, "default": default }));
    };
    choice("/preset", json!(Preset::ALL.map(Preset::name)), json!(Preset::Standard.name()));
    choice("/brdf", json!(BrdfKind::ALL), json!(BrdfKind::ALL[0]));
    let second = SecondLobe::ALL.map(SecondLobe::name);
    choice("/fresnel", json!(["one", second[0], second[1]]), json!("one"));
    choice("/lobe", json!(LobeModel::ALL), json!(LobeModel::ALL[0]));
    choice("/layout", json!(Layout::ALL), json!(Layout::ALL[0]));
    choice("/precision", json!(Precision::ALL), json!(Precision::ALL[0]));
    choice("/terms", json!([true, false, StoredTerms::F82_NAME]), json!(true));
    choice("/fit/metric", json!(Metric::ALL), json!(fit.metric));
    choice("/fit/solver", json!(Solver::ALL), json!(fit.solver));
    choice("/fit/shear", json!(Shear::ALL), json!(Shear::ALL[0]));
    choice("/fit/start", json!(Start::ALL), json!(Start::ALL[0]));
    let mut bounds = |pointer: String, [minimum, maximum]: [Value; 2], default: Option<Value>| {
        let mut field = json!({ "minimum": minimum, "maximum": maximum });
        if let Some(default) = default {
            field["default"] = default;
        }
        fields.insert(pointer, field);
    };
    for (axis, range) in DOMAIN.named() {
        bounds(format!("/resolution/{axis}"), [json!(1), json!(MOST_NODES)], None);
        bounds(format!("/range/{axis}"), range.map(|end| json!(end)), Some(json!(range)));
    }
    for (name, ends, default) in
        [("samples", SAMPLES, fit.samples), ("directions", DIRECTIONS, fit.directions), ("steps", STEPS, fit.steps)]
    {
        bounds(format!("/fit/{name}"), ends.map(|end| json!(end)), Some(json!(default)));
    }
    bounds("/fit/seed".to_owned(), [json!(0), json!(MOST_SEED)], Some(json!(fit.seed)));
    let tabulated: Vec<BrdfKind> = BrdfKind::ALL.iter().copied().filter(|kind| kind.needs_file()).collect();
    json!({ "fields": fields, "presets": presets, "tabulated": tabulated })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::recipe_document::{DEFAULT_ENTRY_LIMIT, canonical_json, parse};

    /// A recipe of `{}` with `value` at a pointer of one or two names.
    fn recipe(pointer: &str, value: &Value) -> Vec<u8> {
        let value = pointer
            .rsplit('/')
            .filter(|name| !name.is_empty())
            .fold(value.clone(), |value, name| json!({ name: value }));
        value.to_string().into_bytes()
    }

    #[test]
    fn defaults_change_nothing_and_bounds_are_the_ends() {
        let plain = canonical_json(&parse(b"{}", DEFAULT_ENTRY_LIMIT).expect("a recipe"));
        let schema = schema();
        let fields = schema["fields"].as_object().expect("fields");
        assert!(fields.len() > 20, "{fields:#?}");
        for (pointer, field) in fields {
            if let Some(default) = field.get("default").filter(|_| !["/fit/shear", "/fit/start"].contains(&&**pointer))
            {
                let given = parse(&recipe(pointer, default), DEFAULT_ENTRY_LIMIT).expect("a default");
                assert_eq!(canonical_json(&given), plain, "{pointer}");
            }
            // A single node is not enough for every axis; more than the bound is never allowed.
            for (end, step) in [("minimum", -1.0), ("maximum", 1.0)] {
                let Some(number) = field.get(end).and_then(Value::as_f64).filter(|_| !pointer.starts_with("/range"))
                else {
                    continue;
                };
                let beyond = json!((number + step) as i64);
                assert!(parse(&recipe(pointer, &beyond), u64::MAX).is_err(), "{pointer}: {beyond}");
                if pointer.starts_with("/fit") {
                    let number = json!(number as i64);
                    assert!(parse(&recipe(pointer, &number), u64::MAX).is_ok(), "{pointer}: {number}");
                }
            }
        }
    }
}
