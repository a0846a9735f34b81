// Layouts ltc2017, ltc2016, godot and hdrp, tables of isotropic surfaces as engines read them, and inverse and matrix33: of M
// or of its inverse. Needs ltc_quadrant.wgsl.

/// A matrix of a lobe that is symmetric in the plane of incidence: two columns in that plane, x and z, and the number across it.
struct LtcPlane {
    x: vec2<f32>,
    y: f32,
    z: vec2<f32>,
}

/// Nodes are evenly spaced in the perceptual roughness, the square root of alpha, and in theta.
fn ltc_steps_roughness(alpha: f32, wo: vec3<f32>) -> vec2<f32> {
    return vec2(sqrt(alpha), ltc_quadrant(vec2(length(wo.xy)), vec2(wo.z)).x);
}

/// Nodes are evenly spaced in the perceptual roughness and in sqrt(1 - cos theta).
fn ltc_steps_versine(alpha: f32, wo: vec3<f32>) -> vec2<f32> {
    // 1 - cos, without a difference of numbers near 1.
    return sqrt(vec2(alpha, dot(wo.xy, wo.xy) / (1.0 + max(wo.z, 0.0))));
}

/// The table stores M.
fn ltc_restore_matrix(stored: LtcPlane) -> LtcPlane {
    return stored;
}

/// The table stores the inverse of M, up to a factor.
fn ltc_restore_inverse(stored: LtcPlane) -> LtcPlane {
    let determinant = stored.x.x * stored.z.y - stored.z.x * stored.x.y;
    let scale = inverseSqrt(stored.x.x * stored.x.x + stored.z.x * stored.z.x);
    return LtcPlane(
        vec2(stored.z.y, -stored.x.y) * scale,
        determinant / stored.y * scale,
        vec2(-stored.z.x, stored.x.x) * scale,
    );
}
