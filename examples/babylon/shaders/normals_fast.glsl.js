export default /* glsl */ `// SPDX-License-Identifier: MIT OR Apache-2.0
// Area lights on GGX without a table, in the space of its normals, by rule fast. Made by ltcforge 0.1.0.
//
//   normals_view(alpha_x, alpha_y, wo)  once for a point and view: roughness, and the view in the tangent frame, normal +z.
//   normals_rectangle, normals_polygon, normals_disk  for each light. Vertices are relative to the point in that frame and
//       run clockwise seen from the lit side. Light of radiance L arrives as L (f0 (x - y) + f90 y).
//
// CHECK of the rectangle (-1 -1 1) (1 -1 1) (1 1.5 -0.5) (-1 1.5 -0.5), alpha_x alpha_y (wo): x y, within 0.00002
//   0.3 0.15 (0.36 0.48 0.8): 0.695826 0.000554
//   0.2 0.6 (-0.64 0.48 0.6): 0.544658 0.002454
//   0.05 0.02 (0.576 -0.768 0.28): 0.989556 0.186976


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
    return (((2.2214415 + (h_1 * 0.4152027)) * inversesqrt(h_1)) + (-0.9720743 + (h_1 * -0.09337349)));
}

vec3 normals_arcs(vec3 flux, vec3 a_1, vec3 q, vec3 n) {
    float _e4 = normals_angle(q, n);
    float _e6 = normals_angle(a_1, q);
    vec3 s = ((_e4 * n) - (_e6 * a_1));
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

vec2 normals_mean(NormalsView view_5, vec3 flux_2, float seen, float rise_1, bool two_sided) {
    float part = clamp((((two_sided ? abs(seen) : seen) * 0.3183099) / (view_5.wo.z + view_5.length_)), 0.0, 1.0);
    vec2 _e15 = normals_weight(view_5, flux_2);
    float _e16 = normals_weight_of(view_5, rise_1);
    float _e17 = normals_per_length(flux_2);
    vec2 alpha_1 = vec2(max(view_5.alpha.x, view_5.alpha.y), min(view_5.alpha.x, view_5.alpha.y));
    vec4 first = vec4(part, view_5.rise, _e15);
    vec4 second = vec4((abs(flux_2.z) * _e17), alpha_1, _e16);
    vec3 units_0_ = max((((mat4x3(vec3(0.957, -0.2205, 0.6027), vec3(-1.39, -0.5151, 0.9099), vec3(-10.86, 9.136, -6.964), vec3(0.2335, -0.0706, 0.5823)) * first) + (mat4x3(vec3(0.1728, 0.4426, -1.059), vec3(-1.234, -0.7694, 2.05), vec3(-0.7549, -0.2645, 1.341), vec3(-0.01225, -0.1219, 1.024)) * second)) + vec3(10.96, -8.294, 4.826)), vec3(0.0));
    vec3 told = ((mat3x3(vec3(-0.03396, -0.1141, -0.04112), vec3(0.01311, -0.004379, -0.3055), vec3(-0.04821, 0.008404, 0.1643)) * units_0_) + vec3(-0.005077, 0.001849, 0.1108));
    float weight = clamp(((_e15.x + (told.z * (_e16 - _e15.x))) + (told.x * part)), 0.0, 1.0);
    float m2_ = (_e15.y * _e15.y);
    return (part * vec2(weight, clamp(((((weight * m2_) * m2_) * _e15.y) + (told.y * part)), 0.0, weight)));
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
    float _e124 = normals_rise(view_6, _e104.w);
    float _e127 = normals_rise(view_6, _e101.w);
    float rise_3 = (((_e119 + _e121) + _e124) + _e127);
    vec3 _e129 = flux_3;
    vec2 _e132 = normals_mean(view_6, _e129, seen_1, (0.25 * rise_3), two_sided_1);
    return _e132;
}

vec2 normals_polygon(NormalsView view_7, inout vec3 vertices_1[8], uint count, bool two_sided_2) {
    vec3 a_2 = vec3(0.0);
    NormalsCorner setting = NormalsCorner(vec3(0.0), vec3(0.0), vec3(0.0), 0.0);
    NormalsCorner rising = NormalsCorner(vec3(0.0), vec3(0.0), vec3(0.0), 0.0);
    vec3 flux_4 = vec3(0.0);
    float rise_2 = 0.0;
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
            uint _e82 = i;
            i = (_e82 + 1u);
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
                vec3 b_2 = vertices_1[_e29];
                float _e33 = a_2.z;
                if (!((_e33 > 0.0))) {
                    local = (b_2.z > 0.0);
                } else {
                    local = true;
                }
                bool _e43 = local;
                if (_e43) {
                    vec3 _e44 = a_2;
                    float _e51 = a_2.z;
                    vec3 cut = vec3(((_e44.xy * abs(b_2.z)) + (b_2.xy * abs(_e51))), 0.0);
                    vec3 _e57 = a_2;
                    float _e59 = a_2.z;
                    NormalsCorner _e63 = normals_corner(view_7, ((_e59 > 0.0) ? _e57 : cut));
                    NormalsCorner _e68 = normals_corner(view_7, ((b_2.z > 0.0) ? b_2 : cut));
                    vec3 _e69 = flux_4;
                    vec3 _e70 = normals_edge(view_7, _e69, _e63, _e68);
                    flux_4 = _e70;
                    float _e72 = a_2.z;
                    if ((_e72 <= 0.0)) {
                        rising = _e63;
                    }
                    if ((b_2.z <= 0.0)) {
                        setting = _e68;
                    }
                }
                float _e78 = rise_2;
                float _e79 = normals_rise(view_7, b_2);
                rise_2 = (_e78 + _e79);
                a_2 = b_2;
            }
        }
    }
    vec3 _e84 = flux_4;
    NormalsCorner _e85 = setting;
    NormalsCorner _e86 = rising;
    vec3 _e87 = normals_edge(view_7, _e84, _e85, _e86);
    flux_4 = _e87;
    vec3 _e88 = flux_4;
    vec3 _e89 = flux_4;
    float _e92 = rise_2;
    vec2 _e95 = normals_mean(view_7, _e88, dot(_e89, view_7.stretched), (_e92 / float(number)), two_sided_2);
    return _e95;
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
