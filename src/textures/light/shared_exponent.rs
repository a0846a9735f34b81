//! RGB9E5: three numbers of nine bits and a shared exponent, in four bytes per texel \[`EXT_texture_shared_exponent`\].

/// The largest number, `511 / 512 2^16`.
pub(super) const LARGEST: f32 = 65_408.0;

/// Bits of a number, and the bias of the exponent.
const BITS: i32 = 9;
const BIAS: i32 = 15;

/// Packs a texel. The largest number is rounded to nine bits, and the other two have the same step. Numbers above
/// [`LARGEST`] become [`LARGEST`]. Domain: finite numbers of at least zero.
pub(super) fn pack(texel: [f32; 3]) -> u32 {
    let texel = texel.map(|x| f64::from(x.min(LARGEST)));
    let largest = texel[0].max(texel[1]).max(texel[2]);
    // The exponent of the largest number, taken from its bits. This is exact on every machine.
    let floor = ((largest as f32).to_bits() >> 23).cast_signed() - 127;
    let exponent = floor.max(-BIAS - 1) + 1 + BIAS;
    let steps = |exponent: i32| texel.map(|x| (x * step(exponent).recip()).round_ties_even() as u32);
    let is_whole = steps(exponent).iter().all(|steps| *steps < 1 << BITS);
    // Rounding can raise the largest number to the next power of two.
    let exponent = if is_whole { exponent } else { exponent + 1 };
    let [r, g, b] = steps(exponent);
    r | g << 9 | b << 18 | (exponent as u32) << 27
}

/// The numbers of a packed texel.
pub(super) fn unpack(packed: u32) -> [f32; 3] {
    let step = step((packed >> 27).cast_signed());
    [0, 9, 18].map(|shift| (f64::from(packed >> shift & 0x1ff) * step) as f32)
}

/// The step between numbers, for an exponent. It is a power of two.
fn step(exponent: i32) -> f64 {
    f64::from_bits(((1023 + exponent - BIAS - BITS) as u64) << 52)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The error is at most half a step. The largest number has at least 256 steps.
    const ERROR: f32 = 0.5 / 256.0;

    #[test]
    fn packed_texels_are_as_near_as_nine_bits_allow() {
        let mut x = 1e-9_f32;
        while x < LARGEST {
            for texel in [[x, 0.0, 0.0], [0.3 * x, x, 0.999 * x], [x; 3], [1e-9, 1e-3 * x, x]] {
                let found = unpack(pack(texel));
                for (a, b) in texel.iter().zip(found) {
                    // At the smallest exponent, the step is 2^-24.
                    assert!((a - b).abs() <= (ERROR * x).max(0.5_f32.powi(25)), "{texel:?} {found:?}");
                }
            }
            x *= 1.037;
        }
    }

    #[test]
    fn numbers_of_nine_bits_are_unchanged() {
        for texel in [[0.0; 3], [LARGEST; 3], [1.0, 0.5, 0.25], [511.0, 1.0, 256.0], [5.960_464_5e-8, 0.0, 0.0]] {
            assert_eq!(unpack(pack(texel)), texel);
        }
        assert_eq!(unpack(pack([1e9, 0.0, 0.0])), [LARGEST, 0.0, 0.0]);
        // An example of the specification: one half is 256 steps of 2^-9, with exponent 0.
        assert_eq!(pack([0.5, 0.0, 0.0]), 256 | 15 << 27);
        // 511.75 of 512 rounds up into the next exponent.
        assert_eq!(unpack(pack([0.999_8, 0.0, 0.0])), [1.0, 0.0, 0.0]);
    }
}
