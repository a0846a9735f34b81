//! Tables in the textures that our own shader reads.

use super::texture::{Texture, TextureError};
use crate::fit::{Layout, Table};

/// The layouts whose tables a shader of ours reads as they are stored.
const OWN: [Layout; 2] = [Layout::Reflected, Layout::Kt2022];

/// Why a table has no textures of a layout.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum NoTextures {
    /// A layout without textures.
    #[error("there are no textures of layout «{name}»; there are of {}", layout_names().join(", "))]
    UnknownLayout {
        /// Its name.
        name: String,
    },
    /// The table has another layout, and what it stores does not tell the numbers of this one.
    #[error(
        "the table has layout {table}, so it has no textures of layout {asked}; a recipe with \"layout\": \"{asked}\" gives a table that has"
    )]
    OtherLayout {
        /// That of the table.
        table: Layout,
        /// The one that was asked for.
        asked: Layout,
    },
    /// A table whose axes are longer than textures.
    #[error(transparent)]
    Texture(#[from] TextureError),
}

/// The layouts that [`textures_of`] knows.
#[must_use]
pub fn layout_names() -> Vec<&'static str> {
    OWN.iter().map(|layout| layout.name()).collect()
}

/// The table as three 3D textures: `ltc_matrix_a`, `ltc_matrix_b` and `ltc_terms`, in the order in which a file stores its
/// entries: x = phi, y = ratio * (nodes of theta) + theta, z = alpha. A table without terms has amplitude 1 and Fresnel
/// term 0.
///
/// # Errors
/// When the layout is not known or not the table's, or an axis is too long.
pub fn textures_of(table: &Table, layout: &str) -> Result<Vec<Texture>, NoTextures> {
    let unknown = || NoTextures::UnknownLayout { name: layout.to_owned() };
    let asked = OWN.into_iter().find(|own| own.name() == layout).ok_or_else(unknown)?;
    if table.layout != asked {
        return Err(NoTextures::OtherLayout { table: table.layout, asked });
    }
    let counts = table.axes.lengths();
    let side = |n: usize| u32::try_from(n).unwrap_or(u32::MAX);
    let sides = [side(counts.phi), side(counts.ratio.saturating_mul(counts.theta)), side(counts.alpha)];
    let texture = |name, channels: [&str; 4], texel: &dyn Fn(usize, &[f32; 9]) -> [f32; 4]| {
        let texels = table.matrix.iter().enumerate().flat_map(|(i, m)| texel(i, m)).collect();
        Texture::new(name, sides, 1, &channels, texels)
    };
    let terms = table.terms.as_ref();
    let term = |i: usize| terms.map_or((1.0, 0.0), |terms| (terms.amplitude[i], terms.fresnel[i]));
    Ok(vec![
        texture("ltc_matrix_a", ["m00", "m01", "m02", "m10"], &|_, m| [m[0], m[1], m[2], m[3]])?,
        texture("ltc_matrix_b", ["m11", "m12", "m20", "m21"], &|_, m| [m[4], m[5], m[6], m[7]])?,
        texture("ltc_terms", ["m22", "amplitude", "fresnel", "unused"], &|i, m| {
            let (amplitude, fresnel) = term(i);
            [m[8], amplitude, fresnel, 0.0]
        })?,
    ])
}

/// How a shader reads these textures, for people: what the axes are, and the nodes, which need not be evenly spaced.
#[must_use]
pub fn sampling_of(table: &Table) -> Vec<String> {
    let nodes = |nodes: &[f64]| nodes.iter().map(|x| (*x as f32).to_string()).collect::<Vec<_>>().join(" ");
    let order = "x = phi, y = ratio * (nodes of theta) + theta, z = alpha; linear weights between nodes";
    let shader =
        format!("layout {}; read by the shader that `ltcforge shader --layout {}` writes", table.layout, table.layout);
    let axes = table.axes.named().map(|(name, axis)| format!("nodes of {name}: {}", nodes(axis)));
    [shader, order.to_owned()].into_iter().chain(axes).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        files::recipe_document,
        fit::{Recipe, Terms},
    };

    /// A table whose numbers tell their places.
    fn planted() -> Table {
        let document = br#"{"layout": "kt2022", "resolution": {"alpha": 2, "ratio": 3, "theta": 4, "phi": 5}}"#;
        let recipe: Recipe = recipe_document::parse(document, u64::MAX).expect("a recipe");
        let entries = 2 * 3 * 4 * 5;
        let matrix = (0..entries).map(|i| std::array::from_fn(|j| (i * 16 + j) as f32)).collect();
        let term = |place: usize| (0..entries).map(|i| (i * 16 + place) as f32).collect();
        Table {
            brdf: recipe.brdf,
            lobe: recipe.lobe,
            layout: recipe.layout,
            axes: recipe.nodes(),
            matrix,
            terms: Some(Terms { amplitude: term(9), fresnel: term(10) }),
            node_error: vec![0.0; entries],
        }
    }

    #[test]
    fn three_textures_have_an_entry_in_the_order_of_the_file() {
        let textures = textures_of(&planted(), "kt2022").expect("textures");
        assert_eq!(
            textures.iter().map(|t| t.name.as_str()).collect::<Vec<_>>(),
            ["ltc_matrix_a", "ltc_matrix_b", "ltc_terms"]
        );
        for (i, texture) in textures.iter().enumerate() {
            assert_eq!([texture.width, texture.height, texture.depth, texture.layers], [5, 12, 2, 1]);
            for (entry, texel) in texture.texels.chunks(4).enumerate() {
                let expected: [f32; 4] = std::array::from_fn(|j| (entry * 16 + 4 * i + j) as f32);
                let known = if i == 2 { 3 } else { 4 };
                assert_eq!(texel[..known], expected[..known], "{} {entry}", texture.name);
            }
        }
    }

    #[test]
    fn a_table_without_terms_reflects_all_light() {
        let textures = textures_of(&Table { terms: None, ..planted() }, "kt2022").expect("textures");
        assert!(textures[2].texels.chunks(4).all(|texel| texel[1..] == [1.0, 0.0, 0.0]));
    }

    #[test]
    fn another_layout_is_refused_with_the_recipe_that_has_it() {
        let refused = |layout: &str| textures_of(&planted(), layout).expect_err(layout).to_string();
        assert!(refused("reflected").contains("\"layout\": \"reflected\""));
        assert!(refused("hdrp").contains("there are of reflected, kt2022"));
    }

    #[test]
    fn people_read_where_the_nodes_are() {
        let lines = sampling_of(&planted());
        assert!(lines.iter().any(|line| line == "nodes of alpha: 0.0001 1"), "{lines:?}");
    }
}
