// Tables with two lobes an entry: the whole lobe, and the part weighed by Schlick's fifth power. Needs a lookup.
//
// Light of radiance L arrives, with two integrals, as
//     L (f0 amplitude covered(first) + (f90 - f0) fresnel covered(second)),
// or, with one integral by ltc_blend, as
//     L (f0 (amplitude - fresnel) + f90 fresnel) covered(blend).

/// The two lobes of a surface seen from one direction. amplitude and fresnel of the first apply to both.
struct LtcLobes {
    first: LtcLobe,
    second: mat3x3<f32>,
}

/// Both lobes of the table for a surface and a view direction, as in ltc_lookup. A table of one lobe gives it twice.
fn ltc_lookup_both(alpha_x: f32, alpha_y: f32, wo: vec3<f32>) -> LtcLobes {
    let seen = ltc_seen(alpha_x, alpha_y, wo);
    return LtcLobes(ltc_lobe_at(seen, 0u), ltc_lobe_at(seen, ltc_table.reading.z).m);
}

/// A single matrix for a material: the mean of both lobes, weighed by their light. For a coloured f0 pass the mean.
fn ltc_blend(lobes: LtcLobes, f0: f32, f90: f32) -> mat3x3<f32> {
    let weighed = max(f90 - f0, 0.0) * lobes.first.fresnel;
    let w = weighed / max(f0 * lobes.first.amplitude + weighed, 1e-30);
    return lobes.first.m * (1.0 - w) + lobes.second * w;
}
