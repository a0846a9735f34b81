//! How much of a surface is there, by the alpha of its base colour.

use super::{
    document::{AlphaMode, Material},
    error::SceneError,
    reflectance::{ReadTexture, Uv},
    texture::Sampled,
};

/// Below this alpha a masked surface is not there, where the material does not say.
const CUTOFF: f64 = 0.5;

/// The alpha of a material's base colour.
#[derive(Debug)]
pub(super) struct Coverage {
    mode: AlphaMode,
    cutoff: f64,
    factor: f64,
    map: Option<Sampled>,
}

impl Coverage {
    pub(super) fn read(material: &Material, texture: &mut ReadTexture<'_>) -> Result<Self, SceneError> {
        let (mode, of) = (material.alpha_mode, &material.pbr_metallic_roughness);
        let info = of.base_color_texture.as_ref().filter(|_| mode != AlphaMode::Opaque);
        let map = texture("alpha", info, &[3])?;
        let cutoff = material.alpha_cutoff.unwrap_or(CUTOFF);
        Ok(Self { mode, cutoff, factor: of.base_color_factor[3], map })
    }

    /// The part of the surface that is there at a point, in [0, 1].
    pub(super) fn at(&self, uv: &Uv<'_>) -> f64 {
        let alpha = || self.factor * self.map.as_ref().map_or(1.0, |map| map.at(uv(map.set))[0]);
        match self.mode {
            AlphaMode::Opaque => 1.0,
            AlphaMode::Mask => f64::from(u8::from(alpha() >= self.cutoff)),
            AlphaMode::Blend => alpha(),
        }
    }

    /// The factor of alpha, and below which alpha nothing is there.
    pub(super) fn numbers(&self) -> [f64; 2] {
        [self.factor, self.cutoff]
    }

    pub(super) fn textures(&self) -> impl Iterator<Item = &Sampled> {
        self.map.iter()
    }
}
