// Integrates a Linearly Transformed Cosine over a polygon. Needs ltc_math.wgsl.
//
// Vertices are relative to the shaded point, in its tangent frame, normal +z. They run clockwise as seen from the side
// that emits. The outline must be convex. ltc_shapes.wgsl has lights of other shapes.

/// Whether to replace the integral above the horizon by a fit [Hill and Heitz 2016], for polygons, disks and spheres.
/// The fit is cheaper, but mostly too bright. The error is 0.033 on average and at most 0.16 for disks that the horizon
/// cuts. For disks above the horizon, it is 0.003 on average and at most 0.09.
const LTC_CHEAP_HORIZON: bool = false;

/// The inverse of M up to a positive factor, which does not change directions.
struct LtcInverse {
    m: mat3x3<f32>,
    /// -1 if M mirrors, which reverses the order of vertices. 0 if M has no inverse; no light is reflected then.
    side: f32,
}

/// The inverse of M: the adjugate divided by its largest element. The determinant may underflow, and the inverse of a
/// sharp lobe has elements of size 1 / alpha. This form needs no determinant and keeps vertices of any size in range.
fn ltc_inverse(m: mat3x3<f32>) -> LtcInverse {
    let x = cross(m[1], m[2]);
    let y = cross(m[2], m[0]);
    let z = cross(m[0], m[1]);
    let most = max(max(abs(x), abs(y)), abs(z));
    let largest = max(max(most.x, most.y), most.z);
    let side = select(0.0, sign(dot(m[2], z)), largest > 1e-30 && largest < 1e30);
    let scale = side / max(largest, 1e-30);
    return LtcInverse(transpose(mat3x3(x * scale, y * scale, z * scale)), side);
}

/// The vector scaled to unit length; zero for a zero vector.
fn ltc_unit(v: vec3<f32>) -> vec3<f32> {
    return v * inverseSqrt(dot(v, v) + 1e-36);
}

/// The angle between two unit vectors divided by its sine, minus one. Error below 2.5e-5 h / sin(h), where h is half
/// the angle. The sum of the vectors stays precise up to an angle of 180 degrees; their dot product does not
/// [ltcforge-studies, polynomials].
fn ltc_bend(a: vec3<f32>, b: vec3<f32>) -> f32 {
    let sum = a + b;
    let k = dot(sum, sum) + 1e-18;
    return (3.1415927 + (0.3824614 + 0.0361113 * k) * k) * inverseSqrt(k) - (1.9987368 + (0.1384879 + 0.0044966 * k) * k);
}

/// acos(a . b) (a x b).z / |a x b| minus (a x b).z.
fn ltc_arc(a: vec3<f32>, b: vec3<f32>) -> f32 {
    return (a.x * b.y - a.y * b.x) * ltc_bend(a, b);
}

/// (a x b).z, computed relative to an origin.
///
/// The sum over a closed outline does not depend on the origin. With an origin near a small light, each term is as
/// small as the sum. Otherwise rounding errors would be larger than the sum.
fn ltc_chord(a: vec3<f32>, b: vec3<f32>, origin: vec3<f32>) -> f32 {
    let p = a.xy - origin.xy;
    let q = b.xy - origin.xy;
    return p.x * q.y - p.y * q.x;
}

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
///
/// Two edges rise from the lowest corner, and two more edges rise to the highest corner. The part above the horizon has
/// at most five corners: the highest corner; the two corners next to it, moved up to the horizon if they are below it;
/// and the points where both paths from the lowest corner cross the horizon. If nothing is cut off, both points are the
/// lowest corner. All five corners move continuously with the light.
fn ltc_rectangle(inverse: LtcInverse, corners: array<vec3<f32>, 4>, two_sided: bool) -> f32 {
    if (LTC_CHEAP_HORIZON) {
        return ltc_cheap_rectangle(inverse, corners, two_sided);
    }
    var x = inverse.m * (corners[1] - corners[0]);
    var y = inverse.m * (corners[2] - corners[1]);
    let falls = vec2(x.z, y.z) < vec2(0.0);
    let turn = select(vec2(1.0), vec2(-1.0), falls);
    x *= turn.x;
    y *= turn.y;
    let lowest = inverse.m * corners[0] + x * (0.5 * turn.x - 0.5) + y * (0.5 * turn.y - 0.5);
    let a = lowest + x;
    let b = lowest + y;
    let highest = a + y;
    // The fraction of each edge that is below the horizon.
    let per_height = vec2(1.0) / max(vec2(x.z, y.z), vec2(1e-36));
    let low = clamp(-lowest.z * per_height, vec2(0.0), vec2(1.0));
    let last_x = clamp(-b.z * per_height.x, 0.0, 1.0);
    let last_y = clamp(-a.z * per_height.y, 0.0, 1.0);
    let d = ltc_unit(lowest + low.y * y + last_x * x);
    let e = ltc_unit(lowest + low.x * x + last_y * y);
    let f = ltc_unit(a + last_y * y);
    let g = ltc_unit(highest);
    let h = ltc_unit(b + last_x * x);
    let sum = ltc_chord(h, d, g) + ltc_chord(d, e, g) + ltc_chord(e, f, g)
        + ltc_arc(d, e) + ltc_arc(e, f) + ltc_arc(f, g) + ltc_arc(g, h) + ltc_arc(h, d);
    let covered = sum * 0.15915494 * (inverse.side * turn.x * turn.y);
    return select(0.0, clamp(select(covered, abs(covered), two_sided), 0.0, 1.0), highest.z > 0.0);
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
