/// The factor by which to multiply what a metal of reflectance f0 reflects. It gives back the energy that shadowing
/// loses: white metal then reflects all light of a white sky, and coloured metal more saturated light.
fn normals_compensation(view: NormalsView, f0: vec3<f32>) -> vec3<f32> {
    return vec3(1.0) + f0 * (1.0 / ltc_albedo(view.alpha.x, view.alpha.y, view.wo) - 1.0);
}
