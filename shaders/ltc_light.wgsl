// Integrates a Linearly Transformed Cosine over a polygon. Needs ltc_math.wgsl.
//
// Vertices are given relative to the shaded point in its tangent frame, normal +z. The lit side is the one from which
// they run clockwise. The outline has to be convex. ltc_shapes.wgsl has lights that are no polygons.

/// Whether what the horizon leaves of polygons, disks and spheres is guessed by a fit [Hill and Heitz 2016] instead of
/// integrated. It is cheaper and mostly too bright: of disks by 0.033 on average and 0.16 at most where the horizon cuts them, by
/// 0.003 on average and 0.09 at most above it.
const LTC_CHEAP_HORIZON: bool = false;

/// The inverse of M up to a positive factor, which changes no direction.
struct LtcInverse {
    m: mat3x3<f32>,
    /// -1 where M mirrors and so turns polygons over; 0 where it has no inverse: nothing is lit then.
    side: f32,
}

/// The inverse's numbers grow as 1 / alpha for sharp lobes. The adjugate divided by its largest element needs no
/// determinant, which may underflow, and keeps vertices of any size in range.
fn ltc_inverse(m: mat3x3<f32>) -> LtcInverse {
    let x = cross(m[1], m[2]);
    let y = cross(m[2], m[0]);
    let z = cross(m[0], m[1]);
    let most = max(max(abs(x), abs(y)), abs(z));
    let largest = max(max(most.x, most.y), most.z);
    let side = sign(dot(m[2], z));
    if (!(largest > 1e-30 && largest < 1e30)) {
        return LtcInverse(mat3x3<f32>(), 0.0);
    }
    let scale = side / largest;
    return LtcInverse(transpose(mat3x3(x * scale, y * scale, z * scale)), side);
}

/// The integral over a convex polygon, added up edge by edge; what lies below the lobe's horizon is left out.
struct LtcClip {
    sum: f32,
    /// A place near the outline.
    origin: vec2<f32>,
    previous: vec3<f32>,
    previous_unit: vec3<f32>,
    /// Where the outline dips below the horizon and where it comes back.
    leaves: vec3<f32>,
    enters: vec3<f32>,
    /// For LTC_CHEAP_HORIZON: the vector form factor without a horizon, times 2 pi, and the sum of the vertices' directions.
    flux: vec3<f32>,
    ahead: vec3<f32>,
}

/// The vector at length one; zero for one without direction.
fn ltc_unit(v: vec3<f32>) -> vec3<f32> {
    let length2 = dot(v, v);
    return select(vec3(0.0), v / sqrt(max(length2, 1e-36)), length2 > 1e-36);
}

/// acos(a . b) / |a x b| - 1.
fn ltc_bend(a: vec3<f32>, b: vec3<f32>) -> f32 {
    let c = cross(a, b);
    let s = sqrt(dot(c, c));
    return select(0.0, ltc_atan2(s, dot(a, b)) / max(s, 1e-18) - 1.0, s > 1e-18);
}

/// acos(a . b) (a x b).z / |a x b|, by the angle's sine and cosine: acos alone is inaccurate for short arcs.
///
/// For a closed outline the sum of (a x b).z is the same for every origin. With an origin near a small light each term
/// is as small as the sum, which rounding errors would otherwise swamp.
fn ltc_arc(a: vec3<f32>, b: vec3<f32>, origin: vec2<f32>) -> f32 {
    let p = a.xy - origin;
    let q = b.xy - origin;
    return p.x * q.y - p.y * q.x + cross(a, b).z * ltc_bend(a, b);
}

/// Begins at a vertex in cosine space; ltc_clip_edge then takes each of the others in turn, and this one last.
fn ltc_clip_begin(vertex: vec3<f32>) -> LtcClip {
    let start = ltc_unit(vertex);
    return LtcClip(0.0, start.xy, vertex, start, vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0));
}

fn ltc_clip_edge(clip: LtcClip, b: vec3<f32>) -> LtcClip {
    var next = clip;
    let a = clip.previous;
    next.previous = b;
    next.previous_unit = ltc_unit(b);
    if (LTC_CHEAP_HORIZON) {
        let c = cross(clip.previous_unit, next.previous_unit);
        next.flux += c + c * ltc_bend(clip.previous_unit, next.previous_unit);
        next.ahead += next.previous_unit;
        return next;
    }
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
        next.sum += ltc_arc(from_point, to_point, clip.origin);
    }
    return next;
}

/// The part of the distribution that the polygon covers, in [0, 1]. An arc along the horizon closes a cut outline.
fn ltc_clip_finish(clip: LtcClip, side: f32, two_sided: bool) -> f32 {
    if (LTC_CHEAP_HORIZON) {
        // The light of a sphere of the same vector form factor.
        let length = sqrt(dot(clip.flux, clip.flux)) * 0.15915494;
        let ahead = dot(clip.flux, clip.ahead);
        let is_lit = side * ahead > 0.0;
        let up = select(-1.0, 1.0, ahead > 0.0) * clip.flux.z * 0.15915494;
        let seen = clamp((length * length + up) / (length + 1.0), 0.0, 1.0);
        return select(0.0, seen, is_lit || (two_sided && side != 0.0));
    }
    let is_cut = any(clip.leaves != clip.enters);
    let closing = select(0.0, ltc_arc(clip.leaves, clip.enters, clip.origin), is_cut);
    let sum = (clip.sum + closing) * 0.15915494 * side;
    return clamp(select(sum, abs(sum), two_sided), 0.0, 1.0);
}

/// A rectangle by its corners in order.
fn ltc_rectangle(inverse: LtcInverse, corners: array<vec3<f32>, 4>, two_sided: bool) -> f32 {
    var clip = ltc_clip_begin(inverse.m * corners[3]);
    clip = ltc_clip_edge(clip, inverse.m * corners[0]);
    clip = ltc_clip_edge(clip, inverse.m * corners[1]);
    clip = ltc_clip_edge(clip, inverse.m * corners[2]);
    clip = ltc_clip_edge(clip, inverse.m * corners[3]);
    return ltc_clip_finish(clip, inverse.side, two_sided);
}

/// A convex polygon of 3 to 8 vertices in order; another count is taken as the nearest of these.
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
