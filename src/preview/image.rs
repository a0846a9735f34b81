//! Pictures: radiance, and bytes to display.

use super::PreviewError;

/// What a lobe's picture holds beside the sphere of directions, as in `sphere.wgsl`.
pub(super) const BESIDE: f32 = -1.0;
/// And where nothing is below its horizon.
pub(super) const BELOW: f32 = -0.5;

/// Linear values of a picture's pixels, row by row from the top.
#[derive(Debug, Clone, PartialEq)]
pub struct Radiances {
    /// Pixels in a row.
    pub width: u32,
    /// Red, green and blue, linear sRGB; a lobe's density in all three.
    pub pixels: Vec<[f32; 3]>,
}

/// Bytes to display, sRGB.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Picture {
    /// Pixels in a row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Red, green and blue of each pixel, row by row from the top.
    pub rgb: Vec<[u8; 3]>,
}

impl Picture {
    /// A picture of one colour.
    pub(super) fn filled(width: u32, height: u32, colour: [u8; 3]) -> Self {
        Self { width, height, rgb: vec![colour; (width * height) as usize] }
    }

    /// Copies `part` to where its left upper corner is `(left, top)`. What lies outside is left out.
    pub(super) fn put(&mut self, part: &Self, left: u32, top: u32) {
        for y in 0..part.height.min(self.height.saturating_sub(top)) {
            let width = part.width.min(self.width.saturating_sub(left)) as usize;
            let from = (y * part.width) as usize;
            let to = ((top + y) * self.width + left) as usize;
            self.rgb[to..to + width].copy_from_slice(&part.rgb[from..from + width]);
        }
    }

    /// The picture as a PNG file. Equal pictures give equal bytes.
    ///
    /// # Errors
    /// [`PreviewError::Png`] for a picture without pixels.
    pub fn png(&self) -> Result<Vec<u8>, PreviewError> {
        let mut bytes = Vec::new();
        let failed = |error: png::EncodingError| PreviewError::Png(error.to_string());
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
