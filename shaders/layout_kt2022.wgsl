// Layout kt2022: a table stores M and the terms as they are. Needs ltc_quadrant.wgsl and ltc_lookup.wgsl.

/// The place of a configuration among evenly spaced nodes. The first node of alpha and the first node of ratio may be
/// raised to the smallest fitted values. Weights are linear in alpha, ratio and angles.
fn ltc_place_kt2022(alpha: f32, ratio: f32, wo: vec3<f32>) -> LtcPlace {
    let angles = ltc_quadrant(vec2(length(wo.xy), wo.y), vec2(wo.z, wo.x));
    let surface = vec2(alpha, ratio);
    var place = ltc_place(vec4(surface, angles));
    let low = ltc_table.start.xy + place.lower.xy * ltc_table.spacing.xy;
    let below = max(low, ltc_table.roughness.xz);
    let weight = clamp((surface - below) / (low + ltc_table.spacing.xy - below), vec2(0.0), vec2(1.0));
    place.weight = vec4(weight, place.weight.zw);
    return place;
}

/// The lobe from interpolated numbers. Domain: a place within the table's ranges, wo in the first quadrant.
fn ltc_restore_kt2022(stored: LtcLobe, alpha_x: f32, ratio: f32, wo: vec3<f32>) -> LtcLobe {
    return stored;
}
