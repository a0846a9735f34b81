//! The coefficients of the polynomials. `cargo run --release -p ltcforge-studies -- formula` finds them.

use super::COUNT;

/// The coefficients.
#[expect(clippy::approx_constant, reason = "a fitted number is close to the root of one half")]
pub const COEFFICIENTS: [f64; COUNT] = [
    0.3798, 0.8316, 0.2164, 0.383, -0.8155, 0.2994, -0.442, -0.224, -1.902, 2.659, -1.669, 1.386, 2.915, -4.753, 2.314,
    1.828, 2.587, -0.7071, -1.424, -1.929, -0.5785, 1.313, -3.626, 4.163, -0.3537, -1.38, 1.422, 0.7947, 0.08377,
    0.2033, 2.063, -2.241, 2.366, 2.077, 6.067, -1.531, 0.4012, -0.8814, 0.4719, 0.2113, -0.5783, 0.3696, 0.09071,
    -1.52, 0.6974, -0.2018, 1.564, -1.388, -0.757, -0.1749, 0.8054, 0.3681, 0.1433, 0.9516,
];
