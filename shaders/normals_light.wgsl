// The light of a polygon on GGX in closed form, without a table: the integral of the visible normals that reflect it,
// exact, and the mean of the weight of shadowing. Needs ltc_math.wgsl and all other normals_*.wgsl but the example.
//
// Vertices are given relative to the shaded point in its tangent frame, normal +z. The lit side is the one from which
// they run clockwise. The outline has to be convex; a disk is lit as a polygon of its area.

/// How the weight is averaged: over triangles between the mean normal and each edge, the one on or near the horizon in four
/// parts, or eight where it is wide; the weight of the mean normal; triangles of edges split in two, and of that on or near the
/// horizon in eight or sixteen.
const NORMALS_FAN: u32 = 0u;
const NORMALS_MEAN: u32 = 1u;
const NORMALS_FINE: u32 = 2u;

/// What is reflected of a convex polygon of 3 to 8 vertices of radiance one: for a Fresnel factor of one (x), and its part
/// weighed by Schlick's (1 - wo . h)^5 (y). Light of radiance L: L (f0 (x - y) + f90 y).
///
/// Cheapest where the compiler knows the rule, and that there are four vertices at most, as in normals_rectangle.
fn normals_polygon(
    view: NormalsView,
    vertices: ptr<function, array<vec3<f32>, 8>>,
    count: u32,
    two_sided: bool,
    rule: u32,
) -> vec2<f32> {
    let number = clamp(count, 3u, 8u);
    let is_fine = rule == NORMALS_FINE;
    // Beyond the last vertex the first comes again.
    let v0 = (*vertices)[0];
    let c0 = normals_corner(v0, view);
    let c1 = normals_corner((*vertices)[1], view);
    let c2 = normals_corner((*vertices)[2], view);
    let c3 = normals_corner(select(v0, (*vertices)[3], number > 3u), view);
    var c4 = c0;
    var c5 = c0;
    var c6 = c0;
    var c7 = c0;
    let many = number > 4u;
    if (many) {
        c4 = normals_corner((*vertices)[4], view);
        c5 = normals_corner(select(v0, (*vertices)[5], number > 5u), view);
        c6 = normals_corner(select(v0, (*vertices)[6], number > 6u), view);
        c7 = normals_corner(select(v0, (*vertices)[7], number > 7u), view);
    }
    let heights = vec4(c0.height, c1.height, c2.height, c3.height);
    let more = vec4(c4.height, c5.height, c6.height, c7.height);
    let high = max(heights, more);
    let low = min(heights, more);
    let highest = max(max(high.x, high.y), max(high.z, high.w));
    let lowest = min(min(low.x, low.y), min(low.z, low.w));
    if (!(highest > 0.0)) {
        return vec2(0.0);
    }

    var light = NormalsLight(number, 4.0 / max(highest, 1e-36), lowest <= 0.0, c0, c0);
    if (light.is_cut) {
        var cut = normals_cut_by(mat2x3(vec3(0.0), vec3(0.0)), c0, c1);
        cut = normals_cut_by(normals_cut_by(normals_cut_by(cut, c1, c2), c2, c3), c3, c4);
        if (many) {
            cut = normals_cut_by(normals_cut_by(cut, c4, c5), c5, c6);
            cut = normals_cut_by(normals_cut_by(cut, c6, c7), c7, c0);
        }
        light.rise = normals_corner(cut[0], view);
        light.sink = normals_corner(cut[1], view);
    }
    let first = normals_edges(view, light, 0u, c0, c1, c2, is_fine);
    let second = normals_edges(view, light, 2u, c2, c3, c4, is_fine);
    let origin = first.first.begin;
    var outline = NormalsOutline(origin.c, vec3(0.0), 0u, origin, origin, vec3(0.0), 0.0, 0.0, 0.0);
    outline = normals_outline_with_both(normals_outline_with_both(outline, 0u, first), 2u, second);
    var third = second;
    var fourth = second;
    if (many) {
        third = normals_edges(view, light, 4u, c4, c5, c6, is_fine);
        fourth = normals_edges(view, light, 6u, c6, c7, c0, is_fine);
        outline = normals_outline_with_both(normals_outline_with_both(outline, 4u, third), 6u, fourth);
    }
    let setting = normals_setting(view, outline, light, rule != NORMALS_MEAN, is_fine);
    var flux = outline.flux;
    if (light.is_cut) {
        flux += setting.horizon.curved + cross(light.sink.c - origin.c, light.rise.c - origin.c);
    }

    let seen = dot(flux, view.stretched);
    let side = select(1.0, -1.0, seen < 0.0);
    if (side < 0.0 && !two_sided) {
        return vec2(0.0);
    }
    let to_part = side * 0.31830989 / (view.wo.z + view.length);
    let tip = normals_unit(flux * side);
    let at_tip = normals_weight(view, tip);
    var parts = vec2(at_tip.x, at_tip.x * at_tip.y) * seen;
    if (rule != NORMALS_MEAN) {
        // The exact integral of each triangle, and its weight.
        var fan = normals_fan(view, tip, at_tip, side, setting.wide, is_fine);
        if (light.is_cut) {
            fan.rise = normals_spoke(view, fan, light.rise.c, true);
            fan.sink = normals_spoke(view, fan, light.sink.c, true);
        }
        // The edge with the horizon's rule comes twice, also as an edge like the others.
        let less = 1.0 - setting.share;
        let one = select(outline.nearest, 8u, setting.is_horizon);
        let s0 = normals_spoke(view, fan, c0.c, c0.height > 0.0);
        let s1 = normals_spoke(view, fan, c1.c, c1.height > 0.0);
        let s2 = normals_spoke(view, fan, c2.c, c2.height > 0.0);
        let s3 = normals_spoke(view, fan, c3.c, c3.height > 0.0);
        var s4 = s0;
        if (many) {
            s4 = normals_spoke(view, fan, c4.c, c4.height > 0.0);
        }
        var sum = NormalsSum(vec3(0.0), vec3(0.0), 0.0);
        sum = normals_add_edges(view, fan, sum, 0u, first, s0, s1, s2, one, less);
        sum = normals_add_edges(view, fan, sum, 2u, second, s2, s3, s4, one, less);
        if (many) {
            let s5 = normals_spoke(view, fan, c5.c, c5.height > 0.0);
            let s6 = normals_spoke(view, fan, c6.c, c6.height > 0.0);
            let s7 = normals_spoke(view, fan, c7.c, c7.height > 0.0);
            sum = normals_add_edges(view, fan, sum, 4u, third, s4, s5, s6, one, less);
            sum = normals_add_edges(view, fan, sum, 6u, fourth, s6, s7, s0, one, less);
        }
        let horizon = select(1.0, less, setting.is_horizon);
        if (light.is_cut && horizon > 0.0) {
            sum = normals_add_edge(view, fan, sum, setting.horizon, fan.sink, fan.rise, horizon);
        }
        if (setting.share > 0.0) {
            sum = normals_add_setting(view, fan, sum, setting);
        }
        parts = normals_total(fan, sum, seen * side) * side;
    }
    // No weight is above one.
    let energy = clamp(parts.x * to_part, 0.0, clamp(seen * to_part, 0.0, 1.0));
    return vec2(energy, clamp(parts.y * to_part, 0.0, energy));
}

/// A rectangle by its corners in order.
fn normals_rectangle(view: NormalsView, corners: array<vec3<f32>, 4>, two_sided: bool, rule: u32) -> vec2<f32> {
    var vertices: array<vec3<f32>, 8>;
    vertices[0] = corners[0];
    vertices[1] = corners[1];
    vertices[2] = corners[2];
    vertices[3] = corners[3];
    return normals_polygon(view, &vertices, 4u, two_sided, rule);
}

/// A disk: the regular octagon of its area. Its half axes are perpendicular; the lit side is towards their cross
/// product, half_x x half_y.
fn normals_disk(
    view: NormalsView,
    centre: vec3<f32>,
    half_x: vec3<f32>,
    half_y: vec3<f32>,
    two_sided: bool,
    rule: u32,
) -> vec2<f32> {
    var vertices: array<vec3<f32>, 8>;
    for (var i = 0u; i < 8u; i++) {
        let turn = ltc_sin_cos((0.5 - f32(i)) * 0.125) * 1.0539074;
        vertices[i] = centre + half_x * turn.y + half_y * turn.x;
    }
    return normals_polygon(view, &vertices, 8u, two_sided, rule);
}
