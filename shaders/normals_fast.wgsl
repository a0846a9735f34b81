/// The reflected light of a rectangle of radiance one: for a Fresnel factor of one (x), and weighted by Schlick's
/// (1 - wo . h)^5 (y).
fn normals_rectangle(view: NormalsView, corners: array<vec3<f32>, 4>, two_sided: bool) -> vec2<f32> {
    // Orient both sides so that they rise. A corner below the surface slides up along its side.
    let falls = select(vec2(0.0), vec2(1.0), vec2(corners[1].z, corners[3].z) < corners[0].zz);
    let along = corners[1] - corners[0];
    let across = corners[3] - corners[0];
    let x = (1.0 - 2.0 * falls.x) * along;
    let y = (1.0 - 2.0 * falls.y) * across;
    let low = corners[0] + falls.x * along + falls.y * across;
    let right = low + x;
    let left = low + y;
    if (right.z + y.z <= 0.0) {
        return vec2(0.0);
    }
    let slide = -1.0 / max(vec2(x.z, y.z), vec2(1e-15));
    let right_up = right + saturate(right.z * slide.y) * y;
    let left_up = left + saturate(left.z * slide.x) * x;
    // a and b are the ends of the lowest side after clipping. They are equal if the surface cuts nothing off.
    let a = normals_corner(view, select(low + saturate(low.z * slide.y) * y, left_up, left.z <= 0.0));
    let b = normals_corner(view, select(low + saturate(low.z * slide.x) * x, right_up, right.z <= 0.0));
    var flux = normals_edge(view, vec3(0.0), a, b);
    let c = normals_corner(view, right_up);
    flux = normals_edge(view, flux, b, c);
    let high = normals_corner(view, right + y);
    flux = normals_edge(view, flux, c, high);
    let d = normals_corner(view, left_up);
    flux = normals_edge(view, normals_edge(view, flux, high, d), d, a);
    let projected = select(1.0, -1.0, falls.x != falls.y) * dot(flux, view.stretched);
    let rise = normals_rise(view, a.w) + normals_rise(view, c.w) + normals_rise(view, d.w) + normals_rise(view, high.w);
    return normals_mean(view, flux, projected, 0.25 * rise, two_sided);
}

/// The reflected light of a convex polygon with 3 to 8 vertices, as in normals_rectangle.
fn normals_polygon(view: NormalsView, vertices: ptr<function, array<vec3<f32>, 8>>, count: u32, two_sided: bool) -> vec2<f32> {
    let number = clamp(count, 3u, 8u);
    var a = (*vertices)[number - 1u];
    var setting = normals_corner(view, a);
    var rising = setting;
    var flux = vec3(0.0);
    var rise = 0.0;
    for (var i = 0u; i < 8u; i++) {
        if (i < number) {
            let b = (*vertices)[i];
            if (a.z > 0.0 || b.z > 0.0) {
                let cut = vec3(a.xy * abs(b.z) + b.xy * abs(a.z), 0.0);
                let begin = normals_corner(view, select(cut, a, a.z > 0.0));
                let end = normals_corner(view, select(cut, b, b.z > 0.0));
                flux = normals_edge(view, flux, begin, end);
                if (a.z <= 0.0) {
                    rising = begin;
                }
                if (b.z <= 0.0) {
                    setting = end;
                }
            }
            rise += normals_rise(view, b);
            a = b;
        }
    }
    flux = normals_edge(view, flux, setting, rising);
    return normals_mean(view, flux, dot(flux, view.stretched), rise / f32(number), two_sided);
}

/// The fraction of the visible normals that reflect the light, times their mean weight. A small network corrects the
/// weight of the mean normal, from the weight at the vertices and from the fraction.
fn normals_mean(view: NormalsView, flux: vec3<f32>, projected: f32, rise: f32, two_sided: bool) -> vec2<f32> {
    let part = saturate(select(projected, abs(projected), two_sided) * 0.31830989 / (view.wo.z + view.length));
    let at_mean = normals_weight(view, flux);
    let at_vertices = normals_weight_of(view, rise);
    let per_length = normals_per_length(flux);
    let alpha = vec2(max(view.alpha.x, view.alpha.y), min(view.alpha.x, view.alpha.y));
    let first = vec4(part, view.rise, at_mean);
    let second = vec4(abs(flux.z) * per_length, alpha, at_vertices);
    let units_0 = max(
        mat4x3(0.957, -0.2205, 0.6027, -1.39, -0.5151, 0.9099, -10.86, 9.136, -6.964, 0.2335, -0.0706, 0.5823) * first
        + mat4x3(0.1728, 0.4426, -1.059, -1.234, -0.7694, 2.05, -0.7549, -0.2645, 1.341, -0.01225, -0.1219, 1.024) * second
        + vec3(10.96, -8.294, 4.826),
        vec3(0.0),
    );
    let outputs = mat3x3(-0.03396, -0.1141, -0.04112, 0.01311, -0.004379, -0.3055, -0.04821, 0.008404, 0.1643) * units_0
        + vec3(-0.005077, 0.001849, 0.1108);
    let weight = saturate(at_mean.x + outputs.z * (at_vertices - at_mean.x) + outputs.x * part);
    let m2 = at_mean.y * at_mean.y;
    return part * vec2(weight, clamp(weight * m2 * m2 * at_mean.y + outputs.y * part, 0.0, weight));
}
