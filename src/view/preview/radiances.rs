//! Radiance, pixel by pixel.

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
