// The light of a polygon on GGX in closed form, without a table: the integral of the visible normals that reflect it,
// exact, and the mean of the weight of shadowing. Needs ltc_math.wgsl.
//
// Vertices are given relative to the shaded point in its tangent frame, normal +z. The lit side is the one from which
// they run clockwise. The outline has to be convex; a disk is lit as a polygon of its area.

/// How the weight is averaged: seven normals a triangle; the weight of the mean normal; seven, edges split in two.
const NORMALS_SEVEN: u32 = 0u;
const NORMALS_MEAN: u32 = 1u;
const NORMALS_FINE: u32 = 2u;

/// Most edges after the cut at the horizon and all splits.
const NORMALS_EDGES: u32 = 20u;

/// A surface seen from a direction.
struct NormalsView {
    alpha: vec2<f32>,
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

/// The image of an outline while it is added up edge by edge.
struct NormalsOutline {
    count: u32,
    first: NormalsCorner,
    last: NormalsCorner,
    /// Twice pi times the integral of the normals.
    flux: vec3<f32>,
    /// The corner where an edge begins, and what the edge adds to the integral beyond the plane triangle.
    c: array<vec3<f32>, 20>,
    curved: array<vec3<f32>, 20>,
}

/// alpha in (0, 1]; wo of unit length in the tangent frame.
fn normals_view(alpha_x: f32, alpha_y: f32, wo: vec3<f32>) -> NormalsView {
    let alpha = max(vec2(alpha_x, alpha_y), vec2(1e-5));
    let stretched = vec3(alpha * wo.xy, wo.z);
    return NormalsView(alpha, wo, stretched, sqrt(dot(stretched, stretched)));
}

fn normals_unstretched(h: vec3<f32>, alpha: vec2<f32>) -> vec3<f32> {
    return vec3(h.xy / alpha, h.z);
}

fn normals_unit(v: vec3<f32>) -> vec3<f32> {
    let length2 = dot(v, v);
    return select(vec3(0.0), v / sqrt(max(length2, 1e-36)), length2 > 1e-36);
}

fn normals_corner(v: vec3<f32>, view: NormalsView) -> NormalsCorner {
    let w = normals_unit(v);
    let c = normals_unstretched(view.wo + w, view.alpha);
    let length = max(sqrt(dot(c, c)), 1e-18);
    return NormalsCorner(w, c / length, length);
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
    let mean = (diagonal.x + diagonal.y + diagonal.z) / 3.0;
    let d = diagonal - mean;
    let p2 = max((dot(d, d) + 2.0 * dot(off, off)) / 6.0, 1e-30);
    let p = sqrt(p2);
    let determinant = d.x * (d.y * d.z - off.z * off.z) - off.x * (off.x * d.z - off.z * off.y) +
        off.y * (off.x * off.z - d.y * off.y);
    let angle = determinant / (2.0 * p * p2);
    let x = min(abs(angle), 1.0);
    // cos(acos(x) / 3) by a polynomial and one step of Newton's.
    let near = 0.8660254 + x * (0.1666667 + x * (-0.0425207 + 0.0098286 * x));
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
    let isolated = longest / sqrt(max(dot(longest, longest), 1e-36));
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
    let doubled = select(1.0, lean / max(radius, 1e-30), radius > 1e-30);
    let larger = sqrt(0.5 + 0.5 * abs(doubled));
    let smaller = 0.5 * ef / (max(radius, 1e-30) * larger);
    let flip = select(1.0, -1.0, ef < 0.0);
    let turn = select(vec2(flip * smaller, flip * larger), vec2(larger, smaller), doubled >= 0.0);
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

/// The integral of c x dc along an edge's image, in the eigenframe of its cone. b.w - a.w is apart.
fn normals_exact(view: NormalsView, a: NormalsCorner, b: NormalsCorner, apart: vec3<f32>) -> vec3<f32> {
    let across = cross(a.w, apart);
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
    let per_norm = 1.0 / max(sqrt(dot(diagonal, diagonal) + 2.0 * dot(off, off)), 1e-30);
    let eigen = normals_eigenframe(diagonal * per_norm, off * per_norm);
    let l1 = max(eigen.values.x, 1e-12);
    let l2 = min(eigen.values.y, 0.0);
    let l3 = min(eigen.values.z, l2);
    let v = transpose(eigen.vectors);
    let p0 = v * a.c;
    let p1 = v * b.c;
    let normal = v * cross(a.c, b.c);
    let d2 = l1 - l2;
    let e2 = l1 - l3;
    let g2 = l2 - l3;
    let d = sqrt(d2);
    let e = sqrt(e2);
    let g = sqrt(g2);
    // The arc runs around the first axis in the sense of the edge; atan2 sees only its ends.
    let sense = select(turns, -turns, p0.x < 0.0);
    let short = normals_atan2(d * e * normal.x, d2 * p0.y * p1.y + e2 * p0.z * p1.z);
    let is_wrapped = short * sense < 0.0 && (abs(short) > 0.01 || dot(a.w, b.w) < 0.9);
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
    let share = select(0.0, top / bottom, is_small);
    let r2 = share * share;
    let wide = normals_atan2(top, bottom) / max(e * g, 1e-30);
    let along3 = select(wide, normal.z / bottom * (1.0 - r2 * (0.33333333 - r2 * 0.2)), is_small);
    return eigen.vectors * vec3(along1, -l2 * along2, -l3 * along3);
}

/// What the edge from a to b adds to the integral of c x dc, beyond a.c x b.c.
fn normals_curved_part(view: NormalsView, a: NormalsCorner, b: NormalsCorner) -> vec3<f32> {
    let apart = b.w - a.w;
    return select(vec3(0.0), normals_exact(view, a, b, apart) - cross(a.c, b.c), dot(apart, apart) >= 1e-14);
}

/// Adds the edge from the last corner to another.
fn normals_edge(outline: ptr<function, NormalsOutline>, view: NormalsView, to: NormalsCorner) {
    let origin = (*outline).first.c;
    let last = (*outline).last;
    let curved = normals_curved_part(view, last, to);
    (*outline).flux += curved + cross(last.c - origin, to.c - origin);
    (*outline).c[(*outline).count] = last.c;
    (*outline).curved[(*outline).count] = curved;
    (*outline).count += 1u;
    (*outline).last = to;
}

/// The direction in which the edge between vertices on either side of the horizon meets it.
fn normals_crossing(a: vec3<f32>, b: vec3<f32>) -> vec3<f32> {
    return vec3(a.xy * abs(b.z) + b.xy * abs(a.z), 0.0);
}

/// G2 / G1, and the same times Schlick's fifth power, for a normal c of any length; z: the part of c that is seen.
fn normals_weight(view: NormalsView, c: vec3<f32>) -> vec3<f32> {
    let h = vec3(view.alpha * c.xy, c.z);
    let length2 = max(dot(h, h), 1e-36);
    let cosine = dot(view.wo, h);
    let wi = h * (2.0 * cosine) - view.wo * length2;
    let up = max(wi.z, 0.0);
    let across = view.alpha * wi.xy;
    let stretched = sqrt(dot(across, across) + wi.z * wi.z);
    let weight = (view.wo.z + view.length) * up / max(view.length * up + view.wo.z * stretched, 1e-36);
    let m = clamp(1.0 - cosine / sqrt(length2), 0.0, 1.0);
    let m2 = m * m;
    let seen = max(dot(c, view.stretched) / max(sqrt(dot(c, c)), 1e-18), 0.0);
    return vec3(weight, weight * (m2 * m2 * m), seen);
}

/// x: what of a normal is seen. yz: the same times its weights.
fn normals_sample(view: NormalsView, c: vec3<f32>) -> vec3<f32> {
    let weight = normals_weight(view, c);
    return vec3(weight.z, weight.z * weight.xy);
}

/// The sum over the triangles between the mean normal and each edge's image: its exact part of the visible normals times
/// the mean of their weights at corners, middles and centroid.
fn normals_fan(view: NormalsView, outline: ptr<function, NormalsOutline>, tip: vec3<f32>) -> vec2<f32> {
    let at_tip = normals_sample(view, tip);
    var from_c = (*outline).c[0];
    var from_sample = normals_sample(view, from_c);
    var from_bend = normals_arc_bend(tip, from_c);
    var sum = vec2(0.0);
    for (var i = 0u; i < (*outline).count; i++) {
        let next = select(i + 1u, 0u, i + 1u == (*outline).count);
        let to_c = (*outline).c[next];
        let to_sample = normals_sample(view, to_c);
        let to_bend = normals_arc_bend(tip, to_c);
        let flux = cross(from_c - tip, to_c - tip) + (*outline).curved[i] + (from_bend - to_bend);
        let unsigned = normals_unit(flux);
        let m = select(unsigned, -unsigned, dot(unsigned, tip) < 0.0);
        let middles = normals_sample(view, 1.5 * m - 0.5 * tip) + normals_sample(view, 1.5 * m - 0.5 * from_c) +
            normals_sample(view, 1.5 * m - 0.5 * to_c);
        let mean = 0.28 * normals_sample(view, m) + 0.04 * (at_tip + from_sample + to_sample) + 0.2 * middles;
        if (mean.x > 1e-18) {
            sum += mean.yz * (dot(flux, view.stretched) / mean.x);
        }
        from_c = to_c;
        from_sample = to_sample;
        from_bend = to_bend;
    }
    return sum;
}

/// What is reflected of a convex polygon of 3 to 8 vertices of radiance one: for a Fresnel factor of one (x), and its part
/// weighed by Schlick's (1 - wo . h)^5 (y). Light of radiance L: L (f0 (x - y) + f90 y).
fn normals_polygon(
    view: NormalsView,
    vertices: ptr<function, array<vec3<f32>, 8>>,
    count: u32,
    two_sided: bool,
    rule: u32,
) -> vec2<f32> {
    let number = clamp(count, 3u, 8u);
    let edge_parts = select(1u, 2u, rule == NORMALS_FINE);
    let horizon_parts = select(select(2u, 4u, rule == NORMALS_FINE), 1u, rule == NORMALS_MEAN);
    // Begin where the outline rises above the surface, or at any vertex of one that is above it.
    var start = 0u;
    var is_cut = false;
    var ups = 0u;
    var before = (*vertices)[number - 1u].z > 0.0;
    for (var i = 0u; i < number; i++) {
        let is_up = (*vertices)[i].z > 0.0;
        if (is_up && !before) {
            start = i;
            is_cut = true;
        }
        ups += select(0u, 1u, is_up);
        before = is_up;
    }
    if (ups == 0u) {
        return vec2(0.0);
    }
    var outline: NormalsOutline;
    var corner = (*vertices)[start];
    if (is_cut) {
        corner = normals_crossing((*vertices)[(start + number - 1u) % number], corner);
    }
    outline.first = normals_corner(corner, view);
    outline.last = outline.first;
    // One loop over all parts of all edges: this is the one place where an edge is integrated, which is much code.
    let skipped = select(1u, 0u, is_cut);
    let edges = ups + 1u - 2u * skipped;
    let closing_parts = select(edge_parts, horizon_parts, is_cut);
    var from_corner = outline.first;
    var to_corner = outline.first;
    var part = 0u;
    for (var step = 0u; step < edges * edge_parts + closing_parts; step++) {
        let edge = step / edge_parts;
        let is_closing = edge >= edges;
        if (part == 0u) {
            var vertex = (*vertices)[(start + skipped + edge) % number];
            if (is_cut && edge == ups) {
                vertex = normals_crossing((*vertices)[(start + ups - 1u) % number], vertex);
            }
            from_corner = outline.last;
            to_corner = normals_corner(vertex, view);
            if (is_closing) {
                to_corner = outline.first;
            }
        }
        part += 1u;
        let parts = select(edge_parts, closing_parts, is_closing);
        var to = to_corner;
        if (part < parts) {
            to = normals_between(from_corner, to_corner, f32(part) / f32(parts), view);
        } else {
            part = 0u;
        }
        normals_edge(&outline, view, to);
    }

    let seen = dot(outline.flux, view.stretched);
    let side = select(1.0, -1.0, seen < 0.0);
    if (side < 0.0 && !two_sided) {
        return vec2(0.0);
    }
    let to_part = side * 0.31830989 / (view.wo.z + view.length);
    let mean_normal = normals_unit(outline.flux * side);
    var parts: vec2<f32>;
    if (rule == NORMALS_MEAN) {
        parts = normals_weight(view, mean_normal).xy * (to_part * seen);
    } else {
        parts = normals_fan(view, &outline, mean_normal) * to_part;
    }
    let energy = clamp(parts.x, 0.0, 1.0);
    return vec2(energy, clamp(parts.y, 0.0, energy));
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
