// SPDX-License-Identifier: MIT OR Apache-2.0
// ltcforge 0.1.0, revision 3, sha256 of the text below: 98f408930eb81ba4
// Area lights on GGX without a table, in the space of its normals, by rule balanced.
//
//   normals_view(alpha_x, alpha_y, wo)  once for a point and view: roughness, and the view in the tangent frame, normal +z.
//   normals_rectangle, normals_polygon, normals_disk  for each light. Vertices are relative to the point in this frame and
//       run clockwise as seen from the side that emits. The third corner of a rectangle is not read.
//       Light of radiance L arrives as L (f0 (x - y) + f90 y).
//   normals_rectangle_lit, normals_polygon_lit  light is the same; flux is for sampler_normals_about of the samplers.
//
// CHECK of the rectangle (-1 -1 1) (1 -1 1) (1 1.5 -0.5) (-1 1.5 -0.5), alpha_x alpha_y (wo): x y, within 0.00002
//   0.3 0.15 (0.36 0.48 0.8): 0.703362 0.000085
//   0.2 0.6 (-0.64 0.48 0.6): 0.547814 0.000918
//   0.05 0.02 (0.576 -0.768 0.28): 0.991828 0.184046

/// A surface seen from direction wo. A = diag(alpha, 1).
struct NormalsView {
    alpha: vec2<f32>,
    per_alpha: vec2<f32>,
    wo: vec3<f32>,
    image: vec3<f32>, // A^-1 wo
    stretched: vec3<f32>, // A wo
    length: f32, // length of A wo
    rise: f32, // rise of wo
}

/// Computes the view for all lights at a point. alpha is in (0, 1]. wo is a unit vector in the tangent frame,
/// normal +z.
fn normals_view(alpha_x: f32, alpha_y: f32, wo: vec3<f32>) -> NormalsView {
    let alpha = max(vec2(alpha_x, alpha_y), vec2(1e-5));
    let stretched = vec3(alpha * wo.xy, wo.z);
    let length = sqrt(dot(stretched, stretched));
    return NormalsView(alpha, 1.0 / alpha, wo, vec3(wo.xy / alpha, wo.z), stretched, length, wo.z / length);
}

/// One over the length of a vector; finite for a zero vector.
fn normals_per_length(v: vec3<f32>) -> f32 {
    return inverseSqrt(v.x * v.x + (v.y * v.y + (v.z * v.z + 1e-30)));
}

/// The rise z / |A w| of a direction; zero below the surface.
fn normals_rise(view: NormalsView, w: vec3<f32>) -> f32 {
    return max(w.z, 0.0) * normals_per_length(vec3(view.alpha * w.xy, w.z));
}

/// Smith's G2 / G1 from the rise of the light direction: the fraction that is not shadowed.
fn normals_weight_of(view: NormalsView, rise: f32) -> f32 {
    return (1.0 + view.rise) * rise / (rise + view.rise);
}

/// G2 / G1 for the normal A c (x), and 1 - wo . h (y). c may have any length and sign.
fn normals_weight(view: NormalsView, c: vec3<f32>) -> vec2<f32> {
    let normal = vec3(view.alpha * c.xy, c.z);
    let h = normal * normals_per_length(normal);
    let cosine = dot(view.wo, h);
    let rise = normals_rise(view, 2.0 * cosine * h - view.wo);
    return vec2(normals_weight_of(view, rise), saturate(1.0 - abs(cosine)));
}

/// The angle between two unit vectors, divided by its sine. Relative error below 1.3e-4.
fn normals_angle(a: vec3<f32>, b: vec3<f32>) -> f32 {
    let h = a.x * b.x + (a.y * b.y + (a.z * b.z + 1.0000002));
    return (2.2214415 + h * (0.5054863 + h * 0.0397516)) * inverseSqrt(h) + (-0.9934988 + h * -0.2022361);
}

/// Adds the integral of c x dc along the arcs of great circles from a to q and from q to n.
fn normals_arcs(flux: vec3<f32>, a: vec3<f32>, q: vec3<f32>, n: vec3<f32>) -> vec3<f32> {
    // Subtracting q changes nothing, because q x q is zero, but keeps the digits of short arcs.
    let s = normals_angle(q, n) * (n - q) - normals_angle(a, q) * (a - q);
    return vec3(flux.x + q.y * s.z - q.z * s.y, flux.y + q.z * s.x - q.x * s.z, flux.z + q.x * s.y - q.y * s.x);
}

/// A corner of a light: its direction w, the image A^-1 (wo + w), the unit vector c along the image, and the image's
/// length.
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

/// The image of an edge by four arcs: the integral of c x dc along it, added to an earlier one; the point halfway between
/// both ends; and the points where the arcs of each half meet.
struct NormalsEdge {
    flux: vec3<f32>,
    middle: vec3<f32>,
    q: vec3<f32>,
    r: vec3<f32>,
}

/// The image is the conic a + 2 t b + t^2 c.
fn normals_edge(view: NormalsView, flux: vec3<f32>, begin: NormalsCorner, end: NormalsCorner) -> NormalsEdge {
    let a = begin.c;
    let c = end.c;
    let sum = begin.w + end.w;
    let y = sum.x * sum.x + (sum.y * sum.y + (sum.z * sum.z + 1e-12));
    let image = begin.image + end.image + (0.5 * y - 2.0) * view.image;
    let b = image * inverseSqrt(y * (begin.length * end.length));
    // Split the conic at the point equally far from both ends, if the ends differ.
    let apart = a - c;
    let bend = 2.0 * dot(b, apart) / (apart.x * apart.x + (apart.y * apart.y + (apart.z * apart.z + 1e-8)));
    let t = bend + sqrt(bend * bend + 1.0);
    let left = a + t * b;
    let right = b + t * c;
    let middle = left + t * right;
    let per_length = normals_per_length(middle);
    let n = per_length * middle;
    // The arcs of each half meet a little outside the conic, so that they enclose its area.
    let root = sqrt(per_length);
    let least = 3.4 * root;
    let more = 0.6 * per_length * root;
    let beyond_left = a + n + (least + more * dot(left, left)) * left;
    let beyond_right = c + n + (least + more * dot(right, right)) * right;
    let q = beyond_left * normals_per_length(beyond_left);
    let r = beyond_right * normals_per_length(beyond_right);
    return NormalsEdge(normals_arcs(normals_arcs(flux, a, q, n), n, r, c), n, q, r);
}

/// Sums over the edges of a light. flux: the integral of c x dc. sums: the values of normals_sample, times the size of
/// the edge among the visible normals. size: these sizes.
struct NormalsSum {
    flux: vec3<f32>,
    sums: vec4<f32>,
    size: f32,
}

/// For the normal A c: the weight G2 / G1 divided by 1 + view.rise; the rise of the reflected view direction; the weight
/// times Schlick's factor; the squared weight.
fn normals_sample(view: NormalsView, c: vec3<f32>) -> vec4<f32> {
    let h = vec3(view.alpha * c.xy, c.z);
    let along = dot(view.wo, h);
    let h2 = dot(h, h);
    let rise = normals_rise(view, 2.0 * along * h - h2 * view.wo);
    let weight = rise / (rise + view.rise);
    return vec4(weight, rise, weight * normals_fifth(saturate(1.0 - abs(along) * inverseSqrt(h2))), weight * weight);
}

/// Adds an edge. On the horizon the weight is zero.
fn normals_add(view: NormalsView, sum: NormalsSum, begin: NormalsCorner, end: NormalsCorner, is_above: bool) -> NormalsSum {
    let edge = normals_edge(view, sum.flux, begin, end);
    let half = edge.middle - begin.c;
    let size = sqrt(dot(half, half)) * saturate(dot(edge.middle, view.stretched));
    if (!is_above) {
        return NormalsSum(edge.flux, sum.sums, sum.size + size);
    }
    return NormalsSum(edge.flux, sum.sums + size * normals_samples(view, edge), sum.size + size);
}

fn normals_fifth(x: f32) -> f32 {
    return x * x * (x * x) * x;
}

/// The mean of the weight (x) and of the weight times Schlick's factor (y) over the light. They are blends of the values
/// at the mean normal, at the mean rise of the outline, and along the outline, with shares from a network. A
/// correction proportional to the extent follows. It needs no clamp, which would draw contours into highlights.
fn normals_blend(at_mean: vec2<f32>, at_rise: f32, outline: vec2<f32>, extent: f32, outputs: vec4<f32>, fifth: f32) -> vec2<f32> {
    let near = saturate(outputs.wx);
    let shares = near * near * (3.0 - 2.0 * near);
    let bounded = vec3(outputs.yz, fifth) / (1.0 + abs(vec3(outputs.yz, fifth)));
    let around = at_rise + shares.x * (outline.x - at_rise);
    let known = around + shares.y * (at_mean.x - around);
    let weight = known * (1.0 + extent * bounded.x * (1.0 - known));
    let schlick = at_mean.y + (0.5 + 0.5 * bounded.z) * (outline.y - at_mean.y);
    return weight * vec2(1.0, schlick * (1.0 + extent * bounded.y * (1.0 - schlick)));
}

/// The samples of an edge: its middle.
fn normals_samples(view: NormalsView, edge: NormalsEdge) -> vec4<f32> {
    return normals_sample(view, edge.middle);
}

/// The fraction of the visible normals that reflect the light, times their mean weight.
fn normals_mean(view: NormalsView, sum: NormalsSum, projected: f32, two_sided: bool) -> vec2<f32> {
    let part = saturate(select(projected, abs(projected), two_sided) * 0.31830989 / (view.wo.z + view.length));
    let at_mean = normals_weight(view, sum.flux);
    let scale = 1.0 + view.rise;
    let means = sum.sums * (vec4(scale, 1.0, scale, scale * scale) / max(sum.size, 1e-20));
    let at_rise = normals_weight_of(view, means.y);
    let extent = sum.size * sum.size;
    let first = vec4(part, view.rise, at_mean);
    let second = vec4(max(view.alpha.x, view.alpha.y), min(view.alpha.x, view.alpha.y), at_rise, means.x);
    let third = sum.size;
    let sum_0 = mat4x4(-10.97, 0.3589, 0.4507, -0.04585, 0.04056, 19.83, -0.7741, 0.2623, 3.904, 11.6, 4.484, 1.37, 1.796, 0.1187, 0.5416, 2.782) * first
        + mat4x4(0.7183, -2.207, -2.359, -0.5499, 0.3575, 0.343, -0.8699, 1.698, -4.729, -1.354, 0.2741, 1.058, 0.6109, 2.047, -1.227, 0.9754) * second
        + vec4(1.031, -0.2568, -0.04868, 0.3217) * third
        + vec4(-1.733, -30.7, -1.4, -4.092);
    let units_0 = sum_0 + sqrt(sum_0 * sum_0 + 1.0);
    let outputs = mat4x4(-0.2265, -0.04962, -0.2762, 0.02247, 0.06334, -0.6608, 0.1095, -0.4541, 0.05504, 0.3706, -0.2145, -0.1937, -0.04367, -0.3634, -0.1784, 0.1189) * units_0
        + vec4(0.6106, 0.2974, 1.157, 1.223);
    let fifth = dot(vec4(0.1535, -11.78, -0.2551, 1.225), units_0)
        + -3.635;
    let outline = vec2(means.x, means.z / (means.x + 1e-6));
    return part * normals_blend(vec2(at_mean.x, normals_fifth(at_mean.y)), at_rise, outline, extent / (extent + 1.0), outputs, fifth);
}

/// Reflected light, and the integral of c x dc along the image of the light's outline: it points along the mean normal or
/// against it.
struct NormalsLit {
    light: vec2<f32>,
    flux: vec3<f32>,
}

/// The reflected light of a rectangle of radiance one: for a Fresnel factor of one (x), and weighted by Schlick's
/// (1 - wo . h)^5 (y).
fn normals_rectangle(view: NormalsView, corners: array<vec3<f32>, 4>, two_sided: bool) -> vec2<f32> {
    return normals_rectangle_lit(view, corners, two_sided).light;
}

/// The same with the mean normal, for samplers.
fn normals_rectangle_lit(view: NormalsView, corners: array<vec3<f32>, 4>, two_sided: bool) -> NormalsLit {
    // Orient both sides so that they rise. A corner below the surface slides up along its side.
    let falls = select(vec2(0.0), vec2(1.0), vec2(corners[1].z, corners[3].z) < corners[0].zz);
    let along = corners[1] - corners[0];
    let across = corners[3] - corners[0];
    let x = (1.0 - 2.0 * falls.x) * along;
    let y = (1.0 - 2.0 * falls.y) * across;
    let low = corners[0] + falls.x * along + falls.y * across;
    let right = low + x;
    let left = low + y;
    if (right.z + y.z <= 0.0) {
        return NormalsLit(vec2(0.0), vec3(0.0));
    }
    let slide = -1.0 / max(vec2(x.z, y.z), vec2(1e-15));
    let right_up = right + saturate(right.z * slide.y) * y;
    let left_up = left + saturate(left.z * slide.x) * x;
    // a and b are the ends of the lowest side after clipping. They are equal if the surface cuts nothing off; otherwise
    // this side lies on the horizon.
    let a = normals_corner(view, select(low + saturate(low.z * slide.y) * y, left_up, left.z <= 0.0));
    let b = normals_corner(view, select(low + saturate(low.z * slide.x) * x, right_up, right.z <= 0.0));
    var sum = normals_add(view, NormalsSum(), a, b, false);
    let c = normals_corner(view, right_up);
    sum = normals_add(view, sum, b, c, true);
    let high = normals_corner(view, right + y);
    sum = normals_add(view, sum, c, high, true);
    let d = normals_corner(view, left_up);
    sum = normals_add(view, normals_add(view, sum, high, d, true), d, a, true);
    let projected = select(1.0, -1.0, falls.x != falls.y) * dot(sum.flux, view.stretched);
    return NormalsLit(normals_mean(view, sum, projected, two_sided), sum.flux);
}

/// The reflected light of a convex polygon with 3 to 8 vertices, as in normals_rectangle.
fn normals_polygon(view: NormalsView, vertices: ptr<function, array<vec3<f32>, 8>>, count: u32, two_sided: bool) -> vec2<f32> {
    return normals_polygon_lit(view, vertices, count, two_sided).light;
}

/// The same with the mean normal, for samplers.
fn normals_polygon_lit(view: NormalsView, vertices: ptr<function, array<vec3<f32>, 8>>, count: u32, two_sided: bool) -> NormalsLit {
    let number = clamp(count, 3u, 8u);
    var a = (*vertices)[number - 1u];
    var setting = normals_corner(view, a);
    var rising = setting;
    var sum = NormalsSum();
    for (var i = 0u; i < 8u; i++) {
        if (i < number) {
            let b = (*vertices)[i];
            // Below the surface, begin and end are one point of the horizon.
            let cut = vec3(a.xy * abs(b.z) + b.xy * abs(a.z), 0.0);
            let begin = normals_corner(view, select(cut, a, a.z > 0.0));
            let end = normals_corner(view, select(cut, b, b.z > 0.0));
            sum = normals_add(view, sum, begin, end, true);
            if (a.z <= 0.0 && b.z > 0.0) {
                rising = begin;
            }
            if (a.z > 0.0 && b.z <= 0.0) {
                setting = end;
            }
            a = b;
        }
    }
    sum = normals_add(view, sum, setting, rising, false);
    return NormalsLit(normals_mean(view, sum, dot(sum.flux, view.stretched), two_sided), sum.flux);
}

/// The reflected light of a disk, replaced by the regular octagon of the same area. The disk emits towards half_x x
/// half_y.
fn normals_disk(view: NormalsView, centre: vec3<f32>, half_x: vec3<f32>, half_y: vec3<f32>, two_sided: bool) -> vec2<f32> {
    var vertices: array<vec3<f32>, 8>;
    var turn = vec2(0.97368348, 0.4033129);
    for (var i = 0u; i < 8u; i++) {
        vertices[i] = centre + half_x * turn.x + half_y * turn.y;
        turn = 0.70710678 * vec2(turn.x + turn.y, turn.y - turn.x);
    }
    return normals_polygon(view, &vertices, 8u, two_sided);
}
