// SPDX-License-Identifier: MIT OR Apache-2.0
// ltcforge 0.1.0, revision 3, sha256 of the text below: 9b68ab5dc537015e
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

// A surface seen from direction wo. A = diag(alpha, 1).
struct NormalsView {
    float2 alpha;
    float2 per_alpha;
    float3 wo;
    float3 image; // A^-1 wo
    float3 stretched; // A wo
    float length; // length of A wo
    float rise; // rise of wo
};

NormalsView NormalsViewOf(float2 alpha, float2 per_alpha, float3 wo, float3 image, float3 stretched, float length, float rise) {
    NormalsView made = { alpha, per_alpha, wo, image, stretched, length, rise };
    return made;
}

// Computes the view for all lights at a point. alpha is in (0, 1]. wo is a unit vector in the tangent frame,
// normal +z.
NormalsView normals_view(float alpha_x, float alpha_y, float3 wo) {
    float2 alpha = max(float2(alpha_x, alpha_y), (float2)1e-5);
    float3 stretched = float3(alpha * wo.xy, wo.z);
    float length_ = sqrt(dot(stretched, stretched));
    return NormalsViewOf(alpha, 1.0 / alpha, wo, float3(wo.xy / alpha, wo.z), stretched, length_, wo.z / length_);
}

// One over the length of a vector; finite for a zero vector.
float normals_per_length(float3 v) {
    return rsqrt(v.x * v.x + (v.y * v.y + (v.z * v.z + 1e-30)));
}

// The rise z / |A w| of a direction; zero below the surface.
float normals_rise(NormalsView view, float3 w) {
    return max(w.z, 0.0) * normals_per_length(float3(view.alpha * w.xy, w.z));
}

// Smith's G2 / G1 from the rise of the light direction: the fraction that is not shadowed.
float normals_weight_of(NormalsView view, float rise) {
    return (1.0 + view.rise) * rise / (rise + view.rise);
}

// G2 / G1 for the normal A c (x), and 1 - wo . h (y). c may have any length and sign.
float2 normals_weight(NormalsView view, float3 c) {
    float3 normal = float3(view.alpha * c.xy, c.z);
    float3 h = normal * normals_per_length(normal);
    float cosine = dot(view.wo, h);
    float rise = normals_rise(view, 2.0 * cosine * h - view.wo);
    return float2(normals_weight_of(view, rise), saturate(1.0 - abs(cosine)));
}

// The angle between two unit vectors, divided by its sine. Relative error below 1.3e-4.
float normals_angle(float3 a, float3 b) {
    float h = a.x * b.x + (a.y * b.y + (a.z * b.z + 1.0000002));
    return (2.2214415 + h * (0.5054863 + h * 0.0397516)) * rsqrt(h) + (-0.9934988 + h * -0.2022361);
}

// Adds the integral of c x dc along the arcs of great circles from a to q and from q to n.
float3 normals_arcs(float3 flux, float3 a, float3 q, float3 n) {
    // Subtracting q changes nothing, because q x q is zero, but keeps the digits of short arcs.
    float3 s = normals_angle(q, n) * (n - q) - normals_angle(a, q) * (a - q);
    return float3(flux.x + q.y * s.z - q.z * s.y, flux.y + q.z * s.x - q.x * s.z, flux.z + q.x * s.y - q.y * s.x);
}

// A corner of a light: its direction w, the image A^-1 (wo + w), the unit vector c along the image, and the image's
// length.
struct NormalsCorner {
    float3 w;
    float3 image;
    float3 c;
    float length;
};

NormalsCorner NormalsCornerOf(float3 w, float3 image, float3 c, float length) {
    NormalsCorner made = { w, image, c, length };
    return made;
}

NormalsCorner normals_corner(NormalsView view, float3 v) {
    float3 w = v * normals_per_length(v);
    float3 image = w * float3(view.per_alpha, 1.0) + view.image;
    float length2 = image.x * image.x + (image.y * image.y + (image.z * image.z + 1e-30));
    float per_length = rsqrt(length2);
    return NormalsCornerOf(w, image, image * per_length, length2 * per_length);
}

// The image of an edge by four arcs: the integral of c x dc along it, added to an earlier one; the point halfway between
// both ends; and the points where the arcs of each half meet.
struct NormalsEdge {
    float3 flux;
    float3 middle;
    float3 q;
    float3 r;
};

NormalsEdge NormalsEdgeOf(float3 flux, float3 middle, float3 q, float3 r) {
    NormalsEdge made = { flux, middle, q, r };
    return made;
}

// The image is the conic a + 2 t b + t^2 c.
NormalsEdge normals_edge(NormalsView view, float3 flux, NormalsCorner begin, NormalsCorner end) {
    float3 a = begin.c;
    float3 c = end.c;
    float3 sum = begin.w + end.w;
    float y = sum.x * sum.x + (sum.y * sum.y + (sum.z * sum.z + 1e-12));
    float3 image = begin.image + end.image + (0.5 * y - 2.0) * view.image;
    float3 b = image * rsqrt(y * (begin.length * end.length));
    // Split the conic at the point equally far from both ends, if the ends differ.
    float3 apart = a - c;
    float bend = 2.0 * dot(b, apart) / (apart.x * apart.x + (apart.y * apart.y + (apart.z * apart.z + 1e-8)));
    float t = bend + sqrt(bend * bend + 1.0);
    float3 left = a + t * b;
    float3 right = b + t * c;
    float3 middle = left + t * right;
    float per_length = normals_per_length(middle);
    float3 n = per_length * middle;
    // The arcs of each half meet a little outside the conic, so that they enclose its area.
    float root = sqrt(per_length);
    float least = 3.4 * root;
    float more = 0.6 * per_length * root;
    float3 beyond_left = a + n + (least + more * dot(left, left)) * left;
    float3 beyond_right = c + n + (least + more * dot(right, right)) * right;
    float3 q = beyond_left * normals_per_length(beyond_left);
    float3 r = beyond_right * normals_per_length(beyond_right);
    return NormalsEdgeOf(normals_arcs(normals_arcs(flux, a, q, n), n, r, c), n, q, r);
}

// Sums over the edges of a light. flux: the integral of c x dc. sums: the values of normals_sample, times the size of
// the edge among the visible normals. size: these sizes.
struct NormalsSum {
    float3 flux;
    float4 sums;
    float size;
};

NormalsSum NormalsSumOf(float3 flux, float4 sums, float size) {
    NormalsSum made = { flux, sums, size };
    return made;
}

float normals_fifth(float x) {
    return x * x * (x * x) * x;
}

// For the normal A c: the weight G2 / G1 divided by 1 + view.rise; the rise of the reflected view direction; the weight
// times Schlick's factor; the squared weight.
float4 normals_sample(NormalsView view, float3 c) {
    float3 h = float3(view.alpha * c.xy, c.z);
    float along = dot(view.wo, h);
    float h2 = dot(h, h);
    float rise = normals_rise(view, 2.0 * along * h - h2 * view.wo);
    float weight = rise / (rise + view.rise);
    return float4(weight, rise, weight * normals_fifth(saturate(1.0 - abs(along) * rsqrt(h2))), weight * weight);
}

// The samples of an edge: its middle.
float4 normals_samples(NormalsView view, NormalsEdge edge) {
    return normals_sample(view, edge.middle);
}

// Adds an edge. On the horizon the weight is zero.
NormalsSum normals_add(NormalsView view, NormalsSum sum, NormalsCorner begin, NormalsCorner end, bool is_above) {
    NormalsEdge edge = normals_edge(view, sum.flux, begin, end);
    float3 half_ = edge.middle - begin.c;
    float size = sqrt(dot(half_, half_)) * saturate(dot(edge.middle, view.stretched));
    if (!is_above) {
        return NormalsSumOf(edge.flux, sum.sums, sum.size + size);
    }
    return NormalsSumOf(edge.flux, sum.sums + size * normals_samples(view, edge), sum.size + size);
}

// The mean of the weight (x) and of the weight times Schlick's factor (y) over the light. They are blends of the values
// at the mean normal, at the mean rise of the outline, and along the outline, with shares from a network. A
// correction proportional to the extent follows. It needs no clamp, which would draw contours into highlights.
float2 normals_blend(float2 at_mean, float at_rise, float2 outline, float extent, float4 outputs, float fifth) {
    float2 near_ = saturate(outputs.wx);
    float2 shares = near_ * near_ * (3.0 - 2.0 * near_);
    float3 bounded = float3(outputs.yz, fifth) / (1.0 + abs(float3(outputs.yz, fifth)));
    float around = at_rise + shares.x * (outline.x - at_rise);
    float known = around + shares.y * (at_mean.x - around);
    float weight = known * (1.0 + extent * bounded.x * (1.0 - known));
    float schlick = at_mean.y + (0.5 + 0.5 * bounded.z) * (outline.y - at_mean.y);
    return weight * float2(1.0, schlick * (1.0 + extent * bounded.y * (1.0 - schlick)));
}

// The fraction of the visible normals that reflect the light, times their mean weight.
float2 normals_mean(NormalsView view, NormalsSum sum, float projected, bool two_sided) {
    float part = saturate((two_sided ? abs(projected) : projected) * 0.31830989 / (view.wo.z + view.length));
    float2 at_mean = normals_weight(view, sum.flux);
    float scale = 1.0 + view.rise;
    float4 means = sum.sums * (float4(scale, 1.0, scale, scale * scale) / max(sum.size, 1e-20));
    float at_rise = normals_weight_of(view, means.y);
    float extent = sum.size * sum.size;
    float4 first = float4(part, view.rise, at_mean);
    float4 second = float4(max(view.alpha.x, view.alpha.y), min(view.alpha.x, view.alpha.y), at_rise, means.x);
    float third = sum.size;
    float4 sum_0 = mul(first, float4x4(-10.97, 0.3589, 0.4507, -0.04585, 0.04056, 19.83, -0.7741, 0.2623, 3.904, 11.6, 4.484, 1.37, 1.796, 0.1187, 0.5416, 2.782))
        + mul(second, float4x4(0.7183, -2.207, -2.359, -0.5499, 0.3575, 0.343, -0.8699, 1.698, -4.729, -1.354, 0.2741, 1.058, 0.6109, 2.047, -1.227, 0.9754))
        + float4(1.031, -0.2568, -0.04868, 0.3217) * third
        + float4(-1.733, -30.7, -1.4, -4.092);
    float4 units_0 = sum_0 + sqrt(sum_0 * sum_0 + 1.0);
    float4 outputs = mul(units_0, float4x4(-0.2265, -0.04962, -0.2762, 0.02247, 0.06334, -0.6608, 0.1095, -0.4541, 0.05504, 0.3706, -0.2145, -0.1937, -0.04367, -0.3634, -0.1784, 0.1189))
        + float4(0.6106, 0.2974, 1.157, 1.223);
    float fifth = dot(float4(0.1535, -11.78, -0.2551, 1.225), units_0)
        + -3.635;
    float2 outline = float2(means.x, means.z / (means.x + 1e-6));
    return part * normals_blend(float2(at_mean.x, normals_fifth(at_mean.y)), at_rise, outline, extent / (extent + 1.0), outputs, fifth);
}

// Reflected light, and the integral of c x dc along the image of the light's outline: it points along the mean normal or
// against it.
struct NormalsLit {
    float2 light;
    float3 flux;
};

NormalsLit NormalsLitOf(float2 light, float3 flux) {
    NormalsLit made = { light, flux };
    return made;
}

// The same with the mean normal, for samplers.
NormalsLit normals_rectangle_lit(NormalsView view, float3 corners[4], bool two_sided) {
    // Orient both sides so that they rise. A corner below the surface slides up along its side.
    float2 falls = float2(corners[1].z, corners[3].z) < corners[0].zz ? (float2)1.0 : (float2)0.0;
    float3 along = corners[1] - corners[0];
    float3 across = corners[3] - corners[0];
    float3 x = (1.0 - 2.0 * falls.x) * along;
    float3 y = (1.0 - 2.0 * falls.y) * across;
    float3 low = corners[0] + falls.x * along + falls.y * across;
    float3 right = low + x;
    float3 left = low + y;
    if (right.z + y.z <= 0.0) {
        return NormalsLitOf((float2)0.0, (float3)0.0);
    }
    float2 slide = -1.0 / max(float2(x.z, y.z), (float2)1e-15);
    float3 right_up = right + saturate(right.z * slide.y) * y;
    float3 left_up = left + saturate(left.z * slide.x) * x;
    // a and b are the ends of the lowest side after clipping. They are equal if the surface cuts nothing off; otherwise
    // this side lies on the horizon.
    NormalsCorner a = normals_corner(view, left.z <= 0.0 ? left_up : low + saturate(low.z * slide.y) * y);
    NormalsCorner b = normals_corner(view, right.z <= 0.0 ? right_up : low + saturate(low.z * slide.x) * x);
    NormalsSum sum = normals_add(view, (NormalsSum)0, a, b, false);
    NormalsCorner c = normals_corner(view, right_up);
    sum = normals_add(view, sum, b, c, true);
    NormalsCorner high = normals_corner(view, right + y);
    sum = normals_add(view, sum, c, high, true);
    NormalsCorner d = normals_corner(view, left_up);
    sum = normals_add(view, normals_add(view, sum, high, d, true), d, a, true);
    float projected = (falls.x != falls.y ? -1.0 : 1.0) * dot(sum.flux, view.stretched);
    return NormalsLitOf(normals_mean(view, sum, projected, two_sided), sum.flux);
}

// The reflected light of a rectangle of radiance one: for a Fresnel factor of one (x), and weighted by Schlick's
// (1 - wo . h)^5 (y).
float2 normals_rectangle(NormalsView view, float3 corners[4], bool two_sided) {
    return normals_rectangle_lit(view, corners, two_sided).light;
}

// The same with the mean normal, for samplers.
NormalsLit normals_polygon_lit(NormalsView view, float3 vertices[8], uint count, bool two_sided) {
    uint number = clamp(count, 3u, 8u);
    float3 a = vertices[number - 1u];
    NormalsCorner setting = normals_corner(view, a);
    NormalsCorner rising = setting;
    NormalsSum sum = (NormalsSum)0;
    for (uint i = 0u; i < 8u; i++) {
        if (i < number) {
            float3 b = vertices[i];
            // Below the surface, begin and end are one point of the horizon.
            float3 cut = float3(a.xy * abs(b.z) + b.xy * abs(a.z), 0.0);
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
    return NormalsLitOf(normals_mean(view, sum, dot(sum.flux, view.stretched), two_sided), sum.flux);
}

// The reflected light of a convex polygon with 3 to 8 vertices, as in normals_rectangle.
float2 normals_polygon(NormalsView view, inout float3 vertices[8], uint count, bool two_sided) {
    return normals_polygon_lit(view, vertices, count, two_sided).light;
}

// The reflected light of a disk, replaced by the regular octagon of the same area. The disk emits towards half_x x
// half_y.
float2 normals_disk(NormalsView view, float3 centre, float3 half_x, float3 half_y, bool two_sided) {
    float3 vertices[8] = { (float3)0.0, (float3)0.0, (float3)0.0, (float3)0.0, (float3)0.0, (float3)0.0, (float3)0.0, (float3)0.0 };
    float2 turn = float2(0.97368348, 0.4033129);
    for (uint i = 0u; i < 8u; i++) {
        vertices[i] = centre + half_x * turn.x + half_y * turn.y;
        turn = 0.70710678 * float2(turn.x + turn.y, turn.y - turn.x);
    }
    return normals_polygon(view, vertices, 8u, two_sided);
}
