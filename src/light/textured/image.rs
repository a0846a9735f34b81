//! A picture on a light.

/// The channels of a texel, in order.
const CHANNELS: [&str; 3] = ["red", "green", "blue"];

/// The radiance of a light as texels: linear, finite, not negative. Rows are ordered from the top, and texels of a row
/// from the left. A texel is a rectangle of one colour, and the image covers the light from edge to edge.
#[derive(Debug, Clone, PartialEq)]
pub struct LightImage {
    width: usize,
    texels: Vec<[f32; 3]>,
}

/// The reason why texels are not a valid picture.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum ImageError {
    /// The number of texels does not match the size.
    #[error("got {found} texels; {width} x {height} needs {}, at least one", u128::from(*.width) * u128::from(*.height))]
    Count {
        /// The width in texels.
        width: u64,
        /// The height in texels.
        height: u64,
        /// The number of texels.
        found: u64,
    },
    /// A channel of a texel is not a valid radiance.
    #[error(
        "the texel at x {x}, y {y} has {channel} {value}; {count} of the image's numbers are negative or not finite"
    )]
    Texel {
        /// The column of the first invalid texel, from zero at the left.
        x: usize,
        /// The row, from zero at the top.
        y: usize,
        /// The first invalid channel.
        channel: &'static str,
        /// The value.
        value: f32,
        /// The number of invalid values in the image.
        count: usize,
    },
}

impl LightImage {
    /// Creates an image from texels.
    ///
    /// # Errors
    /// [`ImageError::Count`] for an image without texels, or with a number of texels that does not match its size.
    /// [`ImageError::Texel`] for numbers that are negative or not finite.
    pub fn new(width: usize, height: usize, texels: Vec<[f32; 3]>) -> Result<Self, ImageError> {
        if texels.is_empty() || width.checked_mul(height) != Some(texels.len()) {
            return Err(ImageError::Count { width: width as u64, height: height as u64, found: texels.len() as u64 });
        }
        let is_wrong = |value: &f32| !(value.is_finite() && *value >= 0.0);
        let count = texels.as_flattened().iter().filter(|value| is_wrong(value)).count();
        if let Some(first) = texels.as_flattened().iter().position(is_wrong) {
            let (texel, channel) = (first / 3, first % 3);
            let (x, y) = (texel % width, texel / width);
            return Err(ImageError::Texel { x, y, channel: CHANNELS[channel], value: texels[texel][channel], count });
        }
        Ok(Self { width, texels })
    }

    /// Creates an image from valid texels. Domain: whole rows of this width, at least one.
    pub(super) fn of_texels(width: usize, texels: Vec<[f32; 3]>) -> Self {
        Self { width, texels }
    }

    /// The width in texels.
    #[must_use]
    pub fn width(&self) -> usize {
        self.width
    }

    /// The height in texels.
    #[must_use]
    pub fn height(&self) -> usize {
        self.texels.len() / self.width
    }

    /// The texels, row after row from the top.
    #[must_use]
    pub fn texels(&self) -> &[[f32; 3]] {
        &self.texels
    }

    /// The texels of a row. Domain: `y` below the height.
    #[must_use]
    pub fn row(&self, y: usize) -> &[[f32; 3]] {
        &self.texels[y * self.width..][..self.width]
    }

    /// The mean of all texels for each channel. Sums each row first, then the sums of the rows.
    #[must_use]
    pub fn mean(&self) -> [f64; 3] {
        let sum = |sums: [f64; 3], row: [f64; 3]| [0, 1, 2].map(|c| sums[c] + row[c]);
        let of_row = |y| self.row(y).iter().map(|texel| texel.map(f64::from)).fold([0.0; 3], sum);
        let total = (0..self.height()).map(of_row).fold([0.0; 3], sum);
        total.map(|sum| sum / self.texels.len() as f64)
    }

    /// Interpolates bilinearly between the centres of the four texels around a point, like a GPU with a clamping
    /// sampler. `u` goes from 0 at the left edge to 1 at the right, `v` from the top to the bottom. Points outside have
    /// the value of the nearest point inside.
    #[must_use]
    pub fn bilinear(&self, [u, v]: [f64; 2]) -> [f64; 3] {
        let (x, next_x, along) = between(u, self.width);
        let (y, next_y, down) = between(v, self.height());
        let mix = |a: f64, b: f64, t: f64| a + (b - a) * t;
        [0, 1, 2].map(|c| {
            let at = |x: usize, y: usize| f64::from(self.row(y)[x][c]);
            mix(mix(at(x, y), at(next_x, y), along), mix(at(x, next_y), at(next_x, next_y), along), down)
        })
    }
}

/// The two of `count` texels whose centres are around a position from 0 to 1, and the position between them.
fn between(position: f64, count: usize) -> (usize, usize, f64) {
    let last = (count - 1) as f64;
    // This order maps NaN to the first texel.
    let x = (position * count as f64 - 0.5).max(0.0).min(last);
    let first = x as usize;
    (first, (first + 1).min(count - 1), x - first as f64)
}
