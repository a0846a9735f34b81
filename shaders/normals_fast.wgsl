/// Sums over the edges of a light: the integral of c x dc, the sum of the corners' rises, and the number of corners.
struct NormalsSum {
    flux: vec3<f32>,
    rise: f32,
    count: f32,
}

/// Adds an edge and the corner at its end. For an edge on the horizon, the corner does not count.
fn normals_add(view: NormalsView, sum: NormalsSum, begin: NormalsCorner, end: NormalsCorner, is_above: bool) -> NormalsSum {
    let flux = normals_edge(view, sum.flux, begin, end).flux;
    if (!is_above) {
        return NormalsSum(flux, sum.rise, sum.count);
    }
    return NormalsSum(flux, sum.rise + normals_rise(view, end.w), sum.count + 1.0);
}

/// The fraction of the visible normals that reflect the light, times their mean weight. It is a blend of the weights at
/// the mean normal and at the corners, with a share from a network. A correction proportional to the fraction follows.
/// It needs no clamp, which would draw contours into highlights.
fn normals_mean(view: NormalsView, sum: NormalsSum, projected: f32, two_sided: bool) -> vec2<f32> {
    let part = saturate(select(projected, abs(projected), two_sided) * 0.31830989 / (view.wo.z + view.length));
    let at_mean = normals_weight(view, sum.flux);
    let at_corners = normals_weight_of(view, sum.rise / sum.count);
    let upright = abs(sum.flux.z) * normals_per_length(sum.flux);
    let first = vec4(part, view.rise, at_mean);
    let second = vec4(upright, max(view.alpha.x, view.alpha.y), min(view.alpha.x, view.alpha.y), at_corners);
    let sum_0 = mat4x3(-0.1519, -0.7039, 1.037, -0.5392, -1.806, -1.746, 9.027, -12.2, -21.41, 0.2465, -1.285, 2.563) * first
        + mat4x3(0.3197, 3.16, -0.8452, -1.318, -1.632, -0.6724, -0.2627, -3.212, -0.0576, -0.5294, 0.6265, 0.1072) * second
        + vec3(-6.745, 11.53, 19.15);
    let units_0 = sum_0 + sqrt(sum_0 * sum_0 + 1.0);
    let outputs = mat3x3(0.1255, -0.6073, -0.03671, 0.1392, 0.1501, -0.1714, -0.08467, 0.004083, -0.7751) * units_0
        + vec3(0.4829, -3.68, 0.4387);
    let near = saturate(outputs.x);
    let known = at_corners + near * near * (3.0 - 2.0 * near) * (at_mean.x - at_corners);
    let more = part * outputs.yz / (1.0 + abs(outputs.yz));
    let m2 = at_mean.y * at_mean.y;
    let schlick = m2 * m2 * at_mean.y;
    let weight = part * known * (1.0 + more.x * (1.0 - known));
    return weight * vec2(1.0, schlick * (1.0 + more.y * (1.0 - schlick)));
}
