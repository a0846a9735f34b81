// Draws directions to rectangles where a surface reflects them, with their exact density [ltcforge, light::sample].

/// A linear map of directions. Drawn directions are uniform over the solid angle of the transformed light.
struct SamplerMap {
    to: mat3x3<f32>,
    /// The inverse of `to`.
    back: mat3x3<f32>,
    /// The determinant of `to`.
    det: f32,
}

/// A direction of unit length, and its density per steradian. The density is 0 if the light is not visible.
struct SamplerDrawn {
    wi: vec3<f32>,
    pdf: f32,
}

/// A rectangle as seen from a point, ready to draw directions.
struct SamplerRectangle {
    map: SamplerMap,
    // The corners of the part above the surface, in the space of the map. g is the highest.
    g: vec3<f32>,
    h: vec3<f32>,
    d: vec3<f32>,
    e: vec3<f32>,
    f: vec3<f32>,
    /// Half of the solid angles of the triangles g h d, g d e and g e f.
    halves: vec3<f32>,
    /// The sum of `halves`.
    total: f32,
    /// The density at a direction p is scale / |to p|^3.
    scale: f32,
}

/// The part of a rectangle above the surface. Both sides rise towards the highest corner. The other corners are a
/// fraction of the sides below it: h and f next to it, d and e at the lowest corner.
struct SamplerPart {
    highest: vec3<f32>,
    x: vec3<f32>,
    y: vec3<f32>,
    h: f32,
    d: vec2<f32>,
    e: vec2<f32>,
    f: f32,
    is_visible: bool,
}

/// The vector scaled to unit length; zero for a zero vector.
fn sampler_unit(v: vec3<f32>) -> vec3<f32> {
    return v * inverseSqrt(dot(v, v) + 1e-36);
}

/// The integral of c x dc along an arc between unit vectors. The angle has a relative error below 8e-4. The sum of the
/// vectors keeps the digits of arcs of nearly 180 degrees.
fn sampler_arc(a: vec3<f32>, b: vec3<f32>) -> vec3<f32> {
    let sum = a + b;
    let h = 0.5 * dot(sum, sum) + 1e-12;
    let per_sine = (2.2214415 + h * 0.4152027) * inverseSqrt(h) + (-0.9720743 + h * -0.0933735);
    return per_sine * cross(a, sum);
}

/// Half of the solid angle of a triangle of unit vectors with this volume.
/// 1 + a.b + b.c + c.a is the product of two sums of vectors. The two smallest sums keep the digits of long triangles.
fn sampler_half(a: vec3<f32>, b: vec3<f32>, c: vec3<f32>, volume: f32) -> f32 {
    let ab = a + b;
    let bc = b + c;
    let ca = c + a;
    let squares = vec3(dot(ab, ab), dot(bc, bc), dot(ca, ca));
    let by_a_or_b = select(dot(ab, bc), dot(ab, ca), squares.y > squares.z);
    let is_c = squares.x > max(squares.y, squares.z);
    return ltc_atan2(abs(volume), select(by_a_or_b, dot(bc, ca), is_c));
}

/// The map of GGX that is exact at the normal h.
fn sampler_tangent(alpha: vec2<f32>, wo: vec3<f32>, h: vec3<f32>) -> SamplerMap {
    let stretched = vec3(alpha * wo.xy, wo.z);
    let per_length = inverseSqrt(dot(stretched, stretched));
    let s = stretched * per_length;
    let per_alpha = 1.0 / alpha;
    let d = max(dot(wo, h), 1e-5);
    let dd = 2.0 * d * d;
    let q = 2.0 * d * h - wo;
    // T A^-1 (I + wo q^T), with s . A^-1 (I + wo q^T) = 2 d h / |A wo|.
    let image = 1.41421356 * vec3(wo.xy * per_alpha, wo.z);
    let along = (-0.41421356 * 2.0 * d * per_length) * h;
    let to = mat3x3(
        image * q.x + s * along.x + vec3(1.41421356 * per_alpha.x, 0.0, 0.0),
        image * q.y + s * along.y + vec3(0.0, 1.41421356 * per_alpha.y, 0.0),
        image * q.z + s * along.z + vec3(0.0, 0.0, 1.41421356));
    // (I - wo q^T / (2 d^2)) A T^-1
    let a = 0.70710678 * vec3(alpha, 1.0);
    let across = 0.29289322 * vec3(alpha * s.xy, s.z);
    let per_dd = 1.0 / dd;
    let turned = across - (dot(q, across) * per_dd) * wo;
    let back_wo = (-per_dd * a * q);
    let back = mat3x3(
        turned * s.x + wo * back_wo.x + vec3(a.x, 0.0, 0.0),
        turned * s.y + wo * back_wo.y + vec3(0.0, a.y, 0.0),
        turned * s.z + wo * back_wo.z + vec3(0.0, 0.0, a.z));
    return SamplerMap(to, back, 2.0 * dd * per_alpha.x * per_alpha.y);
}

/// The map of GGX for the middle of all visible normals.
fn sampler_lobe(alpha: vec2<f32>, wo: vec3<f32>) -> SamplerMap {
    let s = sampler_unit(vec3(alpha * wo.xy, wo.z));
    return sampler_tangent(alpha, wo, sampler_unit(vec3(alpha * s.xy, s.z + 1.0)));
}

/// The map of GGX for the middle of a light. flux is the integral of c x dc along the outline, transformed by
/// sampler_lobe. sum is the sum of its corners.
fn sampler_about(alpha: vec2<f32>, wo: vec3<f32>, flux: vec3<f32>, sum: vec3<f32>) -> SamplerMap {
    let s = sampler_unit(vec3(alpha * wo.xy, wo.z));
    let middle = select(flux, -flux, dot(flux, sum) < 0.0) + 1e-4 * sum;
    let unturned = 0.70710678 * middle + (0.29289322 * dot(s, middle)) * s;
    return sampler_around(alpha, wo, s, unturned, dot(middle, middle));
}

/// The same for flux of normals_rectangle_lit. It loses its digits for tiny lights: the normal that reflects the light's
/// highest corner then replaces it.
fn sampler_about_mean(alpha: vec2<f32>, wo: vec3<f32>, flux: vec3<f32>, highest: vec3<f32>) -> SamplerMap {
    let s = sampler_unit(vec3(alpha * wo.xy, wo.z));
    let corner = (sqrt(dot(highest, highest)) * wo + highest) / vec3(alpha, 1.0);
    let middle = select(-flux, flux, dot(flux, s) > 0.0) + 1e-4 * sampler_unit(corner);
    return sampler_around(alpha, wo, s, middle, dot(middle, middle));
}

/// The map of GGX for the stretched normal middle. flux2 is the squared length of the integral of c x dc.
fn sampler_around(alpha: vec2<f32>, wo: vec3<f32>, s: vec3<f32>, middle: vec3<f32>, flux2: f32) -> SamplerMap {
    let size = 0.15915494 * sqrt(flux2);
    let unit = sampler_unit(middle);
    // Large lights get fewer samples near the horizon, and cover highlights that bend.
    let c = unit + (4.0 * size + max(0.3 - dot(unit, s), 0.0)) * s;
    let larger = max(alpha.x, alpha.y);
    let wide = alpha + (0.3 * size * larger * larger) * abs(wo.xy);
    return sampler_tangent(wide, wo, sampler_unit(vec3(alpha * c.xy, max(c.z, 0.0))));
}

/// The map of an LTC with the matrix m.
fn sampler_ltc_map(m: mat3x3<f32>) -> SamplerMap {
    let x = cross(m[1], m[2]);
    let y = cross(m[2], m[0]);
    let z = cross(m[0], m[1]);
    let det = dot(m[2], z);
    let per_det = select(1.0 / det, 0.0, det == 0.0);
    let rows = mat3x3(x * (1.41421356 * per_det), y * (1.41421356 * per_det), z * per_det);
    return SamplerMap(transpose(rows), mat3x3(m[0] * 0.70710678, m[1] * 0.70710678, m[2]), 2.0 * abs(per_det));
}

fn sampler_part(corners: array<vec3<f32>, 4>, two_sided: bool) -> SamplerPart {
    let along = corners[1] - corners[0];
    let across = corners[3] - corners[0];
    let turn = select(vec2(1.0), vec2(-1.0), vec2(along.z, across.z) < vec2(0.0));
    let x = turn.x * along;
    let y = turn.y * across;
    let low = corners[0] + (0.5 * turn.x - 0.5) * x + (0.5 * turn.y - 0.5) * y;
    let highest = low + x + y;
    // The fractions of each side below the surface: from the lowest corner, and towards the highest.
    let per_height = 1.0 / max(vec2(x.z, y.z), vec2(1e-30));
    let first = saturate(-low.z * per_height);
    let last = saturate(-vec2(low.z + y.z, low.z + x.z) * per_height);
    let is_visible = highest.z > 0.0 && (two_sided || dot(corners[0], cross(along, across)) > 0.0);
    return SamplerPart(highest, x, y, 1.0 - last.x, vec2(1.0 - last.x, 1.0 - first.y), vec2(1.0 - first.x, 1.0 - last.y),
        1.0 - last.y, is_visible);
}

fn sampler_begin(map: SamplerMap, part: SamplerPart) -> SamplerRectangle {
    let x = map.to * part.x;
    let y = map.to * part.y;
    let highest = map.to * part.highest;
    let h = highest - part.h * x;
    let d = highest - part.d.x * x - part.d.y * y;
    let e = highest - part.e.x * x - part.e.y * y;
    let f = highest - part.f * y;
    let per_g = inverseSqrt(dot(highest, highest) + 1e-36);
    let per_h = inverseSqrt(dot(h, h) + 1e-36);
    let per_d = inverseSqrt(dot(d, d) + 1e-36);
    let per_e = inverseSqrt(dot(e, e) + 1e-36);
    let per_f = inverseSqrt(dot(f, f) + 1e-36);
    let unit_g = highest * per_g;
    let unit_h = h * per_h;
    let unit_d = d * per_d;
    let unit_e = e * per_e;
    let unit_f = f * per_f;
    // All volumes are multiples of one. This keeps the digits of tiny lights.
    let volume = map.det * dot(cross(part.x, part.y), part.highest) * per_g;
    let halves = vec3(
        sampler_half(unit_g, unit_h, unit_d, volume * per_h * per_d * (part.h * part.d.y)),
        sampler_half(unit_g, unit_d, unit_e, volume * per_d * per_e * (part.d.x * part.e.y - part.d.y * part.e.x)),
        sampler_half(unit_g, unit_e, unit_f, volume * per_e * per_f * (part.e.x * part.f)));
    let total = select(0.0, halves.x + halves.y + halves.z, part.is_visible);
    let scale = select(0.0, 0.5 * map.det / total, total > 0.0);
    return SamplerRectangle(map, unit_g, unit_h, unit_d, unit_e, unit_f, halves, total, scale);
}

/// The sampler of a rectangle or parallelogram for GGX. wo is the view in the tangent frame, normal +z, of unit length.
/// Corners are relative to the point in this frame, and run clockwise as seen from the side that emits.
fn sampler_normals(alpha_x: f32, alpha_y: f32, wo: vec3<f32>, corners: array<vec3<f32>, 4>, two_sided: bool) -> SamplerRectangle {
    let alpha = max(vec2(alpha_x, alpha_y), vec2(1e-5));
    let part = sampler_part(corners, two_sided);
    let to = sampler_lobe(alpha, wo).to;
    let x = to * part.x;
    let y = to * part.y;
    let highest = to * part.highest;
    let g = sampler_unit(highest);
    let h = sampler_unit(highest - part.h * x);
    let d = sampler_unit(highest - part.d.x * x - part.d.y * y);
    let e = sampler_unit(highest - part.e.x * x - part.e.y * y);
    let f = sampler_unit(highest - part.f * y);
    let flux = sampler_arc(g, h) + sampler_arc(h, d) + sampler_arc(d, e) + sampler_arc(e, f) + sampler_arc(f, g);
    return sampler_begin(sampler_about(alpha, wo, flux, g + h + d + e + f), part);
}

/// The same for the flux of normals_rectangle_lit. It costs less.
fn sampler_normals_about(alpha_x: f32, alpha_y: f32, wo: vec3<f32>, flux: vec3<f32>, corners: array<vec3<f32>, 4>, two_sided: bool) -> SamplerRectangle {
    let alpha = max(vec2(alpha_x, alpha_y), vec2(1e-5));
    let part = sampler_part(corners, two_sided);
    return sampler_begin(sampler_about_mean(alpha, wo, flux, part.highest), part);
}

/// The sampler of a rectangle for an LTC with the matrix m, as for sampler_normals. The unit matrix is for diffuse
/// surfaces.
fn sampler_ltc(m: mat3x3<f32>, corners: array<vec3<f32>, 4>, two_sided: bool) -> SamplerRectangle {
    return sampler_begin(sampler_ltc_map(m), sampler_part(corners, two_sided));
}

/// The direction in a triangle of unit vectors: the arc from b through side ac cuts off half the solid angle `half`, and
/// u is the part of the area along the arc.
fn sampler_in_triangle(a: vec3<f32>, b: vec3<f32>, c: vec3<f32>, half_angle: f32, u: f32) -> vec3<f32> {
    let turned = ltc_sin_cos(half_angle * 0.15915494);
    let ac = c - a;
    let side = sampler_unit(ac + 0.5 * dot(ac, ac) * a);
    let ab = b - a;
    let den = turned.y * abs(dot(cross(a, ab), side)) - turned.x * dot(ab, side);
    let sum = a + b;
    let num = 0.5 * turned.x * dot(sum, sum);
    let size = den * den + num * num;
    let per_size = 1.0 / max(size, 1e-30);
    // A triangle without area: any of its points will do.
    let q = select(a, ((den * den - num * num) * per_size) * a + (2.0 * den * num * per_size) * side, size > 1e-30);
    let bq = q - b;
    let along = 0.5 * dot(bq, bq);
    let m = u * along;
    return (1.0 - m) * b + sqrt(max(m * (2.0 - m), 0.0)) * sampler_unit(bq + along * b);
}

/// The direction for a point y in the space of the map, of unit length.
fn sampler_drawn(map: SamplerMap, scale: f32, y: vec3<f32>) -> SamplerDrawn {
    let p = map.back * y;
    let per_length = inverseSqrt(dot(p, p) + 1e-36);
    let length = dot(p, p) * per_length;
    return SamplerDrawn(p * per_length, scale * length * length * length);
}

/// The density at a direction p.
fn sampler_density(map: SamplerMap, scale: f32, p: vec3<f32>) -> f32 {
    let y = map.to * p;
    let per_length = inverseSqrt(dot(y, y) + 1e-36);
    return scale * per_length * per_length * per_length;
}

/// A direction to the light, for two random numbers in [0, 1).
fn sampler_draw(light: SamplerRectangle, u: vec2<f32>) -> SamplerDrawn {
    var rest = u.x * light.total;
    var b = light.h;
    var c = light.d;
    if (rest > light.halves.x) {
        rest -= light.halves.x;
        b = light.d;
        c = light.e;
        if (rest > light.halves.y) {
            rest = min(rest - light.halves.y, light.halves.z);
            b = light.e;
            c = light.f;
        }
    }
    return sampler_drawn(light.map, light.scale, sampler_in_triangle(light.g, b, c, rest, u.y));
}

/// The density of a direction that hits the light.
fn sampler_pdf(light: SamplerRectangle, wi: vec3<f32>) -> f32 {
    return sampler_density(light.map, light.scale, wi);
}

/// A direction from one of two samplers of the same light, such as specular and diffuse. share is the probability of the
/// first: its part of the reflected light.
fn sampler_draw_either(first: SamplerRectangle, second: SamplerRectangle, share: f32, u: vec2<f32>) -> SamplerDrawn {
    let is_first = u.x < share;
    var chosen = second;
    if (is_first) {
        chosen = first;
    }
    let rest = select((u.x - share) / max(1.0 - share, 1e-6), u.x / max(share, 1e-6), is_first);
    let wi = sampler_draw(chosen, vec2(min(rest, 0.99999994), u.y)).wi;
    return SamplerDrawn(wi, sampler_pdf_either(first, second, share, wi));
}

/// The density of sampler_draw_either.
fn sampler_pdf_either(first: SamplerRectangle, second: SamplerRectangle, share: f32, wi: vec3<f32>) -> f32 {
    return share * sampler_pdf(first, wi) + (1.0 - share) * sampler_pdf(second, wi);
}

/// The analytic light minus the hidden light. hidden is the sum of radiance (1 - visible) brdf cos / pdf over `count`
/// draws. It is unbiased, and has no noise where nothing is hidden.
fn sampler_minus_hidden(light: vec3<f32>, hidden: vec3<f32>, count: f32) -> vec3<f32> {
    return light - hidden / count;
}

/// The analytic light times the visible part of all draws. seen is the sum of visible brdf cos / pdf, all the sum of
/// brdf cos / pdf. It has less noise in shadows, and is biased with few draws.
fn sampler_by_ratio(light: vec3<f32>, seen: vec3<f32>, all: vec3<f32>) -> vec3<f32> {
    return light * seen / max(all, vec3(1e-30));
}
