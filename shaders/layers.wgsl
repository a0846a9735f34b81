// OpenPBR's metals, and coat and fuzz over other layers. A layer transmits the fraction of light that it does not
// reflect (one minus its albedo), so no layer adds energy. These functions work with any light model. Fuzz is an LTC
// and needs no table.

/// The light that a metal reflects, by F82, OpenPBR's Fresnel factor for metals. tint is the fraction of Schlick's
/// factor that remains at 82 degrees. Where F82 makes the light negative, because f0 and tint are low, the result is 0.
/// parts is the reflected light from a light model: for a Fresnel factor of one (x), and weighted by Schlick's fifth
/// power (y). For a table, parts is vec2(amplitude, fresnel) times the covered part.
fn layers_metal(parts: vec2<f32>, f0: vec3<f32>, tint: vec3<f32>) -> vec3<f32> {
    // edge is the light weighted by x (1 - x)^6, where x is the cosine at which Schlick's power equals
    // parts.y / parts.x.
    let one_minus_cos = pow(clamp(parts.y / max(parts.x, 1e-30), 0.0, 1.0), 0.2);
    let one_minus_cos2 = one_minus_cos * one_minus_cos;
    let edge = parts.x * (1.0 - one_minus_cos) * (one_minus_cos2 * one_minus_cos2 * one_minus_cos2);
    // The constants are (6/7)^5 and 1 / ((1/7) (6/7)^6).
    let at_82 = f0 + 0.46266436 * (vec3(1.0) - f0);
    let schlick = f0 * (parts.x - parts.y) + vec3(parts.y);
    return max(schlick - 17.651385 * edge * (vec3(1.0) - tint) * at_82, vec3(0.0));
}

/// The lobe of fuzz for one view.
struct LayersFuzz {
    /// M^-1, for the functions that take the inverse of an LTC.
    inverse: mat3x3<f32>,
    /// The albedo. The reflected light is the albedo times the covered part of the lobe times the radiance.
    albedo: f32,
}

/// The lobe of fuzz with a roughness from 0 to 1, seen from wo, a unit vector in the tangent frame, normal +z.
fn layers_fuzz(roughness: f32, wo: vec3<f32>) -> LayersFuzz {
    let y = clamp(roughness, 0.01, 1.0);
    let x = clamp(wo.z, 0.0, 1.0);
    // The fits of Zeltner, Burley and Chiang 2022, from MaterialX (Apache-2.0).
    let a = (2.58126 * x + 0.813703 * y) * y / (1.0 + 0.310327 * x * x + 2.60994 * x * y);
    let b = sqrt(1.0 - x) * (y - 1.0) * y * y * y / (0.0000254053 + 1.71228 * x - 1.71506 * x * y + 1.34174 * y * y);
    let width = y * (0.0206607 + 1.58491 * y) / (0.0379424 + y * (1.32227 + y));
    let middle = y * (-0.193854 + y * (-1.14885 + y * (1.7932 - 0.95943 * y * y))) / (0.046391 + y);
    let offset = y * (0.000654023 + (-0.0207818 + 0.119681 * y) * y) / (1.26264 + y * (-1.92021 + y));
    let away = (x - middle) / width;
    let albedo = max(exp(-0.5 * away * away) / (2.5066283 * width) + offset, 1e-6);
    // The lobe is symmetric about the plane of incidence. For a view from straight above, any plane works.
    let size = length(wo.xy);
    let along = select(vec2(1.0, 0.0), wo.xy / max(size, 1e-30), size > 1e-30);
    let inverse = mat3x3<f32>(vec3(a * along.x, -a * along.y, 0.0), vec3(a * along.y, a * along.x, 0.0), vec3(b, 0.0, 1.0));
    return LayersFuzz(inverse, albedo);
}

/// The albedo of a dielectric from the terms of a table's lobe. f0 is 0.04 for a refractive index of 1.5; f90 is 1.
fn layers_albedo(amplitude: f32, fresnel: f32, f0: f32) -> f32 {
    return f0 * (amplitude - fresnel) + fresnel;
}

/// The reflected light of a base under a coat. weight is the coverage of the coat. base and coat are the light that
/// each would reflect alone. albedo is the albedo of the coat, and transmittance is its colour.
fn layers_coated(base: vec3<f32>, coat: vec3<f32>, albedo: f32, weight: f32, transmittance: vec3<f32>) -> vec3<f32> {
    return weight * coat + mix(vec3(1.0), (1.0 - albedo) * transmittance, vec3(weight)) * base;
}

/// The reflected light of fuzz over other layers. weight is the coverage of the fuzz. below is the light of the other
/// layers. fuzz includes the fuzz colour; albedo does not.
fn layers_fuzzed(below: vec3<f32>, fuzz: vec3<f32>, albedo: f32, weight: f32) -> vec3<f32> {
    return weight * fuzz + (1.0 - weight * albedo) * below;
}
