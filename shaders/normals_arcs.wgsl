/// The angle between two unit vectors, divided by its sine. Relative error below 1.3e-4.
fn normals_angle(a: vec3<f32>, b: vec3<f32>) -> f32 {
    let h = a.x * b.x + (a.y * b.y + (a.z * b.z + 1.0000002));
    return (2.2214415 + h * (0.5054863 + h * 0.0397516)) * inverseSqrt(h) + (-0.9934988 + h * -0.2022361);
}

/// Adds the integral of c x dc along the arcs of great circles from a to q and from q to n.
fn normals_arcs(flux: vec3<f32>, a: vec3<f32>, q: vec3<f32>, n: vec3<f32>) -> vec3<f32> {
    // Subtracting q changes nothing, because q x q is zero, but keeps the digits of short arcs.
    let s = normals_angle(q, n) * (n - q) - normals_angle(a, q) * (a - q);
    return vec3(flux.x + q.y * s.z - q.z * s.y, flux.y + q.z * s.x - q.x * s.z, flux.z + q.x * s.y - q.y * s.x);
}
