//! The materials of a recipe document: a list of pairs of roughness.

use serde_json::Value;

use super::{
    axes::DOMAIN,
    reader::{Faults, Object, echo},
};
use ltcforge_fit::{BrdfKind, LEAST_THETAS, Layout, MOST_MATERIALS, Recipe};

/// Reads the list in field `materials` as pairs of alpha and ratio, for a layout with materials.
pub(super) fn read_materials(root: &Object, layout: Layout, brdf: BrdfKind, faults: &mut Faults) -> Vec<[f64; 2]> {
    let pointer = root.pointer("materials");
    let field = root.get("materials");
    if !layout.is_of_materials() {
        if field.is_some() {
            let other = Layout::Materials;
            let detail = format!("layout \"{layout}\" has no materials: choose \"{other}\", or leave this field out");
            faults.note(pointer, detail);
        }
        return Vec::new();
    }
    let form =
        format!("a list of 1 to {MOST_MATERIALS} objects, each with alpha and ratio, or with alpha_x and alpha_y");
    let Some(value) = field else {
        faults.note(pointer, format!("missing: layout \"{layout}\" needs its materials, {form}"));
        return Vec::new();
    };
    let Some(items) = value.as_array().filter(|items| (1..=MOST_MATERIALS).contains(&items.len())) else {
        let found = value.as_array().map_or(echo(value), |items| format!("a list of {}", items.len()));
        faults.note(pointer, format!("{found} is not {form}"));
        return Vec::new();
    };
    let mut pairs: Vec<[f64; 2]> = Vec::new();
    for (index, item) in items.iter().enumerate() {
        let pair = read_material(format!("{pointer}/{index}"), item, brdf, faults);
        if let Some(first) = pairs.iter().position(|known| Some(*known) == pair) {
            faults.note(format!("{pointer}/{index}"), format!("the same roughness as {pointer}/{first}"));
        }
        // A material with an error keeps its number, so that messages about other materials are right.
        pairs.push(pair.unwrap_or([f64::NAN; 2]));
    }
    if pairs.iter().flatten().any(|x| x.is_nan()) { Vec::new() } else { pairs }
}

/// Reads one material; `None` if it has an error.
fn read_material(pointer: String, item: &Value, brdf: BrdfKind, faults: &mut Faults) -> Option<[f64; 2]> {
    let before = faults.0.len();
    let object = Object::item(pointer.clone(), item, &["alpha", "ratio", "alpha_x", "alpha_y"], faults);
    let has = |fields: [&str; 2]| fields.map(|field| object.get(field).is_some());
    let mut one = |field: &str| object.number(field, DOMAIN.alpha, 1.0, faults);
    let pair = match (has(["alpha", "ratio"]), has(["alpha_x", "alpha_y"])) {
        ([true, _], [false, false]) => [one("alpha"), one("ratio")],
        ([false, false], [true, true]) => {
            let [x, y] = [one("alpha_x"), one("alpha_y")];
            if y > x {
                let detail = format!(
                    "{y} is more than alpha_x, {x}: the larger roughness must be along x; swap them, and rotate the material's \
                     tangent by 90 degrees"
                );
                faults.note(object.pointer("alpha_y"), detail);
            }
            // A mirror is isotropic.
            [x, if x > 0.0 { y / x } else { 1.0 }]
        }
        _ if item.is_object() => {
            faults.note(pointer, "give alpha, and ratio unless it is 1; or give alpha_x and alpha_y");
            return None;
        }
        _ => return None,
    };
    if brdf.is_isotropic() && pair[1] != 1.0 && faults.0.len() == before {
        let detail = format!("brdf \"{brdf}\" is isotropic: the ratio must be 1, not {}", pair[1]);
        faults.note(pointer, detail);
    }
    (faults.0.len() == before).then_some(pair)
}

/// Checks that there are at least two theta nodes. Textures store alpha next to the terms of the first theta node, and
/// the ratio next to the terms of the second.
pub(super) fn check_thetas(recipe: &Recipe, faults: &mut Faults) {
    let Recipe { layout, resolution, range, .. } = recipe;
    if layout.is_of_materials() && resolution.theta < LEAST_THETAS {
        let detail = format!(
            "[{}, {}] has {} node: layout \"{layout}\" needs at least {LEAST_THETAS}",
            range.theta[0], range.theta[1], resolution.theta
        );
        faults.note("/range/theta", detail);
    }
}

#[cfg(test)]
mod tests {
    use crate::recipe_document::{DEFAULT_ENTRY_LIMIT, RecipeError, canonical_json, parse};

    fn faults(document: &str) -> Vec<[String; 2]> {
        match parse(document.as_bytes(), DEFAULT_ENTRY_LIMIT) {
            Err(RecipeError::Faults(faults)) => faults.into_iter().map(|f| [f.pointer, f.detail]).collect(),
            other => panic!("{document}: {other:?}"),
        }
    }

    #[test]
    fn both_forms_of_a_material_are_one_recipe_that_reads_back() {
        let of_axes = r#"{"layout": "materials", "materials": [{"alpha": 0.5, "ratio": 0.25}, {"alpha": 0.25}]}"#;
        let of_alphas = r#"{"layout": "materials",
            "materials": [{"alpha_x": 0.5, "alpha_y": 0.125}, {"alpha_x": 0.25, "alpha_y": 0.25}]}"#;
        let [a, b] = [of_axes, of_alphas].map(|text| parse(text.as_bytes(), DEFAULT_ENTRY_LIMIT).expect("a recipe"));
        assert_eq!(a, b);
        assert_eq!(a.given().materials(), [[0.5, 0.25], [0.25, 1.0]]);
        assert_eq!((a.resolution().alpha, a.resolution().ratio, a.range().alpha), (2, 1, [0.25, 0.5]));
        assert_eq!(a.entries(), 2 * 9 * 7);
        let canonical = canonical_json(&a);
        assert!(
            canonical.contains(r#""materials":[{"alpha":0.5,"ratio":0.25},{"alpha":0.25,"ratio":1}]"#),
            "{canonical}"
        );
        assert!(!canonical.contains("nodes"), "{canonical}");
        assert_eq!(parse(canonical.as_bytes(), DEFAULT_ENTRY_LIMIT).expect("canonical"), a);
    }

    #[test]
    fn every_fault_of_the_list_is_reported_at_once() {
        let found = faults(
            r#"{"layout": "materials", "nodes": {"alpha": [0.1]}, "range": {"theta": [0.5, 0.5]}, "materials": [
                {"alpha": 1.5}, {"alpha": 0.5, "ratio": 0.5}, {"alpha_x": 0.1, "alpha_y": 0.2}, {"alpha_x": 0.5, "alpha_y": 0.25},
                {"ratio": 1}, 7, {"alpha": 0.1, "gloss": 1}]}"#,
        );
        let pointers: Vec<&str> = found.iter().map(|[pointer, _]| &**pointer).collect();
        let wanted = [
            "/nodes/alpha",
            "/materials/0/alpha",
            "/materials/2/alpha_y",
            "/materials/3",
            "/materials/4",
            "/materials/5",
            "/materials/6/gloss",
            "/range/theta",
        ];
        assert_eq!(pointers, wanted, "{found:?}");
        assert!(found[3][1].contains("/materials/1"), "{found:?}");
    }

    #[test]
    fn a_list_is_of_layout_materials_and_has_1_to_256() {
        let many = |n: usize| {
            let all: Vec<String> = (0..n).map(|i| format!("{{\"alpha\": {}}}", (i + 1) as f64 / 300.0)).collect();
            format!("{{\"layout\": \"materials\", \"materials\": [{}]}}", all.join(", "))
        };
        let detail = |document: &str| faults(document).remove(0)[1].clone();
        assert!(parse(many(256).as_bytes(), DEFAULT_ENTRY_LIMIT).is_ok());
        assert!(detail(&many(257)).starts_with("a list of 257 is not a list of 1 to 256 objects"));
        assert!(detail(&many(0)).starts_with("a list of 0 is not"));
        assert!(detail(r#"{"layout": "materials"}"#).starts_with("missing: layout \"materials\" needs"));
        assert!(detail(r#"{"materials": [{"alpha": 1}]}"#).contains("choose \"materials\", or leave"));
        let repeated = r#"{"layout": "materials", "materials": [{"alpha": 1}], "range": {"alpha": [0, 1]}}"#;
        assert!(detail(repeated).contains("the nodes in /materials range from 1 to 1"), "{}", detail(repeated));
    }
}
