// The weight of shadowing of a visible normal, and the numbers by which its mean is taken. Needs normals_corner.wgsl.

/// G2 / G1, and Schlick's fifth power, for a normal c of any length.
fn normals_weight(view: NormalsView, c: vec3<f32>) -> vec2<f32> {
    let h = vec3(view.alpha * c.xy, c.z);
    let length2 = max(dot(h, h), 1e-36);
    let cosine = dot(view.wo, h);
    let wi = h * (2.0 * cosine) - view.wo * length2;
    let up = max(wi.z, 0.0);
    let across = view.alpha * wi.xy;
    let stretched = sqrt(dot(across, across) + wi.z * wi.z);
    let weight = (view.wo.z + view.length) * up / max(view.length * up + view.wo.z * stretched, 1e-36);
    let m = clamp(1.0 - cosine * inverseSqrt(length2), 0.0, 1.0);
    let m2 = m * m;
    return vec2(weight, m2 * m2 * m);
}

/// The numbers of a rule for a view: of a triangle on an edge how much its outer sample (x) and each corner of its outer side
/// (y) count beside its centroid, and how far the outer sample is beyond that (z); of one on the horizon how fast the weight
/// falls (x), how far its sample is beyond the centroid (y), and the tip's part of Schlick's factor (z).
struct NormalsNumbers {
    edge: vec3<f32>,
    horizon: vec3<f32>,
}

/// Each is linear in the view's mu and in the larger alpha, with the least error over random lights.
fn normals_numbers(view: NormalsView, is_fine: bool) -> NormalsNumbers {
    let mu = view.wo.z / view.length;
    let alpha = max(view.alpha.x, view.alpha.y);
    let at = vec4(1.0, mu, alpha, alpha * mu);
    var edge = mat4x3(
        0.492, 0.042, 0.45,
        -0.033, -0.052, 0.114,
        0.193, 0.044, -0.292,
        -0.188, 0.167, -0.296,
    ) * at;
    var horizon = mat4x3(
        0.103, 0.243, 0.267,
        0.112, -0.064, -0.205,
        0.087, 0.076, 0.295,
        -0.011, -0.137, 0.105,
    ) * at;
    if (is_fine) {
        edge = mat4x3(
            0.356, 0.062, 0.361,
            0.037, -0.065, 0.007,
            0.448, 0.028, -0.325,
            -0.008, 0.165, -0.161,
        ) * at;
        horizon = mat4x3(
            0.088, 0.282, 0.371,
            0.107, -0.077, -0.194,
            0.048, 0.074, 0.269,
            0.009, -0.129, 0.021,
        ) * at;
    }
    return NormalsNumbers(max(edge, vec3(0.0)), max(horizon, vec3(0.02, 0.0, 0.0)));
}

/// The mean over a triangle of a weight that is tip at its tip, zero on its outer edge, which is on the horizon, and near
/// close to it: of tip (1 - s) / (1 - s + r s), r = rate (tip / near - 1), by a polynomial in sqrt r / (1 + sqrt r).
fn normals_to_horizon(tip: f32, near: f32, rate: f32) -> f32 {
    let root = sqrt(rate * near * max(tip - near, 0.0));
    let rest = near / max(near + root, 1e-36);
    let u = 1.0 - rest;
    let series = 2.0 + u * (-7.4062647 + u * (21.070869 + u * (-31.448433 + u * 16.743261)));
    return tip * rest * rest * (1.0 + u * series);
}

/// A normal in a mean: what is seen of it (x), that times its weight, and that times Schlick's factor.
fn normals_sample(view: NormalsView, c: vec3<f32>) -> vec3<f32> {
    let at = normals_weight(view, c);
    let seen = max(dot(c, view.stretched), 0.0);
    return vec3(seen, seen * at.x, seen * at.x * at.y);
}

/// How far above the surface a normal reflects, times the length of its image squared.
fn normals_rise(view: NormalsView, c: vec3<f32>) -> f32 {
    let h = vec3(view.alpha * c.xy, c.z);
    return 2.0 * dot(view.wo, h) * h.z - dot(h, h) * view.wo.z;
}
