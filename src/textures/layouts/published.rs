//! The 3D texture for the demo of KT et al. 2022: 8 x 8 x 192 texels.

use std::f64::consts::FRAC_PI_2;

use super::{
    error::NoTextures,
    rules::{TextureAxis, TextureRules, TextureSampling, TexturesOf, made},
};
use crate::texture::Texture;
use ltcforge_fit::{BrdfKind, Layout, PerAxis, Table};

/// The texture for the demo of KT et al. 2022.
pub(super) struct Kt2022Volume;

/// The number of nodes on each axis, a constant in the demo's shader.
const NODES: u32 = 8;
const TEXTURES: &[TexturesOf] =
    &[TexturesOf { name: "ltc_rows", channels: &["column_0", "column_1", "column_2", "zero"], meaning: "a row of M" }];

impl TextureRules for Kt2022Volume {
    fn sampling(&self) -> TextureSampling {
        TextureSampling {
            table: Layout::Kt2022,
            axes: &[
                TextureAxis { axis: "x", coordinate: "node of phi, evenly from 0 to pi / 2" },
                TextureAxis { axis: "y", coordinate: "node of theta, evenly from 0 to 0.9999 pi / 2" },
                TextureAxis {
                    axis: "z",
                    coordinate: "row * 64 + node of alpha * 8 + node of ratio, both evenly from 0 to 1",
                },
            ],
            textures: TEXTURES,
            normalisation: "M with a third column of unit length",
            recipe: r#"{"layout": "kt2022"}"#,
        }
    }

    fn lacks(&self, table: &Table) -> Option<String> {
        let (one, quarter) = ([0.0, 1.0], [0.0, FRAC_PI_2]);
        let whole = PerAxis { alpha: one, ratio: one, theta: quarter, phi: quarter };
        let nodes = PerAxis { alpha: NODES, ratio: NODES, theta: NODES, phi: NODES };
        let is_whole = table.axes == Layout::Kt2022.nodes(&whole, &nodes);
        let counts = table.lengths().named().map(|(_, n)| n.to_string()).join(" x ");
        (!is_whole).then(|| format!("8 x 8 x 8 x 8 nodes over the whole domain, but the table has {counts}"))
    }

    /// Rejects tables of isotropic surfaces, which have only one ratio.
    fn takes(&self, brdf: BrdfKind) -> bool {
        !brdf.is_isotropic()
    }

    fn textures(&self, table: &Table) -> Result<Vec<Texture>, NoTextures> {
        let counts = table.lengths();
        let slice = counts.theta * counts.phi;
        let slices = counts.alpha * counts.ratio;
        let texel = |row: usize, entry: usize| {
            let [x, y, z] = [0, 1, 2].map(|column| table.matrix[entry][3 * row + column]);
            [x, y, z, 0.0]
        };
        let texels = (0..3).flat_map(|row| (0..slices * slice).flat_map(move |entry| texel(row, entry))).collect();
        Ok(vec![made(&TEXTURES[0], [counts.phi, counts.theta, 3 * slices], 1, texels)?])
    }
}
