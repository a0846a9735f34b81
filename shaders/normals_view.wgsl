/// A surface seen from direction wo. A = diag(alpha, 1).
struct NormalsView {
    alpha: vec2<f32>,
    per_alpha: vec2<f32>,
    wo: vec3<f32>,
    image: vec3<f32>, // A^-1 wo
    stretched: vec3<f32>, // A wo
    length: f32, // length of A wo
    rise: f32, // rise of wo
}

/// Computes the view for all lights at a point. alpha is in (0, 1]. wo is a unit vector in the tangent frame,
/// normal +z.
fn normals_view(alpha_x: f32, alpha_y: f32, wo: vec3<f32>) -> NormalsView {
    let alpha = max(vec2(alpha_x, alpha_y), vec2(1e-5));
    let stretched = vec3(alpha * wo.xy, wo.z);
    let length = sqrt(dot(stretched, stretched));
    return NormalsView(alpha, 1.0 / alpha, wo, vec3(wo.xy / alpha, wo.z), stretched, length, wo.z / length);
}

/// One over the length of a vector; finite for a zero vector.
fn normals_per_length(v: vec3<f32>) -> f32 {
    return inverseSqrt(v.x * v.x + (v.y * v.y + (v.z * v.z + 1e-30)));
}

/// The rise z / |A w| of a direction; zero below the surface.
fn normals_rise(view: NormalsView, w: vec3<f32>) -> f32 {
    return max(w.z, 0.0) * normals_per_length(vec3(view.alpha * w.xy, w.z));
}

/// Smith's G2 / G1 from the rise of the light direction: the fraction that is not shadowed.
fn normals_weight_of(view: NormalsView, rise: f32) -> f32 {
    return (1.0 + view.rise) * rise / (rise + view.rise);
}

/// G2 / G1 for the normal A c (x), and 1 - wo . h (y). c may have any length and sign.
fn normals_weight(view: NormalsView, c: vec3<f32>) -> vec2<f32> {
    let normal = vec3(view.alpha * c.xy, c.z);
    let h = normal * normals_per_length(normal);
    let cosine = dot(view.wo, h);
    let rise = normals_rise(view, 2.0 * cosine * h - view.wo);
    return vec2(normals_weight_of(view, rise), saturate(1.0 - abs(cosine)));
}
