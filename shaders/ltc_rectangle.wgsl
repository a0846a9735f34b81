// Integrates a Linearly Transformed Cosine over a rectangle. Corners are relative to the shaded point, in its tangent
// frame, normal +z. They run clockwise as seen from the side that emits.

/// The inverse of M up to a positive factor, which does not change directions.
struct LtcInverse {
    m: mat3x3<f32>,
    /// -1 if M mirrors, which reverses the order of vertices. 0 if M has no inverse; no light is reflected then.
    side: f32,
}

/// The vector scaled to unit length; zero for a zero vector.
fn ltc_unit(v: vec3<f32>) -> vec3<f32> {
    return v * inverseSqrt(dot(v, v) + 1e-36);
}

/// The angle between two unit vectors divided by its sine, minus one. Error below 2.5e-5 h / sin(h), where h is half
/// the angle. The sum of the vectors stays precise up to an angle of 180 degrees; their dot product does not
/// [ltcforge-studies, polynomials].
fn ltc_bend(a: vec3<f32>, b: vec3<f32>) -> f32 {
    let sum = a + b;
    let k = dot(sum, sum) + 1e-18;
    return (3.1415927 + (0.3824614 + 0.0361113 * k) * k) * inverseSqrt(k) - (1.9987368 + (0.1384879 + 0.0044966 * k) * k);
}

/// acos(a . b) (a x b).z / |a x b| minus (a x b).z.
fn ltc_arc(a: vec3<f32>, b: vec3<f32>) -> f32 {
    return (a.x * b.y - a.y * b.x) * ltc_bend(a, b);
}

/// (a x b).z, computed relative to an origin. The sum over a closed outline does not depend on the origin. With an origin
/// near a small light, each term is as small as the sum. Otherwise rounding errors would be larger than the sum.
fn ltc_chord(a: vec3<f32>, b: vec3<f32>, origin: vec3<f32>) -> f32 {
    let p = a.xy - origin.xy;
    let q = b.xy - origin.xy;
    return p.x * q.y - p.y * q.x;
}

/// The covered part of the lobe for a rectangle or parallelogram. The last corner is not read.
///
/// The part above the horizon has at most five corners: the highest corner; the two corners next to it, moved up to the
/// horizon if they are below it; and the points where both paths from the lowest corner cross the horizon. If nothing is
/// cut off, both points are the lowest corner. All five move continuously with the light.
fn ltc_exact_rectangle(inverse: LtcInverse, corners: array<vec3<f32>, 4>, two_sided: bool) -> f32 {
    var x = inverse.m * (corners[1] - corners[0]);
    var y = inverse.m * (corners[2] - corners[1]);
    let falls = vec2(x.z, y.z) < vec2(0.0);
    let turn = select(vec2(1.0), vec2(-1.0), falls);
    x *= turn.x;
    y *= turn.y;
    let lowest = inverse.m * corners[0] + x * (0.5 * turn.x - 0.5) + y * (0.5 * turn.y - 0.5);
    let a = lowest + x;
    let b = lowest + y;
    let highest = a + y;
    // The fraction of each edge that is below the horizon.
    let per_height = vec2(1.0) / max(vec2(x.z, y.z), vec2(1e-36));
    let low = clamp(-lowest.z * per_height, vec2(0.0), vec2(1.0));
    let last_x = clamp(-b.z * per_height.x, 0.0, 1.0);
    let last_y = clamp(-a.z * per_height.y, 0.0, 1.0);
    let d = ltc_unit(lowest + low.y * y + last_x * x);
    let e = ltc_unit(lowest + low.x * x + last_y * y);
    let f = ltc_unit(a + last_y * y);
    let g = ltc_unit(highest);
    let h = ltc_unit(b + last_x * x);
    let sum = ltc_chord(h, d, g) + ltc_chord(d, e, g) + ltc_chord(e, f, g)
        + ltc_arc(d, e) + ltc_arc(e, f) + ltc_arc(f, g) + ltc_arc(g, h) + ltc_arc(h, d);
    let covered = sum * 0.15915494 * (inverse.side * turn.x * turn.y);
    return select(0.0, clamp(select(covered, abs(covered), two_sided), 0.0, 1.0), highest.z > 0.0);
}
