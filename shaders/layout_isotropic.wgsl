// Layouts ltc2017, ltc2016, godot and hdrp, tables of isotropic surfaces as engines read them, and inverse and matrix33: of M
// or of its inverse.
// Needs ltc_math.wgsl and ltc_table.wgsl.

/// Weights are linear in the perceptual roughness, the square root of alpha, and in theta.
fn ltc_even_roughness(axis: u32, x: f32) -> f32 {
    return select(x, sqrt(x), axis == 0u);
}

/// Weights are linear in the perceptual roughness and in sqrt(1 - cos theta), which is sqrt(2) sin(theta / 2).
fn ltc_even_versine(axis: u32, x: f32) -> f32 {
    if (axis == 2u) {
        return ltc_sin_cos(x * 0.07957747).x;
    }
    return ltc_even_roughness(axis, x);
}

/// The table stores M.
fn ltc_restore_matrix(stored: LtcLobe, alpha_x: f32, ratio: f32, wo: vec3<f32>) -> LtcLobe {
    return stored;
}

/// The table stores the inverse of M, up to a factor. Only the numbers of a lobe that is symmetric in the plane of
/// incidence count.
fn ltc_restore_inverse(stored: LtcLobe, alpha_x: f32, ratio: f32, wo: vec3<f32>) -> LtcLobe {
    let n = stored.m;
    let determinant = n[0].x * n[2].z - n[2].x * n[0].z;
    let m = mat3x3(
        vec3(n[2].z, 0.0, -n[0].z),
        vec3(0.0, determinant / n[1].y, 0.0),
        vec3(-n[2].x, 0.0, n[0].x),
    );
    return LtcLobe(m * (1.0 / length(vec2(n[0].x, n[2].x))), stored.amplitude, stored.fresnel);
}
