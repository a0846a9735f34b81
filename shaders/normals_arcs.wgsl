/// The angle between two unit vectors, divided by its sine. Relative error below 2e-5.
fn normals_angle(a: vec3<f32>, b: vec3<f32>) -> f32 {
    let h = a.x * b.x + (a.y * b.y + (a.z * b.z + 1.0000002));
    let over_root = 2.2214415 + h * (0.5397048 + h * 0.1000458);
    return over_root * inverseSqrt(h) + (-0.9985637 + h * (-0.2744782 + h * -0.0173815));
}

/// Adds the integral of c x dc along the arcs of great circles from a to q and from q to n.
fn normals_arcs(flux: vec3<f32>, a: vec3<f32>, q: vec3<f32>, n: vec3<f32>) -> vec3<f32> {
    // Subtracting q changes nothing, because q x q is zero, but keeps the digits of short arcs.
    let s = normals_angle(q, n) * (n - q) - normals_angle(a, q) * (a - q);
    return vec3(flux.x + q.y * s.z - q.z * s.y, flux.y + q.z * s.x - q.x * s.z, flux.z + q.x * s.y - q.y * s.x);
}
