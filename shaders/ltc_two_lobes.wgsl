// Tables with two lobes an entry: of the whole lobe, and of the part of it that Schlick's fifth power weighs. Needs a lookup.
//
// Light of radiance L arrives, by two integrals, as
//     L (f0 amplitude covered(first) + (f90 - f0) fresnel covered(second)),
// or by one, of ltc_blend, as
//     L (f0 (amplitude - fresnel) + f90 fresnel) covered(blend).

/// The lobes of a surface seen from one direction. amplitude and fresnel are those of both.
struct LtcLobes {
    first: LtcLobe,
    second: mat3x3<f32>,
}

/// Both lobes of the table at a surface and a view direction, as in ltc_lookup; of a table of one lobe that one twice.
fn ltc_lookup_both(alpha_x: f32, alpha_y: f32, wo: vec3<f32>) -> LtcLobes {
    let seen = ltc_seen(alpha_x, alpha_y, wo);
    return LtcLobes(ltc_lobe_at(seen, 0u), ltc_lobe_at(seen, ltc_table.reading.z).m);
}

/// The matrix of one lobe for a material, by the part of its light that the second lobe has. Of a coloured f0 take the mean.
fn ltc_blend(lobes: LtcLobes, f0: f32, f90: f32) -> mat3x3<f32> {
    let weighed = max(f90 - f0, 0.0) * lobes.first.fresnel;
    let w = weighed / max(f0 * lobes.first.amplitude + weighed, 1e-30);
    return lobes.first.m * (1.0 - w) + lobes.second * w;
}
