//! False colours: one scale for amounts, and one for signed numbers.

use super::srgb;

/// Colour stops from 0 to 1 at even steps, in linear RGB: black, purple, orange, pale yellow. Luminance rises evenly.
const AMOUNTS: [[f32; 3]; 5] =
    [[0.0, 0.0, 0.004], [0.10, 0.004, 0.20], [0.50, 0.038, 0.12], [0.95, 0.26, 0.012], [0.98, 0.97, 0.45]];
/// Colour stops from -1 to 1 at even steps, in linear RGB: blue, light grey, red. Both ends are darker.
const SIGNED: [[f32; 3]; 5] =
    [[0.004, 0.03, 0.25], [0.08, 0.32, 0.72], [0.72, 0.72, 0.72], [0.74, 0.22, 0.08], [0.25, 0.006, 0.01]];

/// The colour of an amount from 0 to 1. Values outside have the colour of the nearest end.
#[must_use]
pub fn colour(value: f32) -> [u8; 3] {
    between(&AMOUNTS, value)
}

/// The colour of a number from -1 to 1, neutral at zero. Values outside have the colour of the nearest end.
#[must_use]
pub fn signed_colour(value: f32) -> [u8; 3] {
    between(&SIGNED, 0.5 * (value + 1.0))
}

fn between(stops: &[[f32; 3]; 5], value: f32) -> [u8; 3] {
    let last = stops.len() - 1;
    let place = value.clamp(0.0, 1.0) * last as f32;
    let lower = (place as usize).min(last - 1);
    let weight = place - lower as f32;
    [0, 1, 2].map(|channel| srgb(stops[lower][channel] * (1.0 - weight) + stops[lower + 1][channel] * weight))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lightness(colour: [u8; 3]) -> f32 {
        let [r, g, b] = colour.map(|byte| (f32::from(byte) / 255.0).powf(2.2));
        0.2126 * r + 0.7152 * g + 0.0722 * b
    }

    #[test]
    fn larger_amounts_are_lighter() {
        for i in 0..64_u8 {
            let value = f32::from(i) / 64.0;
            assert!(lightness(colour(value)) < lightness(colour(value + 1.0 / 64.0)), "{value}");
        }
        assert_eq!(colour(7.0), colour(1.0));
    }

    #[test]
    fn zero_is_grey_and_both_ends_are_darker_and_bluer_or_redder() {
        let [r, g, b] = signed_colour(0.0);
        assert!(r == g && g == b);
        for i in 0..64_u8 {
            let (near, far) = (f32::from(i) / 64.0, (f32::from(i) + 1.0) / 64.0);
            assert!(lightness(signed_colour(far)) < lightness(signed_colour(near)), "{near}");
            assert!(lightness(signed_colour(-far)) < lightness(signed_colour(-near)), "-{near}");
            let ([red, _, blue], [low_red, _, low_blue]) = (signed_colour(far), signed_colour(-far));
            assert!(red > blue && low_blue > low_red, "{far}");
        }
        assert_eq!(signed_colour(-7.0), signed_colour(-1.0));
    }
}
