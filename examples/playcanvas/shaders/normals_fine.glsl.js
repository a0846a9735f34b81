export default /* glsl */ `// SPDX-License-Identifier: MIT OR Apache-2.0
// Area lights on GGX without a table, in the space of its normals, by rule fine. Made by ltcforge 0.1.0.
//
//   normals_view(alpha_x, alpha_y, wo)  once for a point and view: roughness, and the view in the tangent frame, normal +z.
//   normals_rectangle, normals_polygon, normals_disk  for each light. Vertices are relative to the point in that frame and
//       run clockwise seen from the lit side. Light of radiance L arrives as L (f0 (x - y) + f90 y).
//
// CHECK of the rectangle (-1 -1 1) (1 -1 1) (1 1.5 -0.5) (-1 1.5 -0.5), alpha_x alpha_y (wo): x y, within 0.00002
//   0.3 0.15 (0.36 0.48 0.8): 0.702634 0.000353
//   0.2 0.6 (-0.64 0.48 0.6): 0.558645 0.001520
//   0.05 0.02 (0.576 -0.768 0.28): 0.989715 0.186722


precision highp float;
precision highp int;

struct NormalsView {
    vec2 alpha;
    vec2 per_alpha;
    vec3 wo;
    vec3 image;
    vec3 stretched;
    float length_;
    float rise;
};
struct NormalsCorner {
    vec3 w;
    vec3 image;
    vec3 c;
    float length_;
};
struct NormalsTip {
    vec3 c;
    float part;
    float side;
    vec4 shared_inputs;
};
struct NormalsSum {
    vec2 signed;
    vec3 sizes;
};
struct NormalsSide {
    NormalsCorner begin;
    NormalsCorner end;
};

NormalsView normals_view(float alpha_x, float alpha_y, vec3 wo) {
    vec2 alpha = max(vec2(alpha_x, alpha_y), vec2(1e-5));
    vec3 stretched = vec3((alpha * wo.xy), wo.z);
    float length_ = sqrt(dot(stretched, stretched));
    return NormalsView(alpha, (vec2(1.0) / alpha), wo, vec3((wo.xy / alpha), wo.z), stretched, length_, (wo.z / length_));
}

float normals_per_length(vec3 v) {
    return inversesqrt(((v.x * v.x) + ((v.y * v.y) + ((v.z * v.z) + 1e-30))));
}

float normals_rise(NormalsView view, vec3 w) {
    float _e10 = normals_per_length(vec3((view.alpha * w.xy), w.z));
    return (max(w.z, 0.0) * _e10);
}

float normals_weight_of(NormalsView view_1, float rise) {
    return (((1.0 + view_1.rise) * rise) / (rise + view_1.rise));
}

vec2 normals_weight(NormalsView view_2, vec3 c) {
    vec3 normal = vec3((view_2.alpha * c.xy), c.z);
    float _e7 = normals_per_length(normal);
    vec3 h = (normal * _e7);
    float cosine = dot(view_2.wo, h);
    float _e16 = normals_rise(view_2, (((2.0 * cosine) * h) - view_2.wo));
    float _e17 = normals_weight_of(view_2, _e16);
    return vec2(_e17, clamp((1.0 - abs(cosine)), 0.0, 1.0));
}

float normals_angle(vec3 a, vec3 b) {
    float h_1 = ((a.x * b.x) + ((a.y * b.y) + ((a.z * b.z) + 1.0000002)));
    float over_root = (2.2214415 + (h_1 * (0.53970426 + (h_1 * 0.10004498))));
    return ((over_root * inversesqrt(h_1)) + (-0.99856365 + (h_1 * (-0.27447703 + (h_1 * -0.017381236)))));
}

vec3 normals_arcs(vec3 flux, vec3 a_1, vec3 q, vec3 n) {
    float _e4 = normals_angle(q, n);
    float _e7 = normals_angle(a_1, q);
    vec3 s = ((_e4 * (n - q)) - (_e7 * (a_1 - q)));
    return vec3(((flux.x + (q.y * s.z)) - (q.z * s.y)), ((flux.y + (q.z * s.x)) - (q.x * s.z)), ((flux.z + (q.x * s.y)) - (q.y * s.x)));
}

NormalsCorner normals_corner(NormalsView view_3, vec3 v_1) {
    float _e2 = normals_per_length(v_1);
    vec3 w_1 = (v_1 * _e2);
    vec3 image = ((w_1 * vec3(view_3.per_alpha, 1.0)) + view_3.image);
    float length2_ = ((image.x * image.x) + ((image.y * image.y) + ((image.z * image.z) + 1e-30)));
    float per_length = inversesqrt(length2_);
    return NormalsCorner(w_1, image, (image * per_length), (length2_ * per_length));
}

vec3 normals_edge(NormalsView view_4, vec3 flux_1, NormalsCorner begin, NormalsCorner end) {
    vec3 a_4 = begin.c;
    vec3 c_1 = end.c;
    vec3 sum_4 = (begin.w + end.w);
    float y = ((sum_4.x * sum_4.x) + ((sum_4.y * sum_4.y) + ((sum_4.z * sum_4.z) + 1e-10)));
    vec3 image_1 = ((begin.image + end.image) + (((0.5 * y) - 2.0) * view_4.image));
    vec3 b_2 = (image_1 * inversesqrt((y * (begin.length_ * end.length_))));
    vec3 apart = (a_4 - c_1);
    float bend = ((2.0 * dot(b_2, apart)) / ((apart.x * apart.x) + ((apart.y * apart.y) + ((apart.z * apart.z) + 1e-8))));
    float t = (bend + sqrt(((bend * bend) + 1.0)));
    vec3 left = (a_4 + (t * b_2));
    vec3 right = (b_2 + (t * c_1));
    vec3 middle = (left + (t * right));
    float _e67 = normals_per_length(middle);
    vec3 n_1 = (_e67 * middle);
    float root = sqrt(_e67);
    float least = (3.3 * root);
    float more = ((0.6 * _e67) * root);
    vec3 q_1 = ((a_4 + n_1) + ((least + (more * dot(left, left))) * left));
    vec3 r = ((c_1 + n_1) + ((least + (more * dot(right, right))) * right));
    float _e87 = normals_per_length(q_1);
    vec3 _e89 = normals_arcs(flux_1, a_4, (q_1 * _e87), n_1);
    float _e90 = normals_per_length(r);
    vec3 _e92 = normals_arcs(_e89, n_1, (r * _e90), c_1);
    return _e92;
}

vec4 normals_network(vec4 first, vec4 second, vec4 third) {
    vec4 units_0_ = max(((((mat4x4(vec4(-13.02, -0.05123, -0.04506, 0.1745), vec4(-15.34, 3.537, 0.1719, 0.7646), vec4(0.9581, -0.07924, 1.487, -1.318), vec4(2.672, -0.0372, 0.4158, -0.4705)) * first) + (mat4x4(vec4(-7.332, 0.1002, 0.3907, 1.197), vec4(0.4244, 0.008437, 0.1669, 0.245), vec4(2.007, 0.1345, -0.7786, 1.951), vec4(4.066, 0.1216, -0.4966, -2.306)) * second)) + (mat4x4(vec4(-5.624, -0.02524, 0.9408, -2.893), vec4(-1.013, -0.5777, 0.6708, 1.261), vec4(1.449, -0.5531, 2.123, 0.6918), vec4(12.6, 5.388, -3.767, -0.3633)) * third)) + vec4(3.307, -8.365, 1.502, -2.399)), vec4(0.0));
    vec4 units_1_ = max(((((mat4x4(vec4(0.2911, 0.08732, -0.2378, 3.093), vec4(2.329, 5.334, -1.179, -4.725), vec4(0.277, -0.2235, 0.6636, -17.36), vec4(-0.5704, -4.27, -0.935, 1.581)) * first) + (mat4x4(vec4(3.386, 0.2138, 0.3196, -3.936), vec4(0.08644, 0.1746, 0.2738, 0.559), vec4(-0.5253, 0.5686, 0.8081, 3.705), vec4(-0.8306, -0.9163, 0.1851, 1.135)) * second)) + (mat4x4(vec4(0.3792, 0.3699, -1.317, -6.255), vec4(0.9582, 1.731, -0.8138, -18.56), vec4(0.7409, 0.07576, -1.894, 2.134), vec4(-2.271, -1.352, -2.596, -11.96)) * third)) + vec4(-3.675, -5.474, 3.814, 22.99)), vec4(0.0));
    vec4 told = (((mat4x4(vec4(0.00491, -0.3719, -0.06271, 0.1884), vec4(0.00863, -0.006025, -0.09717, -0.8619), vec4(0.0008738, -0.00477, 0.07171, 0.1559), vec4(-0.06756, 0.03206, -0.1098, -0.2721)) * units_0_) + (mat4x4(vec4(0.1447, 0.02995, 0.1516, -0.05558), vec4(-0.04049, -0.01654, 0.07856, 0.3683), vec4(-0.04697, -0.1253, -0.03508, 0.03203), vec4(0.07185, -1.163, -0.002817, -0.0119)) * units_1_)) + vec4(-0.005264, 0.004083, 0.0596, -0.0732));
    return told;
}

NormalsSide normals_side(NormalsView view_5, vec3 a_2, vec3 b_1) {
    vec3 cut = vec3(((a_2.xy * abs(b_1.z)) + (b_1.xy * abs(a_2.z))), 0.0);
    NormalsCorner _e18 = normals_corner(view_5, ((a_2.z > 0.0) ? a_2 : cut));
    NormalsCorner _e23 = normals_corner(view_5, ((b_1.z > 0.0) ? b_1 : cut));
    return NormalsSide(_e18, _e23);
}

NormalsTip normals_tip(NormalsView view_6, vec3 flux_2) {
    float seen = dot(flux_2, view_6.stretched);
    float side = (((seen < 0.0) ? -0.3183099 : 0.3183099) / (view_6.wo.z + view_6.length_));
    float _e19 = normals_per_length(flux_2);
    vec3 c_2 = (flux_2 * (((seen < 0.0) ? -1.0 : 1.0) * _e19));
    vec2 alpha_1 = vec2(max(view_6.alpha.x, view_6.alpha.y), min(view_6.alpha.x, view_6.alpha.y));
    vec2 _e36 = normals_weight(view_6, c_2);
    return NormalsTip(c_2, clamp((seen * side), 0.0, 1.0), side, vec4(view_6.rise, alpha_1, _e36.x));
}

vec3 normals_spoke(NormalsTip tip, NormalsCorner corner) {
    float _e4 = normals_angle(tip.c, corner.c);
    return (_e4 * cross(tip.c, corner.c));
}

NormalsSum normals_triangle(NormalsView view_7, NormalsTip tip_1, NormalsSum sum, vec3 flux_3, NormalsCorner begin_1, NormalsCorner end_1) {
    float seen_1 = dot(flux_3, view_7.stretched);
    float part = (seen_1 * tip_1.side);
    float size = abs(part);
    float _e16 = normals_per_length(flux_3);
    vec3 c_3 = (flux_3 * (((seen_1 < 0.0) ? -1.0 : 1.0) * _e16));
    vec2 _e19 = normals_weight(view_7, c_3);
    float _e21 = normals_rise(view_7, begin_1.w);
    float _e23 = normals_rise(view_7, end_1.w);
    vec2 rises = vec2(_e21, _e23);
    float _e30 = normals_weight_of(view_7, (0.5 * (rises.x + rises.y)));
    vec4 first_1 = vec4(size, _e19, _e30);
    vec4 second_1 = vec4(dot(c_3, tip_1.c), dot(c_3, (begin_1.c + end_1.c)), abs(c_3.z), abs((rises.x - rises.y)));
    vec4 _e46 = normals_network(first_1, second_1, tip_1.shared_inputs);
    float known = ((_e19.x + (_e46.z * (_e30 - _e19.x))) + (_e46.w * (tip_1.shared_inputs.w - _e19.x)));
    float weight = clamp((known + (size * _e46.x)), 0.0, 1.0);
    float m2_ = (_e19.y * _e19.y);
    vec2 means = vec2(weight, clamp(((((weight * m2_) * m2_) * _e19.y) + (size * _e46.y)), 0.0, weight));
    return NormalsSum((sum.signed + (part * means)), (sum.sizes + (size * vec3(means, 1.0))));
}

vec2 normals_total(NormalsTip tip_2, NormalsSum sum_1, bool is_lit) {
    vec2 both = max(sum_1.signed, (sum_1.sizes.xy * ((0.5 * tip_2.part) / max(sum_1.sizes.z, 1e-30))));
    float energy = min(both.x, tip_2.part);
    return (is_lit ? vec2(energy, clamp(both.y, 0.0, energy)) : vec2(0.0));
}

vec2 normals_rectangle(NormalsView view_8, vec3 corners[4], bool two_sided) {
    NormalsSum sum_2 = NormalsSum(vec2(0.0), vec3(0.0));
    bool local = false;
    vec2 falls = mix(vec2(0.0), vec2(1.0), lessThan(vec2(corners[1].z, corners[3].z), corners[0].zz));
    vec3 along = (corners[1] - corners[0]);
    vec3 across = (corners[3] - corners[0]);
    vec3 x = ((1.0 - (2.0 * falls.x)) * along);
    vec3 y_1 = ((1.0 - (2.0 * falls.y)) * across);
    vec3 low = ((corners[0] + (falls.x * along)) + (falls.y * across));
    vec3 right_1 = (low + x);
    vec3 left_1 = (low + y_1);
    if (((right_1.z + y_1.z) <= 0.0)) {
        return vec2(0.0);
    }
    vec2 slide = (vec2(-1.0) / max(vec2(x.z, y_1.z), vec2(1e-15)));
    vec3 right_up = (right_1 + (clamp((right_1.z * slide.y), 0.0, 1.0) * y_1));
    vec3 left_up = (left_1 + (clamp((left_1.z * slide.x), 0.0, 1.0) * x));
    NormalsCorner _e81 = normals_corner(view_8, ((left_1.z <= 0.0) ? left_up : (low + (clamp((low.z * slide.y), 0.0, 1.0) * y_1))));
    NormalsCorner _e92 = normals_corner(view_8, ((right_1.z <= 0.0) ? right_up : (low + (clamp((low.z * slide.x), 0.0, 1.0) * x))));
    NormalsCorner _e93 = normals_corner(view_8, right_up);
    NormalsCorner _e95 = normals_corner(view_8, (right_1 + y_1));
    NormalsCorner _e96 = normals_corner(view_8, left_up);
    vec3 none = vec3(0.0);
    vec3 _e99 = normals_edge(view_8, none, _e81, _e92);
    vec3 _e100 = normals_edge(view_8, none, _e92, _e93);
    vec3 _e101 = normals_edge(view_8, none, _e93, _e95);
    vec3 _e102 = normals_edge(view_8, none, _e95, _e96);
    vec3 _e103 = normals_edge(view_8, none, _e96, _e81);
    NormalsTip _e108 = normals_tip(view_8, ((((_e99 + _e100) + _e101) + _e102) + _e103));
    vec3 _e109 = normals_spoke(_e108, _e81);
    vec3 _e110 = normals_spoke(_e108, _e92);
    NormalsSum _e118 = normals_triangle(view_8, _e108, NormalsSum(vec2(0.0), vec3(0.0)), ((_e99 + _e109) - _e110), _e81, _e92);
    sum_2 = _e118;
    vec3 _e120 = normals_spoke(_e108, _e93);
    NormalsSum _e121 = sum_2;
    NormalsSum _e124 = normals_triangle(view_8, _e108, _e121, ((_e100 + _e110) - _e120), _e92, _e93);
    sum_2 = _e124;
    vec3 _e125 = normals_spoke(_e108, _e95);
    NormalsSum _e126 = sum_2;
    NormalsSum _e129 = normals_triangle(view_8, _e108, _e126, ((_e101 + _e120) - _e125), _e93, _e95);
    sum_2 = _e129;
    vec3 _e130 = normals_spoke(_e108, _e96);
    NormalsSum _e131 = sum_2;
    NormalsSum _e134 = normals_triangle(view_8, _e108, _e131, ((_e102 + _e125) - _e130), _e95, _e96);
    sum_2 = _e134;
    NormalsSum _e135 = sum_2;
    NormalsSum _e138 = normals_triangle(view_8, _e108, _e135, ((_e103 + _e130) - _e109), _e96, _e81);
    sum_2 = _e138;
    NormalsSum _e139 = sum_2;
    if (!(two_sided)) {
        local = ((_e108.side > 0.0) == (falls.x == falls.y));
    } else {
        local = true;
    }
    bool _e151 = local;
    vec2 _e152 = normals_total(_e108, _e139, _e151);
    return _e152;
}

vec2 normals_polygon(NormalsView view_9, inout vec3 vertices_1[8], uint count, bool two_sided_1) {
    vec3 a_3 = vec3(0.0);
    NormalsCorner setting = NormalsCorner(vec3(0.0), vec3(0.0), vec3(0.0), 0.0);
    NormalsCorner rising = NormalsCorner(vec3(0.0), vec3(0.0), vec3(0.0), 0.0);
    vec3 flux_4 = vec3(0.0);
    float highest = 0.0;
    uint i = 0u;
    bool local_1 = false;
    NormalsSum sum_3 = NormalsSum(vec2(0.0), vec3(0.0));
    uint i_1 = 0u;
    bool local_2 = false;
    bool local_3 = false;
    uint number = min(max(count, 3u), 8u);
    vec3 _e10 = vertices_1[(number - 1u)];
    a_3 = _e10;
    vec3 _e12 = a_3;
    NormalsCorner _e13 = normals_corner(view_9, _e12);
    setting = _e13;
    NormalsCorner _e15 = setting;
    rising = _e15;
    bool loop_init = true;
    while(true) {
        if (!loop_init) {
            uint _e63 = i;
            i = (_e63 + 1u);
        }
        loop_init = false;
        uint _e24 = i;
        if ((_e24 < 8u)) {
        } else {
            break;
        }
        {
            uint _e27 = i;
            if ((_e27 < number)) {
                uint _e29 = i;
                vec3 b_3 = vertices_1[_e29];
                float _e33 = a_3.z;
                if (!((_e33 > 0.0))) {
                    local_1 = (b_3.z > 0.0);
                } else {
                    local_1 = true;
                }
                bool _e43 = local_1;
                if (_e43) {
                    vec3 _e44 = a_3;
                    NormalsSide _e45 = normals_side(view_9, _e44, b_3);
                    vec3 _e46 = flux_4;
                    vec3 _e49 = normals_edge(view_9, _e46, _e45.begin, _e45.end);
                    flux_4 = _e49;
                    float _e51 = a_3.z;
                    if ((_e51 <= 0.0)) {
                        rising = _e45.begin;
                    }
                    if ((b_3.z <= 0.0)) {
                        setting = _e45.end;
                    }
                }
                float _e59 = highest;
                highest = max(_e59, b_3.z);
                a_3 = b_3;
            }
        }
    }
    float _e65 = highest;
    if ((_e65 <= 0.0)) {
        return vec2(0.0);
    }
    NormalsCorner _e72 = setting;
    NormalsCorner _e73 = rising;
    vec3 _e74 = normals_edge(view_9, vec3(0.0), _e72, _e73);
    vec3 _e75 = flux_4;
    NormalsTip _e77 = normals_tip(view_9, (_e75 + _e74));
    NormalsCorner _e78 = setting;
    vec3 _e79 = normals_spoke(_e77, _e78);
    NormalsCorner _e80 = rising;
    vec3 _e81 = normals_spoke(_e77, _e80);
    vec3 spokes = (_e79 - _e81);
    NormalsSum _e89 = sum_3;
    NormalsCorner _e91 = setting;
    NormalsCorner _e92 = rising;
    NormalsSum _e93 = normals_triangle(view_9, _e77, _e89, (_e74 + spokes), _e91, _e92);
    sum_3 = _e93;
    bool loop_init_1 = true;
    while(true) {
        if (!loop_init_1) {
            uint _e131 = i_1;
            i_1 = (_e131 + 1u);
        }
        loop_init_1 = false;
        uint _e96 = i_1;
        if ((_e96 < 8u)) {
        } else {
            break;
        }
        {
            uint _e99 = i_1;
            if ((_e99 < number)) {
                uint _e101 = i_1;
                vec3 b_4 = vertices_1[_e101];
                float _e105 = a_3.z;
                if (!((_e105 > 0.0))) {
                    local_2 = (b_4.z > 0.0);
                } else {
                    local_2 = true;
                }
                bool _e115 = local_2;
                if (_e115) {
                    vec3 _e116 = a_3;
                    NormalsSide _e117 = normals_side(view_9, _e116, b_4);
                    vec3 _e119 = normals_spoke(_e77, _e117.begin);
                    vec3 _e121 = normals_spoke(_e77, _e117.end);
                    vec3 spokes_1 = (_e119 - _e121);
                    vec3 _e125 = normals_edge(view_9, spokes_1, _e117.begin, _e117.end);
                    NormalsSum _e126 = sum_3;
                    NormalsSum _e129 = normals_triangle(view_9, _e77, _e126, _e125, _e117.begin, _e117.end);
                    sum_3 = _e129;
                }
                a_3 = b_4;
            }
        }
    }
    NormalsSum _e133 = sum_3;
    if (!(two_sided_1)) {
        local_3 = (_e77.side > 0.0);
    } else {
        local_3 = true;
    }
    bool _e141 = local_3;
    vec2 _e142 = normals_total(_e77, _e133, _e141);
    return _e142;
}

vec2 normals_disk(NormalsView view_10, vec3 centre, vec3 half_x, vec3 half_y, bool two_sided_2) {
    vec3 vertices_2[8] = vec3[8](vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0));
    vec2 turn = vec2(0.9736835, 0.4033129);
    uint i_2 = 0u;
    bool loop_init_2 = true;
    while(true) {
        if (!loop_init_2) {
            uint _e39 = i_2;
            i_2 = (_e39 + 1u);
        }
        loop_init_2 = false;
        uint _e12 = i_2;
        if ((_e12 < 8u)) {
        } else {
            break;
        }
        {
            uint _e15 = i_2;
            float _e18 = turn.x;
            float _e22 = turn.y;
            vertices_2[_e15] = ((centre + (half_x * _e18)) + (half_y * _e22));
            float _e26 = turn.x;
            float _e28 = turn.y;
            float _e31 = turn.y;
            float _e33 = turn.x;
            turn = (0.70710677 * vec2((_e26 + _e28), (_e31 - _e33)));
        }
    }
    vec2 _e42 = normals_polygon(view_10, vertices_2, 8u, two_sided_2);
    return _e42;
}
`;
