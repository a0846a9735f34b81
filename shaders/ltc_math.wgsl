// Angles in plain arithmetic. A driver's atan2 may be off by 4096 ulps and its sin by 2^-11. A sharp lobe is narrower
// than these errors. The polynomials here (Cephes: atanf, sinf, cosf) are the same on every GPU.

/// The angle of (x, y) from +x, in [0, pi]; y >= 0. Error below 4e-7. Zero for the zero vector.
fn ltc_atan2(y: f32, x: f32) -> f32 {
    let low = min(y, abs(x));
    let high = max(y, abs(x));
    // Above tan(pi / 8), the polynomial gives the difference from pi / 4.
    let is_far = low > 0.41421356 * high;
    let t = select(low, low - high, is_far) / max(select(high, low + high, is_far), 1e-37);
    let z = t * t;
    let near = (((0.08053744 * z - 0.13877685) * z + 0.1997771) * z - 0.3333295) * z * t + t;
    let eighth = select(near, near + 0.78539816, is_far);
    let quarter = select(eighth, 1.57079633 - eighth, y > abs(x));
    return select(quarter, 3.14159265 - quarter, x < 0.0);
}

/// Sine and cosine of an angle in turns. Error below 2e-7.
fn ltc_sin_cos(turns: f32) -> vec2<f32> {
    let quarter = floor(4.0 * turns + 0.5);
    let x = (turns - 0.25 * quarter) * 6.2831853;
    let z = x * x;
    let s = ((-1.9515296e-4 * z + 8.332161e-3) * z - 0.16666655) * z * x + x;
    let c = ((2.4433157e-5 * z - 1.3887316e-3) * z + 4.1666646e-2) * z * z - 0.5 * z + 1.0;
    let q = u32(i32(quarter)) & 3u;
    let swapped = select(vec2(s, c), vec2(c, s), (q & 1u) == 1u);
    return vec2(select(swapped.x, -swapped.x, q >= 2u), select(swapped.y, -swapped.y, q == 1u || q == 2u));
}

/// The natural logarithm of a positive normal number, by the series of artanh((m - 1) / (m + 1)). Error below 3e-7 of
/// the result.
fn ltc_log(x: f32) -> f32 {
    // 0x3f3504f3 is sqrt(1/2): x = m 2^e with m from sqrt(1/2) to sqrt(2).
    let bits = bitcast<i32>(x) - 0x3f3504f3;
    let m = bitcast<f32>((bits & 0x007fffff) + 0x3f3504f3);
    let s = (m - 1.0) / (m + 1.0);
    let z = s * s;
    let series = (((0.22222222 * z + 0.2857143) * z + 0.4) * z + 0.6666667) * z * s + 2.0 * s;
    return f32(bits >> 23u) * 0.69314718 + series;
}
