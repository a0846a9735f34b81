export default /* glsl */ `// SPDX-License-Identifier: MIT OR Apache-2.0
// Area lights on GGX without a table, in the space of its normals, by rule balanced. Made by ltcforge 0.1.0.
//
//   normals_view(alpha_x, alpha_y, wo)  once for a point and view: roughness, and the view in the tangent frame, normal +z.
//   normals_rectangle, normals_polygon, normals_disk  for each light. Vertices are relative to the point in that frame and
//       run clockwise seen from the lit side. Light of radiance L arrives as L (f0 (x - y) + f90 y).
//
// CHECK of the rectangle (-1 -1 1) (1 -1 1) (1 1.5 -0.5) (-1 1.5 -0.5), alpha_x alpha_y (wo): x y, within 0.00002
//   0.3 0.15 (0.36 0.48 0.8): 0.698599 0.000000
//   0.2 0.6 (-0.64 0.48 0.6): 0.547130 0.000000
//   0.05 0.02 (0.576 -0.768 0.28): 0.990901 0.187277


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

vec2 normals_mean(NormalsView view_5, vec3 flux_2, float seen, vec2 rises, vec2 ends, bool two_sided) {
    float part = clamp((((two_sided ? abs(seen) : seen) * 0.3183099) / (view_5.wo.z + view_5.length_)), 0.0, 1.0);
    vec2 _e16 = normals_weight(view_5, flux_2);
    float _e18 = normals_weight_of(view_5, rises.x);
    float _e19 = normals_per_length(flux_2);
    vec2 alpha_1 = vec2(max(view_5.alpha.x, view_5.alpha.y), min(view_5.alpha.x, view_5.alpha.y));
    vec4 first = vec4(part, view_5.rise, _e16);
    vec4 second = vec4((abs(flux_2.z) * _e19), alpha_1, _e18);
    vec4 third = vec4(((abs(seen) * _e19) / view_5.length_), ends, rises.y);
    vec4 units_0_ = max(((((mat4x4(vec4(-0.4517, -5.272, 1.779, -0.2389), vec4(-1.26, 1.688, 0.5576, -1.128), vec4(-4.275, 1.481, 30.76, -13.12), vec4(-1.536, 4.015, 0.03746, -0.6128)) * first) + (mat4x4(vec4(0.4828, -0.123, -3.655, 0.951), vec4(0.6037, 1.921, 2.182, 0.009572), vec4(0.3429, -0.8065, 1.27, -1.125), vec4(-0.02034, -0.7458, 1.34, -0.6957)) * second)) + (mat4x4(vec4(3.5, -0.5266, -4.763, 1.63), vec4(-0.2434, -2.357, -0.1187, 0.2569), vec4(0.06323, 2.151, -0.3276, 0.2598), vec4(-0.02792, -9.115, -1.102, 0.1882)) * third)) + vec4(2.287, -3.08, -27.36, 11.93)), vec4(0.0));
    vec4 units_1_ = max(((((mat4x4(vec4(2.373, 1.101, -0.2881, -0.2746), vec4(0.894, 2.18, -3.53, 4.745), vec4(1.452, 0.5634, -9.116, 1.627), vec4(-0.4989, 0.7647, -2.529, 1.858)) * first) + (mat4x4(vec4(-3.776, -0.923, 0.6106, 5.323), vec4(2.5, 2.561, 0.8376, 0.6629), vec4(-1.425, 2.694, 0.7314, -7.277), vec4(0.1632, 1.109, 0.502, 1.195)) * second)) + (mat4x4(vec4(0.3068, -2.404, 5.645, -8.7), vec4(-0.1651, -0.7696, -0.4272, 2.286), vec4(0.2761, 0.01648, 0.2228, 1.936), vec4(0.144, -0.2423, -0.456, -10.35)) * third)) + vec4(-2.005, -2.343, 6.88, -4.838)), vec4(0.0));
    vec4 units_2_ = max(((((mat4x4(vec4(0.8842, -0.6139, 0.483, -0.342), vec4(-1.322, 0.0633, 0.8474, 1.882), vec4(-11.05, -4.906, -14.09, 0.4059), vec4(0.3262, -0.117, 0.09231, 0.7526)) * first) + (mat4x4(vec4(-0.4565, -1.156, -0.5831, 0.413), vec4(-0.2157, -0.8456, 1.176, 0.5174), vec4(-0.3535, 2.117, 0.5998, 0.4314), vec4(0.1399, 3.433, -0.06966, 0.702)) * second)) + (mat4x4(vec4(-1.07, 0.7266, -0.5591, -0.1247), vec4(-0.02631, -5.466, -0.07689, 0.3231), vec4(0.2429, -0.07201, -0.05384, 0.7153), vec4(-0.08406, -1.691, 0.174, 0.4504)) * third)) + vec4(12.45, 3.613, 13.75, -5.645)), vec4(0.0));
    vec3 told = ((((mat4x3(vec3(-0.003988, -0.2249, 0.01139), vec3(0.1556, 0.04211, 0.2543), vec3(0.05126, -0.008541, -0.02405), vec3(0.01138, 0.03835, -0.1487)) * units_0_) + (mat4x3(vec3(-0.03438, 0.005577, 0.0775), vec3(-0.05159, -0.00132, 0.04855), vec3(-3.237e-5, 0.1057, -0.02174), vec3(-0.09208, -0.05101, -0.2338)) * units_1_)) + (mat4x3(vec3(-0.01082, -0.09808, 0.02568), vec3(0.008448, 0.007935, 0.1418), vec3(-0.04663, 0.02314, 0.09929), vec3(0.125, 0.09136, -0.1615)) * units_2_)) + vec3(-8.466e-6, 0.000105, 0.0002346));
    float weight = clamp(((_e16.x + (told.z * (_e18 - _e16.x))) + (told.x * part)), 0.0, 1.0);
    float m2_ = (_e16.y * _e16.y);
    return (part * vec2(weight, clamp(((((weight * m2_) * m2_) * _e16.y) + (told.y * part)), 0.0, weight)));
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
    vec4 rises_1 = vec4(_e119, _e121, _e123, _e125);
    float least_1 = min(min(rises_1.x, rises_1.y), min(rises_1.z, rises_1.w));
    float most = max(max(rises_1.x, rises_1.y), max(rises_1.z, rises_1.w));
    vec2 sums_1 = vec2((((rises_1.x + rises_1.y) + rises_1.z) + rises_1.w), dot(rises_1, rises_1));
    vec3 _e150 = flux_3;
    vec2 _e154 = normals_mean(view_6, _e150, seen_1, (0.25 * sums_1), vec2(least_1, most), two_sided_1);
    return _e154;
}

vec2 normals_polygon(NormalsView view_7, inout vec3 vertices_1[8], uint count, bool two_sided_2) {
    vec3 a_2 = vec3(0.0);
    NormalsCorner setting = NormalsCorner(vec3(0.0), vec3(0.0), vec3(0.0), 0.0);
    NormalsCorner rising = NormalsCorner(vec3(0.0), vec3(0.0), vec3(0.0), 0.0);
    vec3 flux_4 = vec3(0.0);
    vec2 sums = vec2(0.0);
    vec2 ends_1 = vec2(1.0, 0.0);
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
            uint _e97 = i;
            i = (_e97 + 1u);
        }
        loop_init = false;
        uint _e29 = i;
        if ((_e29 < 8u)) {
        } else {
            break;
        }
        {
            uint _e32 = i;
            if ((_e32 < number)) {
                uint _e34 = i;
                vec3 b_2 = vertices_1[_e34];
                float _e38 = a_2.z;
                if (!((_e38 > 0.0))) {
                    local = (b_2.z > 0.0);
                } else {
                    local = true;
                }
                bool _e48 = local;
                if (_e48) {
                    vec3 _e49 = a_2;
                    float _e56 = a_2.z;
                    vec3 cut = vec3(((_e49.xy * abs(b_2.z)) + (b_2.xy * abs(_e56))), 0.0);
                    vec3 _e62 = a_2;
                    float _e64 = a_2.z;
                    NormalsCorner _e68 = normals_corner(view_7, ((_e64 > 0.0) ? _e62 : cut));
                    NormalsCorner _e73 = normals_corner(view_7, ((b_2.z > 0.0) ? b_2 : cut));
                    vec3 _e74 = flux_4;
                    vec3 _e75 = normals_edge(view_7, _e74, _e68, _e73);
                    flux_4 = _e75;
                    float _e77 = a_2.z;
                    if ((_e77 <= 0.0)) {
                        rising = _e68;
                    }
                    if ((b_2.z <= 0.0)) {
                        setting = _e73;
                    }
                }
                float _e83 = normals_rise(view_7, b_2);
                vec2 _e84 = sums;
                sums = (_e84 + (_e83 * vec2(1.0, _e83)));
                float _e90 = ends_1.x;
                float _e93 = ends_1.y;
                ends_1 = vec2(min(_e90, _e83), max(_e93, _e83));
                a_2 = b_2;
            }
        }
    }
    vec3 _e99 = flux_4;
    NormalsCorner _e100 = setting;
    NormalsCorner _e101 = rising;
    vec3 _e102 = normals_edge(view_7, _e99, _e100, _e101);
    flux_4 = _e102;
    vec3 _e103 = flux_4;
    vec3 _e104 = flux_4;
    vec2 _e107 = sums;
    vec2 _e111 = ends_1;
    vec2 _e112 = normals_mean(view_7, _e103, dot(_e104, view_7.stretched), (_e107 / vec2(float(number))), _e111, two_sided_2);
    return _e112;
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
