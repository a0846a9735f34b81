// The light of a polygon on GGX in closed form, without a table: the integral of the visible normals that reflect it,
// exact, and the mean of the weight of shadowing. Needs ltc_math.wgsl.
//
// Vertices are given relative to the shaded point in its tangent frame, normal +z. The lit side is the one from which
// they run clockwise. The outline has to be convex; a disk is lit as a polygon of its area.

/// How the weight is averaged: over triangles between the mean normal and each edge, the horizon in four parts; the
/// weight of the mean normal; triangles of edges split in two, and of the horizon in eight.
const NORMALS_FAN: u32 = 0u;
const NORMALS_MEAN: u32 = 1u;
const NORMALS_FINE: u32 = 2u;

/// A surface seen from a direction.
struct NormalsView {
    alpha: vec2<f32>,
    /// 1 / alpha.
    per_alpha: vec2<f32>,
    wo: vec3<f32>,
    /// A wo with A = diag(alpha, 1), and its length.
    stretched: vec3<f32>,
    length: f32,
}

/// A corner of a light's outline.
struct NormalsCorner {
    /// Its direction.
    w: vec3<f32>,
    /// Its image among the normals, A^-1 (wo + w), at length one.
    c: vec3<f32>,
    /// The image's length before.
    length: f32,
}

/// A light's outline above the surface.
struct NormalsOutline {
    /// The number of its vertices, and the first of them that is above the surface after one that is not; zero if all are.
    number: u32,
    start: u32,
    /// Whether the surface cuts it, and how many vertices are above.
    is_cut: bool,
    ups: u32,
    /// How far it is cut: 0 where it touches the surface, 1 where it is deeper below than an eighth of its height above.
    share: f32,
    /// Whether it may have more than four vertices. Where a compiler knows that it has not, half of the work on lists falls
    /// away.
    many: bool,
}

/// An arc along the horizon: its image by the ends at length one and the control point between them, and the normal of
/// its plane.
struct NormalsHorizon {
    begin: vec3<f32>,
    control: vec3<f32>,
    end: vec3<f32>,
    across: vec3<f32>,
}

/// alpha in (0, 1]; wo of unit length in the tangent frame.
fn normals_view(alpha_x: f32, alpha_y: f32, wo: vec3<f32>) -> NormalsView {
    let alpha = max(vec2(alpha_x, alpha_y), vec2(1e-5));
    let stretched = vec3(alpha * wo.xy, wo.z);
    return NormalsView(alpha, 1.0 / alpha, wo, stretched, sqrt(dot(stretched, stretched)));
}

/// A^-1 h.
fn normals_unstretched(h: vec3<f32>, view: NormalsView) -> vec3<f32> {
    return vec3(h.xy * view.per_alpha, h.z);
}

fn normals_unit(v: vec3<f32>) -> vec3<f32> {
    let length2 = dot(v, v);
    return v * select(0.0, inverseSqrt(max(length2, 1e-36)), length2 > 1e-36);
}

fn normals_corner(v: vec3<f32>, view: NormalsView) -> NormalsCorner {
    let w = normals_unit(v);
    let c = normals_unstretched(view.wo + w, view);
    let length2 = max(dot(c, c), 1e-36);
    let per_length = inverseSqrt(length2);
    return NormalsCorner(w, c * per_length, length2 * per_length);
}

/// The cosine of half the angle between two corners.
fn normals_half_cosine(a: NormalsCorner, b: NormalsCorner) -> f32 {
    let sum = a.w + b.w;
    return max(0.5 * sqrt(dot(sum, sum)), 1e-6);
}

/// The corner at t of the edge from a to b, by the parameter of its image as a rational curve with unit ends.
fn normals_between(a: NormalsCorner, b: NormalsCorner, t: f32, view: NormalsView) -> NormalsCorner {
    let x = (1.0 - t) * sqrt(b.length);
    let y = t * sqrt(a.length);
    let middle = (a.w + b.w) * (x * y / normals_half_cosine(a, b));
    return normals_corner(a.w * (x * x) + middle + b.w * (y * y), view);
}

/// a x b (acos(a . b) / |a x b| - 1): what the great circle's arc from a to b adds to a x b.
fn normals_arc_bend(a: vec3<f32>, b: vec3<f32>) -> vec3<f32> {
    let across = cross(a, b);
    let is_acute = dot(a, b) >= 0.0;
    let chord = select(a + b, a - b, is_acute);
    let z = dot(chord, chord) * 0.25;
    let far = z * (2.271551 + z * (-3.4068607 + z * 3.5164571));
    let bend = z * (0.66675535 + z * (0.52912637 + z * (0.52405584 + z * (-0.08954556 + far))));
    let obtuse = 3.14159265 / sqrt(max(dot(across, across), 1e-18)) - bend - 2.0;
    return across * select(obtuse, bend, is_acute);
}

/// The eigenframe of a symmetric matrix of Frobenius norm one, by its diagonal and xy, xz, yz. Column i of the matrix
/// belongs to values[i]; they descend.
struct NormalsEigenframe {
    values: vec3<f32>,
    vectors: mat3x3<f32>,
}

fn normals_eigenframe(diagonal: vec3<f32>, off: vec3<f32>) -> NormalsEigenframe {
    let m = mat3x3(diagonal.x, off.x, off.y, off.x, diagonal.y, off.z, off.y, off.z, diagonal.z);
    let mean = (diagonal.x + diagonal.y + diagonal.z) * 0.33333333;
    let d = diagonal - mean;
    let p2 = 0.16666667 - 0.5 * mean * mean;
    let per_p = inverseSqrt(p2);
    let p = p2 * per_p;
    let determinant = d.x * (d.y * d.z - off.z * off.z) - off.x * (off.x * d.z - off.z * off.y) +
        off.y * (off.x * off.z - d.y * off.y);
    let angle = 0.5 * determinant * (per_p * per_p * per_p);
    let x = min(abs(angle), 1.0);
    // cos(acos(x) / 3) by a polynomial and one step of Newton's.
    let near = 0.8660254 + x * (0.1666667 + x * (-0.0425247 + 0.0098286 * x));
    let g = (8.0 * near * near * near + x) / (12.0 * near * near - 3.0);
    let is_largest = !(angle < 0.0);
    let rough = mean + select(-2.0, 2.0, is_largest) * p * g;
    let row0 = vec3(diagonal.x - rough, off.x, off.y);
    let row1 = vec3(off.x, diagonal.y - rough, off.z);
    let row2 = vec3(off.y, off.z, diagonal.z - rough);
    var longest = cross(row0, row1);
    let second = cross(row0, row2);
    let third = cross(row1, row2);
    longest = select(longest, second, dot(second, second) > dot(longest, longest));
    longest = select(longest, third, dot(third, third) > dot(longest, longest));
    let isolated = longest * inverseSqrt(max(dot(longest, longest), 1e-36));
    let value = dot(isolated, m * isolated);
    // One Jacobi rotation in the plane perpendicular to it.
    let s = select(1.0, -1.0, isolated.z < 0.0);
    let q = -1.0 / (s + isolated.z);
    let r = isolated.x * isolated.y * q;
    let e = vec3(1.0 + s * isolated.x * isolated.x * q, s * r, -s * isolated.x);
    let f = vec3(r, s + isolated.y * isolated.y * q, -isolated.y);
    let image_e = m * e;
    let image_f = m * f;
    let ee = dot(e, image_e);
    let ef = dot(e, image_f);
    let ff = dot(f, image_f);
    let middle = 0.5 * (ee + ff);
    let lean = 0.5 * (ee - ff);
    let radius = sqrt(lean * lean + ef * ef);
    // Half of the angle whose cosine is lean / radius: along (radius + |lean|, ef).
    let longer = radius + abs(lean);
    let per_turn = inverseSqrt(max(longer * longer + ef * ef, 1e-36));
    let larger = select(1.0, longer * per_turn, longer > 1e-18);
    let smaller = select(0.0, ef * per_turn, longer > 1e-18);
    let flip = select(1.0, -1.0, ef < 0.0);
    let turn = select(vec2(flip * smaller, flip * larger), vec2(larger, smaller), lean >= 0.0);
    let upper = e * turn.x + f * turn.y;
    let lower = f * turn.x - e * turn.y;
    let one = select(upper, isolated, is_largest);
    let two = select(lower, upper, is_largest);
    let values = select(vec3(middle + radius, middle - radius, value), vec3(value, middle + radius, middle - radius), is_largest);
    return NormalsEigenframe(values, mat3x3(one, two, cross(one, two)));
}

/// The angle of (x, y) from +x, in [-pi, pi].
fn normals_atan2(y: f32, x: f32) -> f32 {
    let upper = ltc_atan2(abs(y), x);
    return select(upper, -upper, y < 0.0);
}

/// The integral of c x dc along the image of an edge from a to b, in the eigenframe of its cone. The edge is on the plane
/// through the point with the normal across, of any length. A short edge does not turn by a tiny angle against its sense,
/// which is a rounding error; a long one may.
fn normals_exact(view: NormalsView, a: vec3<f32>, b: vec3<f32>, across: vec3<f32>, is_long: bool) -> vec3<f32> {
    let turns = select(1.0, -1.0, dot(view.wo, across) < 0.0);
    let n = across * turns;
    let o = view.wo * n;
    let ax = view.alpha.x;
    let ay = view.alpha.y;
    let diagonal = vec3(ax * ax * (o.x - o.y - o.z), ay * ay * (o.y - o.x - o.z), o.z - o.x - o.y);
    let off = vec3(
        ax * ay * (view.wo.x * n.y + view.wo.y * n.x),
        ax * (view.wo.x * n.z + view.wo.z * n.x),
        ay * (view.wo.y * n.z + view.wo.z * n.y),
    );
    let per_norm = inverseSqrt(max(dot(diagonal, diagonal) + 2.0 * dot(off, off), 1e-36));
    let eigen = normals_eigenframe(diagonal * per_norm, off * per_norm);
    let l1 = max(eigen.values.x, 1e-12);
    let l2 = min(eigen.values.y, 0.0);
    let l3 = min(eigen.values.z, l2);
    let v = transpose(eigen.vectors);
    let p0 = v * a;
    let p1 = v * b;
    let normal = v * cross(a, b);
    let d2 = l1 - l2;
    let e2 = l1 - l3;
    let g2 = l2 - l3;
    let d = sqrt(d2);
    let e = sqrt(e2);
    let g = sqrt(g2);
    // The arc runs around the first axis in the sense of the edge; atan2 sees only its ends.
    let sense = select(turns, -turns, p0.x < 0.0);
    let short = normals_atan2(d * e * normal.x, d2 * p0.y * p1.y + e2 * p0.z * p1.z);
    let is_wrapped = short * sense < 0.0 && (abs(short) > 0.01 || is_long);
    let psi = select(short, short + sense * 6.2831853, is_wrapped);
    let along1 = l1 / (d * e) * psi;
    // artanh and arctan by their series where the arguments are small: g may be zero.
    let slope = normal.y / (d2 * p0.x * p1.x - g2 * p0.z * p1.z);
    let q = d * g * slope;
    let q2 = q * q;
    let ratio = clamp((1.0 + q) / (1.0 - q), 1e-30, 1e30);
    let steep = 0.5 * ltc_log(ratio) / max(d * g, 1e-30);
    let along2 = select(steep, slope * (1.0 + q2 * (0.33333333 + q2 * 0.2)), q2 < 0.0025);
    let bottom = e2 * p0.x * p1.x + g2 * p0.y * p1.y;
    let top = e * g * normal.z;
    let is_small = bottom > 0.0 && abs(top) < 0.03 * bottom;
    let per_bottom = 1.0 / bottom;
    let share = select(0.0, top * per_bottom, is_small);
    let r2 = share * share;
    let wide = normals_atan2(top, bottom) / max(e * g, 1e-30);
    let along3 = select(wide, normal.z * per_bottom * (1.0 - r2 * (0.33333333 - r2 * 0.2)), is_small);
    return eigen.vectors * vec3(along1, -l2 * along2, -l3 * along3);
}

/// The direction in which the edge between vertices on either side of the horizon meets it.
fn normals_crossing(a: vec3<f32>, b: vec3<f32>) -> vec3<f32> {
    return vec3(a.xy * abs(b.z) + b.xy * abs(a.z), 0.0);
}

/// G2 / G1, and Schlick's fifth power, for a normal c of any length.
fn normals_weight(view: NormalsView, c: vec3<f32>) -> vec2<f32> {
    let h = vec3(view.alpha * c.xy, c.z);
    let length2 = max(dot(h, h), 1e-36);
    let cosine = dot(view.wo, h);
    let wi = h * (2.0 * cosine) - view.wo * length2;
    let up = max(wi.z, 0.0);
    let across = view.alpha * wi.xy;
    let stretched = sqrt(dot(across, across) + wi.z * wi.z);
    let weight = (view.wo.z + view.length) * up / max(view.length * up + view.wo.z * stretched, 1e-36);
    let m = clamp(1.0 - cosine * inverseSqrt(length2), 0.0, 1.0);
    let m2 = m * m;
    return vec2(weight, m2 * m2 * m);
}

/// The mean over a triangle of a weight that is tip at its tip, zero on its outer edge, which is on the horizon, and near
/// close to it: of tip (1 - s) / (1 - s + r s), r = rate (tip / near - 1), by a polynomial in sqrt r / (1 + sqrt r).
fn normals_to_horizon(tip: f32, near: f32, rate: f32) -> f32 {
    let root = sqrt(rate * near * max(tip - near, 0.0));
    let rest = near / max(near + root, 1e-36);
    let u = 1.0 - rest;
    let series = 2.0 + u * (-7.4062647 + u * (21.070869 + u * (-31.448433 + u * 16.743261)));
    return tip * rest * rest * (1.0 + u * series);
}

/// The direction of a triangle's centroid, by the integral of its normals.
fn normals_centroid(flux: vec3<f32>, tip: vec3<f32>) -> vec3<f32> {
    let m = normals_unit(flux);
    return select(m, -m, dot(m, tip) < 0.0);
}

/// A normal in a mean: what is seen of it (x), that times its weight, and that times Schlick's factor.
fn normals_sample(view: NormalsView, c: vec3<f32>) -> vec3<f32> {
    let at = normals_weight(view, c);
    let seen = max(dot(c, view.stretched), 0.0);
    return vec3(seen, seen * at.x, seen * at.x * at.y);
}

/// What a triangle reflects, by its centroid, a normal beyond it and what its corners add to the mean. On the horizon, by
/// a normal near its outer edge and at_tip, the weight of its tip.
fn normals_triangle(
    view: NormalsView,
    tip: vec3<f32>,
    at_tip: vec2<f32>,
    corners: vec3<f32>,
    flux: vec3<f32>,
    on_horizon: bool,
    is_fine: bool,
) -> vec2<f32> {
    let m = normals_centroid(flux, tip);
    let outer = m + select(0.5, 0.3, on_horizon) * (m - tip);
    let at_outer = normals_weight(view, outer);
    let energy = normals_to_horizon(at_tip.x, at_outer.x, select(0.155, 0.145, is_fine));
    let horizon = vec2(energy, energy * mix(at_outer.y, at_tip.y, 0.25));
    let seen = select(0.3, 0.2, is_fine) * max(dot(outer, view.stretched), 0.0);
    let sum = normals_sample(view, m) + seen * vec3(1.0, at_outer.x, at_outer.x * at_outer.y) + corners;
    return dot(flux, view.stretched) * select(sum.yz / max(sum.x, 1e-18), horizon, on_horizon);
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

/// What of a polygon's outline is above the surface.
fn normals_outline(vertices: ptr<function, array<vec3<f32>, 8>>, number: u32) -> NormalsOutline {
    var outline = NormalsOutline(number, 0u, false, 0u, 0.0, number > 4u);
    var before = normals_get(vertices, number - 1u, outline.many).z > 0.0;
    var above = 0.0;
    var below = 0.0;
    for (var i = 0u; i < number; i++) {
        let z = normals_get(vertices, i, outline.many).z;
        let is_up = z > 0.0;
        above = max(above, z);
        below = max(below, -z);
        if (is_up && !before) {
            outline.start = i;
            outline.is_cut = true;
        }
        outline.ups += select(0u, 1u, is_up);
        before = is_up;
    }
    outline.share = min(8.0 * below / max(above, 1e-36), 1.0);
    return outline;
}

/// Corner i of an outline. A cut one begins and ends on the horizon; another begins and ends at vertex 0.
fn normals_outline_corner(
    view: NormalsView,
    outline: NormalsOutline,
    vertices: ptr<function, array<vec3<f32>, 8>>,
    i: u32,
) -> NormalsCorner {
    let is_crossing = outline.is_cut && (i == 0u || i == outline.ups + 1u);
    let at = outline.start + i - select(0u, 1u, outline.is_cut && i > 0u);
    let before = select(at - 1u, outline.number - 1u, at == 0u);
    let v = normals_get(vertices, select(at, at - outline.number, at >= outline.number), outline.many);
    let u = normals_get(vertices, select(before, before - outline.number, before >= outline.number), outline.many);
    return normals_corner(select(v, normals_crossing(u, v), is_crossing), view);
}

/// The arc along the horizon that closes an outline which is cut.
fn normals_horizon(view: NormalsView, begin: NormalsCorner, end: NormalsCorner) -> NormalsHorizon {
    let sum = begin.w + end.w;
    let half = normals_half_cosine(begin, end);
    let control = normals_unstretched(view.wo * half + sum * (0.5 / half), view);
    let turn = cross(begin.w, end.w - begin.w).z;
    let across = vec3(0.0, 0.0, select(1.0, -1.0, turn < 0.0));
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
    let horizon_parts = select(select(4u, 8u, is_fine), 1u, rule == NORMALS_MEAN);
    let edges = select(outline.number, outline.ups + 1u, outline.is_cut);
    let closing_parts = select(0u, horizon_parts, outline.is_cut);
    let first = normals_outline_corner(view, outline, vertices, 0u);
    let horizon = normals_horizon(view, normals_outline_corner(view, outline, vertices, outline.ups + 1u), first);

    // One loop over all parts of all edges: this is the one place where an edge is integrated, which is much code. For
    // each edge, where it ends and what it adds to the integral beyond the plane triangle; the same for its first half.
    var ends: array<vec3<f32>, 8>;
    var curves: array<vec3<f32>, 8>;
    var half_ends: array<vec3<f32>, 8>;
    var half_curves: array<vec3<f32>, 8>;
    var horizon_curves: array<vec3<f32>, 8>;
    // What the arc along the horizon, or its second half, and its first half add, and its middle.
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
        let is_edge = is_closing || dot(apart, apart) >= 1e-14;
        let curved = select(vec3(0.0), exact - cross(last.c, c), is_edge);
        flux += curved + cross(last.c - first.c, c - first.c);
        if (is_fine) {
            normals_put(&half_ends, select(8u, edge, is_half), c, many);
            normals_put(&half_curves, select(8u, edge, is_half), curved, many);
        }
        normals_put(&ends, select(edge, 8u, is_half || is_closing), c, many);
        normals_put(&curves, select(edge, 8u, is_half || is_closing), curved, many);
        normals_put(&horizon_curves, select(8u, edge - edges, is_closing), curved, is_fine);
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
        // The horizon comes twice: as an edge like the others, which it is where it only touches the light, so that
        // nothing jumps where an edge sets; and in parts.
        parts = vec2(0.0);
        var from_c = first.c;
        var from_bend = normals_arc_bend(tip, from_c);
        var begin_bend = from_bend;
        let tip_share = select(0.2, 0.1, is_fine) * normals_sample(view, tip);
        let share = select(0.08, 0.04, is_fine);
        var from_share = share * normals_sample(view, from_c);
        for (var i = 0u; i < edges + select(0u, horizon_parts + 1u, outline.is_cut); i++) {
            let is_whole = i == edges;
            let on_horizon = i > edges;
            if (is_whole) {
                begin_bend = from_bend;
            }
            if (i == edges + 1u) {
                from_c = horizon.begin;
                from_bend = begin_bend;
            }
            let counts = select(select(1.0, 1.0 - outline.share, is_whole), outline.share, on_horizon);
            if (is_fine && !on_horizon) {
                let half_c = select(normals_get(&half_ends, i, many), half_end, is_whole);
                let half_curved = select(normals_get(&half_curves, i, many), half_closing, is_whole);
                let half_bend = normals_arc_bend(tip, half_c);
                let half_flux = cross(from_c - tip, half_c - tip) + half_curved + (from_bend - half_bend);
                let half_share = share * normals_sample(view, half_c);
                let half_corners = tip_share + from_share + half_share;
                parts += counts * normals_triangle(view, tip, at_tip, half_corners, half_flux, false, is_fine);
                from_c = half_c;
                from_bend = half_bend;
                from_share = half_share;
            }
            let part = i - edges;
            let part_c = normals_on_horizon(horizon, f32(part) / f32(horizon_parts));
            let part_curved = normals_get(&horizon_curves, part - 1u, is_fine);
            let to_c = select(select(normals_get(&ends, i, many), first.c, is_whole), part_c, on_horizon);
            let curved = select(select(normals_get(&curves, i, many), closing, is_whole), part_curved, on_horizon);
            let to_bend = normals_arc_bend(tip, to_c);
            let part_flux = cross(from_c - tip, to_c - tip) + curved + (from_bend - to_bend);
            let to_share = share * normals_sample(view, to_c);
            let part_corners = tip_share + from_share + to_share;
            parts += counts * normals_triangle(view, tip, at_tip, part_corners, part_flux, on_horizon, is_fine);
            from_c = to_c;
            from_bend = to_bend;
            from_share = to_share;
        }
    }
    // No weight is above one, though triangles that lie upon each other may say so.
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
