// Reads tables with two lobes per entry: the whole lobe, and the lobe weighted by Schlick's fifth power. Needs
// ltc_lookup.wgsl or ltc_lookup_round.wgsl.
//
// The reflected light of radiance L is, with two integrals,
//     L (f0 amplitude covered(first) + (f90 - f0) fresnel covered(second)),
// or, with one integral and ltc_blend,
//     L (f0 (amplitude - fresnel) + f90 fresnel) covered(blend).

/// The two lobes of a surface seen from one direction. amplitude and fresnel of the first lobe apply to both lobes.
struct LtcLobes {
    first: LtcLobe,
    second: mat3x3<f32>,
}

/// Both lobes of the table for a surface and a view direction, as in ltc_lookup. A table with one lobe per entry
/// returns it twice.
fn ltc_lookup_both(alpha_x: f32, alpha_y: f32, wo: vec3<f32>) -> LtcLobes {
    let view = ltc_view(alpha_x, alpha_y, wo);
    return LtcLobes(ltc_lobe_at(view, 0u), ltc_lobe_at(view, ltc_table.reading.z).m);
}

/// A single matrix for a material: the mean of both lobes, weighted by their light. For a coloured f0, pass its mean.
fn ltc_blend(lobes: LtcLobes, f0: f32, f90: f32) -> mat3x3<f32> {
    let weighed = max(f90 - f0, 0.0) * lobes.first.fresnel;
    let w = weighed / max(f0 * lobes.first.amplitude + weighed, 1e-30);
    return lobes.first.m * (1.0 - w) + lobes.second * w;
}
