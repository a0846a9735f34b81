// What of a light's outline is above the surface, edge by edge, and which edge is on or near the horizon. Needs
// normals_corner.wgsl and normals_edge.wgsl.
//
// All edges are written one after the other, two at a time: software drivers keep what a loop passes on in memory, under
// a mask, which takes longer than an integral.

/// A light above a surface.
struct NormalsLight {
    /// How many edges it has, and four over its height.
    number: u32,
    per_height: f32,
    /// Whether the surface cuts it, and where its outline rises above the surface and sinks below it then.
    is_cut: bool,
    rise: NormalsCorner,
    sink: NormalsCorner,
}

/// An edge, as far as it is above the surface.
struct NormalsEdge {
    /// Whether any of it is.
    is_there: bool,
    begin: NormalsCorner,
    end: NormalsCorner,
    /// What its image adds to the integral beyond the plane triangle.
    curved: vec3<f32>,
    /// Of rules that split it: the middle of its image, and what each half adds.
    middle: vec3<f32>,
    halves: mat2x3<f32>,
    /// How near to the horizon it is, from 0 to 1.
    near: f32,
}

struct NormalsEdges {
    first: NormalsEdge,
    second: NormalsEdge,
}

/// What the edges of an outline are together.
struct NormalsOutline {
    /// The integral of c x dc around the image, with plane triangles around the origin.
    origin: vec3<f32>,
    flux: vec3<f32>,
    /// Which edge is nearest to the horizon, its ends, and what it adds to the integral beyond the plane triangle.
    nearest: u32,
    begin: NormalsCorner,
    end: NormalsCorner,
    curved: vec3<f32>,
    /// The sum of nearness times extent over all edges; and nearness squared times extent, the largest and the second.
    extents: f32,
    most: f32,
    second: f32,
}

/// The direction in which the edge between corners on either side of the horizon meets it.
fn normals_crossing(a: vec3<f32>, b: vec3<f32>) -> vec3<f32> {
    return vec3(a.xy * abs(b.z) + b.xy * abs(a.z), 0.0);
}

/// Where an outline rises (0) and sinks (1), so far as known, and where the edge from a to b does.
fn normals_cut_by(cut: mat2x3<f32>, a: NormalsCorner, b: NormalsCorner) -> mat2x3<f32> {
    let crossing = normals_crossing(a.w, b.w);
    let rises = a.height <= 0.0 && b.height > 0.0;
    let sinks = a.height > 0.0 && b.height <= 0.0;
    return mat2x3(select(cut[0], crossing, rises), select(cut[1], crossing, sinks));
}

/// Edge i of a light, from a to b, without its integral.
fn normals_edge_of(light: NormalsLight, i: u32, a: NormalsCorner, b: NormalsCorner) -> NormalsEdge {
    let top = max(a.height, b.height);
    let is_there = top > 0.0 && i < light.number;
    let begin = normals_choose(light.rise, a, a.height > 0.0);
    // What is below has no length.
    let end = normals_choose(begin, normals_choose(light.sink, b, b.height > 0.0), is_there);
    let near = select(0.0, max(1.0 - top * light.per_height, 0.0), is_there);
    return NormalsEdge(is_there, begin, end, vec3(0.0), begin.c, mat2x3(vec3(0.0), vec3(0.0)), near);
}

/// The same edge with its integral by two halves.
fn normals_split(view: NormalsView, edge: NormalsEdge) -> NormalsEdge {
    var split = edge;
    let middle = normals_between(edge.begin, edge.end, 0.5, view);
    split.middle = middle.c;
    split.halves = normals_curved(view, edge.begin, middle, middle, edge.end);
    split.curved = split.halves[0] + split.halves[1] + cross(middle.c - edge.begin.c, edge.end.c - edge.begin.c);
    return split;
}

/// Edge i of a light, from a to b, and the next, from b to c.
fn normals_edges(
    view: NormalsView,
    light: NormalsLight,
    i: u32,
    a: NormalsCorner,
    b: NormalsCorner,
    c: NormalsCorner,
    is_split: bool,
) -> NormalsEdges {
    var edges = NormalsEdges(normals_edge_of(light, i, a, b), normals_edge_of(light, i + 1u, b, c));
    if (is_split) {
        return NormalsEdges(normals_split(view, edges.first), normals_split(view, edges.second));
    }
    let curved = normals_curved(view, edges.first.begin, edges.first.end, edges.second.begin, edges.second.end);
    edges.first.curved = curved[0];
    edges.second.curved = curved[1];
    return edges;
}

/// Adds edge i to an outline.
fn normals_outline_with(outline: NormalsOutline, i: u32, edge: NormalsEdge) -> NormalsOutline {
    var next = outline;
    next.flux += edge.curved + cross(edge.begin.c - outline.origin, edge.end.c - outline.origin);
    let extent = edge.near * distance(edge.begin.w, edge.end.w);
    let by_extent = edge.near * extent;
    let is_nearer = by_extent > outline.most;
    next.begin = normals_choose(outline.begin, edge.begin, is_nearer);
    next.end = normals_choose(outline.end, edge.end, is_nearer);
    next.curved = select(outline.curved, edge.curved, is_nearer);
    next.nearest = select(outline.nearest, i, is_nearer);
    next.second = max(outline.second, min(by_extent, outline.most));
    next.most = max(outline.most, by_extent);
    next.extents += extent;
    return next;
}

/// Adds edge i and the next.
fn normals_outline_with_both(outline: NormalsOutline, i: u32, edges: NormalsEdges) -> NormalsOutline {
    return normals_outline_with(normals_outline_with(outline, i, edges.first), i + 1u, edges.second);
}

/// The edge that has the horizon's rule, and the horizon.
///
/// The weight is zero on the horizon, so an edge there has a rule of its own and more parts, and so has one that is near: whose
/// higher end is lower than a quarter of the light's height. It is the edge with the largest nearness^2 times extent, the horizon's
/// nearness being one, by how much that exceeds the second largest, over the sum of nearness times extent. So nothing jumps.
struct NormalsSetting {
    /// Whether there is such an edge, by which share it counts as the horizon, and whether it is the horizon.
    is_there: bool,
    share: f32,
    is_horizon: bool,
    /// How wide it is, from 0 to 1: above zero each of its triangles is two.
    wide: f32,
    /// Its image as a rational curve: the ends at length one and the control point between them.
    begin: vec3<f32>,
    control: vec3<f32>,
    end: vec3<f32>,
    /// What its parts add: two of them, or four where edges are split.
    parts: array<vec3<f32>, 4>,
    /// The horizon as an edge like the others, if the light is cut.
    horizon: NormalsEdge,
}

/// What the parts of an arc add together, by what each adds and the ends between them.
fn normals_joined(first: vec3<f32>, second: vec3<f32>, begin: vec3<f32>, middle: vec3<f32>, end: vec3<f32>) -> vec3<f32> {
    return first + second + cross(middle - begin, end - begin);
}

/// is_near_too: whether edges near the horizon have its rule as well.
fn normals_setting(
    view: NormalsView,
    outline: NormalsOutline,
    light: NormalsLight,
    is_near_too: bool,
    is_split: bool,
) -> NormalsSetting {
    // None where nothing is cut.
    let horizon = distance(light.rise.w, light.sink.w);
    let own = select(vec3(0.0), vec3(outline.most, outline.second, outline.extents), is_near_too);
    let second = max(own.y, min(own.x, horizon));
    let is_horizon = light.is_cut && horizon >= own.x;
    var setting: NormalsSetting;
    setting.is_there = light.is_cut || own.x > 0.0;
    setting.share = (max(own.x, horizon) - second) / max(own.z + horizon, 1e-36);
    setting.is_horizon = is_horizon;
    if (!setting.is_there) {
        return setting;
    }
    let begin = normals_choose(outline.begin, light.sink, is_horizon);
    let end = normals_choose(outline.end, light.rise, is_horizon);
    setting.wide = setting.share * smoothstep(1.2, 1.8, distance(begin.w, end.w));
    let sum = begin.w + end.w;
    let half = normals_half_cosine(begin, end);
    let control = normals_unstretched(view.wo * half + sum * (0.5 / half), view);
    setting.begin = begin.c;
    setting.control = control * inverseSqrt(begin.length * end.length);
    setting.end = end.c;
    // Integrals come in pairs. With that of the last part but one comes that of the last part, if this is the horizon. If it is not,
    // that of the whole horizon comes in its place, and the last part is what the others leave of the edge's own integral.
    let middle = normals_between(begin, end, 0.5, view);
    var before = begin;
    var joined = vec3(0.0);
    if (is_split) {
        let quarter = normals_between(begin, end, 0.25, view);
        let halved = normals_curved(view, begin, quarter, quarter, middle);
        setting.parts[0] = halved[0];
        setting.parts[1] = halved[1];
        joined = normals_joined(halved[0], halved[1], begin.c, quarter.c, middle.c);
        before = middle;
    }
    let last = normals_choose(middle, normals_between(begin, end, 0.75, view), is_split);
    let curved = normals_curved(view, before, last, normals_choose(light.sink, last, is_horizon), light.rise);
    let but_last = select(curved[0], normals_joined(joined, curved[0], begin.c, middle.c, last.c), is_split);
    let rest = outline.curved - but_last - cross(last.c - begin.c, end.c - begin.c);
    let final_part = select(rest, curved[1], is_horizon);
    setting.horizon.is_there = light.is_cut;
    setting.horizon.begin = light.sink;
    setting.horizon.end = light.rise;
    setting.horizon.curved = select(curved[1], normals_joined(but_last, final_part, begin.c, last.c, end.c), is_horizon);
    if (!is_split) {
        setting.parts[0] = curved[0];
        setting.parts[1] = final_part;
        return setting;
    }
    setting.parts[2] = curved[0];
    setting.parts[3] = final_part;
    if (is_horizon) {
        setting.horizon.middle = middle.c;
        setting.horizon.halves = mat2x3(joined, normals_joined(curved[0], final_part, middle.c, last.c, end.c));
    } else {
        setting.horizon = normals_split(view, setting.horizon);
    }
    return setting;
}

/// The image of a setting edge at t in (0, 1].
fn normals_on_setting(setting: NormalsSetting, t: f32) -> vec3<f32> {
    let u = 1.0 - t;
    let c = normals_unit(setting.begin * (u * u) + setting.control * (2.0 * u * t) + setting.end * (t * t));
    return select(c, setting.end, t >= 1.0);
}
