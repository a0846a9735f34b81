//! Radiance, pixel by pixel.

/// Marks pixels outside the sphere of directions in the picture of a lobe, as in `sphere.wgsl`.
pub(super) const BESIDE: f32 = -1.0;
/// Marks directions below the horizon in the picture of a lobe. The lobe is zero there.
pub(super) const BELOW: f32 = -0.5;

/// Linear values of a picture's pixels, row by row from the top.
#[derive(Debug, Clone, PartialEq)]
pub struct Radiances {
    /// Width in pixels.
    pub width: u32,
    /// Red, green and blue, linear sRGB. All three hold the density of a lobe.
    pub pixels: Vec<[f32; 3]>,
}
