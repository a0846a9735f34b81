//! Number formats in pictures.

/// A tick value without binary rounding errors. Domain: `tick > 0`.
pub(super) fn rounded(tick: f64) -> f64 {
    let scale = 10_f64.powi(3 - tick.log10().floor() as i32);
    (tick * scale).round() / scale
}

/// A number of bytes, with a unit that keeps the number short.
pub(super) fn bytes(tick: f64) -> String {
    match tick {
        tick if tick >= 1e6 => format!("{} MB", rounded(tick / 1e6)),
        tick if tick >= 1e3 => format!("{} kB", rounded(tick / 1e3)),
        _ => format!("{} B", rounded(tick)),
    }
}
