//! The format of numbers in pictures.

/// A tick without the rounding error of its binary form. Domain: `tick > 0`.
pub(super) fn rounded(tick: f64) -> f64 {
    let scale = 10_f64.powi(3 - tick.log10().floor() as i32);
    (tick * scale).round() / scale
}

/// A number of bytes, with a unit that gives few digits.
pub(super) fn bytes(tick: f64) -> String {
    match tick {
        tick if tick >= 1e6 => format!("{} MB", rounded(tick / 1e6)),
        tick if tick >= 1e3 => format!("{} kB", rounded(tick / 1e3)),
        _ => format!("{} B", rounded(tick)),
    }
}
