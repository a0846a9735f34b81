// The light of a polygon on GGX in closed form, without a table: the integral of the visible normals that reflect it,
// exact, and the mean of the weight of shadowing. Needs ltc_math.wgsl, normals_edge.wgsl and normals_weight.wgsl.
//
// Vertices are given relative to the shaded point in its tangent frame, normal +z. The lit side is the one from which
// they run clockwise. The outline has to be convex; a disk is lit as a polygon of its area.

/// How the weight is averaged: over triangles between the mean normal and each edge, the one on or near the horizon in four
/// parts; the weight of the mean normal; triangles of edges split in two, and of that on or near the horizon in eight.
const NORMALS_FAN: u32 = 0u;
const NORMALS_MEAN: u32 = 1u;
const NORMALS_FINE: u32 = 2u;

/// A light's outline above the surface.
struct NormalsOutline {
    /// The number of its vertices, and the first of them that is above the surface after one that is not; zero if all are.
    number: u32,
    start: u32,
    /// Whether the surface cuts it, and how many vertices are above.
    is_cut: bool,
    ups: u32,
    /// The number of its edges. The last may be on the horizon or near it: whether it is, and by which share it counts as the
    /// horizon.
    edges: u32,
    is_closed: bool,
    share: f32,
    /// How many corners before the outline's first that edge is.
    shift: u32,
    /// Whether it may have more than four vertices. Where a compiler knows that it has not, half of the work on lists falls
    /// away.
    many: bool,
}

/// An arc on the horizon or near it: its image by the ends at length one and the control point between them, and the normal of
/// its plane.
struct NormalsHorizon {
    begin: vec3<f32>,
    control: vec3<f32>,
    end: vec3<f32>,
    across: vec3<f32>,
}

/// Vector i of a list of up to eight; of up to four, unless there are many. All lists are read and written by choosing
/// among their vectors: an index that is not a constant would move them to memory, which costs as much as all edges.
fn normals_get(list: ptr<function, array<vec3<f32>, 8>>, i: u32, many: bool) -> vec3<f32> {
    let low = select(select((*list)[0], (*list)[1], i == 1u), select((*list)[2], (*list)[3], i == 3u), i >= 2u);
    let high = select(select((*list)[4], (*list)[5], i == 5u), select((*list)[6], (*list)[7], i == 7u), i >= 6u);
    return select(low, high, many && i >= 4u);
}

/// Sets vector i of a list; none for i = 8.
fn normals_put(list: ptr<function, array<vec3<f32>, 8>>, i: u32, v: vec3<f32>, many: bool) {
    (*list)[0] = select((*list)[0], v, i == 0u);
    (*list)[1] = select((*list)[1], v, i == 1u);
    (*list)[2] = select((*list)[2], v, i == 2u);
    (*list)[3] = select((*list)[3], v, i == 3u);
    (*list)[4] = select((*list)[4], v, many && i == 4u);
    (*list)[5] = select((*list)[5], v, many && i == 5u);
    (*list)[6] = select((*list)[6], v, many && i == 6u);
    (*list)[7] = select((*list)[7], v, many && i == 7u);
}

/// The direction in which the edge between vertices on either side of the horizon meets it.
fn normals_crossing(a: vec3<f32>, b: vec3<f32>) -> vec3<f32> {
    return vec3(a.xy * abs(b.z) + b.xy * abs(a.z), 0.0);
}

/// What of a polygon's outline is above the surface, and which edge is on the horizon or near it, and by how much.
///
/// The weight is zero on the horizon, so an edge there has a rule of its own and more parts, and so has one that is near: whose
/// higher end is lower than a quarter of the light's height, as far as it is lower than all others. If the light is cut,
/// the horizon's extent among those of all edges near it decides between the two. So nothing jumps where an edge sets.
fn normals_outline(vertices: ptr<function, array<vec3<f32>, 8>>, number: u32) -> NormalsOutline {
    var outline = NormalsOutline(number, 0u, false, 0u, number, false, 0.0, 0u, number > 4u);
    let last = normals_get(vertices, number - 1u, outline.many);
    var before = last;
    var height = 0.0;
    // Where it crosses the horizon.
    var rise = vec3(0.0);
    var sink = vec3(0.0);
    for (var i = 0u; i < number; i++) {
        let v = normals_get(vertices, i, outline.many);
        let is_up = v.z > 0.0;
        let crossing = normals_crossing(before, v);
        height = max(height, v.z);
        if (is_up && before.z <= 0.0) {
            outline.start = i;
            outline.is_cut = true;
            rise = crossing;
        }
        if (!is_up && before.z > 0.0) {
            sink = crossing;
        }
        outline.ups += select(0u, 1u, is_up);
        before = v;
    }
    var nearest = 0u;
    var nearness = 0.0;
    var second = 0.0;
    var extents = 0.0;
    before = last;
    for (var i = 0u; i < number; i++) {
        let v = normals_get(vertices, i, outline.many);
        let top = max(before.z, v.z);
        let near = select(0.0, 1.0 - top / max(0.25 * height, 1e-36), top > 0.0);
        if (near > 0.0) {
            let crossing = normals_crossing(before, v);
            let begin = select(crossing, before, before.z > 0.0);
            let end = select(crossing, v, v.z > 0.0);
            extents += near * distance(normals_unit(begin), normals_unit(end));
            second = max(second, min(near, nearness));
            // The edge that ends here; the outline's first begins at the vertex before its start, if it is cut.
            let edge = i + number - outline.start + select(number - 1u, 0u, outline.is_cut);
            nearest = select(nearest, edge % number, near > nearness);
            nearness = max(nearness, near);
        }
        before = v;
    }
    outline.share = nearness - second;
    outline.is_closed = outline.is_cut || outline.share > 0.0;
    if (outline.is_cut) {
        outline.edges = outline.ups + 2u;
        let horizon = distance(normals_unit(rise), normals_unit(sink));
        let extent = horizon / max(horizon + extents, 1e-36);
        let other = outline.share * (1.0 - extent);
        outline.share = abs(extent - other);
        nearest = select(nearest, outline.ups + 1u, extent >= other);
    }
    outline.shift = select(0u, (nearest + 1u) % outline.edges, outline.is_closed);
    return outline;
}

/// Corner i of an outline. If it is closed, its last edge is the one on or near the horizon.
fn normals_outline_corner(
    view: NormalsView,
    outline: NormalsOutline,
    vertices: ptr<function, array<vec3<f32>, 8>>,
    i: u32,
) -> NormalsCorner {
    let turned = i + outline.shift;
    let k = select(turned, turned - outline.edges, turned >= outline.edges);
    // A cut outline begins and ends where it crosses the horizon.
    let is_crossing = outline.is_cut && (k == 0u || k == outline.ups + 1u);
    let at = outline.start + k - select(0u, 1u, outline.is_cut && k > 0u);
    let before = select(at - 1u, outline.number - 1u, at == 0u);
    let v = normals_get(vertices, select(at, at - outline.number, at >= outline.number), outline.many);
    let u = normals_get(vertices, select(before, before - outline.number, before >= outline.number), outline.many);
    return normals_corner(select(v, normals_crossing(u, v), is_crossing), view);
}

/// The edge on or near the horizon.
fn normals_horizon(view: NormalsView, begin: NormalsCorner, end: NormalsCorner) -> NormalsHorizon {
    let sum = begin.w + end.w;
    let half = normals_half_cosine(begin, end);
    let control = normals_unstretched(view.wo * half + sum * (0.5 / half), view);
    let turn = cross(begin.w, end.w - begin.w);
    let is_level = begin.w.z == 0.0 && end.w.z == 0.0;
    let across = select(turn, vec3(0.0, 0.0, select(1.0, -1.0, turn.z < 0.0)), is_level);
    return NormalsHorizon(begin.c, control * inverseSqrt(begin.length * end.length), end.c, across);
}

/// The image of a horizon's arc at t in (0, 1].
fn normals_on_horizon(horizon: NormalsHorizon, t: f32) -> vec3<f32> {
    let u = 1.0 - t;
    let c = normals_unit(horizon.begin * (u * u) + horizon.control * (2.0 * u * t) + horizon.end * (t * t));
    return select(c, horizon.end, t >= 1.0);
}

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
    let outline = normals_outline(vertices, clamp(count, 3u, 8u));
    if (outline.ups == 0u) {
        return vec2(0.0);
    }
    let many = outline.many;
    let is_fine = rule == NORMALS_FINE;
    let edge_parts = select(1u, 2u, is_fine);
    // The edge on or near the horizon is integrated in so many parts, each of which has two triangles.
    let horizon_parts = select(select(2u, 4u, is_fine), 1u, rule == NORMALS_MEAN);
    // Those but the one on or near the horizon.
    let edges = outline.edges - select(0u, 1u, outline.is_closed);
    let closing_parts = select(0u, horizon_parts, outline.is_closed);
    let first = normals_outline_corner(view, outline, vertices, 0u);
    let horizon = normals_horizon(view, normals_outline_corner(view, outline, vertices, edges), first);

    // One loop over all parts of all edges: this is the one place where an edge is integrated, which is much code. For
    // each edge, where it ends and what it adds to the integral beyond the plane triangle; the same for its first half.
    var ends: array<vec3<f32>, 8>;
    var curves: array<vec3<f32>, 8>;
    var half_ends: array<vec3<f32>, 8>;
    var half_curves: array<vec3<f32>, 8>;
    var horizon_curves: array<vec3<f32>, 8>;
    // What the edge on or near the horizon, or its second half, and its first half add, and its middle.
    var closing = vec3(0.0);
    var half_closing = vec3(0.0);
    var half_end = vec3(0.0);
    var arc_start = first.c;
    var flux = vec3(0.0);
    var last = first;
    var edge = 0u;
    var is_second = false;
    for (var step = 0u; step < edges * edge_parts + closing_parts; step++) {
        let is_closing = edge >= edges;
        let is_half = is_fine && !is_second && !is_closing;
        var to = normals_outline_corner(view, outline, vertices, edge + 1u);
        if (is_half) {
            to = normals_between(last, to, 0.5, view);
        }
        let t = f32(edge + 1u - edges) / f32(horizon_parts);
        let c = select(to.c, normals_on_horizon(horizon, t), is_closing);
        let apart = to.w - last.w;
        let across = select(cross(last.w, apart), horizon.across, is_closing);
        let exact = normals_exact(view, last.c, c, across, is_closing || dot(last.w, to.w) < 0.9);
        let is_edge = select(dot(apart, apart), dot(across, across), is_closing) >= 1e-14;
        let curved = select(vec3(0.0), exact - cross(last.c, c), is_edge);
        flux += curved + cross(last.c - first.c, c - first.c);
        if (is_fine) {
            normals_put(&half_ends, select(8u, edge, is_half), c, many);
            normals_put(&half_curves, select(8u, edge, is_half), curved, many);
        }
        normals_put(&ends, select(edge, 8u, is_half || is_closing), c, many);
        normals_put(&curves, select(edge, 8u, is_half || is_closing), curved, many);
        normals_put(&horizon_curves, select(8u, edge - edges, is_closing), curved, false);
        // Beyond the plane triangle of the whole arc, whose parts have their own.
        arc_start = select(c, arc_start, is_closing);
        closing += select(vec3(0.0), curved + cross(last.c - arc_start, c - arc_start), is_closing);
        if (is_fine && edge + 1u == edges + horizon_parts / 2u) {
            half_closing = closing;
            half_end = c;
            closing = vec3(0.0);
            arc_start = c;
        }
        last = NormalsCorner(to.w, c, to.length);
        edge += select(1u, 0u, is_half);
        is_second = is_half;
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
        // The triangles between the mean normal and each part of the outline: the exact integral of each, and its weight.
        // The edge on or near the horizon comes twice: as an edge like the others, and in parts.
        var sum = NormalsSum(vec3(0.0), vec3(0.0), 0.0);
        let least_rise = max(0.125 * normals_rise(view, tip), 1e-36);
        // What is seen is positive on the lit side.
        let sided = side * view.stretched;
        let numbers = normals_numbers(view, is_fine);
        // So little that it matters only where all other normals are seen edge-on, where the mean would jump.
        let tip_share = 0.03 * normals_sample(view, tip);
        let begin = normals_spoke(view, numbers, tip, first.c);
        var before = begin;
        var setting = begin;
        for (var i = 0u; i < outline.edges; i++) {
            let is_closing = i == edges;
            if (is_closing) {
                setting = before;
            }
            let counts = select(1.0, 1.0 - outline.share, is_closing);
            if (is_fine) {
                let half_c = select(normals_get(&half_ends, i, many), half_end, is_closing);
                let half_curved = select(normals_get(&half_curves, i, many), half_closing, is_closing);
                let half = normals_spoke(view, numbers, tip, half_c);
                let flux = normals_flux(tip, before, half, half_curved);
                let m = normals_centroid(flux, tip);
                let mean = normals_triangle(view, numbers, tip, m, tip_share + before.at_end + half.at_end);
                sum = normals_add(view, sum, least_rise, m, counts * dot(flux, sided), mean);
                before = half;
            }
            let c = select(normals_get(&ends, i, many), first.c, is_closing);
            let curved = select(normals_get(&curves, i, many), closing, is_closing);
            let to = normals_spoke(view, numbers, tip, c);
            let flux = normals_flux(tip, before, to, curved);
            let m = normals_centroid(flux, tip);
            let mean = normals_triangle(view, numbers, tip, m, tip_share + before.at_end + to.at_end);
            sum = normals_add(view, sum, least_rise, m, counts * dot(flux, sided), mean);
            before = to;
        }
        // A loop of its own: a driver that runs both sides of a branch skips it where no edge is near the horizon.
        before = setting;
        for (var part = 0u; part < closing_parts; part++) {
            let middle = normals_on_horizon(horizon, (f32(part) + 0.5) / f32(horizon_parts));
            let end = normals_on_horizon(horizon, f32(part + 1u) / f32(horizon_parts));
            let curved = normals_shared(before.c, middle, end, normals_get(&horizon_curves, part, false));
            let half = NormalsSpoke(middle, normals_arc_bend(tip, middle), vec3(0.0));
            let to = NormalsSpoke(end, normals_arc_bend(tip, end), vec3(0.0));
            let first_flux = normals_flux(tip, before, half, curved[0]);
            let first_m = normals_centroid(first_flux, tip);
            let first_mean = normals_horizon_triangle(view, numbers, tip, at_tip, first_m);
            sum = normals_add(view, sum, least_rise, first_m, outline.share * dot(first_flux, sided), first_mean);
            let flux = normals_flux(tip, half, to, curved[1]);
            let m = normals_centroid(flux, tip);
            let mean = normals_horizon_triangle(view, numbers, tip, at_tip, m);
            sum = normals_add(view, sum, least_rise, m, outline.share * dot(flux, sided), mean);
            before = to;
        }
        parts = normals_total(sum, seen * side, at_tip) * side;
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
