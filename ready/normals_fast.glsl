// SPDX-License-Identifier: MIT OR Apache-2.0
// ltcforge 0.1.0, revision 3, sha256 of the text below: fd0c7de7cfe3348b
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

// A surface seen from direction wo. A = diag(alpha, 1).
struct NormalsView {
    vec2 alpha;
    vec2 per_alpha;
    vec3 wo;
    vec3 image; // A^-1 wo
    vec3 stretched; // A wo
    float length_; // length of A wo
    float rise; // rise of wo
};

// Computes the view for all lights at a point. alpha is in (0, 1]. wo is a unit vector in the tangent frame,
// normal +z.
NormalsView normals_view(float alpha_x, float alpha_y, vec3 wo) {
    vec2 alpha = max(vec2(alpha_x, alpha_y), vec2(1e-5));
    vec3 stretched = vec3(alpha * wo.xy, wo.z);
    float length_ = sqrt(dot(stretched, stretched));
    return NormalsView(alpha, 1.0 / alpha, wo, vec3(wo.xy / alpha, wo.z), stretched, length_, wo.z / length_);
}

// One over the length of a vector; finite for a zero vector.
float normals_per_length(vec3 v) {
    return inversesqrt(v.x * v.x + (v.y * v.y + (v.z * v.z + 1e-30)));
}

// The rise z / |A w| of a direction; zero below the surface.
float normals_rise(NormalsView view, vec3 w) {
    return max(w.z, 0.0) * normals_per_length(vec3(view.alpha * w.xy, w.z));
}

// Smith's G2 / G1 from the rise of the light direction: the fraction that is not shadowed.
float normals_weight_of(NormalsView view, float rise) {
    return (1.0 + view.rise) * rise / (rise + view.rise);
}

// G2 / G1 for the normal A c (x), and 1 - wo . h (y). c may have any length and sign.
vec2 normals_weight(NormalsView view, vec3 c) {
    vec3 normal = vec3(view.alpha * c.xy, c.z);
    vec3 h = normal * normals_per_length(normal);
    float cosine = dot(view.wo, h);
    float rise = normals_rise(view, 2.0 * cosine * h - view.wo);
    return vec2(normals_weight_of(view, rise), clamp(1.0 - abs(cosine), 0.0, 1.0));
}

// The angle between two unit vectors, divided by its sine. Relative error below 8e-4.
float normals_angle(vec3 a, vec3 b) {
    float h = a.x * b.x + (a.y * b.y + (a.z * b.z + 1.0000002));
    return (2.2214415 + h * 0.4152027) * inversesqrt(h) + (-0.9720743 + h * -0.0933735);
}

// Adds the integral of c x dc along the arcs of great circles from a to q and from q to n.
vec3 normals_arcs(vec3 flux, vec3 a, vec3 q, vec3 n) {
    vec3 s = normals_angle(q, n) * n - normals_angle(a, q) * a;
    return vec3(flux.x + q.y * s.z - q.z * s.y, flux.y + q.z * s.x - q.x * s.z, flux.z + q.x * s.y - q.y * s.x);
}

// A corner of a light: its direction w, the image A^-1 (wo + w), the unit vector c along the image, and the image's
// length.
struct NormalsCorner {
    vec3 w;
    vec3 image;
    vec3 c;
    float length_;
};

NormalsCorner normals_corner(NormalsView view, vec3 v) {
    vec3 w = v * normals_per_length(v);
    vec3 image = w * vec3(view.per_alpha, 1.0) + view.image;
    float length2 = image.x * image.x + (image.y * image.y + (image.z * image.z + 1e-30));
    float per_length = inversesqrt(length2);
    return NormalsCorner(w, image, image * per_length, length2 * per_length);
}

// The image of an edge by four arcs: the integral of c x dc along it, added to an earlier one; the point halfway between
// both ends; and the points where the arcs of each half meet.
struct NormalsEdge {
    vec3 flux;
    vec3 middle;
    vec3 q;
    vec3 r;
};

// The image is the conic a + 2 t b + t^2 c.
NormalsEdge normals_edge(NormalsView view, vec3 flux, NormalsCorner begin, NormalsCorner end) {
    vec3 a = begin.c;
    vec3 c = end.c;
    vec3 sum = begin.w + end.w;
    float y = sum.x * sum.x + (sum.y * sum.y + (sum.z * sum.z + 1e-12));
    vec3 image = begin.image + end.image + (0.5 * y - 2.0) * view.image;
    vec3 b = image * inversesqrt(y * (begin.length_ * end.length_));
    // Split the conic at the point equally far from both ends, if the ends differ.
    vec3 apart = a - c;
    float bend = 2.0 * dot(b, apart) / (apart.x * apart.x + (apart.y * apart.y + (apart.z * apart.z + 1e-8)));
    float t = bend + sqrt(bend * bend + 1.0);
    vec3 left = a + t * b;
    vec3 right = b + t * c;
    vec3 middle = left + t * right;
    float per_length = normals_per_length(middle);
    vec3 n = per_length * middle;
    // The arcs of each half meet a little outside the conic, so that they enclose its area.
    float root = sqrt(per_length);
    float least = 3.4 * root;
    float more = 0.6 * per_length * root;
    vec3 beyond_left = a + n + (least + more * dot(left, left)) * left;
    vec3 beyond_right = c + n + (least + more * dot(right, right)) * right;
    vec3 q = beyond_left * normals_per_length(beyond_left);
    vec3 r = beyond_right * normals_per_length(beyond_right);
    return NormalsEdge(normals_arcs(normals_arcs(flux, a, q, n), n, r, c), n, q, r);
}

// Sums over the edges of a light: the integral of c x dc, the sum of the corners' rises, and the number of corners.
struct NormalsSum {
    vec3 flux;
    float rise;
    float count;
};

// Adds an edge and the corner at its end. For an edge on the horizon, the corner does not count.
NormalsSum normals_add(NormalsView view, NormalsSum sum, NormalsCorner begin, NormalsCorner end, bool is_above) {
    vec3 flux = normals_edge(view, sum.flux, begin, end).flux;
    if (!is_above) {
        return NormalsSum(flux, sum.rise, sum.count);
    }
    return NormalsSum(flux, sum.rise + normals_rise(view, end.w), sum.count + 1.0);
}

// The fraction of the visible normals that reflect the light, times their mean weight. It is a blend of the weights at
// the mean normal and at the corners, with a share from a network. A correction proportional to the fraction follows.
// It needs no clamp, which would draw contours into highlights.
vec2 normals_mean(NormalsView view, NormalsSum sum, float projected, bool two_sided) {
    float part = clamp((two_sided ? abs(projected) : projected) * 0.31830989 / (view.wo.z + view.length_), 0.0, 1.0);
    vec2 at_mean = normals_weight(view, sum.flux);
    float at_corners = normals_weight_of(view, sum.rise / sum.count);
    float upright = abs(sum.flux.z) * normals_per_length(sum.flux);
    vec4 first = vec4(part, view.rise, at_mean);
    vec4 second = vec4(upright, max(view.alpha.x, view.alpha.y), min(view.alpha.x, view.alpha.y), at_corners);
    vec3 sum_0 = mat4x3(-0.1519, -0.7039, 1.037, -0.5392, -1.806, -1.746, 9.027, -12.2, -21.41, 0.2465, -1.285, 2.563) * first
        + mat4x3(0.3197, 3.16, -0.8452, -1.318, -1.632, -0.6724, -0.2627, -3.212, -0.0576, -0.5294, 0.6265, 0.1072) * second
        + vec3(-6.745, 11.53, 19.15);
    vec3 units_0 = sum_0 + sqrt(sum_0 * sum_0 + 1.0);
    vec3 outputs = mat3(0.1255, -0.6073, -0.03671, 0.1392, 0.1501, -0.1714, -0.08467, 0.004083, -0.7751) * units_0
        + vec3(0.4829, -3.68, 0.4387);
    float near = clamp(outputs.x, 0.0, 1.0);
    float known = at_corners + near * near * (3.0 - 2.0 * near) * (at_mean.x - at_corners);
    vec2 more = part * outputs.yz / (1.0 + abs(outputs.yz));
    float m2 = at_mean.y * at_mean.y;
    float schlick = m2 * m2 * at_mean.y;
    float weight = part * known * (1.0 + more.x * (1.0 - known));
    return weight * vec2(1.0, schlick * (1.0 + more.y * (1.0 - schlick)));
}

// Reflected light, and the integral of c x dc along the image of the light's outline: it points along the mean normal or
// against it.
struct NormalsLit {
    vec2 light;
    vec3 flux;
};

// The same with the mean normal, for samplers.
NormalsLit normals_rectangle_lit(NormalsView view, vec3 corners[4], bool two_sided) {
    // Orient both sides so that they rise. A corner below the surface slides up along its side.
    vec2 falls = mix(vec2(0.0), vec2(1.0), lessThan(vec2(corners[1].z, corners[3].z), corners[0].zz));
    vec3 along = corners[1] - corners[0];
    vec3 across = corners[3] - corners[0];
    vec3 x = (1.0 - 2.0 * falls.x) * along;
    vec3 y = (1.0 - 2.0 * falls.y) * across;
    vec3 low = corners[0] + falls.x * along + falls.y * across;
    vec3 right = low + x;
    vec3 left = low + y;
    if (right.z + y.z <= 0.0) {
        return NormalsLit(vec2(0.0), vec3(0.0));
    }
    vec2 slide = -1.0 / max(vec2(x.z, y.z), vec2(1e-15));
    vec3 right_up = right + clamp(right.z * slide.y, 0.0, 1.0) * y;
    vec3 left_up = left + clamp(left.z * slide.x, 0.0, 1.0) * x;
    // a and b are the ends of the lowest side after clipping. They are equal if the surface cuts nothing off; otherwise
    // this side lies on the horizon.
    NormalsCorner a = normals_corner(view, left.z <= 0.0 ? left_up : low + clamp(low.z * slide.y, 0.0, 1.0) * y);
    NormalsCorner b = normals_corner(view, right.z <= 0.0 ? right_up : low + clamp(low.z * slide.x, 0.0, 1.0) * x);
    NormalsSum sum = normals_add(view, NormalsSum(vec3(0.0), 0.0, 0.0), a, b, false);
    NormalsCorner c = normals_corner(view, right_up);
    sum = normals_add(view, sum, b, c, true);
    NormalsCorner high = normals_corner(view, right + y);
    sum = normals_add(view, sum, c, high, true);
    NormalsCorner d = normals_corner(view, left_up);
    sum = normals_add(view, normals_add(view, sum, high, d, true), d, a, true);
    float projected = (falls.x != falls.y ? -1.0 : 1.0) * dot(sum.flux, view.stretched);
    return NormalsLit(normals_mean(view, sum, projected, two_sided), sum.flux);
}

// The reflected light of a rectangle of radiance one: for a Fresnel factor of one (x), and weighted by Schlick's
// (1 - wo . h)^5 (y).
vec2 normals_rectangle(NormalsView view, vec3 corners[4], bool two_sided) {
    return normals_rectangle_lit(view, corners, two_sided).light;
}

// The same with the mean normal, for samplers.
NormalsLit normals_polygon_lit(NormalsView view, vec3 vertices[8], uint count, bool two_sided) {
    uint number = clamp(count, 3u, 8u);
    vec3 a = vertices[number - 1u];
    NormalsCorner setting = normals_corner(view, a);
    NormalsCorner rising = setting;
    NormalsSum sum = NormalsSum(vec3(0.0), 0.0, 0.0);
    for (uint i = 0u; i < 8u; i++) {
        if (i < number) {
            vec3 b = vertices[i];
            // Below the surface, begin and end are one point of the horizon.
            vec3 cut = vec3(a.xy * abs(b.z) + b.xy * abs(a.z), 0.0);
            NormalsCorner begin = normals_corner(view, a.z > 0.0 ? a : cut);
            NormalsCorner end = normals_corner(view, b.z > 0.0 ? b : cut);
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

// The reflected light of a convex polygon with 3 to 8 vertices, as in normals_rectangle.
vec2 normals_polygon(NormalsView view, inout vec3 vertices[8], uint count, bool two_sided) {
    return normals_polygon_lit(view, vertices, count, two_sided).light;
}

// The reflected light of a disk, replaced by the regular octagon of the same area. The disk emits towards half_x x
// half_y.
vec2 normals_disk(NormalsView view, vec3 centre, vec3 half_x, vec3 half_y, bool two_sided) {
    vec3 vertices[8] = vec3[8](vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0));
    vec2 turn = vec2(0.97368348, 0.4033129);
    for (uint i = 0u; i < 8u; i++) {
        vertices[i] = centre + half_x * turn.x + half_y * turn.y;
        turn = 0.70710678 * vec2(turn.x + turn.y, turn.y - turn.x);
    }
    return normals_polygon(view, vertices, 8u, two_sided);
}
