//! The 2D textures of isotropic tables, as engines sample them.
//!
//! Nodes are at texel centres: texel `i` of `n` has the coordinate `i / (n - 1)`. Therefore a shader samples at
//! `coordinate (n - 1) / n + 0.5 / n`.

use super::{
    error::NoTextures,
    rules::{TextureAxis, TextureRules, TextureSampling, TexturesOf, made},
};
use crate::texture::Texture;
use ltcforge_fit::{Layout, Table, Terms, clipped_form_factor};

const ROUGHNESS: TextureAxis =
    TextureAxis { axis: "x", coordinate: "sqrt(alpha), from 0 to 1; texel i of n at i / (n - 1)" };
const VERSINE: TextureAxis =
    TextureAxis { axis: "y", coordinate: "sqrt(1 - cos theta), from 0 to 1; texel i of n at i / (n - 1)" };
const THETA: TextureAxis =
    TextureAxis { axis: "y", coordinate: "theta / (pi / 2), from 0 to 1; texel i of n at i / (n - 1)" };

const AMPLITUDE: &str = "reflectance is f0 (amplitude - fresnel) + f90 fresnel";

/// The textures of three.js, Babylon.js, `PlayCanvas`, Bevy, Blender and Unreal.
pub(super) const LTC2017: EngineTextures = EngineTextures {
    sampling: TextureSampling {
        table: Layout::Ltc2017,
        axes: &[ROUGHNESS, VERSINE],
        textures: &[
            TexturesOf {
                name: "LTC_1",
                channels: &["minv00", "minv20", "minv02", "minv22"],
                meaning: "M^-1 by row and column",
            },
            TexturesOf {
                name: "LTC_2",
                channels: &["amplitude", "fresnel", "zero", "sphere"],
                meaning: "reflectance is f0 (amplitude - fresnel) + f90 fresnel; sphere, at x = (1 + cos of the light's elevation) \
                          / 2 and y = its form factor as if unclipped, is the part that is left above the horizon times its cosine",
            },
        ],
        normalisation: "M^-1 over its element 11",
        recipe: r#"{"layout": "ltc2017"}"#,
    },
    numbers: &[
        &[Number::Matrix(0, 0), Number::Matrix(2, 0), Number::Matrix(0, 2), Number::Matrix(2, 2)],
        &[Number::Amplitude, Number::Fresnel, Number::Zero, Number::Sphere],
    ],
};

/// The textures of Open 3D Engine.
pub(super) const LTC2016: EngineTextures = EngineTextures {
    sampling: TextureSampling {
        table: Layout::Ltc2016,
        axes: &[ROUGHNESS, THETA],
        textures: &[
            TexturesOf {
                name: "LTC_1",
                channels: &["minv22", "minv20", "minv11", "minv02"],
                meaning: "M^-1 by row and column",
            },
            TexturesOf { name: "LTC_2", channels: &["amplitude", "fresnel", "zero", "zero_2"], meaning: AMPLITUDE },
        ],
        normalisation: "M^-1 over its element 00",
        recipe: r#"{"layout": "ltc2016"}"#,
    },
    numbers: &[
        &[Number::Matrix(2, 2), Number::Matrix(2, 0), Number::Matrix(1, 1), Number::Matrix(0, 2)],
        &[Number::Amplitude, Number::Fresnel, Number::Zero, Number::Zero],
    ],
};

/// The textures of Godot.
pub(super) const GODOT: EngineTextures = EngineTextures {
    sampling: TextureSampling {
        table: Layout::Godot,
        axes: &[ROUGHNESS, THETA],
        textures: &[
            TexturesOf {
                name: "LTC_1",
                channels: &["m00", "m20", "m11", "m02"],
                meaning: "M by row and column, in the frame of tangent T1, T2 and normal; Godot's has y up and z along -T1",
            },
            TexturesOf {
                name: "LTC_2",
                channels: &["m22", "amplitude", "fresnel", "zero"],
                meaning: "the last number of M; reflectance is f0 (amplitude - fresnel) + f90 fresnel",
            },
        ],
        normalisation: "M with a third column of about unit length",
        recipe: r#"{"layout": "godot"}"#,
    },
    numbers: &[
        &[Number::Matrix(0, 0), Number::Matrix(2, 0), Number::Matrix(1, 1), Number::Matrix(0, 2)],
        &[Number::Matrix(2, 2), Number::Amplitude, Number::Fresnel, Number::Zero],
    ],
};

/// The texture of Unity's High Definition Render Pipeline.
pub(super) const HDRP: EngineTextures = EngineTextures {
    sampling: TextureSampling {
        table: Layout::Hdrp,
        axes: &[ROUGHNESS, VERSINE],
        textures: &[TexturesOf {
            name: "LTC_1",
            channels: &["minv00", "minv20", "minv11", "minv02"],
            meaning: "M^-1 by row and column, which is elements 00, 02, 11 and 20 of its transpose",
        }],
        normalisation: "M^-1 over its element 22",
        recipe: r#"{"layout": "hdrp"}"#,
    },
    numbers: &[&[Number::Matrix(0, 0), Number::Matrix(2, 0), Number::Matrix(1, 1), Number::Matrix(0, 2)]],
};

/// One of the numbers in a texel.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Number {
    /// An element of the stored matrix, by row and column.
    Matrix(usize, usize),
    Amplitude,
    Fresnel,
    /// [`clipped_form_factor`], which depends only on the position of the texel.
    Sphere,
    Zero,
}

/// The 2D textures of one table layout.
pub(super) struct EngineTextures {
    pub(super) sampling: TextureSampling,
    /// The numbers in the channels of each texture.
    numbers: &'static [&'static [Number]],
}

impl TextureRules for EngineTextures {
    fn sampling(&self) -> TextureSampling {
        self.sampling
    }

    fn lacks(&self, table: &Table) -> Option<String> {
        let needs_terms = self.numbers.concat().contains(&Number::Amplitude);
        (needs_terms && table.terms.is_none())
            .then(|| "amplitude and Fresnel term, but the table's recipe has \"terms\": false".to_owned())
    }

    fn textures(&self, table: &Table) -> Result<Vec<Texture>, NoTextures> {
        let counts = table.lengths();
        let (width, height) = (counts.alpha, counts.theta);
        let along = |i: usize, n: usize| i as f64 / (n.max(2) - 1) as f64;
        let number = |number: Number, x: usize, y: usize| {
            let entry = x * height + y;
            let term = |of: fn(&Terms) -> &[f32]| table.terms.as_ref().map_or(0.0, |terms| of(terms)[entry]);
            match number {
                Number::Matrix(row, column) => table.matrix[entry][3 * row + column],
                Number::Amplitude => term(Terms::amplitude),
                Number::Fresnel => term(Terms::fresnel),
                Number::Sphere => clipped_form_factor(2.0 * along(x, width) - 1.0, along(y, height)) as f32,
                Number::Zero => 0.0,
            }
        };
        let texture = |(of, numbers): (&TexturesOf, &&[Number])| {
            let places = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
            let texels = places.flat_map(|(x, y)| numbers.iter().map(move |of| number(*of, x, y))).collect();
            Ok(made(of, [width, height, 1], 1, texels)?)
        };
        self.sampling.textures.iter().zip(self.numbers).map(texture).collect()
    }
}
