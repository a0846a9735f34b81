export default /* glsl */ `// SPDX-License-Identifier: MIT OR Apache-2.0
// Area lights on GGX without a table, in the space of its normals, by rule balanced. Made by ltcforge 0.1.0.
//
//   normals_view(alpha_x, alpha_y, wo)  once for a point and view: roughness, and the view in the tangent frame, normal +z.
//   normals_rectangle, normals_polygon, normals_disk  for each light. Vertices are relative to the point in that frame and
//       run clockwise seen from the lit side. Light of radiance L arrives as L (f0 (x - y) + f90 y).
//
// Check, of the rectangle (-1 -1 1) (1 -1 1) (1 1.5 -0.5) (-1 1.5 -0.5), alpha_x alpha_y (wo): x y, within 0.00002
//   0.3 0.15 (0.36 0.48 0.8): 0.698486 0.000198
//   0.2 0.6 (-0.64 0.48 0.6): 0.546075 0.003081
//   0.05 0.02 (0.576 -0.768 0.28): 0.989197 0.187579


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
    vec3 a_3 = begin.c;
    vec3 c_1 = end.c;
    vec3 sum = (begin.w + end.w);
    float y = ((sum.x * sum.x) + ((sum.y * sum.y) + ((sum.z * sum.z) + 1e-10)));
    vec3 image_1 = ((begin.image + end.image) + (((0.5 * y) - 2.0) * view_4.image));
    vec3 b_1 = (image_1 * inversesqrt((y * (begin.length_ * end.length_))));
    vec3 apart = (a_3 - c_1);
    float bend = ((2.0 * dot(b_1, apart)) / ((apart.x * apart.x) + ((apart.y * apart.y) + ((apart.z * apart.z) + 1e-8))));
    float t = (bend + sqrt(((bend * bend) + 1.0)));
    vec3 left = (a_3 + (t * b_1));
    vec3 right = (b_1 + (t * c_1));
    vec3 middle = (left + (t * right));
    float _e67 = normals_per_length(middle);
    vec3 n_1 = (_e67 * middle);
    float root = sqrt(_e67);
    float least = (3.3 * root);
    float more = ((0.6 * _e67) * root);
    vec3 q_1 = ((a_3 + n_1) + ((least + (more * dot(left, left))) * left));
    vec3 r = ((c_1 + n_1) + ((least + (more * dot(right, right))) * right));
    float _e87 = normals_per_length(q_1);
    vec3 _e89 = normals_arcs(flux_1, a_3, (q_1 * _e87), n_1);
    float _e90 = normals_per_length(r);
    vec3 _e92 = normals_arcs(_e89, n_1, (r * _e90), c_1);
    return _e92;
}

vec3 normals_network(vec4 first, vec4 second, vec4 third) {
    vec4 units_0_ = max(((((mat4x4(vec4(-0.9354, 0.3392, 0.901, 0.8184), vec4(0.06939, 1.973, 0.7174, -0.5905), vec4(-5.548, -1.308, -4.657, -10.01), vec4(-1.921, 0.03933, 3.627, 2.526)) * first) + (mat4x4(vec4(-2.568, 0.1459, 3.309, -0.128), vec4(-0.1699, 1.817, -0.2266, -0.4018), vec4(0.2633, 0.7666, -1.943, -0.4549), vec4(1.911, 0.623, 0.03777, 0.02032)) * second)) + (mat4x4(vec4(2.098, -1.183, -2.054, -0.7316), vec4(-4.466, -0.07308, -0.3089, -0.215), vec4(-0.109, -0.1926, -0.002601, 0.2204), vec4(0.04332, 0.06559, -0.02132, -0.01499)) * third)) + vec4(4.547, -0.7266, -0.8663, 8.579)), vec4(0.0));
    vec4 units_1_ = max(((((mat4x4(vec4(0.6477, 1.515, -2.204, -3.046), vec4(-0.694, 0.0419, 2.159, 2.215), vec4(0.1061, 2.5, -1.076, -1.853), vec4(1.589, -0.03674, 4.327, 4.146)) * first) + (mat4x4(vec4(0.2575, -2.166, -0.949, -0.4878), vec4(-0.5416, 2.396, 2.191, 2.432), vec4(-0.3327, -0.9711, 2.921, -2.265), vec4(-0.5585, 0.2379, 2.755, 3.295)) * second)) + (mat4x4(vec4(-3.606, 1.975, -0.4173, 0.2039), vec4(-0.9847, 0.1395, -3.315, -3.135), vec4(1.333, 0.7253, 0.4845, 0.6164), vec4(-0.01515, 0.01943, 0.5687, 0.6633)) * third)) + vec4(0.3426, -5.247, -5.019, -4.998)), vec4(0.0));
    vec4 units_2_ = max(((((mat4x4(vec4(0.74, -0.1652, -1.324, -8.85), vec4(0.9079, -0.2555, -2.65, 0.8941), vec4(-11.14, 12.12, -13.68, -1.982), vec4(0.4566, -0.02314, -2.036, 4.191)) * first) + (mat4x4(vec4(-1.068, 0.1236, 2.726, -0.09983), vec4(1.252, -0.5095, 0.3149, 2.472), vec4(1.543, -0.1216, -0.6891, -0.6191), vec4(0.988, -0.01941, -0.4513, -0.3021)) * second)) + (mat4x4(vec4(-0.4826, 0.2351, 4.428, 0.4689), vec4(-0.5691, 0.007494, -0.7105, -1.696), vec4(-0.07313, 0.0004897, 0.4579, -2.729), vec4(0.006034, -0.002308, 0.008641, -0.3128)) * third)) + vec4(9.743, -11.63, 10.16, 0.8425)), vec4(0.0));
    return ((((mat4x3(vec3(-0.02834, -0.02664, 0.1041), vec3(-0.01883, -0.01512, 0.09821), vec3(0.007351, 0.06988, 0.01708), vec3(-0.01147, -0.1042, -0.02192)) * units_0_) + (mat4x3(vec3(-0.001762, -0.0824, -0.02879), vec3(-0.008193, 0.01041, 0.1278), vec3(-0.01512, 0.005387, 0.1031), vec3(0.00705, -0.001201, -0.1004)) * units_1_)) + (mat4x3(vec3(-0.04486, 0.01646, 0.09211), vec3(0.02413, -0.01387, -0.1807), vec3(-0.01519, -0.01256, -0.1395), vec3(0.03092, 0.0857, 0.1504)) * units_2_)) + vec3(-0.009406, 0.005604, 0.06389));
}

vec2 normals_mean(NormalsView view_5, vec3 flux_2, float seen, vec3 rises, float width, bool two_sided) {
    float part = clamp((((two_sided ? abs(seen) : seen) * 0.3183099) / (view_5.wo.z + view_5.length_)), 0.0, 1.0);
    vec2 _e16 = normals_weight(view_5, flux_2);
    float _e18 = normals_weight_of(view_5, rises.x);
    float _e19 = normals_per_length(flux_2);
    vec2 alpha_1 = vec2(max(view_5.alpha.x, view_5.alpha.y), min(view_5.alpha.x, view_5.alpha.y));
    vec4 first_1 = vec4(part, view_5.rise, _e16);
    vec4 second_1 = vec4((abs(flux_2.z) * _e19), alpha_1, _e18);
    vec4 third_1 = vec4(((abs(seen) * _e19) / view_5.length_), rises.yz, width);
    vec3 _e43 = normals_network(first_1, second_1, third_1);
    float weight = clamp(((_e16.x + (_e43.z * (_e18 - _e16.x))) + (_e43.x * part)), 0.0, 1.0);
    float m2_ = (_e16.y * _e16.y);
    return (part * vec2(weight, clamp(((((weight * m2_) * m2_) * _e16.y) + (_e43.y * part)), 0.0, weight)));
}

vec2 normals_rectangle(NormalsView view_6, vec3 corners[4], bool two_sided_1) {
    vec3 flux_3 = vec3(0.0);
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
    NormalsCorner _e81 = normals_corner(view_6, ((left_1.z <= 0.0) ? left_up : (low + (clamp((low.z * slide.y), 0.0, 1.0) * y_1))));
    NormalsCorner _e92 = normals_corner(view_6, ((right_1.z <= 0.0) ? right_up : (low + (clamp((low.z * slide.x), 0.0, 1.0) * x))));
    vec3 _e95 = normals_edge(view_6, vec3(0.0), _e81, _e92);
    flux_3 = _e95;
    NormalsCorner _e97 = normals_corner(view_6, right_up);
    vec3 _e98 = flux_3;
    vec3 _e99 = normals_edge(view_6, _e98, _e92, _e97);
    flux_3 = _e99;
    NormalsCorner _e101 = normals_corner(view_6, (right_1 + y_1));
    vec3 _e102 = flux_3;
    vec3 _e103 = normals_edge(view_6, _e102, _e97, _e101);
    flux_3 = _e103;
    NormalsCorner _e104 = normals_corner(view_6, left_up);
    vec3 _e105 = flux_3;
    vec3 _e106 = normals_edge(view_6, _e105, _e101, _e104);
    vec3 _e107 = normals_edge(view_6, _e106, _e104, _e81);
    flux_3 = _e107;
    vec3 _e114 = flux_3;
    float seen_1 = (((falls.x != falls.y) ? -1.0 : 1.0) * dot(_e114, view_6.stretched));
    float _e119 = normals_rise(view_6, _e81.w);
    float _e121 = normals_rise(view_6, _e97.w);
    float _e123 = normals_rise(view_6, _e104.w);
    float _e125 = normals_rise(view_6, _e101.w);
    vec4 rises_2 = vec4(_e119, _e121, _e123, _e125);
    float least_1 = min(min(rises_2.x, rises_2.y), min(rises_2.z, rises_2.w));
    float most = max(max(rises_2.x, rises_2.y), max(rises_2.z, rises_2.w));
    float mean = (0.25 * (((rises_2.x + rises_2.y) + rises_2.z) + rises_2.w));
    vec3 apart_1 = (_e81.w - _e92.w);
    vec3 _e153 = flux_3;
    vec2 _e158 = normals_mean(view_6, _e153, seen_1, vec3(mean, least_1, most), (0.5 * dot(apart_1, apart_1)), two_sided_1);
    return _e158;
}

vec2 normals_polygon(NormalsView view_7, inout vec3 vertices_1[8], uint count, bool two_sided_2) {
    vec3 a_2 = vec3(0.0);
    NormalsCorner setting = NormalsCorner(vec3(0.0), vec3(0.0), vec3(0.0), 0.0);
    NormalsCorner rising = NormalsCorner(vec3(0.0), vec3(0.0), vec3(0.0), 0.0);
    vec3 flux_4 = vec3(0.0);
    vec3 rises_1 = vec3(0.0, 1.0, 0.0);
    uint i = 0u;
    bool local = false;
    uint number = min(max(count, 3u), 8u);
    vec3 _e10 = vertices_1[(number - 1u)];
    a_2 = _e10;
    vec3 _e12 = a_2;
    NormalsCorner _e13 = normals_corner(view_7, _e12);
    setting = _e13;
    NormalsCorner _e15 = setting;
    rising = _e15;
    bool loop_init = true;
    while(true) {
        if (!loop_init) {
            uint _e93 = i;
            i = (_e93 + 1u);
        }
        loop_init = false;
        uint _e27 = i;
        if ((_e27 < 8u)) {
        } else {
            break;
        }
        {
            uint _e30 = i;
            if ((_e30 < number)) {
                uint _e32 = i;
                vec3 b_2 = vertices_1[_e32];
                float _e36 = a_2.z;
                if (!((_e36 > 0.0))) {
                    local = (b_2.z > 0.0);
                } else {
                    local = true;
                }
                bool _e46 = local;
                if (_e46) {
                    vec3 _e47 = a_2;
                    float _e54 = a_2.z;
                    vec3 cut = vec3(((_e47.xy * abs(b_2.z)) + (b_2.xy * abs(_e54))), 0.0);
                    vec3 _e60 = a_2;
                    float _e62 = a_2.z;
                    NormalsCorner _e66 = normals_corner(view_7, ((_e62 > 0.0) ? _e60 : cut));
                    NormalsCorner _e71 = normals_corner(view_7, ((b_2.z > 0.0) ? b_2 : cut));
                    vec3 _e72 = flux_4;
                    vec3 _e73 = normals_edge(view_7, _e72, _e66, _e71);
                    flux_4 = _e73;
                    float _e75 = a_2.z;
                    if ((_e75 <= 0.0)) {
                        rising = _e66;
                    }
                    if ((b_2.z <= 0.0)) {
                        setting = _e71;
                    }
                }
                float _e81 = normals_rise(view_7, b_2);
                float _e83 = rises_1.x;
                float _e86 = rises_1.y;
                float _e89 = rises_1.z;
                rises_1 = vec3((_e83 + _e81), min(_e86, _e81), max(_e89, _e81));
                a_2 = b_2;
            }
        }
    }
    float _e96 = rises_1.z;
    if ((_e96 <= 0.0)) {
        return vec2(0.0);
    }
    vec3 _e101 = flux_4;
    NormalsCorner _e102 = setting;
    NormalsCorner _e103 = rising;
    vec3 _e104 = normals_edge(view_7, _e101, _e102, _e103);
    flux_4 = _e104;
    vec3 _e106 = setting.w;
    vec3 _e108 = rising.w;
    vec3 apart_2 = (_e106 - _e108);
    vec3 _e110 = flux_4;
    vec3 _e111 = flux_4;
    float _e115 = rises_1.x;
    vec3 _e118 = rises_1;
    vec2 _e124 = normals_mean(view_7, _e110, dot(_e111, view_7.stretched), vec3((_e115 / float(number)), _e118.yz), (0.5 * dot(apart_2, apart_2)), two_sided_2);
    return _e124;
}

vec2 normals_disk(NormalsView view_8, vec3 centre, vec3 half_x, vec3 half_y, bool two_sided_3) {
    vec3 vertices_2[8] = vec3[8](vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0));
    vec2 turn = vec2(0.9736835, 0.4033129);
    uint i_1 = 0u;
    bool loop_init_1 = true;
    while(true) {
        if (!loop_init_1) {
            uint _e39 = i_1;
            i_1 = (_e39 + 1u);
        }
        loop_init_1 = false;
        uint _e12 = i_1;
        if ((_e12 < 8u)) {
        } else {
            break;
        }
        {
            uint _e15 = i_1;
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
    vec2 _e42 = normals_polygon(view_8, vertices_2, 8u, two_sided_3);
    return _e42;
}
`;
