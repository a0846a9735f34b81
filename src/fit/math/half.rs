//! Half floats, IEEE 754 binary16.

/// The bits of the nearest half float, ties to even. Values of 65,520 or more become infinite.
#[must_use]
pub fn half_bits(x: f32) -> u16 {
    const INFINITE: u32 = 0x7f80_0000;
    const TWO_TO_16: u32 = 0x4780_0000;
    const LEAST_NORMAL: u32 = 0x3880_0000;
    // Exponents have a bias of 127 in f32 and of 15 in f16.
    const BIAS: u32 = (127 - 15) << 23;
    let magnitude = x.to_bits() & 0x7fff_ffff;
    let bits = if magnitude > INFINITE {
        0x7e00 | (magnitude >> 13) & 0x3ff
    } else if magnitude >= TWO_TO_16 {
        0x7c00
    } else if magnitude >= LEAST_NORMAL {
        (magnitude - BIAS + 0xfff + ((magnitude >> 13) & 1)) >> 13
    } else {
        // Subnormal numbers are multiples of 2^-24. The addition rounds, because the sum has no bits below one step.
        let rounded = f32::from_bits(magnitude) * 16_777_216.0 + 8_388_608.0;
        rounded.to_bits() & 0x7f_ffff
    };
    bits as u16 | (x.to_bits() >> 16) as u16 & 0x8000
}

/// The bits of the nearest half float. The lower half of the mantissa is cut off first, so numbers just beyond a
/// midpoint count as the midpoint.
#[must_use]
pub fn half_bits_f64(x: f64) -> u16 {
    let cut = if x.is_nan() { x } else { f64::from_bits(x.to_bits() & !0xffff_ffff) };
    half_bits(cut as f32)
}

/// The value of a half float.
#[must_use]
pub fn from_half_bits(bits: u16) -> f32 {
    let magnitude = u32::from(bits) & 0x7fff;
    let x = match magnitude >> 10 {
        0 => magnitude as f32 / 16_777_216.0,
        31 => f32::from_bits(0x7f80_0000 | (magnitude & 0x3ff) << 13),
        _ => f32::from_bits((magnitude << 13) + ((127 - 15) << 23)),
    };
    if bits & 0x8000 == 0 { x } else { -x }
}

#[cfg(test)]
mod tests {
    use half::f16;

    use super::*;

    #[test]
    fn halves_and_numbers_near_and_between_them_match_the_crate() {
        for bits in 0..=u16::MAX {
            let (x, wanted) = (from_half_bits(bits), f16::from_bits(bits).to_f32_const());
            assert!(x.to_bits() == wanted.to_bits() || x.is_nan() && wanted.is_nan(), "{bits:x}: {x} {wanted}");
            let middle = 0.5 * (x + from_half_bits(bits.wrapping_add(1)));
            for base in [x, middle] {
                for y in [-1_i64, 0, 1].map(|step| f32::from_bits((i64::from(base.to_bits()) + step) as u32)) {
                    assert_eq!(half_bits(y), f16::from_f32_const(y).to_bits(), "{y:e}");
                    let z = f64::from_bits(f64::from(y).to_bits() + 1);
                    assert_eq!(half_bits_f64(z), f16::from_f64_const(z).to_bits(), "{z:e}");
                }
            }
        }
    }
}
