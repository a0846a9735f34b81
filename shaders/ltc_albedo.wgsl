// The albedo of GGX, without a table.

/// The albedo of GGX for a Fresnel factor of one: one minus the energy lost to shadowing. The error of the cubic
/// polynomial is .0045 on average and at most .056 for views up to 88 degrees [ltcforge-studies, albedo].
fn ltc_albedo(alpha_x: f32, alpha_y: f32, view: vec3<f32>) -> f32 {
    // Interpolated normals may face away from the viewer, so view.z may be negative.
    let wo = vec3(view.xy, max(view.z, 1e-4));
    let alpha = vec3(max(vec2(alpha_x, alpha_y), vec2(1e-5)), 1.0);
    let stretched = alpha * wo;
    let per_length = inverseSqrt(dot(stretched, stretched));
    // G2 / G1 for the view reflected at the middle of the visible normals.
    let normal = alpha * (stretched * per_length + vec3(0.0, 0.0, 1.0));
    let reflected = normal * (2.0 * dot(wo, normal) / dot(normal, normal)) - wo;
    let out = alpha * reflected;
    let rise = vec2(wo.z * per_length, max(reflected.z, 0.0) * inverseSqrt(dot(out, out)));
    let lit = (1.0 + rise.x) * rise.y / (rise.x + rise.y);
    let v = vec4(rise.x, 1.0 - lit, max(alpha.x, alpha.y), min(alpha.x, alpha.y));
    let of_s = 5.363 + dot(vec4(-16.3138, 16.1379, 0.6751, 2.6458), v)
        + v.x * dot(vec4(13.3242, 12.9676, -2.6392, -0.9361), v)
        + v.y * dot(vec3(1.4565, 4.1804, 1.1242), v.yzw)
        + v.z * dot(vec2(0.2994, 0.2718), v.zw) + -7.0761 * v.w * v.w;
    let of_a = -0.2305 + dot(vec3(0.5096, 0.667, 0.2056), v.xzw)
        + v.x * dot(vec3(-0.2558, 0.1556, -0.2097), v.xzw)
        + v.z * dot(vec2(-0.3646, -0.0675), v.zw) + -0.3276 * v.w * v.w;
    let of_b = -0.3395 + dot(vec2(0.7035, 0.7827), v.xw)
        + v.x * dot(vec2(-0.3537, 0.0475), v.xw) + -0.2428 * v.w * v.w;
    return clamp(1.0 - (v.y * of_s + v.z * of_a + v.w * of_b), 0.2, 1.0);
}
