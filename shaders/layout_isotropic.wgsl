// Layouts of tables for isotropic surfaces: inverse, matrix33, and ltc2017, ltc2016, godot and hdrp, which engines
// read. A table stores M or its inverse. Needs ltc_quadrant.wgsl.

/// A matrix that is symmetric about the plane of incidence. Its columns x and z lie in this plane. y is the only
/// nonzero number of its column across the plane.
struct LtcPlane {
    x: vec2<f32>,
    y: f32,
    z: vec2<f32>,
}

/// The coordinates for nodes that are evenly spaced in the perceptual roughness sqrt(alpha) and in theta.
fn ltc_steps_roughness(alpha: f32, wo: vec3<f32>) -> vec2<f32> {
    return vec2(sqrt(alpha), ltc_quadrant(vec2(length(wo.xy)), vec2(wo.z)).x);
}

/// The coordinates for nodes that are evenly spaced in the perceptual roughness sqrt(alpha) and in sqrt(1 - cos theta).
fn ltc_steps_versine(alpha: f32, wo: vec3<f32>) -> vec2<f32> {
    // The quotient is 1 - cos theta, without cancellation if the cosine is near 1.
    return sqrt(vec2(alpha, dot(wo.xy, wo.xy) / (1.0 + max(wo.z, 0.0))));
}

/// M from a table that stores M.
fn ltc_restore_matrix(stored: LtcPlane) -> LtcPlane {
    return stored;
}

/// M, up to a factor, from a table that stores the inverse of M.
fn ltc_restore_inverse(stored: LtcPlane) -> LtcPlane {
    let determinant = stored.x.x * stored.z.y - stored.z.x * stored.x.y;
    let scale = inverseSqrt(stored.x.x * stored.x.x + stored.z.x * stored.z.x);
    return LtcPlane(
        vec2(stored.z.y, -stored.x.y) * scale,
        determinant / stored.y * scale,
        vec2(-stored.z.x, stored.x.x) * scale,
    );
}
