// Metals, and how a coat and fuzz combine with what lies below, as OpenPBR layers them: each layer passes on what it does
// not reflect of all light, so that no light is gained. For light by any model; fuzz is an LTC and needs no table.

/// What a metal reflects by F82, its Fresnel factor in OpenPBR: tint is the part of Schlick's factor that is left at 82
/// degrees, which may come out negative where f0 is dark and the tint low, as the formula has it. parts is the light by a model: for a Fresnel factor of one, and its part weighed by Schlick's fifth power; of a
/// table amplitude and Fresnel term, each times the part that the light covers.
fn layers_metal(parts: vec2<f32>, f0: vec3<f32>, tint: vec3<f32>) -> vec3<f32> {
    // The light weighed by x (1 - x)^6, of the incidence at which Schlick's power is the quotient of both.
    let away = pow(clamp(parts.y / max(parts.x, 1e-30), 0.0, 1.0), 0.2);
    let away2 = away * away;
    let edge = parts.x * (1.0 - away) * (away2 * away2 * away2);
    // (6/7)^5, and one over (1/7) (6/7)^6.
    let at_82 = f0 + 0.46266436 * (vec3(1.0) - f0);
    return f0 * (parts.x - parts.y) + vec3(parts.y) - 17.651385 * edge * (vec3(1.0) - tint) * at_82;
}

/// Fuzz as one view sees it.
struct LayersFuzz {
    /// M^-1, for the functions that take the inverse of an LTC.
    inverse: mat3x3<f32>,
    /// The part of all light that it reflects: what it reflects of a light is this times the part that the light covers.
    albedo: f32,
}

/// The fuzz of a roughness from 0 to 1, seen from wo, of unit length in the tangent frame, normal +z.
fn layers_fuzz(roughness: f32, wo: vec3<f32>) -> LayersFuzz {
    let y = clamp(roughness, 0.01, 1.0);
    let x = clamp(wo.z, 0.0, 1.0);
    // Zeltner, Burley and Chiang 2022, by the functions of MaterialX (Apache-2.0).
    let a = (2.58126 * x + 0.813703 * y) * y / (1.0 + 0.310327 * x * x + 2.60994 * x * y);
    let b = sqrt(1.0 - x) * (y - 1.0) * y * y * y / (0.0000254053 + 1.71228 * x - 1.71506 * x * y + 1.34174 * y * y);
    let width = y * (0.0206607 + 1.58491 * y) / (0.0379424 + y * (1.32227 + y));
    let middle = y * (-0.193854 + y * (-1.14885 + y * (1.7932 - 0.95943 * y * y))) / (0.046391 + y);
    let offset = y * (0.000654023 + (-0.0207818 + 0.119681 * y) * y) / (1.26264 + y * (-1.92021 + y));
    let away = (x - middle) / width;
    let albedo = max(exp(-0.5 * away * away) / (2.5066283 * width) + offset, 1e-6);
    // The lobe lies in the plane of the view; from above any will do.
    let size = length(wo.xy);
    let along = select(vec2(1.0, 0.0), wo.xy / max(size, 1e-30), size > 1e-30);
    let inverse = mat3x3<f32>(vec3(a * along.x, -a * along.y, 0.0), vec3(a * along.y, a * along.x, 0.0), vec3(b, 0.0, 1.0));
    return LayersFuzz(inverse, albedo);
}

/// What a table's lobe of a dielectric reflects of all light: f0 from above, 0.04 for an index of 1.5, and 1 at grazing views.
fn layers_albedo(amplitude: f32, fresnel: f32, f0: f32) -> f32 {
    return f0 * (amplitude - fresnel) + fresnel;
}

/// The light of a base under a coat that covers the part weight of it: base and coat are what each reflects by itself, albedo
/// what the coat reflects of all light, transmittance its colour.
fn layers_coated(base: vec3<f32>, coat: vec3<f32>, albedo: f32, weight: f32, transmittance: vec3<f32>) -> vec3<f32> {
    return weight * coat + mix(vec3(1.0), (1.0 - albedo) * transmittance, vec3(weight)) * base;
}

/// The light of all below under fuzz that covers the part weight of it; fuzz has its colour, and albedo has not.
fn layers_fuzzed(below: vec3<f32>, fuzz: vec3<f32>, albedo: f32, weight: f32) -> vec3<f32> {
    return weight * fuzz + (1.0 - weight * albedo) * below;
}
