// Angles of directions in the first quadrant, to find the place of an entry. They are precise enough for interpolation
// weights.

/// The angles from +x to vectors in the first quadrant. Error below 4e-7 [ltcforge-studies, polynomials].
fn ltc_quadrant(y: vec2<f32>, x: vec2<f32>) -> vec2<f32> {
    let t = (y - x) / (y + x);
    let z = t * t;
    let tail = ((0.0068118 * z - 0.0336042) * z + 0.0796237) * z - 0.1323334;
    return 0.78539816 + t * (((tail * z + 0.1980782) * z - 0.3331737) * z + 0.9999961);
}
