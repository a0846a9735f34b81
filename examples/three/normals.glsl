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
//     parts 0.702866 0.000223 | 0.710371 0.000052 | 0.704465 0.000247
//   alpha_x 0.2 alpha_y 0.6 wo (-0.64 0.48 0.6)
//     parts 0.550205 0.001271 | 0.599484 0.000332 | 0.553721 0.001490
//   alpha_x 0.05 alpha_y 0.02 wo (0.576 -0.768 0.28)
//     parts 0.989657 0.185364 | 0.991922 0.187098 | 0.989585 0.185611


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
};
struct NormalsEigenframe {
    vec3 values;
    mat3x3 vectors;
};
struct NormalsNumbers {
    vec3 edge;
    vec3 horizon;
};
struct NormalsSpoke {
    vec3 c;
    vec3 bend;
    vec3 at_end;
};
struct NormalsSum {
    vec3 all_;
    vec3 positive;
    float unknown;
};
struct NormalsOutline {
    uint number;
    uint start;
    bool is_cut;
    uint ups;
    uint edges;
    bool is_closed;
    float share;
    uint shift;
    bool many;
};
struct NormalsHorizon {
    vec3 begin;
    vec3 control;
    vec3 end;
    vec3 across;
};
const uint NORMALS_FAN = 0u;
const uint NORMALS_MEAN = 1u;
const uint NORMALS_FINE = 2u;


float normals_ltc_atan2_(float y, float x) {
    float low = min(y, abs(x));
    float high = max(y, abs(x));
    bool is_far = (low > (0.41421357 * high));
    float t_2 = ((is_far ? (low - high) : low) / max((is_far ? (low + high) : high), 1e-37));
    float z = (t_2 * t_2);
    float near_1 = (((((((((0.08053744 * z) - 0.13877685) * z) + 0.1997771) * z) - 0.3333295) * z) * t_2) + t_2);
    float eighth = (is_far ? (near_1 + 0.7853982) : near_1);
    float quarter = ((y > abs(x)) ? (1.5707964 - eighth) : eighth);
    return ((x < 0.0) ? (3.1415927 - quarter) : quarter);
}

vec2 normals_ltc_sin_cos(float turns) {
    bool local = false;
    float quarter_1 = floor(((4.0 * turns) + 0.5));
    float x_3 = ((turns - (0.25 * quarter_1)) * 6.2831855);
    float z_1 = (x_3 * x_3);
    float s = (((((((-0.00019515296 * z_1) + 0.008332161) * z_1) - 0.16666655) * z_1) * x_3) + x_3);
    float c_4 = ((((((((2.4433157e-5 * z_1) - 0.0013887316) * z_1) + 0.041666646) * z_1) * z_1) - (0.5 * z_1)) + 1.0);
    uint q = (uint(int(quarter_1)) & 3u);
    vec2 swapped = (((q & 1u) == 1u) ? vec2(c_4, s) : vec2(s, c_4));
    if (!((q == 1u))) {
        local = (q == 2u);
    } else {
        local = true;
    }
    bool _e64 = local;
    return vec2(((q >= 2u) ? -(swapped.x) : swapped.x), (_e64 ? -(swapped.y) : swapped.y));
}

float normals_ltc_log(float x_1) {
    int bits = (floatBitsToInt(x_1) - 1060439283);
    float m_4 = intBitsToFloat(((bits & 8388607) + 1060439283));
    float s_1 = ((m_4 - 1.0) / (m_4 + 1.0));
    float z_2 = (s_1 * s_1);
    float series = (((((((((0.22222222 * z_2) + 0.2857143) * z_2) + 0.4) * z_2) + 0.6666667) * z_2) * s_1) + (2.0 * s_1));
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
    return NormalsCorner(_e2, (_e5 * per_length), (length2_1 * per_length));
}

float normals_half_cosine(NormalsCorner a, NormalsCorner b) {
    vec3 sum_3 = (a.w + b.w);
    return max((0.5 * sqrt(dot(sum_3, sum_3))), 1e-6);
}

NormalsCorner normals_between(NormalsCorner a_1, NormalsCorner b_1, float t, NormalsView view_2) {
    float x_4 = ((1.0 - t) * sqrt(b_1.length_));
    float y_2 = (t * sqrt(a_1.length_));
    float _e16 = normals_half_cosine(a_1, b_1);
    vec3 middle = ((a_1.w + b_1.w) * ((x_4 * y_2) / _e16));
    NormalsCorner _e27 = normals_corner((((a_1.w * (x_4 * x_4)) + middle) + (b_1.w * (y_2 * y_2))), view_2);
    return _e27;
}

vec3 normals_arc_bend(vec3 a_2, vec3 b_2) {
    vec3 across_1 = cross(a_2, b_2);
    bool is_acute = (dot(a_2, b_2) >= 0.0);
    vec3 chord = (is_acute ? (a_2 - b_2) : (a_2 + b_2));
    float z_3 = (dot(chord, chord) * 0.25);
    float far = (z_3 * (2.271551 + (z_3 * (-3.4068606 + (z_3 * 3.516457)))));
    float bend = (z_3 * (0.6667554 + (z_3 * (0.52912635 + (z_3 * (0.52405584 + (z_3 * (-0.08954556 + far))))))));
    float obtuse = (((3.1415927 / sqrt(max(dot(across_1, across_1), 1e-18))) - bend) - 2.0);
    return (across_1 * (is_acute ? bend : obtuse));
}

mat2x3 normals_shared(vec3 a_3, vec3 m, vec3 b_3, vec3 whole) {
    vec3 _e4 = normals_arc_bend(a_3, m);
    vec3 _e5 = normals_arc_bend(m, b_3);
    vec3 rest = (((whole - cross((m - a_3), (b_3 - a_3))) - _e4) - _e5);
    vec2 length2_2 = vec2(dot((m - a_3), (m - a_3)), dot((b_3 - m), (b_3 - m)));
    vec2 cubes = (length2_2 * sqrt(length2_2));
    vec2 shares = (cubes / vec2(max((cubes.x + cubes.y), 1e-36)));
    return mat2x3((_e4 + (rest * shares.x)), (_e5 + (rest * shares.y)));
}

NormalsEigenframe normals_eigenframe(vec3 diagonal, vec3 off) {
    vec3 longest = vec3(0.0);
    mat3x3 m_5 = mat3x3(vec3(diagonal.x, off.x, off.y), vec3(off.x, diagonal.y, off.z), vec3(off.y, off.z, diagonal.z));
    float mean_1 = (((diagonal.x + diagonal.y) + diagonal.z) * 0.33333334);
    vec3 d = (diagonal - vec3(mean_1));
    float p2_ = (0.16666667 - ((0.5 * mean_1) * mean_1));
    float per_p = inversesqrt(p2_);
    float p = (p2_ * per_p);
    float determinant_ = (((d.x * ((d.y * d.z) - (off.z * off.z))) - (off.x * ((off.x * d.z) - (off.z * off.y)))) + (off.y * ((off.x * off.z) - (d.y * off.y))));
    float angle = ((0.5 * determinant_) * ((per_p * per_p) * per_p));
    float x_5 = min(abs(angle), 1.0);
    float near_2 = (0.8660254 + (x_5 * (0.1666667 + (x_5 * (-0.0425247 + (0.0098286 * x_5))))));
    float g = (((((8.0 * near_2) * near_2) * near_2) + x_5) / (((12.0 * near_2) * near_2) - 3.0));
    bool is_largest = !((angle < 0.0));
    float rough = (mean_1 + (((is_largest ? 2.0 : -2.0) * p) * g));
    vec3 row0_ = vec3((diagonal.x - rough), off.x, off.y);
    vec3 row1_ = vec3(off.x, (diagonal.y - rough), off.z);
    vec3 row2_ = vec3(off.y, off.z, (diagonal.z - rough));
    longest = cross(row0_, row1_);
    vec3 second_1 = cross(row0_, row2_);
    vec3 third = cross(row1_, row2_);
    vec3 _e117 = longest;
    vec3 _e119 = longest;
    vec3 _e120 = longest;
    longest = ((dot(second_1, second_1) > dot(_e119, _e120)) ? second_1 : _e117);
    vec3 _e124 = longest;
    vec3 _e126 = longest;
    vec3 _e127 = longest;
    longest = ((dot(third, third) > dot(_e126, _e127)) ? third : _e124);
    vec3 _e131 = longest;
    vec3 _e132 = longest;
    vec3 _e133 = longest;
    vec3 isolated = (_e131 * inversesqrt(max(dot(_e132, _e133), 1e-36)));
    float value = dot(isolated, (m_5 * isolated));
    float s_2 = ((isolated.z < 0.0) ? -1.0 : 1.0);
    float q_1 = (-1.0 / (s_2 + isolated.z));
    float r = ((isolated.x * isolated.y) * q_1);
    vec3 e = vec3((1.0 + (((s_2 * isolated.x) * isolated.x) * q_1)), (s_2 * r), (-(s_2) * isolated.x));
    vec3 f = vec3(r, (s_2 + ((isolated.y * isolated.y) * q_1)), -(isolated.y));
    vec3 image_e = (m_5 * e);
    vec3 image_f = (m_5 * f);
    float ee = dot(e, image_e);
    float ef = dot(e, image_f);
    float ff = dot(f, image_f);
    float middle_1 = (0.5 * (ee + ff));
    float lean = (0.5 * (ee - ff));
    float radius = sqrt(((lean * lean) + (ef * ef)));
    float longer = (radius + abs(lean));
    float per_turn = inversesqrt(max(((longer * longer) + (ef * ef)), 1e-36));
    float larger = ((longer > 1e-18) ? (longer * per_turn) : 1.0);
    float smaller = ((longer > 1e-18) ? (ef * per_turn) : 0.0);
    float flip = ((ef < 0.0) ? -1.0 : 1.0);
    vec2 turn = ((lean >= 0.0) ? vec2(larger, smaller) : vec2((flip * smaller), (flip * larger)));
    vec3 upper = ((e * turn.x) + (f * turn.y));
    vec3 lower = ((f * turn.x) - (e * turn.y));
    vec3 one = (is_largest ? isolated : upper);
    vec3 two = (is_largest ? upper : lower);
    vec3 values = (is_largest ? vec3(value, (middle_1 + radius), (middle_1 - radius)) : vec3((middle_1 + radius), (middle_1 - radius), value));
    return NormalsEigenframe(values, mat3x3(one, two, cross(one, two)));
}

float normals_atan2_(float y_1, float x_2) {
    float _e3 = normals_ltc_atan2_(abs(y_1), x_2);
    return ((y_1 < 0.0) ? -(_e3) : _e3);
}

vec3 normals_exact(NormalsView view_3, vec3 a_4, vec3 b_4, vec3 across, bool is_long) {
    bool local_1 = false;
    bool local_2 = false;
    bool local_3 = false;
    float turns_1 = ((dot(view_3.wo, across) < 0.0) ? -1.0 : 1.0);
    vec3 n = (across * turns_1);
    vec3 o = (view_3.wo * n);
    float ax = view_3.alpha.x;
    float ay = view_3.alpha.y;
    vec3 diagonal_1 = vec3(((ax * ax) * ((o.x - o.y) - o.z)), ((ay * ay) * ((o.y - o.x) - o.z)), ((o.z - o.x) - o.y));
    vec3 off_1 = vec3(((ax * ay) * ((view_3.wo.x * n.y) + (view_3.wo.y * n.x))), (ax * ((view_3.wo.x * n.z) + (view_3.wo.z * n.x))), (ay * ((view_3.wo.y * n.z) + (view_3.wo.z * n.y))));
    float per_norm = inversesqrt(max((dot(diagonal_1, diagonal_1) + (2.0 * dot(off_1, off_1))), 1e-36));
    NormalsEigenframe _e81 = normals_eigenframe((diagonal_1 * per_norm), (off_1 * per_norm));
    float l1_ = max(_e81.values.x, 1e-12);
    float l2_ = min(_e81.values.y, 0.0);
    float l3_ = min(_e81.values.z, l2_);
    mat3x3 v_3 = transpose(_e81.vectors);
    vec3 p0_ = (v_3 * a_4);
    vec3 p1_ = (v_3 * b_4);
    vec3 normal = (v_3 * cross(a_4, b_4));
    float d2_ = (l1_ - l2_);
    float e2_ = (l1_ - l3_);
    float g2_ = (l2_ - l3_);
    float d_1 = sqrt(d2_);
    float e_1 = sqrt(e2_);
    float g_1 = sqrt(g2_);
    float sense = ((p0_.x < 0.0) ? -(turns_1) : turns_1);
    float _e122 = normals_atan2_(((d_1 * e_1) * normal.x), (((d2_ * p0_.y) * p1_.y) + ((e2_ * p0_.z) * p1_.z)));
    if (((_e122 * sense) < 0.0)) {
        if (!((abs(_e122) > 0.01))) {
            local_2 = is_long;
        } else {
            local_2 = true;
        }
        bool _e135 = local_2;
        local_1 = _e135;
    } else {
        local_1 = false;
    }
    bool is_wrapped = local_1;
    float psi = (is_wrapped ? (_e122 + (sense * 6.2831855)) : _e122);
    float along1_ = ((l1_ / (d_1 * e_1)) * psi);
    float slope = (normal.y / (((d2_ * p0_.x) * p1_.x) - ((g2_ * p0_.z) * p1_.z)));
    float q_2 = ((d_1 * g_1) * slope);
    float q2_ = (q_2 * q_2);
    float ratio = clamp(((1.0 + q_2) / (1.0 - q_2)), 1e-30, 1e30);
    float _e167 = normals_ltc_log(ratio);
    float steep = ((0.5 * _e167) / max((d_1 * g_1), 1e-30));
    float along2_ = ((q2_ < 0.0025) ? (slope * (1.0 + (q2_ * (0.33333334 + (q2_ * 0.2))))) : steep);
    float bottom = (((e2_ * p0_.x) * p1_.x) + ((g2_ * p0_.y) * p1_.y));
    float top = ((e_1 * g_1) * normal.z);
    if ((bottom > 0.0)) {
        local_3 = (abs(top) < (0.03 * bottom));
    } else {
        local_3 = false;
    }
    bool is_small = local_3;
    float per_bottom = (1.0 / bottom);
    float share = (is_small ? (top * per_bottom) : 0.0);
    float r2_ = (share * share);
    float _e213 = normals_atan2_(top, bottom);
    float wide = (_e213 / max((e_1 * g_1), 1e-30));
    float along3_ = (is_small ? ((normal.z * per_bottom) * (1.0 - (r2_ * (0.33333334 - (r2_ * 0.2))))) : wide);
    return (_e81.vectors * vec3(along1_, (-(l2_) * along2_), (-(l3_) * along3_)));
}

vec2 normals_weight(NormalsView view_4, vec3 c) {
    vec3 h_1 = vec3((view_4.alpha * c.xy), c.z);
    float length2_3 = max(dot(h_1, h_1), 1e-36);
    float cosine = dot(view_4.wo, h_1);
    vec3 wi = ((h_1 * (2.0 * cosine)) - (view_4.wo * length2_3));
    float up = max(wi.z, 0.0);
    vec2 across_2 = (view_4.alpha * wi.xy);
    float stretched_1 = sqrt((dot(across_2, across_2) + (wi.z * wi.z)));
    float weight = (((view_4.wo.z + view_4.length_) * up) / max(((view_4.length_ * up) + (view_4.wo.z * stretched_1)), 1e-36));
    float m_6 = clamp((1.0 - (cosine * inversesqrt(length2_3))), 0.0, 1.0);
    float m2_ = (m_6 * m_6);
    return vec2(weight, ((m2_ * m2_) * m_6));
}

NormalsNumbers normals_numbers(NormalsView view_5, bool is_fine) {
    vec3 edge = vec3(0.0);
    vec3 horizon = vec3(0.0);
    float mu = (view_5.wo.z / view_5.length_);
    float alpha_1 = max(view_5.alpha.x, view_5.alpha.y);
    vec4 at = vec4(1.0, mu, alpha_1, (alpha_1 * mu));
    edge = (mat4x3(vec3(0.492, 0.042, 0.45), vec3(-0.033, -0.052, 0.114), vec3(0.193, 0.044, -0.292), vec3(-0.188, 0.167, -0.296)) * at);
    horizon = (mat4x3(vec3(0.103, 0.243, 0.267), vec3(0.112, -0.064, -0.205), vec3(0.087, 0.076, 0.295), vec3(-0.011, -0.137, 0.105)) * at);
    if (is_fine) {
        edge = (mat4x3(vec3(0.356, 0.062, 0.361), vec3(0.037, -0.065, 0.007), vec3(0.448, 0.028, -0.325), vec3(-0.008, 0.165, -0.161)) * at);
        horizon = (mat4x3(vec3(0.088, 0.282, 0.371), vec3(0.107, -0.077, -0.194), vec3(0.048, 0.074, 0.269), vec3(0.009, -0.129, 0.021)) * at);
    }
    vec3 _e88 = edge;
    vec3 _e92 = horizon;
    return NormalsNumbers(max(_e88, vec3(0.0)), max(_e92, vec3(0.02, 0.0, 0.0)));
}

float normals_to_horizon(float tip, float near, float rate) {
    float root = sqrt(((rate * near) * max((tip - near), 0.0)));
    float rest_1 = (near / max((near + root), 1e-36));
    float u = (1.0 - rest_1);
    float series_1 = (2.0 + (u * (-7.406265 + (u * (21.07087 + (u * (-31.448433 + (u * 16.743261))))))));
    return (((tip * rest_1) * rest_1) * (1.0 + (u * series_1)));
}

vec3 normals_centroid(vec3 flux, vec3 tip_1) {
    vec3 _e2 = normals_unit(flux);
    float share_1 = clamp((10.0 * dot(_e2, tip_1)), -1.0, 1.0);
    return ((share_1 * _e2) + ((1.0 - abs(share_1)) * tip_1));
}

vec3 normals_sample(NormalsView view_6, vec3 c_1) {
    vec2 _e2 = normals_weight(view_6, c_1);
    float seen_1 = max(dot(c_1, view_6.stretched), 0.0);
    return vec3(seen_1, (seen_1 * _e2.x), ((seen_1 * _e2.x) * _e2.y));
}

NormalsSpoke normals_spoke(NormalsView view_7, NormalsNumbers numbers, vec3 tip_2, vec3 c_2) {
    vec3 _e4 = normals_arc_bend(tip_2, c_2);
    vec3 _e7 = normals_sample(view_7, c_2);
    return NormalsSpoke(c_2, _e4, (numbers.edge.y * _e7));
}

vec3 normals_flux(vec3 tip_3, NormalsSpoke a_5, NormalsSpoke b_5, vec3 curved) {
    return ((cross((a_5.c - tip_3), (b_5.c - tip_3)) + curved) + (a_5.bend - b_5.bend));
}

vec2 normals_triangle(NormalsView view_8, NormalsNumbers numbers_1, vec3 tip_4, vec3 m_1, vec3 corners) {
    vec3 _e10 = normals_sample(view_8, (m_1 + (numbers_1.edge.z * (m_1 - tip_4))));
    vec3 _e11 = normals_sample(view_8, m_1);
    vec3 mean_2 = ((_e11 + (numbers_1.edge.x * _e10)) + corners);
    return (mean_2.yz / vec2(max(mean_2.x, 1e-18)));
}

float normals_rise(NormalsView view_9, vec3 c_3) {
    vec3 h_2 = vec3((view_9.alpha * c_3.xy), c_3.z);
    return (((2.0 * dot(view_9.wo, h_2)) * h_2.z) - (dot(h_2, h_2) * view_9.wo.z));
}

NormalsSum normals_add(NormalsView view_10, NormalsSum sum, float least_rise, vec3 m_2, float whole_1, vec2 mean) {
    float _e6 = normals_rise(view_10, m_2);
    float known = clamp((_e6 / least_rise), 0.0, 1.0);
    vec3 part_1 = ((known * whole_1) * vec3(1.0, mean));
    return NormalsSum((sum.all_ + part_1), (sum.positive + ((part_1.x > 0.0) ? part_1 : vec3(0.0))), ((sum.unknown + whole_1) - part_1.x));
}

vec2 normals_total(NormalsSum sum_1, float seen, vec2 at_tip) {
    float share_2 = clamp((((sum_1.positive.x + sum_1.unknown) - seen) / max(seen, 1e-18)), 0.0, 0.5);
    float tip_6 = (1e-6 * max(seen, 1e-18));
    float per_part = (((share_2 * sum_1.unknown) + ((1.0 - share_2) * seen)) / (sum_1.positive.x + tip_6));
    return ((share_2 * sum_1.all_.yz) + (per_part * (sum_1.positive.yz + ((tip_6 * at_tip.x) * vec2(1.0, at_tip.y)))));
}

vec2 normals_horizon_triangle(NormalsView view_11, NormalsNumbers numbers_2, vec3 tip_5, vec2 at_tip_1, vec3 m_3) {
    vec2 _e10 = normals_weight(view_11, (m_3 + (numbers_2.horizon.y * (m_3 - tip_5))));
    float _e15 = normals_to_horizon(at_tip_1.x, _e10.x, numbers_2.horizon.x);
    return (_e15 * vec2(1.0, mix(_e10.y, at_tip_1.y, numbers_2.horizon.z)));
}

vec3 normals_get(inout vec3 list[8], uint i, bool many) {
    bool local_4 = false;
    vec3 _e4 = list[0];
    vec3 _e6 = list[1];
    vec3 _e11 = list[2];
    vec3 _e13 = list[3];
    vec3 low_1 = ((i >= 2u) ? ((i == 3u) ? _e13 : _e11) : ((i == 1u) ? _e6 : _e4));
    vec3 _e21 = list[4];
    vec3 _e23 = list[5];
    vec3 _e28 = list[6];
    vec3 _e30 = list[7];
    vec3 high_1 = ((i >= 6u) ? ((i == 7u) ? _e30 : _e28) : ((i == 5u) ? _e23 : _e21));
    if (many) {
        local_4 = (i >= 4u);
    } else {
        local_4 = false;
    }
    bool _e42 = local_4;
    return (_e42 ? high_1 : low_1);
}

void normals_put(inout vec3 list_1[8], uint i_1, vec3 v_2, bool many_1) {
    bool local_5 = false;
    bool local_6 = false;
    bool local_7 = false;
    bool local_8 = false;
    vec3 _e6 = list_1[0];
    list_1[0] = ((i_1 == 0u) ? v_2 : _e6);
    vec3 _e12 = list_1[1];
    list_1[1] = ((i_1 == 1u) ? v_2 : _e12);
    vec3 _e18 = list_1[2];
    list_1[2] = ((i_1 == 2u) ? v_2 : _e18);
    vec3 _e24 = list_1[3];
    list_1[3] = ((i_1 == 3u) ? v_2 : _e24);
    vec3 _e30 = list_1[4];
    if (many_1) {
        local_5 = (i_1 == 4u);
    } else {
        local_5 = false;
    }
    bool _e36 = local_5;
    list_1[4] = (_e36 ? v_2 : _e30);
    vec3 _e40 = list_1[5];
    if (many_1) {
        local_6 = (i_1 == 5u);
    } else {
        local_6 = false;
    }
    bool _e46 = local_6;
    list_1[5] = (_e46 ? v_2 : _e40);
    vec3 _e50 = list_1[6];
    if (many_1) {
        local_7 = (i_1 == 6u);
    } else {
        local_7 = false;
    }
    bool _e56 = local_7;
    list_1[6] = (_e56 ? v_2 : _e50);
    vec3 _e60 = list_1[7];
    if (many_1) {
        local_8 = (i_1 == 7u);
    } else {
        local_8 = false;
    }
    bool _e66 = local_8;
    list_1[7] = (_e66 ? v_2 : _e60);
    return;
}

vec3 normals_crossing(vec3 a_6, vec3 b_6) {
    return vec3(((a_6.xy * abs(b_6.z)) + (b_6.xy * abs(a_6.z))), 0.0);
}

NormalsOutline normals_outline(inout vec3 vertices_1[8], uint number) {
    NormalsOutline outline = NormalsOutline(0u, 0u, false, 0u, 0u, false, 0.0, 0u, false);
    vec3 before = vec3(0.0);
    float height = 0.0;
    vec3 rise = vec3(0.0);
    vec3 sink = vec3(0.0);
    uint i_2 = 0u;
    bool local_9 = false;
    bool local_10 = false;
    uint nearest = 0u;
    float nearness = 0.0;
    float second = 0.0;
    float extents = 0.0;
    uint i_3 = 0u;
    bool local_11 = false;
    outline = NormalsOutline(number, 0u, false, 0u, number, false, 0.0, 0u, (number > 4u));
    bool _e15 = outline.many;
    vec3 _e16 = normals_get(vertices_1, (number - 1u), _e15);
    before = _e16;
    bool loop_init = true;
    while(true) {
        if (!loop_init) {
            uint _e70 = i_2;
            i_2 = (_e70 + 1u);
        }
        loop_init = false;
        uint _e28 = i_2;
        if ((_e28 < number)) {
        } else {
            break;
        }
        {
            uint _e30 = i_2;
            bool _e32 = outline.many;
            vec3 _e33 = normals_get(vertices_1, _e30, _e32);
            bool is_up = (_e33.z > 0.0);
            vec3 _e37 = before;
            vec3 _e38 = normals_crossing(_e37, _e33);
            float _e39 = height;
            height = max(_e39, _e33.z);
            if (is_up) {
                float _e45 = before.z;
                local_9 = (_e45 <= 0.0);
            } else {
                local_9 = false;
            }
            bool _e49 = local_9;
            if (_e49) {
                uint _e51 = i_2;
                outline.start = _e51;
                outline.is_cut = true;
                rise = _e38;
            }
            if (!(is_up)) {
                float _e58 = before.z;
                local_10 = (_e58 > 0.0);
            } else {
                local_10 = false;
            }
            bool _e62 = local_10;
            if (_e62) {
                sink = _e38;
            }
            uint _e64 = outline.ups;
            outline.ups = (_e64 + (is_up ? 1u : 0u));
            before = _e33;
        }
    }
    before = _e16;
    bool loop_init_1 = true;
    while(true) {
        if (!loop_init_1) {
            uint _e148 = i_3;
            i_3 = (_e148 + 1u);
        }
        loop_init_1 = false;
        uint _e82 = i_3;
        if ((_e82 < number)) {
        } else {
            break;
        }
        {
            uint _e84 = i_3;
            bool _e86 = outline.many;
            vec3 _e87 = normals_get(vertices_1, _e84, _e86);
            float _e89 = before.z;
            float top_1 = max(_e89, _e87.z);
            float _e92 = height;
            float near_3 = ((top_1 > 0.0) ? (1.0 - (top_1 / max((0.25 * _e92), 1e-36))) : 0.0);
            if ((near_3 > 0.0)) {
                vec3 _e106 = before;
                vec3 _e107 = normals_crossing(_e106, _e87);
                vec3 _e108 = before;
                float _e110 = before.z;
                vec3 begin_1 = ((_e110 > 0.0) ? _e108 : _e107);
                vec3 end_1 = ((_e87.z > 0.0) ? _e87 : _e107);
                float _e118 = extents;
                vec3 _e119 = normals_unit(begin_1);
                vec3 _e120 = normals_unit(end_1);
                extents = (_e118 + (near_3 * distance(_e119, _e120)));
                float _e124 = second;
                float _e125 = nearness;
                second = max(_e124, min(near_3, _e125));
                uint _e128 = i_3;
                uint _e131 = outline.start;
                bool _e137 = outline.is_cut;
                uint edge_2 = (((_e128 + number) - _e131) + (_e137 ? 0u : (number - 1u)));
                uint _e140 = nearest;
                float _e142 = nearness;
                nearest = ((near_3 > _e142) ? (edge_2 % number) : _e140);
                float _e145 = nearness;
                nearness = max(_e145, near_3);
            }
            before = _e87;
        }
    }
    float _e151 = nearness;
    float _e152 = second;
    outline.share = (_e151 - _e152);
    bool _e156 = outline.is_cut;
    if (!(_e156)) {
        float _e161 = outline.share;
        local_11 = (_e161 > 0.0);
    } else {
        local_11 = true;
    }
    bool _e165 = local_11;
    outline.is_closed = _e165;
    bool _e167 = outline.is_cut;
    if (_e167) {
        uint _e170 = outline.ups;
        outline.edges = (_e170 + 2u);
        vec3 _e173 = rise;
        vec3 _e174 = normals_unit(_e173);
        vec3 _e175 = sink;
        vec3 _e176 = normals_unit(_e175);
        float horizon_2 = distance(_e174, _e176);
        float _e178 = extents;
        float extent = (horizon_2 / max((horizon_2 + _e178), 1e-36));
        float _e184 = outline.share;
        float other = (_e184 * (1.0 - extent));
        outline.share = abs((extent - other));
        uint _e191 = nearest;
        uint _e193 = outline.ups;
        nearest = ((extent >= other) ? (_e193 + 1u) : _e191);
    }
    uint _e200 = nearest;
    uint _e204 = outline.edges;
    bool _e207 = outline.is_closed;
    outline.shift = (_e207 ? ((_e200 + 1u) % _e204) : 0u);
    NormalsOutline _e209 = outline;
    return _e209;
}

NormalsCorner normals_outline_corner(NormalsView view_12, NormalsOutline outline_1, inout vec3 vertices_2[8], uint i_4) {
    bool local_12 = false;
    bool local_13 = false;
    bool local_14 = false;
    uint turned = (i_4 + outline_1.shift);
    uint k = ((turned >= outline_1.edges) ? (turned - outline_1.edges) : turned);
    if (outline_1.is_cut) {
        if (!((k == 0u))) {
            local_13 = (k == (outline_1.ups + 1u));
        } else {
            local_13 = true;
        }
        bool _e24 = local_13;
        local_12 = _e24;
    } else {
        local_12 = false;
    }
    bool is_crossing = local_12;
    if (outline_1.is_cut) {
        local_14 = (k > 0u);
    } else {
        local_14 = false;
    }
    bool _e37 = local_14;
    uint at_1 = ((outline_1.start + k) - (_e37 ? 1u : 0u));
    uint before_2 = ((at_1 == 0u) ? (outline_1.number - 1u) : (at_1 - 1u));
    vec3 _e54 = normals_get(vertices_2, ((at_1 >= outline_1.number) ? (at_1 - outline_1.number) : at_1), outline_1.many);
    vec3 _e61 = normals_get(vertices_2, ((before_2 >= outline_1.number) ? (before_2 - outline_1.number) : before_2), outline_1.many);
    vec3 _e62 = normals_crossing(_e61, _e54);
    NormalsCorner _e64 = normals_corner((is_crossing ? _e62 : _e54), view_12);
    return _e64;
}

NormalsHorizon normals_horizon(NormalsView view_13, NormalsCorner begin, NormalsCorner end) {
    bool local_15 = false;
    vec3 sum_4 = (begin.w + end.w);
    float _e6 = normals_half_cosine(begin, end);
    vec3 _e13 = normals_unstretched(((view_13.wo * _e6) + (sum_4 * (0.5 / _e6))), view_13);
    vec3 turn_1 = cross(begin.w, (end.w - begin.w));
    if ((begin.w.z == 0.0)) {
        local_15 = (end.w.z == 0.0);
    } else {
        local_15 = false;
    }
    bool is_level = local_15;
    vec3 across_3 = (is_level ? vec3(0.0, 0.0, ((turn_1.z < 0.0) ? -1.0 : 1.0)) : turn_1);
    return NormalsHorizon(begin.c, (_e13 * inversesqrt((begin.length_ * end.length_))), end.c, across_3);
}

vec3 normals_on_horizon(NormalsHorizon horizon_1, float t_1) {
    float u_1 = (1.0 - t_1);
    vec3 _e17 = normals_unit((((horizon_1.begin * (u_1 * u_1)) + (horizon_1.control * ((2.0 * u_1) * t_1))) + (horizon_1.end * (t_1 * t_1))));
    return ((t_1 >= 1.0) ? horizon_1.end : _e17);
}

vec2 normals_polygon(NormalsView view_14, inout vec3 vertices_3[8], uint count, bool two_sided, uint rule) {
    vec3 ends[8] = vec3[8](vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0));
    vec3 curves[8] = vec3[8](vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0));
    vec3 half_ends[8] = vec3[8](vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0));
    vec3 half_curves[8] = vec3[8](vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0));
    vec3 horizon_curves[8] = vec3[8](vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0));
    vec3 closing = vec3(0.0);
    vec3 half_closing = vec3(0.0);
    vec3 half_end = vec3(0.0);
    vec3 arc_start = vec3(0.0);
    vec3 flux_1 = vec3(0.0);
    NormalsCorner last = NormalsCorner(vec3(0.0), vec3(0.0), 0.0);
    uint edge_1 = 0u;
    bool is_second = false;
    uint step_ = 0u;
    bool local_16 = false;
    bool local_17 = false;
    NormalsCorner to = NormalsCorner(vec3(0.0), vec3(0.0), 0.0);
    bool local_18 = false;
    bool local_19 = false;
    bool local_20 = false;
    bool local_21 = false;
    bool local_22 = false;
    vec2 parts = vec2(0.0);
    NormalsSum sum_2 = NormalsSum(vec3(0.0), vec3(0.0), 0.0);
    NormalsSpoke before_1 = NormalsSpoke(vec3(0.0), vec3(0.0), vec3(0.0));
    NormalsSpoke setting = NormalsSpoke(vec3(0.0), vec3(0.0), vec3(0.0));
    uint i_5 = 0u;
    uint part = 0u;
    NormalsOutline _e8 = normals_outline(vertices_3, min(max(count, 3u), 8u));
    if ((_e8.ups == 0u)) {
        return vec2(0.0);
    }
    bool many_2 = _e8.many;
    bool is_fine_1 = (rule == NORMALS_FINE);
    uint edge_parts = (is_fine_1 ? 2u : 1u);
    uint horizon_parts = ((rule == NORMALS_MEAN) ? 1u : (is_fine_1 ? 4u : 2u));
    uint edges = (_e8.edges - (_e8.is_closed ? 1u : 0u));
    uint closing_parts = (_e8.is_closed ? horizon_parts : 0u);
    NormalsCorner _e37 = normals_outline_corner(view_14, _e8, vertices_3, 0u);
    NormalsCorner _e38 = normals_outline_corner(view_14, _e8, vertices_3, edges);
    NormalsHorizon _e39 = normals_horizon(view_14, _e38, _e37);
    arc_start = _e37.c;
    last = _e37;
    bool loop_init_2 = true;
    while(true) {
        if (!loop_init_2) {
            uint _e217 = step_;
            step_ = (_e217 + 1u);
        }
        loop_init_2 = false;
        uint _e66 = step_;
        if ((_e66 < ((edges * edge_parts) + closing_parts))) {
        } else {
            break;
        }
        {
            uint _e70 = edge_1;
            bool is_closing = (_e70 >= edges);
            if (is_fine_1) {
                bool _e74 = is_second;
                local_16 = !(_e74);
            } else {
                local_16 = false;
            }
            bool _e77 = local_16;
            if (_e77) {
                local_17 = !(is_closing);
            } else {
                local_17 = false;
            }
            bool is_half = local_17;
            uint _e83 = edge_1;
            NormalsCorner _e86 = normals_outline_corner(view_14, _e8, vertices_3, (_e83 + 1u));
            to = _e86;
            if (is_half) {
                NormalsCorner _e88 = last;
                NormalsCorner _e89 = to;
                NormalsCorner _e91 = normals_between(_e88, _e89, 0.5, view_14);
                to = _e91;
            }
            uint _e92 = edge_1;
            float t_3 = (float(((_e92 + 1u) - edges)) / float(horizon_parts));
            vec3 _e100 = to.c;
            vec3 _e101 = normals_on_horizon(_e39, t_3);
            vec3 c_5 = (is_closing ? _e101 : _e100);
            vec3 _e104 = to.w;
            vec3 _e106 = last.w;
            vec3 apart = (_e104 - _e106);
            vec3 _e109 = last.w;
            vec3 across_4 = (is_closing ? _e39.across : cross(_e109, apart));
            vec3 _e114 = last.c;
            if (!(is_closing)) {
                vec3 _e119 = last.w;
                vec3 _e121 = to.w;
                local_18 = (dot(_e119, _e121) < 0.9);
            } else {
                local_18 = true;
            }
            bool _e126 = local_18;
            vec3 _e127 = normals_exact(view_14, _e114, c_5, across_4, _e126);
            bool is_edge = ((is_closing ? dot(across_4, across_4) : dot(apart, apart)) >= 1e-14);
            vec3 _e134 = last.c;
            vec3 curved_1 = (is_edge ? (_e127 - cross(_e134, c_5)) : vec3(0.0));
            vec3 _e140 = flux_1;
            vec3 _e142 = last.c;
            flux_1 = (_e140 + (curved_1 + cross((_e142 - _e37.c), (c_5 - _e37.c))));
            if (is_fine_1) {
                uint _e151 = edge_1;
                normals_put(half_ends, (is_half ? _e151 : 8u), c_5, many_2);
                uint _e154 = edge_1;
                normals_put(half_curves, (is_half ? _e154 : 8u), curved_1, many_2);
            }
            uint _e156 = edge_1;
            if (!(is_half)) {
                local_19 = is_closing;
            } else {
                local_19 = true;
            }
            bool _e162 = local_19;
            normals_put(ends, (_e162 ? 8u : _e156), c_5, many_2);
            uint _e164 = edge_1;
            if (!(is_half)) {
                local_20 = is_closing;
            } else {
                local_20 = true;
            }
            bool _e170 = local_20;
            normals_put(curves, (_e170 ? 8u : _e164), curved_1, many_2);
            uint _e173 = edge_1;
            normals_put(horizon_curves, (is_closing ? (_e173 - edges) : 8u), curved_1, false);
            vec3 _e177 = arc_start;
            arc_start = (is_closing ? _e177 : c_5);
            vec3 _e179 = closing;
            vec3 _e181 = last.c;
            vec3 _e182 = arc_start;
            vec3 _e184 = arc_start;
            closing = (_e179 + (is_closing ? (curved_1 + cross((_e181 - _e182), (c_5 - _e184))) : vec3(0.0)));
            if (is_fine_1) {
                uint _e194 = edge_1;
                local_21 = ((_e194 + 1u) == (edges + (horizon_parts / 2u)));
            } else {
                local_21 = false;
            }
            bool _e202 = local_21;
            if (_e202) {
                vec3 _e203 = closing;
                half_closing = _e203;
                half_end = c_5;
                closing = vec3(0.0);
                arc_start = c_5;
            }
            vec3 _e207 = to.w;
            float _e209 = to.length_;
            last = NormalsCorner(_e207, c_5, _e209);
            uint _e211 = edge_1;
            edge_1 = (_e211 + (is_half ? 0u : 1u));
            is_second = is_half;
        }
    }
    vec3 _e219 = flux_1;
    float seen_2 = dot(_e219, view_14.stretched);
    float side = ((seen_2 < 0.0) ? -1.0 : 1.0);
    if ((side < 0.0)) {
        local_22 = !(two_sided);
    } else {
        local_22 = false;
    }
    bool _e233 = local_22;
    if (_e233) {
        return vec2(0.0);
    }
    float to_part = ((side * 0.3183099) / (view_14.wo.z + view_14.length_));
    vec3 _e243 = flux_1;
    vec3 _e245 = normals_unit((_e243 * side));
    vec2 _e246 = normals_weight(view_14, _e245);
    parts = (vec2(_e246.x, (_e246.x * _e246.y)) * seen_2);
    if ((rule != NORMALS_MEAN)) {
        float _e263 = normals_rise(view_14, _e245);
        float least_rise_1 = max((0.125 * _e263), 1e-36);
        vec3 sided = (side * view_14.stretched);
        NormalsNumbers _e270 = normals_numbers(view_14, is_fine_1);
        vec3 _e271 = normals_sample(view_14, _e245);
        vec3 tip_share = (0.03 * _e271);
        NormalsSpoke _e275 = normals_spoke(view_14, _e270, _e245, _e37.c);
        before_1 = _e275;
        setting = _e275;
        bool loop_init_3 = true;
        while(true) {
            if (!loop_init_3) {
                uint _e336 = i_5;
                i_5 = (_e336 + 1u);
            }
            loop_init_3 = false;
            uint _e280 = i_5;
            if ((_e280 < _e8.edges)) {
            } else {
                break;
            }
            {
                uint _e283 = i_5;
                bool is_closing_1 = (_e283 == edges);
                if (is_closing_1) {
                    NormalsSpoke _e285 = before_1;
                    setting = _e285;
                }
                float counts = (is_closing_1 ? (1.0 - _e8.share) : 1.0);
                if (is_fine_1) {
                    uint _e291 = i_5;
                    vec3 _e292 = normals_get(half_ends, _e291, many_2);
                    vec3 _e293 = half_end;
                    vec3 half_c = (is_closing_1 ? _e293 : _e292);
                    uint _e295 = i_5;
                    vec3 _e296 = normals_get(half_curves, _e295, many_2);
                    vec3 _e297 = half_closing;
                    vec3 half_curved = (is_closing_1 ? _e297 : _e296);
                    NormalsSpoke _e299 = normals_spoke(view_14, _e270, _e245, half_c);
                    NormalsSpoke _e300 = before_1;
                    vec3 _e301 = normals_flux(_e245, _e300, _e299, half_curved);
                    vec3 _e302 = normals_centroid(_e301, _e245);
                    vec3 _e304 = before_1.at_end;
                    vec2 _e308 = normals_triangle(view_14, _e270, _e245, _e302, ((tip_share + _e304) + _e299.at_end));
                    NormalsSum _e309 = sum_2;
                    NormalsSum _e312 = normals_add(view_14, _e309, least_rise_1, _e302, (counts * dot(_e301, sided)), _e308);
                    sum_2 = _e312;
                    before_1 = _e299;
                }
                uint _e313 = i_5;
                vec3 _e314 = normals_get(ends, _e313, many_2);
                vec3 c_6 = (is_closing_1 ? _e37.c : _e314);
                uint _e317 = i_5;
                vec3 _e318 = normals_get(curves, _e317, many_2);
                vec3 _e319 = closing;
                vec3 curved_2 = (is_closing_1 ? _e319 : _e318);
                NormalsSpoke _e321 = normals_spoke(view_14, _e270, _e245, c_6);
                NormalsSpoke _e322 = before_1;
                vec3 _e323 = normals_flux(_e245, _e322, _e321, curved_2);
                vec3 _e324 = normals_centroid(_e323, _e245);
                vec3 _e326 = before_1.at_end;
                vec2 _e330 = normals_triangle(view_14, _e270, _e245, _e324, ((tip_share + _e326) + _e321.at_end));
                NormalsSum _e331 = sum_2;
                NormalsSum _e334 = normals_add(view_14, _e331, least_rise_1, _e324, (counts * dot(_e323, sided)), _e330);
                sum_2 = _e334;
                before_1 = _e321;
            }
        }
        NormalsSpoke _e338 = setting;
        before_1 = _e338;
        bool loop_init_4 = true;
        while(true) {
            if (!loop_init_4) {
                uint _e391 = part;
                part = (_e391 + 1u);
            }
            loop_init_4 = false;
            uint _e341 = part;
            if ((_e341 < closing_parts)) {
            } else {
                break;
            }
            {
                uint _e343 = part;
                vec3 _e349 = normals_on_horizon(_e39, ((float(_e343) + 0.5) / float(horizon_parts)));
                uint _e350 = part;
                vec3 _e356 = normals_on_horizon(_e39, (float((_e350 + 1u)) / float(horizon_parts)));
                vec3 _e358 = before_1.c;
                uint _e359 = part;
                vec3 _e361 = normals_get(horizon_curves, _e359, false);
                mat2x3 _e362 = normals_shared(_e358, _e349, _e356, _e361);
                vec3 _e363 = normals_arc_bend(_e245, _e349);
                NormalsSpoke half_ = NormalsSpoke(_e349, _e363, vec3(0.0));
                vec3 _e367 = normals_arc_bend(_e245, _e356);
                NormalsSpoke to_1 = NormalsSpoke(_e356, _e367, vec3(0.0));
                NormalsSpoke _e371 = before_1;
                vec3 _e373 = normals_flux(_e245, _e371, half_, _e362[0]);
                vec3 _e374 = normals_centroid(_e373, _e245);
                vec2 _e375 = normals_horizon_triangle(view_14, _e270, _e245, _e246, _e374);
                NormalsSum _e376 = sum_2;
                NormalsSum _e380 = normals_add(view_14, _e376, least_rise_1, _e374, (_e8.share * dot(_e373, sided)), _e375);
                sum_2 = _e380;
                vec3 _e382 = normals_flux(_e245, half_, to_1, _e362[1]);
                vec3 _e383 = normals_centroid(_e382, _e245);
                vec2 _e384 = normals_horizon_triangle(view_14, _e270, _e245, _e246, _e383);
                NormalsSum _e385 = sum_2;
                NormalsSum _e389 = normals_add(view_14, _e385, least_rise_1, _e383, (_e8.share * dot(_e382, sided)), _e384);
                sum_2 = _e389;
                before_1 = to_1;
            }
        }
        NormalsSum _e393 = sum_2;
        vec2 _e395 = normals_total(_e393, (seen_2 * side), _e246);
        parts = (_e395 * side);
    }
    float _e398 = parts.x;
    float energy = clamp((_e398 * to_part), 0.0, clamp((seen_2 * to_part), 0.0, 1.0));
    float _e407 = parts.y;
    return vec2(energy, clamp((_e407 * to_part), 0.0, energy));
}

vec2 normals_rectangle(NormalsView view_15, vec3 corners_1[4], bool two_sided_1, uint rule_1) {
    vec3 vertices_4[8] = vec3[8](vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0));
    vertices_4[0] = corners_1[0];
    vertices_4[1] = corners_1[1];
    vertices_4[2] = corners_1[2];
    vertices_4[3] = corners_1[3];
    vec2 _e14 = normals_polygon(view_15, vertices_4, 4u, two_sided_1, rule_1);
    return _e14;
}

vec2 normals_disk(NormalsView view_16, vec3 centre, vec3 half_x, vec3 half_y, bool two_sided_2, uint rule_2) {
    vec3 vertices_5[8] = vec3[8](vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0));
    uint i_6 = 0u;
    bool loop_init_5 = true;
    while(true) {
        if (!loop_init_5) {
            uint _e30 = i_6;
            i_6 = (_e30 + 1u);
        }
        loop_init_5 = false;
        uint _e9 = i_6;
        if ((_e9 < 8u)) {
        } else {
            break;
        }
        {
            uint _e12 = i_6;
            vec2 _e18 = normals_ltc_sin_cos(((0.5 - float(_e12)) * 0.125));
            vec2 turn_2 = (_e18 * 1.0539074);
            uint _e21 = i_6;
            vertices_5[_e21] = ((centre + (half_x * turn_2.y)) + (half_y * turn_2.x));
        }
    }
    vec2 _e33 = normals_polygon(view_16, vertices_5, 8u, two_sided_2, rule_2);
    return _e33;
}
