// The visible normals of GGX that reflect the corners of a light: their images, and arcs between them.

/// A surface seen from a direction.
struct NormalsView {
    alpha: vec2<f32>,
    /// 1 / alpha.
    per_alpha: vec2<f32>,
    wo: vec3<f32>,
    /// A wo with A = diag(alpha, 1), and its length.
    stretched: vec3<f32>,
    length: f32,
}

/// A corner of a light's outline.
struct NormalsCorner {
    /// Its direction.
    w: vec3<f32>,
    /// Its image among the normals, A^-1 (wo + w), at length one.
    c: vec3<f32>,
    /// The image's length before.
    length: f32,
    /// How high above the surface it is.
    height: f32,
}

/// alpha in (0, 1]; wo of unit length in the tangent frame.
fn normals_view(alpha_x: f32, alpha_y: f32, wo: vec3<f32>) -> NormalsView {
    let alpha = max(vec2(alpha_x, alpha_y), vec2(1e-5));
    let stretched = vec3(alpha * wo.xy, wo.z);
    return NormalsView(alpha, 1.0 / alpha, wo, stretched, sqrt(dot(stretched, stretched)));
}

/// A^-1 h.
fn normals_unstretched(h: vec3<f32>, view: NormalsView) -> vec3<f32> {
    return vec3(h.xy * view.per_alpha, h.z);
}

fn normals_unit(v: vec3<f32>) -> vec3<f32> {
    let length2 = dot(v, v);
    return v * select(0.0, inverseSqrt(max(length2, 1e-36)), length2 > 1e-36);
}

fn normals_corner(v: vec3<f32>, view: NormalsView) -> NormalsCorner {
    let w = normals_unit(v);
    let c = normals_unstretched(view.wo + w, view);
    let length2 = max(dot(c, c), 1e-36);
    let per_length = inverseSqrt(length2);
    return NormalsCorner(w, c * per_length, length2 * per_length, v.z);
}

/// The first of two corners, or the second.
fn normals_choose(first: NormalsCorner, second: NormalsCorner, is_second: bool) -> NormalsCorner {
    return NormalsCorner(
        select(first.w, second.w, is_second),
        select(first.c, second.c, is_second),
        select(first.length, second.length, is_second),
        select(first.height, second.height, is_second),
    );
}

/// The cosine of half the angle between two corners.
fn normals_half_cosine(a: NormalsCorner, b: NormalsCorner) -> f32 {
    let sum = a.w + b.w;
    return max(0.5 * sqrt(dot(sum, sum)), 1e-6);
}

/// The corner at t of the edge from a to b, by the parameter of its image as a rational curve with unit ends.
fn normals_between(a: NormalsCorner, b: NormalsCorner, t: f32, view: NormalsView) -> NormalsCorner {
    let x = (1.0 - t) * sqrt(b.length);
    let y = t * sqrt(a.length);
    let middle = (a.w + b.w) * (x * y / normals_half_cosine(a, b));
    return normals_corner(a.w * (x * x) + middle + b.w * (y * y), view);
}

/// Angles over their sines, less one, by the squares of their chords, for up to a right angle. Finite beyond, but too small.
fn normals_acute_bend(chord2: vec2<f32>) -> vec2<f32> {
    let z = chord2 * 0.25;
    let far = z * (2.271551 + z * (-3.4068607 + z * 3.5164571));
    return z * (0.66675535 + z * (0.52912637 + z * (0.52405584 + z * (-0.08954556 + far))));
}

/// a x b (acos(a . b) / |a x b| - 1): what the great circle's arc from a to b adds to a x b.
fn normals_arc_bend(a: vec3<f32>, b: vec3<f32>) -> vec3<f32> {
    let across = cross(a, b);
    let is_acute = dot(a, b) >= 0.0;
    let chord = select(a + b, a - b, is_acute);
    let bend = normals_acute_bend(vec2(dot(chord, chord))).x;
    let obtuse = 3.14159265 / sqrt(max(dot(across, across), 1e-18)) - bend - 2.0;
    return across * select(obtuse, bend, is_acute);
}

/// What each of two parts, from a to m and from m to b, adds beyond its plane triangle, of the image of an edge whose whole is
/// known: the great circle's arc, and of what the arcs leave a share by the cube of the chord. The shares decide only which
/// part has which weight: what the bend lacks beyond a right angle is in the rest.
fn normals_shared(a: vec3<f32>, m: vec3<f32>, b: vec3<f32>, whole: vec3<f32>) -> mat2x3<f32> {
    let length2 = vec2(dot(m - a, m - a), dot(b - m, b - m));
    let bend = normals_acute_bend(length2);
    let arc = cross(a, m) * bend.x;
    let next = cross(m, b) * bend.y;
    let rest = whole - cross(m - a, b - a) - arc - next;
    let cubes = length2 * sqrt(length2);
    let shares = cubes / max(cubes.x + cubes.y, 1e-36);
    return mat2x3(arc + rest * shares.x, next + rest * shares.y);
}
