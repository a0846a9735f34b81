// Layout reflected: a table stores each lobe relative to a reflection that is known in closed form. Needs LtcLobe and
// LTC_LEAST_ALPHA from ltc_table.wgsl. The nodes are in place_reflected.wgsl.

/// The lobe from interpolated numbers of layout reflected. The numbers are relative to the reflection at wm, the middle
/// of the visible normals. Domain: a place within the table's ranges, wo in the first quadrant.
fn ltc_restore_reflected(stored: LtcLobe, alpha_x: f32, ratio: f32, wo: vec3<f32>) -> LtcLobe {
    let alpha = vec3(alpha_x, max(alpha_x * ratio, LTC_LEAST_ALPHA), 1.0);
    let stretched = alpha * wo;
    let stretched2 = dot(stretched, stretched);
    let per_length = inverseSqrt(stretched2);
    let wm = normalize(alpha * (stretched * per_length + vec3(0.0, 0.0, 1.0)));
    let d = dot(wo, wm);
    let reflected = 2.0 * d * wm - wo;
    // As the normal wm tilts along t, the reflected direction moves by 2 (d t - (reflected . t) wm). The first two
    // columns of a matrix K are this motion times alpha_x, for t along x and along y. The third column is the reflected
    // direction. M is K times the stored matrix.
    let s = stored.m;
    let x = 2.0 * alpha_x * s[0].xy;
    let y = 2.0 * alpha_x * s[1].xy;
    let z = 2.0 * alpha_x * s[2].xy;
    let m = mat3x3(
        vec3(d * x, 0.0) - dot(reflected.xy, x) * wm + s[0].z * reflected,
        vec3(d * y, 0.0) - dot(reflected.xy, y) * wm + s[1].z * reflected,
        vec3(d * z, 0.0) - dot(reflected.xy, z) * wm + s[2].z * reflected,
    );
    // Smith's G2 / G1, from lengths in the space where the surface is a hemisphere.
    let out = alpha * reflected;
    let height = abs(reflected.z);
    let size = stretched2 * per_length;
    let g2_over_g1 = height * (size + wo.z) / max(height * size + wo.z * sqrt(dot(out, out)), 1e-30);
    let amplitude = stored.amplitude * g2_over_g1 * g2_over_g1;
    let grazing = max(stored.fresnel + 1.0 - d, 0.0);
    let grazing2 = grazing * grazing;
    return LtcLobe(m, amplitude, amplitude * (grazing2 * grazing2 * grazing));
}
