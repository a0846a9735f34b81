export default /* glsl */ `// SPDX-License-Identifier: MIT OR Apache-2.0
// ltcforge 0.1.0, revision 1, sha256 of the text below: ee640e16ae478691
// Area lights on GGX without a table, in the space of its normals, by rule fine.
//
//   normals_view(alpha_x, alpha_y, wo)  once for a point and view: roughness, and the view in the tangent frame, normal +z.
//   normals_rectangle, normals_polygon, normals_disk  for each light. Vertices are relative to the point in that frame and
//       run clockwise seen from the lit side; a rectangle's third is not read.
//       Light of radiance L arrives as L (f0 (x - y) + f90 y).
//
// CHECK of the rectangle (-1 -1 1) (1 -1 1) (1 1.5 -0.5) (-1 1.5 -0.5), alpha_x alpha_y (wo): x y, within 0.00002
//   0.3 0.15 (0.36 0.48 0.8): 0.702793 0.000353
//   0.2 0.6 (-0.64 0.48 0.6): 0.558839 0.001522
//   0.05 0.02 (0.576 -0.768 0.28): 0.989722 0.186726

precision highp float;
precision highp int;

// A surface seen from a direction. A = diag(alpha, 1).
struct NormalsView {
    vec2 alpha;
    vec2 per_alpha;
    vec3 wo;
    vec3 image; // A^-1 wo
    vec3 stretched; // A wo
    float length_; // of A wo
    float rise; // of wo
};

// alpha in (0, 1]; wo of length one in the tangent frame.
NormalsView normals_view(float alpha_x, float alpha_y, vec3 wo) {
    vec2 alpha = max(vec2(alpha_x, alpha_y), vec2(1e-5));
    vec3 stretched = vec3(alpha * wo.xy, wo.z);
    float length_ = sqrt(dot(stretched, stretched));
    return NormalsView(alpha, 1.0 / alpha, wo, vec3(wo.xy / alpha, wo.z), stretched, length_, wo.z / length_);
}

// One over the length; finite for no length.
float normals_per_length(vec3 v) {
    return inversesqrt(v.x * v.x + (v.y * v.y + (v.z * v.z + 1e-30)));
}

// Height z / |A w| of a direction, zero below the surface.
float normals_rise(NormalsView view, vec3 w) {
    return max(w.z, 0.0) * normals_per_length(vec3(view.alpha * w.xy, w.z));
}

// The part that is not shadowed, G2/G1, by a direction's rise.
float normals_weight_of(NormalsView view, float rise) {
    return (1.0 + view.rise) * rise / (rise + view.rise);
}

// The same of the normal A c, of any length and sign, and 1 - wo . h.
vec2 normals_weight(NormalsView view, vec3 c) {
    vec3 normal = vec3(view.alpha * c.xy, c.z);
    vec3 h = normal * normals_per_length(normal);
    float cosine = dot(view.wo, h);
    float rise = normals_rise(view, 2.0 * cosine * h - view.wo);
    return vec2(normals_weight_of(view, rise), clamp(1.0 - abs(cosine), 0.0, 1.0));
}

// An angle over its sine, off by 2e-5 of itself at most.
float normals_angle(vec3 a, vec3 b) {
    float h = a.x * b.x + (a.y * b.y + (a.z * b.z + 1.0000002));
    float over_root = 2.2214415 + h * (0.5397048 + h * 0.1000458);
    return over_root * inversesqrt(h) + (-0.9985637 + h * (-0.2744782 + h * -0.0173815));
}

// Adds the integral of c x dc along the great circles' arcs from a to q to n.
vec3 normals_arcs(vec3 flux, vec3 a, vec3 q, vec3 n) {
    // q x q is zero; differences keep the digits of short arcs.
    vec3 s = normals_angle(q, n) * (n - q) - normals_angle(a, q) * (a - q);
    return vec3(flux.x + q.y * s.z - q.z * s.y, flux.y + q.z * s.x - q.x * s.z, flux.z + q.x * s.y - q.y * s.x);
}

// A light's corner: its direction, its image A^-1 (wo + w), that at length one, and its length.
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

// Adds the integral along an edge's image, the conic a + 2 t b + t^2 c, by four arcs.
vec3 normals_edge(NormalsView view, vec3 flux, NormalsCorner begin, NormalsCorner end) {
    vec3 a = begin.c;
    vec3 c = end.c;
    vec3 sum = begin.w + end.w;
    float y = sum.x * sum.x + (sum.y * sum.y + (sum.z * sum.z + 1e-10));
    vec3 image = begin.image + end.image + (0.5 * y - 2.0) * view.image;
    vec3 b = image * inversesqrt(y * (begin.length_ * end.length_));
    // It is halved where it is equally far from both ends, if they are apart.
    vec3 apart = a - c;
    float bend = 2.0 * dot(b, apart) / (apart.x * apart.x + (apart.y * apart.y + (apart.z * apart.z + 1e-8)));
    float t = bend + sqrt(bend * bend + 1.0);
    vec3 left = a + t * b;
    vec3 right = b + t * c;
    vec3 middle = left + t * right;
    float per_length = normals_per_length(middle);
    vec3 n = per_length * middle;
    // The arcs of a half meet a little outside of it, so that they enclose its area.
    float root = sqrt(per_length);
    float least = 3.4 * root;
    float more = 0.6 * per_length * root;
    vec3 q = a + n + (least + more * dot(left, left)) * left;
    vec3 r = c + n + (least + more * dot(right, right)) * right;
    return normals_arcs(normals_arcs(flux, a, q * normals_per_length(q), n), n, r * normals_per_length(r), c);
}

// More of the weight and of Schlick's part, and the shares of the outer corners and of the tip.
vec4 normals_network(vec4 first, vec4 second, vec4 third) {
    vec4 units_0 = max(
        mat4(-13.02, -0.05123, -0.04506, 0.1745, -15.34, 3.537, 0.1719, 0.7646, 0.9581, -0.07924, 1.487, -1.318, 2.672, -0.0372, 0.4158, -0.4705) * first
        + mat4(-7.332, 0.1002, 0.3907, 1.197, 0.4244, 0.008437, 0.1669, 0.245, 2.007, 0.1345, -0.7786, 1.951, 4.066, 0.1216, -0.4966, -2.306) * second
        + mat4(-5.624, -0.02524, 0.9408, -2.893, -1.013, -0.5777, 0.6708, 1.261, 1.449, -0.5531, 2.123, 0.6918, 12.6, 5.388, -3.767, -0.3633) * third
        + vec4(3.307, -8.365, 1.502, -2.399),
        vec4(0.0)
    );
    vec4 units_1 = max(
        mat4(0.2911, 0.08732, -0.2378, 3.093, 2.329, 5.334, -1.179, -4.725, 0.277, -0.2235, 0.6636, -17.36, -0.5704, -4.27, -0.935, 1.581) * first
        + mat4(3.386, 0.2138, 0.3196, -3.936, 0.08644, 0.1746, 0.2738, 0.559, -0.5253, 0.5686, 0.8081, 3.705, -0.8306, -0.9163, 0.1851, 1.135) * second
        + mat4(0.3792, 0.3699, -1.317, -6.255, 0.9582, 1.731, -0.8138, -18.56, 0.7409, 0.07576, -1.894, 2.134, -2.271, -1.352, -2.596, -11.96) * third
        + vec4(-3.675, -5.474, 3.814, 22.99),
        vec4(0.0)
    );
    vec4 told = mat4(0.00491, -0.3719, -0.06271, 0.1884, 0.00863, -0.006025, -0.09717, -0.8619, 0.0008738, -0.00477, 0.07171, 0.1559, -0.06756, 0.03206, -0.1098, -0.2721) * units_0
        + mat4(0.1447, 0.02995, 0.1516, -0.05558, -0.04049, -0.01654, 0.07856, 0.3683, -0.04697, -0.1253, -0.03508, 0.03203, 0.07185, -1.163, -0.002817, -0.0119) * units_1
        + vec4(-0.005264, 0.004083, 0.0596, -0.0732);
    return told;
}

// The normal at which all triangles of a light meet, its mean normal, and what they have in common.
struct NormalsTip {
    vec3 c;
    // The part of the visible normals, and what makes it of an integral along A wo; negative for a light that turns right.
    float part;
    float side;
    // The view's rise, the larger and the smaller alpha, and the weight of the tip.
    vec4 shared_inputs;
};

// Sums over triangles: parts times the means of the weight and of Schlick's part; sizes of parts times these, and sizes.
struct NormalsSum {
    vec2 signed;
    vec3 sizes;
};

// An edge's part above the surface.
struct NormalsSide {
    NormalsCorner begin;
    NormalsCorner end;
};

NormalsSide normals_side(NormalsView view, vec3 a, vec3 b) {
    vec3 cut = vec3(a.xy * abs(b.z) + b.xy * abs(a.z), 0.0);
    NormalsCorner begin = normals_corner(view, a.z > 0.0 ? a : cut);
    return NormalsSide(begin, normals_corner(view, b.z > 0.0 ? b : cut));
}

NormalsTip normals_tip(NormalsView view, vec3 flux) {
    float seen = dot(flux, view.stretched);
    float side = (seen < 0.0 ? -0.31830989 : 0.31830989) / (view.wo.z + view.length_);
    vec3 c = flux * ((seen < 0.0 ? -1.0 : 1.0) * normals_per_length(flux));
    vec2 alpha = vec2(max(view.alpha.x, view.alpha.y), min(view.alpha.x, view.alpha.y));
    return NormalsTip(c, clamp(seen * side, 0.0, 1.0), side, vec4(view.rise, alpha, normals_weight(view, c).x));
}

// The integral of c x dc along the great circle's arc from the tip to a corner.
vec3 normals_spoke(NormalsTip tip, NormalsCorner corner) {
    return normals_angle(tip.c, corner.c) * cross(tip.c, corner.c);
}

// Adds a triangle between the tip and an edge's image, around which the integral of c x dc is flux: its part of the visible
// normals times their mean weight. That is the weight of its mean normal, shares of those of its outer corners and of the
// tip, and more by its part. A network of rectified linear units tells these.
NormalsSum normals_triangle(
    NormalsView view,
    NormalsTip tip,
    NormalsSum sum,
    vec3 flux,
    NormalsCorner begin,
    NormalsCorner end
) {
    float seen = dot(flux, view.stretched);
    float part = seen * tip.side;
    float size = abs(part);
    // A triangle that runs back is turned around.
    vec3 c = flux * ((seen < 0.0 ? -1.0 : 1.0) * normals_per_length(flux));
    vec2 at_mean = normals_weight(view, c);
    vec2 rises = vec2(normals_rise(view, begin.w), normals_rise(view, end.w));
    float at_corners = normals_weight_of(view, 0.5 * (rises.x + rises.y));
    vec4 first = vec4(size, at_mean, at_corners);
    vec4 second = vec4(dot(c, tip.c), dot(c, begin.c + end.c), abs(c.z), abs(rises.x - rises.y));
    vec4 told = normals_network(first, second, tip.shared_inputs);
    float known = at_mean.x + told.z * (at_corners - at_mean.x) + told.w * (tip.shared_inputs.w - at_mean.x);
    float weight = clamp(known + size * told.x, 0.0, 1.0);
    float m2 = at_mean.y * at_mean.y;
    vec2 means = vec2(weight, clamp(weight * m2 * m2 * at_mean.y + size * told.y, 0.0, weight));
    return NormalsSum(sum.signed + part * means, sum.sizes + size * vec3(means, 1.0));
}

// The light of all triangles. Overlapping ones cancel; the mean over all by their sizes does not.
vec2 normals_total(NormalsTip tip, NormalsSum sum, bool is_lit) {
    vec2 both = max(sum.signed, sum.sizes.xy * (0.5 * tip.part / max(sum.sizes.z, 1e-30)));
    float energy = min(both.x, tip.part);
    return is_lit ? vec2(energy, clamp(both.y, 0.0, energy)) : vec2(0.0);
}

// Reflected light of a rectangle of radiance one: for a Fresnel factor of one, and by Schlick's (1 - wo . h)^5.
vec2 normals_rectangle(NormalsView view, vec3 corners[4], bool two_sided) {
    // Sides are turned to rise. A corner below slides up along its side.
    vec2 falls = mix(vec2(0.0), vec2(1.0), lessThan(vec2(corners[1].z, corners[3].z), corners[0].zz));
    vec3 along = corners[1] - corners[0];
    vec3 across = corners[3] - corners[0];
    vec3 x = (1.0 - 2.0 * falls.x) * along;
    vec3 y = (1.0 - 2.0 * falls.y) * across;
    vec3 low = corners[0] + falls.x * along + falls.y * across;
    vec3 right = low + x;
    vec3 left = low + y;
    if (right.z + y.z <= 0.0) {
        return vec2(0.0);
    }
    vec2 slide = -1.0 / max(vec2(x.z, y.z), vec2(1e-15));
    vec3 right_up = right + clamp(right.z * slide.y, 0.0, 1.0) * y;
    vec3 left_up = left + clamp(left.z * slide.x, 0.0, 1.0) * x;
    // The side on the horizon, or one point.
    NormalsCorner a = normals_corner(view, left.z <= 0.0 ? left_up : low + clamp(low.z * slide.y, 0.0, 1.0) * y);
    NormalsCorner b = normals_corner(view, right.z <= 0.0 ? right_up : low + clamp(low.z * slide.x, 0.0, 1.0) * x);
    NormalsCorner c = normals_corner(view, right_up);
    NormalsCorner high = normals_corner(view, right + y);
    NormalsCorner d = normals_corner(view, left_up);
    vec3 none = vec3(0.0);
    vec3 ab = normals_edge(view, none, a, b);
    vec3 bc = normals_edge(view, none, b, c);
    vec3 ch = normals_edge(view, none, c, high);
    vec3 hd = normals_edge(view, none, high, d);
    vec3 da = normals_edge(view, none, d, a);
    NormalsTip tip = normals_tip(view, ab + bc + ch + hd + da);
    vec3 to_a = normals_spoke(tip, a);
    vec3 to_b = normals_spoke(tip, b);
    NormalsSum sum = normals_triangle(view, tip, NormalsSum(vec2(0.0), vec3(0.0)), ab + to_a - to_b, a, b);
    vec3 to_c = normals_spoke(tip, c);
    sum = normals_triangle(view, tip, sum, bc + to_b - to_c, b, c);
    vec3 to_high = normals_spoke(tip, high);
    sum = normals_triangle(view, tip, sum, ch + to_c - to_high, c, high);
    vec3 to_d = normals_spoke(tip, d);
    sum = normals_triangle(view, tip, sum, hd + to_high - to_d, high, d);
    sum = normals_triangle(view, tip, sum, da + to_d - to_a, d, a);
    return normals_total(tip, sum, two_sided || (tip.side > 0.0) == (falls.x == falls.y));
}

// The same of a convex polygon of 3 to 8 vertices.
vec2 normals_polygon(NormalsView view, vec3 vertices[8], uint count, bool two_sided) {
    uint number = clamp(count, 3u, 8u);
    vec3 a = vertices[number - 1u];
    NormalsCorner setting = normals_corner(view, a);
    NormalsCorner rising = setting;
    vec3 flux = vec3(0.0);
    float highest = 0.0;
    for (uint i = 0u; i < 8u; i++) {
        if (i < number) {
            vec3 b = vertices[i];
            if (a.z > 0.0 || b.z > 0.0) {
                NormalsSide side = normals_side(view, a, b);
                flux = normals_edge(view, flux, side.begin, side.end);
                if (a.z <= 0.0) {
                    rising = side.begin;
                }
                if (b.z <= 0.0) {
                    setting = side.end;
                }
            }
            highest = max(highest, b.z);
            a = b;
        }
    }
    if (highest <= 0.0) {
        return vec2(0.0);
    }
    vec3 horizon = normals_edge(view, vec3(0.0), setting, rising);
    NormalsTip tip = normals_tip(view, flux + horizon);
    vec3 spokes = normals_spoke(tip, setting) - normals_spoke(tip, rising);
    NormalsSum sum = NormalsSum(vec2(0.0), vec3(0.0));
    sum = normals_triangle(view, tip, sum, horizon + spokes, setting, rising);
    for (uint i = 0u; i < 8u; i++) {
        if (i < number) {
            vec3 b = vertices[i];
            if (a.z > 0.0 || b.z > 0.0) {
                NormalsSide side = normals_side(view, a, b);
                vec3 spokes = normals_spoke(tip, side.begin) - normals_spoke(tip, side.end);
                vec3 triangle = normals_edge(view, spokes, side.begin, side.end);
                sum = normals_triangle(view, tip, sum, triangle, side.begin, side.end);
            }
            a = b;
        }
    }
    return normals_total(tip, sum, two_sided || tip.side > 0.0);
}

// The same of a disk by its half axes, lit from the side of their cross product: the octagon of its area.
vec2 normals_disk(NormalsView view, vec3 centre, vec3 half_x, vec3 half_y, bool two_sided) {
    vec3 vertices[8] = vec3[8](vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0));
    vec2 turn = vec2(0.97368348, 0.4033129);
    for (uint i = 0u; i < 8u; i++) {
        vertices[i] = centre + half_x * turn.x + half_y * turn.y;
        turn = 0.70710678 * vec2(turn.x + turn.y, turn.y - turn.x);
    }
    return normals_polygon(view, vertices, 8u, two_sided);
}
`;
