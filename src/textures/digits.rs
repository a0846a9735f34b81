//! Numbers as text, with the fewest digits that read back as the stored number.

use half::f16;

use ltcforge_fit::Precision;

/// The shortest decimal that reads back as `x`, which must be exact in the precision. For 32 bits, it must read back as
/// an f32. For 16 bits, it must give the half when read as a half, as an f32 that is then rounded, or as an f64. The
/// text is a valid number in JSON and JavaScript. With a decimal point, it is also valid in C, C# and Rust.
pub(super) fn shortest(x: f32, precision: Precision) -> String {
    let exponential = match precision {
        Precision::F32 => format!("{x:e}"),
        Precision::F16 => shortest_half(x),
    };
    plain(&exponential)
}

/// The shortest decimal of a half. Five digits distinguish all halves. For each length, the function tries the decimal
/// nearest to `x`.
fn shortest_half(x: f32) -> String {
    (0..=4)
        .map(|decimals| format!("{x:.decimals$e}"))
        .find(|text| reads_as(text, x))
        .unwrap_or_else(|| format!("{x:e}"))
}

/// Whether the text gives this half no matter how it is read. The text must not be halfway between two halves, because
/// engines round ties in different directions.
fn reads_as(text: &str, x: f32) -> bool {
    let (Ok(single), Ok(double)) = (text.parse::<f32>(), text.parse::<f64>()) else { return false };
    let bits = f16::from_f32_const(x).to_bits();
    let around = [double * (1.0 - 1e-5), double, double * (1.0 + 1e-5)];
    f16::from_f32_const(single).to_bits() == bits && around.iter().all(|y| f16::from_f64_const(*y).to_bits() == bits)
}

/// The text without an exponent if it is not much longer, such as `0.125` for `1.25e-1`. Exponents have no `+`.
fn plain(exponential: &str) -> String {
    let Some((mantissa, exponent)) = exponential.split_once('e') else { return exponential.to_owned() };
    let Ok(exponent) = exponent.parse::<i32>() else { return exponential.to_owned() };
    let (sign, mantissa) = mantissa.strip_prefix('-').map_or(("", mantissa), |rest| ("-", rest));
    let digits: String = mantissa.chars().filter(char::is_ascii_digit).collect();
    let digits = digits.trim_end_matches('0');
    let digits = if digits.is_empty() { "0" } else { digits };
    let count = i32::try_from(digits.len()).unwrap_or(i32::MAX);
    match exponent {
        // All digits are before the decimal point.
        _ if (count - 1..6).contains(&exponent) => {
            format!("{sign}{digits}{}", "0".repeat((exponent + 1 - count) as usize))
        }
        0..6 => {
            let (whole, part) = digits.split_at(exponent as usize + 1);
            format!("{sign}{whole}.{part}")
        }
        -4..0 => format!("{sign}0.{}{digits}", "0".repeat((-exponent - 1) as usize)),
        _ if count == 1 => format!("{sign}{digits}e{exponent}"),
        _ => format!("{sign}{}.{}e{exponent}", &digits[..1], &digits[1..]),
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn every_half_is_read_back_from_five_digits() {
        let mut lengths = [0_usize; 12];
        for bits in 0..=u16::MAX {
            let half = f16::from_bits(bits);
            if !half.is_finite() {
                continue;
            }
            let text = shortest(half.to_f32_const(), Precision::F16);
            let single: f32 = text.parse().unwrap_or_else(|_| panic!("{text}"));
            let double: f64 = serde_json::from_str(&text).unwrap_or_else(|_| panic!("{text} is not JSON"));
            assert_eq!(f16::from_f32_const(single).to_bits(), bits, "{text}");
            assert_eq!(f16::from_f64_const(double).to_bits(), bits, "{text}");
            // The text must be strictly nearer to this half than to its neighbours: some engines round ties away from
            // zero.
            for neighbour in [bits ^ 0x8000, bits.wrapping_add(1), bits.wrapping_sub(1)].map(f16::from_bits) {
                let (here, there) = ((double - half.to_f64_const()).abs(), (double - neighbour.to_f64_const()).abs());
                assert!(neighbour.is_nan() || half == neighbour || here < there, "{text} is not nearest to {half}");
            }
            let digits = text.split('e').next().unwrap_or_default().trim_start_matches(['-', '0', '.']);
            lengths[digits.chars().filter(char::is_ascii_digit).count()] += 1;
        }
        assert_eq!(lengths[6..].iter().sum::<usize>(), 0, "more than five digits: {lengths:?}");
        assert!(lengths[5] < 40_000, "most halves need fewer than five: {lengths:?}");
    }

    #[test]
    fn numbers_are_written_like_people_write_them() {
        for (x, single, half) in [
            (0.0, "0", "0"),
            (1.0, "1", "1"),
            (-0.5, "-0.5", "-0.5"),
            (65504.0, "65504", "65500"),
            (1234.0, "1234", "1234"),
            (0.1, "0.1", "0.1"),
            (1e-7, "1e-7", "1e-7"),
            (-1.5e-9, "-1.5e-9", "-0"),
            (1e20, "1e20", ""),
            (0.000_123_4, "0.0001234", "0.0001234"),
        ] {
            assert_eq!(shortest(x, Precision::F32), single);
            if !half.is_empty() {
                let stored = f16::from_f32_const(x).to_f32_const();
                assert_eq!(shortest(stored, Precision::F16), half);
            }
        }
    }

    proptest! {
        #[test]
        fn every_f32_is_read_back(x in prop::num::f32::NORMAL | prop::num::f32::SUBNORMAL | prop::num::f32::ZERO) {
            let text = shortest(x, Precision::F32);
            prop_assert_eq!(text.parse::<f32>().map(f32::to_bits), Ok(x.to_bits()), "{}", text);
            let double: f64 = serde_json::from_str(&text).expect("JSON");
            prop_assert_eq!((double as f32).to_bits(), x.to_bits(), "{}", text);
        }
    }
}
