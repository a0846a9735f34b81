//! One sphere lit in one way, with its picture and its error.

use rayon::prelude::*;

use super::{
    list::Material,
    shade::{Way, shade},
    sphere::seen,
};
use ltcforge::view::picture::{Picture, colour, srgb};
use ltcforge_light::LightError;

/// The radiance of the lamp (for glass, its basic radiance), and of the background.
const RADIANCE: f64 = 2.0;
const BACKGROUND: f64 = 0.02;

/// A sphere in a panel of `side` x `side` pixels.
pub(super) struct Sphere {
    side: u32,
    pixels: Vec<Pixel>,
}

/// The part of a pixel that the sphere covers, 0 to 1, and the radiance of the sphere in it.
struct Pixel {
    coverage: f64,
    radiance: [f64; 3],
}

/// The error of a sphere against the truth, over the covered pixels and over channels.
pub(super) struct Apart {
    pub(super) mean_absolute: f64,
    /// Mean true radiance.
    pub(super) mean_radiance: f64,
}

impl Sphere {
    /// The sphere of a material. `None` if this way cannot compute its light.
    ///
    /// # Errors
    /// The errors of [`shade`].
    pub(super) fn new(material: &Material, way: Way<'_>, side: u32) -> Result<Option<Self>, LightError> {
        let pixel = |index: u32| {
            let Some((coverage, point)) = seen(side, [index % side, index / side], material.lamp()) else {
                return Ok(Some(Pixel { coverage: 0.0, radiance: [0.0; 3] }));
            };
            let light = shade(material, way, &point)?;
            Ok(light.map(|light| Pixel { coverage, radiance: light.map(|part| RADIANCE * part) }))
        };
        let pixels = (0..side * side).into_par_iter().map(pixel).collect::<Result<Vec<_>, LightError>>()?;
        let pixels: Option<Vec<Pixel>> = pixels.into_iter().collect();
        Ok(pixels.map(|pixels| Self { side, pixels }))
    }

    /// The sphere, displayed as in previews: `1 - exp(-x)`, the sRGB curve, eight bits.
    pub(super) fn shown(&self) -> Picture {
        self.picture(|Pixel { coverage, radiance }| {
            radiance.map(|part| {
                let seen = coverage * part.max(0.0) + (1.0 - coverage) * BACKGROUND;
                srgb(1.0 - libm::expf(-seen as f32))
            })
        })
    }

    /// The difference from the truth in false colours, which end at `scale`. Domain: spheres of the same size.
    pub(super) fn difference(&self, truth: &Self, scale: f64) -> Picture {
        let mut wanted = truth.pixels.iter();
        self.picture(|pixel| {
            let apart = wanted.next().map_or(0.0, |wanted| pixel.apart(wanted));
            colour((pixel.coverage * apart / scale) as f32)
        })
    }

    /// The mean difference from the truth, and the mean true radiance.
    pub(super) fn apart(&self, truth: &Self) -> Apart {
        let (mut apart, mut radiance, mut covered) = (0.0, 0.0, 0.0);
        for (pixel, wanted) in self.pixels.iter().zip(&truth.pixels) {
            apart += pixel.coverage * pixel.apart(wanted);
            radiance += pixel.coverage * mean(wanted.radiance);
            covered += pixel.coverage;
        }
        Apart { mean_absolute: apart / covered, mean_radiance: radiance / covered }
    }

    fn picture(&self, rgb: impl FnMut(&Pixel) -> [u8; 3]) -> Picture {
        Picture { width: self.side, height: self.side, rgb: self.pixels.iter().map(rgb).collect() }
    }
}

impl Pixel {
    /// The absolute difference, averaged over channels.
    fn apart(&self, other: &Self) -> f64 {
        mean([0, 1, 2].map(|i| (self.radiance[i] - other.radiance[i]).abs()))
    }
}

fn mean(channels: [f64; 3]) -> f64 {
    channels.iter().sum::<f64>() / 3.0
}
