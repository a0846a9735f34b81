// SPDX-License-Identifier: MIT OR Apache-2.0
// ltcforge 0.1.0, revision 1, sha256 of the text below: db72795ebca6b989
// Linearly Transformed Cosines: area lights on anisotropic GGX, by a formula, without a table.
//
// FUNCTIONS
//   ltc_formula(alpha_x, alpha_y, wo, f0, f90)  inverse, amplitude and fresnel of a material with this reflectance at
//       normal and grazing incidence; 1.0, 1.0 for metals. GGX roughness along x and y is above 0. wo is the view
//       direction in the tangent frame, normal +z, of unit length.
//   ltc_rectangle(inverse, corners, two_sided)  the part of the lobe that a rectangle or parallelogram covers, 0 to 1.
//       Corners are relative to the shaded point, in the tangent frame, clockwise as seen from the side that emits.
//   Light of radiance L arrives as L (f0 (amplitude - fresnel) + f90 fresnel) covered.
//
// USE
//   Call ltc_formula once for a point and view, then a function for each light.
//
// CHECK
//   amplitude, fresnel and covered by f0 = 1 | f0 = 0.04, f90 = 1, for the one-sided rectangle
//   (-1 -1 1) (1 -1 1) (1 1.5 -0.5) (-1 1.5 -0.5).
//   A port in 32 bits comes within 0.00002 of each number.
//   alpha_x 0.3 alpha_y 0.15 wo (0.36 0.48 0.8)
//     0.908257 0.001018 0.802197 | 0.908257 0.001018 0.801577
//   alpha_x 0.2 alpha_y 0.6 wo (-0.64 0.48 0.6)
//     0.738604 0.008137 0.729490 | 0.738604 0.008137 0.701043
//   alpha_x 0.05 alpha_y 0.02 wo (0.576 -0.768 0.28)
//     0.991439 0.189741 0.998539 | 0.991439 0.189741 0.998541

// Integrates a Linearly Transformed Cosine over a rectangle. Corners are relative to the shaded point, in its tangent
// frame, normal +z. They run clockwise as seen from the side that emits.

// The inverse of M up to a positive factor, which does not change directions.
struct LtcInverse {
    mat3 m;
    // -1 if M mirrors, which reverses the order of vertices. 0 if M has no inverse; no light is reflected then.
    float side;
};

// The vector scaled to unit length; zero for a zero vector.
vec3 ltc_unit(vec3 v) {
    return v * inversesqrt(dot(v, v) + 1e-36);
}

// The angle between two unit vectors divided by its sine, minus one. Error below 2.5e-5 h / sin(h), where h is half
// the angle. The sum of the vectors stays precise up to an angle of 180 degrees; their dot product does not
// [ltcforge-studies, polynomials].
float ltc_bend(vec3 a, vec3 b) {
    vec3 sum = a + b;
    float k = dot(sum, sum) + 1e-18;
    return (3.1415927 + (0.3824614 + 0.0361113 * k) * k) * inversesqrt(k) - (1.9987368 + (0.1384879 + 0.0044966 * k) * k);
}

// acos(a . b) (a x b).z / |a x b| minus (a x b).z.
float ltc_arc(vec3 a, vec3 b) {
    return (a.x * b.y - a.y * b.x) * ltc_bend(a, b);
}

// (a x b).z, computed relative to an origin. The sum over a closed outline does not depend on the origin. With an origin
// near a small light, each term is as small as the sum. Otherwise rounding errors would be larger than the sum.
float ltc_chord(vec3 a, vec3 b, vec3 origin) {
    vec2 p = a.xy - origin.xy;
    vec2 q = b.xy - origin.xy;
    return p.x * q.y - p.y * q.x;
}

// The covered part of the lobe for a rectangle or parallelogram. The last corner is not read.
//
// The part above the horizon has at most five corners: the highest corner; the two corners next to it, moved up to the
// horizon if they are below it; and the points where both paths from the lowest corner cross the horizon. If nothing is
// cut off, both points are the lowest corner. All five move continuously with the light.
float ltc_rectangle(LtcInverse inverse_, vec3 corners[4], bool two_sided) {
    vec3 x = inverse_.m * (corners[1] - corners[0]);
    vec3 y = inverse_.m * (corners[2] - corners[1]);
    bvec2 falls = lessThan(vec2(x.z, y.z), vec2(0.0));
    vec2 turn = mix(vec2(1.0), vec2(-1.0), falls);
    x *= turn.x;
    y *= turn.y;
    vec3 lowest = inverse_.m * corners[0] + x * (0.5 * turn.x - 0.5) + y * (0.5 * turn.y - 0.5);
    vec3 a = lowest + x;
    vec3 b = lowest + y;
    vec3 highest = a + y;
    // The fraction of each edge that is below the horizon.
    vec2 per_height = vec2(1.0) / max(vec2(x.z, y.z), vec2(1e-36));
    vec2 low = clamp(-lowest.z * per_height, vec2(0.0), vec2(1.0));
    float last_x = clamp(-b.z * per_height.x, 0.0, 1.0);
    float last_y = clamp(-a.z * per_height.y, 0.0, 1.0);
    vec3 d = ltc_unit(lowest + low.y * y + last_x * x);
    vec3 e = ltc_unit(lowest + low.x * x + last_y * y);
    vec3 f = ltc_unit(a + last_y * y);
    vec3 g = ltc_unit(highest);
    vec3 h = ltc_unit(b + last_x * x);
    float sum = ltc_chord(h, d, g) + ltc_chord(d, e, g) + ltc_chord(e, f, g)
        + ltc_arc(d, e) + ltc_arc(e, f) + ltc_arc(f, g) + ltc_arc(g, h) + ltc_arc(h, d);
    float covered = sum * 0.15915494 * (inverse_.side * turn.x * turn.y);
    return highest.z > 0.0 ? clamp(two_sided ? abs(covered) : covered, 0.0, 1.0) : 0.0;
}

// An LTC of anisotropic GGX by a formula, derived in docs/formula.md. Needs ltc_rectangle.wgsl.

// The lobe of a surface seen from one direction.
struct LtcFormula {
    // Pass it to ltc_rectangle and other light functions.
    LtcInverse inverse;
    // The albedo is f0 (amplitude - fresnel) + f90 fresnel.
    float amplitude;
    float fresnel;
};

// The lobe of a material with reflectance f0 at normal and f90 at grazing incidence. For metals pass 1.0, 1.0: this is
// cheaper, and nearly the same. wo is the view direction in the tangent frame, normal +z, of unit length.
LtcFormula ltc_formula(float alpha_x, float alpha_y, vec3 wo, float f0, float f90) {
    vec2 a = max(vec2(alpha_x, alpha_y), vec2(1e-5));
    float larger = max(a.x, a.y);
    float smaller = min(a.x, a.y);
    vec3 o = vec3(wo.xy, max(wo.z, 1e-4));
    vec3 stretched = vec3(a * o.xy, o.z);
    float per_size = inversesqrt(dot(stretched, stretched));
    float size = dot(stretched, stretched) * per_size;
    float mu = o.z * per_size;
    // c is the central visible normal in stretched space, h in the tangent frame. h reflects the view into r.
    vec3 c = normalize(vec3(stretched.xy * per_size, mu + 1.0));
    vec3 h = normalize(vec3(a * c.xy, c.z));
    float d = dot(o, h);
    vec3 r = 2.0 * d * h - o;
    vec3 r_stretched = vec3(a * r.xy, r.z);
    float rise = max(r.z, 1e-4) * inversesqrt(dot(r_stretched, r_stretched));
    // Smith's G2 / G1.
    float g = (1.0 + mu) * rise / (rise + mu);
    float by_larger = larger * (0.3606 * larger - 0.7649 * g)
        + smaller * 0.7905 * smaller
        + mu * (0.3165 * mu - 0.6515 * rise)
        + 0.3192;
    float by_smaller = larger * -0.3601 * mu + smaller * (0.1624 * mu - 2.312 * rise + 1.389) + rise * 0.3065 - 0.2533;
    float incidence = mu * (-0.7474 * g - 0.1998 * smaller + 0.7915)
        + smaller * (0.5865 * d - 0.2242 * smaller)
        + larger * 0.1321 * size
        + g * 0.9561;
    float amplitude = clamp(g * g + larger * by_larger + smaller * by_smaller, 0.0, 1.0);
    float m = clamp(incidence - d, 0.0, 1.0);
    float fresnel = amplitude * (m * m) * (m * m) * m;
    // Fraction of the light due to Schlick's (f90 - f0).
    float weighed = max(f90 - f0, 0.0) * fresnel;
    float share = weighed / max(f0 * amplitude + weighed, 1e-30);
    float swell = larger * (-0.9696 * size + 1.01 * d)
        + smaller * 0.9295 * size
        + mu * 0.3992 * d
        + size * (1.392 * rise - 1.767);
    float lift = mu * 2.14 * mu + rise * 2.12 * rise + share * (5.773 * d - 1.058);
    float along = larger * (1.869 * larger - 4.093)
        + mu * 2.646 * mu
        + g * 1.896
        + rise * 2.287
        + share * (-1.101 * rise - 1.286);
    float row = -0.9713 + rise * -1.452 + mu * 1.22 + size * (-3.319 * d + 3.99) + g * -0.4978;
    vec2 tilt = a * (0.4684 * a - 0.7911 * mu)
        + mu * -0.215
        + d * (-2.333 * size + 3.053 * rise)
        + rise * -1.654
        + share * 1.301;
    vec2 stretch = a * (0.4713 * a + 0.8451 * mu + 0.2945 * smaller + 0.2964 * larger - 0.8417);
    vec3 tangent = (1.0 + larger * swell) * r + vec3(0.0, 0.0, larger * lift * (1.0 - c.z));
    // The determinant is a multiple of 1 + rho . o. Without corrections, it is 2 d^2.
    vec3 rho = tangent + max(d * d - (1.0 + dot(tangent, o)), 0.0) * o;
    // x, y and c are the rows of the rotation that takes c to z.
    float k = 1.0 / (1.0 + c.z);
    float xy = -c.x * c.y * k;
    vec3 x = vec3(1.0 - c.x * c.x * k, xy, -c.x);
    vec3 y = vec3(xy, 1.0 - c.y * c.y * k, -c.y);
    vec3 away = vec3(c.xy * c.z, c.z * c.z - 1.0);
    vec3 skew = along * away;
    vec2 grown = exp(stretch);
    vec3 per_a = vec3(1.0 / a, 1.0);
    vec3 row_x = (grown.x * x + c.x * skew + (c.x * tilt.x) * c) * per_a;
    vec3 row_y = (grown.y * y + c.y * skew + (c.y * tilt.y) * c) * per_a;
    vec3 row_z = (c + row * away) * per_a;
    mat3 inverse_ = mat3(row_x + dot(row_x, o) * rho, row_y + dot(row_y, o) * rho, row_z + dot(row_z, o) * rho);
    return LtcFormula(LtcInverse(transpose(inverse_), 1.0), amplitude, fresnel);
}
