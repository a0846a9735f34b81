/// The factor on what a metal of reflectance f0 reflects that gives back what shadowing loses: white metal reflects all of a white
/// sky, and light that bounces twice is coloured twice.
fn normals_compensation(view: NormalsView, f0: vec3<f32>) -> vec3<f32> {
    return vec3(1.0) + f0 * (1.0 / ltc_albedo(view.alpha.x, view.alpha.y, view.wo) - 1.0);
}
