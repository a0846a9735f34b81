/// The samples of an edge: its middle.
fn normals_samples(view: NormalsView, edge: NormalsEdge) -> vec4<f32> {
    return normals_sample(view, edge.middle);
}

/// The fraction of the visible normals that reflect the light, times their mean weight.
fn normals_mean(view: NormalsView, sum: NormalsSum, projected: f32, two_sided: bool) -> vec2<f32> {
    let part = saturate(select(projected, abs(projected), two_sided) * 0.31830989 / (view.wo.z + view.length));
    let at_mean = normals_weight(view, sum.flux);
    let scale = 1.0 + view.rise;
    let means = sum.sums * (vec4(scale, 1.0, scale, scale * scale) / max(sum.size, 1e-20));
    let at_rise = normals_weight_of(view, means.y);
    let extent = sum.size * sum.size;
    let first = vec4(part, view.rise, at_mean);
    let second = vec4(max(view.alpha.x, view.alpha.y), min(view.alpha.x, view.alpha.y), at_rise, means.x);
    let third = sum.size;
    let sum_0 = mat4x4(-10.97, 0.3589, 0.4507, -0.04585, 0.04056, 19.83, -0.7741, 0.2623, 3.904, 11.6, 4.484, 1.37, 1.796, 0.1187, 0.5416, 2.782) * first
        + mat4x4(0.7183, -2.207, -2.359, -0.5499, 0.3575, 0.343, -0.8699, 1.698, -4.729, -1.354, 0.2741, 1.058, 0.6109, 2.047, -1.227, 0.9754) * second
        + vec4(1.031, -0.2568, -0.04868, 0.3217) * third
        + vec4(-1.733, -30.7, -1.4, -4.092);
    let units_0 = sum_0 + sqrt(sum_0 * sum_0 + 1.0);
    let outputs = mat4x4(-0.2265, -0.04962, -0.2762, 0.02247, 0.06334, -0.6608, 0.1095, -0.4541, 0.05504, 0.3706, -0.2145, -0.1937, -0.04367, -0.3634, -0.1784, 0.1189) * units_0
        + vec4(0.6106, 0.2974, 1.157, 1.223);
    let fifth = dot(vec4(0.1535, -11.78, -0.2551, 1.225), units_0)
        + -3.635;
    let outline = vec2(means.x, means.z / (means.x + 1e-6));
    return part * normals_blend(vec2(at_mean.x, normals_fifth(at_mean.y)), at_rise, outline, extent / (extent + 1.0), outputs, fifth);
}
