//! Radiance, pixel by pixel.

/// The value of a lobe's picture outside the sphere of directions, as in `sphere.wgsl`.
pub(super) const BESIDE: f32 = -1.0;
/// The value of a lobe's picture below the horizon, where the lobe is zero.
pub(super) const BELOW: f32 = -0.5;

/// Linear values of a picture's pixels, row by row from the top.
#[derive(Debug, Clone, PartialEq)]
pub struct Radiances {
    /// Pixels in a row.
    pub width: u32,
    /// Red, green and blue, linear sRGB. A lobe's density is in all three.
    pub pixels: Vec<[f32; 3]>,
}
