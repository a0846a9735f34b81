//! Texels that are square on a light.

use super::{
    LightImage,
    filters::averaged,
    rows::{Row, made},
};

/// Most texels along a side, and in all, that an image is brought to: WebGPU's least limit of a texture, and 128 MiB of
/// halves.
pub const MOST_SQUARE_TEXELS: [usize; 2] = [8192, 1 << 24];

impl LightImage {
    /// How many texels the image needs along both sides to be square on a light of this width and height, in any unit: as
    /// many along one side as it has, and no fewer along the other; fewer along both where that would be more than 8192 a
    /// side or 2^24 in all. Domain: lengths above zero.
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

    /// The image in other texels: each is the mean of what of the image lies in it. The mean stays, and so does a colour.
    /// Domain: a width and a height above zero. Runs on the current rayon pool; its size changes nothing.
    #[must_use]
    pub fn resampled(&self, [width, height]: [usize; 2]) -> Self {
        let (columns, rows) = (averaged(self.width(), width), averaged(self.height(), height));
        made(width, height, |y, row| Row::new(self, &rows[y]).add(&columns, 1.0, row))
    }
}
