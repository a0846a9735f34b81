// The preview's lobes over the sphere of directions. Needs sphere.wgsl and the files that it needs.

/// xyz: the direction of a pixel on the sphere of directions, seen from far away. w: 0 outside the sphere, else 1. The
/// rim is not antialiased, because pixels store densities.
fn direction_of(place: vec3<f32>) -> vec4<f32> {
    let flat = place.xy * 1.05;
    let height2 = 1.0 - dot(flat, flat);
    let towards = sqrt(max(height2, 0.0));
    let wi = scene.right.xyz * flat.x + scene.up.xyz * flat.y - scene.forward.xyz * towards;
    return vec4(wi, select(0.0, 1.0, height2 > 0.0));
}

/// The value of pixels outside the sphere, and the value of directions below the horizon that have density zero.
const BESIDE: f32 = -1.0;
const BELOW: f32 = -0.5;

/// The density of the table's lobe, per steradian.
@compute @workgroup_size(8, 8)
fn lobe_by_table(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_id) local: vec3<u32>) {
    let pixel = pixel_of(group, local);
    if (any(pixel >= vec2(scene.options.x))) {
        return;
    }
    let wi = direction_of(place_of(pixel));
    var density = BESIDE;
    if (wi.w > 0.0) {
        let lobe = ltc_lookup(scene.materials[0].x, scene.materials[0].y, scene.lobe_wo.xyz);
        // The density is c.z |det M^-1| / (pi |c|^4), where c = M^-1 wi. The computed inverse has a factor f, which
        // cancels: the numerator has f^3 from the determinant and f from c, and the denominator has f^4.
        let inverse = ltc_inverse(lobe.m);
        let c = inverse.m * wi.xyz;
        let length2 = dot(c, c);
        density = max(c.z, 0.0) * abs(determinant(inverse.m)) / (3.14159265 * max(length2 * length2, 1e-36)) * lobe.amplitude;
        density = select(density, BELOW, wi.z < 0.0 && density <= 0.0);
    }
    write(pixel, vec3(density));
}

/// The density of GGX times the cosine, per steradian.
@compute @workgroup_size(8, 8)
fn lobe_by_reference(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_id) local: vec3<u32>) {
    let pixel = pixel_of(group, local);
    if (any(pixel >= vec2(scene.options.x))) {
        return;
    }
    let wi = direction_of(place_of(pixel));
    var density = BESIDE;
    if (wi.w > 0.0) {
        density = select(0.0, BELOW, wi.z < 0.0);
        if (wi.z > GGX_HORIZON) {
            let alpha = max(scene.materials[0].xy, vec2(LTC_LEAST_ALPHA));
            let wo = scene.lobe_wo.xyz;
            let wm = normalize(wo + wi.xyz);
            let g2 = 1.0 / (1.0 + ggx_lambda(alpha, wo) + ggx_lambda(alpha, wi.xyz));
            density = ggx_distribution(alpha, wm) * g2 / (4.0 * wo.z);
        }
    }
    write(pixel, vec3(density));
}
