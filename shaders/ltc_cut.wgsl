// Integrates a Linearly Transformed Cosine over polygons. The surface cuts the lobe, so no light shines through from
// below. Needs ltc_light.wgsl.
//
// Lights are relative to the shaded point, in its tangent frame, normal +z, as in ltc_light.wgsl. They are clipped by
// the surface first, then by the horizon of the lobe. The result is divided by the fraction of the lobe above the
// surface.

/// The outline of a light. The surface clips its edges one by one.
struct LtcCut {
    clip: LtcClip,
    /// The points where the outline leaves the upper hemisphere and enters it again, in the tangent frame.
    leaves: vec3<f32>,
    enters: vec3<f32>,
}

/// One over the fraction of the lobe above the surface. The fraction is (1 + cos t) / 2, where t is the angle between
/// the normal z and M^T z: the integral of a clamped cosine over a half space.
fn ltc_per_part_above(inverse: LtcInverse) -> f32 {
    // row is the last row of M, up to a factor.
    let row = cross(inverse.m[0], inverse.m[1]) * inverse.side;
    return 2.0 / max(1.0 + row.z * inverseSqrt(dot(row, row) + 1e-36), 1e-6);
}

/// Adds an edge above the surface. The edge may start anywhere, not only where the last edge ended.
fn ltc_cut_above(inverse: LtcInverse, clip: LtcClip, start: vec3<f32>, end: vec3<f32>) -> LtcClip {
    var next = clip;
    let a = inverse.m * start;
    let b = inverse.m * end;
    next.previous = a;
    next.previous_unit = ltc_unit(a);
    next = ltc_clip_edge(next, b);
    if (LTC_CHEAP_HORIZON) {
        // Polygons do not use this sum. ltc_cut_shapes.wgsl adds arcs to it.
        var p = ltc_unit(a);
        var q = ltc_unit(b);
        if (a.z > 0.0 && b.z <= 0.0) {
            q = ltc_unit(vec3(b.xy * a.z - a.xy * b.z, 0.0));
            next.leaves = q;
        }
        if (a.z <= 0.0 && b.z > 0.0) {
            p = ltc_unit(vec3(a.xy * b.z - b.xy * a.z, 0.0));
            next.enters = p;
        }
        if (a.z > 0.0 || b.z > 0.0) {
            next.sum += ltc_chord(p, q, clip.origin) + ltc_arc(p, q);
        }
    }
    return next;
}

/// Adds an edge of a light, clipped by the surface.
fn ltc_cut_edge(inverse: LtcInverse, cut: LtcCut, a: vec3<f32>, b: vec3<f32>) -> LtcCut {
    var next = cut;
    if (a.z <= 0.0 && b.z <= 0.0) {
        return next;
    }
    let crossing = vec3(a.xy * abs(b.z) + b.xy * abs(a.z), 0.0);
    var start = a;
    var end = b;
    if (b.z <= 0.0) {
        next.leaves = crossing;
        end = crossing;
    }
    if (a.z <= 0.0) {
        next.enters = crossing;
        start = crossing;
    }
    next.clip = ltc_cut_above(inverse, next.clip, start, end);
    return next;
}

/// The covered part of the lobe. A straight edge along the surface closes an outline that the surface cuts.
fn ltc_cut_finish(inverse: LtcInverse, cut: LtcCut, two_sided: bool) -> f32 {
    var clip = cut.clip;
    if (any(cut.leaves != cut.enters)) {
        clip = ltc_cut_above(inverse, clip, cut.leaves, cut.enters);
    }
    return min(ltc_clip_finish(clip, inverse.side, two_sided) * ltc_per_part_above(inverse), 1.0);
}

/// Like ltc_rectangle, but without light from below the surface.
fn ltc_cut_rectangle(inverse: LtcInverse, corners: array<vec3<f32>, 4>, two_sided: bool) -> f32 {
    let last = corners[0] + corners[2] - corners[1];
    var cut = LtcCut(ltc_clip_begin(inverse.m * corners[0]), vec3(0.0), vec3(0.0));
    cut = ltc_cut_edge(inverse, cut, corners[0], corners[1]);
    cut = ltc_cut_edge(inverse, cut, corners[1], corners[2]);
    cut = ltc_cut_edge(inverse, cut, corners[2], last);
    cut = ltc_cut_edge(inverse, cut, last, corners[0]);
    return ltc_cut_finish(inverse, cut, two_sided);
}

/// Like ltc_polygon, but without light from below the surface.
fn ltc_cut_polygon(inverse: LtcInverse, vertices: array<vec3<f32>, 8>, count: u32, two_sided: bool) -> f32 {
    var outline = vertices;
    let number = clamp(count, 3u, 8u);
    var previous = outline[number - 1u];
    var cut = LtcCut(ltc_clip_begin(inverse.m * previous), vec3(0.0), vec3(0.0));
    for (var i = 0u; i < 8u; i++) {
        if (i >= number) {
            break;
        }
        cut = ltc_cut_edge(inverse, cut, previous, outline[i]);
        previous = outline[i];
    }
    return ltc_cut_finish(inverse, cut, two_sided);
}
