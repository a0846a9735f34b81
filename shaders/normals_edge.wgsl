// The exact integral along the images of a light's edges among the visible normals of GGX. Needs ltc_math.wgsl and
// normals_corner.wgsl.
//
// Two edges are integrated at a time, component by component in vec2. One integral is a chain of operations that wait for
// each other; two of them side by side take less than twice as long.

/// Two vectors: the first has the components x.x, y.x and z.x.
struct NormalsPair {
    x: vec2<f32>,
    y: vec2<f32>,
    z: vec2<f32>,
}

fn normals_pair(first: vec3<f32>, second: vec3<f32>) -> NormalsPair {
    return NormalsPair(vec2(first.x, second.x), vec2(first.y, second.y), vec2(first.z, second.z));
}

fn normals_pair_dot(a: NormalsPair, b: NormalsPair) -> vec2<f32> {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

fn normals_pair_cross(a: NormalsPair, b: NormalsPair) -> NormalsPair {
    return NormalsPair(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
}

fn normals_pair_scaled(a: NormalsPair, by: vec2<f32>) -> NormalsPair {
    return NormalsPair(a.x * by, a.y * by, a.z * by);
}

fn normals_pair_plus(a: NormalsPair, b: NormalsPair) -> NormalsPair {
    return NormalsPair(a.x + b.x, a.y + b.y, a.z + b.z);
}

fn normals_pair_minus(a: NormalsPair, b: NormalsPair) -> NormalsPair {
    return NormalsPair(a.x - b.x, a.y - b.y, a.z - b.z);
}

/// A v with A = diag(alpha, 1).
fn normals_pair_stretched(v: NormalsPair, view: NormalsView) -> NormalsPair {
    return NormalsPair(view.alpha.x * v.x, view.alpha.y * v.y, v.z);
}

/// An angle in [0, pi / 2] over its sine, by its cosine: a polynomial that is 1e-7 off at most.
fn normals_per_sine(cosine: vec2<f32>) -> vec2<f32> {
    let x2 = cosine * cosine;
    let low = 1.5707962 - 0.99998414 * cosine + x2 * (0.78493574 - 0.6614053 * cosine);
    let high = 0.55826277 - 0.42721283 * cosine + x2 * (0.2563661 - 0.09989328 * cosine);
    return low + x2 * x2 * (high + x2 * x2 * 0.018134789);
}

/// A hyperbolic angle over its sine, by its cosine less one.
fn normals_per_hyperbolic_sine(u: vec2<f32>) -> vec2<f32> {
    let sine = sqrt(u * (u + 2.0));
    let e = 1.0 + u + sine;
    let far = vec2(ltc_log(e.x), ltc_log(e.y)) / max(sine, vec2(1e-30));
    return select(far, 1.0 + u * (-0.33333333 + u * (0.13333333 - 0.057142857 * u)), u < vec2(0.02));
}

/// A cone of normals c^T K c = 0, K = A (wo n^T + n wo^T - (wo . n) I) A, by the eigenvalues first > 0 >= second >= third of K.
struct NormalsCone {
    /// wo . n.
    towards: vec2<f32>,
    /// n . n.
    normal2: vec2<f32>,
    first: vec2<f32>,
    /// The other two with the sign turned.
    second: vec2<f32>,
    third: vec2<f32>,
}

/// The cone of the edge on the plane with the normal n, of any length, whose towards is not negative.
///
/// The eigenvalue farthest from the others is that of Smith's formula, and its quotients with K's minors and determinant are
/// the others: all terms have forms in which small ones do not vanish in large ones.
fn normals_cone(view: NormalsView, n: NormalsPair, towards: vec2<f32>) -> NormalsCone {
    let wo = view.wo;
    let normal2 = normals_pair_dot(n, n);
    let squares = view.alpha * view.alpha;
    // Diagonal and principal minors of wo n^T + n wo^T - (wo . n) I.
    let diagonal = NormalsPair(2.0 * wo.x * n.x - towards, 2.0 * wo.y * n.y - towards, 2.0 * wo.z * n.z - towards);
    let across = NormalsPair(wo.y * n.z - wo.z * n.y, wo.z * n.x - wo.x * n.z, wo.x * n.y - wo.y * n.x);
    let minors = NormalsPair(
        towards * diagonal.x - across.x * across.x,
        towards * diagonal.y - across.y * across.y,
        towards * diagonal.z - across.z * across.z,
    );
    let trace = squares.x * diagonal.x + squares.y * diagonal.y + diagonal.z;
    let minor = squares.y * minors.x + squares.x * (minors.y + squares.y * minors.z);
    let determinant = squares.x * squares.y * (towards * normal2);

    let mean = trace * 0.33333333;
    let spread2 = max(mean * mean - minor * 0.33333333, vec2(1e-36));
    let per_spread = inverseSqrt(spread2);
    let cosine = (mean * (mean * mean - 0.5 * minor) + 0.5 * determinant) * per_spread * per_spread * per_spread;
    // cos(acos(x) / 3).
    let x = min(abs(cosine), vec2(1.0));
    let x2 = x * x;
    let third = 0.86602547 + x * 0.16665926 + x2 * (-0.047981778 + x * 0.023804546) +
        x2 * x2 * (-0.012577177 + x * 0.0051134448 - x2 * 0.0010438402);
    let is_first = cosine >= vec2(0.0);
    let rough = mean + select(vec2(-2.0), vec2(2.0), is_first) * (spread2 * per_spread) * third;
    // Sum and product of the other two; where it is small beside them, it is itself the determinant over their product.
    let is_small = is_first & (trace < -rough);
    let sum_beside = trace - rough;
    let product_beside = minor - rough * sum_beside;
    let per_divisor = 1.0 / select(rough, product_beside, is_small);
    let quotient = determinant * per_divisor;
    let isolated = select(rough, quotient, is_small);
    let product = select(quotient, product_beside, is_small);
    let sum = select((minor - quotient) * per_divisor, sum_beside, is_small);
    let radius = sqrt(max(0.25 * sum * sum - product, vec2(0.0)));
    let is_above = !is_first & (sum >= vec2(0.0));
    let larger = 0.5 * sum + select(-radius, radius, is_above);
    let smaller = product / select(larger, vec2(-1e-30), larger == vec2(0.0));
    let upper = select(smaller, larger, is_above);
    let lower = select(larger, smaller, is_above);
    let first = max(select(upper, isolated, is_first), vec2(1e-18));
    let second = max(-select(lower, smaller, is_first), vec2(0.0));
    return NormalsCone(towards, normal2, first, second, max(-select(isolated, larger, is_first), max(second, vec2(1e-30))));
}

/// The vector of a cone's first eigenvalue, of any length: A E (wo (n . E n) + n (1 - wo . E n)), E = A^2 / (towards A^2 + first).
fn normals_cone_axis(view: NormalsView, n: NormalsPair, cone: NormalsCone) -> NormalsPair {
    let wo = view.wo;
    let sum = cone.towards + cone.first;
    let sum_x = cone.towards * view.alpha.x * view.alpha.x + cone.first;
    let sum_y = cone.towards * view.alpha.y * view.alpha.y + cone.first;
    let per_sum = sum / (sum_x * sum_y);
    let x = view.alpha.x * sum_y * per_sum;
    let y = view.alpha.y * sum_x * per_sum;
    let weighted = NormalsPair(view.alpha.x * x * n.x, view.alpha.y * y * n.y, n.z);
    let of_wo = normals_pair_dot(weighted, n);
    let of_n = sum - (weighted.x * wo.x + weighted.y * wo.y + weighted.z * wo.z);
    return NormalsPair(x * (wo.x * of_wo + n.x * of_n), y * (wo.y * of_wo + n.y * of_n), wo.z * of_wo + n.z * of_n);
}

/// What the images of the edges from a0 to b0 and from a1 to b1 add to the integral of c x dc beyond the plane triangles'
/// a.c x b.c.
///
/// The integral is psi(M) (a.c x b.c) with M = a.c . b.c I - (a.c . K b.c) K^-1 and psi(x) = acos(x) / sqrt(1 - x^2), which for
/// x > 1 is the same of hyperbolic functions. Along the first axis the arc may take more than half of the turn.
fn normals_curved(
    view: NormalsView,
    a0: NormalsCorner,
    b0: NormalsCorner,
    a1: NormalsCorner,
    b1: NormalsCorner,
) -> mat2x3<f32> {
    let wo = view.wo;
    let a = normals_pair(a0.c, a1.c);
    let b = normals_pair(b0.c, b1.c);
    let apart = normals_pair(b0.w - a0.w, b1.w - a1.w);
    let apart2 = normals_pair_dot(apart, apart);
    // Not a x b, whose rounding errors are as large as those of a and b themselves.
    let across = normals_pair_cross(normals_pair(a0.w, a1.w), apart);
    let towards = wo.x * across.x + wo.y * across.y + wo.z * across.z;
    let turns = select(vec2(1.0), vec2(-1.0), towards < vec2(0.0));
    let n = normals_pair_scaled(across, turns);
    let cone = normals_cone(view, n, towards * turns);
    let axis = normals_cone_axis(view, n, cone);
    let per_axis2 = 1.0 / max(normals_pair_dot(axis, axis), vec2(1e-36));

    // What of a x b is along each axis.
    let normal = normals_pair_cross(a, b);
    let on_axis = normals_pair_dot(axis, normal);
    let rest = normals_pair_minus(normal, normals_pair_scaled(axis, on_axis * per_axis2));
    let h = normals_pair_stretched(rest, view);
    let by_wo = normals_pair_dot(n, h);
    let by_n = wo.x * h.x + wo.y * h.y + wo.z * h.z;
    let image = normals_pair_stretched(
        NormalsPair(
            wo.x * by_wo + n.x * by_n - cone.towards * h.x,
            wo.y * by_wo + n.y * by_n - cone.towards * h.y,
            wo.z * by_wo + n.z * by_n - cone.towards * h.z,
        ),
        view,
    );
    let shifted = normals_pair_plus(image, normals_pair_scaled(rest, cone.second));
    let level = normals_pair_minus(shifted, normals_pair_scaled(axis, normals_pair_dot(shifted, axis) * per_axis2));
    let gap = max(cone.third - cone.second, 1e-6 * cone.third);
    let on_third = normals_pair_scaled(level, -1.0 / gap);
    let on_second = normals_pair_minus(rest, on_third);

    // The eigenvalues of M, of which the second is one at least.
    let lengths = vec2(a0.length * b0.length, a1.length * b1.length);
    let squares = view.alpha.x * view.alpha.x * view.alpha.y * view.alpha.y;
    let bend = 0.5 * apart2 / max(lengths * cone.normal2 * squares, vec2(1e-36));
    let ends = normals_pair_dot(a, b);
    let first = ends - bend * (cone.second * cone.third);
    let second = ends + bend * (cone.first * cone.third);
    let third = ends + bend * (cone.first * cone.second);

    // The sense of the turn around the first axis is that of the edge. A short edge does not turn by a tiny angle against it,
    // which is a rounding error; a long one may.
    let turn = cone.first * inverseSqrt((cone.first + cone.second) * (cone.first + cone.third));
    let per_axis = sqrt(per_axis2);
    let beside = on_axis * per_axis;
    let is_far = (apart2 > vec2(0.2)) | (abs(beside) > 0.01 * turn);
    let is_wrapped = (beside * turns < vec2(0.0)) & is_far;
    let is_obtuse = first < vec2(0.0);
    let begun = select(select(vec2(0.0), vec2(6.2831853), is_wrapped), vec2(3.1415927), is_obtuse);
    let acute = normals_per_sine(min(abs(first), vec2(1.0)));
    let along_first = (begun * turns * turn + select(acute, -acute, is_obtuse) * beside) * per_axis;
    let along_second = normals_per_hyperbolic_sine(max(second - 1.0, vec2(0.0)));
    let sharp = normals_per_sine(min(abs(third), vec2(1.0)));
    let sine2 = (cone.first + cone.third) * gap * normals_pair_dot(on_third, on_third);
    let blunt = 3.1415927 * cone.third * inverseSqrt(max(sine2, vec2(1e-36))) - sharp;
    let along_third = select(sharp, blunt, third < vec2(0.0));

    let whole = normals_pair_plus(
        normals_pair_scaled(axis, along_first),
        normals_pair_plus(normals_pair_scaled(on_second, along_second), normals_pair_scaled(on_third, along_third)),
    );
    let curved = normals_pair_minus(whole, normal);
    let is_edge = apart2 >= vec2(1e-14);
    return mat2x3(
        select(vec3(0.0), vec3(curved.x.x, curved.y.x, curved.z.x), is_edge.x),
        select(vec3(0.0), vec3(curved.x.y, curved.y.y, curved.z.y), is_edge.y),
    );
}
