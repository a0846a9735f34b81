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
//   rule  how the weight of shadowing is averaged: 0 over seven normals of each triangle; 1 at the mean normal, which is
//       cheaper; 2 over twice as many triangles.
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
//     parts 0.700191 0.000228 | 0.710371 0.000052 | 0.701970 0.000247
//   alpha_x 0.2 alpha_y 0.6 wo (-0.64 0.48 0.6)
//     parts 0.551031 0.001375 | 0.599484 0.000332 | 0.551419 0.001477
//   alpha_x 0.05 alpha_y 0.02 wo (0.576 -0.768 0.28)
//     parts 0.985693 0.188876 | 0.991922 0.187098 | 0.982803 0.185731


precision highp float;
precision highp int;

struct NormalsView {
    vec2 alpha;
    vec3 wo;
    vec3 stretched;
    float length_;
};
struct NormalsCorner {
    vec3 w;
    vec3 c;
    float length_;
};
struct NormalsOutline {
    uint count;
    NormalsCorner first;
    NormalsCorner last;
    vec3 flux;
    vec3 c[20];
    vec3 curved[20];
};
struct NormalsEigenframe {
    vec3 values;
    mat3x3 vectors;
};
const uint NORMALS_SEVEN = 0u;
const uint NORMALS_MEAN = 1u;
const uint NORMALS_FINE = 2u;
const uint NORMALS_EDGES = 20u;


float ltc_atan2_(float y, float x) {
    float low = min(y, abs(x));
    float high = max(y, abs(x));
    bool is_far = (low > (0.41421357 * high));
    float t_1 = ((is_far ? (low - high) : low) / max((is_far ? (low + high) : high), 1e-37));
    float z = (t_1 * t_1);
    float near = (((((((((0.08053744 * z) - 0.13877685) * z) + 0.1997771) * z) - 0.3333295) * z) * t_1) + t_1);
    float eighth = (is_far ? (near + 0.7853982) : near);
    float quarter = ((y > abs(x)) ? (1.5707964 - eighth) : eighth);
    return ((x < 0.0) ? (3.1415927 - quarter) : quarter);
}

vec2 ltc_sin_cos(float turns) {
    bool local = false;
    float quarter_1 = floor(((4.0 * turns) + 0.5));
    float x_3 = ((turns - (0.25 * quarter_1)) * 6.2831855);
    float z_1 = (x_3 * x_3);
    float s = (((((((-0.00019515296 * z_1) + 0.008332161) * z_1) - 0.16666655) * z_1) * x_3) + x_3);
    float c_2 = ((((((((2.4433157e-5 * z_1) - 0.0013887316) * z_1) + 0.041666646) * z_1) * z_1) - (0.5 * z_1)) + 1.0);
    uint q = (uint(int(quarter_1)) & 3u);
    vec2 swapped = (((q & 1u) == 1u) ? vec2(c_2, s) : vec2(s, c_2));
    if (!((q == 1u))) {
        local = (q == 2u);
    } else {
        local = true;
    }
    bool _e64 = local;
    return vec2(((q >= 2u) ? -(swapped.x) : swapped.x), (_e64 ? -(swapped.y) : swapped.y));
}

float ltc_log(float x_1) {
    int bits = (floatBitsToInt(x_1) - 1060439283);
    float m = intBitsToFloat(((bits & 8388607) + 1060439283));
    float s_1 = ((m - 1.0) / (m + 1.0));
    float z_2 = (s_1 * s_1);
    float series = (((((((((0.22222222 * z_2) + 0.2857143) * z_2) + 0.4) * z_2) + 0.6666667) * z_2) * s_1) + (2.0 * s_1));
    return ((float((bits >> 23u)) * 0.6931472) + series);
}

NormalsView normals_view(float alpha_x, float alpha_y, vec3 wo) {
    vec2 alpha_1 = max(vec2(alpha_x, alpha_y), vec2(1e-5));
    vec3 stretched = vec3((alpha_1 * wo.xy), wo.z);
    return NormalsView(alpha_1, wo, stretched, sqrt(dot(stretched, stretched)));
}

vec3 normals_unstretched(vec3 h, vec2 alpha) {
    return vec3((h.xy / alpha), h.z);
}

vec3 normals_unit(vec3 v) {
    float length2_ = dot(v, v);
    return ((length2_ > 1e-36) ? (v / vec3(sqrt(max(length2_, 1e-36)))) : vec3(0.0));
}

NormalsCorner normals_corner(vec3 v_1, NormalsView view) {
    vec3 _e2 = normals_unit(v_1);
    vec3 _e6 = normals_unstretched((view.wo + _e2), view.alpha);
    float length_ = max(sqrt(dot(_e6, _e6)), 1e-18);
    return NormalsCorner(_e2, (_e6 / vec3(length_)), length_);
}

float normals_half_cosine(NormalsCorner a, NormalsCorner b) {
    vec3 sum_1 = (a.w + b.w);
    return max((0.5 * sqrt(dot(sum_1, sum_1))), 1e-6);
}

NormalsCorner normals_between(NormalsCorner a_1, NormalsCorner b_1, float t, NormalsView view_1) {
    float x_4 = ((1.0 - t) * sqrt(b_1.length_));
    float y_2 = (t * sqrt(a_1.length_));
    float _e16 = normals_half_cosine(a_1, b_1);
    vec3 middle = ((a_1.w + b_1.w) * ((x_4 * y_2) / _e16));
    NormalsCorner _e27 = normals_corner((((a_1.w * (x_4 * x_4)) + middle) + (b_1.w * (y_2 * y_2))), view_1);
    return _e27;
}

vec3 normals_arc_bend(vec3 a_2, vec3 b_2) {
    vec3 across = cross(a_2, b_2);
    bool is_acute = (dot(a_2, b_2) >= 0.0);
    vec3 chord = (is_acute ? (a_2 - b_2) : (a_2 + b_2));
    float z_3 = (dot(chord, chord) * 0.25);
    float far = (z_3 * (2.271551 + (z_3 * (-3.4068606 + (z_3 * 3.516457)))));
    float bend = (z_3 * (0.6667554 + (z_3 * (0.52912635 + (z_3 * (0.52405584 + (z_3 * (-0.08954556 + far))))))));
    float obtuse = (((3.1415927 / sqrt(max(dot(across, across), 1e-18))) - bend) - 2.0);
    return (across * (is_acute ? bend : obtuse));
}

NormalsEigenframe normals_eigenframe(vec3 diagonal, vec3 off) {
    vec3 longest = vec3(0.0);
    mat3x3 m_1 = mat3x3(vec3(diagonal.x, off.x, off.y), vec3(off.x, diagonal.y, off.z), vec3(off.y, off.z, diagonal.z));
    float mean = (((diagonal.x + diagonal.y) + diagonal.z) / 3.0);
    vec3 d = (diagonal - vec3(mean));
    float p2_ = max(((dot(d, d) + (2.0 * dot(off, off))) / 6.0), 1e-30);
    float p = sqrt(p2_);
    float determinant_ = (((d.x * ((d.y * d.z) - (off.z * off.z))) - (off.x * ((off.x * d.z) - (off.z * off.y)))) + (off.y * ((off.x * off.z) - (d.y * off.y))));
    float angle = (determinant_ / ((2.0 * p) * p2_));
    float x_5 = min(abs(angle), 1.0);
    float near_1 = (0.8660254 + (x_5 * (0.1666667 + (x_5 * (-0.0425207 + (0.0098286 * x_5))))));
    float g = (((((8.0 * near_1) * near_1) * near_1) + x_5) / (((12.0 * near_1) * near_1) - 3.0));
    bool is_largest = !((angle < 0.0));
    float rough = (mean + (((is_largest ? 2.0 : -2.0) * p) * g));
    vec3 row0_ = vec3((diagonal.x - rough), off.x, off.y);
    vec3 row1_ = vec3(off.x, (diagonal.y - rough), off.z);
    vec3 row2_ = vec3(off.y, off.z, (diagonal.z - rough));
    longest = cross(row0_, row1_);
    vec3 second = cross(row0_, row2_);
    vec3 third = cross(row1_, row2_);
    vec3 _e119 = longest;
    vec3 _e121 = longest;
    vec3 _e122 = longest;
    longest = ((dot(second, second) > dot(_e121, _e122)) ? second : _e119);
    vec3 _e126 = longest;
    vec3 _e128 = longest;
    vec3 _e129 = longest;
    longest = ((dot(third, third) > dot(_e128, _e129)) ? third : _e126);
    vec3 _e133 = longest;
    vec3 _e134 = longest;
    vec3 _e135 = longest;
    vec3 isolated = (_e133 / vec3(sqrt(max(dot(_e134, _e135), 1e-36))));
    float value = dot(isolated, (m_1 * isolated));
    float s_2 = ((isolated.z < 0.0) ? -1.0 : 1.0);
    float q_1 = (-1.0 / (s_2 + isolated.z));
    float r = ((isolated.x * isolated.y) * q_1);
    vec3 e = vec3((1.0 + (((s_2 * isolated.x) * isolated.x) * q_1)), (s_2 * r), (-(s_2) * isolated.x));
    vec3 f = vec3(r, (s_2 + ((isolated.y * isolated.y) * q_1)), -(isolated.y));
    vec3 image_e = (m_1 * e);
    vec3 image_f = (m_1 * f);
    float ee = dot(e, image_e);
    float ef = dot(e, image_f);
    float ff = dot(f, image_f);
    float middle_1 = (0.5 * (ee + ff));
    float lean = (0.5 * (ee - ff));
    float radius = sqrt(((lean * lean) + (ef * ef)));
    float doubled = ((radius > 1e-30) ? (lean / max(radius, 1e-30)) : 1.0);
    float larger = sqrt((0.5 + (0.5 * abs(doubled))));
    float smaller = ((0.5 * ef) / (max(radius, 1e-30) * larger));
    float flip = ((ef < 0.0) ? -1.0 : 1.0);
    vec2 turn = ((doubled >= 0.0) ? vec2(larger, smaller) : vec2((flip * smaller), (flip * larger)));
    vec3 upper = ((e * turn.x) + (f * turn.y));
    vec3 lower = ((f * turn.x) - (e * turn.y));
    vec3 one = (is_largest ? isolated : upper);
    vec3 two = (is_largest ? upper : lower);
    vec3 values = (is_largest ? vec3(value, (middle_1 + radius), (middle_1 - radius)) : vec3((middle_1 + radius), (middle_1 - radius), value));
    return NormalsEigenframe(values, mat3x3(one, two, cross(one, two)));
}

float normals_atan2_(float y_1, float x_2) {
    float _e3 = ltc_atan2_(abs(y_1), x_2);
    return ((y_1 < 0.0) ? -(_e3) : _e3);
}

vec3 normals_exact(NormalsView view_2, NormalsCorner a_3, NormalsCorner b_3, vec3 apart) {
    bool local_1 = false;
    bool local_2 = false;
    bool local_3 = false;
    vec3 across_1 = cross(a_3.w, apart);
    float turns_1 = ((dot(view_2.wo, across_1) < 0.0) ? -1.0 : 1.0);
    vec3 n = (across_1 * turns_1);
    vec3 o = (view_2.wo * n);
    float ax = view_2.alpha.x;
    float ay = view_2.alpha.y;
    vec3 diagonal_1 = vec3(((ax * ax) * ((o.x - o.y) - o.z)), ((ay * ay) * ((o.y - o.x) - o.z)), ((o.z - o.x) - o.y));
    vec3 off_1 = vec3(((ax * ay) * ((view_2.wo.x * n.y) + (view_2.wo.y * n.x))), (ax * ((view_2.wo.x * n.z) + (view_2.wo.z * n.x))), (ay * ((view_2.wo.y * n.z) + (view_2.wo.z * n.y))));
    float per_norm = (1.0 / max(sqrt((dot(diagonal_1, diagonal_1) + (2.0 * dot(off_1, off_1)))), 1e-30));
    NormalsEigenframe _e84 = normals_eigenframe((diagonal_1 * per_norm), (off_1 * per_norm));
    float l1_ = max(_e84.values.x, 1e-12);
    float l2_ = min(_e84.values.y, 0.0);
    float l3_ = min(_e84.values.z, l2_);
    mat3x3 v_2 = transpose(_e84.vectors);
    vec3 p0_ = (v_2 * a_3.c);
    vec3 p1_ = (v_2 * b_3.c);
    vec3 normal = (v_2 * cross(a_3.c, b_3.c));
    float d2_ = (l1_ - l2_);
    float e2_ = (l1_ - l3_);
    float g2_ = (l2_ - l3_);
    float d_1 = sqrt(d2_);
    float e_1 = sqrt(e2_);
    float g_1 = sqrt(g2_);
    float sense = ((p0_.x < 0.0) ? -(turns_1) : turns_1);
    float _e129 = normals_atan2_(((d_1 * e_1) * normal.x), (((d2_ * p0_.y) * p1_.y) + ((e2_ * p0_.z) * p1_.z)));
    if (((_e129 * sense) < 0.0)) {
        if (!((abs(_e129) > 0.01))) {
            local_2 = (dot(a_3.w, b_3.w) < 0.9);
        } else {
            local_2 = true;
        }
        bool _e147 = local_2;
        local_1 = _e147;
    } else {
        local_1 = false;
    }
    bool is_wrapped = local_1;
    float psi = (is_wrapped ? (_e129 + (sense * 6.2831855)) : _e129);
    float along1_ = ((l1_ / (d_1 * e_1)) * psi);
    float slope = (normal.y / (((d2_ * p0_.x) * p1_.x) - ((g2_ * p0_.z) * p1_.z)));
    float q_2 = ((d_1 * g_1) * slope);
    float q2_ = (q_2 * q_2);
    float ratio = clamp(((1.0 + q_2) / (1.0 - q_2)), 1e-30, 1e30);
    float _e179 = ltc_log(ratio);
    float steep = ((0.5 * _e179) / max((d_1 * g_1), 1e-30));
    float along2_ = ((q2_ < 0.0025) ? (slope * (1.0 + (q2_ * (0.33333334 + (q2_ * 0.2))))) : steep);
    float bottom = (((e2_ * p0_.x) * p1_.x) + ((g2_ * p0_.y) * p1_.y));
    float top = ((e_1 * g_1) * normal.z);
    if ((bottom > 0.0)) {
        local_3 = (abs(top) < (0.03 * bottom));
    } else {
        local_3 = false;
    }
    bool is_small = local_3;
    float share = (is_small ? (top / bottom) : 0.0);
    float r2_ = (share * share);
    float _e223 = normals_atan2_(top, bottom);
    float wide = (_e223 / max((e_1 * g_1), 1e-30));
    float along3_ = (is_small ? ((normal.z / bottom) * (1.0 - (r2_ * (0.33333334 - (r2_ * 0.2))))) : wide);
    return (_e84.vectors * vec3(along1_, (-(l2_) * along2_), (-(l3_) * along3_)));
}

vec3 normals_curved_part(NormalsView view_3, NormalsCorner a_4, NormalsCorner b_4) {
    vec3 apart_1 = (b_4.w - a_4.w);
    vec3 _e6 = normals_exact(view_3, a_4, b_4, apart_1);
    return ((dot(apart_1, apart_1) >= 1e-14) ? (_e6 - cross(a_4.c, b_4.c)) : vec3(0.0));
}

void normals_edge(inout NormalsOutline outline, NormalsView view_4, NormalsCorner to) {
    vec3 origin = outline.first.c;
    NormalsCorner last = outline.last;
    vec3 _e8 = normals_curved_part(view_4, last, to);
    vec3 _e10 = outline.flux;
    outline.flux = (_e10 + (_e8 + cross((last.c - origin), (to.c - origin))));
    uint _e20 = outline.count;
    outline.c[_e20] = last.c;
    uint _e25 = outline.count;
    outline.curved[_e25] = _e8;
    uint _e28 = outline.count;
    outline.count = (_e28 + 1u);
    outline.last = to;
    return;
}

vec3 normals_crossing(vec3 a_5, vec3 b_5) {
    return vec3(((a_5.xy * abs(b_5.z)) + (b_5.xy * abs(a_5.z))), 0.0);
}

vec3 normals_weight(NormalsView view_5, vec3 c) {
    vec3 h_1 = vec3((view_5.alpha * c.xy), c.z);
    float length2_1 = max(dot(h_1, h_1), 1e-36);
    float cosine = dot(view_5.wo, h_1);
    vec3 wi = ((h_1 * (2.0 * cosine)) - (view_5.wo * length2_1));
    float up = max(wi.z, 0.0);
    vec2 across_2 = (view_5.alpha * wi.xy);
    float stretched_1 = sqrt((dot(across_2, across_2) + (wi.z * wi.z)));
    float weight = (((view_5.wo.z + view_5.length_) * up) / max(((view_5.length_ * up) + (view_5.wo.z * stretched_1)), 1e-36));
    float m_2 = clamp((1.0 - (cosine / sqrt(length2_1))), 0.0, 1.0);
    float m2_ = (m_2 * m_2);
    float seen = max((dot(c, view_5.stretched) / max(sqrt(dot(c, c)), 1e-18)), 0.0);
    return vec3(weight, (weight * ((m2_ * m2_) * m_2)), seen);
}

vec3 normals_sample(NormalsView view_6, vec3 c_1) {
    vec3 _e2 = normals_weight(view_6, c_1);
    return vec3(_e2.z, (_e2.z * _e2.xy));
}

vec2 normals_fan(NormalsView view_7, inout NormalsOutline outline_1, vec3 tip) {
    vec3 from_c = vec3(0.0);
    vec3 from_sample = vec3(0.0);
    vec3 from_bend = vec3(0.0);
    vec2 sum = vec2(0.0);
    uint i = 0u;
    vec3 _e3 = normals_sample(view_7, tip);
    vec3 _e6 = outline_1.c[0];
    from_c = _e6;
    vec3 _e8 = from_c;
    vec3 _e9 = normals_sample(view_7, _e8);
    from_sample = _e9;
    vec3 _e11 = from_c;
    vec3 _e12 = normals_arc_bend(tip, _e11);
    from_bend = _e12;
    bool loop_init = true;
    while(true) {
        if (!loop_init) {
            uint _e102 = i;
            i = (_e102 + 1u);
        }
        loop_init = false;
        uint _e19 = i;
        uint _e21 = outline_1.count;
        if ((_e19 < _e21)) {
        } else {
            break;
        }
        {
            uint _e23 = i;
            uint _e27 = i;
            uint _e31 = outline_1.count;
            uint next = (((_e27 + 1u) == _e31) ? 0u : (_e23 + 1u));
            vec3 to_c = outline_1.c[next];
            vec3 _e37 = normals_sample(view_7, to_c);
            vec3 _e38 = normals_arc_bend(tip, to_c);
            vec3 _e39 = from_c;
            uint _e44 = i;
            vec3 _e46 = outline_1.curved[_e44];
            vec3 _e48 = from_bend;
            vec3 flux = ((cross((_e39 - tip), (to_c - tip)) + _e46) + (_e48 - _e38));
            vec3 _e51 = normals_unit(flux);
            vec3 m_3 = ((dot(_e51, tip) < 0.0) ? -(_e51) : _e51);
            vec3 _e62 = normals_sample(view_7, ((1.5 * m_3) - (0.5 * tip)));
            vec3 _e65 = from_c;
            vec3 _e69 = normals_sample(view_7, ((1.5 * m_3) - (0.5 * _e65)));
            vec3 _e76 = normals_sample(view_7, ((1.5 * m_3) - (0.5 * to_c)));
            vec3 middles = ((_e62 + _e69) + _e76);
            vec3 _e78 = normals_sample(view_7, m_3);
            vec3 _e81 = from_sample;
            vec3 mean_1 = (((0.28 * _e78) + (0.04 * ((_e3 + _e81) + _e37))) + (0.2 * middles));
            if ((mean_1.x > 1e-18)) {
                vec2 _e93 = sum;
                sum = (_e93 + (mean_1.yz * (dot(flux, view_7.stretched) / mean_1.x)));
            }
            from_c = to_c;
            from_sample = _e37;
            from_bend = _e38;
        }
    }
    vec2 _e104 = sum;
    return _e104;
}

vec2 normals_polygon(NormalsView view_8, inout vec3 vertices_1[8], uint count, bool two_sided, uint rule) {
    uint start = 0u;
    bool is_cut = false;
    uint ups = 0u;
    bool before = false;
    uint i_1 = 0u;
    bool local_4 = false;
    NormalsOutline outline_2 = NormalsOutline(0u, NormalsCorner(vec3(0.0), vec3(0.0), 0.0), NormalsCorner(vec3(0.0), vec3(0.0), 0.0), vec3(0.0), vec3[20](vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0)), vec3[20](vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0)));
    vec3 corner = vec3(0.0);
    NormalsCorner from_corner = NormalsCorner(vec3(0.0), vec3(0.0), 0.0);
    NormalsCorner to_corner = NormalsCorner(vec3(0.0), vec3(0.0), 0.0);
    uint part = 0u;
    uint step_ = 0u;
    vec3 vertex = vec3(0.0);
    bool local_5 = false;
    NormalsCorner to_1 = NormalsCorner(vec3(0.0), vec3(0.0), 0.0);
    bool local_6 = false;
    vec2 parts = vec2(0.0);
    uint number = min(max(count, 3u), 8u);
    uint edge_parts = ((rule == NORMALS_FINE) ? 2u : 1u);
    uint horizon_parts = ((rule == NORMALS_MEAN) ? 1u : ((rule == NORMALS_FINE) ? 4u : 2u));
    float _e32 = vertices_1[(number - 1u)].z;
    before = (_e32 > 0.0);
    bool loop_init_1 = true;
    while(true) {
        if (!loop_init_1) {
            uint _e60 = i_1;
            i_1 = (_e60 + 1u);
        }
        loop_init_1 = false;
        uint _e38 = i_1;
        if ((_e38 < number)) {
        } else {
            break;
        }
        {
            uint _e40 = i_1;
            float _e43 = vertices_1[_e40].z;
            bool is_up = (_e43 > 0.0);
            if (is_up) {
                bool _e48 = before;
                local_4 = !(_e48);
            } else {
                local_4 = false;
            }
            bool _e51 = local_4;
            if (_e51) {
                uint _e52 = i_1;
                start = _e52;
                is_cut = true;
            }
            uint _e54 = ups;
            ups = (_e54 + (is_up ? 1u : 0u));
            before = is_up;
        }
    }
    uint _e62 = ups;
    if ((_e62 == 0u)) {
        return vec2(0.0);
    }
    uint _e68 = start;
    vec3 _e70 = vertices_1[_e68];
    corner = _e70;
    bool _e72 = is_cut;
    if (_e72) {
        uint _e73 = start;
        vec3 _e79 = vertices_1[(((_e73 + number) - 1u) % number)];
        vec3 _e80 = corner;
        vec3 _e81 = normals_crossing(_e79, _e80);
        corner = _e81;
    }
    vec3 _e83 = corner;
    NormalsCorner _e84 = normals_corner(_e83, view_8);
    outline_2.first = _e84;
    NormalsCorner _e87 = outline_2.first;
    outline_2.last = _e87;
    bool _e90 = is_cut;
    uint skipped = (_e90 ? 0u : 1u);
    uint _e92 = ups;
    uint edges = ((_e92 + 1u) - (2u * skipped));
    bool _e98 = is_cut;
    uint closing_parts = (_e98 ? horizon_parts : edge_parts);
    NormalsCorner _e101 = outline_2.first;
    from_corner = _e101;
    NormalsCorner _e104 = outline_2.first;
    to_corner = _e104;
    bool loop_init_2 = true;
    while(true) {
        if (!loop_init_2) {
            uint _e168 = step_;
            step_ = (_e168 + 1u);
        }
        loop_init_2 = false;
        uint _e110 = step_;
        if ((_e110 < ((edges * edge_parts) + closing_parts))) {
        } else {
            break;
        }
        {
            uint _e114 = step_;
            uint edge = (_e114 / edge_parts);
            bool is_closing = (edge >= edges);
            uint _e117 = part;
            if ((_e117 == 0u)) {
                uint _e120 = start;
                vec3 _e125 = vertices_1[(((_e120 + skipped) + edge) % number)];
                vertex = _e125;
                bool _e127 = is_cut;
                if (_e127) {
                    uint _e130 = ups;
                    local_5 = (edge == _e130);
                } else {
                    local_5 = false;
                }
                bool _e133 = local_5;
                if (_e133) {
                    uint _e134 = start;
                    uint _e135 = ups;
                    vec3 _e141 = vertices_1[(((_e134 + _e135) - 1u) % number)];
                    vec3 _e142 = vertex;
                    vec3 _e143 = normals_crossing(_e141, _e142);
                    vertex = _e143;
                }
                NormalsCorner _e145 = outline_2.last;
                from_corner = _e145;
                vec3 _e146 = vertex;
                NormalsCorner _e147 = normals_corner(_e146, view_8);
                to_corner = _e147;
                if (is_closing) {
                    NormalsCorner _e149 = outline_2.first;
                    to_corner = _e149;
                }
            }
            uint _e150 = part;
            part = (_e150 + 1u);
            uint parts_1 = (is_closing ? closing_parts : edge_parts);
            NormalsCorner _e154 = to_corner;
            to_1 = _e154;
            uint _e156 = part;
            if ((_e156 < parts_1)) {
                NormalsCorner _e158 = from_corner;
                NormalsCorner _e159 = to_corner;
                uint _e160 = part;
                NormalsCorner _e164 = normals_between(_e158, _e159, (float(_e160) / float(parts_1)), view_8);
                to_1 = _e164;
            } else {
                part = 0u;
            }
            NormalsCorner _e166 = to_1;
            normals_edge(outline_2, view_8, _e166);
        }
    }
    vec3 _e171 = outline_2.flux;
    float seen_1 = dot(_e171, view_8.stretched);
    float side = ((seen_1 < 0.0) ? -1.0 : 1.0);
    if ((side < 0.0)) {
        local_6 = !(two_sided);
    } else {
        local_6 = false;
    }
    bool _e185 = local_6;
    if (_e185) {
        return vec2(0.0);
    }
    float to_part = ((side * 0.3183099) / (view_8.wo.z + view_8.length_));
    vec3 _e196 = outline_2.flux;
    vec3 _e198 = normals_unit((_e196 * side));
    if ((rule == NORMALS_MEAN)) {
        vec3 _e202 = normals_weight(view_8, _e198);
        parts = (_e202.xy * (to_part * seen_1));
    } else {
        vec2 _e206 = normals_fan(view_8, outline_2, _e198);
        parts = (_e206 * to_part);
    }
    float _e209 = parts.x;
    float energy = clamp(_e209, 0.0, 1.0);
    float _e214 = parts.y;
    return vec2(energy, clamp(_e214, 0.0, energy));
}

vec2 normals_rectangle(NormalsView view_9, vec3 corners[4], bool two_sided_1, uint rule_1) {
    vec3 vertices_2[8] = vec3[8](vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0));
    vertices_2[0] = corners[0];
    vertices_2[1] = corners[1];
    vertices_2[2] = corners[2];
    vertices_2[3] = corners[3];
    vec2 _e14 = normals_polygon(view_9, vertices_2, 4u, two_sided_1, rule_1);
    return _e14;
}

vec2 normals_disk(NormalsView view_10, vec3 centre, vec3 half_x, vec3 half_y, bool two_sided_2, uint rule_2) {
    vec3 vertices_3[8] = vec3[8](vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0));
    uint i_2 = 0u;
    bool loop_init_3 = true;
    while(true) {
        if (!loop_init_3) {
            uint _e30 = i_2;
            i_2 = (_e30 + 1u);
        }
        loop_init_3 = false;
        uint _e9 = i_2;
        if ((_e9 < 8u)) {
        } else {
            break;
        }
        {
            uint _e12 = i_2;
            vec2 _e18 = ltc_sin_cos(((0.5 - float(_e12)) * 0.125));
            vec2 turn_1 = (_e18 * 1.0539074);
            uint _e21 = i_2;
            vertices_3[_e21] = ((centre + (half_x * turn_1.y)) + (half_y * turn_1.x));
        }
    }
    vec2 _e33 = normals_polygon(view_10, vertices_3, 8u, two_sided_2, rule_2);
    return _e33;
}
