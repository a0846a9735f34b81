// The visible normals of GGX that reflect an edge of a light: its image among them, and the exact integral along it.
// Needs ltc_math.wgsl.

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

/// What each of two parts, from a to m and from m to b, adds beyond its plane triangle, of the image of an edge whose whole is
/// known: the great circle's arc, and of what the arcs leave a share by the cube of the chord. The shares decide only which
/// part has which weight.
fn normals_shared(a: vec3<f32>, m: vec3<f32>, b: vec3<f32>, whole: vec3<f32>) -> mat2x3<f32> {
    let arc = normals_arc_bend(a, m);
    let next = normals_arc_bend(m, b);
    let rest = whole - cross(m - a, b - a) - arc - next;
    let length2 = vec2(dot(m - a, m - a), dot(b - m, b - m));
    let cubes = length2 * sqrt(length2);
    let shares = cubes / max(cubes.x + cubes.y, 1e-36);
    return mat2x3(arc + rest * shares.x, next + rest * shares.y);
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
