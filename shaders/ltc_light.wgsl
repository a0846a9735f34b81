// Integrates a Linearly Transformed Cosine over polygons. Needs ltc_rectangle.wgsl. Outlines must be convex.

/// Whether to replace the integral above the horizon by a fit [Hill and Heitz 2016], for polygons, disks and spheres.
/// The fit is cheaper, but mostly too bright. The error is 0.033 on average and at most 0.16 for disks that the horizon
/// cuts. For disks above the horizon, it is 0.003 on average and at most 0.09.
const LTC_CHEAP_HORIZON: bool = false;

/// The integral over a convex polygon, added up edge by edge. It leaves out parts below the horizon of the lobe.
struct LtcClip {
    sum: f32,
    /// A point near the outline.
    origin: vec3<f32>,
    previous: vec3<f32>,
    previous_unit: vec3<f32>,
    /// The points where the outline leaves the upper hemisphere and enters it again.
    leaves: vec3<f32>,
    enters: vec3<f32>,
    /// For LTC_CHEAP_HORIZON: the vector form factor without a horizon, times 2 pi; and the sum of the vertices'
    /// directions.
    flux: vec3<f32>,
    ahead: vec3<f32>,
}

/// Starts an outline at a vertex in cosine space. Call ltc_clip_edge with each of the other vertices in order, then
/// with this vertex.
fn ltc_clip_begin(vertex: vec3<f32>) -> LtcClip {
    let start = ltc_unit(vertex);
    return LtcClip(0.0, start, vertex, start, vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0));
}

fn ltc_clip_edge(clip: LtcClip, b: vec3<f32>) -> LtcClip {
    if (LTC_CHEAP_HORIZON) {
        var next = clip;
        next.previous = b;
        next.previous_unit = ltc_unit(b);
        let c = cross(clip.previous_unit, next.previous_unit);
        next.flux += c + c * ltc_bend(clip.previous_unit, next.previous_unit);
        next.ahead += next.previous_unit;
        return next;
    }
    return ltc_clip_exact_edge(clip, b);
}

/// Does the same as ltc_clip_edge if LTC_CHEAP_HORIZON is false.
fn ltc_clip_exact_edge(clip: LtcClip, b: vec3<f32>) -> LtcClip {
    var next = clip;
    let a = clip.previous;
    next.previous = b;
    next.previous_unit = ltc_unit(b);
    var from_point = clip.previous_unit;
    var to_point = next.previous_unit;
    if (a.z > 0.0 && b.z <= 0.0) {
        next.leaves = ltc_unit(vec3(b.xy * a.z - a.xy * b.z, 0.0));
        to_point = next.leaves;
    }
    if (a.z <= 0.0 && b.z > 0.0) {
        next.enters = ltc_unit(vec3(a.xy * b.z - b.xy * a.z, 0.0));
        from_point = next.enters;
    }
    if (a.z > 0.0 || b.z > 0.0) {
        next.sum += ltc_chord(from_point, to_point, clip.origin) + ltc_arc(from_point, to_point);
    }
    return next;
}

/// The covered part of the lobe, from 0 to 1. An arc along the horizon closes an outline that the horizon cuts.
fn ltc_clip_finish(clip: LtcClip, side: f32, two_sided: bool) -> f32 {
    if (LTC_CHEAP_HORIZON) {
        // The form factor of a sphere with the same vector form factor.
        let length = sqrt(dot(clip.flux, clip.flux)) * 0.15915494;
        let ahead = dot(clip.flux, clip.ahead);
        let is_lit = side * ahead > 0.0;
        let up = select(-1.0, 1.0, ahead > 0.0) * clip.flux.z * 0.15915494;
        let covered = clamp((length * length + up) / (length + 1.0), 0.0, 1.0);
        return select(0.0, covered, is_lit || (two_sided && side != 0.0));
    }
    return ltc_clip_exact_finish(clip, side, two_sided);
}

/// Returns the same as ltc_clip_finish if LTC_CHEAP_HORIZON is false.
fn ltc_clip_exact_finish(clip: LtcClip, side: f32, two_sided: bool) -> f32 {
    let is_cut = any(clip.leaves != clip.enters);
    let closing = select(0.0, ltc_chord(clip.leaves, clip.enters, clip.origin) + ltc_arc(clip.leaves, clip.enters), is_cut);
    let sum = (clip.sum + closing) * 0.15915494 * side;
    return clamp(select(sum, abs(sum), two_sided), 0.0, 1.0);
}

/// The covered part of the lobe for a rectangle if LTC_CHEAP_HORIZON is true.
fn ltc_cheap_rectangle(inverse: LtcInverse, corners: array<vec3<f32>, 4>, two_sided: bool) -> f32 {
    var clip = ltc_clip_begin(inverse.m * corners[3]);
    clip = ltc_clip_edge(clip, inverse.m * corners[0]);
    clip = ltc_clip_edge(clip, inverse.m * corners[1]);
    clip = ltc_clip_edge(clip, inverse.m * corners[2]);
    clip = ltc_clip_edge(clip, inverse.m * corners[3]);
    return ltc_clip_finish(clip, inverse.side, two_sided);
}

/// The covered part of the lobe for a rectangle or parallelogram, given by its corners in order. The last corner is not
/// read.
fn ltc_rectangle(inverse: LtcInverse, corners: array<vec3<f32>, 4>, two_sided: bool) -> f32 {
    if (LTC_CHEAP_HORIZON) {
        return ltc_cheap_rectangle(inverse, corners, two_sided);
    }
    return ltc_exact_rectangle(inverse, corners, two_sided);
}

/// The covered part of the lobe for a convex polygon with 3 to 8 vertices in order. The count is clamped to this range.
fn ltc_polygon(inverse: LtcInverse, vertices: array<vec3<f32>, 8>, count: u32, two_sided: bool) -> f32 {
    var outline = vertices;
    let number = clamp(count, 3u, 8u);
    var clip = ltc_clip_begin(inverse.m * outline[number - 1u]);
    for (var i = 0u; i < 8u; i++) {
        if (i >= number) {
            break;
        }
        clip = ltc_clip_edge(clip, inverse.m * outline[i]);
    }
    return ltc_clip_finish(clip, inverse.side, two_sided);
}
