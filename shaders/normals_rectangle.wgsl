/// Reflected light, and the integral of c x dc along the image of the light's outline: it points along the mean normal or
/// against it.
struct NormalsLit {
    light: vec2<f32>,
    flux: vec3<f32>,
}

/// The reflected light of a rectangle of radiance one: for a Fresnel factor of one (x), and weighted by Schlick's
/// (1 - wo . h)^5 (y).
fn normals_rectangle(view: NormalsView, corners: array<vec3<f32>, 4>, two_sided: bool) -> vec2<f32> {
    return normals_rectangle_lit(view, corners, two_sided).light;
}

/// The same with the mean normal, for samplers.
fn normals_rectangle_lit(view: NormalsView, corners: array<vec3<f32>, 4>, two_sided: bool) -> NormalsLit {
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
        return NormalsLit(vec2(0.0), vec3(0.0));
    }
    let slide = -1.0 / max(vec2(x.z, y.z), vec2(1e-15));
    let right_up = right + saturate(right.z * slide.y) * y;
    let left_up = left + saturate(left.z * slide.x) * x;
    // a and b are the ends of the lowest side after clipping. They are equal if the surface cuts nothing off; otherwise
    // this side lies on the horizon.
    let a = normals_corner(view, select(low + saturate(low.z * slide.y) * y, left_up, left.z <= 0.0));
    let b = normals_corner(view, select(low + saturate(low.z * slide.x) * x, right_up, right.z <= 0.0));
    var sum = normals_add(view, NormalsSum(), a, b, false);
    let c = normals_corner(view, right_up);
    sum = normals_add(view, sum, b, c, true);
    let high = normals_corner(view, right + y);
    sum = normals_add(view, sum, c, high, true);
    let d = normals_corner(view, left_up);
    sum = normals_add(view, normals_add(view, sum, high, d, true), d, a, true);
    let projected = select(1.0, -1.0, falls.x != falls.y) * dot(sum.flux, view.stretched);
    return NormalsLit(normals_mean(view, sum, projected, two_sided), sum.flux);
}

/// The reflected light of a convex polygon with 3 to 8 vertices, as in normals_rectangle.
fn normals_polygon(view: NormalsView, vertices: ptr<function, array<vec3<f32>, 8>>, count: u32, two_sided: bool) -> vec2<f32> {
    return normals_polygon_lit(view, vertices, count, two_sided).light;
}

/// The same with the mean normal, for samplers.
fn normals_polygon_lit(view: NormalsView, vertices: ptr<function, array<vec3<f32>, 8>>, count: u32, two_sided: bool) -> NormalsLit {
    let number = clamp(count, 3u, 8u);
    var a = (*vertices)[number - 1u];
    var setting = normals_corner(view, a);
    var rising = setting;
    var sum = NormalsSum();
    for (var i = 0u; i < 8u; i++) {
        if (i < number) {
            let b = (*vertices)[i];
            // Below the surface, begin and end are one point of the horizon.
            let cut = vec3(a.xy * abs(b.z) + b.xy * abs(a.z), 0.0);
            let begin = normals_corner(view, select(cut, a, a.z > 0.0));
            let end = normals_corner(view, select(cut, b, b.z > 0.0));
            sum = normals_add(view, sum, begin, end, true);
            if (a.z <= 0.0 && b.z > 0.0) {
                rising = begin;
            }
            if (a.z > 0.0 && b.z <= 0.0) {
                setting = end;
            }
            a = b;
        }
    }
    sum = normals_add(view, sum, setting, rising, false);
    return NormalsLit(normals_mean(view, sum, dot(sum.flux, view.stretched), two_sided), sum.flux);
}
