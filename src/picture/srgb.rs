//! The curve from linear values to bytes.

/// The sRGB curve [IEC 61966-2-1] of a linear value in [0, 1], as a byte.
#[must_use]
pub fn srgb(linear: f32) -> u8 {
    let curved = if linear <= 0.003_130_8 { 12.92 * linear } else { 1.055 * libm::powf(linear, 1.0 / 2.4) - 0.055 };
    (curved.clamp(0.0, 1.0) * 255.0 + 0.5) as u8
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_curve_has_its_ends_and_its_middle() {
        assert_eq!([0.0, 1.0, 7.0, -1.0, f32::NAN].map(srgb), [0, 255, 255, 0, 0]);
        assert_eq!(srgb(0.5), 188);
    }
}
