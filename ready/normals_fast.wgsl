// SPDX-License-Identifier: MIT OR Apache-2.0
// ltcforge 0.1.0, revision 3, sha256 of the text below: 4b9c8ee38f209d60
// Area lights on GGX without a table, in the space of its normals, by rule fast.
//
//   normals_view(alpha_x, alpha_y, wo)  once for a point and view: roughness, and the view in the tangent frame, normal +z.
//   normals_rectangle, normals_polygon, normals_disk  for each light. Vertices are relative to the point in this frame and
//       run clockwise as seen from the side that emits. The third corner of a rectangle is not read.
//       Light of radiance L arrives as L (f0 (x - y) + f90 y).
//   normals_rectangle_lit, normals_polygon_lit  light is the same; flux is for sampler_normals_about of the samplers.
//
// CHECK of the rectangle (-1 -1 1) (1 -1 1) (1 1.5 -0.5) (-1 1.5 -0.5), alpha_x alpha_y (wo): x y, within 0.00002
//   0.3 0.15 (0.36 0.48 0.8): 0.692584 0.000055
//   0.2 0.6 (-0.64 0.48 0.6): 0.552486 0.000339
//   0.05 0.02 (0.576 -0.768 0.28): 0.988636 0.189273

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

/// The angle between two unit vectors, divided by its sine. Relative error below 8e-4.
fn normals_angle(a: vec3<f32>, b: vec3<f32>) -> f32 {
    let h = a.x * b.x + (a.y * b.y + (a.z * b.z + 1.0000002));
    return (2.2214415 + h * 0.4152027) * inverseSqrt(h) + (-0.9720743 + h * -0.0933735);
}

/// Adds the integral of c x dc along the arcs of great circles from a to q and from q to n.
fn normals_arcs(flux: vec3<f32>, a: vec3<f32>, q: vec3<f32>, n: vec3<f32>) -> vec3<f32> {
    let s = normals_angle(q, n) * n - normals_angle(a, q) * a;
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

/// Sums over the edges of a light: the integral of c x dc, the sum of the corners' rises, and the number of corners.
struct NormalsSum {
    flux: vec3<f32>,
    rise: f32,
    count: f32,
}

/// Adds an edge and the corner at its end. For an edge on the horizon, the corner does not count.
fn normals_add(view: NormalsView, sum: NormalsSum, begin: NormalsCorner, end: NormalsCorner, is_above: bool) -> NormalsSum {
    let flux = normals_edge(view, sum.flux, begin, end).flux;
    if (!is_above) {
        return NormalsSum(flux, sum.rise, sum.count);
    }
    return NormalsSum(flux, sum.rise + normals_rise(view, end.w), sum.count + 1.0);
}

/// The fraction of the visible normals that reflect the light, times their mean weight. It is a blend of the weights at
/// the mean normal and at the corners, with a share from a network. A correction proportional to the fraction follows.
/// It needs no clamp, which would draw contours into highlights.
fn normals_mean(view: NormalsView, sum: NormalsSum, projected: f32, two_sided: bool) -> vec2<f32> {
    let part = saturate(select(projected, abs(projected), two_sided) * 0.31830989 / (view.wo.z + view.length));
    let at_mean = normals_weight(view, sum.flux);
    let at_corners = normals_weight_of(view, sum.rise / sum.count);
    let upright = abs(sum.flux.z) * normals_per_length(sum.flux);
    let first = vec4(part, view.rise, at_mean);
    let second = vec4(upright, max(view.alpha.x, view.alpha.y), min(view.alpha.x, view.alpha.y), at_corners);
    let sum_0 = mat4x3(-0.1519, -0.7039, 1.037, -0.5392, -1.806, -1.746, 9.027, -12.2, -21.41, 0.2465, -1.285, 2.563) * first
        + mat4x3(0.3197, 3.16, -0.8452, -1.318, -1.632, -0.6724, -0.2627, -3.212, -0.0576, -0.5294, 0.6265, 0.1072) * second
        + vec3(-6.745, 11.53, 19.15);
    let units_0 = sum_0 + sqrt(sum_0 * sum_0 + 1.0);
    let outputs = mat3x3(0.1255, -0.6073, -0.03671, 0.1392, 0.1501, -0.1714, -0.08467, 0.004083, -0.7751) * units_0
        + vec3(0.4829, -3.68, 0.4387);
    let near = saturate(outputs.x);
    let known = at_corners + near * near * (3.0 - 2.0 * near) * (at_mean.x - at_corners);
    let more = part * outputs.yz / (1.0 + abs(outputs.yz));
    let m2 = at_mean.y * at_mean.y;
    let schlick = m2 * m2 * at_mean.y;
    let weight = part * known * (1.0 + more.x * (1.0 - known));
    return weight * vec2(1.0, schlick * (1.0 + more.y * (1.0 - schlick)));
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
