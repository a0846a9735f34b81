//! False colours: black, purple, orange, pale yellow, each lighter than the one before.

use super::srgb;

/// Linear colours at even steps from 0 to 1; their luminance rises evenly.
const STOPS: [[f32; 3]; 5] =
    [[0.0, 0.0, 0.004], [0.10, 0.004, 0.20], [0.50, 0.038, 0.12], [0.95, 0.26, 0.012], [0.98, 0.97, 0.45]];

/// The colour of a value from 0 to 1; beyond, that of the nearest.
#[must_use]
pub fn colour(value: f32) -> [u8; 3] {
    let last = STOPS.len() - 1;
    let place = value.clamp(0.0, 1.0) * last as f32;
    let lower = (place as usize).min(last - 1);
    let weight = place - lower as f32;
    [0, 1, 2].map(|channel| srgb(STOPS[lower][channel] * (1.0 - weight) + STOPS[lower + 1][channel] * weight))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn larger_is_lighter() {
        let lightness = |value: f32| {
            let [r, g, b] = colour(value).map(|byte| (f32::from(byte) / 255.0).powf(2.2));
            0.2126 * r + 0.7152 * g + 0.0722 * b
        };
        for i in 0..64_u8 {
            let value = f32::from(i) / 64.0;
            assert!(lightness(value) < lightness(value + 1.0 / 64.0), "{value}");
        }
        assert_eq!(colour(7.0), colour(1.0));
    }
}
