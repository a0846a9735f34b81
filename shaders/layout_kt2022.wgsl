// Layout kt2022: a table stores M and the terms themselves. Needs ltc_math.wgsl and ltc_table.wgsl.

/// The lobe of interpolated numbers, at a place within the table's ranges seen from wo in the first quadrant.
fn ltc_restore_kt2022(stored: LtcLobe, alpha_x: f32, ratio: f32, wo: vec3<f32>) -> LtcLobe {
    return stored;
}
