// The mean of the weight of shadowing over the triangles between the mean normal and each edge's image. Needs
// normals_corner.wgsl, normals_outline.wgsl and normals_weight.wgsl.

/// The great circle's arc from the tip of the triangles to a corner of the outline: where it ends and whether that is above the
/// surface, what it adds beyond the plane triangle, and what its end adds to the mean of a triangle beside it.
struct NormalsSpoke {
    c: vec3<f32>,
    is_up: bool,
    bend: vec3<f32>,
    at_end: vec3<f32>,
}

/// What all triangles of a light share.
struct NormalsFan {
    numbers: NormalsNumbers,
    /// The mean normal, where all triangles meet, its weight and Schlick's factor, and what it adds to each mean.
    tip: vec3<f32>,
    at_tip: vec2<f32>,
    tip_sample: vec3<f32>,
    /// What is seen of a normal, positive on the lit side: A wo or its opposite.
    seen: vec3<f32>,
    /// One over an eighth of how far above the surface the tip reflects.
    per_rise: f32,
    is_split: bool,
    /// The spokes to where the outline rises above the surface and where it sinks below, if it does.
    rise: NormalsSpoke,
    sink: NormalsSpoke,
}

/// What triangles reflect together: their parts of what is seen (x), those times their weights, and those times Schlick's
/// factor; the same of the positive parts alone; and the part of triangles whose weight is unknown.
struct NormalsSum {
    all: vec3<f32>,
    positive: vec3<f32>,
    unknown: f32,
}

/// side: 1, or -1 where the light is seen from behind. Without the spokes.
fn normals_fan(
    view: NormalsView,
    tip: vec3<f32>,
    at_tip: vec2<f32>,
    side: f32,
    wide: f32,
    is_split: bool,
) -> NormalsFan {
    // So little that it matters only where all other normals are seen edge-on, where the mean would jump.
    let tip_sample = 0.03 * normals_sample(view, tip);
    let per_rise = 1.0 / max(0.125 * normals_rise(view, tip), 1e-36);
    let none = NormalsSpoke(tip, false, vec3(0.0), vec3(0.0));
    let numbers = normals_numbers(view, wide, is_split);
    return NormalsFan(numbers, tip, at_tip, tip_sample, side * view.stretched, per_rise, is_split, none, none);
}

fn normals_spoke(view: NormalsView, fan: NormalsFan, c: vec3<f32>, is_up: bool) -> NormalsSpoke {
    return NormalsSpoke(c, is_up, normals_arc_bend(fan.tip, c), fan.numbers.edge.y * normals_sample(view, c));
}

/// A spoke that ends on the edge with the horizon's rule, whose corners add nothing to means.
fn normals_spoke_to_setting(fan: NormalsFan, c: vec3<f32>) -> NormalsSpoke {
    return NormalsSpoke(c, true, normals_arc_bend(fan.tip, c), vec3(0.0));
}

/// The first of two spokes, or the second.
fn normals_choose_spoke(first: NormalsSpoke, second: NormalsSpoke, is_second: bool) -> NormalsSpoke {
    return NormalsSpoke(
        select(first.c, second.c, is_second),
        select(first.is_up, second.is_up, is_second),
        select(first.bend, second.bend, is_second),
        select(first.at_end, second.at_end, is_second),
    );
}

/// The integral of the normals of the triangle between two spokes, whose outer side adds curved beyond the plane triangle.
fn normals_flux(fan: NormalsFan, a: NormalsSpoke, b: NormalsSpoke, curved: vec3<f32>) -> vec3<f32> {
    return cross(a.c - fan.tip, b.c - fan.tip) + curved + (a.bend - b.bend);
}

/// A triangle's centroid, by the integral of its normals. Where that is at a right angle to the tip, because what runs on and
/// what runs back cancel each other, it is the tip.
fn normals_centroid(fan: NormalsFan, flux: vec3<f32>) -> vec3<f32> {
    let m = normals_unit(flux);
    let share = clamp(10.0 * dot(m, fan.tip), -1.0, 1.0);
    return share * m + (1.0 - abs(share)) * fan.tip;
}

/// Adds a triangle by its centroid m, its part of what is seen, its mean weight, and that times Schlick's factor. A centroid
/// that reflects below the surface is none: the image of the edge crosses the triangle's other sides.
fn normals_add(
    view: NormalsView,
    fan: NormalsFan,
    sum: NormalsSum,
    m: vec3<f32>,
    whole: f32,
    mean: vec2<f32>,
) -> NormalsSum {
    let known = clamp(normals_rise(view, m) * fan.per_rise, 0.0, 1.0);
    let part = known * whole * vec3(1.0, mean);
    return NormalsSum(sum.all + part, sum.positive + select(vec3(0.0), part, part.x > 0.0), sum.unknown + whole - part.x);
}

/// Adds the triangle between two spokes, which counts by a share. Its mean is that of its centroid, a normal beyond it and its
/// corners.
fn normals_add_triangle(
    view: NormalsView,
    fan: NormalsFan,
    sum: NormalsSum,
    a: NormalsSpoke,
    b: NormalsSpoke,
    curved: vec3<f32>,
    share: f32,
) -> NormalsSum {
    let flux = normals_flux(fan, a, b, curved);
    let m = normals_centroid(fan, flux);
    let outer = normals_sample(view, m + fan.numbers.edge.z * (m - fan.tip));
    let corners = fan.tip_sample + a.at_end + b.at_end;
    let mean = normals_sample(view, m) + fan.numbers.edge.x * outer + corners;
    return normals_add(view, fan, sum, m, share * dot(flux, fan.seen), mean.yz / max(mean.x, 1e-18));
}

/// Adds the triangle, or the two, of an edge between two corners, as far as it is above the surface. They count by a share.
fn normals_add_edge(
    view: NormalsView,
    fan: NormalsFan,
    sum: NormalsSum,
    edge: NormalsEdge,
    a: NormalsSpoke,
    b: NormalsSpoke,
    share: f32,
) -> NormalsSum {
    let counts = select(0.0, share, edge.is_there);
    let begin = normals_choose_spoke(fan.rise, a, a.is_up);
    let end = normals_choose_spoke(fan.sink, b, b.is_up);
    if (fan.is_split) {
        let middle = normals_spoke(view, fan, edge.middle, true);
        let half = normals_add_triangle(view, fan, sum, begin, middle, edge.halves[0], counts);
        return normals_add_triangle(view, fan, half, middle, end, edge.halves[1], counts);
    }
    return normals_add_triangle(view, fan, sum, begin, end, edge.curved, counts);
}

/// Adds edge i and the next, from a to b and from b to c. One edge, none for 8, counts by less than one.
fn normals_add_edges(
    view: NormalsView,
    fan: NormalsFan,
    sum: NormalsSum,
    i: u32,
    edges: NormalsEdges,
    a: NormalsSpoke,
    b: NormalsSpoke,
    c: NormalsSpoke,
    one: u32,
    less: f32,
) -> NormalsSum {
    let first = normals_add_edge(view, fan, sum, edges.first, a, b, select(1.0, less, i == one));
    return normals_add_edge(view, fan, first, edges.second, b, c, select(1.0, less, i + 1u == one));
}

/// Adds a triangle on the edge with the horizon's rule, between normals a and b: by a normal near its outer side, and a second
/// one where the edge is wide.
fn normals_add_on_setting(
    view: NormalsView,
    fan: NormalsFan,
    sum: NormalsSum,
    a: NormalsSpoke,
    b: NormalsSpoke,
    curved: vec3<f32>,
    share: f32,
) -> NormalsSum {
    let flux = normals_flux(fan, a, b, curved);
    let m = normals_centroid(fan, flux);
    let near = normals_weight(view, m + fan.numbers.horizon.y * (m - fan.tip));
    var energy = normals_to_horizon(fan.at_tip.x, near.x, fan.numbers.horizon.x);
    if (fan.numbers.inner.x > 0.0) {
        let within = normals_weight(view, m + fan.numbers.inner.y * (m - fan.tip));
        energy = mix(energy, within.x, fan.numbers.inner.x);
    }
    let mean = energy * vec2(1.0, mix(near.y, fan.at_tip.y, fan.numbers.horizon.z));
    return normals_add(view, fan, sum, m, share * dot(flux, fan.seen), mean);
}

/// Adds the triangles on the edge with the horizon's rule, two at a time: those of an integral, or of half of one where it is wide.
/// The corner within a half starts at the middle of the whole where the edge begins to be wide, and moves to the half's own middle as
/// it gets wider, so that nothing jumps.
fn normals_add_setting(view: NormalsView, fan: NormalsFan, sum: NormalsSum, setting: NormalsSetting) -> NormalsSum {
    let is_wide = setting.wide > 0.0;
    let parts = select(2u, 4u, fan.is_split);
    let pairs = select(parts, 2u * parts, is_wide);
    let step = 1.0 / f32(pairs);
    let to_middle = 0.5 * select(1.0, setting.wide, is_wide);
    var added = sum;
    var before = normals_spoke_to_setting(fan, setting.begin);
    var second = vec3(0.0);
    for (var i = 0u; i < 8u; i++) {
        if (i >= pairs) {
            break;
        }
        let part = select(i, i / 2u, is_wide);
        let low = select(setting.parts[0], setting.parts[1], part == 1u);
        let high = select(setting.parts[2], setting.parts[3], part == 3u);
        let whole = select(low, high, part >= 2u);
        let is_second = i % 2u == 1u;
        let t = f32(i);
        let middle_c = normals_on_setting(setting, step * (t + select(1.0 - to_middle, to_middle, is_second)));
        let end_c = normals_on_setting(setting, step * (t + 1.0));
        let last_c = normals_on_setting(setting, step * (t + 2.0));
        let halves = normals_shared(before.c, end_c, last_c, whole);
        let half = select(halves[0], second, is_second);
        second = halves[1];
        let curved = normals_shared(before.c, middle_c, end_c, select(whole, half, is_wide));
        let middle = normals_spoke_to_setting(fan, middle_c);
        let end = normals_spoke_to_setting(fan, end_c);
        added = normals_add_on_setting(view, fan, added, before, middle, curved[0], setting.share);
        added = normals_add_on_setting(view, fan, added, middle, end, curved[1], setting.share);
        before = end;
    }
    return added;
}

/// What is reflected of a light whose part is seen. Where the image bends around the mean normal, triangles reach beyond
/// it, and those that run back take that away again. Their rules may differ by more than what they leave of each other, so
/// there the mean weight is in part that of the positive triangles alone; so it is in triangles whose own is unknown.
fn normals_total(fan: NormalsFan, sum: NormalsSum, seen: f32) -> vec2<f32> {
    let share = clamp((sum.positive.x + sum.unknown - seen) / max(seen, 1e-18), 0.0, 0.5);
    // The tip counts so little that it matters only where nothing else does.
    let tip = 1e-6 * max(seen, 1e-18);
    let per_part = (share * sum.unknown + (1.0 - share) * seen) / (sum.positive.x + tip);
    return share * sum.all.yz + per_part * (sum.positive.yz + tip * fan.at_tip.x * vec2(1.0, fan.at_tip.y));
}
