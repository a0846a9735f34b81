//! The recipe that errors name: one whose table has the files that were asked for.

use crate::{
    files::digest::Digest,
    fit::{BrdfKind, Layout, LobeModel, Table},
};

/// The recipe of a layout, with the scattering model and the lobe of a table added where the layout takes them.
pub(super) fn recipe_like(recipe: &str, layout: Layout, table: &Table) -> String {
    let brdf = table.brdf.kind();
    let mut fields = String::new();
    if brdf != BrdfKind::ALL[0] && layout.takes(brdf) {
        fields += &format!("\"brdf\": \"{brdf}\", ");
        if let Some(file) = table.brdf.file() {
            fields += &format!("\"tabulated\": \"{}\", ", Digest::from_bytes(*file.digest()));
        }
    }
    if table.lobe != LobeModel::ALL[0] && layout.stores(table.lobe) {
        fields += &format!("\"lobe\": \"{}\", ", table.lobe);
    }
    recipe.replacen('{', &format!("{{{fields}"), 1)
}
