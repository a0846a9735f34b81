export default /* wgsl */ `// SPDX-License-Identifier: MIT OR Apache-2.0
// Area lights on GGX without a table, in the space of its normals, by rule balanced. Made by ltcforge 0.1.0.
//
//   normals_view(alpha_x, alpha_y, wo)  once for a point and view: roughness, and the view in the tangent frame, normal +z.
//   normals_rectangle, normals_polygon, normals_disk  for each light. Vertices are relative to the point in that frame and
//       run clockwise seen from the lit side. Light of radiance L arrives as L (f0 (x - y) + f90 y).
//
// Check, of the rectangle (-1 -1 1) (1 -1 1) (1 1.5 -0.5) (-1 1.5 -0.5), alpha_x alpha_y (wo): x y, within 0.00002
//   0.3 0.15 (0.36 0.48 0.8): 0.698486 0.000198
//   0.2 0.6 (-0.64 0.48 0.6): 0.546075 0.003081
//   0.05 0.02 (0.576 -0.768 0.28): 0.989197 0.187579

/// A surface seen from a direction. A = diag(alpha, 1).
struct NormalsView {
    alpha: vec2<f32>,
    per_alpha: vec2<f32>,
    wo: vec3<f32>,
    image: vec3<f32>, // A^-1 wo
    stretched: vec3<f32>, // A wo
    length: f32, // of A wo
    rise: f32, // of wo
}

/// alpha in (0, 1]; wo of length one in the tangent frame.
fn normals_view(alpha_x: f32, alpha_y: f32, wo: vec3<f32>) -> NormalsView {
    let alpha = max(vec2(alpha_x, alpha_y), vec2(1e-5));
    let stretched = vec3(alpha * wo.xy, wo.z);
    let length = sqrt(dot(stretched, stretched));
    return NormalsView(alpha, 1.0 / alpha, wo, vec3(wo.xy / alpha, wo.z), stretched, length, wo.z / length);
}

/// One over the length; finite for no length.
fn normals_per_length(v: vec3<f32>) -> f32 {
    return inverseSqrt(v.x * v.x + (v.y * v.y + (v.z * v.z + 1e-30)));
}

/// Height z / |A w| of a direction, zero below the surface.
fn normals_rise(view: NormalsView, w: vec3<f32>) -> f32 {
    return max(w.z, 0.0) * normals_per_length(vec3(view.alpha * w.xy, w.z));
}

/// What is not shadowed, G2/G1, by a direction's rise.
fn normals_weight_of(view: NormalsView, rise: f32) -> f32 {
    return (1.0 + view.rise) * rise / (rise + view.rise);
}

/// The same of the normal A c, of any length and sign, and 1 - wo . h.
fn normals_weight(view: NormalsView, c: vec3<f32>) -> vec2<f32> {
    let normal = vec3(view.alpha * c.xy, c.z);
    let h = normal * normals_per_length(normal);
    let cosine = dot(view.wo, h);
    let rise = normals_rise(view, 2.0 * cosine * h - view.wo);
    return vec2(normals_weight_of(view, rise), saturate(1.0 - abs(cosine)));
}

/// An angle over its sine, off by 2e-5 of itself at most.
fn normals_angle(a: vec3<f32>, b: vec3<f32>) -> f32 {
    let h = a.x * b.x + (a.y * b.y + (a.z * b.z + 1.0000002));
    let over_root = 2.2214415 + h * (0.53970425 + h * 0.10004498);
    return over_root * inverseSqrt(h) + (-0.99856362 + h * (-0.27447702 + h * -0.017381236));
}

/// Adds the integral of c x dc along the great circles' arcs from a to q to n.
fn normals_arcs(flux: vec3<f32>, a: vec3<f32>, q: vec3<f32>, n: vec3<f32>) -> vec3<f32> {
    // q x q is zero; differences keep the digits of short arcs.
    let s = normals_angle(q, n) * (n - q) - normals_angle(a, q) * (a - q);
    return vec3(flux.x + q.y * s.z - q.z * s.y, flux.y + q.z * s.x - q.x * s.z, flux.z + q.x * s.y - q.y * s.x);
}

/// A light's corner: its direction, its image A^-1 (wo + w), that at length one, and its length.
struct NormalsCorner {
    w: vec3<f32>,
    image: vec3<f32>,
    c: vec3<f32>,
    length: f32,
}

fn normals_corner(view: NormalsView, v: vec3<f32>) -> NormalsCorner {
    let w = v * normals_per_length(v);
    let image = w * vec3(view.per_alpha, 1.0) + view.image;
    let length2 = image.x * image.x + (image.y * image.y + (image.z * image.z + 1e-30));
    let per_length = inverseSqrt(length2);
    return NormalsCorner(w, image, image * per_length, length2 * per_length);
}

/// Adds the integral along an edge's image, the conic a + 2 t b + t^2 c, by four arcs.
fn normals_edge(view: NormalsView, flux: vec3<f32>, begin: NormalsCorner, end: NormalsCorner) -> vec3<f32> {
    let a = begin.c;
    let c = end.c;
    let sum = begin.w + end.w;
    let y = sum.x * sum.x + (sum.y * sum.y + (sum.z * sum.z + 1e-10));
    let image = begin.image + end.image + (0.5 * y - 2.0) * view.image;
    let b = image * inverseSqrt(y * (begin.length * end.length));
    // It is halved where it is equally far from both ends, if they are apart.
    let apart = a - c;
    let bend = 2.0 * dot(b, apart) / (apart.x * apart.x + (apart.y * apart.y + (apart.z * apart.z + 1e-8)));
    let t = bend + sqrt(bend * bend + 1.0);
    let left = a + t * b;
    let right = b + t * c;
    let middle = left + t * right;
    let per_length = normals_per_length(middle);
    let n = per_length * middle;
    // The arcs of a half meet a little outside of it, so that they enclose its area.
    let root = sqrt(per_length);
    let least = 3.3 * root;
    let more = 0.6 * per_length * root;
    let q = a + n + (least + more * dot(left, left)) * left;
    let r = c + n + (least + more * dot(right, right)) * right;
    return normals_arcs(normals_arcs(flux, a, q * normals_per_length(q), n), n, r * normals_per_length(r), c);
}

/// What is reflected of a rectangle of radiance one: for a Fresnel factor of one, and by Schlick's (1 - wo . h)^5.
fn normals_rectangle(view: NormalsView, corners: array<vec3<f32>, 4>, two_sided: bool) -> vec2<f32> {
    // Both sides are turned to rise. A corner below the surface slides up along its side.
    let falls = select(vec2(0.0), vec2(1.0), vec2(corners[1].z, corners[3].z) < corners[0].zz);
    let along = corners[1] - corners[0];
    let across = corners[3] - corners[0];
    let x = (1.0 - 2.0 * falls.x) * along;
    let y = (1.0 - 2.0 * falls.y) * across;
    let low = corners[0] + falls.x * along + falls.y * across;
    let right = low + x;
    let left = low + y;
    if (right.z + y.z <= 0.0) {
        return vec2(0.0);
    }
    let slide = -1.0 / max(vec2(x.z, y.z), vec2(1e-15));
    let right_up = right + saturate(right.z * slide.y) * y;
    let left_up = left + saturate(left.z * slide.x) * x;
    // The side on the horizon, or one point.
    let a = normals_corner(view, select(low + saturate(low.z * slide.y) * y, left_up, left.z <= 0.0));
    let b = normals_corner(view, select(low + saturate(low.z * slide.x) * x, right_up, right.z <= 0.0));
    var flux = normals_edge(view, vec3(0.0), a, b);
    let c = normals_corner(view, right_up);
    flux = normals_edge(view, flux, b, c);
    let high = normals_corner(view, right + y);
    flux = normals_edge(view, flux, c, high);
    let d = normals_corner(view, left_up);
    flux = normals_edge(view, normals_edge(view, flux, high, d), d, a);
    let seen = select(1.0, -1.0, falls.x != falls.y) * dot(flux, view.stretched);
    let rises = vec4(normals_rise(view, a.w), normals_rise(view, c.w), normals_rise(view, d.w), normals_rise(view, high.w));
    let least = min(min(rises.x, rises.y), min(rises.z, rises.w));
    let most = max(max(rises.x, rises.y), max(rises.z, rises.w));
    let mean = 0.25 * (rises.x + rises.y + rises.z + rises.w);
    let apart = a.w - b.w;
    return normals_mean(view, flux, seen, vec3(mean, least, most), 0.5 * dot(apart, apart), two_sided);
}

/// The same of a convex polygon of 3 to 8 vertices.
fn normals_polygon(
    view: NormalsView,
    vertices: ptr<function, array<vec3<f32>, 8>>,
    count: u32,
    two_sided: bool,
) -> vec2<f32> {
    let number = clamp(count, 3u, 8u);
    var a = (*vertices)[number - 1u];
    var setting = normals_corner(view, a);
    var rising = setting;
    var flux = vec3(0.0);
    var rises = vec3(0.0, 1.0, 0.0);
    for (var i = 0u; i < 8u; i++) {
        if (i < number) {
            let b = (*vertices)[i];
            if (a.z > 0.0 || b.z > 0.0) {
                let cut = vec3(a.xy * abs(b.z) + b.xy * abs(a.z), 0.0);
                let begin = normals_corner(view, select(cut, a, a.z > 0.0));
                let end = normals_corner(view, select(cut, b, b.z > 0.0));
                flux = normals_edge(view, flux, begin, end);
                if (a.z <= 0.0) {
                    rising = begin;
                }
                if (b.z <= 0.0) {
                    setting = end;
                }
            }
            let rise = normals_rise(view, b);
            rises = vec3(rises.x + rise, min(rises.y, rise), max(rises.z, rise));
            a = b;
        }
    }
    if (rises.z <= 0.0) {
        return vec2(0.0);
    }
    flux = normals_edge(view, flux, setting, rising);
    let apart = setting.w - rising.w;
    return normals_mean(view, flux, dot(flux, view.stretched), vec3(rises.x / f32(number), rises.yz), 0.5 * dot(apart, apart), two_sided);
}

/// The part of the visible normals times their mean weight: that of the mean normal, a share of that of the vertices, and more
/// by the part. A network of rectified linear units tells these.
fn normals_mean(view: NormalsView, flux: vec3<f32>, seen: f32, rises: vec3<f32>, width: f32, two_sided: bool) -> vec2<f32> {
    let part = saturate(select(seen, abs(seen), two_sided) * 0.31830989 / (view.wo.z + view.length));
    let at_mean = normals_weight(view, flux);
    let at_vertices = normals_weight_of(view, rises.x);
    let per_length = normals_per_length(flux);
    let alpha = vec2(max(view.alpha.x, view.alpha.y), min(view.alpha.x, view.alpha.y));
    let first = vec4(part, view.rise, at_mean);
    let second = vec4(abs(flux.z) * per_length, alpha, at_vertices);
    let third = vec4(abs(seen) * per_length / view.length, rises.yz, width);
    let told = normals_network(first, second, third);
    let weight = saturate(at_mean.x + told.z * (at_vertices - at_mean.x) + told.x * part);
    let m2 = at_mean.y * at_mean.y;
    return part * vec2(weight, clamp(weight * m2 * m2 * at_mean.y + told.y * part, 0.0, weight));
}

/// More of the weight and of Schlick's part, and the share of the vertices.
fn normals_network(first: vec4<f32>, second: vec4<f32>, third: vec4<f32>) -> vec3<f32> {
    let units_0 = max(
        mat4x4(-0.9354, 0.3392, 0.901, 0.8184, 0.06939, 1.973, 0.7174, -0.5905, -5.548, -1.308, -4.657, -10.01, -1.921, 0.03933, 3.627, 2.526) * first
        + mat4x4(-2.568, 0.1459, 3.309, -0.128, -0.1699, 1.817, -0.2266, -0.4018, 0.2633, 0.7666, -1.943, -0.4549, 1.911, 0.623, 0.03777, 0.02032) * second
        + mat4x4(2.098, -1.183, -2.054, -0.7316, -4.466, -0.07308, -0.3089, -0.215, -0.109, -0.1926, -0.002601, 0.2204, 0.04332, 0.06559, -0.02132, -0.01499) * third
        + vec4(4.547, -0.7266, -0.8663, 8.579),
        vec4(0.0),
    );
    let units_1 = max(
        mat4x4(0.6477, 1.515, -2.204, -3.046, -0.694, 0.0419, 2.159, 2.215, 0.1061, 2.5, -1.076, -1.853, 1.589, -0.03674, 4.327, 4.146) * first
        + mat4x4(0.2575, -2.166, -0.949, -0.4878, -0.5416, 2.396, 2.191, 2.432, -0.3327, -0.9711, 2.921, -2.265, -0.5585, 0.2379, 2.755, 3.295) * second
        + mat4x4(-3.606, 1.975, -0.4173, 0.2039, -0.9847, 0.1395, -3.315, -3.135, 1.333, 0.7253, 0.4845, 0.6164, -0.01515, 0.01943, 0.5687, 0.6633) * third
        + vec4(0.3426, -5.247, -5.019, -4.998),
        vec4(0.0),
    );
    let units_2 = max(
        mat4x4(0.74, -0.1652, -1.324, -8.85, 0.9079, -0.2555, -2.65, 0.8941, -11.14, 12.12, -13.68, -1.982, 0.4566, -0.02314, -2.036, 4.191) * first
        + mat4x4(-1.068, 0.1236, 2.726, -0.09983, 1.252, -0.5095, 0.3149, 2.472, 1.543, -0.1216, -0.6891, -0.6191, 0.988, -0.01941, -0.4513, -0.3021) * second
        + mat4x4(-0.4826, 0.2351, 4.428, 0.4689, -0.5691, 0.007494, -0.7105, -1.696, -0.07313, 0.0004897, 0.4579, -2.729, 0.006034, -0.002308, 0.008641, -0.3128) * third
        + vec4(9.743, -11.63, 10.16, 0.8425),
        vec4(0.0),
    );
    return mat4x3(-0.02834, -0.02664, 0.1041, -0.01883, -0.01512, 0.09821, 0.007351, 0.06988, 0.01708, -0.01147, -0.1042, -0.02192) * units_0
        + mat4x3(-0.001762, -0.0824, -0.02879, -0.008193, 0.01041, 0.1278, -0.01512, 0.005387, 0.1031, 0.00705, -0.001201, -0.1004) * units_1
        + mat4x3(-0.04486, 0.01646, 0.09211, 0.02413, -0.01387, -0.1807, -0.01519, -0.01256, -0.1395, 0.03092, 0.0857, 0.1504) * units_2
        + vec3(-0.009406, 0.005604, 0.06389);
}

/// The same of a disk by perpendicular half axes, lit from the side of half_x x half_y: the regular octagon of its area.
fn normals_disk(view: NormalsView, centre: vec3<f32>, half_x: vec3<f32>, half_y: vec3<f32>, two_sided: bool) -> vec2<f32> {
    var vertices: array<vec3<f32>, 8>;
    var turn = vec2(0.97368348, 0.4033129);
    for (var i = 0u; i < 8u; i++) {
        vertices[i] = centre + half_x * turn.x + half_y * turn.y;
        turn = 0.70710678 * vec2(turn.x + turn.y, turn.y - turn.x);
    }
    return normals_polygon(view, &vertices, 8u, two_sided);
}
`;
