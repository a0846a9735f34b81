/// The factor by which to multiply what a metal of reflectance f0 reflects. It gives back the energy that shadowing
/// loses: white metal then reflects all light of a white sky, and coloured metal more saturated light.
fn ltc_compensation(lobe: LtcLobe, f0: vec3<f32>) -> vec3<f32> {
    return vec3(1.0) + f0 * (1.0 / max(lobe.amplitude, 0.01) - 1.0);
}
