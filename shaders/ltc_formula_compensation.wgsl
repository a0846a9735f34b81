/// The factor by which to multiply the light of a metal of reflectance f0, to restore the energy lost to shadowing.
/// White metal then reflects all light of a white sky. Coloured metal reflects more saturated light.
fn ltc_formula_compensation(lobe: LtcFormula, f0: vec3<f32>) -> vec3<f32> {
    return vec3(1.0) + f0 * (1.0 / max(lobe.amplitude, 0.01) - 1.0);
}
