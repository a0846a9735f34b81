//! Reflectance of dielectrics seen from above, by `KHR_materials_ior` and `KHR_materials_specular`.

use super::{
    document::{Extensions, Ior, Specular, TextureInfo},
    error::SceneError,
    texture::{Sampled, extension, linear},
};

/// Reads some channels of a texture that a material names by what it is of.
pub(super) type ReadTexture<'a> =
    dyn FnMut(&str, Option<&TextureInfo>, &[usize]) -> Result<Option<Sampled>, SceneError> + 'a;

/// Uv coordinates of a set.
pub(super) type Uv<'a> = dyn Fn(u32) -> [f64; 2] + 'a;

/// The reflectance of a dielectric, with its textures.
#[derive(Debug)]
pub(super) struct Dielectric {
    /// By its index of refraction.
    f0: f64,
    of: Specular,
    factor: Option<Sampled>,
    colour: Option<Sampled>,
}

impl Dielectric {
    pub(super) fn read(extensions: &Extensions, texture: &mut ReadTexture<'_>) -> Result<Self, SceneError> {
        let Ior { ior } = extension(extensions, "KHR_materials_ior")?.unwrap_or_default();
        let of: Specular = extension(extensions, "KHR_materials_specular")?.unwrap_or_default();
        let factor = texture("specular factor", of.specular_texture.as_ref(), &[3])?;
        let colour = texture("specular colour", of.specular_color_texture.as_ref(), &[0, 1, 2])?;
        let root = if ior > 0.0 { (ior - 1.0) / (ior + 1.0) } else { 1.0 };
        let found = Self { f0: root * root, of, factor, colour };
        let most = found.of_maps(1.0, [1.0; 3]);
        if most.is_finite() && most >= 0.0 {
            Ok(found)
        } else {
            Err(SceneError::fault("extensions/KHR_materials_specular", format!("a reflectance of {most}")))
        }
    }

    /// The reflectance at a point.
    pub(super) fn at(&self, uv: &Uv<'_>) -> f64 {
        let factor = self.factor.as_ref().map_or(1.0, |map| map.at(uv(map.set))[0]);
        let colour = self.colour.as_ref().map_or([1.0; 3], |map| map.at(uv(map.set)).map(linear));
        self.of_maps(factor, colour)
    }

    /// `min(f0 luminance(colour), 1) factor`, of `KHR_materials_specular`.
    fn of_maps(&self, factor: f64, colour: [f64; 3]) -> f64 {
        let [r, g, b] = [0, 1, 2].map(|i| self.of.specular_color_factor[i] * colour[i]);
        (self.f0 * luminance([r, g, b])).min(1.0) * self.of.specular_factor * factor
    }

    pub(super) fn textures(&self) -> impl Iterator<Item = &Sampled> {
        self.factor.iter().chain(&self.colour)
    }
}

/// Relative luminance of linear colours [Rec. 709].
pub(super) fn luminance([r, g, b]: [f64; 3]) -> f64 {
    0.2126 * r + 0.7152 * g + 0.0722 * b
}
