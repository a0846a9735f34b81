//! The picture on the light of a frame, as renderers read it.

use std::sync::Arc;

use super::Scene;
use ltcforge_light::textured::{LightImage, LightPyramid, Readings};

/// A picture: as it is for the reference and for the light as the camera sees it, and prefiltered for models.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct LightPicture {
    pub(super) image: Arc<LightImage>,
    /// Of texels that are square on the light.
    pub(super) pyramid: LightPyramid,
    /// How often models read it.
    pub(super) readings: Readings,
}

impl LightPicture {
    /// That of a scene, if it has one. Domain: a scene without faults, so that its light is a rectangle.
    pub(super) fn of(scene: &Scene) -> Option<Self> {
        let image = scene.picture.image()?;
        let pyramid = LightPyramid::new(&image.resampled(image.square_size(scene.light.half_size)));
        Some(Self { image, pyramid, readings: scene.readings })
    }

    /// The base that texts to include take: the binary logarithm of halves of the root of how many texels the first level has.
    pub(super) fn base(&self) -> f32 {
        let level = &self.pyramid.levels()[0];
        let texels = (level.width() * level.height()) as f64;
        LightPyramid::level_of(texels.sqrt()) as f32
    }
}
