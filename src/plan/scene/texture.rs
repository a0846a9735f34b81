//! Textures: the channels of an image at texture coordinates.

use std::sync::Arc;

use super::image::Pixels;
use ltcforge_fit::math::pow;

const CLAMP: u32 = 33_071;
const MIRROR: u32 = 33_648;

/// A texture of a material.
#[derive(Debug)]
pub(super) struct Sampled {
    pub(super) pixels: Arc<Pixels>,
    /// The wrap modes of glTF. An image without a wrap mode repeats.
    pub(super) wrap: [Option<u32>; 2],
    /// The set of texture coordinates.
    pub(super) set: u32,
    pub(super) transform: [[f64; 3]; 2],
}

impl Sampled {
    /// The texel at texture coordinates.
    pub(super) fn at(&self, uv: [f64; 2]) -> [f64; 3] {
        let size = self.pixels.size;
        let texel = [0, 1].map(|i| {
            let [a, b, c] = self.transform[i];
            let place = a * uv[0] + b * uv[1] + c;
            let wrapped = match self.wrap[i] {
                Some(CLAMP) => place.clamp(0.0, 1.0),
                Some(MIRROR) => place.rem_euclid(2.0).min((-place).rem_euclid(2.0)),
                _ => place.rem_euclid(1.0),
            };
            // A coordinate that is not a number selects the first texel.
            ((wrapped * size[i] as f64) as usize).min(size[i] - 1)
        });
        self.pixels.at(texel)
    }
}

/// Converts a level of a colour texture to linear light, by the sRGB curve [IEC 61966-2-1]. Domain: [0, 1].
pub(super) fn linear(level: f64) -> f64 {
    if level <= 0.040_45 { level / 12.92 } else { pow((level + 0.055) / 1.055, 2.4) }
}
