//! The tone curve from radiance to bytes: exposure, `1 - exp(-x)`, the sRGB curve, rounding to 8 bits. It is the same
//! in all modes.

use rayon::prelude::*;

use super::Radiances;
use crate::picture::{Picture, srgb};

/// The displayed byte for a radiance.
pub(super) fn display(exposure: f32, radiance: f32) -> u8 {
    srgb(1.0 - (-exposure * radiance.max(0.0)).exp())
}

/// The picture of tone-mapped radiances.
pub(super) fn displayed(exposure: f32, radiances: &Radiances) -> Picture {
    let rgb: Vec<[u8; 3]> =
        radiances.pixels.par_iter().map(|pixel| pixel.map(|channel| display(exposure, channel))).collect();
    Picture { width: radiances.width, height: rgb.len() as u32 / radiances.width, rgb }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn black_white_and_the_middle() {
        assert_eq!(display(1.0, 0.0), 0);
        assert_eq!(display(1.0, -1.0), 0);
        assert_eq!(display(1.0, 100.0), 255);
        // 1 - exp(-ln 2) = 1/2, which is byte 188 in sRGB.
        assert_eq!(display(2.0, 0.5 * std::f32::consts::LN_2), 188);
    }
}
