//! Tables in the textures that our own shader reads.

use super::texture::{Texture, TextureError};
use crate::fit::{Layout, Table};

/// Why a table has no textures of a layout.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum NoTextures {
    /// A layout that is not known.
    #[error("layout «{name}» is not known; there are {}", layout_names().join(", "))]
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
    Layout::ALL.iter().map(|layout| layout.name()).collect()
}

/// The table as three 3D textures: `ltc_matrix_a`, `ltc_matrix_b` and `ltc_terms`, in the order in which a file stores its
/// entries: x = phi, y = ratio * (nodes of theta) + theta, z = alpha. A table without terms has amplitude 1 and Fresnel
/// term 0.
///
/// # Errors
/// When the layout is not known or not the table's, or an axis is too long.
pub fn textures_of(table: &Table, layout: &str) -> Result<Vec<Texture>, NoTextures> {
    let asked = Layout::from_name(layout).ok_or_else(|| NoTextures::UnknownLayout { name: layout.to_owned() })?;
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
