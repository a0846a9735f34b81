// Linearly Transformed Cosines: area lights on anisotropic GGX, by a table that ltcforge fitted.
// Made by ltcforge 0.1.0. SPDX-License-Identifier: MIT OR Apache-2.0
//
// Reads tables of layout reflected, and takes every table for one.
//
// FUNCTIONS
//   ltc_lookup(alpha_x, alpha_y, wo)  M, amplitude and fresnel. GGX roughness along x and y; wo is the view direction in
//       the tangent frame, normal +z, of unit length. M maps the clamped cosine to the lobe, in that frame.
//   ltc_inverse(M)                    the inverse up to a factor, for all lights at the point.
//   ltc_rectangle(inverse, corners, two_sided), ltc_polygon(inverse, vertices, count, two_sided),
//   ltc_disk(inverse, centre, half_x, half_y, two_sided), ltc_sphere(inverse, centre, radius),
//   ltc_tube(inverse, start, end, radius), ltc_line(inverse, start, end, width)
//       the part of the lobe that a light covers, 0 to 1. All is relative to the shaded point, in the tangent frame.
//       Vertices are convex and run clockwise seen from the lit side; a disk's is towards half_x x half_y. A tube has
//       round ends; a line is the limit of a thin one, its width the diameter. Disks, spheres and tubes are exact.
//       LTC_CHEAP_HORIZON, a constant, makes disks and spheres cheaper, and too bright by up to 0.16 at the horizon.
//   Light of radiance L arrives as L (f0 (amplitude - fresnel) + f90 fresnel) covered.
//
// USE
//   ltc_lookup and ltc_inverse once for a point and view, then one call for each light. Isotropic surfaces have alpha_x =
//   alpha_y. Diffuse light is the albedo times one with the unit matrix for inverse.
//   A second table in the same shader needs names and bindings of its own: ltcforge shader --prefix --first-binding.
//
// BINDINGS OF A TABLE
//   uniform   8 x u32: how many nodes alpha, ratio, theta and phi have; the layout's number, not read here
//             (reflected 1, kt2022 0, ltc2017 2, ltc2016 3, godot 4, hdrp 5);
//             1 if ratio has the one node 1 and phi has one node, else 0; 0; 0
//   nodes     uniform of f32, at most 512: alpha's nodes, then ratio's, theta's and phi's, ascending
//   matrix_a  3D texture, RGBA, 32 or 16 bit float: m00 m01 m02 m10 of each entry; m01 is row 0, column 1
//   matrix_b  likewise: m11 m12 m20 m21
//   terms     likewise: m22 amplitude fresnel 0; a table without terms has amplitude 1, fresnel 0
//   The textures are phi wide, ratio * theta high and alpha deep: texel (p, r * theta_nodes + t, a) is entry [a, r, t, p]
//   of the file's tensors.
//   Texels stand in the order of the file's entries, but their numbers have to be put together from its tensors
//   matrix, amplitude and fresnel. Alpha is the larger roughness, ratio the smaller over it, theta and phi the view
//   direction's angles in radians.
//   here      uniforms ltc_table.nodes and ltc_table.reading, uvec4 each; ltc_nodes.four, 128 x vec4, four nodes each, 0 after
//             the last; samplers ltc_matrix_a, ltc_matrix_b, ltc_terms
//   The entries are weighed here, texels are fetched: filter and wrap mode do not matter.
//
// CHECK
//   Of the table with the nodes alpha 0.1 0.4 1; ratio 0.1 1; theta 0 0.7 1.5; phi 0 0.6 1.5
//   whose entry number e = ((a * 2 + r) * 3 + t) * 3 + p has the numbers I[k] + e * (k + 1) / 1024, k = 0 to 10: the nine
//   of the matrix by rows, amplitude, fresnel; I = 1 0 0 0 1 0 0 0 1 1 0. All are exact in 16 bits. Covered is by the
//   one-sided rectangle (-1 -1 1) (1 -1 1) (1 1.5 -0.5) (-1 1.5 -0.5).
//   M is given by rows. A port in 32 bits comes within 0.00002 of each number.
//   alpha_x 0.3 alpha_y 0.15 wo (0.36 0.48 0.8)
//     M 0.455160 -0.025988 -0.355745 | -0.024825 0.462310 -0.494482 | 0.335194 0.445719 1.010002
//     amplitude 1.183772 fresnel 0.013038 covered 0.717446
//   alpha_x 0.2 alpha_y 0.6 wo (-0.64 0.48 0.6)
//     M 0.796046 0.023805 0.631094 | -0.092481 0.827790 -0.286082 | -1.043624 0.615172 1.100971
//     amplitude 1.256243 fresnel 0.166366 covered 0.654362
//   alpha_x 0.05 alpha_y 0.02 wo (0.576 -0.768 0.28)
//     M 0.021982 0.039881 -0.616365 | 0.047724 0.003240 0.827966 | 0.140107 -0.184676 0.331542
//     amplitude 1.068168 fresnel 0.384685 covered 0.959973


precision highp float;
precision highp int;

struct LtcNodes {
    vec4 four[128];
};
struct LtcTexels {
    vec4 a;
    vec4 b;
    vec4 terms;
};
struct LtcPlace {
    uint lower;
    float weight;
    float nearest;
};
struct LtcTable {
    uvec4 nodes;
    uvec4 reading;
};
struct LtcLobe {
    mat3x3 m;
    float amplitude;
    float fresnel;
};
struct LtcFold {
    float alpha;
    float ratio;
    float theta;
    float phi;
    vec2 mirror;
    bool swap;
};
struct LtcInverse {
    mat3x3 m;
    float side;
};
struct LtcClip {
    float sum;
    vec2 origin;
    vec3 previous;
    vec3 previous_unit;
    vec3 leaves;
    vec3 enters;
};
struct LtcCone {
    float a;
    float b;
    float g;
    float cut2_;
    float height;
    mat3x3 axes;
};
struct LtcBorder {
    vec2 sines;
    vec2 cosines;
    float turn;
};
const float LTC_LEAST_ALPHA = 1e-5;
const bool LTC_CHEAP_HORIZON = false;
const bool ltc_hardware_filter = false;

uniform LtcNodes ltc_nodes;

uniform highp sampler3D ltc_matrix_a;

uniform highp sampler3D ltc_matrix_b;

uniform highp sampler3D ltc_terms;

uniform LtcTable ltc_table;


float ltc_atan2_(float y, float x) {
    float low = min(y, abs(x));
    float high = max(y, abs(x));
    bool is_far = (low > (0.41421357 * high));
    float t = ((is_far ? (low - high) : low) / max((is_far ? (low + high) : high), 1e-37));
    float z = (t * t);
    float near = (((((((((0.08053744 * z) - 0.13877685) * z) + 0.1997771) * z) - 0.3333295) * z) * t) + t);
    float eighth = (is_far ? (near + 0.7853982) : near);
    float quarter = ((y > abs(x)) ? (1.5707964 - eighth) : eighth);
    return ((x < 0.0) ? (3.1415927 - quarter) : quarter);
}

vec2 ltc_sin_cos(float turns) {
    bool local = false;
    float quarter_1 = floor(((4.0 * turns) + 0.5));
    float x_5 = ((turns - (0.25 * quarter_1)) * 6.2831855);
    float z_1 = (x_5 * x_5);
    float s_1 = (((((((-0.00019515296 * z_1) + 0.008332161) * z_1) - 0.16666655) * z_1) * x_5) + x_5);
    float c_1 = ((((((((2.4433157e-5 * z_1) - 0.0013887316) * z_1) + 0.041666646) * z_1) * z_1) - (0.5 * z_1)) + 1.0);
    uint q_1 = (uint(int(quarter_1)) & 3u);
    vec2 swapped = (((q_1 & 1u) == 1u) ? vec2(c_1, s_1) : vec2(s_1, c_1));
    if (!((q_1 == 1u))) {
        local = (q_1 == 2u);
    } else {
        local = true;
    }
    bool _e64 = local;
    return vec2(((q_1 >= 2u) ? -(swapped.x) : swapped.x), (_e64 ? -(swapped.y) : swapped.y));
}

float ltc_log(float x_1) {
    int bits = (floatBitsToInt(x_1) - 1060439283);
    float m_3 = intBitsToFloat(((bits & 8388607) + 1060439283));
    float s_2 = ((m_3 - 1.0) / (m_3 + 1.0));
    float z_2 = (s_2 * s_2);
    float series = (((((((((0.22222222 * z_2) + 0.2857143) * z_2) + 0.4) * z_2) + 0.6666667) * z_2) * s_2) + (2.0 * s_2));
    return ((float((bits >> 23u)) * 0.6931472) + series);
}

float ltc_node(uint place) {
    vec4 four = ltc_nodes.four[(place / 4u)];
    return four[(place % 4u)];
}

LtcTexels ltc_fetch(uvec3 texel) {
    vec4 _e3 = texelFetch(ltc_matrix_a, ivec3(texel), 0);
    vec4 _e6 = texelFetch(ltc_matrix_b, ivec3(texel), 0);
    vec4 _e9 = texelFetch(ltc_terms, ivec3(texel), 0);
    return LtcTexels(_e3, _e6, _e9);
}

LtcFold ltc_fold(float alpha_x, float alpha_y, vec3 wo) {
    LtcFold fold = LtcFold(0.0, 0.0, 0.0, 0.0, vec2(0.0), false);
    vec2 a_1 = max(vec2(alpha_x, alpha_y), vec2(1e-5));
    bool swap = (a_1.y > a_1.x);
    vec2 flat_ = abs(wo.xy);
    fold.alpha = max(a_1.x, a_1.y);
    float _e22 = fold.alpha;
    fold.ratio = (min(a_1.x, a_1.y) / _e22);
    float _e28 = ltc_atan2_(sqrt(dot(flat_, flat_)), wo.z);
    fold.theta = min(_e28, 1.5707964);
    float _e38 = ltc_atan2_((swap ? flat_.x : flat_.y), (swap ? flat_.y : flat_.x));
    fold.phi = _e38;
    fold.mirror = mix(vec2(1.0), vec2(-1.0), lessThan(wo.xy, vec2(0.0)));
    fold.swap = swap;
    LtcFold _e50 = fold;
    return _e50;
}

float ltc_even(uint axis, float x_2) {
    return x_2;
}

LtcPlace ltc_between(uint axis_1, uint first, uint count, float x_3) {
    uint lower = 0u;
    float below = 0.0;
    uint span = 0u;
    float _e6 = ltc_node(first);
    below = _e6;
    span = count;
    while(true) {
        uint _e9 = span;
        if ((_e9 > 1u)) {
        } else {
            break;
        }
        {
            uint _e12 = span;
            uint part = (_e12 / 2u);
            uint _e15 = lower;
            float _e18 = ltc_node(((first + _e15) + part));
            uint _e19 = lower;
            uint _e20 = lower;
            lower = ((_e18 <= x_3) ? (_e20 + part) : _e19);
            float _e24 = below;
            below = ((_e18 <= x_3) ? _e18 : _e24);
            uint _e27 = span;
            span = (_e27 - part);
        }
    }
    uint _e29 = lower;
    float _e36 = ltc_node((first + min((_e29 + 1u), (count - 1u))));
    float _e37 = below;
    float nearest = clamp(x_3, _e37, _e36);
    float _e39 = below;
    float _e40 = ltc_even(axis_1, _e39);
    float _e41 = ltc_even(axis_1, _e36);
    float step_ = (_e41 - _e40);
    uint _e43 = lower;
    float _e44 = ltc_even(axis_1, nearest);
    float _e47 = below;
    return LtcPlace(_e43, ((_e36 > _e47) ? ((_e44 - _e40) / step_) : 0.0), nearest);
}

LtcTexels ltc_fetch_weighed(LtcPlace alpha, LtcPlace ratio, LtcPlace theta, LtcPlace phi) {
    LtcTexels sum = LtcTexels(vec4(0.0), vec4(0.0), vec4(0.0));
    uint corner = 0u;
    uvec4 _e14 = ltc_table.nodes;
    uvec4 last_1 = (_e14 - uvec4(1u));
    uvec4 lower_1 = uvec4(alpha.lower, ratio.lower, theta.lower, phi.lower);
    vec4 upper = vec4(alpha.weight, ratio.weight, theta.weight, phi.weight);
    bool loop_init = true;
    while(true) {
        if (!loop_init) {
            uint _e88 = corner;
            corner = (_e88 + 1u);
        }
        loop_init = false;
        uint _e30 = corner;
        if ((_e30 < 16u)) {
        } else {
            break;
        }
        {
            uint _e33 = corner;
            uvec4 step_1 = ((uvec4(_e33) >> uvec4(3u, 2u, 1u, 0u)) & uvec4(1u));
            vec4 weights = mix((vec4(1.0) - upper), upper, equal(step_1, uvec4(1u)));
            float weight = (((weights.x * weights.y) * weights.z) * weights.w);
            uvec4 entry = min((lower_1 + step_1), last_1);
            uint _e65 = ltc_table.nodes.z;
            uvec3 texel_1 = uvec3(entry.w, ((entry.y * _e65) + entry.z), entry.x);
            LtcTexels _e71 = ltc_fetch(texel_1);
            vec4 _e73 = sum.a;
            sum.a = (_e73 + (weight * _e71.a));
            vec4 _e78 = sum.b;
            sum.b = (_e78 + (weight * _e71.b));
            vec4 _e83 = sum.terms;
            sum.terms = (_e83 + (weight * _e71.terms));
        }
    }
    LtcTexels _e90 = sum;
    return _e90;
}

mat3x3 ltc_turned(mat3x3 m, float angle) {
    vec2 _e4 = ltc_sin_cos((angle * 0.15915494));
    mat3x3 r = mat3x3(vec3(_e4.y, _e4.x, 0.0), vec3(-(_e4.x), _e4.y, 0.0), vec3(0.0, 0.0, 1.0));
    return ((r * m) * transpose(r));
}

mat3x3 ltc_unfold(LtcFold fold_1, mat3x3 folded) {
    mat3x3 m_1 = mat3x3(0.0);
    m_1 = folded;
    if (fold_1.swap) {
        m_1 = mat3x3(folded[1].yxz, folded[0].yxz, folded[2].yxz);
    }
    vec3 mirror = vec3(fold_1.mirror, 1.0);
    vec3 _e15 = m_1[0];
    vec3 _e20 = m_1[1];
    vec3 _e25 = m_1[2];
    return mat3x3(((_e15 * mirror) * mirror.x), ((_e20 * mirror) * mirror.y), (_e25 * mirror));
}

vec3 ltc_reflected_tangent(vec3 wo_1, vec3 wm, float d, vec3 tangent) {
    vec3 tilt = (tangent - (dot(wm, tangent) * wm));
    return (2.0 * ((dot(wo_1, tilt) * wm) + (d * tilt)));
}

float ltc_smith_lambda(float alpha_x_1, float alpha_y_1, vec3 w) {
    vec2 slope = (vec2((alpha_x_1 * w.x), (alpha_y_1 * w.y)) / vec2(w.z));
    return (0.5 * (sqrt((1.0 + dot(slope, slope))) - 1.0));
}

LtcLobe ltc_restore_reflected(LtcLobe stored, float alpha_x_2, float ratio_1, vec3 wo_2) {
    float alpha_y_3 = max((alpha_x_2 * ratio_1), LTC_LEAST_ALPHA);
    vec3 halfway = (normalize(vec3((alpha_x_2 * wo_2.x), (alpha_y_3 * wo_2.y), wo_2.z)) + vec3(0.0, 0.0, 1.0));
    vec3 wm_1 = normalize(vec3((alpha_x_2 * halfway.x), (alpha_y_3 * halfway.y), halfway.z));
    float d_1 = dot(wo_2, wm_1);
    vec3 reflected = (((2.0 * d_1) * wm_1) - wo_2);
    vec3 _e35 = ltc_reflected_tangent(wo_2, wm_1, d_1, vec3(1.0, 0.0, 0.0));
    vec3 _e41 = ltc_reflected_tangent(wo_2, wm_1, d_1, vec3(0.0, 1.0, 0.0));
    mat3x3 k_2 = mat3x3((alpha_x_2 * _e35), (alpha_x_2 * _e41), reflected);
    float _e44 = ltc_smith_lambda(alpha_x_2, alpha_y_3, wo_2);
    float seen = (1.0 + _e44);
    float _e47 = ltc_smith_lambda(alpha_x_2, alpha_y_3, reflected);
    float g2_over_g1_ = (seen / (seen + _e47));
    float amplitude = ((stored.amplitude * g2_over_g1_) * g2_over_g1_);
    float grazing = max(((stored.fresnel + 1.0) - d_1), 0.0);
    float grazing2_ = (grazing * grazing);
    return LtcLobe((k_2 * stored.m), amplitude, (amplitude * ((grazing2_ * grazing2_) * grazing)));
}

LtcLobe ltc_restore(LtcLobe stored_1, float alpha_x_3, float ratio_2, vec3 wo_3) {
    LtcLobe _e4 = ltc_restore_reflected(stored_1, alpha_x_3, ratio_2, wo_3);
    return _e4;
}

LtcLobe ltc_lookup(float alpha_x_4, float alpha_y_2, vec3 wo_4) {
    LtcTexels texels = LtcTexels(vec4(0.0), vec4(0.0), vec4(0.0));
    vec3 view = vec3(0.0);
    bool local_1 = false;
    LtcLobe lobe = LtcLobe(mat3x3(0.0), 0.0, 0.0);
    LtcFold _e3 = ltc_fold(alpha_x_4, alpha_y_2, wo_4);
    uvec4 n = ltc_table.nodes;
    LtcPlace _e11 = ltc_between(0u, 0u, n.x, _e3.alpha);
    LtcPlace _e16 = ltc_between(1u, n.x, n.y, _e3.ratio);
    LtcPlace _e23 = ltc_between(2u, (n.x + n.y), n.z, _e3.theta);
    LtcPlace _e32 = ltc_between(3u, ((n.x + n.y) + n.z), n.w, _e3.phi);
    LtcTexels _e34 = ltc_fetch_weighed(_e11, _e16, _e23, _e32);
    texels = _e34;
    vec4 _e36 = texels.a;
    float _e40 = texels.a.w;
    vec4 _e42 = texels.b;
    vec4 _e46 = texels.b;
    float _e50 = texels.terms.x;
    mat3x3 stored_2 = transpose(mat3x3(_e36.xyz, vec3(_e40, _e42.xy), vec3(_e46.zw, _e50)));
    view = vec3((_e3.swap ? abs(wo_4.yx) : abs(wo_4.xy)), wo_4.z);
    if (!((_e23.nearest != _e3.theta))) {
        local_1 = (_e32.nearest != _e3.phi);
    } else {
        local_1 = true;
    }
    bool _e73 = local_1;
    if (_e73) {
        vec2 _e77 = ltc_sin_cos((_e23.nearest * 0.15915494));
        vec2 _e81 = ltc_sin_cos((_e32.nearest * 0.15915494));
        view = vec3((_e77.x * _e81.y), (_e77.x * _e81.x), _e77.y);
    }
    float _e92 = texels.terms.y;
    float _e95 = texels.terms.z;
    vec3 _e99 = view;
    LtcLobe _e100 = ltc_restore(LtcLobe(stored_2, _e92, _e95), _e11.nearest, _e16.nearest, _e99);
    lobe = _e100;
    uint _e105 = ltc_table.reading.y;
    if ((_e105 == 1u)) {
        mat3x3 _e110 = lobe.m;
        float _e117 = ltc_node(((n.x + n.y) + n.z));
        mat3x3 _e119 = ltc_turned(_e110, (_e3.phi - _e117));
        lobe.m = _e119;
    }
    mat3x3 _e122 = lobe.m;
    mat3x3 _e123 = ltc_unfold(_e3, _e122);
    lobe.m = _e123;
    LtcLobe _e124 = lobe;
    return _e124;
}

LtcInverse ltc_inverse(mat3x3 m_2) {
    bool local_2 = false;
    vec3 x_6 = cross(m_2[1], m_2[2]);
    vec3 y_2 = cross(m_2[2], m_2[0]);
    vec3 z_3 = cross(m_2[0], m_2[1]);
    vec3 most = max(max(abs(x_6), abs(y_2)), abs(z_3));
    float largest = max(max(most.x, most.y), most.z);
    float side_1 = sign(dot(m_2[2], z_3));
    if ((largest > 1e-30)) {
        local_2 = (largest < 1e30);
    } else {
        local_2 = false;
    }
    bool _e30 = local_2;
    if (!(_e30)) {
        return LtcInverse(mat3x3(0.0), 0.0);
    }
    float scale = (side_1 / largest);
    return LtcInverse(transpose(mat3x3((x_6 * scale), (y_2 * scale), (z_3 * scale))), side_1);
}

vec3 ltc_unit(vec3 v) {
    float length2_ = dot(v, v);
    return ((length2_ > 1e-36) ? (v / vec3(sqrt(max(length2_, 1e-36)))) : vec3(0.0));
}

float ltc_arc(vec3 a, vec3 b, vec2 origin) {
    vec3 c_2 = cross(a, b);
    float s_3 = sqrt(dot(c_2, c_2));
    vec2 p_1 = (a.xy - origin);
    vec2 q_2 = (b.xy - origin);
    float _e11 = ltc_atan2_(s_3, dot(a, b));
    float bend = ((s_3 > 1e-18) ? ((_e11 / max(s_3, 1e-18)) - 1.0) : 0.0);
    return (((p_1.x * q_2.y) - (p_1.y * q_2.x)) + (c_2.z * bend));
}

LtcClip ltc_clip_begin(vec3 vertex) {
    vec3 _e1 = ltc_unit(vertex);
    return LtcClip(0.0, _e1.xy, vertex, _e1, vec3(0.0), vec3(0.0));
}

LtcClip ltc_clip_edge(LtcClip clip, vec3 b_1) {
    LtcClip next = LtcClip(0.0, vec2(0.0), vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0));
    vec3 from_point = vec3(0.0);
    vec3 to_point = vec3(0.0);
    bool local_3 = false;
    bool local_4 = false;
    bool local_5 = false;
    next = clip;
    vec3 a_2 = clip.previous;
    next.previous = b_1;
    vec3 _e6 = ltc_unit(b_1);
    next.previous_unit = _e6;
    from_point = clip.previous_unit;
    vec3 _e10 = next.previous_unit;
    to_point = _e10;
    if ((a_2.z > 0.0)) {
        local_3 = (b_1.z <= 0.0);
    } else {
        local_3 = false;
    }
    bool _e21 = local_3;
    if (_e21) {
        vec3 _e32 = ltc_unit(vec3(((b_1.xy * a_2.z) - (a_2.xy * b_1.z)), 0.0));
        next.leaves = _e32;
        vec3 _e34 = next.leaves;
        to_point = _e34;
    }
    if ((a_2.z <= 0.0)) {
        local_4 = (b_1.z > 0.0);
    } else {
        local_4 = false;
    }
    bool _e44 = local_4;
    if (_e44) {
        vec3 _e55 = ltc_unit(vec3(((a_2.xy * b_1.z) - (b_1.xy * a_2.z)), 0.0));
        next.enters = _e55;
        vec3 _e57 = next.enters;
        from_point = _e57;
    }
    if (!((a_2.z > 0.0))) {
        local_5 = (b_1.z > 0.0);
    } else {
        local_5 = true;
    }
    bool _e68 = local_5;
    if (_e68) {
        float _e70 = next.sum;
        vec3 _e71 = from_point;
        vec3 _e72 = to_point;
        float _e74 = ltc_arc(_e71, _e72, clip.origin);
        next.sum = (_e70 + _e74);
    }
    LtcClip _e76 = next;
    return _e76;
}

float ltc_clip_finish(LtcClip clip_1, float side, bool two_sided) {
    bool is_cut = any(notEqual(clip_1.leaves, clip_1.enters));
    float _e10 = ltc_arc(clip_1.leaves, clip_1.enters, clip_1.origin);
    float closing = (is_cut ? _e10 : 0.0);
    float sum_1 = (((clip_1.sum + closing) * 0.15915494) * side);
    return clamp((two_sided ? abs(sum_1) : sum_1), 0.0, 1.0);
}

float ltc_rectangle(LtcInverse inverse_, vec3 corners[4], bool two_sided_1) {
    LtcClip clip_2 = LtcClip(0.0, vec2(0.0), vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0));
    LtcClip _e6 = ltc_clip_begin((inverse_.m * corners[3]));
    clip_2 = _e6;
    LtcClip _e8 = clip_2;
    LtcClip _e12 = ltc_clip_edge(_e8, (inverse_.m * corners[0]));
    clip_2 = _e12;
    LtcClip _e13 = clip_2;
    LtcClip _e17 = ltc_clip_edge(_e13, (inverse_.m * corners[1]));
    clip_2 = _e17;
    LtcClip _e18 = clip_2;
    LtcClip _e22 = ltc_clip_edge(_e18, (inverse_.m * corners[2]));
    clip_2 = _e22;
    LtcClip _e23 = clip_2;
    LtcClip _e27 = ltc_clip_edge(_e23, (inverse_.m * corners[3]));
    clip_2 = _e27;
    LtcClip _e28 = clip_2;
    float _e30 = ltc_clip_finish(_e28, inverse_.side, two_sided_1);
    return _e30;
}

float ltc_polygon(LtcInverse inverse_1, vec3 vertices_1[8], uint count_1, bool two_sided_2) {
    vec3 outline[8] = vec3[8](vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0));
    LtcClip clip_3 = LtcClip(0.0, vec2(0.0), vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0));
    uint i = 0u;
    outline = vertices_1;
    uint number = min(max(count_1, 3u), 8u);
    vec3 _e12 = outline[(number - 1u)];
    LtcClip _e14 = ltc_clip_begin((inverse_1.m * _e12));
    clip_3 = _e14;
    bool loop_init_1 = true;
    while(true) {
        if (!loop_init_1) {
            uint _e28 = i;
            i = (_e28 + 1u);
        }
        loop_init_1 = false;
        uint _e18 = i;
        if ((_e18 < number)) {
        } else {
            break;
        }
        {
            LtcClip _e20 = clip_3;
            uint _e22 = i;
            vec3 _e24 = outline[_e22];
            LtcClip _e26 = ltc_clip_edge(_e20, (inverse_1.m * _e24));
            clip_3 = _e26;
        }
    }
    LtcClip _e30 = clip_3;
    float _e32 = ltc_clip_finish(_e30, inverse_1.side, two_sided_2);
    return _e32;
}

float ltc_angle(float y_1, float x_4) {
    float _e3 = ltc_atan2_(abs(y_1), x_4);
    return ((y_1 < 0.0) ? -(_e3) : _e3);
}

vec2 ltc_unit_turn(vec2 turn) {
    float size = max(abs(turn.x), abs(turn.y));
    if (!((size > 0.0))) {
        return vec2(1.0, 0.0);
    }
    vec2 scaled = (turn / vec2(size));
    return (scaled / vec2(sqrt(dot(scaled, scaled))));
}

float ltc_cone_root(float trace, float minors, float last) {
    float root = 0.0;
    int i_1 = 0;
    bool local_6 = false;
    root = (((2.0 * sqrt(max(((trace * trace) - (3.0 * minors)), 0.0))) - trace) * 0.33333334);
    if ((trace > 0.0)) {
        float size_1 = sqrt(((minors * minors) + ((4.0 * trace) * last)));
        if ((minors > 0.0)) {
            float _e26 = root;
            root = min(_e26, ((2.0 * last) / (minors + size_1)));
        } else {
            float _e32 = root;
            root = min(_e32, ((size_1 - minors) / (2.0 * trace)));
        }
    }
    bool loop_init_2 = true;
    while(true) {
        if (!loop_init_2) {
            int _e72 = i_1;
            i_1 = (_e72 + 1);
        }
        loop_init_2 = false;
        int _e40 = i_1;
        if ((_e40 < 4)) {
        } else {
            break;
        }
        {
            float _e43 = root;
            float _e45 = root;
            float _e48 = root;
            float value_1 = (((((_e43 + trace) * _e45) + minors) * _e48) - last);
            float _e51 = root;
            float _e52 = root;
            float _e58 = root;
            float next_2 = (_e51 - (value_1 / ((((3.0 * _e52) + (2.0 * trace)) * _e58) + minors)));
            float _e63 = root;
            if ((next_2 < _e63)) {
                local_6 = (next_2 > 0.0);
            } else {
                local_6 = false;
            }
            bool _e70 = local_6;
            if (_e70) {
                root = next_2;
            }
        }
    }
    float _e74 = root;
    return _e74;
}

LtcCone ltc_cone(vec3 centre, vec3 half_x, vec3 half_y) {
    LtcCone cone = LtcCone(0.0, 0.0, 0.0, 0.0, 0.0, mat3x3(0.0));
    bool local_7 = false;
    vec3 middle = vec3(0.0);
    vec3 e = vec3(0.0);
    vec2 turn_1 = vec2(1.0, 0.0);
    vec3 most_1 = max(max(abs(centre), abs(half_x)), abs(half_y));
    float size_2 = max(max(most_1.x, most_1.y), most_1.z);
    if (!((size_2 > 0.0))) {
        LtcCone _e18 = cone;
        return _e18;
    }
    vec3 c_3 = (centre / vec3(size_2));
    vec3 x_7 = (half_x / vec3(size_2));
    vec3 y_3 = (half_y / vec3(size_2));
    vec3 x_y = cross(x_7, y_3);
    vec3 y_c = cross(y_3, c_3);
    vec3 c_x = cross(c_3, x_7);
    float volume = abs(dot(c_3, x_y));
    float trace_1 = ((dot(x_7, x_7) + dot(y_3, y_3)) - dot(c_3, c_3));
    float minors_1 = ((dot(x_y, x_y) - dot(y_c, y_c)) - dot(c_x, c_x));
    float _e41 = ltc_cone_root(trace_1, minors_1, (volume * volume));
    if ((_e41 > 0.0)) {
        local_7 = (volume > 0.0);
    } else {
        local_7 = false;
    }
    bool _e49 = local_7;
    if (!(_e49)) {
        LtcCone _e51 = cone;
        return _e51;
    }
    float rest = (_e41 * (trace_1 + _e41));
    vec3 col_x = (((((x_y * x_y.x) - (y_c * y_c.x)) - (c_x * c_x.x)) - (_e41 * (((x_7 * x_7.x) + (y_3 * y_3.x)) - (c_3 * c_3.x)))) + vec3(rest, 0.0, 0.0));
    vec3 col_y = (((((x_y * x_y.y) - (y_c * y_c.y)) - (c_x * c_x.y)) - (_e41 * (((x_7 * x_7.y) + (y_3 * y_3.y)) - (c_3 * c_3.y)))) + vec3(0.0, rest, 0.0));
    vec3 col_z = (((((x_y * x_y.z) - (y_c * y_c.z)) - (c_x * c_x.z)) - (_e41 * (((x_7 * x_7.z) + (y_3 * y_3.z)) - (c_3 * c_3.z)))) + vec3(0.0, 0.0, rest));
    middle = ((col_x.x > col_y.y) ? col_x : col_y);
    vec3 _e125 = middle;
    middle = ((col_z.z >= max(col_x.x, col_y.y)) ? col_z : _e125);
    float _e133 = middle.x;
    float _e136 = middle.y;
    float _e140 = middle.z;
    float largest_1 = max(max(abs(_e133), abs(_e136)), abs(_e140));
    if (!((largest_1 > 0.0))) {
        LtcCone _e146 = cone;
        return _e146;
    }
    vec3 _e147 = middle;
    middle = (_e147 / vec3(largest_1));
    vec3 _e150 = middle;
    vec3 _e151 = middle;
    vec3 _e152 = middle;
    middle = (_e150 / vec3(sqrt(dot(_e151, _e152))));
    vec3 _e157 = middle;
    vec3 _e158 = middle;
    vec3 _e160 = middle;
    middle = ((dot(_e160, c_3) < 0.0) ? -(_e158) : _e157);
    vec3 _e165 = middle;
    vec3 _e167 = middle;
    float flat_1 = sqrt(dot(_e165.xy, _e167.xy));
    float _e172 = middle.y;
    float _e175 = middle.x;
    e = ((flat_1 > 1e-6) ? (vec3(-(_e172), _e175, 0.0) / vec3(max(flat_1, 1e-6))) : vec3(1.0, 0.0, 0.0));
    vec3 _e190 = e;
    vec3 _e191 = middle;
    vec3 _e192 = middle;
    vec3 _e193 = e;
    e = (_e190 - (_e191 * dot(_e192, _e193)));
    vec3 _e197 = middle;
    vec3 _e198 = e;
    vec3 f = cross(_e197, _e198);
    vec3 _e200 = e;
    vec3 _e202 = e;
    vec3 _e204 = e;
    vec3 of_e = vec3(dot(_e200, x_7), dot(_e202, y_3), dot(_e204, c_3));
    vec3 of_f = vec3(dot(f, x_7), dot(f, y_3), dot(f, c_3));
    float ee = (dot(of_e.xy, of_e.xy) - (of_e.z * of_e.z));
    float ef = (dot(of_e.xy, of_f.xy) - (of_e.z * of_f.z));
    float ff = (dot(of_f.xy, of_f.xy) - (of_f.z * of_f.z));
    float difference = (0.5 * (ee - ff));
    float spread = sqrt(((difference * difference) + (ef * ef)));
    float l1_ = max(((0.5 * (ee + ff)) + spread), 0.0);
    float l2_ = min((volume * (volume / max((_e41 * l1_), 1e-36))), l1_);
    if ((spread > 0.0)) {
        if ((difference > 0.0)) {
            vec2 _e261 = ltc_unit_turn(vec2((difference + spread), ef));
            turn_1 = _e261;
        } else {
            vec2 _e265 = ltc_unit_turn(vec2(abs(ef), (spread - difference)));
            turn_1 = _e265;
            float _e268 = turn_1.y;
            float _e271 = turn_1.y;
            turn_1.y = ((ef > 0.0) ? _e271 : -(_e268));
        }
    }
    vec3 _e275 = e;
    float _e277 = turn_1.x;
    float _e280 = turn_1.y;
    vec3 first_4 = ((_e275 * _e277) + (f * _e280));
    cone.a = sqrt(l1_);
    cone.b = sqrt(l2_);
    cone.g = sqrt(_e41);
    cone.cut2_ = (((x_7.z * x_7.z) + (y_3.z * y_3.z)) - (c_3.z * c_3.z));
    cone.height = c_3.z;
    vec3 _e304 = middle;
    vec3 _e306 = middle;
    cone.axes = mat3x3(first_4, cross(_e304, first_4), _e306);
    LtcCone _e308 = cone;
    return _e308;
}

float ltc_artanh_over(float k, vec2 s) {
    float value = 0.0;
    float bottom = max((1.0 - ((k * k) * s.y)), 1e-18);
    float tangent_1 = (abs((k * s.x)) / bottom);
    float tangent2_ = (tangent_1 * tangent_1);
    value = (1.0 + (tangent2_ * (0.33333334 + (tangent2_ * (0.2 + (tangent2_ * (0.14285713 + (tangent2_ * 0.11111111))))))));
    if ((tangent2_ >= 0.01)) {
        float _e37 = ltc_log(((1.0 + tangent_1) / max((1.0 - tangent_1), 1e-12)));
        value = ((0.5 * _e37) / tangent_1);
    }
    float _e43 = value;
    return ((s.x / bottom) * _e43);
}

float ltc_arctan_over(float k_1, vec2 c) {
    if ((k_1 > 1e-6)) {
        float _e11 = ltc_angle((k_1 * c.x), (1.0 + ((k_1 * k_1) * c.y)));
        return (_e11 / k_1);
    }
    return c.x;
}

float ltc_along(LtcCone cone_1, LtcBorder border) {
    float a_g2_ = ((cone_1.g * cone_1.g) + (cone_1.a * cone_1.a));
    float b_g2_ = ((cone_1.g * cone_1.g) + (cone_1.b * cone_1.b));
    float a_g = sqrt(a_g2_);
    float b_g = sqrt(b_g2_);
    float k_3 = sqrt(max(((cone_1.a - cone_1.b) * (cone_1.a + cone_1.b)), 0.0));
    float _e30 = ltc_artanh_over((k_3 / a_g), border.sines);
    float sines = (_e30 / a_g);
    float _e34 = ltc_arctan_over((k_3 / b_g), border.cosines);
    float cosines = (_e34 / b_g);
    float _e46 = ltc_angle(((a_g * b_g) * border.turn), ((a_g2_ * border.cosines.y) + (b_g2_ * border.sines.y)));
    float around = ((_e46 < 0.0) ? (_e46 + 6.2831855) : _e46);
    vec3 n_1 = vec3(cone_1.axes[0].z, cone_1.axes[1].z, cone_1.axes[2].z);
    return (((((n_1.z * (cone_1.a / a_g)) * (cone_1.b / b_g)) * around) - ((n_1.x * ((cone_1.b * cone_1.g) / a_g)) * sines)) + ((n_1.y * ((cone_1.a * cone_1.g) / b_g)) * cosines));
}

vec4 ltc_cone_horizon(LtcCone cone_2) {
    vec2 _e12 = ltc_unit_turn(vec2((cone_2.a * cone_2.axes[0].z), (cone_2.b * cone_2.axes[1].z)));
    vec2 _e24 = ltc_unit_turn(vec2((-(cone_2.g) * cone_2.axes[2].z), sqrt(max(cone_2.cut2_, 0.0))));
    return vec4(_e12, _e24);
}

float ltc_cone_covered(LtcCone cone_3) {
    LtcBorder border_1 = LtcBorder(vec2(0.0), vec2(0.0), 0.0);
    if (!((cone_3.g > 0.0))) {
        return 0.0;
    }
    vec3 n_2 = vec3(cone_3.axes[0].z, cone_3.axes[1].z, cone_3.axes[2].z);
    float a_g_1 = sqrt(((cone_3.g * cone_3.g) + (cone_3.a * cone_3.a)));
    float b_g_1 = sqrt(((cone_3.g * cone_3.g) + (cone_3.b * cone_3.b)));
    float whole = ((cone_3.a / a_g_1) * (cone_3.b / b_g_1));
    if (!((cone_3.cut2_ > 0.0))) {
        return clamp(((cone_3.height > 0.0) ? (whole * n_2.z) : 0.0), 0.0, 1.0);
    }
    vec4 _e51 = ltc_cone_horizon(cone_3);
    vec2 top = _e51.xy;
    float q_3 = _e51.z;
    float h = _e51.w;
    border_1.sines = vec2(((2.0 * h) * top.x), ((((top.y * q_3) * top.y) * q_3) - (((top.x * h) * top.x) * h)));
    border_1.cosines = vec2(((-2.0 * h) * top.y), ((((top.x * q_3) * top.x) * q_3) - (((top.y * h) * top.y) * h)));
    border_1.turn = ((2.0 * q_3) * h);
    float across = ((((cone_3.b * cone_3.g) * abs((n_2.x * top.x))) + ((cone_3.a * cone_3.g) * abs((n_2.y * top.y)))) + ((cone_3.a * cone_3.b) * abs((n_2.z * q_3))));
    float _e127 = border_1.cosines.y;
    float _e135 = border_1.sines.y;
    float ahead = (((cone_3.g * cone_3.g) + ((cone_3.a * cone_3.a) * _e127)) + ((cone_3.b * cone_3.b) * _e135));
    LtcBorder _e138 = border_1;
    float _e139 = ltc_along(cone_3, _e138);
    float _e143 = ltc_atan2_(((2.0 * h) * across), ahead);
    return clamp(((_e139 + _e143) * 0.15915494), 0.0, 1.0);
}

float ltc_disk(LtcInverse inverse_2, vec3 centre_1, vec3 half_x_1, vec3 half_y_1, bool two_sided_3) {
    bool local_8 = false;
    bool local_9 = false;
    if (!((inverse_2.side == 0.0))) {
        if (!(two_sided_3)) {
            local_9 = !((dot(centre_1, cross(half_x_1, half_y_1)) < 0.0));
        } else {
            local_9 = false;
        }
        bool _e20 = local_9;
        local_8 = _e20;
    } else {
        local_8 = true;
    }
    bool _e22 = local_8;
    if (_e22) {
        return 0.0;
    }
    LtcCone _e30 = ltc_cone((inverse_2.m * centre_1), (inverse_2.m * half_x_1), (inverse_2.m * half_y_1));
    float _e31 = ltc_cone_covered(_e30);
    return _e31;
}

LtcCone ltc_sphere_cone(LtcInverse inverse_3, vec3 centre_2, float radius) {
    vec3 _e3 = ltc_unit(centre_2);
    float sine2_ = ((radius * radius) / max(dot(centre_2, centre_2), 1e-36));
    bool is_upright = (abs(_e3.z) > 0.7);
    vec3 _e23 = ltc_unit(cross((is_upright ? vec3(1.0, 0.0, 0.0) : vec3(0.0, 0.0, 1.0)), _e3));
    vec3 y_4 = cross(_e3, _e23);
    float sine = sqrt(sine2_);
    LtcCone _e40 = ltc_cone((inverse_3.m * (_e3 * sqrt(max((1.0 - sine2_), 0.0)))), (inverse_3.m * (_e23 * sine)), (inverse_3.m * (y_4 * sine)));
    return _e40;
}

float ltc_sphere(LtcInverse inverse_4, vec3 centre_3, float radius_1) {
    if ((inverse_4.side == 0.0)) {
        return 0.0;
    }
    if ((dot(centre_3, centre_3) <= (radius_1 * radius_1))) {
        return 1.0;
    }
    LtcCone _e11 = ltc_sphere_cone(inverse_4, centre_3, radius_1);
    float _e12 = ltc_cone_covered(_e11);
    return _e12;
}

float ltc_line(LtcInverse inverse_5, vec3 start, vec3 end, float width) {
    vec3 p = vec3(0.0);
    vec3 q = vec3(0.0);
    bool local_10 = false;
    bool local_11 = false;
    vec3 lit = cross(start, end);
    p = (inverse_5.m * start);
    q = (inverse_5.m * end);
    vec3 _e11 = p;
    vec3 _e12 = q;
    vec3 normal = cross(_e11, _e12);
    float area2_ = dot(normal, normal);
    if (!(!((area2_ > 1e-36)))) {
        float _e22 = p.z;
        if ((_e22 <= 0.0)) {
            float _e28 = q.z;
            local_11 = (_e28 <= 0.0);
        } else {
            local_11 = false;
        }
        bool _e32 = local_11;
        local_10 = _e32;
    } else {
        local_10 = true;
    }
    bool _e34 = local_10;
    if (_e34) {
        return 0.0;
    }
    vec3 _e36 = q;
    vec3 _e37 = p;
    vec3 along = (_e36 - _e37);
    float distance_ = sqrt(dot(along, along));
    float seen_1 = (((sqrt(dot(lit, lit)) * abs(determinant(inverse_5.m))) * distance_) / area2_);
    vec3 t_1 = (along / vec3(distance_));
    vec3 o = cross(t_1, (normal / vec3(sqrt(area2_))));
    float _e56 = p.z;
    if ((_e56 < 0.0)) {
        vec3 _e59 = p;
        float _e61 = q.z;
        vec3 _e63 = q;
        float _e65 = p.z;
        float _e69 = q.z;
        float _e71 = p.z;
        p = (((_e59 * _e61) - (_e63 * _e65)) / vec3((_e69 - _e71)));
    } else {
        float _e76 = q.z;
        if ((_e76 < 0.0)) {
            vec3 _e79 = p;
            float _e81 = q.z;
            vec3 _e83 = q;
            float _e85 = p.z;
            float _e89 = q.z;
            float _e91 = p.z;
            q = (((_e79 * _e81) - (_e83 * _e85)) / vec3((_e89 - _e91)));
        }
    }
    vec3 _e95 = p;
    vec3 _e97 = p;
    vec2 at_p = vec2(dot(_e95, o), dot(_e97, t_1));
    vec3 _e100 = q;
    vec3 _e102 = q;
    vec2 at_q = vec2(dot(_e100, o), dot(_e102, t_1));
    vec2 from_p = (at_p / vec2(max(sqrt(dot(at_p, at_p)), 1e-18)));
    vec2 from_q = (at_q / vec2(max(sqrt(dot(at_q, at_q)), 1e-18)));
    float sine_1 = abs(((from_p.x * from_q.y) - (from_p.y * from_q.x)));
    float _e126 = ltc_atan2_(sine_1, dot(from_p, from_q));
    vec2 sum_2 = vec2(((from_p.x * from_q.x) - (from_p.y * from_q.y)), ((from_p.y * from_q.x) + (from_p.x * from_q.y)));
    float integral = ((o.z * _e126) + (((o.z * sum_2.x) + (t_1.z * sum_2.y)) * sine_1));
    return clamp((((width * seen_1) * integral) * 0.15915494), 0.0, 1.0);
}

vec2 ltc_turn_of(LtcCone cone_4, vec3 direction) {
    vec2 _e13 = ltc_unit_turn(vec2((dot(direction, cone_4.axes[0]) * cone_4.b), (dot(direction, cone_4.axes[1]) * cone_4.a)));
    return _e13;
}

vec3 ltc_direction_of(LtcCone cone_5, vec2 turn_2) {
    return (cone_5.axes * vec3((cone_5.a * turn_2.x), (cone_5.b * turn_2.y), cone_5.g));
}

float ltc_round(vec2 first_1, vec2 second) {
    float sine_2 = ((first_1.x * second.y) - (first_1.y * second.x));
    float cosine = dot(first_1, second);
    return ((sine_2 < 0.0) ? (3.0 + cosine) : (1.0 - cosine));
}

float ltc_border(LtcCone cone_6, vec2 first_2, vec2 second_1, vec2 origin_1) {
    LtcBorder border_2 = LtcBorder(vec2(0.0), vec2(0.0), 0.0);
    vec3 _e4 = ltc_direction_of(cone_6, first_2);
    vec3 _e5 = ltc_unit(_e4);
    vec3 _e6 = ltc_direction_of(cone_6, second_1);
    vec3 _e7 = ltc_unit(_e6);
    vec2 u = (_e5.xy - origin_1);
    vec2 v_1 = (_e7.xy - origin_1);
    float moved = (((u.x * v_1.y) - (u.y * v_1.x)) - ((_e5.x * _e7.y) - (_e5.y * _e7.x)));
    border_2.sines = vec2((second_1.y - first_2.y), (first_2.y * second_1.y));
    border_2.cosines = vec2((second_1.x - first_2.x), (first_2.x * second_1.x));
    border_2.turn = ((first_2.x * second_1.y) - (first_2.y * second_1.x));
    LtcBorder _e52 = border_2;
    float _e53 = ltc_along(cone_6, _e52);
    return (_e53 + moved);
}

LtcClip ltc_clip_border(LtcClip clip_4, LtcCone cone_7, vec3 b_2) {
    LtcClip next_1 = LtcClip(0.0, vec2(0.0), vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0));
    vec2 first_3 = vec2(0.0);
    vec2 second_2 = vec2(0.0);
    bool local_12 = false;
    bool local_13 = false;
    bool local_14 = false;
    bool local_15 = false;
    bool local_16 = false;
    next_1 = clip_4;
    next_1.previous = b_2;
    vec3 _e6 = ltc_unit(b_2);
    next_1.previous_unit = _e6;
    vec2 _e8 = ltc_turn_of(cone_7, clip_4.previous);
    first_3 = _e8;
    vec2 _e10 = ltc_turn_of(cone_7, b_2);
    second_2 = _e10;
    if (!((cone_7.cut2_ > 0.0))) {
        if ((cone_7.height > 0.0)) {
            local_12 = (cone_7.g > 0.0);
        } else {
            local_12 = false;
        }
        bool _e25 = local_12;
        if (_e25) {
            float _e27 = next_1.sum;
            vec2 _e28 = first_3;
            vec2 _e29 = second_2;
            float _e31 = ltc_border(cone_7, _e28, _e29, clip_4.origin);
            next_1.sum = (_e27 + _e31);
        }
        LtcClip _e33 = next_1;
        return _e33;
    }
    vec4 _e34 = ltc_cone_horizon(cone_7);
    vec2 rise = vec2(((_e34.x * _e34.z) + (_e34.y * _e34.w)), ((_e34.y * _e34.z) - (_e34.x * _e34.w)));
    vec2 dip = vec2(((_e34.x * _e34.z) - (_e34.y * _e34.w)), ((_e34.y * _e34.z) + (_e34.x * _e34.w)));
    bool begins_up = (clip_4.previous.z > 0.0);
    bool ends_up = (b_2.z > 0.0);
    vec2 _e72 = first_3;
    vec2 _e73 = second_2;
    float _e74 = ltc_round(_e72, _e73);
    bool is_same = (begins_up == ends_up);
    vec2 _e76 = first_3;
    float _e77 = ltc_round(_e76, dip);
    bool leaves = (is_same ? (_e77 < _e74) : begins_up);
    vec2 _e80 = first_3;
    float _e81 = ltc_round(_e80, rise);
    bool enters = (is_same ? (_e81 < _e74) : ends_up);
    if (leaves) {
        vec3 _e85 = ltc_direction_of(cone_7, dip);
        vec3 _e86 = ltc_unit(_e85);
        next_1.leaves = _e86;
    }
    if (enters) {
        vec3 _e88 = ltc_direction_of(cone_7, rise);
        vec3 _e89 = ltc_unit(_e88);
        next_1.enters = _e89;
    }
    if (leaves) {
        local_13 = enters;
    } else {
        local_13 = false;
    }
    bool _e93 = local_13;
    if (_e93) {
        local_14 = begins_up;
    } else {
        local_14 = false;
    }
    bool _e97 = local_14;
    if (_e97) {
        float _e99 = next_1.sum;
        vec2 _e100 = first_3;
        float _e102 = ltc_border(cone_7, _e100, dip, clip_4.origin);
        vec2 _e103 = second_2;
        float _e105 = ltc_border(cone_7, rise, _e103, clip_4.origin);
        next_1.sum = (_e99 + (_e102 + _e105));
    } else {
        if (!(leaves)) {
            local_15 = enters;
        } else {
            local_15 = true;
        }
        bool _e112 = local_15;
        if (!(_e112)) {
            local_16 = begins_up;
        } else {
            local_16 = true;
        }
        bool _e117 = local_16;
        if (_e117) {
            vec2 _e118 = first_3;
            first_3 = (enters ? rise : _e118);
            vec2 _e120 = second_2;
            second_2 = (leaves ? dip : _e120);
            float _e123 = next_1.sum;
            vec2 _e124 = first_3;
            vec2 _e125 = second_2;
            float _e127 = ltc_border(cone_7, _e124, _e125, clip_4.origin);
            next_1.sum = (_e123 + _e127);
        }
    }
    LtcClip _e129 = next_1;
    return _e129;
}

float ltc_tube(LtcInverse inverse_6, vec3 start_1, vec3 end_1, float radius_2) {
    bool local_17 = false;
    LtcClip clip_5 = LtcClip(0.0, vec2(0.0), vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0));
    if ((inverse_6.side == 0.0)) {
        return 0.0;
    }
    vec3 along_1 = (end_1 - start_1);
    vec3 _e9 = ltc_unit(along_1);
    float distance_1 = sqrt(dot(along_1, along_1));
    vec3 nearest_1 = (start_1 + (_e9 * clamp(-(dot(start_1, _e9)), 0.0, distance_1)));
    if ((dot(nearest_1, nearest_1) <= (radius_2 * radius_2))) {
        return 1.0;
    }
    vec3 beside = (start_1 - (_e9 * dot(start_1, _e9)));
    float beside2_ = dot(beside, beside);
    if (!(!((distance_1 > 0.0)))) {
        local_17 = (beside2_ <= (radius_2 * radius_2));
    } else {
        local_17 = true;
    }
    bool _e35 = local_17;
    if (_e35) {
        LtcCone _e36 = ltc_sphere_cone(inverse_6, nearest_1, radius_2);
        float _e37 = ltc_cone_covered(_e36);
        return _e37;
    }
    vec3 towards = (beside * (radius_2 / beside2_));
    vec3 sideways = (cross(_e9, beside) * ((sqrt((beside2_ - (radius_2 * radius_2))) / beside2_) * inverse_6.side));
    vec3 left = ((towards + sideways) * radius_2);
    vec3 right = ((towards - sideways) * radius_2);
    vec3 last_2 = (inverse_6.m * (start_1 - right));
    LtcClip _e55 = ltc_clip_begin(last_2);
    clip_5 = _e55;
    LtcClip _e57 = clip_5;
    LtcClip _e61 = ltc_clip_edge(_e57, (inverse_6.m * (end_1 - right)));
    clip_5 = _e61;
    LtcClip _e62 = clip_5;
    LtcCone _e63 = ltc_sphere_cone(inverse_6, end_1, radius_2);
    LtcClip _e67 = ltc_clip_border(_e62, _e63, (inverse_6.m * (end_1 - left)));
    clip_5 = _e67;
    LtcClip _e68 = clip_5;
    LtcClip _e72 = ltc_clip_edge(_e68, (inverse_6.m * (start_1 - left)));
    clip_5 = _e72;
    LtcClip _e73 = clip_5;
    LtcCone _e74 = ltc_sphere_cone(inverse_6, start_1, radius_2);
    LtcClip _e75 = ltc_clip_border(_e73, _e74, last_2);
    clip_5 = _e75;
    LtcClip _e76 = clip_5;
    float _e79 = ltc_clip_finish(_e76, 1.0, false);
    return _e79;
}
