/// Sums over the edges of a light. flux: the integral of c x dc. sums: the values of normals_sample, times the size of
/// the edge among the visible normals. size: these sizes.
struct NormalsSum {
    flux: vec3<f32>,
    sums: vec4<f32>,
    size: f32,
}

/// For the normal A c: the weight G2 / G1 divided by 1 + view.rise; the rise of the reflected view direction; the weight
/// times Schlick's factor; the squared weight.
fn normals_sample(view: NormalsView, c: vec3<f32>) -> vec4<f32> {
    let h = vec3(view.alpha * c.xy, c.z);
    let along = dot(view.wo, h);
    let h2 = dot(h, h);
    let rise = normals_rise(view, 2.0 * along * h - h2 * view.wo);
    let weight = rise / (rise + view.rise);
    return vec4(weight, rise, weight * normals_fifth(saturate(1.0 - abs(along) * inverseSqrt(h2))), weight * weight);
}

/// Adds an edge. On the horizon the weight is zero.
fn normals_add(view: NormalsView, sum: NormalsSum, begin: NormalsCorner, end: NormalsCorner, is_above: bool) -> NormalsSum {
    let edge = normals_edge(view, sum.flux, begin, end);
    let half = edge.middle - begin.c;
    let size = sqrt(dot(half, half)) * saturate(dot(edge.middle, view.stretched));
    if (!is_above) {
        return NormalsSum(edge.flux, sum.sums, sum.size + size);
    }
    return NormalsSum(edge.flux, sum.sums + size * normals_samples(view, edge), sum.size + size);
}

fn normals_fifth(x: f32) -> f32 {
    return x * x * (x * x) * x;
}

/// The mean of the weight (x) and of the weight times Schlick's factor (y) over the light. They are blends of the values
/// at the mean normal, at the mean rise of the outline, and along the outline, with shares from a network. A
/// correction proportional to the extent follows. It needs no clamp, which would draw contours into highlights.
fn normals_blend(at_mean: vec2<f32>, at_rise: f32, outline: vec2<f32>, extent: f32, outputs: vec4<f32>, fifth: f32) -> vec2<f32> {
    let near = saturate(outputs.wx);
    let shares = near * near * (3.0 - 2.0 * near);
    let bounded = vec3(outputs.yz, fifth) / (1.0 + abs(vec3(outputs.yz, fifth)));
    let around = at_rise + shares.x * (outline.x - at_rise);
    let known = around + shares.y * (at_mean.x - around);
    let weight = known * (1.0 + extent * bounded.x * (1.0 - known));
    let schlick = at_mean.y + (0.5 + 0.5 * bounded.z) * (outline.y - at_mean.y);
    return weight * vec2(1.0, schlick * (1.0 + extent * bounded.y * (1.0 - schlick)));
}
