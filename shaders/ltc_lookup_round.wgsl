// Reads a table of isotropic surfaces: the lobe is symmetric about the plane of incidence and rotates with the view.
// Needs ltc_table.wgsl, and the functions ltc_steps and ltc_restore, which call the functions of a layout.
// `ltcforge shader` writes both functions.

/// Interpolates the 4 entries around a place in the shader. Weights are exact, and any texture format works. `layer` is
/// the first layer of the lobe.
fn ltc_fetch_weighed(place: vec2<f32>, layer: u32) -> LtcTexels {
    let last = ltc_table.nodes.xz - vec2(1u);
    let at = clamp(place, vec2(0.0), vec2<f32>(last));
    let lower = vec2<u32>(at);
    let upper = min(lower + vec2(1u), last);
    let weight = fract(at);
    let near = vec3(0u, lower.y, lower.x + layer);
    let far = vec3(0u, upper.y, upper.x + layer);
    let low = ltc_mix(ltc_fetch(near), ltc_fetch(vec3(far.xy, near.z)), weight.y);
    let high = ltc_mix(ltc_fetch(vec3(near.xy, far.z)), ltc_fetch(far), weight.y);
    return ltc_mix(low, high, weight.x);
}

/// A surface and a view: their place among the nodes of alpha and theta, and the direction of the view's azimuth.
struct LtcView {
    place: vec2<f32>,
    ahead: vec2<f32>,
}

/// Finds the place of a configuration. For an anisotropic surface, the larger roughness counts. wo is the view
/// direction in the tangent frame, normal +z, of unit length.
fn ltc_view(alpha_x: f32, alpha_y: f32, wo: vec3<f32>) -> LtcView {
    let alpha = clamp(max(alpha_x, alpha_y), LTC_LEAST_ALPHA, 1.0);
    // The azimuth is 0 for a view from straight above.
    let flat = wo.xy + vec2(1e-18, 0.0);
    let ahead = flat * inverseSqrt(dot(flat, flat));
    let place = (ltc_steps(alpha, vec3(flat, wo.z)) - ltc_table.start.xz) * ltc_table.per_step.xz;
    return LtcView(place, ahead);
}

/// The lobe whose first layer is `layer`.
fn ltc_lobe_at(view: LtcView, layer: u32) -> LtcLobe {
    let ahead = view.ahead;
    var texels: LtcTexels;
    if (ltc_hardware_filter) {
        let middle = view.place + vec2(0.5);
        texels = ltc_sample(vec2(0.5, middle.y * ltc_table.texel.y), middle.x, layer);
    } else {
        texels = ltc_fetch_weighed(view.place, layer);
    }
    // The two columns in the plane of incidence; texels.b.x is the number across the plane.
    let x = vec2(texels.a.x, texels.b.z);
    let z = vec2(texels.a.z, texels.terms.x);
    let plane = ltc_restore(LtcPlane(x, texels.b.x, z));
    // The lobe rotates by the azimuth of the view.
    let along = plane.x.x * ahead;
    let across = plane.y * ahead;
    let m = mat3x3(
        vec3(along * ahead.x + vec2(across.y, -across.x) * ahead.y, plane.x.y * ahead.x),
        vec3(along * ahead.y - vec2(across.y, -across.x) * ahead.x, plane.x.y * ahead.y),
        vec3(plane.z.x * ahead, plane.z.y),
    );
    return LtcLobe(m, texels.terms.y, texels.terms.z);
}

/// The lobe of the table for a surface and a view direction. wo is as in ltc_view.
fn ltc_lookup(alpha_x: f32, alpha_y: f32, wo: vec3<f32>) -> LtcLobe {
    return ltc_lobe_at(ltc_view(alpha_x, alpha_y, wo), 0u);
}
