//! Texels that are square on a light.

use super::{
    LightImage,
    filters::averaged,
    rows::{Row, made},
};

/// The largest number of texels along a side, and in total, of a converted image. The first is the texture size that
/// every WebGPU device supports. The second gives 128 MiB of half floats.
pub const MOST_SQUARE_TEXELS: [usize; 2] = [8192, 1 << 24];

impl LightImage {
    /// The number of texels along both sides with which the image is square on a light of this width and height, in any
    /// unit. One side keeps its number of texels, and the other gets at least as many as before. Both are reduced if
    /// this exceeds 8192 per side or 2^24 in total. Domain: positive lengths.
    #[must_use]
    pub fn square_size(&self, light: [f64; 2]) -> [usize; 2] {
        let size = [self.width() as f64, self.height() as f64];
        let finest = (light[0] / size[0]).min(light[1] / size[1]);
        let [along, in_all] = MOST_SQUARE_TEXELS.map(|most| most as f64);
        let longest = light[0].max(light[1]) / along;
        let largest = (light[0] * light[1] / in_all).sqrt();
        let texel = finest.max(longest).max(largest);
        light.map(|length| ((length / texel).round() as usize).max(1))
    }

    /// Converts the image to another number of texels. Each texel is the mean of the part of the image that it covers.
    /// This preserves the mean and uniform colours. Domain: a positive width and height. Runs on the current rayon
    /// pool. The size of the pool does not change the result.
    #[must_use]
    pub fn resampled(&self, [width, height]: [usize; 2]) -> Self {
        let (columns, rows) = (averaged(self.width(), width), averaged(self.height(), height));
        made(width, height, |y, row| Row::new(self, &rows[y]).add(&columns, 1.0, row))
    }
}
