//! Recipes that errors suggest. Their tables have the requested files.

use serde_json::json;

use ltcforge_files::digest::Digest;
use ltcforge_fit::{BrdfKind, Layout, LobeModel, Table};

/// The given recipe with the table's scattering model, materials and lobe, if the layout supports them. It keeps two
/// lobes per entry if the readers of the layout support them.
pub(super) fn recipe_like(recipe: &str, layout: Layout, takes_two_lobes: bool, table: &Table) -> String {
    let brdf = table.brdf.kind();
    let file = table.brdf.file().map(|file| Digest::from_bytes(*file.digest()).to_string());
    let takes_brdf = brdf != BrdfKind::ALL[0] && layout.takes(&table.brdf);
    let takes_lobe = table.lobe != LobeModel::ALL[0] && layout.stores(table.lobe);
    let fresnel = table.brdf.fresnel();
    let quoted = |value: String| format!("\"{value}\"");
    let fields = [
        ("brdf", takes_brdf.then(|| quoted(brdf.to_string()))),
        ("tabulated", file.filter(|_| takes_brdf).map(quoted)),
        (
            "fresnel",
            (!fresnel.is_one() && (takes_two_lobes || fresnel.second().is_none())).then(|| json!(fresnel).to_string()),
        ),
        ("lobe", takes_lobe.then(|| quoted(table.lobe.to_string()))),
    ];
    let fields = fields.into_iter().filter_map(|(name, value)| value.map(|value| format!("\"{name}\": {value}, ")));
    recipe.replacen('{', &format!("{{{}", fields.collect::<String>()), 1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use ltcforge_files::recipe_document::{DEFAULT_ENTRY_LIMIT, parse};
    use ltcforge_fit::{Plan, fit_plan};

    #[test]
    fn the_suggested_recipe_keeps_the_materials_of_the_table() {
        let small = r#""preset": "draft", "resolution": {"alpha": 2, "ratio": 2, "theta": 2, "phi": 2}"#;
        let fresnel = r#""fresnel": [{"f0": 0.04, "weight": 4}, {"f0": 1}]"#;
        let read = |document: &str| parse(document.as_bytes(), DEFAULT_ENTRY_LIMIT).expect("a recipe");
        let recipe = read(&format!("{{{small}, {fresnel}}}"));
        let table = fit_plan(&Plan::new(&recipe), &|_| std::ops::ControlFlow::Continue(())).expect("not stopped");
        let named = read(&recipe_like(r#"{"layout": "ltc2017"}"#, Layout::Ltc2017, false, &table));
        assert_eq!((named.layout(), named.model()), (Layout::Ltc2017, recipe.model()));
    }
}
