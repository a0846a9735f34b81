// Layout reflected: a table stores what is left of each lobe beside a reflection that is known in closed form. Needs
// ltc_math.wgsl and ltc_table.wgsl.

/// Smith's Lambda of GGX.
fn ltc_smith_lambda(alpha_x: f32, alpha_y: f32, w: vec3<f32>) -> f32 {
    let slope = vec2(alpha_x * w.x, alpha_y * w.y) / w.z;
    return 0.5 * (sqrt(1.0 + dot(slope, slope)) - 1.0);
}

/// How a reflected direction moves when the normal wm tilts along a tangent; d = dot(wo, wm).
fn ltc_reflected_tangent(wo: vec3<f32>, wm: vec3<f32>, d: f32, tangent: vec3<f32>) -> vec3<f32> {
    let tilt = tangent - dot(wm, tangent) * wm;
    return 2.0 * (dot(wo, tilt) * wm + d * tilt);
}

/// What the interpolated numbers of layout reflected stand for, at a place within the table's ranges seen from wo in
/// the first quadrant: they are what is left of the lobe beside the reflection at the normal in the middle of those seen.
fn ltc_restore_reflected(stored: LtcLobe, alpha_x: f32, ratio: f32, wo: vec3<f32>) -> LtcLobe {
    let alpha_y = max(alpha_x * ratio, LTC_LEAST_ALPHA);
    let halfway = normalize(vec3(alpha_x * wo.x, alpha_y * wo.y, wo.z)) + vec3(0.0, 0.0, 1.0);
    let wm = normalize(vec3(alpha_x * halfway.x, alpha_y * halfway.y, halfway.z));
    let d = dot(wo, wm);
    let reflected = 2.0 * d * wm - wo;
    let k = mat3x3(
        alpha_x * ltc_reflected_tangent(wo, wm, d, vec3(1.0, 0.0, 0.0)),
        alpha_x * ltc_reflected_tangent(wo, wm, d, vec3(0.0, 1.0, 0.0)),
        reflected,
    );
    let seen = 1.0 + ltc_smith_lambda(alpha_x, alpha_y, wo);
    let g2_over_g1 = seen / (seen + ltc_smith_lambda(alpha_x, alpha_y, reflected));
    let amplitude = stored.amplitude * g2_over_g1 * g2_over_g1;
    let grazing = max(stored.fresnel + 1.0 - d, 0.0);
    let grazing2 = grazing * grazing;
    return LtcLobe(k * stored.m, amplitude, amplitude * (grazing2 * grazing2 * grazing));
}
