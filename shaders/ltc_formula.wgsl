// An LTC of anisotropic GGX by a formula, derived in docs/formula.md. Needs ltc_rectangle.wgsl.

/// The lobe of a surface seen from one direction.
struct LtcFormula {
    /// Pass it to ltc_rectangle and other light functions.
    inverse: LtcInverse,
    /// The albedo is f0 (amplitude - fresnel) + f90 fresnel.
    amplitude: f32,
    fresnel: f32,
}

/// The lobe of a material with reflectance f0 at normal and f90 at grazing incidence. For metals pass 1.0, 1.0: this is
/// cheaper, and nearly the same. wo is the view direction in the tangent frame, normal +z, of unit length.
fn ltc_formula(alpha_x: f32, alpha_y: f32, wo: vec3<f32>, f0: f32, f90: f32) -> LtcFormula {
    let a = max(vec2(alpha_x, alpha_y), vec2(1e-5));
    let larger = max(a.x, a.y);
    let smaller = min(a.x, a.y);
    let o = vec3(wo.xy, max(wo.z, 1e-4));
    let stretched = vec3(a * o.xy, o.z);
    let per_size = inverseSqrt(dot(stretched, stretched));
    let size = dot(stretched, stretched) * per_size;
    let mu = o.z * per_size;
    // c is the central visible normal in stretched space, h in the tangent frame. h reflects the view into r.
    let c = normalize(vec3(stretched.xy * per_size, mu + 1.0));
    let h = normalize(vec3(a * c.xy, c.z));
    let d = dot(o, h);
    let r = 2.0 * d * h - o;
    let r_stretched = vec3(a * r.xy, r.z);
    let rise = max(r.z, 1e-4) * inverseSqrt(dot(r_stretched, r_stretched));
    // Smith's G2 / G1.
    let g = (1.0 + mu) * rise / (rise + mu);
    let by_larger = larger * (0.3606 * larger - 0.7649 * g)
        + smaller * 0.7905 * smaller
        + mu * (0.3165 * mu - 0.6515 * rise)
        + 0.3192;
    let by_smaller = larger * -0.3601 * mu + smaller * (0.1624 * mu - 2.312 * rise + 1.389) + rise * 0.3065 - 0.2533;
    let incidence = mu * (-0.7474 * g - 0.1998 * smaller + 0.7915)
        + smaller * (0.5865 * d - 0.2242 * smaller)
        + larger * 0.1321 * size
        + g * 0.9561;
    let amplitude = saturate(g * g + larger * by_larger + smaller * by_smaller);
    let m = saturate(incidence - d);
    let fresnel = amplitude * (m * m) * (m * m) * m;
    // Fraction of the light due to Schlick's (f90 - f0).
    let weighed = max(f90 - f0, 0.0) * fresnel;
    let share = weighed / max(f0 * amplitude + weighed, 1e-30);
    let swell = larger * (-0.9696 * size + 1.01 * d)
        + smaller * 0.9295 * size
        + mu * 0.3992 * d
        + size * (1.392 * rise - 1.767);
    let lift = mu * 2.14 * mu + rise * 2.12 * rise + share * (5.773 * d - 1.058);
    let along = larger * (1.869 * larger - 4.093)
        + mu * 2.646 * mu
        + g * 1.896
        + rise * 2.287
        + share * (-1.101 * rise - 1.286);
    let row = -0.9713 + rise * -1.452 + mu * 1.22 + size * (-3.319 * d + 3.99) + g * -0.4978;
    let tilt = a * (0.4684 * a - 0.7911 * mu)
        + mu * -0.215
        + d * (-2.333 * size + 3.053 * rise)
        + rise * -1.654
        + share * 1.301;
    let stretch = a * (0.4713 * a + 0.8451 * mu + 0.2945 * smaller + 0.2964 * larger - 0.8417);
    let tangent = (1.0 + larger * swell) * r + vec3(0.0, 0.0, larger * lift * (1.0 - c.z));
    // The determinant is a multiple of 1 + rho . o. Without corrections, it is 2 d^2.
    let rho = tangent + max(d * d - (1.0 + dot(tangent, o)), 0.0) * o;
    // x, y and c are the rows of the rotation that takes c to z.
    let k = 1.0 / (1.0 + c.z);
    let xy = -c.x * c.y * k;
    let x = vec3(1.0 - c.x * c.x * k, xy, -c.x);
    let y = vec3(xy, 1.0 - c.y * c.y * k, -c.y);
    let away = vec3(c.xy * c.z, c.z * c.z - 1.0);
    let skew = along * away;
    let grown = exp(stretch);
    let per_a = vec3(1.0 / a, 1.0);
    let row_x = (grown.x * x + c.x * skew + (c.x * tilt.x) * c) * per_a;
    let row_y = (grown.y * y + c.y * skew + (c.y * tilt.y) * c) * per_a;
    let row_z = (c + row * away) * per_a;
    let inverse = mat3x3(row_x + dot(row_x, o) * rho, row_y + dot(row_y, o) * rho, row_z + dot(row_z, o) * rho);
    return LtcFormula(LtcInverse(transpose(inverse), 1.0), amplitude, fresnel);
}
