//! The sRGB curve from linear values to bytes.

use std::sync::LazyLock;

/// For each byte above zero, the least linear value that rounds to it.
static STEPS: LazyLock<[f32; 255]> = LazyLock::new(|| {
    std::array::from_fn(|step| {
        // The bits of non-negative floats have the same order as the floats.
        let (mut below, mut at) = (0, 1.0_f32.to_bits());
        while at - below > 1 {
            let middle = below + (at - below) / 2;
            if usize::from(curve(f32::from_bits(middle))) > step {
                at = middle;
            } else {
                below = middle;
            }
        }
        f32::from_bits(at)
    })
});

/// The sRGB curve [IEC 61966-2-1] of a linear value in [0, 1], as a byte. Other values are clamped.
#[must_use]
pub fn srgb(linear: f32) -> u8 {
    // Eight comparisons replace a call of `powf`, which would take a fifth of the rendering time.
    STEPS.partition_point(|step| *step <= linear) as u8
}

fn curve(linear: f32) -> u8 {
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

    #[test]
    fn steps_follow_the_curve() {
        let everywhere = (0..=100_000_u32).map(|i| i as f32 / 1e5);
        let around = STEPS.iter().flat_map(|step| [step.next_down(), *step, step.next_up()]);
        for linear in everywhere.chain(around) {
            assert_eq!(srgb(linear), curve(linear), "{linear}");
        }
    }
}
