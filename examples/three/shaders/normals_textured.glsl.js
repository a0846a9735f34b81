export default /* glsl */ `// SPDX-License-Identifier: MIT OR Apache-2.0
// ltcforge 0.1.0, revision 1, sha256 of the text below: a083211c34d8afbf
// Area lights on GGX without a table, in the space of its normals, by rule balanced.
//
//   normals_view(alpha_x, alpha_y, wo)  once for a point and view: roughness, and the view in the tangent frame, normal +z.
//   normals_rectangle, normals_polygon, normals_disk  for each light. Vertices are relative to the point in that frame and
//       run clockwise seen from the lit side; a rectangle's third is not read.
//       Light of radiance L arrives as L (f0 (x - y) + f90 y).
//
// PICTURES ON LIGHTS
//   normals_textured_rectangle(view, corners, two_sided, picture, base)
//       parts, as normals_rectangle has them, and colour: light arrives as that of radiance colour.
//       The picture's upper left is at the first corner, its rows run to the second, its columns to the fourth; all four
//       are read. picture is a layer of normals_pictures, a 2D array with all levels that light-texture writes; base is
//       log2(sqrt(width height)) - 1 of its first level, whose texels are best square on the light.
//       normals_picture_sampler is linear between texels and levels and clamps to the edge.
//       NORMALS_READINGS, a constant, says how often a picture is read: 4.
//   normals_profile_rectangle(view, corners, two_sided, picture)
//       the same of a lamp whose radiance depends on the direction, as its IES profile tells it: picture is a layer with all
//       levels that light-texture writes of the profile. Angles around its axis are from the side to the second corner to that to
//       the fourth.
//
// CHECK of the rectangle (-1 -1 1) (1 -1 1) (1 1.5 -0.5) (-1 1.5 -0.5), alpha_x alpha_y (wo): x y, within 0.00002
//   0.3 0.15 (0.36 0.48 0.8): 0.698755 0.000000
//   0.2 0.6 (-0.64 0.48 0.6): 0.547291 0.000000
//   0.05 0.02 (0.576 -0.768 0.28): 0.990908 0.187280

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

// The part of the visible normals times their mean weight: that of the mean normal, a share of that of the vertices, and more
// by the part, as a network tells.
vec2 normals_mean(NormalsView view, vec3 flux, float seen, vec2 rises, vec2 ends, bool two_sided) {
    float part = clamp((two_sided ? abs(seen) : seen) * 0.31830989 / (view.wo.z + view.length_), 0.0, 1.0);
    vec2 at_mean = normals_weight(view, flux);
    float at_vertices = normals_weight_of(view, rises.x);
    float per_length = normals_per_length(flux);
    vec2 alpha = vec2(max(view.alpha.x, view.alpha.y), min(view.alpha.x, view.alpha.y));
    vec4 first = vec4(part, view.rise, at_mean);
    vec4 second = vec4(abs(flux.z) * per_length, alpha, at_vertices);
    vec4 third = vec4(abs(seen) * per_length / view.length_, ends, rises.y);
    vec4 units_0 = max(
        mat4(-0.4517, -5.272, 1.779, -0.2389, -1.26, 1.688, 0.5576, -1.128, -4.275, 1.481, 30.76, -13.12, -1.536, 4.015, 0.03746, -0.6128) * first
        + mat4(0.4828, -0.123, -3.655, 0.951, 0.6037, 1.921, 2.182, 0.009572, 0.3429, -0.8065, 1.27, -1.125, -0.02034, -0.7458, 1.34, -0.6957) * second
        + mat4(3.5, -0.5266, -4.763, 1.63, -0.2434, -2.357, -0.1187, 0.2569, 0.06323, 2.151, -0.3276, 0.2598, -0.02792, -9.115, -1.102, 0.1882) * third
        + vec4(2.287, -3.08, -27.36, 11.93),
        vec4(0.0)
    );
    vec4 units_1 = max(
        mat4(2.373, 1.101, -0.2881, -0.2746, 0.894, 2.18, -3.53, 4.745, 1.452, 0.5634, -9.116, 1.627, -0.4989, 0.7647, -2.529, 1.858) * first
        + mat4(-3.776, -0.923, 0.6106, 5.323, 2.5, 2.561, 0.8376, 0.6629, -1.425, 2.694, 0.7314, -7.277, 0.1632, 1.109, 0.502, 1.195) * second
        + mat4(0.3068, -2.404, 5.645, -8.7, -0.1651, -0.7696, -0.4272, 2.286, 0.2761, 0.01648, 0.2228, 1.936, 0.144, -0.2423, -0.456, -10.35) * third
        + vec4(-2.005, -2.343, 6.88, -4.838),
        vec4(0.0)
    );
    vec4 units_2 = max(
        mat4(0.8842, -0.6139, 0.483, -0.342, -1.322, 0.0633, 0.8474, 1.882, -11.05, -4.906, -14.09, 0.4059, 0.3262, -0.117, 0.09231, 0.7526) * first
        + mat4(-0.4565, -1.156, -0.5831, 0.413, -0.2157, -0.8456, 1.176, 0.5174, -0.3535, 2.117, 0.5998, 0.4314, 0.1399, 3.433, -0.06966, 0.702) * second
        + mat4(-1.07, 0.7266, -0.5591, -0.1247, -0.02631, -5.466, -0.07689, 0.3231, 0.2429, -0.07201, -0.05384, 0.7153, -0.08406, -1.691, 0.174, 0.4504) * third
        + vec4(12.45, 3.613, 13.75, -5.645),
        vec4(0.0)
    );
    vec3 told = mat4x3(-0.003988, -0.2249, 0.01139, 0.1556, 0.04211, 0.2543, 0.05126, -0.008541, -0.02405, 0.01138, 0.03835, -0.1487) * units_0
        + mat4x3(-0.03438, 0.005577, 0.0775, -0.05159, -0.00132, 0.04855, -3.237e-5, 0.1057, -0.02174, -0.09208, -0.05101, -0.2338) * units_1
        + mat4x3(-0.01082, -0.09808, 0.02568, 0.008448, 0.007935, 0.1418, -0.04663, 0.02314, 0.09929, 0.125, 0.09136, -0.1615) * units_2
        + vec3(-8.466e-6, 0.000105, 0.0002346);
    float weight = clamp(at_mean.x + told.z * (at_vertices - at_mean.x) + told.x * part, 0.0, 1.0);
    float m2 = at_mean.y * at_mean.y;
    return part * vec2(weight, clamp(weight * m2 * m2 * at_mean.y + told.y * part, 0.0, weight));
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
    vec3 flux = normals_edge(view, vec3(0.0), a, b);
    NormalsCorner c = normals_corner(view, right_up);
    flux = normals_edge(view, flux, b, c);
    NormalsCorner high = normals_corner(view, right + y);
    flux = normals_edge(view, flux, c, high);
    NormalsCorner d = normals_corner(view, left_up);
    flux = normals_edge(view, normals_edge(view, flux, high, d), d, a);
    float seen = (falls.x != falls.y ? -1.0 : 1.0) * dot(flux, view.stretched);
    vec4 rises = vec4(normals_rise(view, a.w), normals_rise(view, c.w), normals_rise(view, d.w), normals_rise(view, high.w));
    float least = min(min(rises.x, rises.y), min(rises.z, rises.w));
    float most = max(max(rises.x, rises.y), max(rises.z, rises.w));
    vec2 sums = vec2(rises.x + rises.y + rises.z + rises.w, dot(rises, rises));
    return normals_mean(view, flux, seen, 0.25 * sums, vec2(least, most), two_sided);
}

// The same of a convex polygon of 3 to 8 vertices.
vec2 normals_polygon(NormalsView view, vec3 vertices[8], uint count, bool two_sided) {
    uint number = clamp(count, 3u, 8u);
    vec3 a = vertices[number - 1u];
    NormalsCorner setting = normals_corner(view, a);
    NormalsCorner rising = setting;
    vec3 flux = vec3(0.0);
    vec2 sums = vec2(0.0);
    vec2 ends = vec2(1.0, 0.0);
    for (uint i = 0u; i < 8u; i++) {
        if (i < number) {
            vec3 b = vertices[i];
            if (a.z > 0.0 || b.z > 0.0) {
                vec3 cut = vec3(a.xy * abs(b.z) + b.xy * abs(a.z), 0.0);
                NormalsCorner begin = normals_corner(view, a.z > 0.0 ? a : cut);
                NormalsCorner end = normals_corner(view, b.z > 0.0 ? b : cut);
                flux = normals_edge(view, flux, begin, end);
                if (a.z <= 0.0) {
                    rising = begin;
                }
                if (b.z <= 0.0) {
                    setting = end;
                }
            }
            float rise = normals_rise(view, b);
            sums += rise * vec2(1.0, rise);
            ends = vec2(min(ends.x, rise), max(ends.y, rise));
            a = b;
        }
    }
    flux = normals_edge(view, flux, setting, rising);
    return normals_mean(view, flux, dot(flux, view.stretched), sums / float(number), ends, two_sided);
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

// How often a picture is read for a light: 1, 2, 4 or 6.
const uint NORMALS_READINGS = 4u;

// The pictures of lights, a layer each, with all levels that the prefilter makes; the sampler is linear between texels and
// levels, and clamps.
uniform highp sampler2DArray normals_pictures;

// A rectangle by its first corner, the directions of its sides and their lengths.
struct NormalsFrame {
    vec3 corner;
    vec3 x;
    vec3 y;
    vec2 size;
};

// The bump (1 + Q)^-2 on a rectangle: Q grows by one along its longer axis at the root of radii2.x, across at that of radii2.y.
struct NormalsBump {
    vec2 middle;
    vec2 axis;
    vec2 radii2;
};

NormalsFrame normals_frame(vec3 corners[4]) {
    vec3 x = corners[1] - corners[0];
    vec3 y = corners[3] - corners[0];
    vec2 size = max(vec2(length(x), length(y)), vec2(1e-15));
    return NormalsFrame(corners[0], x / size.x, y / size.y, size);
}

// The smaller eigenvalue of a symmetric matrix, xx, xy, yy, and the larger; the direction of the smaller.
vec4 normals_eigen(vec3 m) {
    float mean = 0.5 * (m.x + m.z);
    float apart = 0.5 * (m.x - m.z);
    float distance_ = sqrt(apart * apart + m.y * m.y);
    vec2 v = apart > 0.0 ? vec2(-m.y, apart + distance_) : vec2(distance_ - apart, -m.y);
    float length2 = dot(v, v);
    vec2 axis = length2 > 1e-30 ? v * inversesqrt(max(length2, 1e-30)) : vec2(1.0, 0.0);
    return vec4(mean - distance_, mean + distance_, axis);
}

// Q of a bump, for what lies between a point and the middle.
float normals_quadratic(NormalsBump bump, vec2 d) {
    vec2 q = vec2(dot(d, bump.axis), d.y * bump.axis.x - d.x * bump.axis.y);
    return q.x * q.x / bump.radii2.x + q.y * q.y / bump.radii2.y;
}

// Where a lamp's profile is read for a point of its light, and the radius of that reading, squared, over the profile's area: at
// the tangents of the direction from there to the shaded point, from -4 to 4, and no wider than a square of the light's area.
vec3 normals_profile(NormalsFrame frame, vec2 p, float radius2) {
    float area = frame.size.x * frame.size.y;
    float distance_ = abs(dot(frame.corner, cross(frame.x, frame.y)));
    float per_span = 0.125 / max(distance_, 1e-6 * (frame.size.x + frame.size.y));
    vec2 foot = -vec2(dot(frame.corner, frame.x), dot(frame.corner, frame.y));
    float narrower = radius2 * (area / (area + 12.0 * radius2));
    return vec3(0.5 + per_span * (foot - p), per_span * per_span * narrower);
}

// How high a point is above where the light ends, the surface.
float normals_height(NormalsView view, vec3 p) {
    return p.z;
}

// The lobe on a light's plane over a bump whose Q is quadratic there, up to a factor.
float normals_share(NormalsView view, vec3 p, float quadratic) {
    float r = sqrt(dot(p, p));
    vec3 c = view.image * r + p * vec3(view.per_alpha, 1.0);
    float ratio = max(r + dot(view.wo, p), 1e-6 * r) / max(dot(c, c), 1e-30);
    vec3 stretched = vec3(view.alpha * p.xy, p.z);
    float z = max(p.z, 0.0);
    float shadowed = view.length_ * z + view.wo.z * sqrt(dot(stretched, stretched));
    float fall = (1.0 + quadratic) * ratio;
    return fall * fall * (z + 1e-6 * shadowed) / max(r * shadowed, 1e-30);
}

// The mean of a picture or of a lamp's profile, read along the longer axis of a bump where that is within the rectangle and above
// the lobe's end. picture is the layer, base the binary logarithm of halves of the root of how many texels its first level has.
vec3 normals_colour(
    NormalsView lobe,
    NormalsFrame frame,
    NormalsBump bump,
    uint picture,
    float base,
    bool is_profile
) {
    float unit = sqrt(max(bump.radii2.x - bump.radii2.y, 1e-12 * bump.radii2.x));
    vec2 along = bump.axis * unit;
    // Where functions that are linear along it are not negative.
    vec3 middle = frame.corner + bump.middle.x * frame.x + bump.middle.y * frame.y;
    float height = normals_height(lobe, middle);
    float rise = normals_height(lobe, along.x * frame.x + along.y * frame.y);
    vec2 per_slope = 1.0 / mix(along, vec2(1e-15), lessThan(abs(along), vec2(1e-15)));
    vec2 halves = 0.5 * frame.size;
    vec2 centre = (halves - bump.middle) * per_slope;
    vec2 reach = halves * abs(per_slope);
    float border = -height / (abs(rise) < 1e-15 ? 1e-15 : rise);
    float low = max(max(centre.x - reach.x, centre.y - reach.y), rise < 0.0 ? -1e4 : border);
    float high = min(min(centre.x + reach.x, centre.y + reach.y), rise < 0.0 ? border : 1e4);
    vec2 t = clamp(vec2(low, high), vec2(-1e4), vec2(1e4));
    t = t.x > t.y ? vec2(0.5 * (t.x + t.y)) : t;
    vec2 s = t * inversesqrt(1.0 + t * t);
    float part = (s.y - s.x) / float(NORMALS_READINGS);
    float spread = NORMALS_READINGS == 1u ? 1.5625 : 0.9025;
    float per_area = 1.0 / (frame.size.x * frame.size.y);
    vec4 sum = vec4(0.0);
    for (uint i = 0u; i < NORMALS_READINGS; i++) {
        float at = s.x + part * (float(i) + 0.5);
        float reach = clamp(at * inversesqrt(max(1.0 - at * at, 1e-12)), t.x, t.y);
        float stretch2 = 1.0 + reach * reach;
        float gap = 0.35 * unit * min(part * stretch2 * sqrt(stretch2), t.y - t.x);
        vec2 wanted = bump.middle + reach * along;
        vec2 p = clamp(wanted, vec2(0.0), frame.size);
        vec2 moved = wanted - p;
        float radius2 = spread * (bump.radii2.y * stretch2 + gap * gap) + dot(moved, moved);
        vec3 place = vec3(p / frame.size, radius2 * per_area);
        if (is_profile) {
            place = normals_profile(frame, p, radius2);
        }
        float level = base + 0.5 * log2(place.z);
        float quadratic = normals_quadratic(bump, p - bump.middle);
        float weight = normals_share(lobe, frame.corner + p.x * frame.x + p.y * frame.y, quadratic);
        vec4 read = textureLod(normals_pictures, vec3(place.xy, picture), level);
        sum += weight * vec4(read.xyz, 1.0);
    }
    return sum.xyz / sum.w;
}

// What a light with a picture reflects: the two parts of the whole light, and the picture's colour for both.
struct NormalsTextured {
    vec2 parts;
    vec3 colour;
};

// xx, xy, yy of a vector's product with itself.
vec3 normals_square(vec2 v) {
    return vec3(v.x * v.x, v.x * v.y, v.y * v.y);
}

// The bump that the lobe is close to, where the normal A c reflects the light: of q = |c|^2 sqrt(r) / (r + wo . P), nearly
// quadratic.
NormalsBump normals_bump(NormalsView view, NormalsFrame frame, vec3 flux) {
    vec3 h = vec3(view.alpha * flux.xy, flux.z);
    vec3 wi = 2.0 * dot(view.wo, h) * h - dot(h, h) * view.wo;
    vec3 normal = cross(frame.x, frame.y);
    float distance_ = dot(frame.corner, normal);
    float facing = distance_ < 0.0 ? -1.0 : 1.0;
    float descent = max(max(facing * dot(wi, normal), 1e-4 * dot(h, h)), 1e-30);
    vec3 met = (facing * distance_ / descent) * wi - frame.corner;
    vec2 at = clamp(vec2(dot(frame.x, met), dot(frame.y, met)), vec2(0.0), frame.size);

    vec3 p = frame.corner + at.x * frame.x + at.y * frame.y;
    float per_r = inversesqrt(max(dot(p, p), 1e-30));
    float r = dot(p, p) * per_r;
    vec3 c = view.image * r + p * vec3(view.per_alpha, 1.0);
    float per_n = 1.0 / max(dot(c, c), 1e-30);
    float per_e = 1.0 / max(r + dot(view.wo, p), 1e-6 * r);
    // Derivatives of r, c, ln |c|^2 and ln (r + wo . P).
    vec2 dr = per_r * vec2(dot(p, frame.x), dot(p, frame.y));
    vec3 cx = view.image * dr.x + frame.x * vec3(view.per_alpha, 1.0);
    vec3 cy = view.image * dr.y + frame.y * vec3(view.per_alpha, 1.0);
    vec2 n = 2.0 * per_n * vec2(dot(c, cx), dot(c, cy));
    vec2 e = per_e * (dr + vec2(dot(view.wo, frame.x), dot(view.wo, frame.y)));
    vec2 gradient = n + 0.5 * per_r * dr - e;
    float bend = per_r * (2.0 * per_n * dot(c, view.image) + 0.5 * per_r - per_e);
    float bent = bend + 0.5 * per_r * per_r;
    vec3 second = 2.0 * per_n * vec3(dot(cx, cx), dot(cx, cy), dot(cy, cy)) + vec3(bend, 0.0, bend) + normals_square(e)
        + normals_square(gradient) - normals_square(n) - bent * normals_square(dr);

    vec4 eigen = normals_eigen(second);
    vec2 w = max(eigen.xy, vec2(0.1 / (frame.size.x * frame.size.y)));
    vec2 axis = eigen.zw;
    vec2 g = vec2(dot(gradient, axis), gradient.y * axis.x - gradient.x * axis.y);
    vec2 shift = g / w;
    float twice = 2.0 * max(1.0 - 0.5 * dot(g, shift), 0.1);
    return NormalsBump(at - shift.x * axis - shift.y * vec2(-axis.y, axis.x), axis, twice / w);
}

// The same of a rectangle with a picture or a lamp's profile: the parts of the whole light, and the colour of what is reflected.
NormalsTextured normals_shown_rectangle(NormalsView view, vec3 corners[4], bool two_sided, uint picture, float base, bool is_profile) {
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
        return NormalsTextured(vec2(0.0), vec3(0.0));
    }
    vec2 slide = -1.0 / max(vec2(x.z, y.z), vec2(1e-15));
    vec3 right_up = right + clamp(right.z * slide.y, 0.0, 1.0) * y;
    vec3 left_up = left + clamp(left.z * slide.x, 0.0, 1.0) * x;
    // The side on the horizon, or one point.
    NormalsCorner a = normals_corner(view, left.z <= 0.0 ? left_up : low + clamp(low.z * slide.y, 0.0, 1.0) * y);
    NormalsCorner b = normals_corner(view, right.z <= 0.0 ? right_up : low + clamp(low.z * slide.x, 0.0, 1.0) * x);
    vec3 flux = normals_edge(view, vec3(0.0), a, b);
    NormalsCorner c = normals_corner(view, right_up);
    flux = normals_edge(view, flux, b, c);
    NormalsCorner high = normals_corner(view, right + y);
    flux = normals_edge(view, flux, c, high);
    NormalsCorner d = normals_corner(view, left_up);
    flux = normals_edge(view, normals_edge(view, flux, high, d), d, a);
    float seen = (falls.x != falls.y ? -1.0 : 1.0) * dot(flux, view.stretched);
    vec4 rises = vec4(normals_rise(view, a.w), normals_rise(view, c.w), normals_rise(view, d.w), normals_rise(view, high.w));
    float least = min(min(rises.x, rises.y), min(rises.z, rises.w));
    float most = max(max(rises.x, rises.y), max(rises.z, rises.w));
    vec2 sums = vec2(rises.x + rises.y + rises.z + rises.w, dot(rises, rises));
    vec2 parts = normals_mean(view, flux, seen, 0.25 * sums, vec2(least, most), two_sided);
    NormalsFrame frame = normals_frame(corners);
    vec3 colour = normals_colour(view, frame, normals_bump(view, frame, flux), picture, base, is_profile);
    return NormalsTextured(parts, colour);
}

// A rectangle with a picture.
NormalsTextured normals_textured_rectangle(
    NormalsView view,
    vec3 corners[4],
    bool two_sided,
    uint picture,
    float base
) {
    return normals_shown_rectangle(view, corners, two_sided, picture, base, false);
}

// A lamp with a profile, of 512 x 512 texels.
NormalsTextured normals_profile_rectangle(
    NormalsView view,
    vec3 corners[4],
    bool two_sided,
    uint picture
) {
    return normals_shown_rectangle(view, corners, two_sided, picture, 8.0, true);
}
`;
