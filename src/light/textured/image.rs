//! A picture on a light.

/// The channels of a texel, in this order: red, green, blue.
const CHANNELS: [&str; 3] = ["red", "green", "blue"];

/// The radiance of a light, texel by texel: linear, finite, not negative. Row after row from the top, each from the left;
/// a texel is a rectangle of one colour, and the image covers the light from edge to edge.
#[derive(Debug, Clone, PartialEq)]
pub struct LightImage {
    width: usize,
    texels: Vec<[f32; 3]>,
}

/// Why texels are no picture of a light.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum ImageError {
    /// The numbers are not as many as the size says.
    #[error("{found} texels; an image of {width} x {height} has {}, and one at least", u128::from(*.width) * u128::from(*.height))]
    Count {
        /// The width in texels.
        width: u64,
        /// The height in texels.
        height: u64,
        /// How many texels there are.
        found: u64,
    },
    /// A channel of a texel is no radiance.
    #[error(
        "the texel at x {x}, y {y} has {channel} {value}; {count} of the image's numbers are negative or not finite, and a light has none"
    )]
    Texel {
        /// The column of the first such texel, from zero at the left.
        x: usize,
        /// Its row, from zero at the top.
        y: usize,
        /// The first such channel.
        channel: &'static str,
        /// Its number.
        value: f32,
        /// How many numbers of the image are so.
        count: usize,
    },
}

impl LightImage {
    /// The image of these texels.
    ///
    /// # Errors
    /// [`ImageError::Count`] for an image without texels or with more or fewer than its size says,
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

    /// The image of texels that are known to be right. Domain: as many as rows of that width, one at least.
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

    /// The mean of all texels, each channel by itself. Rows are summed one by one, and then their sums.
    #[must_use]
    pub fn mean(&self) -> [f64; 3] {
        let sum = |sums: [f64; 3], row: [f64; 3]| [0, 1, 2].map(|c| sums[c] + row[c]);
        let of_row = |y| self.row(y).iter().map(|texel| texel.map(f64::from)).fold([0.0; 3], sum);
        let total = (0..self.height()).map(of_row).fold([0.0; 3], sum);
        total.map(|sum| sum / self.texels.len() as f64)
    }

    /// Between the middles of the four texels around a point by their distances, as a GPU does it with a sampler that
    /// clamps. `u` runs from 0 at the left edge to 1 at the right, `v` from the top to the bottom; points outside have the
    /// value of the nearest point inside.
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

/// The two of `count` texels between whose middles a position from 0 to 1 lies, and how far from the first to the second.
fn between(position: f64, count: usize) -> (usize, usize, f64) {
    let last = (count - 1) as f64;
    // In this order a position that is not a number is the first texel's.
    let x = (position * count as f64 - 0.5).max(0.0).min(last);
    let first = x as usize;
    (first, (first + 1).min(count - 1), x - first as f64)
}
