//! The textures that our shader reads, for each table layout.
//!
//! Nodes need not be evenly spaced. A shader finds the position among the nodes on each axis. It then samples between
//! texel centres, or interpolates the texels itself.

use super::{
    error::NoTextures,
    isotropic,
    rules::{TextureAxis, TextureRules, TextureSampling, TexturesOf, made},
};
use crate::texture::Texture;
use ltcforge_fit::{Layout, Table};

/// Axes for the order in which a file stores its entries.
const VOLUME: &[TextureAxis] = &[
    TextureAxis { axis: "x", coordinate: "node of phi" },
    TextureAxis { axis: "y", coordinate: "node of ratio times how many theta has, plus node of theta" },
    TextureAxis { axis: "z", coordinate: "node of alpha" },
];
const ARRAY: &[TextureAxis] = &[
    TextureAxis { axis: "x", coordinate: "node of phi" },
    TextureAxis { axis: "y", coordinate: "node of ratio times how many theta has, plus node of theta" },
    TextureAxis {
        axis: "layer",
        coordinate: "node of alpha; first all layers of matrix_a, then of matrix_b, then of terms",
    },
];
const PARTS: &[TexturesOf] = &[
    TexturesOf {
        name: "ltc_matrix_a",
        channels: &["m00", "m01", "m02", "m10"],
        meaning: "the stored matrix by row and column",
    },
    TexturesOf { name: "ltc_matrix_b", channels: &["m11", "m12", "m20", "m21"], meaning: "likewise" },
    TexturesOf {
        name: "ltc_terms",
        channels: &["m22", "amplitude", "fresnel", "unused"],
        meaning: "the last number of the matrix, and the stored terms; 1 and 0 for a table without terms",
    },
];
const TOGETHER: &[TexturesOf] = &[TexturesOf {
    name: "ltc",
    channels: &["x", "y", "z", "w"],
    meaning: "matrix_a: m00 m01 m02 m10; matrix_b: m11 m12 m20 m21; terms: m22 amplitude fresnel 0",
}];
const COLUMN: &str = "the stored matrix, its third column of unit length";

pub(super) const REFLECTED: ShaderTextures = ShaderTextures {
    table: Layout::Reflected,
    is_array: false,
    normalisation: COLUMN,
    recipe: r#"{"layout": "reflected"}"#,
};
pub(super) const KT2022: ShaderTextures =
    ShaderTextures { table: Layout::Kt2022, recipe: r#"{"layout": "kt2022"}"#, ..REFLECTED };
pub(super) const MATERIALS: ShaderTextures = ShaderTextures {
    table: Layout::Materials,
    recipe: r#"{"layout": "materials", "materials": [{"alpha": 0.3, "ratio": 0.5}]}"#,
    ..REFLECTED
};
pub(super) const MATERIALS_ARRAY: ShaderTextures = ShaderTextures { is_array: true, ..MATERIALS };
pub(super) const LTC2017: ShaderTextures = of(&isotropic::LTC2017);
pub(super) const LTC2016: ShaderTextures = of(&isotropic::LTC2016);
pub(super) const GODOT: ShaderTextures = of(&isotropic::GODOT);
pub(super) const HDRP: ShaderTextures = of(&isotropic::HDRP);
pub(super) const INVERSE: ShaderTextures = ShaderTextures {
    table: Layout::Inverse,
    normalisation: "the stored matrix, whose inverse has a third column of unit length",
    recipe: r#"{"layout": "inverse"}"#,
    ..REFLECTED
};
pub(super) const MATRIX33: ShaderTextures = ShaderTextures {
    table: Layout::Matrix33,
    normalisation: "the stored matrix over its last element",
    recipe: r#"{"layout": "matrix33"}"#,
    ..REFLECTED
};
pub(super) const REFLECTED_ARRAY: ShaderTextures = ShaderTextures { is_array: true, ..REFLECTED };
pub(super) const KT2022_ARRAY: ShaderTextures = ShaderTextures { is_array: true, ..KT2022 };

/// The textures for our shader, for a table layout that also has 2D textures for engines.
const fn of(engines: &isotropic::EngineTextures) -> ShaderTextures {
    let TextureSampling { table, normalisation, recipe, .. } = engines.sampling;
    ShaderTextures { table, is_array: false, normalisation, recipe }
}

/// Textures with the entries of a table in order, in the form that our shader reads.
pub(super) struct ShaderTextures {
    table: Layout,
    is_array: bool,
    normalisation: &'static str,
    recipe: &'static str,
}

impl TextureRules for ShaderTextures {
    fn sampling(&self) -> TextureSampling {
        let (axes, textures) = if self.is_array { (ARRAY, TOGETHER) } else { (VOLUME, PARTS) };
        TextureSampling { table: self.table, axes, textures, normalisation: self.normalisation, recipe: self.recipe }
    }

    fn is_for_shader(&self) -> bool {
        true
    }

    fn textures(&self, table: &Table) -> Result<Vec<Texture>, NoTextures> {
        let counts = table.lengths();
        let (width, height) = (counts.phi, counts.ratio.saturating_mul(counts.theta));
        let lobes: Vec<&[[f32; 9]]> = [Some(table.matrices()), table.second_matrices()].into_iter().flatten().collect();
        let layers = lobes.len() * counts.alpha;
        if self.is_array {
            let texels = (0..3).flat_map(|part| lobes.iter().flat_map(move |lobe| texels(table, lobe, part)));
            return Ok(vec![made(&TOGETHER[0], [width, height, 1], 3 * layers, texels.collect())?]);
        }
        let part = |(part, of)| {
            let texels = lobes.iter().flat_map(|lobe| texels(table, lobe, part)).collect();
            Ok(made(of, [width, height, layers], 1, texels)?)
        };
        PARTS.iter().enumerate().map(part).collect()
    }
}

/// The texels of one part of a lobe, in the order of the entries.
fn texels(table: &Table, lobe: &[[f32; 9]], part: usize) -> Vec<f32> {
    let terms = |i: usize| table.terms.as_ref().map_or([1.0, 0.0], |t| [t.amplitude()[i], t.fresnel()[i]]);
    let texel = |(i, m): (usize, &[f32; 9])| match part {
        0 => [m[0], m[1], m[2], m[3]],
        1 => [m[4], m[5], m[6], m[7]],
        _ => {
            let [amplitude, fresnel] = terms(i);
            [m[8], amplitude, fresnel, table.beside_terms(i)]
        }
    };
    lobe.iter().enumerate().flat_map(texel).collect()
}
