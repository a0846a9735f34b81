//! The recipe that errors name: one whose table has the files that were asked for.

use ltcforge_files::digest::Digest;
use ltcforge_fit::{BrdfKind, Layout, LobeModel, Table};

/// The recipe of a layout, with the scattering model and the lobe of a table added where the layout takes them.
pub(super) fn recipe_like(recipe: &str, layout: Layout, table: &Table) -> String {
    let brdf = table.brdf.kind();
    let file = table.brdf.file().map(|file| Digest::from_bytes(*file.digest()).to_string());
    let takes_brdf = brdf != BrdfKind::ALL[0] && layout.takes(brdf);
    let takes_lobe = table.lobe != LobeModel::ALL[0] && layout.stores(table.lobe);
    let fields = [
        ("brdf", takes_brdf.then(|| brdf.to_string())),
        ("tabulated", file.filter(|_| takes_brdf)),
        ("lobe", takes_lobe.then(|| table.lobe.to_string())),
    ];
    let fields = fields.into_iter().filter_map(|(name, value)| value.map(|value| format!("\"{name}\": \"{value}\", ")));
    recipe.replacen('{', &format!("{{{}", fields.collect::<String>()), 1)
}
