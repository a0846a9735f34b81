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

/// A cone of normals c^T K c = 0, K = A (wo n^T + n wo^T - (wo . n) I) A, by the eigenvalues l1 > 0 >= -p >= -q of K.
struct NormalsCone {
    /// wo . n.
    k: vec2<f32>,
    /// n . n.
    n2: vec2<f32>,
    l1: vec2<f32>,
    p: vec2<f32>,
    q: vec2<f32>,
}

/// The cone of the edge on the plane with the normal n, of any length, where k = wo . n is not negative.
///
/// The eigenvalue that is farthest from the others comes from Smith's formula. The product of the others is K's determinant over
/// it, and their sum comes from K's minors: so they keep their digits where they are small beside it.
fn normals_cone(view: NormalsView, n: NormalsPair, k: vec2<f32>) -> NormalsCone {
    let wo = view.wo;
    let n2 = normals_pair_dot(n, n);
    let squares = view.alpha * view.alpha;
    // Diagonal and principal minors of wo n^T + n wo^T - (wo . n) I.
    let diagonal = NormalsPair(2.0 * wo.x * n.x - k, 2.0 * wo.y * n.y - k, 2.0 * wo.z * n.z - k);
    let across = NormalsPair(wo.y * n.z - wo.z * n.y, wo.z * n.x - wo.x * n.z, wo.x * n.y - wo.y * n.x);
    let minors = NormalsPair(
        k * diagonal.x - across.x * across.x,
        k * diagonal.y - across.y * across.y,
        k * diagonal.z - across.z * across.z,
    );
    let trace = squares.x * diagonal.x + squares.y * diagonal.y + diagonal.z;
    let minor = squares.y * minors.x + squares.x * (minors.y + squares.y * minors.z);
    let determinant = squares.x * squares.y * (k * n2);

    let mean = trace * 0.33333333;
    let spread2 = max(mean * mean - minor * 0.33333333, vec2(1e-36));
    let per_spread = inverseSqrt(spread2);
    let cosine = (mean * (mean * mean - 0.5 * minor) + 0.5 * determinant) * per_spread * per_spread * per_spread;
    // cos(acos(x) / 3).
    let x = min(abs(cosine), vec2(1.0));
    let x2 = x * x;
    let of_third = 0.86602547 + x * 0.16665926 + x2 * (-0.047981778 + x * 0.023804546) +
        x2 * x2 * (-0.012577177 + x * 0.0051134448 - x2 * 0.0010438402);
    let is_first = cosine >= vec2(0.0);
    let rough = mean + select(vec2(-2.0), vec2(2.0), is_first) * (spread2 * per_spread) * of_third;
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
    let l1 = max(select(upper, isolated, is_first), vec2(1e-18));
    let p = max(-select(lower, smaller, is_first), vec2(0.0));
    let q = max(-select(isolated, larger, is_first), max(p, vec2(1e-30)));
    return NormalsCone(k, n2, l1, p, q);
}

/// The vector of a cone's first eigenvalue, of any length: A^-1 W (wo (n . W n) + n (1 - wo . W n)), W = A^2 / (k A^2 + l1).
fn normals_cone_axis(view: NormalsView, n: NormalsPair, cone: NormalsCone) -> NormalsPair {
    let wo = view.wo;
    let sum = cone.k + cone.l1;
    let sum_x = cone.k * view.alpha.x * view.alpha.x + cone.l1;
    let sum_y = cone.k * view.alpha.y * view.alpha.y + cone.l1;
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
    let sense = select(vec2(1.0), vec2(-1.0), towards < vec2(0.0));
    let n = normals_pair_scaled(across, sense);
    let cone = normals_cone(view, n, towards * sense);
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
            wo.x * by_wo + n.x * by_n - cone.k * h.x,
            wo.y * by_wo + n.y * by_n - cone.k * h.y,
            wo.z * by_wo + n.z * by_n - cone.k * h.z,
        ),
        view,
    );
    let shifted = normals_pair_plus(image, normals_pair_scaled(rest, cone.p));
    let level = normals_pair_minus(shifted, normals_pair_scaled(axis, normals_pair_dot(shifted, axis) * per_axis2));
    let gap = max(cone.q - cone.p, 1e-6 * cone.q);
    let on_third = normals_pair_scaled(level, -1.0 / gap);
    let on_second = normals_pair_minus(rest, on_third);

    // The eigenvalues of M, of which the second is one at least.
    let lengths = vec2(a0.length * b0.length, a1.length * b1.length);
    let squares = view.alpha.x * view.alpha.x * view.alpha.y * view.alpha.y;
    let bend = 0.5 * apart2 / max(lengths * cone.n2 * squares, vec2(1e-36));
    let ends = normals_pair_dot(a, b);
    let m1 = ends - bend * (cone.p * cone.q);
    let m2 = ends + bend * (cone.l1 * cone.q);
    let m3 = ends + bend * (cone.l1 * cone.p);

    // The sense of the turn around the first axis is that of the edge. No short edge runs nearly all around the axis: an angle
    // against its sense is a rounding error.
    let by_angle = cone.l1 * inverseSqrt((cone.l1 + cone.p) * (cone.l1 + cone.q));
    let per_axis = sqrt(per_axis2);
    let beside = on_axis * per_axis;
    let is_far = (apart2 > vec2(0.2)) | ((apart2 >= vec2(1e-9)) & (abs(beside) > 0.01 * by_angle));
    let is_wrapped = (beside * sense < vec2(0.0)) & is_far;
    let is_obtuse = m1 < vec2(0.0);
    let begun = select(select(vec2(0.0), vec2(6.2831853), is_wrapped), vec2(3.1415927), is_obtuse);
    let acute = normals_per_sine(min(abs(m1), vec2(1.0)));
    let along_first = (begun * sense * by_angle + select(acute, -acute, is_obtuse) * beside) * per_axis;
    let along_second = normals_per_hyperbolic_sine(max(m2 - 1.0, vec2(0.0)));
    let sharp = normals_per_sine(min(abs(m3), vec2(1.0)));
    let sine2 = (cone.l1 + cone.q) * gap * normals_pair_dot(on_third, on_third);
    let blunt = 3.1415927 * cone.q * inverseSqrt(max(sine2, vec2(1e-36))) - sharp;
    let along_third = select(sharp, blunt, m3 < vec2(0.0));

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
