// Layout reflected: a table stores what is left of each lobe beside a reflection that is known in closed form. Needs
// LtcLobe and LTC_LEAST_ALPHA, which ltc_table.wgsl has; place_reflected.wgsl has its nodes.

/// What the interpolated numbers of layout reflected stand for, at a place within the table's ranges seen from wo in
/// the first quadrant: they are what is left of the lobe beside the reflection at the normal in the middle of those seen.
fn ltc_restore_reflected(stored: LtcLobe, alpha_x: f32, ratio: f32, wo: vec3<f32>) -> LtcLobe {
    let alpha = vec3(alpha_x, max(alpha_x * ratio, LTC_LEAST_ALPHA), 1.0);
    let seen = alpha * wo;
    let seen2 = dot(seen, seen);
    let per_seen = inverseSqrt(seen2);
    let wm = normalize(alpha * (seen * per_seen + vec3(0.0, 0.0, 1.0)));
    let d = dot(wo, wm);
    let reflected = 2.0 * d * wm - wo;
    // The reflected direction moves by 2 (d t - (reflected . t) wm) as the normal wm tilts along t: the columns of a matrix K for
    // t along x and y, times alpha_x, and reflected itself. M is K times what is stored.
    let s = stored.m;
    let x = 2.0 * alpha_x * s[0].xy;
    let y = 2.0 * alpha_x * s[1].xy;
    let z = 2.0 * alpha_x * s[2].xy;
    let m = mat3x3(
        vec3(d * x, 0.0) - dot(reflected.xy, x) * wm + s[0].z * reflected,
        vec3(d * y, 0.0) - dot(reflected.xy, y) * wm + s[1].z * reflected,
        vec3(d * z, 0.0) - dot(reflected.xy, z) * wm + s[2].z * reflected,
    );
    // Smith's G2 over G1, of lengths where the surface is a hemisphere.
    let out = alpha * reflected;
    let height = abs(reflected.z);
    let size = seen2 * per_seen;
    let g2_over_g1 = height * (size + wo.z) / max(height * size + wo.z * sqrt(dot(out, out)), 1e-30);
    let amplitude = stored.amplitude * g2_over_g1 * g2_over_g1;
    let grazing = max(stored.fresnel + 1.0 - d, 0.0);
    let grazing2 = grazing * grazing;
    return LtcLobe(m, amplitude, amplitude * (grazing2 * grazing2 * grazing));
}
