/// The factor by which to multiply the light of a metal of reflectance f0, to restore the energy lost to shadowing.
/// White metal then reflects all light of a white sky. Coloured metal reflects more saturated light.
fn normals_compensation(view: NormalsView, f0: vec3<f32>) -> vec3<f32> {
    return vec3(1.0) + f0 * (1.0 / ltc_albedo(view.alpha.x, view.alpha.y, view.wo) - 1.0);
}
