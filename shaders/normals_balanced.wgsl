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
    let sum_0 = mat4x4(-8.753, 0.5654, 0.3926, 0.1981, 0.3816, 24.24, -0.6129, 0.2369, 2.713, 9.272, 6.006, 3.125, 1.758, -0.2931, 0.3957, 3.77) * first
        + mat4x4(0.6518, -2.403, -2.107, -0.7803, 0.6439, 0.1223, -0.7821, 2.213, -3.177, -0.4119, 0.4902, 1.055, 0.3836, 1.799, -1.441, 1.085) * second
        + vec4(0.7555, -0.2884, -0.1174, 0.6383) * third
        + vec4(-1.895, -32.28, -3.253, -6.858);
    let units_0 = sum_0 + sqrt(sum_0 * sum_0 + 1.0);
    let outputs = mat4x4(-0.2243, -0.08187, -0.3105, -0.135, 0.03016, -0.3446, 0.07265, -0.385, 0.06841, 0.6177, -0.2157, 0.2122, -0.02905, -0.5208, -0.1619, -0.151) * units_0
        + vec4(0.5919, 0.2545, 0.969, 1.459);
    let fifth = dot(vec4(-0.3032, -8.743, -0.4859, 1.045), units_0)
        + -2.783;
    let outline = vec2(means.x, means.z / (means.x + 1e-6));
    return part * normals_blend(vec2(at_mean.x, normals_fifth(at_mean.y)), at_rise, outline, extent / (extent + 1.0), outputs, fifth);
}
