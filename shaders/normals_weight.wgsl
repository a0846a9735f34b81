// The mean of the weight of shadowing over triangles of visible normals. Needs normals_edge.wgsl.

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

/// The mean over a triangle of a weight that is tip at its tip, zero on its outer edge, which is on the horizon, and near
/// close to it: of tip (1 - s) / (1 - s + r s), r = rate (tip / near - 1), by a polynomial in sqrt r / (1 + sqrt r).
fn normals_to_horizon(tip: f32, near: f32, rate: f32) -> f32 {
    let root = sqrt(rate * near * max(tip - near, 0.0));
    let rest = near / max(near + root, 1e-36);
    let u = 1.0 - rest;
    let series = 2.0 + u * (-7.4062647 + u * (21.070869 + u * (-31.448433 + u * 16.743261)));
    return tip * rest * rest * (1.0 + u * series);
}

/// The direction of a triangle's centroid, by the integral of its normals.
fn normals_centroid(flux: vec3<f32>, tip: vec3<f32>) -> vec3<f32> {
    let m = normals_unit(flux);
    return select(m, -m, dot(m, tip) < 0.0);
}

/// A normal in a mean: what is seen of it (x), that times its weight, and that times Schlick's factor.
fn normals_sample(view: NormalsView, c: vec3<f32>) -> vec3<f32> {
    let at = normals_weight(view, c);
    let seen = max(dot(c, view.stretched), 0.0);
    return vec3(seen, seen * at.x, seen * at.x * at.y);
}

/// The great circle's arc from the tip of the triangles to a corner of the outline: where it ends, what it adds beyond the
/// plane triangle, and what its end adds to the mean of a triangle beside it.
struct NormalsSpoke {
    c: vec3<f32>,
    bend: vec3<f32>,
    at_end: vec3<f32>,
}

fn normals_spoke(view: NormalsView, tip: vec3<f32>, c: vec3<f32>, is_fine: bool) -> NormalsSpoke {
    return NormalsSpoke(c, normals_arc_bend(tip, c), select(0.08, 0.04, is_fine) * normals_sample(view, c));
}

/// The integral of the normals of the triangle between two spokes, whose outer side adds curved beyond the plane triangle.
fn normals_flux(tip: vec3<f32>, a: NormalsSpoke, b: NormalsSpoke, curved: vec3<f32>) -> vec3<f32> {
    return cross(a.c - tip, b.c - tip) + curved + (a.bend - b.bend);
}

/// What a triangle on an edge reflects, by its centroid, a normal beyond it and what its corners add to the mean.
fn normals_triangle(
    view: NormalsView,
    tip: vec3<f32>,
    corners: vec3<f32>,
    flux: vec3<f32>,
    is_fine: bool,
) -> vec2<f32> {
    let m = normals_centroid(flux, tip);
    let outer = m + 0.5 * (m - tip);
    let sum = normals_sample(view, m) + select(0.3, 0.2, is_fine) * normals_sample(view, outer) + corners;
    return dot(flux, view.stretched) / max(sum.x, 1e-18) * sum.yz;
}

/// What a triangle on the horizon reflects, by a normal near its outer edge and at_tip, the weight of its tip.
fn normals_horizon_triangle(
    view: NormalsView,
    tip: vec3<f32>,
    at_tip: vec2<f32>,
    flux: vec3<f32>,
    is_fine: bool,
) -> vec2<f32> {
    let m = normals_centroid(flux, tip);
    let near = normals_weight(view, m + 0.3 * (m - tip));
    let energy = normals_to_horizon(at_tip.x, near.x, select(0.155, 0.145, is_fine));
    return dot(flux, view.stretched) * energy * vec2(1.0, mix(near.y, at_tip.y, 0.25));
}
