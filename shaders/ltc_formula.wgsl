// An LTC of anisotropic GGX by a formula, without a table. Needs ltc_light.wgsl. docs/formula.md derives it;
// `ltcforge-studies -- formula` prints the polynomials.

/// The lobe of a surface seen from one direction.
struct LtcFormula {
    /// For all lights at the point.
    inverse: LtcInverse,
    /// The albedo is f0 (amplitude - fresnel) + f90 fresnel.
    amplitude: f32,
    fresnel: f32,
}

/// The lobe of a material with reflectance f0 at normal and f90 at grazing incidence. For metals, pass 1.0 and 1.0: the
/// lobe is cheaper, and nearly the same. wo is the view direction in the tangent frame, normal +z, of unit length.
fn ltc_formula(alpha_x: f32, alpha_y: f32, wo: vec3<f32>, f0: f32, f90: f32) -> LtcFormula {
    let a = max(vec2(alpha_x, alpha_y), vec2(1e-5));
    let larger = max(a.x, a.y);
    let smaller = min(a.x, a.y);
    let stretched = vec3(a * wo.xy, wo.z);
    let per_size = inverseSqrt(dot(stretched, stretched));
    let size = dot(stretched, stretched) * per_size;
    let mu = wo.z * per_size;
    // The middle one of the visible normals, stretched (c) and not (h). h reflects the view to r.
    let c = normalize(vec3(stretched.xy * per_size, mu + 1.0));
    let h = normalize(vec3(a * c.xy, c.z));
    let d = dot(wo, h);
    let r = 2.0 * d * h - wo;
    let r_stretched = vec3(a * r.xy, r.z);
    let rise = max(r.z, 1e-4) * inverseSqrt(dot(r_stretched, r_stretched));
    // Smith's G2 / G1.
    let g = (1.0 + mu) * rise / (rise + mu);
    let kept = larger * (-0.3625 * larger + 0.3835 * smaller - 0.2283 * d)
        + smaller * (-0.4963 * smaller - 0.5965 * mu - 2.311 * size + 2.033 * d + 1.778 * rise - 1.116)
        + size * 0.9219 * size
        + d * -0.8828 * d;
    let lost = larger * -1.827 * g + 0.3032;
    let incidence = mu * (-0.07943 * mu - 1.232 * rise + 1.195) + rise * 0.8384 * rise + 0.2783;
    let amplitude = saturate(g * g * (1.0 + kept) + (1.0 - g) * lost);
    let m = saturate(incidence - d);
    let fresnel = amplitude * (m * m) * (m * m) * m;
    // The part of the light that Schlick's factor reflects.
    let weighed = max(f90 - f0, 0.0) * fresnel;
    let share = weighed / max(f0 * amplitude + weighed, 1e-30);
    let swell = larger * (-0.9399 * size + 0.9578 * d)
        + smaller * (0.9558 * size + 0.09062)
        + mu * 0.497 * d
        + size * (1.425 * rise - 1.901)
        + share * 0.00433 * d;
    let lift = mu * 1.416 * mu + d * (0.1837 * g + 0.2952) + rise * 2.731 * rise + share * (7.102 * d - 1.708);
    let along = larger * (3.267 * larger - 4.979)
        + mu * 2.982 * mu
        + g * 2.029
        + rise * 2.356
        + share * (-1.539 * rise - 1.178);
    let row = -1.117 + larger * -0.3015 + mu * 1.055 + size * (-2.746 * d + 3.338) + g * -1.342;
    let tilt = a * 0.2705 * a
        + mu * (-0.6464 * smaller - 0.2694)
        + d * (-2.008 * size + 2.739 * rise)
        + rise * -1.71
        + share * 1.383;
    let stretch = a * (0.7308 * a + 1.048 * mu + 0.4492 * smaller - 1.057 + 0.3911 * share);
    let tangent = (1.0 + larger * swell) * r + vec3(0.0, 0.0, larger * lift * (1.0 - c.z));
    // The determinant is a multiple of 1 + rho . wo. Without corrections, it is 2 d^2.
    let rho = tangent + max(d * d - (1.0 + dot(tangent, wo)), 0.0) * wo;
    // The rows of the matrix that turns c to z, and the slope of c's tangent plane.
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
    let inverse = mat3x3(row_x + dot(row_x, wo) * rho, row_y + dot(row_y, wo) * rho, row_z + dot(row_z, wo) * rho);
    return LtcFormula(LtcInverse(transpose(inverse), 1.0), amplitude, fresnel);
}
