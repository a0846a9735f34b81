//! The paper's table 1, for our layouts: the contents and sizes of tables. This needs no fits.

use std::fmt::Write as _;

use super::error::FigureError;
use ltcforge::{
    files::recipe_document::{DEFAULT_ENTRY_LIMIT, parse},
    fit::{Layout, Plan, Table, Terms},
    textures::{Texture, TextureLayout},
};

/// Layouts in the form that their readers load: 2D textures for engines, and other textures for our shader.
const LAYOUTS: [TextureLayout; 6] = [
    TextureLayout::Reflected,
    TextureLayout::Kt2022,
    TextureLayout::Ltc2017,
    TextureLayout::Ltc2016,
    TextureLayout::Godot,
    TextureLayout::Hdrp,
];
/// Channels without numbers of a lobe: empty channels, and numbers of the light.
const NOT_OF_LOBES: [&str; 3] = ["unused", "zero", "sphere"];

/// A text table with a line for each layout, at its default resolution.
pub(super) fn table() -> Result<String, FigureError> {
    let mut text = String::from(
        "| layout | stored | axes | nodes | textures | numbers a lobe | bytes, 32 bits | bytes, 16 bits |\n\
         |---|---|---|---|---|---|---|---|\n",
    );
    for layout in LAYOUTS {
        let table = empty(layout.sampling().table)?;
        let textures = layout.textures(&table)?;
        let numbers: usize = textures.iter().map(|texture| texture.texels.len()).sum();
        let of_lobes =
            textures.iter().flat_map(|texture| &texture.channels).filter(|name| !NOT_OF_LOBES.contains(&name.as_str()));
        let axes = table.axes.named().into_iter().filter(|(_, nodes)| nodes.len() > 1);
        let (names, nodes): (Vec<_>, Vec<_>) = axes.map(|(name, nodes)| (name, nodes.len().to_string())).unzip();
        // Writing to a string cannot fail.
        let _ = writeln!(
            text,
            "| `{}` | {} | {} | {} | {} | {} | {} | {} |",
            table.layout(),
            layout.sampling().normalisation,
            names.join(", "),
            nodes.join(" x "),
            textures.iter().map(sides).collect::<Vec<_>>().join("; "),
            of_lobes.count(),
            numbers * size_of::<f32>(),
            numbers * size_of::<u16>(),
        );
    }
    Ok(text)
}

/// A table with the default resolution of the layout. Every lobe is the cosine.
fn empty(layout: Layout) -> Result<Table, FigureError> {
    let plan = Plan::new(&parse(format!(r#"{{"layout": "{layout}"}}"#).as_bytes(), DEFAULT_ENTRY_LIMIT)?);
    let (recipe, count) = (plan.recipe(), plan.entries() as usize);
    Ok(Table {
        brdf: recipe.model().clone(),
        lobe: recipe.lobe(),
        layout,
        axes: plan.nodes().clone(),
        matrix: vec![[1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]; count],
        terms: recipe.terms().any().then(|| Terms {
            amplitude: vec![1.0; count],
            fresnel: vec![0.0; count],
            edge: None,
        }),
        second: None,
        node_error: vec![0.0; count],
    })
}

/// The side lengths of a texture in texels.
fn sides(texture: &Texture) -> String {
    let Texture { width, height, depth, .. } = texture;
    if *depth > 1 { format!("{width} x {height} x {depth}") } else { format!("{width} x {height}") }
}
