/// The factor by which to multiply what a metal of reflectance f0 reflects. It gives back the energy that shadowing
/// loses: white metal then reflects all light of a white sky, and coloured metal more saturated light. Arguments as
/// gaussians_view.
fn gaussians_compensation(alpha_x: f32, alpha_y: f32, wo: vec3<f32>, f0: vec3<f32>) -> vec3<f32> {
    return vec3(1.0) + f0 * (1.0 / ltc_albedo(alpha_x, alpha_y, wo) - 1.0);
}
