//! The picture on a light, as renderers read it.

use std::sync::Arc;

use super::Scene;
use ltcforge_light::textured::{LightImage, LightPyramid, Readings};

/// A picture on a light. The reference and the camera read the image, and models read the prefiltered pyramid.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct LightPicture {
    pub(super) image: Arc<LightImage>,
    /// The prefiltered picture. Its texels are square on the light.
    pub(super) pyramid: LightPyramid,
    /// The number of texture reads of a model per shaded point.
    pub(super) readings: Readings,
}

impl LightPicture {
    /// The picture on the light of a scene, if there is one. Domain: a scene without faults, so its light is a
    /// rectangle.
    pub(super) fn of(scene: &Scene) -> Option<Self> {
        let image = scene.picture.image()?;
        let pyramid = LightPyramid::new(&image.resampled(image.square_size(scene.light.half_size)));
        Some(Self { image, pyramid, readings: scene.readings })
    }

    /// The `base` argument of the shaders: log2(sqrt(n) / 2) for n texels in the first level.
    pub(super) fn base(&self) -> f32 {
        let level = &self.pyramid.levels()[0];
        let texels = (level.width() * level.height()) as f64;
        LightPyramid::level_of(texels.sqrt()) as f32
    }
}
