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
//     parts 0.701572 0.000219 | 0.710371 0.000052 | 0.704523 0.000244
//   alpha_x 0.2 alpha_y 0.6 wo (-0.64 0.48 0.6)
//     parts 0.549790 0.001242 | 0.599484 0.000332 | 0.553100 0.001496
//   alpha_x 0.05 alpha_y 0.02 wo (0.576 -0.768 0.28)
//     parts 0.988140 0.187998 | 0.991922 0.187098 | 0.989343 0.187655


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
    float share;
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
    float m_3 = intBitsToFloat(((bits & 8388607) + 1060439283));
    float s_1 = ((m_3 - 1.0) / (m_3 + 1.0));
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

NormalsEigenframe normals_eigenframe(vec3 diagonal, vec3 off) {
    vec3 longest = vec3(0.0);
    mat3x3 m_4 = mat3x3(vec3(diagonal.x, off.x, off.y), vec3(off.x, diagonal.y, off.z), vec3(off.y, off.z, diagonal.z));
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
    vec3 second = cross(row0_, row2_);
    vec3 third = cross(row1_, row2_);
    vec3 _e117 = longest;
    vec3 _e119 = longest;
    vec3 _e120 = longest;
    longest = ((dot(second, second) > dot(_e119, _e120)) ? second : _e117);
    vec3 _e124 = longest;
    vec3 _e126 = longest;
    vec3 _e127 = longest;
    longest = ((dot(third, third) > dot(_e126, _e127)) ? third : _e124);
    vec3 _e131 = longest;
    vec3 _e132 = longest;
    vec3 _e133 = longest;
    vec3 isolated = (_e131 * inversesqrt(max(dot(_e132, _e133), 1e-36)));
    float value = dot(isolated, (m_4 * isolated));
    float s_2 = ((isolated.z < 0.0) ? -1.0 : 1.0);
    float q_1 = (-1.0 / (s_2 + isolated.z));
    float r = ((isolated.x * isolated.y) * q_1);
    vec3 e = vec3((1.0 + (((s_2 * isolated.x) * isolated.x) * q_1)), (s_2 * r), (-(s_2) * isolated.x));
    vec3 f = vec3(r, (s_2 + ((isolated.y * isolated.y) * q_1)), -(isolated.y));
    vec3 image_e = (m_4 * e);
    vec3 image_f = (m_4 * f);
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

vec3 normals_exact(NormalsView view_3, vec3 a_3, vec3 b_3, vec3 across, bool is_long) {
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
    vec3 p0_ = (v_3 * a_3);
    vec3 p1_ = (v_3 * b_3);
    vec3 normal = (v_3 * cross(a_3, b_3));
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
    float length2_2 = max(dot(h_1, h_1), 1e-36);
    float cosine = dot(view_4.wo, h_1);
    vec3 wi = ((h_1 * (2.0 * cosine)) - (view_4.wo * length2_2));
    float up = max(wi.z, 0.0);
    vec2 across_2 = (view_4.alpha * wi.xy);
    float stretched_1 = sqrt((dot(across_2, across_2) + (wi.z * wi.z)));
    float weight = (((view_4.wo.z + view_4.length_) * up) / max(((view_4.length_ * up) + (view_4.wo.z * stretched_1)), 1e-36));
    float m_5 = clamp((1.0 - (cosine * inversesqrt(length2_2))), 0.0, 1.0);
    float m2_ = (m_5 * m_5);
    return vec2(weight, ((m2_ * m2_) * m_5));
}

float normals_to_horizon(float tip, float near, float rate) {
    float root = sqrt(((rate * near) * max((tip - near), 0.0)));
    float rest = (near / max((near + root), 1e-36));
    float u = (1.0 - rest);
    float series_1 = (2.0 + (u * (-7.406265 + (u * (21.07087 + (u * (-31.448433 + (u * 16.743261))))))));
    return (((tip * rest) * rest) * (1.0 + (u * series_1)));
}

vec3 normals_centroid(vec3 flux, vec3 tip_1) {
    vec3 _e2 = normals_unit(flux);
    return ((dot(_e2, tip_1) < 0.0) ? -(_e2) : _e2);
}

vec3 normals_sample(NormalsView view_5, vec3 c_1) {
    vec2 _e2 = normals_weight(view_5, c_1);
    float seen_1 = max(dot(c_1, view_5.stretched), 0.0);
    return vec3(seen_1, (seen_1 * _e2.x), ((seen_1 * _e2.x) * _e2.y));
}

NormalsSpoke normals_spoke(NormalsView view_6, vec3 tip_2, vec3 c_2, bool is_fine) {
    vec3 _e4 = normals_arc_bend(tip_2, c_2);
    vec3 _e8 = normals_sample(view_6, c_2);
    return NormalsSpoke(c_2, _e4, ((is_fine ? 0.04 : 0.08) * _e8));
}

vec3 normals_flux(vec3 tip_3, NormalsSpoke a_4, NormalsSpoke b_4, vec3 curved) {
    return ((cross((a_4.c - tip_3), (b_4.c - tip_3)) + curved) + (a_4.bend - b_4.bend));
}

vec2 normals_triangle(NormalsView view_7, vec3 tip_4, vec3 m, vec3 corners, bool is_fine_1) {
    vec3 _e9 = normals_sample(view_7, (m + (0.5 * (m - tip_4))));
    vec3 _e10 = normals_sample(view_7, m);
    vec3 mean_2 = ((_e10 + ((is_fine_1 ? 0.2 : 0.3) * _e9)) + corners);
    return (mean_2.yz / vec2(max(mean_2.x, 1e-18)));
}

float normals_rise(NormalsView view_8, vec3 c_3) {
    vec3 h_2 = vec3((view_8.alpha * c_3.xy), c_3.z);
    return (((2.0 * dot(view_8.wo, h_2)) * h_2.z) - (dot(h_2, h_2) * view_8.wo.z));
}

NormalsSum normals_add(NormalsView view_9, NormalsSum sum, float least_rise, vec3 m_1, float whole, vec2 mean) {
    float _e6 = normals_rise(view_9, m_1);
    float known = clamp((_e6 / least_rise), 0.0, 1.0);
    vec3 part_1 = ((known * whole) * vec3(1.0, mean));
    return NormalsSum((sum.all_ + part_1), (sum.positive + ((part_1.x > 0.0) ? part_1 : vec3(0.0))), ((sum.unknown + whole) - part_1.x));
}

vec2 normals_total(NormalsSum sum_1, float seen, vec2 at_tip) {
    float share_1 = clamp((((sum_1.positive.x + sum_1.unknown) - seen) / max(seen, 1e-18)), 0.0, 0.5);
    float tip_6 = (1e-6 * max(seen, 1e-18));
    float per_part = (((share_1 * sum_1.unknown) + ((1.0 - share_1) * seen)) / (sum_1.positive.x + tip_6));
    return ((share_1 * sum_1.all_.yz) + (per_part * (sum_1.positive.yz + ((tip_6 * at_tip.x) * vec2(1.0, at_tip.y)))));
}

vec2 normals_horizon_triangle(NormalsView view_10, vec3 tip_5, vec2 at_tip_1, vec3 m_2, bool is_fine_2) {
    vec2 _e9 = normals_weight(view_10, (m_2 + (0.3 * (m_2 - tip_5))));
    float _e15 = normals_to_horizon(at_tip_1.x, _e9.x, (is_fine_2 ? 0.145 : 0.155));
    return (_e15 * vec2(1.0, mix(_e9.y, at_tip_1.y, 0.25)));
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

vec3 normals_crossing(vec3 a_5, vec3 b_5) {
    return vec3(((a_5.xy * abs(b_5.z)) + (b_5.xy * abs(a_5.z))), 0.0);
}

NormalsOutline normals_outline(inout vec3 vertices_1[8], uint number) {
    NormalsOutline outline = NormalsOutline(0u, 0u, false, 0u, 0.0, false);
    bool before = false;
    float above = 0.0;
    float below = 0.0;
    uint i_2 = 0u;
    bool local_9 = false;
    outline = NormalsOutline(number, 0u, false, 0u, 0.0, (number > 4u));
    bool _e13 = outline.many;
    vec3 _e14 = normals_get(vertices_1, (number - 1u), _e13);
    before = (_e14.z > 0.0);
    bool loop_init = true;
    while(true) {
        if (!loop_init) {
            uint _e56 = i_2;
            i_2 = (_e56 + 1u);
        }
        loop_init = false;
        uint _e25 = i_2;
        if ((_e25 < number)) {
        } else {
            break;
        }
        {
            uint _e27 = i_2;
            bool _e29 = outline.many;
            vec3 _e30 = normals_get(vertices_1, _e27, _e29);
            float z_4 = _e30.z;
            bool is_up = (z_4 > 0.0);
            float _e34 = above;
            above = max(_e34, z_4);
            float _e36 = below;
            below = max(_e36, -(z_4));
            if (is_up) {
                bool _e41 = before;
                local_9 = !(_e41);
            } else {
                local_9 = false;
            }
            bool _e44 = local_9;
            if (_e44) {
                uint _e46 = i_2;
                outline.start = _e46;
                outline.is_cut = true;
            }
            uint _e50 = outline.ups;
            outline.ups = (_e50 + (is_up ? 1u : 0u));
            before = is_up;
        }
    }
    float _e59 = below;
    float _e62 = above;
    outline.share = min(((8.0 * _e59) / max(_e62, 1e-36)), 1.0);
    NormalsOutline _e68 = outline;
    return _e68;
}

NormalsCorner normals_outline_corner(NormalsView view_11, NormalsOutline outline_1, inout vec3 vertices_2[8], uint i_3) {
    bool local_10 = false;
    bool local_11 = false;
    bool local_12 = false;
    if (outline_1.is_cut) {
        if (!((i_3 == 0u))) {
            local_11 = (i_3 == (outline_1.ups + 1u));
        } else {
            local_11 = true;
        }
        bool _e17 = local_11;
        local_10 = _e17;
    } else {
        local_10 = false;
    }
    bool is_crossing = local_10;
    if (outline_1.is_cut) {
        local_12 = (i_3 > 0u);
    } else {
        local_12 = false;
    }
    bool _e30 = local_12;
    uint at = ((outline_1.start + i_3) - (_e30 ? 1u : 0u));
    uint before_2 = ((at == 0u) ? (outline_1.number - 1u) : (at - 1u));
    vec3 _e47 = normals_get(vertices_2, ((at >= outline_1.number) ? (at - outline_1.number) : at), outline_1.many);
    vec3 _e54 = normals_get(vertices_2, ((before_2 >= outline_1.number) ? (before_2 - outline_1.number) : before_2), outline_1.many);
    vec3 _e55 = normals_crossing(_e54, _e47);
    NormalsCorner _e57 = normals_corner((is_crossing ? _e55 : _e47), view_11);
    return _e57;
}

NormalsHorizon normals_horizon(NormalsView view_12, NormalsCorner begin, NormalsCorner end) {
    vec3 sum_4 = (begin.w + end.w);
    float _e6 = normals_half_cosine(begin, end);
    vec3 _e13 = normals_unstretched(((view_12.wo * _e6) + (sum_4 * (0.5 / _e6))), view_12);
    float turn_1 = cross(begin.w, (end.w - begin.w)).z;
    vec3 across_3 = vec3(0.0, 0.0, ((turn_1 < 0.0) ? -1.0 : 1.0));
    return NormalsHorizon(begin.c, (_e13 * inversesqrt((begin.length_ * end.length_))), end.c, across_3);
}

vec3 normals_on_horizon(NormalsHorizon horizon, float t_1) {
    float u_1 = (1.0 - t_1);
    vec3 _e17 = normals_unit((((horizon.begin * (u_1 * u_1)) + (horizon.control * ((2.0 * u_1) * t_1))) + (horizon.end * (t_1 * t_1))));
    return ((t_1 >= 1.0) ? horizon.end : _e17);
}

vec2 normals_polygon(NormalsView view_13, inout vec3 vertices_3[8], uint count, bool two_sided, uint rule) {
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
    uint edge = 0u;
    bool is_second = false;
    uint step_ = 0u;
    bool local_13 = false;
    bool local_14 = false;
    NormalsCorner to = NormalsCorner(vec3(0.0), vec3(0.0), 0.0);
    bool local_15 = false;
    bool local_16 = false;
    bool local_17 = false;
    bool local_18 = false;
    bool local_19 = false;
    bool local_20 = false;
    vec2 parts = vec2(0.0);
    NormalsSum sum_2 = NormalsSum(vec3(0.0), vec3(0.0), 0.0);
    NormalsSpoke before_1 = NormalsSpoke(vec3(0.0), vec3(0.0), vec3(0.0));
    NormalsSpoke setting = NormalsSpoke(vec3(0.0), vec3(0.0), vec3(0.0));
    uint i_4 = 0u;
    uint part = 1u;
    NormalsOutline _e8 = normals_outline(vertices_3, min(max(count, 3u), 8u));
    if ((_e8.ups == 0u)) {
        return vec2(0.0);
    }
    bool many_2 = _e8.many;
    bool is_fine_3 = (rule == NORMALS_FINE);
    uint edge_parts = (is_fine_3 ? 2u : 1u);
    uint horizon_parts = ((rule == NORMALS_MEAN) ? 1u : (is_fine_3 ? 8u : 4u));
    uint edges = (_e8.is_cut ? (_e8.ups + 1u) : _e8.number);
    uint closing_parts = (_e8.is_cut ? horizon_parts : 0u);
    NormalsCorner _e37 = normals_outline_corner(view_13, _e8, vertices_3, 0u);
    NormalsCorner _e41 = normals_outline_corner(view_13, _e8, vertices_3, (_e8.ups + 1u));
    NormalsHorizon _e42 = normals_horizon(view_13, _e41, _e37);
    arc_start = _e37.c;
    last = _e37;
    bool loop_init_1 = true;
    while(true) {
        if (!loop_init_1) {
            uint _e222 = step_;
            step_ = (_e222 + 1u);
        }
        loop_init_1 = false;
        uint _e69 = step_;
        if ((_e69 < ((edges * edge_parts) + closing_parts))) {
        } else {
            break;
        }
        {
            uint _e73 = edge;
            bool is_closing = (_e73 >= edges);
            if (is_fine_3) {
                bool _e77 = is_second;
                local_13 = !(_e77);
            } else {
                local_13 = false;
            }
            bool _e80 = local_13;
            if (_e80) {
                local_14 = !(is_closing);
            } else {
                local_14 = false;
            }
            bool is_half = local_14;
            uint _e86 = edge;
            NormalsCorner _e89 = normals_outline_corner(view_13, _e8, vertices_3, (_e86 + 1u));
            to = _e89;
            if (is_half) {
                NormalsCorner _e91 = last;
                NormalsCorner _e92 = to;
                NormalsCorner _e94 = normals_between(_e91, _e92, 0.5, view_13);
                to = _e94;
            }
            uint _e95 = edge;
            float t_3 = (float(((_e95 + 1u) - edges)) / float(horizon_parts));
            vec3 _e103 = to.c;
            vec3 _e104 = normals_on_horizon(_e42, t_3);
            vec3 c_5 = (is_closing ? _e104 : _e103);
            vec3 _e107 = to.w;
            vec3 _e109 = last.w;
            vec3 apart = (_e107 - _e109);
            vec3 _e112 = last.w;
            vec3 across_4 = (is_closing ? _e42.across : cross(_e112, apart));
            vec3 _e117 = last.c;
            if (!(is_closing)) {
                vec3 _e122 = last.w;
                vec3 _e124 = to.w;
                local_15 = (dot(_e122, _e124) < 0.9);
            } else {
                local_15 = true;
            }
            bool _e129 = local_15;
            vec3 _e130 = normals_exact(view_13, _e117, c_5, across_4, _e129);
            if (!(is_closing)) {
                local_16 = (dot(apart, apart) >= 1e-14);
            } else {
                local_16 = true;
            }
            bool is_edge = local_16;
            vec3 _e140 = last.c;
            vec3 curved_1 = (is_edge ? (_e130 - cross(_e140, c_5)) : vec3(0.0));
            vec3 _e146 = flux_1;
            vec3 _e148 = last.c;
            flux_1 = (_e146 + (curved_1 + cross((_e148 - _e37.c), (c_5 - _e37.c))));
            if (is_fine_3) {
                uint _e157 = edge;
                normals_put(half_ends, (is_half ? _e157 : 8u), c_5, many_2);
                uint _e160 = edge;
                normals_put(half_curves, (is_half ? _e160 : 8u), curved_1, many_2);
            }
            uint _e162 = edge;
            if (!(is_half)) {
                local_17 = is_closing;
            } else {
                local_17 = true;
            }
            bool _e168 = local_17;
            normals_put(ends, (_e168 ? 8u : _e162), c_5, many_2);
            uint _e170 = edge;
            if (!(is_half)) {
                local_18 = is_closing;
            } else {
                local_18 = true;
            }
            bool _e176 = local_18;
            normals_put(curves, (_e176 ? 8u : _e170), curved_1, many_2);
            uint _e179 = edge;
            normals_put(horizon_curves, (is_closing ? (_e179 - edges) : 8u), curved_1, is_fine_3);
            vec3 _e182 = arc_start;
            arc_start = (is_closing ? _e182 : c_5);
            vec3 _e184 = closing;
            vec3 _e186 = last.c;
            vec3 _e187 = arc_start;
            vec3 _e189 = arc_start;
            closing = (_e184 + (is_closing ? (curved_1 + cross((_e186 - _e187), (c_5 - _e189))) : vec3(0.0)));
            if (is_fine_3) {
                uint _e199 = edge;
                local_19 = ((_e199 + 1u) == (edges + (horizon_parts / 2u)));
            } else {
                local_19 = false;
            }
            bool _e207 = local_19;
            if (_e207) {
                vec3 _e208 = closing;
                half_closing = _e208;
                half_end = c_5;
                closing = vec3(0.0);
                arc_start = c_5;
            }
            vec3 _e212 = to.w;
            float _e214 = to.length_;
            last = NormalsCorner(_e212, c_5, _e214);
            uint _e216 = edge;
            edge = (_e216 + (is_half ? 0u : 1u));
            is_second = is_half;
        }
    }
    vec3 _e224 = flux_1;
    float seen_2 = dot(_e224, view_13.stretched);
    float side = ((seen_2 < 0.0) ? -1.0 : 1.0);
    if ((side < 0.0)) {
        local_20 = !(two_sided);
    } else {
        local_20 = false;
    }
    bool _e238 = local_20;
    if (_e238) {
        return vec2(0.0);
    }
    float to_part = ((side * 0.3183099) / (view_13.wo.z + view_13.length_));
    vec3 _e248 = flux_1;
    vec3 _e250 = normals_unit((_e248 * side));
    vec2 _e251 = normals_weight(view_13, _e250);
    parts = (vec2(_e251.x, (_e251.x * _e251.y)) * seen_2);
    if ((rule != NORMALS_MEAN)) {
        float _e268 = normals_rise(view_13, _e250);
        float least_rise_1 = max((0.125 * _e268), 1e-36);
        vec3 sided = (side * view_13.stretched);
        vec3 _e278 = normals_sample(view_13, _e250);
        vec3 tip_share = ((is_fine_3 ? 0.1 : 0.2) * _e278);
        NormalsSpoke _e281 = normals_spoke(view_13, _e250, _e37.c, is_fine_3);
        before_1 = _e281;
        setting = _e281;
        bool loop_init_2 = true;
        while(true) {
            if (!loop_init_2) {
                uint _e346 = i_4;
                i_4 = (_e346 + 1u);
            }
            loop_init_2 = false;
            uint _e286 = i_4;
            if ((_e286 < (edges + (_e8.is_cut ? 1u : 0u)))) {
            } else {
                break;
            }
            {
                uint _e293 = i_4;
                bool is_closing_1 = (_e293 == edges);
                if (is_closing_1) {
                    NormalsSpoke _e295 = before_1;
                    setting = _e295;
                }
                float counts = (is_closing_1 ? (1.0 - _e8.share) : 1.0);
                if (is_fine_3) {
                    uint _e301 = i_4;
                    vec3 _e302 = normals_get(half_ends, _e301, many_2);
                    vec3 _e303 = half_end;
                    vec3 half_c = (is_closing_1 ? _e303 : _e302);
                    uint _e305 = i_4;
                    vec3 _e306 = normals_get(half_curves, _e305, many_2);
                    vec3 _e307 = half_closing;
                    vec3 half_curved = (is_closing_1 ? _e307 : _e306);
                    NormalsSpoke _e309 = normals_spoke(view_13, _e250, half_c, is_fine_3);
                    NormalsSpoke _e310 = before_1;
                    vec3 _e311 = normals_flux(_e250, _e310, _e309, half_curved);
                    vec3 _e312 = normals_centroid(_e311, _e250);
                    vec3 _e314 = before_1.at_end;
                    vec2 _e318 = normals_triangle(view_13, _e250, _e312, ((tip_share + _e314) + _e309.at_end), is_fine_3);
                    NormalsSum _e319 = sum_2;
                    NormalsSum _e322 = normals_add(view_13, _e319, least_rise_1, _e312, (counts * dot(_e311, sided)), _e318);
                    sum_2 = _e322;
                    before_1 = _e309;
                }
                uint _e323 = i_4;
                vec3 _e324 = normals_get(ends, _e323, many_2);
                vec3 c_6 = (is_closing_1 ? _e37.c : _e324);
                uint _e327 = i_4;
                vec3 _e328 = normals_get(curves, _e327, many_2);
                vec3 _e329 = closing;
                vec3 curved_2 = (is_closing_1 ? _e329 : _e328);
                NormalsSpoke _e331 = normals_spoke(view_13, _e250, c_6, is_fine_3);
                NormalsSpoke _e332 = before_1;
                vec3 _e333 = normals_flux(_e250, _e332, _e331, curved_2);
                vec3 _e334 = normals_centroid(_e333, _e250);
                vec3 _e336 = before_1.at_end;
                vec2 _e340 = normals_triangle(view_13, _e250, _e334, ((tip_share + _e336) + _e331.at_end), is_fine_3);
                NormalsSum _e341 = sum_2;
                NormalsSum _e344 = normals_add(view_13, _e341, least_rise_1, _e334, (counts * dot(_e333, sided)), _e340);
                sum_2 = _e344;
                before_1 = _e331;
            }
        }
        NormalsSpoke _e348 = setting;
        before_1 = _e348;
        bool loop_init_3 = true;
        while(true) {
            if (!loop_init_3) {
                uint _e376 = part;
                part = (_e376 + 1u);
            }
            loop_init_3 = false;
            uint _e351 = part;
            if ((_e351 <= closing_parts)) {
            } else {
                break;
            }
            {
                uint _e353 = part;
                vec3 _e357 = normals_on_horizon(_e42, (float(_e353) / float(horizon_parts)));
                vec3 _e358 = normals_arc_bend(_e250, _e357);
                NormalsSpoke to_1 = NormalsSpoke(_e357, _e358, vec3(0.0));
                NormalsSpoke _e362 = before_1;
                uint _e363 = part;
                vec3 _e366 = normals_get(horizon_curves, (_e363 - 1u), is_fine_3);
                vec3 _e367 = normals_flux(_e250, _e362, to_1, _e366);
                vec3 _e368 = normals_centroid(_e367, _e250);
                vec2 _e369 = normals_horizon_triangle(view_13, _e250, _e251, _e368, is_fine_3);
                NormalsSum _e370 = sum_2;
                NormalsSum _e374 = normals_add(view_13, _e370, least_rise_1, _e368, (_e8.share * dot(_e367, sided)), _e369);
                sum_2 = _e374;
                before_1 = to_1;
            }
        }
        NormalsSum _e378 = sum_2;
        vec2 _e380 = normals_total(_e378, (seen_2 * side), _e251);
        parts = (_e380 * side);
    }
    float _e383 = parts.x;
    float energy = clamp((_e383 * to_part), 0.0, clamp((seen_2 * to_part), 0.0, 1.0));
    float _e392 = parts.y;
    return vec2(energy, clamp((_e392 * to_part), 0.0, energy));
}

vec2 normals_rectangle(NormalsView view_14, vec3 corners_1[4], bool two_sided_1, uint rule_1) {
    vec3 vertices_4[8] = vec3[8](vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0));
    vertices_4[0] = corners_1[0];
    vertices_4[1] = corners_1[1];
    vertices_4[2] = corners_1[2];
    vertices_4[3] = corners_1[3];
    vec2 _e14 = normals_polygon(view_14, vertices_4, 4u, two_sided_1, rule_1);
    return _e14;
}

vec2 normals_disk(NormalsView view_15, vec3 centre, vec3 half_x, vec3 half_y, bool two_sided_2, uint rule_2) {
    vec3 vertices_5[8] = vec3[8](vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0));
    uint i_5 = 0u;
    bool loop_init_4 = true;
    while(true) {
        if (!loop_init_4) {
            uint _e30 = i_5;
            i_5 = (_e30 + 1u);
        }
        loop_init_4 = false;
        uint _e9 = i_5;
        if ((_e9 < 8u)) {
        } else {
            break;
        }
        {
            uint _e12 = i_5;
            vec2 _e18 = normals_ltc_sin_cos(((0.5 - float(_e12)) * 0.125));
            vec2 turn_2 = (_e18 * 1.0539074);
            uint _e21 = i_5;
            vertices_5[_e21] = ((centre + (half_x * turn_2.y)) + (half_y * turn_2.x));
        }
    }
    vec2 _e33 = normals_polygon(view_15, vertices_5, 8u, two_sided_2, rule_2);
    return _e33;
}
