// Reads a table of Gaussians for gaussians_light.wgsl. Needs ltc_table.wgsl and gaussians_light.wgsl.

/// Decodes a Gaussian from the numbers of a table. The third column of m is the axis times a length. The other columns
/// are the standard deviations times this length, plus a part along the axis, which this function removes.
fn gaussians_of_lobe(kind: u32, lobe: LtcLobe) -> GaussiansView {
    let size = max(length(lobe.m[2]), 1e-18);
    let axis = normalize(vec3(lobe.m[2].xy, max(lobe.m[2].z, 1e-6 * size)));
    let first = (lobe.m[0] - axis * dot(axis, lobe.m[0])) / size;
    let second = (lobe.m[1] - axis * dot(axis, lobe.m[1])) / size;
    var view = gaussians_around(kind, axis, first, second);
    view.parts = vec2(lobe.amplitude, lobe.fresnel);
    return view;
}

/// The table's Gaussian for a surface and a view direction, in the form that gaussians_view returns. kind must be the
/// kind of the table's Gaussians.
fn gaussians_lookup(kind: u32, alpha_x: f32, alpha_y: f32, wo: vec3<f32>) -> GaussiansView {
    return gaussians_of_lobe(kind, ltc_lookup(alpha_x, alpha_y, wo));
}
