//! Pictures in sRGB, and their encoding as PNG.

/// The picture could not be written as PNG.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("PNG: {0}")]
pub struct PngError(String);

/// A picture in sRGB, with 8 bits per channel.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Picture {
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// Red, green and blue of each pixel, row by row from the top.
    pub rgb: Vec<[u8; 3]>,
}

impl Picture {
    /// A picture of one colour.
    #[must_use]
    pub fn filled(width: u32, height: u32, colour: [u8; 3]) -> Self {
        Self { width, height, rgb: vec![colour; (width * height) as usize] }
    }

    /// Copies `part` so that its upper left corner is at `(left, top)`. Pixels outside the picture are dropped.
    pub fn put(&mut self, part: &Self, left: u32, top: u32) {
        for y in 0..part.height.min(self.height.saturating_sub(top)) {
            let width = part.width.min(self.width.saturating_sub(left)) as usize;
            let from = (y * part.width) as usize;
            let to = ((top + y) * self.width + left) as usize;
            self.rgb[to..to + width].copy_from_slice(&part.rgb[from..from + width]);
        }
    }

    /// Blends a pixel towards white by `coverage` (0 to 1), in sRGB values. A pixel outside the picture is ignored.
    pub(super) fn blend_white(&mut self, x: f32, y: f32, coverage: f32) {
        if x < 0.0 || y < 0.0 || x >= self.width as f32 || y >= self.height as f32 {
            return;
        }
        for channel in &mut self.rgb[(y as u32 * self.width + x as u32) as usize] {
            let dark = f32::from(*channel);
            *channel = (dark + coverage.clamp(0.0, 1.0) * (255.0 - dark)).round() as u8;
        }
    }

    /// The picture as a PNG file. Equal pictures give equal bytes.
    ///
    /// # Errors
    /// [`PngError`] for a picture without pixels.
    pub fn png(&self) -> Result<Vec<u8>, PngError> {
        let mut bytes = Vec::new();
        let failed = |error: png::EncodingError| PngError(error.to_string());
        let mut encoder = png::Encoder::new(&mut bytes, self.width, self.height);
        encoder.set_color(png::ColorType::Rgb);
        encoder.set_depth(png::BitDepth::Eight);
        encoder.set_source_srgb(png::SrgbRenderingIntent::RelativeColorimetric);
        let mut writer = encoder.write_header().map_err(failed)?;
        writer.write_image_data(self.rgb.as_flattened()).map_err(failed)?;
        writer.finish().map_err(failed)?;
        Ok(bytes)
    }
}
