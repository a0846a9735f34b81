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
/// falls (x), how far its sample is beyond the centroid (y), and the tip's part of Schlick's factor (z); and, where that is wide,
/// by how much a second sample counts in place of that fall's mean (x), and how far beyond the centroid it is (y), towards the tip
/// if negative.
struct NormalsNumbers {
    edge: vec3<f32>,
    horizon: vec3<f32>,
    inner: vec2<f32>,
}

/// Each is a sum of 1, the view's mu, the larger alpha and alpha mu, where the edge on or near the horizon is wide also of the
/// ratio of the alphas and ratio alpha, with the least error over random lights.
fn normals_numbers(view: NormalsView, wide: f32, is_fine: bool) -> NormalsNumbers {
    let mu = view.wo.z / view.length;
    let alpha = max(view.alpha.x, view.alpha.y);
    let at = vec4(1.0, mu, alpha, alpha * mu);
    let by_ratio = vec2(1.0, alpha) * (min(view.alpha.x, view.alpha.y) / alpha);
    var edge = mat4x3(
        0.01, 0.091, 0.643,
        0.494, -0.105, -0.07,
        0.326, -0.051, -0.335,
        -0.194, 0.253, -0.279,
    ) * at;
    var horizon = mat4x3(
        0.069, 0.272, 0.32,
        0.187, -0.173, -0.352,
        0.02, 0.133, 0.276,
        -0.022, -0.086, 0.206,
    ) * at;
    var wide_edge = mat4x3(
        -0.303, -0.001, 1.146,
        0.484, 0.01, -0.263,
        1.059, -0.078, -0.744,
        -0.565, 0.059, 0.218,
    ) * at + mat2x3(
        -0.076, -0.017, -0.263,
        0.531, 0.23, -0.369,
    ) * by_ratio;
    var wide_horizon = mat4x3(
        0.03, 0.484, 0.698,
        0.155, -0.201, -0.541,
        0.259, -0.096, -0.123,
        -0.116, 0.125, 0.685,
    ) * at + mat2x3(
        0.01, -0.012, 0.103,
        -0.164, -0.06, -0.169,
    ) * by_ratio;
    var inner = mat4x2(
        0.078, -0.863,
        -0.025, -0.268,
        0.422, 0.688,
        -0.025, 0.266,
    ) * at + mat2x2(
        0.051, 1.221,
        -0.225, -0.86,
    ) * by_ratio;
    if (is_fine) {
        edge = mat4x3(
            0.952, 0.077, 0.129,
            -0.667, -0.076, 0.436,
            -1.181, -0.007, 0.083,
            1.403, 0.141, -0.708,
        ) * at;
        horizon = mat4x3(
            0.074, 0.303, 0.297,
            0.198, -0.249, -0.32,
            0.0, 0.105, 0.311,
            -0.14, 0.162, 0.402,
        ) * at;
        wide_edge = mat4x3(
            0.061, -0.007, 0.653,
            0.135, 0.017, 0.23,
            0.495, -0.052, -0.327,
            -0.396, -0.014, -0.132,
        ) * at + mat2x3(
            -0.247, 0.002, -0.295,
            1.007, 0.246, -0.367,
        ) * by_ratio;
        wide_horizon = mat4x3(
            0.098, 0.413, 0.521,
            0.13, -0.148, -0.351,
            0.148, -0.007, 0.097,
            -0.114, 0.102, 0.526,
        ) * at + mat2x3(
            -0.042, 0.074, 0.202,
            -0.109, -0.133, -0.225,
        ) * by_ratio;
        inner = mat4x2(
            0.179, -0.736,
            -0.041, -0.213,
            0.263, 0.534,
            0.041, 0.183,
        ) * at + mat2x2(
            0.157, 0.869,
            -0.296, -0.469,
        ) * by_ratio;
    }
    return NormalsNumbers(
        max(mix(edge, wide_edge, wide), vec3(0.0)),
        max(mix(horizon, wide_horizon, wide), vec3(0.02, 0.0, 0.0)),
        vec2(wide * max(inner.x, 0.0), inner.y),
    );
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
