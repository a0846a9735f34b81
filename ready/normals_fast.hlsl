// SPDX-License-Identifier: MIT OR Apache-2.0
// ltcforge 0.1.0, revision 1, sha256 of the text below: c0f14db8c54f0ad4
// Area lights on GGX without a table, in the space of its normals, by rule fast.
//
//   normals_view(alpha_x, alpha_y, wo)  once for a point and view: roughness, and the view in the tangent frame, normal +z.
//   normals_rectangle, normals_polygon, normals_disk  for each light. Vertices are relative to the point in this frame and
//       run clockwise as seen from the side that emits. The third corner of a rectangle is not read.
//       Light of radiance L arrives as L (f0 (x - y) + f90 y).
//
// CHECK of the rectangle (-1 -1 1) (1 -1 1) (1 1.5 -0.5) (-1 1.5 -0.5), alpha_x alpha_y (wo): x y, within 0.00002
//   0.3 0.15 (0.36 0.48 0.8): 0.695982 0.000554
//   0.2 0.6 (-0.64 0.48 0.6): 0.544837 0.002457
//   0.05 0.02 (0.576 -0.768 0.28): 0.989561 0.186979

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

// The angle between two unit vectors, divided by its sine. Relative error below 8e-4.
float normals_angle(float3 a, float3 b) {
    float h = a.x * b.x + (a.y * b.y + (a.z * b.z + 1.0000002));
    return (2.2214415 + h * 0.4152027) * rsqrt(h) + (-0.9720743 + h * -0.0933735);
}

// Adds the integral of c x dc along the arcs of great circles from a to q and from q to n.
float3 normals_arcs(float3 flux, float3 a, float3 q, float3 n) {
    float3 s = normals_angle(q, n) * n - normals_angle(a, q) * a;
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

// Adds the integral of c x dc along the image of an edge, by four arcs. The image is the conic a + 2 t b + t^2 c.
float3 normals_edge(NormalsView view, float3 flux, NormalsCorner begin, NormalsCorner end) {
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
    float3 q = a + n + (least + more * dot(left, left)) * left;
    float3 r = c + n + (least + more * dot(right, right)) * right;
    return normals_arcs(normals_arcs(flux, a, q * normals_per_length(q), n), n, r * normals_per_length(r), c);
}

// The fraction of the visible normals that reflect the light, times their mean weight. A small network corrects the
// weight of the mean normal, from the weight at the vertices and from the fraction.
float2 normals_mean(NormalsView view, float3 flux, float projected, float rise, bool two_sided) {
    float part = saturate((two_sided ? abs(projected) : projected) * 0.31830989 / (view.wo.z + view.length));
    float2 at_mean = normals_weight(view, flux);
    float at_vertices = normals_weight_of(view, rise);
    float per_length = normals_per_length(flux);
    float2 alpha = float2(max(view.alpha.x, view.alpha.y), min(view.alpha.x, view.alpha.y));
    float4 first = float4(part, view.rise, at_mean);
    float4 second = float4(abs(flux.z) * per_length, alpha, at_vertices);
    float3 units_0 = max(
        mul(first, float4x3(0.957, -0.2205, 0.6027, -1.39, -0.5151, 0.9099, -10.86, 9.136, -6.964, 0.2335, -0.0706, 0.5823))
        + mul(second, float4x3(0.1728, 0.4426, -1.059, -1.234, -0.7694, 2.05, -0.7549, -0.2645, 1.341, -0.01225, -0.1219, 1.024))
        + float3(10.96, -8.294, 4.826),
        (float3)0.0
    );
    float3 outputs = mul(units_0, float3x3(-0.03396, -0.1141, -0.04112, 0.01311, -0.004379, -0.3055, -0.04821, 0.008404, 0.1643))
        + float3(-0.005077, 0.001849, 0.1108);
    float weight = saturate(at_mean.x + outputs.z * (at_vertices - at_mean.x) + outputs.x * part);
    float m2 = at_mean.y * at_mean.y;
    return part * float2(weight, clamp(weight * m2 * m2 * at_mean.y + outputs.y * part, 0.0, weight));
}

// The reflected light of a rectangle of radiance one: for a Fresnel factor of one (x), and weighted by Schlick's
// (1 - wo . h)^5 (y).
float2 normals_rectangle(NormalsView view, float3 corners[4], bool two_sided) {
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
        return (float2)0.0;
    }
    float2 slide = -1.0 / max(float2(x.z, y.z), (float2)1e-15);
    float3 right_up = right + saturate(right.z * slide.y) * y;
    float3 left_up = left + saturate(left.z * slide.x) * x;
    // a and b are the ends of the lowest side after clipping. They are equal if the surface cuts nothing off.
    NormalsCorner a = normals_corner(view, left.z <= 0.0 ? left_up : low + saturate(low.z * slide.y) * y);
    NormalsCorner b = normals_corner(view, right.z <= 0.0 ? right_up : low + saturate(low.z * slide.x) * x);
    float3 flux = normals_edge(view, (float3)0.0, a, b);
    NormalsCorner c = normals_corner(view, right_up);
    flux = normals_edge(view, flux, b, c);
    NormalsCorner high = normals_corner(view, right + y);
    flux = normals_edge(view, flux, c, high);
    NormalsCorner d = normals_corner(view, left_up);
    flux = normals_edge(view, normals_edge(view, flux, high, d), d, a);
    float projected = (falls.x != falls.y ? -1.0 : 1.0) * dot(flux, view.stretched);
    float rise = normals_rise(view, a.w) + normals_rise(view, c.w) + normals_rise(view, d.w) + normals_rise(view, high.w);
    return normals_mean(view, flux, projected, 0.25 * rise, two_sided);
}

// The reflected light of a convex polygon with 3 to 8 vertices, as in normals_rectangle.
float2 normals_polygon(NormalsView view, float3 vertices[8], uint count, bool two_sided) {
    uint number = clamp(count, 3u, 8u);
    float3 a = vertices[number - 1u];
    NormalsCorner setting = normals_corner(view, a);
    NormalsCorner rising = setting;
    float3 flux = (float3)0.0;
    float rise = 0.0;
    for (uint i = 0u; i < 8u; i++) {
        if (i < number) {
            float3 b = vertices[i];
            if (a.z > 0.0 || b.z > 0.0) {
                float3 cut = float3(a.xy * abs(b.z) + b.xy * abs(a.z), 0.0);
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
            rise += normals_rise(view, b);
            a = b;
        }
    }
    flux = normals_edge(view, flux, setting, rising);
    return normals_mean(view, flux, dot(flux, view.stretched), rise / float(number), two_sided);
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
