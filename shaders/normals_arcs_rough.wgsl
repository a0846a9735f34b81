/// The angle between two unit vectors, divided by its sine. Relative error below 8e-4.
fn normals_angle(a: vec3<f32>, b: vec3<f32>) -> f32 {
    let h = a.x * b.x + (a.y * b.y + (a.z * b.z + 1.0000002));
    return (2.2214415 + h * 0.4152027) * inverseSqrt(h) + (-0.9720743 + h * -0.0933735);
}

/// Adds the integral of c x dc along the arcs of great circles from a to q and from q to n.
fn normals_arcs(flux: vec3<f32>, a: vec3<f32>, q: vec3<f32>, n: vec3<f32>) -> vec3<f32> {
    let s = normals_angle(q, n) * n - normals_angle(a, q) * a;
    return vec3(flux.x + q.y * s.z - q.z * s.y, flux.y + q.z * s.x - q.x * s.z, flux.z + q.x * s.y - q.y * s.x);
}
