/// The factor on what a metal of reflectance f0 reflects that gives back what shadowing loses: white metal reflects all of a white
/// sky, and light that bounces twice is coloured twice.
fn ltc_compensation(lobe: LtcLobe, f0: vec3<f32>) -> vec3<f32> {
    return vec3(1.0) + f0 * (1.0 / max(lobe.amplitude, 0.01) - 1.0);
}
