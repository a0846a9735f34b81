// The nodes of layout reflected. Needs ltc_quadrant.wgsl and ltc_lookup.wgsl.

/// The place of a configuration among the nodes. Nodes are evenly spaced in u, where alpha = u^1.6, ratio = u^1.3,
/// phi = u and theta = (1 - (1 - u)^2) 0.9999 pi/2. Weights are linear in alpha, ratio, theta and phi.
fn ltc_place_reflected(alpha: f32, ratio: f32, wo: vec3<f32>) -> LtcPlace {
    let angles = ltc_quadrant(vec2(length(wo.xy), wo.y), vec2(wo.z, wo.x));
    let theta = 0.63668344 * angles.x;
    let powers = vec2(1.6, 1.3);
    let surface = vec2(alpha, ratio);
    var place = ltc_place(vec4(pow(surface, 1.0 / powers), 1.0 - sqrt(max(1.0 - theta, 0.0)), angles.y));
    let below = ltc_table.start.xyz + place.lower.xyz * ltc_table.spacing.xyz;
    let above = below + ltc_table.spacing.xyz;
    let low = vec3(pow(below.xy, powers), (2.0 - below.z) * below.z);
    let high = vec3(pow(above.xy, powers), (2.0 - above.z) * above.z);
    let weight = clamp((vec3(surface, theta) - low) / (high - low), vec3(0.0), vec3(1.0));
    place.weight = vec4(weight, place.weight.w);
    return place;
}
