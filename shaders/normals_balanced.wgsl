/// What is reflected of a rectangle of radiance one: for a Fresnel factor of one, and by Schlick's (1 - wo . h)^5.
fn normals_rectangle(view: NormalsView, corners: array<vec3<f32>, 4>, two_sided: bool) -> vec2<f32> {
    // Both sides are turned to rise. A corner below the surface slides up along its side.
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
    // The side on the horizon, or one point.
    let a = normals_corner(view, select(low + saturate(low.z * slide.y) * y, left_up, left.z <= 0.0));
    let b = normals_corner(view, select(low + saturate(low.z * slide.x) * x, right_up, right.z <= 0.0));
    var flux = normals_edge(view, vec3(0.0), a, b);
    let c = normals_corner(view, right_up);
    flux = normals_edge(view, flux, b, c);
    let high = normals_corner(view, right + y);
    flux = normals_edge(view, flux, c, high);
    let d = normals_corner(view, left_up);
    flux = normals_edge(view, normals_edge(view, flux, high, d), d, a);
    let seen = select(1.0, -1.0, falls.x != falls.y) * dot(flux, view.stretched);
    let rises = vec4(normals_rise(view, a.w), normals_rise(view, c.w), normals_rise(view, d.w), normals_rise(view, high.w));
    let least = min(min(rises.x, rises.y), min(rises.z, rises.w));
    let most = max(max(rises.x, rises.y), max(rises.z, rises.w));
    let mean = 0.25 * (rises.x + rises.y + rises.z + rises.w);
    let apart = a.w - b.w;
    return normals_mean(view, flux, seen, vec3(mean, least, most), 0.5 * dot(apart, apart), two_sided);
}

/// The same of a convex polygon of 3 to 8 vertices.
fn normals_polygon(
    view: NormalsView,
    vertices: ptr<function, array<vec3<f32>, 8>>,
    count: u32,
    two_sided: bool,
) -> vec2<f32> {
    let number = clamp(count, 3u, 8u);
    var a = (*vertices)[number - 1u];
    var setting = normals_corner(view, a);
    var rising = setting;
    var flux = vec3(0.0);
    var rises = vec3(0.0, 1.0, 0.0);
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
            let rise = normals_rise(view, b);
            rises = vec3(rises.x + rise, min(rises.y, rise), max(rises.z, rise));
            a = b;
        }
    }
    if (rises.z <= 0.0) {
        return vec2(0.0);
    }
    flux = normals_edge(view, flux, setting, rising);
    let apart = setting.w - rising.w;
    return normals_mean(view, flux, dot(flux, view.stretched), vec3(rises.x / f32(number), rises.yz), 0.5 * dot(apart, apart), two_sided);
}

/// The part of the visible normals times their mean weight: that of the mean normal, a share of that of the vertices, and more
/// by the part. A network of rectified linear units tells these.
fn normals_mean(view: NormalsView, flux: vec3<f32>, seen: f32, rises: vec3<f32>, width: f32, two_sided: bool) -> vec2<f32> {
    let part = saturate(select(seen, abs(seen), two_sided) * 0.31830989 / (view.wo.z + view.length));
    let at_mean = normals_weight(view, flux);
    let at_vertices = normals_weight_of(view, rises.x);
    let per_length = normals_per_length(flux);
    let alpha = vec2(max(view.alpha.x, view.alpha.y), min(view.alpha.x, view.alpha.y));
    let first = vec4(part, view.rise, at_mean);
    let second = vec4(abs(flux.z) * per_length, alpha, at_vertices);
    let third = vec4(abs(seen) * per_length / view.length, rises.yz, width);
    let told = normals_network(first, second, third);
    let weight = saturate(at_mean.x + told.z * (at_vertices - at_mean.x) + told.x * part);
    let m2 = at_mean.y * at_mean.y;
    return part * vec2(weight, clamp(weight * m2 * m2 * at_mean.y + told.y * part, 0.0, weight));
}
