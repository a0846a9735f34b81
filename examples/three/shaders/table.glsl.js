export default /* glsl */ `// Linearly Transformed Cosines: area lights on anisotropic GGX, by a table that ltcforge fitted.
// Made by ltcforge 0.1.0. SPDX-License-Identifier: MIT OR Apache-2.0
//
// Reads tables of layout reflected, and takes every table for one.
//
// FUNCTIONS
//   ltc_lookup(alpha_x, alpha_y, wo)  M, amplitude and fresnel. GGX roughness along x and y; wo is the view direction in
//       the tangent frame, normal +z, of unit length. M maps the clamped cosine to the lobe, in that frame.
//   ltc_inverse(M)                    the inverse up to a factor, for all lights at the point.
//   ltc_rectangle(inverse, corners, two_sided), ltc_polygon(inverse, vertices, count, two_sided)
//       the part of the lobe that a light covers, 0 to 1. All is relative to the shaded point, in the tangent frame.
//       Vertices are convex and run clockwise seen from the lit side. Disks, spheres, tubes and lines were left out by
//       --lights polygons.
//   Light of radiance L arrives as L (f0 (amplitude - fresnel) + f90 fresnel) covered.
//
// USE
//   ltc_lookup and ltc_inverse once for a point and view, then one call for each light. Isotropic surfaces have alpha_x =
//   alpha_y. Diffuse light is the albedo times one with the unit matrix for inverse.
//   A second table in the same shader needs names and bindings of its own: ltcforge shader --prefix --first-binding.
//
// BINDINGS OF A TABLE
//   uniform   8 x u32: how many nodes alpha, ratio, theta and phi have; the layout's number, not read here
//             (reflected 1, kt2022 0, ltc2017 2, ltc2016 3, godot 4, hdrp 5, inverse 6, matrix33 7);
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
    vec3 flux;
    vec3 ahead;
};
const float LTC_LEAST_ALPHA = 1e-5;
const uint LTC_MOST_HALVINGS = 14u;
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
    float x_3 = ((turns - (0.25 * quarter_1)) * 6.2831855);
    float z_1 = (x_3 * x_3);
    float s = (((((((-0.00019515296 * z_1) + 0.008332161) * z_1) - 0.16666655) * z_1) * x_3) + x_3);
    float c = ((((((((2.4433157e-5 * z_1) - 0.0013887316) * z_1) + 0.041666646) * z_1) * z_1) - (0.5 * z_1)) + 1.0);
    uint q = (uint(int(quarter_1)) & 3u);
    vec2 swapped = (((q & 1u) == 1u) ? vec2(c, s) : vec2(s, c));
    if (!((q == 1u))) {
        local = (q == 2u);
    } else {
        local = true;
    }
    bool _e64 = local;
    return vec2(((q >= 2u) ? -(swapped.x) : swapped.x), (_e64 ? -(swapped.y) : swapped.y));
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
    vec2 a_2 = max(vec2(alpha_x, alpha_y), vec2(1e-5));
    bool swap = (a_2.y > a_2.x);
    vec2 flat_ = abs(wo.xy);
    fold.alpha = max(a_2.x, a_2.y);
    float _e22 = fold.alpha;
    fold.ratio = (min(a_2.x, a_2.y) / _e22);
    float _e28 = ltc_atan2_(sqrt(dot(flat_, flat_)), wo.z);
    fold.theta = min(_e28, 1.5707964);
    float _e38 = ltc_atan2_((swap ? flat_.x : flat_.y), (swap ? flat_.y : flat_.x));
    fold.phi = _e38;
    fold.mirror = mix(vec2(1.0), vec2(-1.0), lessThan(wo.xy, vec2(0.0)));
    fold.swap = swap;
    LtcFold _e50 = fold;
    return _e50;
}

float ltc_even(uint axis, float x_1) {
    return x_1;
}

LtcPlace ltc_between(uint axis_1, uint first, uint count, float x_2) {
    uint lower = 0u;
    float below = 0.0;
    uint span = 0u;
    uint halving = 0u;
    float _e6 = ltc_node(first);
    below = _e6;
    span = count;
    bool loop_init = true;
    while(true) {
        if (!loop_init) {
            uint _e35 = halving;
            halving = (_e35 + 1u);
        }
        loop_init = false;
        uint _e11 = halving;
        if ((_e11 < LTC_MOST_HALVINGS)) {
        } else {
            break;
        }
        {
            uint _e14 = span;
            if ((_e14 <= 1u)) {
                break;
            }
            uint _e17 = span;
            uint part = (_e17 / 2u);
            uint _e20 = lower;
            float _e23 = ltc_node(((first + _e20) + part));
            uint _e24 = lower;
            uint _e25 = lower;
            lower = ((_e23 <= x_2) ? (_e25 + part) : _e24);
            float _e29 = below;
            below = ((_e23 <= x_2) ? _e23 : _e29);
            uint _e32 = span;
            span = (_e32 - part);
        }
    }
    uint _e37 = lower;
    float _e44 = ltc_node((first + min((_e37 + 1u), (count - 1u))));
    float _e45 = below;
    float nearest = clamp(x_2, _e45, _e44);
    float _e47 = below;
    float _e48 = ltc_even(axis_1, _e47);
    float _e49 = ltc_even(axis_1, _e44);
    float step_ = (_e49 - _e48);
    uint _e51 = lower;
    float _e52 = ltc_even(axis_1, nearest);
    float _e55 = below;
    return LtcPlace(_e51, ((_e44 > _e55) ? ((_e52 - _e48) / step_) : 0.0), nearest);
}

LtcTexels ltc_fetch_weighed(LtcPlace alpha, LtcPlace ratio, LtcPlace theta, LtcPlace phi) {
    LtcTexels sum = LtcTexels(vec4(0.0), vec4(0.0), vec4(0.0));
    uint corner = 0u;
    uvec4 _e14 = ltc_table.nodes;
    uvec4 last = (_e14 - uvec4(1u));
    uvec4 lower_1 = uvec4(alpha.lower, ratio.lower, theta.lower, phi.lower);
    vec4 upper = vec4(alpha.weight, ratio.weight, theta.weight, phi.weight);
    bool loop_init_1 = true;
    while(true) {
        if (!loop_init_1) {
            uint _e88 = corner;
            corner = (_e88 + 1u);
        }
        loop_init_1 = false;
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
            uvec4 entry = min((lower_1 + step_1), last);
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
    mat3x3 k = mat3x3((alpha_x_2 * _e35), (alpha_x_2 * _e41), reflected);
    float _e44 = ltc_smith_lambda(alpha_x_2, alpha_y_3, wo_2);
    float seen = (1.0 + _e44);
    float _e47 = ltc_smith_lambda(alpha_x_2, alpha_y_3, reflected);
    float g2_over_g1_ = (seen / (seen + _e47));
    float amplitude = ((stored.amplitude * g2_over_g1_) * g2_over_g1_);
    float grazing = max(((stored.fresnel + 1.0) - d_1), 0.0);
    float grazing2_ = (grazing * grazing);
    return LtcLobe((k * stored.m), amplitude, (amplitude * ((grazing2_ * grazing2_) * grazing)));
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
    vec3 x_4 = cross(m_2[1], m_2[2]);
    vec3 y_1 = cross(m_2[2], m_2[0]);
    vec3 z_2 = cross(m_2[0], m_2[1]);
    vec3 most = max(max(abs(x_4), abs(y_1)), abs(z_2));
    float largest = max(max(most.x, most.y), most.z);
    float side_1 = sign(dot(m_2[2], z_2));
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
    return LtcInverse(transpose(mat3x3((x_4 * scale), (y_1 * scale), (z_2 * scale))), side_1);
}

vec3 ltc_unit(vec3 v) {
    float length2_ = dot(v, v);
    return ((length2_ > 1e-36) ? (v / vec3(sqrt(max(length2_, 1e-36)))) : vec3(0.0));
}

float ltc_bend(vec3 a, vec3 b) {
    vec3 c_1 = cross(a, b);
    float s_1 = sqrt(dot(c_1, c_1));
    float _e6 = ltc_atan2_(s_1, dot(a, b));
    return ((s_1 > 1e-18) ? ((_e6 / max(s_1, 1e-18)) - 1.0) : 0.0);
}

float ltc_arc(vec3 a_1, vec3 b_1, vec2 origin) {
    vec2 p = (a_1.xy - origin);
    vec2 q_1 = (b_1.xy - origin);
    float _e16 = ltc_bend(a_1, b_1);
    return (((p.x * q_1.y) - (p.y * q_1.x)) + (cross(a_1, b_1).z * _e16));
}

LtcClip ltc_clip_begin(vec3 vertex) {
    vec3 _e1 = ltc_unit(vertex);
    return LtcClip(0.0, _e1.xy, vertex, _e1, vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0));
}

LtcClip ltc_clip_edge(LtcClip clip, vec3 b_2) {
    LtcClip next = LtcClip(0.0, vec2(0.0), vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0));
    vec3 from_point = vec3(0.0);
    vec3 to_point = vec3(0.0);
    bool local_3 = false;
    bool local_4 = false;
    bool local_5 = false;
    next = clip;
    vec3 a_3 = clip.previous;
    next.previous = b_2;
    vec3 _e6 = ltc_unit(b_2);
    next.previous_unit = _e6;
    from_point = clip.previous_unit;
    vec3 _e14 = next.previous_unit;
    to_point = _e14;
    if ((a_3.z > 0.0)) {
        local_3 = (b_2.z <= 0.0);
    } else {
        local_3 = false;
    }
    bool _e25 = local_3;
    if (_e25) {
        vec3 _e36 = ltc_unit(vec3(((b_2.xy * a_3.z) - (a_3.xy * b_2.z)), 0.0));
        next.leaves = _e36;
        vec3 _e38 = next.leaves;
        to_point = _e38;
    }
    if ((a_3.z <= 0.0)) {
        local_4 = (b_2.z > 0.0);
    } else {
        local_4 = false;
    }
    bool _e48 = local_4;
    if (_e48) {
        vec3 _e59 = ltc_unit(vec3(((a_3.xy * b_2.z) - (b_2.xy * a_3.z)), 0.0));
        next.enters = _e59;
        vec3 _e61 = next.enters;
        from_point = _e61;
    }
    if (!((a_3.z > 0.0))) {
        local_5 = (b_2.z > 0.0);
    } else {
        local_5 = true;
    }
    bool _e72 = local_5;
    if (_e72) {
        float _e74 = next.sum;
        vec3 _e75 = from_point;
        vec3 _e76 = to_point;
        float _e78 = ltc_arc(_e75, _e76, clip.origin);
        next.sum = (_e74 + _e78);
    }
    LtcClip _e80 = next;
    return _e80;
}

float ltc_clip_finish(LtcClip clip_1, float side, bool two_sided) {
    bool local_6 = false;
    bool local_7 = false;
    bool is_cut = any(notEqual(clip_1.leaves, clip_1.enters));
    float _e40 = ltc_arc(clip_1.leaves, clip_1.enters, clip_1.origin);
    float closing = (is_cut ? _e40 : 0.0);
    float sum_1 = (((clip_1.sum + closing) * 0.15915494) * side);
    return clamp((two_sided ? abs(sum_1) : sum_1), 0.0, 1.0);
}

float ltc_rectangle(LtcInverse inverse_, vec3 corners[4], bool two_sided_1) {
    LtcClip clip_2 = LtcClip(0.0, vec2(0.0), vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0));
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
    LtcClip clip_3 = LtcClip(0.0, vec2(0.0), vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0));
    uint i = 0u;
    outline = vertices_1;
    uint number = min(max(count_1, 3u), 8u);
    vec3 _e12 = outline[(number - 1u)];
    LtcClip _e14 = ltc_clip_begin((inverse_1.m * _e12));
    clip_3 = _e14;
    bool loop_init_2 = true;
    while(true) {
        if (!loop_init_2) {
            uint _e31 = i;
            i = (_e31 + 1u);
        }
        loop_init_2 = false;
        uint _e18 = i;
        if ((_e18 < 8u)) {
        } else {
            break;
        }
        {
            uint _e21 = i;
            if ((_e21 >= number)) {
                break;
            }
            LtcClip _e23 = clip_3;
            uint _e25 = i;
            vec3 _e27 = outline[_e25];
            LtcClip _e29 = ltc_clip_edge(_e23, (inverse_1.m * _e27));
            clip_3 = _e29;
        }
    }
    LtcClip _e33 = clip_3;
    float _e35 = ltc_clip_finish(_e33, inverse_1.side, two_sided_2);
    return _e35;
}
`;
