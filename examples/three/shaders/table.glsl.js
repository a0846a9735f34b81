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
//       Vertices are convex and run clockwise seen from the lit side. A rectangle may be a parallelogram; its last corner is not
//       read. A polygon of four vertices costs more. Disks, spheres, tubes and lines were left out by
//       --lights polygons.
//   Light of radiance L arrives as L (f0 (amplitude - fresnel) + f90 fresnel) covered.
//
// USE
//   ltc_lookup and ltc_inverse once for a point and view, then one call for each light. Isotropic surfaces have alpha_x =
//   alpha_y. Diffuse light is the albedo times one with the unit matrix for inverse.
//   A second table in the same shader needs names and bindings of its own: ltcforge shader --prefix --first-binding.
//
// BINDINGS OF A TABLE
//   uniform   36 words, nine vectors of four, which ltcforge export --for wgpu writes as ltc.json. Two of u32: how
//             many nodes alpha, ratio, theta and phi have; the layout's number, not read here
//             (reflected 1, kt2022 0, ltc2017 2, ltc2016 3, godot 4, hdrp 5, inverse 6, matrix33 7),
//             1 if ratio has the one node 1 and phi has one node, else 0, and 0, 0. Seven of f32: the first node of
//             each axis in the variable in which the layout's nodes are evenly spaced, the step between nodes in it
//             (1 for one node), and one over that; 1 / alpha_nodes, 1 / (ratio_nodes theta_nodes), theta_nodes,
//             1 / phi_nodes; the first and last alpha, the first and last ratio; the cosines of the last and first
//             theta, 0, 0; cosine and sine of the first phi, and of the last
//   matrix_a  3D texture, RGBA, 32 or 16 bit float: m00 m01 m02 m10 of each entry; m01 is row 0, column 1
//   matrix_b  likewise: m11 m12 m20 m21
//   terms     likewise: m22 amplitude fresnel 0; a table without terms has amplitude 1, fresnel 0
//   The textures are phi wide, ratio * theta high and alpha deep: texel (p, r * theta_nodes + t, a) is entry [a, r, t, p]
//   of the file's tensors.
//   Texels stand in the order of the file's entries, but their numbers have to be put together from its tensors
//   matrix, amplitude and fresnel. Alpha is the larger roughness, ratio the smaller over it, theta and phi the view
//   direction's angles in radians.
//   here      uniforms ltc_table.nodes and .reading, uvec4 each; ltc_table.start, .step, .per_step, .texel, .roughness,
//             .cosines and .azimuths, vec4 each; samplers ltc_matrix_a, ltc_matrix_b, ltc_terms
//   The entries are weighed here, texels are fetched: filter and wrap mode do not matter.
//
// CHECK
//   Of the table with the uniform nodes 3 2 3 3, start 0.23713738 0.17012542 0 0, step 0.3814313 0.8298746 0.39396363 0.75,
//   alpha and ratio 0.1 1 0.1 1, cosines 0.0707372 1, azimuths 1 0 0.0707372 0.997495,
//   whose entry number e = ((a * 2 + r) * 3 + t) * 3 + p has the numbers I[k] + e * (k + 1) / 1024,
//   k = 0 to 10: the nine of the matrix by rows, amplitude, fresnel; I = 1 0 0 0 1 0 0 0 1 1 0. All are exact in
//   16 bits. Covered is by the
//   one-sided rectangle (-1 -1 1) (1 -1 1) (1 1.5 -0.5) (-1 1.5 -0.5).
//   M is given by rows. A port in 32 bits comes within 0.00002 of each number.
//   alpha_x 0.3 alpha_y 0.15 wo (0.36 0.48 0.8)
//     M 0.460449 -0.021201 -0.351458 | -0.020871 0.466205 -0.490648 | 0.314199 0.420865 0.981290
//     amplitude 1.154364 fresnel 0.008354 covered 0.712543
//   alpha_x 0.2 alpha_y 0.6 wo (-0.64 0.48 0.6)
//     M 0.798057 0.021249 0.629628 | -0.092988 0.829957 -0.287235 | -1.017662 0.593832 1.070388
//     amplitude 1.231810 fresnel 0.131679 covered 0.649354
//   alpha_x 0.05 alpha_y 0.02 wo (0.576 -0.768 0.28)
//     M 0.024247 0.037322 -0.613512 | 0.044761 0.006612 0.824185 | 0.138496 -0.182740 0.329282
//     amplitude 1.062531 fresnel 0.367991 covered 0.960659


precision highp float;
precision highp int;

struct LtcTexels {
    vec4 a;
    vec4 b;
    vec4 terms;
};
struct LtcTable {
    uvec4 nodes;
    uvec4 reading;
    vec4 start;
    vec4 spacing;
    vec4 per_step;
    vec4 texel;
    vec4 roughness;
    vec4 cosines;
    vec4 azimuths;
};
struct LtcLobe {
    mat3x3 m;
    float amplitude;
    float fresnel;
};
struct LtcFold {
    float alpha;
    float ratio;
    vec3 wo;
    vec2 x;
    vec2 y;
};
struct LtcPlace {
    vec4 lower;
    vec4 weight;
};
struct LtcInverse {
    mat3x3 m;
    float side;
};
struct LtcClip {
    float sum;
    vec3 origin;
    vec3 previous;
    vec3 previous_unit;
    vec3 leaves;
    vec3 enters;
    vec3 flux;
    vec3 ahead;
};
const float LTC_LEAST_ALPHA = 1e-5;
const bool LTC_CHEAP_HORIZON = false;
const bool ltc_hardware_filter = false;

uniform highp sampler3D ltc_matrix_a;

uniform highp sampler3D ltc_matrix_b;

uniform highp sampler3D ltc_terms;

uniform LtcTable ltc_table;


vec2 ltc_quadrant(vec2 y, vec2 x) {
    vec2 t = ((y - x) / (y + x));
    vec2 z = (t * t);
    vec2 tail = ((((((0.0068118 * z) - vec2(0.0336042)) * z) + vec2(0.0796237)) * z) - vec2(0.1323334));
    return (vec2(0.7853982) + (t * ((((((tail * z) + vec2(0.1980782)) * z) - vec2(0.3331737)) * z) + vec2(0.9999961))));
}

LtcTexels ltc_fetch(uvec3 texel) {
    vec4 _e3 = texelFetch(ltc_matrix_a, ivec3(texel), 0);
    vec4 _e6 = texelFetch(ltc_matrix_b, ivec3(texel), 0);
    vec4 _e9 = texelFetch(ltc_terms, ivec3(texel), 0);
    return LtcTexels(_e3, _e6, _e9);
}

LtcFold ltc_fold(float alpha_x, float alpha_y, vec3 wo) {
    LtcFold fold = LtcFold(0.0, 0.0, vec3(0.0), vec2(0.0), vec2(0.0));
    vec2 towards = vec2(0.0);
    vec2 a_3 = max(vec2(alpha_x, alpha_y), vec2(1e-5));
    bool swap = (a_3.y > a_3.x);
    vec2 mirror = mix(vec2(1.0), vec2(-1.0), lessThan(wo.xy, vec2(0.0)));
    float larger = max(a_3.x, a_3.y);
    float _e27 = ltc_table.roughness.x;
    float _e31 = ltc_table.roughness.y;
    fold.alpha = clamp(larger, _e27, _e31);
    float _e41 = ltc_table.roughness.z;
    float _e45 = ltc_table.roughness.w;
    fold.ratio = clamp((min(a_3.x, a_3.y) / larger), _e41, _e45);
    fold.x = (swap ? vec2(0.0, mirror.y) : vec2(mirror.x, 0.0));
    fold.y = (swap ? vec2(mirror.x, 0.0) : vec2(0.0, mirror.y));
    vec2 flat_ = ((swap ? abs(wo.yx) : abs(wo.xy)) + vec2(1e-18, 0.0));
    float per_size = inversesqrt(dot(flat_, flat_));
    vec2 ahead = (flat_ * per_size);
    vec4 _e77 = ltc_table.azimuths;
    vec2 first = _e77.xy;
    vec4 _e81 = ltc_table.azimuths;
    vec2 last = _e81.zw;
    towards = ahead;
    if (((first.x * ahead.y) < (first.y * ahead.x))) {
        towards = first;
    }
    if (((last.x * ahead.y) > (last.y * ahead.x))) {
        towards = last;
    }
    float _e102 = ltc_table.cosines.x;
    float _e106 = ltc_table.cosines.y;
    float height = clamp(wo.z, _e102, _e106);
    float size = ((height == wo.z) ? dot(flat_, ahead) : sqrt((1.0 - (height * height))));
    vec2 _e117 = towards;
    fold.wo = vec3((_e117 * size), height);
    uint _e123 = ltc_table.reading.y;
    if ((_e123 == 1u)) {
        vec2 turn = vec2(dot(first, ahead), ((first.x * ahead.y) - (first.y * ahead.x)));
        vec2 x_2 = fold.x;
        vec2 _e142 = fold.y;
        fold.x = ((turn.x * x_2) + (turn.y * _e142));
        vec2 _e148 = fold.y;
        fold.y = ((turn.x * _e148) - (turn.y * x_2));
    }
    LtcFold _e153 = fold;
    return _e153;
}

LtcPlace ltc_place(vec4 steps) {
    uvec4 _e3 = ltc_table.nodes;
    vec4 most = max((vec4(_e3) - vec4(2.0)), vec4(0.0));
    vec4 _e13 = ltc_table.start;
    vec4 _e17 = ltc_table.per_step;
    vec4 at = ((steps - _e13) * _e17);
    vec4 lower_1 = clamp(floor(at), vec4(0.0), most);
    return LtcPlace(lower_1, clamp((at - lower_1), vec4(0.0), vec4(1.0)));
}

LtcTexels ltc_fetch_weighed(vec4 lower, vec4 upper) {
    LtcTexels sum = LtcTexels(vec4(0.0), vec4(0.0), vec4(0.0));
    uint corner = 0u;
    uvec4 first_1 = uvec4(lower);
    uvec4 _e13 = ltc_table.nodes;
    uvec4 last_1 = (_e13 - uvec4(1u));
    bool loop_init = true;
    while(true) {
        if (!loop_init) {
            uint _e77 = corner;
            corner = (_e77 + 1u);
        }
        loop_init = false;
        uint _e19 = corner;
        if ((_e19 < 16u)) {
        } else {
            break;
        }
        {
            uint _e22 = corner;
            uvec4 step_ = ((uvec4(_e22) >> uvec4(3u, 2u, 1u, 0u)) & uvec4(1u));
            vec4 weights = mix((vec4(1.0) - upper), upper, equal(step_, uvec4(1u)));
            float weight = (((weights.x * weights.y) * weights.z) * weights.w);
            uvec4 entry = min((first_1 + step_), last_1);
            uint _e54 = ltc_table.nodes.z;
            LtcTexels _e60 = ltc_fetch(uvec3(entry.w, ((entry.y * _e54) + entry.z), entry.x));
            vec4 _e62 = sum.a;
            sum.a = (_e62 + (weight * _e60.a));
            vec4 _e67 = sum.b;
            sum.b = (_e67 + (weight * _e60.b));
            vec4 _e72 = sum.terms;
            sum.terms = (_e72 + (weight * _e60.terms));
        }
    }
    LtcTexels _e79 = sum;
    return _e79;
}

LtcPlace ltc_place_reflected(float alpha, float ratio, vec3 wo_1) {
    LtcPlace place = LtcPlace(vec4(0.0), vec4(0.0));
    vec2 _e10 = ltc_quadrant(vec2(length(wo_1.xy), wo_1.y), vec2(wo_1.z, wo_1.x));
    float theta = (0.63668346 * _e10.x);
    vec2 powers = vec2(1.6, 1.3);
    vec2 surface = vec2(alpha, ratio);
    LtcPlace _e31 = ltc_place(vec4(pow(surface, vec2(0.625, 0.7692308)), (1.0 - sqrt(max((1.0 - theta), 0.0))), _e10.y));
    place = _e31;
    vec4 _e35 = ltc_table.start;
    vec4 _e38 = place.lower;
    vec4 _e42 = ltc_table.spacing;
    vec3 below = (_e35.xyz + (_e38.xyz * _e42.xyz));
    vec4 _e48 = ltc_table.spacing;
    vec3 above = (below + _e48.xyz);
    vec3 low = vec3(pow(below.xy, powers), ((2.0 - below.z) * below.z));
    vec3 high = vec3(pow(above.xy, powers), ((2.0 - above.z) * above.z));
    vec3 weight_1 = clamp(((vec3(surface, theta) - low) / (high - low)), vec3(0.0), vec3(1.0));
    float _e79 = place.weight.w;
    place.weight = vec4(weight_1, _e79);
    LtcPlace _e81 = place;
    return _e81;
}

LtcPlace ltc_place_of(float alpha_1, float ratio_1, vec3 wo_2) {
    LtcPlace _e3 = ltc_place_reflected(alpha_1, ratio_1, wo_2);
    return _e3;
}

LtcLobe ltc_restore_reflected(LtcLobe stored, float alpha_x_1, float ratio_2, vec3 wo_3) {
    vec3 alpha_3 = vec3(alpha_x_1, max((alpha_x_1 * ratio_2), LTC_LEAST_ALPHA), 1.0);
    vec3 seen = (alpha_3 * wo_3);
    float seen2_ = dot(seen, seen);
    float per_seen = inversesqrt(seen2_);
    vec3 wm = normalize((alpha_3 * ((seen * per_seen) + vec3(0.0, 0.0, 1.0))));
    float d = dot(wo_3, wm);
    vec3 reflected = (((2.0 * d) * wm) - wo_3);
    mat3x3 s = stored.m;
    vec2 x_3 = ((2.0 * alpha_x_1) * s[0].xy);
    vec2 y_2 = ((2.0 * alpha_x_1) * s[1].xy);
    vec2 z_1 = ((2.0 * alpha_x_1) * s[2].xy);
    mat3x3 m_1 = mat3x3(((vec3((d * x_3), 0.0) - (dot(reflected.xy, x_3) * wm)) + (s[0].z * reflected)), ((vec3((d * y_2), 0.0) - (dot(reflected.xy, y_2) * wm)) + (s[1].z * reflected)), ((vec3((d * z_1), 0.0) - (dot(reflected.xy, z_1) * wm)) + (s[2].z * reflected)));
    vec3 out_ = (alpha_3 * reflected);
    float height_1 = abs(reflected.z);
    float size_1 = (seen2_ * per_seen);
    float g2_over_g1_ = ((height_1 * (size_1 + wo_3.z)) / max(((height_1 * size_1) + (wo_3.z * sqrt(dot(out_, out_)))), 1e-30));
    float amplitude = ((stored.amplitude * g2_over_g1_) * g2_over_g1_);
    float grazing = max(((stored.fresnel + 1.0) - d), 0.0);
    float grazing2_ = (grazing * grazing);
    return LtcLobe(m_1, amplitude, (amplitude * ((grazing2_ * grazing2_) * grazing)));
}

LtcLobe ltc_restore(LtcLobe stored_1, float alpha_2, float ratio_3, vec3 wo_4) {
    LtcLobe _e4 = ltc_restore_reflected(stored_1, alpha_2, ratio_3, wo_4);
    return _e4;
}

LtcLobe ltc_lookup(float alpha_x_2, float alpha_y_1, vec3 wo_5) {
    LtcTexels texels = LtcTexels(vec4(0.0), vec4(0.0), vec4(0.0));
    LtcLobe lobe = LtcLobe(mat3x3(0.0), 0.0, 0.0);
    LtcFold _e3 = ltc_fold(alpha_x_2, alpha_y_1, wo_5);
    LtcPlace _e7 = ltc_place_of(_e3.alpha, _e3.ratio, _e3.wo);
    LtcTexels _e11 = ltc_fetch_weighed(_e7.lower, _e7.weight);
    texels = _e11;
    vec4 _e13 = texels.a;
    float _e17 = texels.a.w;
    vec4 _e19 = texels.b;
    vec4 _e23 = texels.b;
    float _e27 = texels.terms.x;
    mat3x3 stored_2 = transpose(mat3x3(_e13.xyz, vec3(_e17, _e19.xy), vec3(_e23.zw, _e27)));
    float _e33 = texels.terms.y;
    float _e36 = texels.terms.z;
    LtcLobe _e41 = ltc_restore(LtcLobe(stored_2, _e33, _e36), _e3.alpha, _e3.ratio, _e3.wo);
    lobe = _e41;
    mat3x3 m_2 = lobe.m;
    vec3 x_4 = vec3(((_e3.x * m_2[0].x) + (_e3.y * m_2[0].y)), m_2[0].z);
    vec3 y_3 = vec3(((_e3.x * m_2[1].x) + (_e3.y * m_2[1].y)), m_2[1].z);
    vec3 z_2 = vec3(((_e3.x * m_2[2].x) + (_e3.y * m_2[2].y)), m_2[2].z);
    lobe.m = mat3x3(((x_4 * _e3.x.x) + (y_3 * _e3.y.x)), ((x_4 * _e3.x.y) + (y_3 * _e3.y.y)), z_2);
    LtcLobe _e97 = lobe;
    return _e97;
}

LtcInverse ltc_inverse(mat3x3 m) {
    bool local = false;
    vec3 x_5 = cross(m[1], m[2]);
    vec3 y_4 = cross(m[2], m[0]);
    vec3 z_3 = cross(m[0], m[1]);
    vec3 most_1 = max(max(abs(x_5), abs(y_4)), abs(z_3));
    float largest = max(max(most_1.x, most_1.y), most_1.z);
    if ((largest > 1e-30)) {
        local = (largest < 1e30);
    } else {
        local = false;
    }
    bool _e30 = local;
    float side_1 = (_e30 ? sign(dot(m[2], z_3)) : 0.0);
    float scale = (side_1 / max(largest, 1e-30));
    return LtcInverse(transpose(mat3x3((x_5 * scale), (y_4 * scale), (z_3 * scale))), side_1);
}

vec3 ltc_unit(vec3 v) {
    return (v * inversesqrt((dot(v, v) + 1e-36)));
}

float ltc_bend(vec3 a, vec3 b) {
    vec3 sum_1 = (a + b);
    float k = (dot(sum_1, sum_1) + 1e-18);
    return (((3.1415927 + ((0.3824614 + (0.0361113 * k)) * k)) * inversesqrt(k)) - (1.9987369 + ((0.1384879 + (0.0044966 * k)) * k)));
}

float ltc_arc(vec3 a_1, vec3 b_1) {
    float _e9 = ltc_bend(a_1, b_1);
    return (((a_1.x * b_1.y) - (a_1.y * b_1.x)) * _e9);
}

float ltc_chord(vec3 a_2, vec3 b_2, vec3 origin) {
    vec2 p = (a_2.xy - origin.xy);
    vec2 q = (b_2.xy - origin.xy);
    return ((p.x * q.y) - (p.y * q.x));
}

LtcClip ltc_clip_begin(vec3 vertex) {
    vec3 _e1 = ltc_unit(vertex);
    return LtcClip(0.0, _e1, vertex, _e1, vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0));
}

LtcClip ltc_clip_edge(LtcClip clip, vec3 b_3) {
    LtcClip next = LtcClip(0.0, vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0));
    vec3 from_point = vec3(0.0);
    vec3 to_point = vec3(0.0);
    bool local_1 = false;
    bool local_2 = false;
    bool local_3 = false;
    next = clip;
    vec3 a_4 = clip.previous;
    next.previous = b_3;
    vec3 _e6 = ltc_unit(b_3);
    next.previous_unit = _e6;
    from_point = clip.previous_unit;
    vec3 _e14 = next.previous_unit;
    to_point = _e14;
    if ((a_4.z > 0.0)) {
        local_1 = (b_3.z <= 0.0);
    } else {
        local_1 = false;
    }
    bool _e25 = local_1;
    if (_e25) {
        vec3 _e36 = ltc_unit(vec3(((b_3.xy * a_4.z) - (a_4.xy * b_3.z)), 0.0));
        next.leaves = _e36;
        vec3 _e38 = next.leaves;
        to_point = _e38;
    }
    if ((a_4.z <= 0.0)) {
        local_2 = (b_3.z > 0.0);
    } else {
        local_2 = false;
    }
    bool _e48 = local_2;
    if (_e48) {
        vec3 _e59 = ltc_unit(vec3(((a_4.xy * b_3.z) - (b_3.xy * a_4.z)), 0.0));
        next.enters = _e59;
        vec3 _e61 = next.enters;
        from_point = _e61;
    }
    if (!((a_4.z > 0.0))) {
        local_3 = (b_3.z > 0.0);
    } else {
        local_3 = true;
    }
    bool _e72 = local_3;
    if (_e72) {
        float _e74 = next.sum;
        vec3 _e75 = from_point;
        vec3 _e76 = to_point;
        float _e78 = ltc_chord(_e75, _e76, clip.origin);
        vec3 _e79 = from_point;
        vec3 _e80 = to_point;
        float _e81 = ltc_arc(_e79, _e80);
        next.sum = (_e74 + (_e78 + _e81));
    }
    LtcClip _e84 = next;
    return _e84;
}

float ltc_clip_finish(LtcClip clip_1, float side, bool two_sided) {
    bool local_4 = false;
    bool local_5 = false;
    bool is_cut = any(notEqual(clip_1.leaves, clip_1.enters));
    float _e40 = ltc_chord(clip_1.leaves, clip_1.enters, clip_1.origin);
    float _e43 = ltc_arc(clip_1.leaves, clip_1.enters);
    float closing = (is_cut ? (_e40 + _e43) : 0.0);
    float sum_2 = (((clip_1.sum + closing) * 0.15915494) * side);
    return clamp((two_sided ? abs(sum_2) : sum_2), 0.0, 1.0);
}

float ltc_rectangle(LtcInverse inverse_, vec3 corners[4], bool two_sided_1) {
    vec3 x_1 = vec3(0.0);
    vec3 y_1 = vec3(0.0);
    x_1 = (inverse_.m * (corners[1] - corners[0]));
    y_1 = (inverse_.m * (corners[2] - corners[1]));
    float _e16 = x_1.z;
    float _e18 = y_1.z;
    bvec2 falls = lessThan(vec2(_e16, _e18), vec2(0.0));
    vec2 turn_1 = mix(vec2(1.0), vec2(-1.0), falls);
    vec3 _e28 = x_1;
    x_1 = (_e28 * turn_1.x);
    vec3 _e31 = y_1;
    y_1 = (_e31 * turn_1.y);
    vec3 _e37 = x_1;
    vec3 _e45 = y_1;
    vec3 lowest = (((inverse_.m * corners[0]) + (_e37 * ((0.5 * turn_1.x) - 0.5))) + (_e45 * ((0.5 * turn_1.y) - 0.5)));
    vec3 _e53 = x_1;
    vec3 a_5 = (lowest + _e53);
    vec3 _e55 = y_1;
    vec3 b_4 = (lowest + _e55);
    vec3 _e57 = y_1;
    vec3 highest = (a_5 + _e57);
    float _e60 = x_1.z;
    float _e62 = y_1.z;
    vec2 per_height = (vec2(1.0) / max(vec2(_e60, _e62), vec2(1e-36)));
    vec2 low_1 = clamp((-(lowest.z) * per_height), vec2(0.0), vec2(1.0));
    float last_x = clamp((-(b_4.z) * per_height.x), 0.0, 1.0);
    float last_y = clamp((-(a_5.z) * per_height.y), 0.0, 1.0);
    vec3 _e93 = y_1;
    vec3 _e96 = x_1;
    vec3 _e99 = ltc_unit(((lowest + (low_1.y * _e93)) + (last_x * _e96)));
    vec3 _e101 = x_1;
    vec3 _e104 = y_1;
    vec3 _e107 = ltc_unit(((lowest + (low_1.x * _e101)) + (last_y * _e104)));
    vec3 _e108 = y_1;
    vec3 _e111 = ltc_unit((a_5 + (last_y * _e108)));
    vec3 _e112 = ltc_unit(highest);
    vec3 _e113 = x_1;
    vec3 _e116 = ltc_unit((b_4 + (last_x * _e113)));
    float _e117 = ltc_chord(_e116, _e99, _e112);
    float _e118 = ltc_chord(_e99, _e107, _e112);
    float _e120 = ltc_chord(_e107, _e111, _e112);
    float _e122 = ltc_arc(_e99, _e107);
    float _e124 = ltc_arc(_e107, _e111);
    float _e126 = ltc_arc(_e111, _e112);
    float _e128 = ltc_arc(_e112, _e116);
    float _e130 = ltc_arc(_e116, _e99);
    float sum_3 = (((((((_e117 + _e118) + _e120) + _e122) + _e124) + _e126) + _e128) + _e130);
    float covered = ((sum_3 * 0.15915494) * ((inverse_.side * turn_1.x) * turn_1.y));
    return ((highest.z > 0.0) ? clamp((two_sided_1 ? abs(covered) : covered), 0.0, 1.0) : 0.0);
}

float ltc_polygon(LtcInverse inverse_1, vec3 vertices_1[8], uint count, bool two_sided_2) {
    vec3 outline[8] = vec3[8](vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0));
    LtcClip clip_2 = LtcClip(0.0, vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0));
    uint i = 0u;
    outline = vertices_1;
    uint number = min(max(count, 3u), 8u);
    vec3 _e12 = outline[(number - 1u)];
    LtcClip _e14 = ltc_clip_begin((inverse_1.m * _e12));
    clip_2 = _e14;
    bool loop_init_1 = true;
    while(true) {
        if (!loop_init_1) {
            uint _e31 = i;
            i = (_e31 + 1u);
        }
        loop_init_1 = false;
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
            LtcClip _e23 = clip_2;
            uint _e25 = i;
            vec3 _e27 = outline[_e25];
            LtcClip _e29 = ltc_clip_edge(_e23, (inverse_1.m * _e27));
            clip_2 = _e29;
        }
    }
    LtcClip _e33 = clip_2;
    float _e35 = ltc_clip_finish(_e33, inverse_1.side, two_sided_2);
    return _e35;
}
`;
