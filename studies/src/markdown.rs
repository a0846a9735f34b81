//! Number formats for the docs.

use crate::lights::Spread;

/// A number with `digits` significant digits, without a zero before the decimal point.
#[must_use]
pub fn short(x: f64, digits: i32) -> String {
    if x == 0.0 {
        return "0".to_owned();
    }
    let first = x.abs().log10().floor() as i32;
    let behind = (digits - 1 - first).max(0);
    let text = format!("{x:.*}", behind as usize);
    text.strip_prefix('0').filter(|rest| rest.starts_with('.')).map_or(text.clone(), str::to_owned)
}

/// The mean, 95th percentile and largest error as text.
#[must_use]
pub fn spread(Spread { mean, p95, max, .. }: Spread) -> String {
    [mean, p95, max].map(|x| short(x, 2)).join(" / ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_digits_count() {
        let texts = [0.000_273, 0.0121, 0.076_9, 1.26, 13.2, 0.0].map(|x| short(x, 2));
        assert_eq!(texts, [".00027", ".012", ".077", "1.3", "13", "0"]);
    }
}
