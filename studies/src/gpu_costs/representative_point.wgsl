// GGX towards the point of the light that is nearest to the mirrored view, times the light's solid angle [Lagarde and
// de Rousiers 2014]. The lobe's peak is lowered as much as the light widens the lobe [Karis 2013].
fn engine_triangle(a: vec3<f32>, b: vec3<f32>, c: vec3<f32>) -> f32 {
    return 2.0 * atan2(abs(dot(cross(a, b), c)), 1.0 + dot(a, b) + dot(b, c) + dot(c, a));
}

fn lit(alpha: vec2<f32>, local: Local) -> vec4<f32> {
    let corner = local.corners[0];
    let x = local.corners[1] - corner;
    let y = local.corners[3] - corner;
    let across = cross(x, y);
    let mirrored = vec3(-local.wo.xy, local.wo.z);
    let height = dot(corner, across);
    let descent = dot(mirrored, across) / height;
    let met = select(1e4 * mirrored, mirrored / descent, descent > 1e-4) - corner;
    let point = corner + saturate(dot(met, x) / dot(x, x)) * x + saturate(dot(met, y) / dot(y, y)) * y;
    let wi = normalize(point);
    let h = normalize(local.wo + wi);
    let slope = vec3(h.xy / alpha, h.z);
    let density = dot(slope, slope);
    let shadow = wi.z * length(vec3(alpha * local.wo.xy, local.wo.z)) + local.wo.z * length(vec3(alpha * wi.xy, wi.z));
    let lobe = 0.5 * wi.z / (3.14159265 * alpha.x * alpha.y * density * density * shadow);
    let centre = corner + 0.5 * (x + y);
    let widened = min(alpha + 0.25 * sqrt(length(across)) * inverseSqrt(dot(centre, centre)), vec2(1.0));
    let peak = alpha.x * alpha.y / (widened.x * widened.y);
    let a = normalize(corner);
    let b = normalize(local.corners[1]);
    let c = normalize(local.corners[2]);
    let d = normalize(local.corners[3]);
    let angle = engine_triangle(a, b, c) + engine_triangle(a, c, d);
    let weight = 1.0 - saturate(dot(local.wo, h));
    let squared = weight * weight;
    let lit = saturate(select(0.0, lobe * peak * angle, height > 0.0 && wi.z > 0.0));
    return vec4(lit, lit * squared * squared * weight, 0.0, 0.0);
}
