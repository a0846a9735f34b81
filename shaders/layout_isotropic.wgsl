// Layouts for isotropic surfaces: ltc2017, ltc2016, godot and hdrp as engines read them, and inverse and matrix33. A
// table stores M or its inverse. Needs ltc_quadrant.wgsl.

/// A matrix symmetric in the plane of incidence: its two columns in this plane, x and z, and the number y across the
/// plane.
struct LtcPlane {
    x: vec2<f32>,
    y: f32,
    z: vec2<f32>,
}

/// The coordinates of evenly spaced nodes: the perceptual roughness sqrt(alpha), and theta.
fn ltc_steps_roughness(alpha: f32, wo: vec3<f32>) -> vec2<f32> {
    return vec2(sqrt(alpha), ltc_quadrant(vec2(length(wo.xy)), vec2(wo.z)).x);
}

/// The coordinates of evenly spaced nodes: the perceptual roughness sqrt(alpha), and sqrt(1 - cos theta).
fn ltc_steps_versine(alpha: f32, wo: vec3<f32>) -> vec2<f32> {
    // The quotient is 1 - cos theta, without cancellation near 1.
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
