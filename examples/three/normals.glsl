// Area lights on anisotropic GGX in closed form, in the space of its normals: no table.
// Made by ltcforge 0.1.0. SPDX-License-Identifier: MIT OR Apache-2.0
//
// FUNCTIONS
//   normals_view(alpha_x, alpha_y, wo)  a surface seen from a direction, for all lights at the point. GGX roughness along
//       x and y; wo is the view direction in the tangent frame, normal +z, of unit length.
//   normals_rectangle(view, corners, two_sided, rule), normals_polygon(view, vertices, count, two_sided, rule),
//   normals_disk(view, centre, half_x, half_y, two_sided, rule)
//       what is reflected of a light of radiance one: for a Fresnel factor of one, and the part of it that Schlick's
//       (1 - cos)^5 weighs. The light's vertices are relative to the shaded point, in the tangent frame, convex, and run
//       clockwise seen from the lit side; a disk's is towards half_x x half_y.
//   rule  how the weight of shadowing is averaged: 0 over triangles between the mean normal and each edge; 1 at the mean
//       normal, which is cheaper; 2 over twice as many triangles. Give it as a constant: compilers then drop the others.
//   Light of radiance L arrives as L (f0 (x - y) + f90 y).
//
// USE
//   normals_view once for a point and view, then one call for each light. Isotropic surfaces have alpha_x = alpha_y. Nothing
//   is bound. Diffuse light is not here: it is Lambert's form factor of the light.
//
// CHECK
//   The parts of the one-sided rectangle (-1 -1 1) (1 -1 1) (1 1.5 -0.5) (-1 1.5 -0.5),
//   by rules 0 | 1 | 2. A port in 32 bits comes within 0.00002 of each number.
//   alpha_x 0.3 alpha_y 0.15 wo (0.36 0.48 0.8)
//     parts 0.703713 0.000227 | 0.710371 0.000052 | 0.704264 0.000264
//   alpha_x 0.2 alpha_y 0.6 wo (-0.64 0.48 0.6)
//     parts 0.555524 0.001326 | 0.599484 0.000332 | 0.554540 0.001579
//   alpha_x 0.05 alpha_y 0.02 wo (0.576 -0.768 0.28)
//     parts 0.989424 0.186035 | 0.991922 0.187098 | 0.989324 0.186352


precision highp float;
precision highp int;

struct NormalsView {
    vec2 alpha;
    vec2 per_alpha;
    vec3 wo;
    vec3 stretched;
    float length_;
};
struct NormalsCorner {
    vec3 w;
    vec3 c;
    float length_;
    float height;
};
struct NormalsPair {
    vec2 x;
    vec2 y;
    vec2 z;
};
struct NormalsCone {
    vec2 k;
    vec2 n2_;
    vec2 l1_;
    vec2 p;
    vec2 q;
};
struct NormalsLight {
    uint number;
    float per_height;
    bool is_cut;
    NormalsCorner rise;
    NormalsCorner sink;
};
struct NormalsEdge {
    bool is_there;
    NormalsCorner begin;
    NormalsCorner end;
    vec3 curved;
    vec3 middle;
    mat2x3 halves;
    float near;
};
struct NormalsEdges {
    NormalsEdge first;
    NormalsEdge second;
};
struct NormalsOutline {
    vec3 origin;
    vec3 flux;
    uint nearest;
    NormalsCorner begin;
    NormalsCorner end;
    vec3 curved;
    float extents;
    float most;
    float second;
};
struct NormalsSetting {
    bool is_there;
    float share;
    bool is_horizon;
    float wide;
    vec3 begin;
    vec3 control;
    vec3 end;
    vec3 parts[4];
    NormalsEdge horizon;
};
struct NormalsNumbers {
    vec3 edge;
    vec3 horizon;
    vec2 inner;
};
struct NormalsSpoke {
    vec3 c;
    bool is_up;
    vec3 bend;
    vec3 at_end;
};
struct NormalsFan {
    NormalsNumbers numbers;
    vec3 tip;
    vec2 at_tip;
    vec3 tip_sample;
    vec3 seen;
    float per_rise;
    bool is_split;
    NormalsSpoke rise;
    NormalsSpoke sink;
};
struct NormalsSum {
    vec3 all_;
    vec3 positive;
    float unknown;
};
const uint NORMALS_FAN = 0u;
const uint NORMALS_MEAN = 1u;
const uint NORMALS_FINE = 2u;


vec2 normals_ltc_sin_cos(float turns) {
    bool local = false;
    float quarter = floor(((4.0 * turns) + 0.5));
    float x_1 = ((turns - (0.25 * quarter)) * 6.2831855);
    float z = (x_1 * x_1);
    float s = (((((((-0.00019515296 * z) + 0.008332161) * z) - 0.16666655) * z) * x_1) + x_1);
    float c_7 = ((((((((2.4433157e-5 * z) - 0.0013887316) * z) + 0.041666646) * z) * z) - (0.5 * z)) + 1.0);
    uint q = (uint(int(quarter)) & 3u);
    vec2 swapped = (((q & 1u) == 1u) ? vec2(c_7, s) : vec2(s, c_7));
    if (!((q == 1u))) {
        local = (q == 2u);
    } else {
        local = true;
    }
    bool _e64 = local;
    return vec2(((q >= 2u) ? -(swapped.x) : swapped.x), (_e64 ? -(swapped.y) : swapped.y));
}

float normals_ltc_log(float x) {
    int bits = (floatBitsToInt(x) - 1060439283);
    float m_2 = intBitsToFloat(((bits & 8388607) + 1060439283));
    float s_1 = ((m_2 - 1.0) / (m_2 + 1.0));
    float z_1 = (s_1 * s_1);
    float series = (((((((((0.22222222 * z_1) + 0.2857143) * z_1) + 0.4) * z_1) + 0.6666667) * z_1) * s_1) + (2.0 * s_1));
    return ((float((bits >> 23u)) * 0.6931472) + series);
}

NormalsView normals_view(float alpha_x, float alpha_y, vec3 wo) {
    vec2 alpha = max(vec2(alpha_x, alpha_y), vec2(1e-5));
    vec3 stretched = vec3((alpha * wo.xy), wo.z);
    return NormalsView(alpha, (vec2(1.0) / alpha), wo, stretched, sqrt(dot(stretched, stretched)));
}

vec3 normals_unstretched(vec3 h, NormalsView view) {
    return vec3((h.xy * view.per_alpha), h.z);
}

vec3 normals_unit(vec3 v) {
    float length2_ = dot(v, v);
    return (v * ((length2_ > 1e-36) ? inversesqrt(max(length2_, 1e-36)) : 0.0));
}

NormalsCorner normals_corner(vec3 v_1, NormalsView view_1) {
    vec3 _e2 = normals_unit(v_1);
    vec3 _e5 = normals_unstretched((view_1.wo + _e2), view_1);
    float length2_1 = max(dot(_e5, _e5), 1e-36);
    float per_length = inversesqrt(length2_1);
    return NormalsCorner(_e2, (_e5 * per_length), (length2_1 * per_length), v_1.z);
}

NormalsCorner normals_choose(NormalsCorner first, NormalsCorner second, bool is_second) {
    return NormalsCorner((is_second ? second.w : first.w), (is_second ? second.c : first.c), (is_second ? second.length_ : first.length_), (is_second ? second.height : first.height));
}

float normals_half_cosine(NormalsCorner a, NormalsCorner b) {
    vec3 sum_8 = (a.w + b.w);
    return max((0.5 * sqrt(dot(sum_8, sum_8))), 1e-6);
}

NormalsCorner normals_between(NormalsCorner a_1, NormalsCorner b_1, float t, NormalsView view_2) {
    float x_2 = ((1.0 - t) * sqrt(b_1.length_));
    float y = (t * sqrt(a_1.length_));
    float _e16 = normals_half_cosine(a_1, b_1);
    vec3 middle_1 = ((a_1.w + b_1.w) * ((x_2 * y) / _e16));
    NormalsCorner _e27 = normals_corner((((a_1.w * (x_2 * x_2)) + middle_1) + (b_1.w * (y * y))), view_2);
    return _e27;
}

vec2 normals_acute_bend(vec2 chord2_) {
    vec2 z_2 = (chord2_ * 0.25);
    vec2 far = (z_2 * (vec2(2.271551) + (z_2 * (vec2(-3.4068606) + (z_2 * 3.516457)))));
    return (z_2 * (vec2(0.6667554) + (z_2 * (vec2(0.52912635) + (z_2 * (vec2(0.52405584) + (z_2 * (vec2(-0.08954556) + far))))))));
}

vec3 normals_arc_bend(vec3 a_2, vec3 b_2) {
    vec3 across = cross(a_2, b_2);
    bool is_acute = (dot(a_2, b_2) >= 0.0);
    vec3 chord = (is_acute ? (a_2 - b_2) : (a_2 + b_2));
    vec2 _e11 = normals_acute_bend(vec2(dot(chord, chord)));
    float bend = _e11.x;
    float obtuse = (((3.1415927 / sqrt(max(dot(across, across), 1e-18))) - bend) - 2.0);
    return (across * (is_acute ? bend : obtuse));
}

mat2x3 normals_shared(vec3 a_3, vec3 m, vec3 b_3, vec3 whole) {
    vec2 length2_2 = vec2(dot((m - a_3), (m - a_3)), dot((b_3 - m), (b_3 - m)));
    vec2 _e11 = normals_acute_bend(length2_2);
    vec3 arc = (cross(a_3, m) * _e11.x);
    vec3 next_1 = (cross(m, b_3) * _e11.y);
    vec3 rest = (((whole - cross((m - a_3), (b_3 - a_3))) - arc) - next_1);
    vec2 cubes = (length2_2 * sqrt(length2_2));
    vec2 shares = (cubes / vec2(max((cubes.x + cubes.y), 1e-36)));
    return mat2x3((arc + (rest * shares.x)), (next_1 + (rest * shares.y)));
}

NormalsPair normals_pair(vec3 first_1, vec3 second_1) {
    return NormalsPair(vec2(first_1.x, second_1.x), vec2(first_1.y, second_1.y), vec2(first_1.z, second_1.z));
}

vec2 normals_pair_dot(NormalsPair a_4, NormalsPair b_4) {
    return (((a_4.x * b_4.x) + (a_4.y * b_4.y)) + (a_4.z * b_4.z));
}

NormalsPair normals_pair_cross(NormalsPair a_5, NormalsPair b_5) {
    return NormalsPair(((a_5.y * b_5.z) - (a_5.z * b_5.y)), ((a_5.z * b_5.x) - (a_5.x * b_5.z)), ((a_5.x * b_5.y) - (a_5.y * b_5.x)));
}

NormalsPair normals_pair_scaled(NormalsPair a_6, vec2 by) {
    return NormalsPair((a_6.x * by), (a_6.y * by), (a_6.z * by));
}

NormalsPair normals_pair_plus(NormalsPair a_7, NormalsPair b_6) {
    return NormalsPair((a_7.x + b_6.x), (a_7.y + b_6.y), (a_7.z + b_6.z));
}

NormalsPair normals_pair_minus(NormalsPair a_8, NormalsPair b_7) {
    return NormalsPair((a_8.x - b_7.x), (a_8.y - b_7.y), (a_8.z - b_7.z));
}

NormalsPair normals_pair_stretched(NormalsPair v_2, NormalsView view_3) {
    return NormalsPair((view_3.alpha.x * v_2.x), (view_3.alpha.y * v_2.y), v_2.z);
}

vec2 normals_per_sine(vec2 cosine) {
    vec2 x2_ = (cosine * cosine);
    vec2 low = ((vec2(1.5707963) - (0.99998415 * cosine)) + (x2_ * (vec2(0.7849357) - (0.6614053 * cosine))));
    vec2 high = ((vec2(0.55826277) - (0.42721283 * cosine)) + (x2_ * (vec2(0.2563661) - (0.09989328 * cosine))));
    return (low + ((x2_ * x2_) * (high + ((x2_ * x2_) * 0.01813479))));
}

vec2 normals_per_hyperbolic_sine(vec2 u) {
    vec2 sine = sqrt((u * (u + vec2(2.0))));
    vec2 e = ((vec2(1.0) + u) + sine);
    float _e11 = normals_ltc_log(e.x);
    float _e13 = normals_ltc_log(e.y);
    vec2 far_1 = (vec2(_e11, _e13) / max(sine, vec2(1e-30)));
    return mix(far_1, (vec2(1.0) + (u * (vec2(-0.33333334) + (u * (vec2(0.13333333) - (0.057142857 * u)))))), lessThan(u, vec2(0.02)));
}

NormalsCone normals_cone(NormalsView view_4, NormalsPair n, vec2 k) {
    vec3 wo_1 = view_4.wo;
    vec2 _e4 = normals_pair_dot(n, n);
    vec2 squares = (view_4.alpha * view_4.alpha);
    NormalsPair diagonal = NormalsPair((((2.0 * wo_1.x) * n.x) - k), (((2.0 * wo_1.y) * n.y) - k), (((2.0 * wo_1.z) * n.z) - k));
    NormalsPair across_1 = NormalsPair(((wo_1.y * n.z) - (wo_1.z * n.y)), ((wo_1.z * n.x) - (wo_1.x * n.z)), ((wo_1.x * n.y) - (wo_1.y * n.x)));
    NormalsPair minors = NormalsPair(((k * diagonal.x) - (across_1.x * across_1.x)), ((k * diagonal.y) - (across_1.y * across_1.y)), ((k * diagonal.z) - (across_1.z * across_1.z)));
    vec2 trace = (((squares.x * diagonal.x) + (squares.y * diagonal.y)) + diagonal.z);
    vec2 minor = ((squares.y * minors.x) + (squares.x * (minors.y + (squares.y * minors.z))));
    vec2 determinant_ = ((squares.x * squares.y) * (k * _e4));
    vec2 mean_1 = (trace * 0.33333334);
    vec2 spread2_ = max(((mean_1 * mean_1) - (minor * 0.33333334)), vec2(1e-36));
    vec2 per_spread = inversesqrt(spread2_);
    vec2 cosine_1 = (((((mean_1 * ((mean_1 * mean_1) - (0.5 * minor))) + (0.5 * determinant_)) * per_spread) * per_spread) * per_spread);
    vec2 x_3 = min(abs(cosine_1), vec2(1.0));
    vec2 x2_1 = (x_3 * x_3);
    vec2 of_third = (((vec2(0.86602545) + (x_3 * 0.16665927)) + (x2_1 * (vec2(-0.047981776) + (x_3 * 0.023804545)))) + ((x2_1 * x2_1) * ((vec2(-0.012577177) + (x_3 * 0.0051134448)) - (x2_1 * 0.0010438402))));
    bvec2 is_first = greaterThanEqual(cosine_1, vec2(0.0));
    vec2 rough = (mean_1 + ((mix(vec2(-2.0), vec2(2.0), is_first) * (spread2_ * per_spread)) * of_third));
    bvec2 is_small = bvec2(is_first.x && lessThan(trace, -(rough)).x, is_first.y && lessThan(trace, -(rough)).y);
    vec2 sum_beside = (trace - rough);
    vec2 product_beside = (minor - (rough * sum_beside));
    vec2 per_divisor = (vec2(1.0) / mix(rough, product_beside, is_small));
    vec2 quotient = (determinant_ * per_divisor);
    vec2 isolated = mix(rough, quotient, is_small);
    vec2 product = mix(quotient, product_beside, is_small);
    vec2 sum_9 = mix(((minor - quotient) * per_divisor), sum_beside, is_small);
    vec2 radius = sqrt(max((((0.25 * sum_9) * sum_9) - product), vec2(0.0)));
    bvec2 is_above = bvec2(not(is_first).x && greaterThanEqual(sum_9, vec2(0.0)).x, not(is_first).y && greaterThanEqual(sum_9, vec2(0.0)).y);
    vec2 larger = ((0.5 * sum_9) + mix(-(radius), radius, is_above));
    vec2 smaller = (product / mix(larger, vec2(-1e-30), equal(larger, vec2(0.0))));
    vec2 upper = mix(smaller, larger, is_above);
    vec2 lower = mix(larger, smaller, is_above);
    vec2 l1_ = max(mix(upper, isolated, is_first), vec2(1e-18));
    vec2 p = max(-(mix(lower, smaller, is_first)), vec2(0.0));
    vec2 q_1 = max(-(mix(isolated, larger, is_first)), max(p, vec2(1e-30)));
    return NormalsCone(k, _e4, l1_, p, q_1);
}

NormalsPair normals_cone_axis(NormalsView view_5, NormalsPair n_1, NormalsCone cone) {
    vec3 wo_2 = view_5.wo;
    vec2 sum_10 = (cone.k + cone.l1_);
    vec2 sum_x = (((cone.k * view_5.alpha.x) * view_5.alpha.x) + cone.l1_);
    vec2 sum_y = (((cone.k * view_5.alpha.y) * view_5.alpha.y) + cone.l1_);
    vec2 per_sum = (sum_10 / (sum_x * sum_y));
    vec2 x_4 = ((view_5.alpha.x * sum_y) * per_sum);
    vec2 y_1 = ((view_5.alpha.y * sum_x) * per_sum);
    NormalsPair weighted = NormalsPair(((view_5.alpha.x * x_4) * n_1.x), ((view_5.alpha.y * y_1) * n_1.y), n_1.z);
    vec2 _e47 = normals_pair_dot(weighted, n_1);
    vec2 of_n = (sum_10 - (((weighted.x * wo_2.x) + (weighted.y * wo_2.y)) + (weighted.z * wo_2.z)));
    return NormalsPair((x_4 * ((wo_2.x * _e47) + (n_1.x * of_n))), (y_1 * ((wo_2.y * _e47) + (n_1.y * of_n))), ((wo_2.z * _e47) + (n_1.z * of_n)));
}

mat2x3 normals_curved(NormalsView view_6, NormalsCorner a0_, NormalsCorner b0_, NormalsCorner a1_, NormalsCorner b1_) {
    vec3 wo_3 = view_6.wo;
    NormalsPair _e8 = normals_pair(a0_.c, a1_.c);
    NormalsPair _e11 = normals_pair(b0_.c, b1_.c);
    NormalsPair _e18 = normals_pair((b0_.w - a0_.w), (b1_.w - a1_.w));
    vec2 _e19 = normals_pair_dot(_e18, _e18);
    NormalsPair _e22 = normals_pair(a0_.w, a1_.w);
    NormalsPair _e23 = normals_pair_cross(_e22, _e18);
    vec2 towards = (((wo_3.x * _e23.x) + (wo_3.y * _e23.y)) + (wo_3.z * _e23.z));
    vec2 sense = mix(vec2(1.0), vec2(-1.0), lessThan(towards, vec2(0.0)));
    NormalsPair _e43 = normals_pair_scaled(_e23, sense);
    NormalsCone _e45 = normals_cone(view_6, _e43, (towards * sense));
    NormalsPair _e46 = normals_cone_axis(view_6, _e43, _e45);
    vec2 _e47 = normals_pair_dot(_e46, _e46);
    vec2 per_axis2_ = (vec2(1.0) / max(_e47, vec2(1e-36)));
    NormalsPair _e54 = normals_pair_cross(_e8, _e11);
    vec2 _e55 = normals_pair_dot(_e46, _e54);
    NormalsPair _e57 = normals_pair_scaled(_e46, (_e55 * per_axis2_));
    NormalsPair _e58 = normals_pair_minus(_e54, _e57);
    NormalsPair _e59 = normals_pair_stretched(_e58, view_6);
    vec2 _e60 = normals_pair_dot(_e43, _e59);
    vec2 by_n = (((wo_3.x * _e59.x) + (wo_3.y * _e59.y)) + (wo_3.z * _e59.z));
    NormalsPair _e100 = normals_pair_stretched(NormalsPair((((wo_3.x * _e60) + (_e43.x * by_n)) - (_e45.k * _e59.x)), (((wo_3.y * _e60) + (_e43.y * by_n)) - (_e45.k * _e59.y)), (((wo_3.z * _e60) + (_e43.z * by_n)) - (_e45.k * _e59.z))), view_6);
    NormalsPair _e102 = normals_pair_scaled(_e58, _e45.p);
    NormalsPair _e103 = normals_pair_plus(_e100, _e102);
    vec2 _e104 = normals_pair_dot(_e103, _e46);
    NormalsPair _e106 = normals_pair_scaled(_e46, (_e104 * per_axis2_));
    NormalsPair _e107 = normals_pair_minus(_e103, _e106);
    vec2 gap = max((_e45.q - _e45.p), (1e-6 * _e45.q));
    NormalsPair _e118 = normals_pair_scaled(_e107, (vec2(-1.0) / gap));
    NormalsPair _e119 = normals_pair_minus(_e58, _e118);
    vec2 lengths = vec2((a0_.length_ * b0_.length_), (a1_.length_ * b1_.length_));
    float squares_1 = (((view_6.alpha.x * view_6.alpha.x) * view_6.alpha.y) * view_6.alpha.y);
    vec2 bend_1 = ((0.5 * _e19) / max(((lengths * _e45.n2_) * squares_1), vec2(1e-36)));
    vec2 _e147 = normals_pair_dot(_e8, _e11);
    vec2 m1_ = (_e147 - (bend_1 * (_e45.p * _e45.q)));
    vec2 m2_ = (_e147 + (bend_1 * (_e45.l1_ * _e45.q)));
    vec2 m3_ = (_e147 + (bend_1 * (_e45.l1_ * _e45.p)));
    vec2 by_angle = (_e45.l1_ * inversesqrt(((_e45.l1_ + _e45.p) * (_e45.l1_ + _e45.q))));
    vec2 per_axis = sqrt(per_axis2_);
    vec2 beside = (_e55 * per_axis);
    bvec2 is_far = bvec2(greaterThan(_e19, vec2(0.2)).x || bvec2(greaterThanEqual(_e19, vec2(1e-9)).x && greaterThan(abs(beside), (0.01 * by_angle)).x, greaterThanEqual(_e19, vec2(1e-9)).y && greaterThan(abs(beside), (0.01 * by_angle)).y).x, greaterThan(_e19, vec2(0.2)).y || bvec2(greaterThanEqual(_e19, vec2(1e-9)).x && greaterThan(abs(beside), (0.01 * by_angle)).x, greaterThanEqual(_e19, vec2(1e-9)).y && greaterThan(abs(beside), (0.01 * by_angle)).y).y);
    bvec2 is_wrapped = bvec2(lessThan((beside * sense), vec2(0.0)).x && is_far.x, lessThan((beside * sense), vec2(0.0)).y && is_far.y);
    bvec2 is_obtuse = lessThan(m1_, vec2(0.0));
    vec2 begun = mix(mix(vec2(0.0), vec2(6.2831855), is_wrapped), vec2(3.1415927), is_obtuse);
    vec2 _e207 = normals_per_sine(min(abs(m1_), vec2(1.0)));
    vec2 along_first = ((((begun * sense) * by_angle) + (mix(_e207, -(_e207), is_obtuse) * beside)) * per_axis);
    vec2 _e221 = normals_per_hyperbolic_sine(max((m2_ - vec2(1.0)), vec2(0.0)));
    vec2 _e226 = normals_per_sine(min(abs(m3_), vec2(1.0)));
    vec2 _e231 = normals_pair_dot(_e118, _e118);
    vec2 sine2_ = (((_e45.l1_ + _e45.q) * gap) * _e231);
    vec2 blunt = (((3.1415927 * _e45.q) * inversesqrt(max(sine2_, vec2(1e-36)))) - _e226);
    vec2 along_third = mix(_e226, blunt, lessThan(m3_, vec2(0.0)));
    NormalsPair _e246 = normals_pair_scaled(_e46, along_first);
    NormalsPair _e247 = normals_pair_scaled(_e119, _e221);
    NormalsPair _e248 = normals_pair_scaled(_e118, along_third);
    NormalsPair _e249 = normals_pair_plus(_e247, _e248);
    NormalsPair _e250 = normals_pair_plus(_e246, _e249);
    NormalsPair _e251 = normals_pair_minus(_e250, _e54);
    bvec2 is_edge = greaterThanEqual(_e19, vec2(1e-14));
    return mat2x3((is_edge.x ? vec3(_e251.x.x, _e251.y.x, _e251.z.x) : vec3(0.0)), (is_edge.y ? vec3(_e251.x.y, _e251.y.y, _e251.z.y) : vec3(0.0)));
}

vec3 normals_crossing(vec3 a_9, vec3 b_8) {
    return vec3(((a_9.xy * abs(b_8.z)) + (b_8.xy * abs(a_9.z))), 0.0);
}

mat2x3 normals_cut_by(mat2x3 cut, NormalsCorner a_10, NormalsCorner b_9) {
    bool local_1 = false;
    bool local_2 = false;
    vec3 _e5 = normals_crossing(a_10.w, b_9.w);
    if ((a_10.height <= 0.0)) {
        local_1 = (b_9.height > 0.0);
    } else {
        local_1 = false;
    }
    bool rises = local_1;
    if ((a_10.height > 0.0)) {
        local_2 = (b_9.height <= 0.0);
    } else {
        local_2 = false;
    }
    bool sinks = local_2;
    return mat2x3((rises ? _e5 : cut[0]), (sinks ? _e5 : cut[1]));
}

NormalsEdge normals_edge_of(NormalsLight light, uint i, NormalsCorner a_11, NormalsCorner b_10) {
    bool local_3 = false;
    float top = max(a_11.height, b_10.height);
    if ((top > 0.0)) {
        local_3 = (i < light.number);
    } else {
        local_3 = false;
    }
    bool is_there = local_3;
    NormalsCorner _e19 = normals_choose(light.rise, a_11, (a_11.height > 0.0));
    NormalsCorner _e24 = normals_choose(light.sink, b_10, (b_10.height > 0.0));
    NormalsCorner _e25 = normals_choose(_e19, _e24, is_there);
    float near_1 = (is_there ? max((1.0 - (top * light.per_height)), 0.0) : 0.0);
    return NormalsEdge(is_there, _e19, _e25, vec3(0.0), _e19.c, mat2x3(vec3(0.0), vec3(0.0)), near_1);
}

NormalsEdge normals_split(NormalsView view_7, NormalsEdge edge) {
    NormalsEdge split = NormalsEdge(false, NormalsCorner(vec3(0.0), vec3(0.0), 0.0, 0.0), NormalsCorner(vec3(0.0), vec3(0.0), 0.0, 0.0), vec3(0.0), vec3(0.0), mat2x3(0.0), 0.0);
    split = edge;
    NormalsCorner _e6 = normals_between(edge.begin, edge.end, 0.5, view_7);
    split.middle = _e6.c;
    mat2x3 _e12 = normals_curved(view_7, edge.begin, _e6, _e6, edge.end);
    split.halves = _e12;
    vec3 _e16 = split.halves[0];
    vec3 _e19 = split.halves[1];
    split.curved = ((_e16 + _e19) + cross((_e6.c - edge.begin.c), (edge.end.c - edge.begin.c)));
    NormalsEdge _e32 = split;
    return _e32;
}

NormalsEdges normals_edges(NormalsView view_8, NormalsLight light_1, uint i_1, NormalsCorner a_12, NormalsCorner b_11, NormalsCorner c, bool is_split) {
    NormalsEdges edges = NormalsEdges(NormalsEdge(false, NormalsCorner(vec3(0.0), vec3(0.0), 0.0, 0.0), NormalsCorner(vec3(0.0), vec3(0.0), 0.0, 0.0), vec3(0.0), vec3(0.0), mat2x3(0.0), 0.0), NormalsEdge(false, NormalsCorner(vec3(0.0), vec3(0.0), 0.0, 0.0), NormalsCorner(vec3(0.0), vec3(0.0), 0.0, 0.0), vec3(0.0), vec3(0.0), mat2x3(0.0), 0.0));
    NormalsEdge _e7 = normals_edge_of(light_1, i_1, a_12, b_11);
    NormalsEdge _e10 = normals_edge_of(light_1, (i_1 + 1u), b_11, c);
    edges = NormalsEdges(_e7, _e10);
    if (is_split) {
        NormalsEdge _e14 = edges.first;
        NormalsEdge _e15 = normals_split(view_8, _e14);
        NormalsEdge _e17 = edges.second;
        NormalsEdge _e18 = normals_split(view_8, _e17);
        return NormalsEdges(_e15, _e18);
    }
    NormalsCorner _e22 = edges.first.begin;
    NormalsCorner _e25 = edges.first.end;
    NormalsCorner _e28 = edges.second.begin;
    NormalsCorner _e31 = edges.second.end;
    mat2x3 _e32 = normals_curved(view_8, _e22, _e25, _e28, _e31);
    edges.first.curved = _e32[0];
    edges.second.curved = _e32[1];
    NormalsEdges _e39 = edges;
    return _e39;
}

NormalsOutline normals_outline_with(NormalsOutline outline, uint i_2, NormalsEdge edge_1) {
    NormalsOutline next = NormalsOutline(vec3(0.0), vec3(0.0), 0u, NormalsCorner(vec3(0.0), vec3(0.0), 0.0, 0.0), NormalsCorner(vec3(0.0), vec3(0.0), 0.0, 0.0), vec3(0.0), 0.0, 0.0, 0.0);
    next = outline;
    vec3 _e5 = next.flux;
    next.flux = (_e5 + (edge_1.curved + cross((edge_1.begin.c - outline.origin), (edge_1.end.c - outline.origin))));
    float extent = (edge_1.near * distance(edge_1.begin.w, edge_1.end.w));
    float by_extent = (edge_1.near * extent);
    bool is_nearer = (by_extent > outline.most);
    NormalsCorner _e32 = normals_choose(outline.begin, edge_1.begin, is_nearer);
    next.begin = _e32;
    NormalsCorner _e36 = normals_choose(outline.end, edge_1.end, is_nearer);
    next.end = _e36;
    next.curved = (is_nearer ? edge_1.curved : outline.curved);
    next.nearest = (is_nearer ? i_2 : outline.nearest);
    next.second = max(outline.second, min(by_extent, outline.most));
    next.most = max(outline.most, by_extent);
    float _e53 = next.extents;
    next.extents = (_e53 + extent);
    NormalsOutline _e55 = next;
    return _e55;
}

NormalsOutline normals_outline_with_both(NormalsOutline outline_1, uint i_3, NormalsEdges edges_1) {
    NormalsOutline _e4 = normals_outline_with(outline_1, i_3, edges_1.first);
    NormalsOutline _e8 = normals_outline_with(_e4, (i_3 + 1u), edges_1.second);
    return _e8;
}

vec3 normals_joined(vec3 first_2, vec3 second_2, vec3 begin, vec3 middle, vec3 end) {
    return ((first_2 + second_2) + cross((middle - begin), (end - begin)));
}

NormalsSetting normals_setting(NormalsView view_9, NormalsOutline outline_2, NormalsLight light_2, bool is_near_too, bool is_split_1) {
    bool local_4 = false;
    NormalsSetting setting = NormalsSetting(false, 0.0, false, 0.0, vec3(0.0), vec3(0.0), vec3(0.0), vec3[4](vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0)), NormalsEdge(false, NormalsCorner(vec3(0.0), vec3(0.0), 0.0, 0.0), NormalsCorner(vec3(0.0), vec3(0.0), 0.0, 0.0), vec3(0.0), vec3(0.0), mat2x3(0.0), 0.0));
    bool local_5 = false;
    NormalsCorner before = NormalsCorner(vec3(0.0), vec3(0.0), 0.0, 0.0);
    vec3 joined = vec3(0.0);
    float horizon_1 = distance(light_2.rise.w, light_2.sink.w);
    vec3 own = (is_near_too ? vec3(outline_2.most, outline_2.second, outline_2.extents) : vec3(0.0));
    float second_5 = max(own.y, min(own.x, horizon_1));
    if (light_2.is_cut) {
        local_4 = (horizon_1 >= own.x);
    } else {
        local_4 = false;
    }
    bool is_horizon = local_4;
    if (!(light_2.is_cut)) {
        local_5 = (own.x > 0.0);
    } else {
        local_5 = true;
    }
    bool _e38 = local_5;
    setting.is_there = _e38;
    setting.share = ((max(own.x, horizon_1) - second_5) / max((own.z + horizon_1), 1e-36));
    setting.is_horizon = is_horizon;
    bool _e50 = setting.is_there;
    if (!(_e50)) {
        NormalsSetting _e52 = setting;
        return _e52;
    }
    NormalsCorner _e55 = normals_choose(outline_2.begin, light_2.sink, is_horizon);
    NormalsCorner _e58 = normals_choose(outline_2.end, light_2.rise, is_horizon);
    float _e61 = setting.share;
    setting.wide = (_e61 * smoothstep(1.2, 1.8, distance(_e55.w, _e58.w)));
    vec3 sum_11 = (_e55.w + _e58.w);
    float _e72 = normals_half_cosine(_e55, _e58);
    vec3 _e79 = normals_unstretched(((view_9.wo * _e72) + (sum_11 * (0.5 / _e72))), view_9);
    setting.begin = _e55.c;
    setting.control = (_e79 * inversesqrt((_e55.length_ * _e58.length_)));
    setting.end = _e58.c;
    NormalsCorner _e91 = normals_between(_e55, _e58, 0.5, view_9);
    before = _e55;
    if (is_split_1) {
        NormalsCorner _e97 = normals_between(_e55, _e58, 0.25, view_9);
        mat2x3 _e98 = normals_curved(view_9, _e55, _e97, _e97, _e91);
        setting.parts[0] = _e98[0];
        setting.parts[1] = _e98[1];
        vec3 _e110 = normals_joined(_e98[0], _e98[1], _e55.c, _e97.c, _e91.c);
        joined = _e110;
        before = _e91;
    }
    NormalsCorner _e112 = normals_between(_e55, _e58, 0.75, view_9);
    NormalsCorner _e113 = normals_choose(_e91, _e112, is_split_1);
    NormalsCorner _e114 = before;
    NormalsCorner _e116 = normals_choose(light_2.sink, _e113, is_horizon);
    mat2x3 _e118 = normals_curved(view_9, _e114, _e113, _e116, light_2.rise);
    vec3 _e120 = joined;
    vec3 _e125 = normals_joined(_e120, _e118[0], _e55.c, _e91.c, _e113.c);
    vec3 but_last = (is_split_1 ? _e125 : _e118[0]);
    vec3 rest_1 = ((outline_2.curved - but_last) - cross((_e113.c - _e55.c), (_e58.c - _e55.c)));
    vec3 final_part = (is_horizon ? _e118[1] : rest_1);
    setting.horizon.is_there = light_2.is_cut;
    setting.horizon.begin = light_2.sink;
    setting.horizon.end = light_2.rise;
    vec3 _e154 = normals_joined(but_last, final_part, _e55.c, _e113.c, _e58.c);
    setting.horizon.curved = (is_horizon ? _e154 : _e118[1]);
    if (!(is_split_1)) {
        setting.parts[0] = _e118[0];
        setting.parts[1] = final_part;
        NormalsSetting _e162 = setting;
        return _e162;
    }
    setting.parts[2] = _e118[0];
    setting.parts[3] = final_part;
    if (is_horizon) {
        setting.horizon.middle = _e91.c;
        vec3 _e173 = joined;
        vec3 _e178 = normals_joined(_e118[0], final_part, _e91.c, _e113.c, _e58.c);
        setting.horizon.halves = mat2x3(_e173, _e178);
    } else {
        NormalsEdge _e182 = setting.horizon;
        NormalsEdge _e183 = normals_split(view_9, _e182);
        setting.horizon = _e183;
    }
    NormalsSetting _e184 = setting;
    return _e184;
}

vec3 normals_on_setting(NormalsSetting setting_1, float t_1) {
    float u_1 = (1.0 - t_1);
    vec3 _e17 = normals_unit((((setting_1.begin * (u_1 * u_1)) + (setting_1.control * ((2.0 * u_1) * t_1))) + (setting_1.end * (t_1 * t_1))));
    return ((t_1 >= 1.0) ? setting_1.end : _e17);
}

vec2 normals_weight(NormalsView view_10, vec3 c_1) {
    vec3 h_1 = vec3((view_10.alpha * c_1.xy), c_1.z);
    float length2_3 = max(dot(h_1, h_1), 1e-36);
    float cosine_2 = dot(view_10.wo, h_1);
    vec3 wi = ((h_1 * (2.0 * cosine_2)) - (view_10.wo * length2_3));
    float up = max(wi.z, 0.0);
    vec2 across_2 = (view_10.alpha * wi.xy);
    float stretched_1 = sqrt((dot(across_2, across_2) + (wi.z * wi.z)));
    float weight = (((view_10.wo.z + view_10.length_) * up) / max(((view_10.length_ * up) + (view_10.wo.z * stretched_1)), 1e-36));
    float m_3 = clamp((1.0 - (cosine_2 * inversesqrt(length2_3))), 0.0, 1.0);
    float m2_1 = (m_3 * m_3);
    return vec2(weight, ((m2_1 * m2_1) * m_3));
}

NormalsNumbers normals_numbers(NormalsView view_11, float wide, bool is_fine) {
    vec3 edge_2 = vec3(0.0);
    vec3 horizon = vec3(0.0);
    vec3 wide_edge = vec3(0.0);
    vec3 wide_horizon = vec3(0.0);
    vec2 inner = vec2(0.0);
    float mu = (view_11.wo.z / view_11.length_);
    float alpha_1 = max(view_11.alpha.x, view_11.alpha.y);
    vec4 at = vec4(1.0, mu, alpha_1, (alpha_1 * mu));
    vec2 by_ratio = (vec2(1.0, alpha_1) * (min(view_11.alpha.x, view_11.alpha.y) / alpha_1));
    edge_2 = (mat4x3(vec3(0.01, 0.091, 0.643), vec3(0.494, -0.105, -0.07), vec3(0.326, -0.051, -0.335), vec3(-0.194, 0.253, -0.279)) * at);
    horizon = (mat4x3(vec3(0.069, 0.272, 0.32), vec3(0.187, -0.173, -0.352), vec3(0.02, 0.133, 0.276), vec3(-0.022, -0.086, 0.206)) * at);
    wide_edge = ((mat4x3(vec3(-0.303, -0.001, 1.146), vec3(0.484, 0.01, -0.263), vec3(1.059, -0.078, -0.744), vec3(-0.565, 0.059, 0.218)) * at) + (mat2x3(vec3(-0.076, -0.017, -0.263), vec3(0.531, 0.23, -0.369)) * by_ratio));
    wide_horizon = ((mat4x3(vec3(0.03, 0.484, 0.698), vec3(0.155, -0.201, -0.541), vec3(0.259, -0.096, -0.123), vec3(-0.116, 0.125, 0.685)) * at) + (mat2x3(vec3(0.01, -0.012, 0.103), vec3(-0.164, -0.06, -0.169)) * by_ratio));
    inner = ((mat4x2(vec2(0.078, -0.863), vec2(-0.025, -0.268), vec2(0.422, 0.688), vec2(-0.025, 0.266)) * at) + (mat2x2(vec2(0.051, 1.221), vec2(-0.225, -0.86)) * by_ratio));
    if (is_fine) {
        edge_2 = (mat4x3(vec3(0.952, 0.077, 0.129), vec3(-0.667, -0.076, 0.436), vec3(-1.181, -0.007, 0.083), vec3(1.403, 0.141, -0.708)) * at);
        horizon = (mat4x3(vec3(0.074, 0.303, 0.297), vec3(0.198, -0.249, -0.32), vec3(0.0, 0.105, 0.311), vec3(-0.14, 0.162, 0.402)) * at);
        wide_edge = ((mat4x3(vec3(0.061, -0.007, 0.653), vec3(0.135, 0.017, 0.23), vec3(0.495, -0.052, -0.327), vec3(-0.396, -0.014, -0.132)) * at) + (mat2x3(vec3(-0.247, 0.002, -0.295), vec3(1.007, 0.246, -0.367)) * by_ratio));
        wide_horizon = ((mat4x3(vec3(0.098, 0.413, 0.521), vec3(0.13, -0.148, -0.351), vec3(0.148, -0.007, 0.097), vec3(-0.114, 0.102, 0.526)) * at) + (mat2x3(vec3(-0.042, 0.074, 0.202), vec3(-0.109, -0.133, -0.225)) * by_ratio));
        inner = ((mat4x2(vec2(0.179, -0.736), vec2(-0.041, -0.213), vec2(0.263, 0.534), vec2(0.041, 0.183)) * at) + (mat2x2(vec2(0.157, 0.869), vec2(-0.296, -0.469)) * by_ratio));
    }
    vec3 _e263 = edge_2;
    vec3 _e264 = wide_edge;
    vec3 _e269 = horizon;
    vec3 _e270 = wide_horizon;
    float _e278 = inner.x;
    float _e283 = inner.y;
    return NormalsNumbers(max(mix(_e263, _e264, wide), vec3(0.0)), max(mix(_e269, _e270, wide), vec3(0.02, 0.0, 0.0)), vec2((wide * max(_e278, 0.0)), _e283));
}

float normals_to_horizon(float tip, float near, float rate) {
    float root = sqrt(((rate * near) * max((tip - near), 0.0)));
    float rest_2 = (near / max((near + root), 1e-36));
    float u_2 = (1.0 - rest_2);
    float series_1 = (2.0 + (u_2 * (-7.406265 + (u_2 * (21.07087 + (u_2 * (-31.448433 + (u_2 * 16.743261))))))));
    return (((tip * rest_2) * rest_2) * (1.0 + (u_2 * series_1)));
}

vec3 normals_sample(NormalsView view_12, vec3 c_2) {
    vec2 _e2 = normals_weight(view_12, c_2);
    float seen_1 = max(dot(c_2, view_12.stretched), 0.0);
    return vec3(seen_1, (seen_1 * _e2.x), ((seen_1 * _e2.x) * _e2.y));
}

float normals_rise(NormalsView view_13, vec3 c_3) {
    vec3 h_2 = vec3((view_13.alpha * c_3.xy), c_3.z);
    return (((2.0 * dot(view_13.wo, h_2)) * h_2.z) - (dot(h_2, h_2) * view_13.wo.z));
}

NormalsFan normals_fan(NormalsView view_14, vec3 tip_1, vec2 at_tip, float side, float wide_1, bool is_split_2) {
    vec3 _e6 = normals_sample(view_14, tip_1);
    vec3 tip_sample = (0.03 * _e6);
    float _e9 = normals_rise(view_14, tip_1);
    float per_rise = (1.0 / max((0.125 * _e9), 1e-36));
    NormalsSpoke none = NormalsSpoke(tip_1, false, vec3(0.0), vec3(0.0));
    NormalsNumbers _e22 = normals_numbers(view_14, wide_1, is_split_2);
    return NormalsFan(_e22, tip_1, at_tip, tip_sample, (side * view_14.stretched), per_rise, is_split_2, none, none);
}

NormalsSpoke normals_spoke(NormalsView view_15, NormalsFan fan, vec3 c_4, bool is_up) {
    vec3 _e5 = normals_arc_bend(fan.tip, c_4);
    vec3 _e9 = normals_sample(view_15, c_4);
    return NormalsSpoke(c_4, is_up, _e5, (fan.numbers.edge.y * _e9));
}

NormalsSpoke normals_spoke_to_setting(NormalsFan fan_1, vec3 c_5) {
    vec3 _e4 = normals_arc_bend(fan_1.tip, c_5);
    return NormalsSpoke(c_5, true, _e4, vec3(0.0));
}

NormalsSpoke normals_choose_spoke(NormalsSpoke first_3, NormalsSpoke second_3, bool is_second_1) {
    return NormalsSpoke((is_second_1 ? second_3.c : first_3.c), (is_second_1 ? second_3.is_up : first_3.is_up), (is_second_1 ? second_3.bend : first_3.bend), (is_second_1 ? second_3.at_end : first_3.at_end));
}

vec3 normals_flux(NormalsFan fan_2, NormalsSpoke a_13, NormalsSpoke b_12, vec3 curved) {
    return ((cross((a_13.c - fan_2.tip), (b_12.c - fan_2.tip)) + curved) + (a_13.bend - b_12.bend));
}

vec3 normals_centroid(NormalsFan fan_3, vec3 flux) {
    vec3 _e2 = normals_unit(flux);
    float share_3 = clamp((10.0 * dot(_e2, fan_3.tip)), -1.0, 1.0);
    return ((share_3 * _e2) + ((1.0 - abs(share_3)) * fan_3.tip));
}

NormalsSum normals_add(NormalsView view_16, NormalsFan fan_4, NormalsSum sum, vec3 m_1, float whole_1, vec2 mean) {
    float _e6 = normals_rise(view_16, m_1);
    float known = clamp((_e6 * fan_4.per_rise), 0.0, 1.0);
    vec3 part = ((known * whole_1) * vec3(1.0, mean));
    return NormalsSum((sum.all_ + part), (sum.positive + ((part.x > 0.0) ? part : vec3(0.0))), ((sum.unknown + whole_1) - part.x));
}

NormalsSum normals_add_triangle(NormalsView view_17, NormalsFan fan_5, NormalsSum sum_1, NormalsSpoke a_14, NormalsSpoke b_13, vec3 curved_1, float share) {
    vec3 _e7 = normals_flux(fan_5, a_14, b_13, curved_1);
    vec3 _e8 = normals_centroid(fan_5, _e7);
    vec3 _e16 = normals_sample(view_17, (_e8 + (fan_5.numbers.edge.z * (_e8 - fan_5.tip))));
    vec3 corners_1 = ((fan_5.tip_sample + a_14.at_end) + b_13.at_end);
    vec3 _e22 = normals_sample(view_17, _e8);
    vec3 mean_2 = ((_e22 + (fan_5.numbers.edge.x * _e16)) + corners_1);
    NormalsSum _e38 = normals_add(view_17, fan_5, sum_1, _e8, (share * dot(_e7, fan_5.seen)), (mean_2.yz / vec2(max(mean_2.x, 1e-18))));
    return _e38;
}

NormalsSum normals_add_edge(NormalsView view_18, NormalsFan fan_6, NormalsSum sum_2, NormalsEdge edge_3, NormalsSpoke a_15, NormalsSpoke b_14, float share_1) {
    float counts = (edge_3.is_there ? share_1 : 0.0);
    NormalsSpoke _e12 = normals_choose_spoke(fan_6.rise, a_15, a_15.is_up);
    NormalsSpoke _e15 = normals_choose_spoke(fan_6.sink, b_14, b_14.is_up);
    if (fan_6.is_split) {
        NormalsSpoke _e19 = normals_spoke(view_18, fan_6, edge_3.middle, true);
        NormalsSum _e22 = normals_add_triangle(view_18, fan_6, sum_2, _e12, _e19, edge_3.halves[0], counts);
        NormalsSum _e25 = normals_add_triangle(view_18, fan_6, _e22, _e19, _e15, edge_3.halves[1], counts);
        return _e25;
    }
    NormalsSum _e27 = normals_add_triangle(view_18, fan_6, sum_2, _e12, _e15, edge_3.curved, counts);
    return _e27;
}

NormalsSum normals_add_edges(NormalsView view_19, NormalsFan fan_7, NormalsSum sum_3, uint i_4, NormalsEdges edges_2, NormalsSpoke a_16, NormalsSpoke b_15, NormalsSpoke c_6, uint one, float less) {
    NormalsSum _e14 = normals_add_edge(view_19, fan_7, sum_3, edges_2.first, a_16, b_15, ((i_4 == one) ? less : 1.0));
    NormalsSum _e21 = normals_add_edge(view_19, fan_7, _e14, edges_2.second, b_15, c_6, (((i_4 + 1u) == one) ? less : 1.0));
    return _e21;
}

NormalsSum normals_add_on_setting(NormalsView view_20, NormalsFan fan_8, NormalsSum sum_4, NormalsSpoke a_17, NormalsSpoke b_16, vec3 curved_2, float share_2) {
    float energy = 0.0;
    vec3 _e7 = normals_flux(fan_8, a_17, b_16, curved_2);
    vec3 _e8 = normals_centroid(fan_8, _e7);
    vec2 _e16 = normals_weight(view_20, (_e8 + (fan_8.numbers.horizon.y * (_e8 - fan_8.tip))));
    float _e23 = normals_to_horizon(fan_8.at_tip.x, _e16.x, fan_8.numbers.horizon.x);
    energy = _e23;
    if ((fan_8.numbers.inner.x > 0.0)) {
        vec2 _e37 = normals_weight(view_20, (_e8 + (fan_8.numbers.inner.y * (_e8 - fan_8.tip))));
        float _e38 = energy;
        energy = mix(_e38, _e37.x, fan_8.numbers.inner.x);
    }
    float _e44 = energy;
    vec2 mean_3 = (_e44 * vec2(1.0, mix(_e16.y, fan_8.at_tip.y, fan_8.numbers.horizon.z)));
    NormalsSum _e58 = normals_add(view_20, fan_8, sum_4, _e8, (share_2 * dot(_e7, fan_8.seen)), mean_3);
    return _e58;
}

NormalsSum normals_add_setting(NormalsView view_21, NormalsFan fan_9, NormalsSum sum_5, NormalsSetting setting_2) {
    NormalsSum added = NormalsSum(vec3(0.0), vec3(0.0), 0.0);
    NormalsSpoke before_1 = NormalsSpoke(vec3(0.0), false, vec3(0.0), vec3(0.0));
    vec3 second_4 = vec3(0.0);
    uint i_5 = 0u;
    bool is_wide = (setting_2.wide > 0.0);
    uint parts_1 = (fan_9.is_split ? 4u : 2u);
    uint pairs = (is_wide ? (2u * parts_1) : parts_1);
    float step_ = (1.0 / float(pairs));
    float to_middle = (0.5 * (is_wide ? setting_2.wide : 1.0));
    added = sum_5;
    NormalsSpoke _e24 = normals_spoke_to_setting(fan_9, setting_2.begin);
    before_1 = _e24;
    bool loop_init = true;
    while(true) {
        if (!loop_init) {
            uint _e102 = i_5;
            i_5 = (_e102 + 1u);
        }
        loop_init = false;
        uint _e31 = i_5;
        if ((_e31 < 8u)) {
        } else {
            break;
        }
        {
            uint _e34 = i_5;
            if ((_e34 >= pairs)) {
                break;
            }
            uint _e36 = i_5;
            uint _e37 = i_5;
            uint part_1 = (is_wide ? (_e37 / 2u) : _e36);
            vec3 low_1 = ((part_1 == 1u) ? setting_2.parts[1] : setting_2.parts[0]);
            vec3 high_1 = ((part_1 == 3u) ? setting_2.parts[3] : setting_2.parts[2]);
            vec3 whole_2 = ((part_1 >= 2u) ? high_1 : low_1);
            uint _e58 = i_5;
            bool is_second_2 = ((_e58 % 2u) == 1u);
            uint _e63 = i_5;
            float t_2 = float(_e63);
            vec3 _e70 = normals_on_setting(setting_2, (step_ * (t_2 + (is_second_2 ? to_middle : (1.0 - to_middle)))));
            vec3 _e74 = normals_on_setting(setting_2, (step_ * (t_2 + 1.0)));
            vec3 _e78 = normals_on_setting(setting_2, (step_ * (t_2 + 2.0)));
            vec3 _e80 = before_1.c;
            mat2x3 _e81 = normals_shared(_e80, _e74, _e78, whole_2);
            vec3 _e83 = second_4;
            vec3 half_ = (is_second_2 ? _e83 : _e81[0]);
            second_4 = _e81[1];
            vec3 _e87 = before_1.c;
            mat2x3 _e89 = normals_shared(_e87, _e70, _e74, (is_wide ? half_ : whole_2));
            NormalsSpoke _e90 = normals_spoke_to_setting(fan_9, _e70);
            NormalsSpoke _e91 = normals_spoke_to_setting(fan_9, _e74);
            NormalsSum _e92 = added;
            NormalsSpoke _e93 = before_1;
            NormalsSum _e96 = normals_add_on_setting(view_21, fan_9, _e92, _e93, _e90, _e89[0], setting_2.share);
            added = _e96;
            NormalsSum _e97 = added;
            NormalsSum _e100 = normals_add_on_setting(view_21, fan_9, _e97, _e90, _e91, _e89[1], setting_2.share);
            added = _e100;
            before_1 = _e91;
        }
    }
    NormalsSum _e104 = added;
    return _e104;
}

vec2 normals_total(NormalsFan fan_10, NormalsSum sum_6, float seen) {
    float share_4 = clamp((((sum_6.positive.x + sum_6.unknown) - seen) / max(seen, 1e-18)), 0.0, 0.5);
    float tip_2 = (1e-6 * max(seen, 1e-18));
    float per_part = (((share_4 * sum_6.unknown) + ((1.0 - share_4) * seen)) / (sum_6.positive.x + tip_2));
    return ((share_4 * sum_6.all_.yz) + (per_part * (sum_6.positive.yz + ((tip_2 * fan_10.at_tip.x) * vec2(1.0, fan_10.at_tip.y)))));
}

vec2 normals_polygon(NormalsView view_22, inout vec3 vertices_1[8], uint count, bool two_sided, uint rule) {
    NormalsCorner c4_ = NormalsCorner(vec3(0.0), vec3(0.0), 0.0, 0.0);
    NormalsCorner c5_ = NormalsCorner(vec3(0.0), vec3(0.0), 0.0, 0.0);
    NormalsCorner c6_ = NormalsCorner(vec3(0.0), vec3(0.0), 0.0, 0.0);
    NormalsCorner c7_ = NormalsCorner(vec3(0.0), vec3(0.0), 0.0, 0.0);
    NormalsLight light_3 = NormalsLight(0u, 0.0, false, NormalsCorner(vec3(0.0), vec3(0.0), 0.0, 0.0), NormalsCorner(vec3(0.0), vec3(0.0), 0.0, 0.0));
    mat2x3 cut_1 = mat2x3(0.0);
    NormalsOutline outline_3 = NormalsOutline(vec3(0.0), vec3(0.0), 0u, NormalsCorner(vec3(0.0), vec3(0.0), 0.0, 0.0), NormalsCorner(vec3(0.0), vec3(0.0), 0.0, 0.0), vec3(0.0), 0.0, 0.0, 0.0);
    NormalsEdges third = NormalsEdges(NormalsEdge(false, NormalsCorner(vec3(0.0), vec3(0.0), 0.0, 0.0), NormalsCorner(vec3(0.0), vec3(0.0), 0.0, 0.0), vec3(0.0), vec3(0.0), mat2x3(0.0), 0.0), NormalsEdge(false, NormalsCorner(vec3(0.0), vec3(0.0), 0.0, 0.0), NormalsCorner(vec3(0.0), vec3(0.0), 0.0, 0.0), vec3(0.0), vec3(0.0), mat2x3(0.0), 0.0));
    NormalsEdges fourth = NormalsEdges(NormalsEdge(false, NormalsCorner(vec3(0.0), vec3(0.0), 0.0, 0.0), NormalsCorner(vec3(0.0), vec3(0.0), 0.0, 0.0), vec3(0.0), vec3(0.0), mat2x3(0.0), 0.0), NormalsEdge(false, NormalsCorner(vec3(0.0), vec3(0.0), 0.0, 0.0), NormalsCorner(vec3(0.0), vec3(0.0), 0.0, 0.0), vec3(0.0), vec3(0.0), mat2x3(0.0), 0.0));
    vec3 flux_1 = vec3(0.0);
    bool local_6 = false;
    vec2 parts = vec2(0.0);
    NormalsFan fan_11 = NormalsFan(NormalsNumbers(vec3(0.0), vec3(0.0), vec2(0.0)), vec3(0.0), vec2(0.0), vec3(0.0), vec3(0.0), 0.0, false, NormalsSpoke(vec3(0.0), false, vec3(0.0), vec3(0.0)), NormalsSpoke(vec3(0.0), false, vec3(0.0), vec3(0.0)));
    NormalsSpoke s4_ = NormalsSpoke(vec3(0.0), false, vec3(0.0), vec3(0.0));
    NormalsSum sum_7 = NormalsSum(vec3(0.0), vec3(0.0), 0.0);
    bool local_7 = false;
    uint number = min(max(count, 3u), 8u);
    bool is_fine_1 = (rule == NORMALS_FINE);
    vec3 v0_ = vertices_1[0];
    NormalsCorner _e12 = normals_corner(v0_, view_22);
    vec3 _e14 = vertices_1[1];
    NormalsCorner _e15 = normals_corner(_e14, view_22);
    vec3 _e17 = vertices_1[2];
    NormalsCorner _e18 = normals_corner(_e17, view_22);
    vec3 _e20 = vertices_1[3];
    NormalsCorner _e24 = normals_corner(((number > 3u) ? _e20 : v0_), view_22);
    c4_ = _e12;
    c5_ = _e12;
    c6_ = _e12;
    c7_ = _e12;
    bool many = (number > 4u);
    if (many) {
        vec3 _e32 = vertices_1[4];
        NormalsCorner _e33 = normals_corner(_e32, view_22);
        c4_ = _e33;
        vec3 _e35 = vertices_1[5];
        NormalsCorner _e39 = normals_corner(((number > 5u) ? _e35 : v0_), view_22);
        c5_ = _e39;
        vec3 _e41 = vertices_1[6];
        NormalsCorner _e45 = normals_corner(((number > 6u) ? _e41 : v0_), view_22);
        c6_ = _e45;
        vec3 _e47 = vertices_1[7];
        NormalsCorner _e51 = normals_corner(((number > 7u) ? _e47 : v0_), view_22);
        c7_ = _e51;
    }
    vec4 heights = vec4(_e12.height, _e15.height, _e18.height, _e24.height);
    float _e58 = c4_.height;
    float _e60 = c5_.height;
    float _e62 = c6_.height;
    float _e64 = c7_.height;
    vec4 more = vec4(_e58, _e60, _e62, _e64);
    vec4 high_2 = max(heights, more);
    vec4 low_2 = min(heights, more);
    float highest = max(max(high_2.x, high_2.y), max(high_2.z, high_2.w));
    float lowest = min(min(low_2.x, low_2.y), min(low_2.z, low_2.w));
    if (!((highest > 0.0))) {
        return vec2(0.0);
    }
    light_3 = NormalsLight(number, (4.0 / max(highest, 1e-36)), (lowest <= 0.0), _e12, _e12);
    bool _e96 = light_3.is_cut;
    if (_e96) {
        mat2x3 _e102 = normals_cut_by(mat2x3(vec3(0.0), vec3(0.0)), _e12, _e15);
        cut_1 = _e102;
        mat2x3 _e104 = cut_1;
        mat2x3 _e105 = normals_cut_by(_e104, _e15, _e18);
        mat2x3 _e106 = normals_cut_by(_e105, _e18, _e24);
        NormalsCorner _e107 = c4_;
        mat2x3 _e108 = normals_cut_by(_e106, _e24, _e107);
        cut_1 = _e108;
        if (many) {
            mat2x3 _e109 = cut_1;
            NormalsCorner _e110 = c4_;
            NormalsCorner _e111 = c5_;
            mat2x3 _e112 = normals_cut_by(_e109, _e110, _e111);
            NormalsCorner _e113 = c5_;
            NormalsCorner _e114 = c6_;
            mat2x3 _e115 = normals_cut_by(_e112, _e113, _e114);
            cut_1 = _e115;
            mat2x3 _e116 = cut_1;
            NormalsCorner _e117 = c6_;
            NormalsCorner _e118 = c7_;
            mat2x3 _e119 = normals_cut_by(_e116, _e117, _e118);
            NormalsCorner _e120 = c7_;
            mat2x3 _e121 = normals_cut_by(_e119, _e120, _e12);
            cut_1 = _e121;
        }
        vec3 _e124 = cut_1[0];
        NormalsCorner _e125 = normals_corner(_e124, view_22);
        light_3.rise = _e125;
        vec3 _e128 = cut_1[1];
        NormalsCorner _e129 = normals_corner(_e128, view_22);
        light_3.sink = _e129;
    }
    NormalsLight _e130 = light_3;
    NormalsEdges _e132 = normals_edges(view_22, _e130, 0u, _e12, _e15, _e18, is_fine_1);
    NormalsLight _e133 = light_3;
    NormalsCorner _e135 = c4_;
    NormalsEdges _e136 = normals_edges(view_22, _e133, 2u, _e18, _e24, _e135, is_fine_1);
    NormalsCorner origin = _e132.first.begin;
    outline_3 = NormalsOutline(origin.c, vec3(0.0), 0u, origin, origin, vec3(0.0), 0.0, 0.0, 0.0);
    NormalsOutline _e150 = outline_3;
    NormalsOutline _e152 = normals_outline_with_both(_e150, 0u, _e132);
    NormalsOutline _e154 = normals_outline_with_both(_e152, 2u, _e136);
    outline_3 = _e154;
    third = _e136;
    fourth = _e136;
    if (many) {
        NormalsLight _e157 = light_3;
        NormalsCorner _e159 = c4_;
        NormalsCorner _e160 = c5_;
        NormalsCorner _e161 = c6_;
        NormalsEdges _e162 = normals_edges(view_22, _e157, 4u, _e159, _e160, _e161, is_fine_1);
        third = _e162;
        NormalsLight _e163 = light_3;
        NormalsCorner _e165 = c6_;
        NormalsCorner _e166 = c7_;
        NormalsEdges _e167 = normals_edges(view_22, _e163, 6u, _e165, _e166, _e12, is_fine_1);
        fourth = _e167;
        NormalsOutline _e168 = outline_3;
        NormalsEdges _e170 = third;
        NormalsOutline _e171 = normals_outline_with_both(_e168, 4u, _e170);
        NormalsEdges _e173 = fourth;
        NormalsOutline _e174 = normals_outline_with_both(_e171, 6u, _e173);
        outline_3 = _e174;
    }
    NormalsOutline _e175 = outline_3;
    NormalsLight _e176 = light_3;
    NormalsSetting _e179 = normals_setting(view_22, _e175, _e176, (rule != NORMALS_MEAN), is_fine_1);
    vec3 _e181 = outline_3.flux;
    flux_1 = _e181;
    bool _e184 = light_3.is_cut;
    if (_e184) {
        vec3 _e185 = flux_1;
        vec3 _e190 = light_3.sink.c;
        vec3 _e195 = light_3.rise.c;
        flux_1 = (_e185 + (_e179.horizon.curved + cross((_e190 - origin.c), (_e195 - origin.c))));
    }
    vec3 _e201 = flux_1;
    float seen_2 = dot(_e201, view_22.stretched);
    float side_1 = ((seen_2 < 0.0) ? -1.0 : 1.0);
    if ((side_1 < 0.0)) {
        local_6 = !(two_sided);
    } else {
        local_6 = false;
    }
    bool _e215 = local_6;
    if (_e215) {
        return vec2(0.0);
    }
    float to_part = ((side_1 * 0.3183099) / (view_22.wo.z + view_22.length_));
    vec3 _e225 = flux_1;
    vec3 _e227 = normals_unit((_e225 * side_1));
    vec2 _e228 = normals_weight(view_22, _e227);
    parts = (vec2(_e228.x, (_e228.x * _e228.y)) * seen_2);
    if ((rule != NORMALS_MEAN)) {
        NormalsFan _e239 = normals_fan(view_22, _e227, _e228, side_1, _e179.wide, is_fine_1);
        fan_11 = _e239;
        bool _e242 = light_3.is_cut;
        if (_e242) {
            NormalsFan _e244 = fan_11;
            vec3 _e247 = light_3.rise.c;
            NormalsSpoke _e249 = normals_spoke(view_22, _e244, _e247, true);
            fan_11.rise = _e249;
            NormalsFan _e251 = fan_11;
            vec3 _e254 = light_3.sink.c;
            NormalsSpoke _e256 = normals_spoke(view_22, _e251, _e254, true);
            fan_11.sink = _e256;
        }
        float less_1 = (1.0 - _e179.share);
        uint _e261 = outline_3.nearest;
        uint one_1 = (_e179.is_horizon ? 8u : _e261);
        NormalsFan _e265 = fan_11;
        NormalsSpoke _e270 = normals_spoke(view_22, _e265, _e12.c, (_e12.height > 0.0));
        NormalsFan _e271 = fan_11;
        NormalsSpoke _e276 = normals_spoke(view_22, _e271, _e15.c, (_e15.height > 0.0));
        NormalsFan _e277 = fan_11;
        NormalsSpoke _e282 = normals_spoke(view_22, _e277, _e18.c, (_e18.height > 0.0));
        NormalsFan _e283 = fan_11;
        NormalsSpoke _e288 = normals_spoke(view_22, _e283, _e24.c, (_e24.height > 0.0));
        s4_ = _e270;
        if (many) {
            NormalsFan _e290 = fan_11;
            vec3 _e292 = c4_.c;
            float _e294 = c4_.height;
            NormalsSpoke _e297 = normals_spoke(view_22, _e290, _e292, (_e294 > 0.0));
            s4_ = _e297;
        }
        NormalsFan _e305 = fan_11;
        NormalsSum _e306 = sum_7;
        NormalsSum _e308 = normals_add_edges(view_22, _e305, _e306, 0u, _e132, _e270, _e276, _e282, one_1, less_1);
        sum_7 = _e308;
        NormalsFan _e309 = fan_11;
        NormalsSum _e310 = sum_7;
        NormalsSpoke _e312 = s4_;
        NormalsSum _e313 = normals_add_edges(view_22, _e309, _e310, 2u, _e136, _e282, _e288, _e312, one_1, less_1);
        sum_7 = _e313;
        if (many) {
            NormalsFan _e314 = fan_11;
            vec3 _e316 = c5_.c;
            float _e318 = c5_.height;
            NormalsSpoke _e321 = normals_spoke(view_22, _e314, _e316, (_e318 > 0.0));
            NormalsFan _e322 = fan_11;
            vec3 _e324 = c6_.c;
            float _e326 = c6_.height;
            NormalsSpoke _e329 = normals_spoke(view_22, _e322, _e324, (_e326 > 0.0));
            NormalsFan _e330 = fan_11;
            vec3 _e332 = c7_.c;
            float _e334 = c7_.height;
            NormalsSpoke _e337 = normals_spoke(view_22, _e330, _e332, (_e334 > 0.0));
            NormalsFan _e338 = fan_11;
            NormalsSum _e339 = sum_7;
            NormalsEdges _e341 = third;
            NormalsSpoke _e342 = s4_;
            NormalsSum _e343 = normals_add_edges(view_22, _e338, _e339, 4u, _e341, _e342, _e321, _e329, one_1, less_1);
            sum_7 = _e343;
            NormalsFan _e344 = fan_11;
            NormalsSum _e345 = sum_7;
            NormalsEdges _e347 = fourth;
            NormalsSum _e348 = normals_add_edges(view_22, _e344, _e345, 6u, _e347, _e329, _e337, _e270, one_1, less_1);
            sum_7 = _e348;
        }
        float horizon_2 = (_e179.is_horizon ? less_1 : 1.0);
        bool _e353 = light_3.is_cut;
        if (_e353) {
            local_7 = (horizon_2 > 0.0);
        } else {
            local_7 = false;
        }
        bool _e359 = local_7;
        if (_e359) {
            NormalsFan _e360 = fan_11;
            NormalsSum _e361 = sum_7;
            NormalsSpoke _e364 = fan_11.sink;
            NormalsSpoke _e366 = fan_11.rise;
            NormalsSum _e367 = normals_add_edge(view_22, _e360, _e361, _e179.horizon, _e364, _e366, horizon_2);
            sum_7 = _e367;
        }
        if ((_e179.share > 0.0)) {
            NormalsFan _e371 = fan_11;
            NormalsSum _e372 = sum_7;
            NormalsSum _e373 = normals_add_setting(view_22, _e371, _e372, _e179);
            sum_7 = _e373;
        }
        NormalsFan _e374 = fan_11;
        NormalsSum _e375 = sum_7;
        vec2 _e377 = normals_total(_e374, _e375, (seen_2 * side_1));
        parts = (_e377 * side_1);
    }
    float _e380 = parts.x;
    float energy_1 = clamp((_e380 * to_part), 0.0, clamp((seen_2 * to_part), 0.0, 1.0));
    float _e389 = parts.y;
    return vec2(energy_1, clamp((_e389 * to_part), 0.0, energy_1));
}

vec2 normals_rectangle(NormalsView view_23, vec3 corners[4], bool two_sided_1, uint rule_1) {
    vec3 vertices_2[8] = vec3[8](vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0));
    vertices_2[0] = corners[0];
    vertices_2[1] = corners[1];
    vertices_2[2] = corners[2];
    vertices_2[3] = corners[3];
    vec2 _e14 = normals_polygon(view_23, vertices_2, 4u, two_sided_1, rule_1);
    return _e14;
}

vec2 normals_disk(NormalsView view_24, vec3 centre, vec3 half_x, vec3 half_y, bool two_sided_2, uint rule_2) {
    vec3 vertices_3[8] = vec3[8](vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0));
    uint i_6 = 0u;
    bool loop_init_1 = true;
    while(true) {
        if (!loop_init_1) {
            uint _e30 = i_6;
            i_6 = (_e30 + 1u);
        }
        loop_init_1 = false;
        uint _e9 = i_6;
        if ((_e9 < 8u)) {
        } else {
            break;
        }
        {
            uint _e12 = i_6;
            vec2 _e18 = normals_ltc_sin_cos(((0.5 - float(_e12)) * 0.125));
            vec2 turn = (_e18 * 1.0539074);
            uint _e21 = i_6;
            vertices_3[_e21] = ((centre + (half_x * turn.y)) + (half_y * turn.x));
        }
    }
    vec2 _e33 = normals_polygon(view_24, vertices_3, 8u, two_sided_2, rule_2);
    return _e33;
}
