// Lights a GGX surface by a polygon light, with a single Gaussian and without a table. This is the cheapest and the
// coarsest model. Needs ltc_math.wgsl.
//
// Vertices are relative to the shaded point, in its tangent frame, normal +z. They run clockwise as seen from the side
// that emits. The outline must be convex. A polygon of the same area replaces a disk.

/// The kind of Gaussian: round (SG), or stretched like the reflected lobe (ASG).
const GAUSSIANS_SG: u32 = 0u;
const GAUSSIANS_ASG: u32 = 1u;

/// The Gaussian lobe of a surface seen from one direction.
struct GaussiansView {
    /// The middle of the lobe, of unit length.
    axis: vec3<f32>,
    /// The dot products of a projected direction with x and y are its coordinates in the lobe, in standard deviations.
    x: vec3<f32>,
    y: vec3<f32>,
    /// The reflected light of a white sky: for a Fresnel factor of one (x), and weighted by Schlick's
    /// (1 - wo . h)^5 (y).
    parts: vec2<f32>,
}

/// The change of the reflected direction when the normal h tilts by dh.
fn gaussians_moved(h: vec3<f32>, wo: vec3<f32>, dh: vec3<f32>) -> vec3<f32> {
    let h2 = dot(h, h);
    let cosine = dot(wo, h);
    let along = 2.0 * dot(wo, dh) / h2 - 4.0 * cosine * dot(h, dh) / (h2 * h2);
    return h * along + dh * (2.0 * cosine / h2);
}

/// The Gaussian around an axis. The vectors first and second are its standard deviations, perpendicular to the axis. A
/// round Gaussian has the same area as a stretched one.
fn gaussians_around(kind: u32, axis: vec3<f32>, first: vec3<f32>, second: vec3<f32>) -> GaussiansView {
    let area = dot(axis, cross(first, second));
    let size = max(abs(area), 1e-30);
    let oriented = select(size, -size, area < 0.0);
    var view = GaussiansView(axis, cross(second, axis) / oriented, cross(axis, first) / oriented, vec2(0.0));
    if (kind == GAUSSIANS_SG) {
        // x and y are the perpendicular vectors closest to first and second. The order of first and second does not
        // matter.
        let turned = cross(second, axis);
        let x = normalize(first + select(turned, -turned, area < 0.0));
        view.x = x / sqrt(size);
        view.y = cross(axis, x) / sqrt(size);
    }
    return view;
}

/// The Gaussian of a surface with roughness alpha_x and alpha_y, both above 0, seen from direction wo.
fn gaussians_view(kind: u32, alpha_x: f32, alpha_y: f32, wo: vec3<f32>) -> GaussiansView {
    let stretch = vec3(alpha_x, alpha_y, 1.0);
    let stretched = stretch * wo;
    let stretched_length = length(stretched);
    let s = stretched / stretched_length;
    // h is the middle of the visible normals. spread is their standard deviation in the space where the surface is a
    // hemisphere.
    let h = stretch * vec3(s.xy, s.z + 1.0);
    let spread = sqrt(2.0 * (1.0 + s.z));
    let h2 = dot(h, h);
    let cosine = dot(wo, h);
    let axis = normalize(h * (2.0 * cosine / h2) - wo);
    let first = gaussians_moved(h, wo, vec3(spread * alpha_x, 0.0, 0.0));
    let second = gaussians_moved(h, wo, vec3(0.0, spread * alpha_y, 0.0));
    var view = gaussians_around(kind, axis, first, second);
    // Smith's G2 / G1 at the lobe's middle.
    let up = max(axis.z, 0.0);
    let bottom = stretched_length * up + wo.z * length(stretch * axis);
    let weight = min((wo.z + stretched_length) * up / max(bottom, 1e-36), 1.0);
    let m = clamp(1.0 - cosine / sqrt(h2), 0.0, 1.0);
    view.parts = vec2(weight, weight * (m * m * m * m * m));
    return view;
}

/// The coordinates of a direction of any length in the equal-area projection around the axis, in standard deviations.
fn gaussians_at(view: GaussiansView, w: vec3<f32>) -> vec2<f32> {
    let size = length(w);
    let from_behind = max(size + dot(w, view.axis), 1e-6 * size);
    return vec2(dot(w, view.x), dot(w, view.y)) * sqrt(2.0 / max(size * from_behind, 1e-36));
}

/// The image of a direction in a square of area one: half of erf along x and along y. This maps the plane of the
/// Gaussian to the square. Error below 2.5e-4 [Abramowitz and Stegun, 7.1.27].
fn gaussians_image(view: GaussiansView, w: vec3<f32>) -> vec2<f32> {
    let at = gaussians_at(view, w);
    let z = min(abs(at), vec2(8.0));
    let p = (((0.078108 * z + 0.000972) * z + 0.230389) * z + 0.278393) * z + 1.0;
    let p2 = p * p;
    let half = 0.5 - 0.5 / (p2 * p2);
    return select(half, -half, at < vec2(0.0));
}

/// The image of an outline in the square, added up edge by edge. It leaves out parts below the surface.
struct GaussiansOutline {
    /// Twice the area of the image.
    area: f32,
    /// The first vertex and its image.
    start: vec3<f32>,
    origin: vec2<f32>,
    /// The sum of the edges' cross products: a normal of the light.
    normal: vec3<f32>,
    previous: vec3<f32>,
    previous_image: vec2<f32>,
    /// The points where the outline leaves the upper hemisphere and enters it again, and their images.
    leaves: vec3<f32>,
    enters: vec3<f32>,
    leaves_image: vec2<f32>,
    enters_image: vec2<f32>,
}

/// Starts an outline at a vertex. Call gaussians_outline_edge with each of the other vertices in order, then with this
/// vertex.
fn gaussians_outline_begin(view: GaussiansView, vertex: vec3<f32>) -> GaussiansOutline {
    let zero = vec3(0.0);
    let none = vec2(0.0);
    return GaussiansOutline(0.0, vertex, gaussians_image(view, vertex), zero, vertex, none, zero, zero, none, none);
}

/// Twice the signed area of the triangle between the origin, a and b.
fn gaussians_turn(a: vec2<f32>, b: vec2<f32>) -> f32 {
    return a.x * b.y - a.y * b.x;
}

/// The parameter (0 at a, 1 at b) of the point of an edge that is s deviations after its foot. The foot is the point of
/// the edge closest to the axis. a and b hold dot products with x, y and the axis. ends holds the coordinates
/// of a and b along the edge.
fn gaussians_beyond_foot(a: vec3<f32>, b: vec3<f32>, ends: vec2<f32>, s: f32) -> f32 {
    let change = (ends.y - ends.x) - s * (b.z - a.z);
    let is_there = abs(change) >= 1e-30;
    return select(0.5, clamp((s * a.z - ends.x) / select(1.0, change, is_there), 0.0, 1.0), is_there);
}

/// Twice the area between the origin and the image of an edge. Three chords replace the image. They meet at two points,
/// 0.7 deviations before and after the foot.
fn gaussians_under(
    view: GaussiansView,
    origin: vec2<f32>,
    start: vec3<f32>,
    start_image: vec2<f32>,
    end: vec3<f32>,
    end_image: vec2<f32>,
) -> f32 {
    let a = vec3(dot(start, view.x), dot(start, view.y), dot(start, view.axis));
    let b = vec3(dot(end, view.x), dot(end, view.y), dot(end, view.axis));
    let line = cross(a, b);
    let ends = vec2(line.y * a.x - line.x * a.y, line.y * b.x - line.x * b.y) / max(length(line.xy), 1e-30);
    var parts = vec2(gaussians_beyond_foot(a, b, ends, -0.7), gaussians_beyond_foot(a, b, ends, 0.7));
    // An edge that begins or ends behind the axis turns around the axis by up to 180 degrees. Its two points are then
    // the foot and the point where the edge crosses the plane perpendicular to the axis, in the order of the edge.
    let sizes = max(vec2(length(start), length(end)), vec2(1e-36));
    let passes = (a.z > 0.0) != (b.z > 0.0);
    let behind = select(0.0, min(-4.0 * min(a.z / sizes.x, b.z / sizes.y), 1.0), passes);
    let passing = a.z / select(1.0, a.z - b.z, passes);
    let crossed = vec2(gaussians_beyond_foot(a, b, ends, 0.0), passing);
    parts = mix(parts, select(crossed.yx, crossed, a.z > 0.0), vec2(behind));
    // The position of a foot near 90 degrees from the axis is unstable. The middle of the edge replaces it.
    let normal = cross(start, end);
    let height = dot(normal, view.axis);
    let far = clamp((0.02 - (1.0 - height * height / max(dot(normal, normal), 1e-36))) / 0.015, 0.0, 1.0);
    parts = mix(parts, vec2(sizes.x / (sizes.x + sizes.y)), vec2(far));
    let first = gaussians_image(view, start + (end - start) * min(parts.x, parts.y)) - origin;
    let second = gaussians_image(view, start + (end - start) * max(parts.x, parts.y)) - origin;
    return gaussians_turn(start_image, first) + gaussians_turn(first, second) + gaussians_turn(second, end_image);
}

fn gaussians_outline_edge(view: GaussiansView, outline: GaussiansOutline, b: vec3<f32>) -> GaussiansOutline {
    var next = outline;
    let a = outline.previous;
    next.normal += cross(a - outline.start, b - outline.start);
    next.previous = b;
    next.previous_image = gaussians_image(view, b) - outline.origin;
    var start = a;
    var start_image = outline.previous_image;
    var end = b;
    var end_image = next.previous_image;
    if ((a.z > 0.0) != (b.z > 0.0)) {
        let crossing = vec3(a.xy * abs(b.z) + b.xy * abs(a.z), 0.0);
        let image = gaussians_image(view, crossing) - outline.origin;
        if (a.z > 0.0) {
            next.leaves = crossing;
            next.leaves_image = image;
            end = crossing;
            end_image = image;
        } else {
            next.enters = crossing;
            next.enters_image = image;
            start = crossing;
            start_image = image;
        }
    }
    if (a.z > 0.0 || b.z > 0.0) {
        next.area += gaussians_under(view, outline.origin, start, start_image, end, end_image);
    }
    return next;
}

/// The reflected light of the outline. A line along the horizon closes an outline that the surface cuts.
fn gaussians_outline_finish(view: GaussiansView, outline: GaussiansOutline, two_sided: bool) -> vec2<f32> {
    var area = outline.area;
    if (any(outline.leaves != outline.enters)) {
        area += gaussians_under(
            view, outline.origin, outline.leaves, outline.leaves_image, outline.enters, outline.enters_image);
    }
    let is_lit = two_sided || dot(outline.normal, outline.start) >= 0.0;
    // The parts from a table are the light of a Gaussian over its whole plane, and may exceed one. The bound keeps the
    // reflected light at one or below.
    return view.parts * select(0.0, min(0.5 * abs(area), 1.0 / max(view.parts.x, 1.0)), is_lit);
}

/// The reflected light of a rectangle of radiance one, given by its corners in order. x: for a Fresnel factor of one.
/// y: weighted by Schlick's (1 - wo . h)^5. The reflected light of radiance L is L (f0 (x - y) + f90 y).
fn gaussians_rectangle(view: GaussiansView, corners: array<vec3<f32>, 4>, two_sided: bool) -> vec2<f32> {
    var outline = gaussians_outline_begin(view, corners[3]);
    outline = gaussians_outline_edge(view, outline, corners[0]);
    outline = gaussians_outline_edge(view, outline, corners[1]);
    outline = gaussians_outline_edge(view, outline, corners[2]);
    outline = gaussians_outline_edge(view, outline, corners[3]);
    return gaussians_outline_finish(view, outline, two_sided);
}

/// The reflected light of a convex polygon with 3 to 8 vertices in order. The count is clamped to this range.
fn gaussians_polygon(view: GaussiansView, vertices: array<vec3<f32>, 8>, count: u32, two_sided: bool) -> vec2<f32> {
    var list = vertices;
    let number = clamp(count, 3u, 8u);
    var outline = gaussians_outline_begin(view, list[number - 1u]);
    for (var i = 0u; i < 8u; i++) {
        if (i >= number) {
            break;
        }
        outline = gaussians_outline_edge(view, outline, list[i]);
    }
    return gaussians_outline_finish(view, outline, two_sided);
}

/// The reflected light of a disk, replaced by the regular octagon of the same area. The half axes are perpendicular.
/// The disk emits towards half_x x half_y.
fn gaussians_disk(
    view: GaussiansView,
    centre: vec3<f32>,
    half_x: vec3<f32>,
    half_y: vec3<f32>,
    two_sided: bool,
) -> vec2<f32> {
    var vertices: array<vec3<f32>, 8>;
    for (var i = 0u; i < 8u; i++) {
        let turn = ltc_sin_cos((0.5 - f32(i)) * 0.125) * 1.0539074;
        vertices[i] = centre + half_x * turn.y + half_y * turn.x;
    }
    return gaussians_polygon(view, vertices, 8u, two_sided);
}

/// The reflected light of a spherical Gaussian with radiance amplitude * exp(sharpness (w . axis - 1)): its inner
/// product with the Gaussian of the surface. axis has unit length. Light from below the surface counts too.
fn gaussians_sg(view: GaussiansView, axis: vec3<f32>, sharpness: f32, amplitude: f32) -> vec2<f32> {
    let width = 2.0 / sharpness;
    let products = width * vec3(dot(view.x, view.x), dot(view.x, view.y), dot(view.y, view.y));
    let area = width * abs(dot(view.axis, cross(view.x, view.y)));
    let determinant = 1.0 + products.x + products.z + area * area;
    let at = gaussians_at(view, axis);
    let squares = (1.0 + products.z) * at.x * at.x + (1.0 + products.x) * at.y * at.y;
    let far = (squares - 2.0 * products.y * at.x * at.y) / determinant;
    return view.parts * (amplitude * area / sqrt(determinant) * exp(-far));
}
