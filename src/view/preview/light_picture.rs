//! The picture on the light of a frame, as renderers read it.

use std::sync::Arc;

use super::Scene;
use ltcforge_light::textured::{LightImage, LightPyramid, Readings};

/// A picture: the image for the reference and for the camera, and the prefiltered pyramid for models.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct LightPicture {
    pub(super) image: Arc<LightImage>,
    /// The prefiltered picture. Its texels are square on the light.
    pub(super) pyramid: LightPyramid,
    /// The number of times that models read the picture for a point.
    pub(super) readings: Readings,
}

impl LightPicture {
    /// The picture of a scene, if the scene has one. Domain: a scene without faults, so that its light is a rectangle.
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
