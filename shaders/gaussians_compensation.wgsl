/// The factor on what a metal of reflectance f0 reflects that gives back what shadowing loses: white metal reflects all of a white
/// sky, and light that bounces twice is coloured twice. Arguments as in gaussians_view.
fn gaussians_compensation(alpha_x: f32, alpha_y: f32, wo: vec3<f32>, f0: vec3<f32>) -> vec3<f32> {
    return vec3(1.0) + f0 * (1.0 / ltc_albedo(alpha_x, alpha_y, wo) - 1.0);
}
