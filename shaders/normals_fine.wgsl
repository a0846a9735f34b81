/// A neural network of rectified linear units. Its outputs are corrections of the weight (x) and of Schlick's part (y),
/// and the shares of the outer corners (z) and of the tip (w).
fn normals_network(first: vec4<f32>, second: vec4<f32>, third: vec4<f32>) -> vec4<f32> {
    let units_0 = max(
        mat4x4(-13.02, -0.05123, -0.04506, 0.1745, -15.34, 3.537, 0.1719, 0.7646, 0.9581, -0.07924, 1.487, -1.318, 2.672, -0.0372, 0.4158, -0.4705) * first
        + mat4x4(-7.332, 0.1002, 0.3907, 1.197, 0.4244, 0.008437, 0.1669, 0.245, 2.007, 0.1345, -0.7786, 1.951, 4.066, 0.1216, -0.4966, -2.306) * second
        + mat4x4(-5.624, -0.02524, 0.9408, -2.893, -1.013, -0.5777, 0.6708, 1.261, 1.449, -0.5531, 2.123, 0.6918, 12.6, 5.388, -3.767, -0.3633) * third
        + vec4(3.307, -8.365, 1.502, -2.399),
        vec4(0.0),
    );
    let units_1 = max(
        mat4x4(0.2911, 0.08732, -0.2378, 3.093, 2.329, 5.334, -1.179, -4.725, 0.277, -0.2235, 0.6636, -17.36, -0.5704, -4.27, -0.935, 1.581) * first
        + mat4x4(3.386, 0.2138, 0.3196, -3.936, 0.08644, 0.1746, 0.2738, 0.559, -0.5253, 0.5686, 0.8081, 3.705, -0.8306, -0.9163, 0.1851, 1.135) * second
        + mat4x4(0.3792, 0.3699, -1.317, -6.255, 0.9582, 1.731, -0.8138, -18.56, 0.7409, 0.07576, -1.894, 2.134, -2.271, -1.352, -2.596, -11.96) * third
        + vec4(-3.675, -5.474, 3.814, 22.99),
        vec4(0.0),
    );
    let outputs = mat4x4(0.00491, -0.3719, -0.06271, 0.1884, 0.00863, -0.006025, -0.09717, -0.8619, 0.0008738, -0.00477, 0.07171, 0.1559, -0.06756, 0.03206, -0.1098, -0.2721) * units_0
        + mat4x4(0.1447, 0.02995, 0.1516, -0.05558, -0.04049, -0.01654, 0.07856, 0.3683, -0.04697, -0.1253, -0.03508, 0.03203, 0.07185, -1.163, -0.002817, -0.0119) * units_1
        + vec4(-0.005264, 0.004083, 0.0596, -0.0732);
    return outputs;
}

/// The tip is the mean normal of a light. All triangles of the light meet at the tip and share the other values.
struct NormalsTip {
    c: vec3<f32>,
    /// part: the fraction of the visible normals that reflect the light. side: the factor that converts an integral's
    /// component along A wo to a fraction. It is negative if the edges run counterclockwise as seen from the shaded
    /// point.
    part: f32,
    side: f32,
    /// Inputs of the network that all triangles share: the view's rise, the larger and the smaller alpha, and the
    /// weight at the tip.
    shared_inputs: vec4<f32>,
}

/// Sums over triangles. signed: fractions times the mean weight and times the mean of Schlick's part. sizes: both sums
/// with absolute fractions, then the sum of the absolute fractions.
struct NormalsSum {
    signed: vec2<f32>,
    sizes: vec3<f32>,
}

/// The part of an edge above the surface.
struct NormalsSide {
    begin: NormalsCorner,
    end: NormalsCorner,
}

fn normals_side(view: NormalsView, a: vec3<f32>, b: vec3<f32>) -> NormalsSide {
    let cut = vec3(a.xy * abs(b.z) + b.xy * abs(a.z), 0.0);
    let begin = normals_corner(view, select(cut, a, a.z > 0.0));
    return NormalsSide(begin, normals_corner(view, select(cut, b, b.z > 0.0)));
}

fn normals_tip(view: NormalsView, flux: vec3<f32>) -> NormalsTip {
    let projected = dot(flux, view.stretched);
    let side = select(0.31830989, -0.31830989, projected < 0.0) / (view.wo.z + view.length);
    let c = flux * (select(1.0, -1.0, projected < 0.0) * normals_per_length(flux));
    let alpha = vec2(max(view.alpha.x, view.alpha.y), min(view.alpha.x, view.alpha.y));
    return NormalsTip(c, saturate(projected * side), side, vec4(view.rise, alpha, normals_weight(view, c).x));
}

/// The integral of c x dc along the arc of a great circle from the tip to a corner.
fn normals_spoke(tip: NormalsTip, corner: NormalsCorner) -> vec3<f32> {
    return normals_angle(tip.c, corner.c) * cross(tip.c, corner.c);
}

/// Adds the triangle between the tip and the image of an edge. flux is the integral of c x dc around the triangle. The
/// triangle's fraction of the visible normals is multiplied by a mean weight. normals_network corrects the weight of
/// the triangle's mean normal, from the weights at the outer corners and at the tip, and from the fraction.
fn normals_triangle(
    view: NormalsView,
    tip: NormalsTip,
    sum: NormalsSum,
    flux: vec3<f32>,
    begin: NormalsCorner,
    end: NormalsCorner,
) -> NormalsSum {
    let projected = dot(flux, view.stretched);
    let part = projected * tip.side;
    let size = abs(part);
    // Reverse a triangle with a negative fraction.
    let c = flux * (select(1.0, -1.0, projected < 0.0) * normals_per_length(flux));
    let at_mean = normals_weight(view, c);
    let rises = vec2(normals_rise(view, begin.w), normals_rise(view, end.w));
    let at_corners = normals_weight_of(view, 0.5 * (rises.x + rises.y));
    let first = vec4(size, at_mean, at_corners);
    let second = vec4(dot(c, tip.c), dot(c, begin.c + end.c), abs(c.z), abs(rises.x - rises.y));
    let outputs = normals_network(first, second, tip.shared_inputs);
    let known = at_mean.x + outputs.z * (at_corners - at_mean.x) + outputs.w * (tip.shared_inputs.w - at_mean.x);
    let weight = saturate(known + size * outputs.x);
    let m2 = at_mean.y * at_mean.y;
    let means = vec2(weight, clamp(weight * m2 * m2 * at_mean.y + size * outputs.y, 0.0, weight));
    return NormalsSum(sum.signed + part * means, sum.sizes + size * vec3(means, 1.0));
}

/// The reflected light of all triangles. Overlapping triangles cancel in the signed sum. The lower bound is half of
/// tip.part times the means over the triangles, weighted by their absolute fractions.
fn normals_total(tip: NormalsTip, sum: NormalsSum, is_lit: bool) -> vec2<f32> {
    let both = max(sum.signed, sum.sizes.xy * (0.5 * tip.part / max(sum.sizes.z, 1e-30)));
    let energy = min(both.x, tip.part);
    return select(vec2(0.0), vec2(energy, clamp(both.y, 0.0, energy)), is_lit);
}

/// The reflected light of a rectangle of radiance one: for a Fresnel factor of one (x), and weighted by Schlick's
/// (1 - wo . h)^5 (y).
fn normals_rectangle(view: NormalsView, corners: array<vec3<f32>, 4>, two_sided: bool) -> vec2<f32> {
    // Orient both sides so that they rise. A corner below the surface slides up along its side.
    let falls = select(vec2(0.0), vec2(1.0), vec2(corners[1].z, corners[3].z) < corners[0].zz);
    let along = corners[1] - corners[0];
    let across = corners[3] - corners[0];
    let x = (1.0 - 2.0 * falls.x) * along;
    let y = (1.0 - 2.0 * falls.y) * across;
    let low = corners[0] + falls.x * along + falls.y * across;
    let right = low + x;
    let left = low + y;
    if (right.z + y.z <= 0.0) {
        return vec2(0.0);
    }
    let slide = -1.0 / max(vec2(x.z, y.z), vec2(1e-15));
    let right_up = right + saturate(right.z * slide.y) * y;
    let left_up = left + saturate(left.z * slide.x) * x;
    // a and b are the ends of the lowest side after clipping. They are equal if the surface cuts nothing off.
    let a = normals_corner(view, select(low + saturate(low.z * slide.y) * y, left_up, left.z <= 0.0));
    let b = normals_corner(view, select(low + saturate(low.z * slide.x) * x, right_up, right.z <= 0.0));
    let c = normals_corner(view, right_up);
    let high = normals_corner(view, right + y);
    let d = normals_corner(view, left_up);
    let none = vec3(0.0);
    let ab = normals_edge(view, none, a, b);
    let bc = normals_edge(view, none, b, c);
    let ch = normals_edge(view, none, c, high);
    let hd = normals_edge(view, none, high, d);
    let da = normals_edge(view, none, d, a);
    let tip = normals_tip(view, ab + bc + ch + hd + da);
    let to_a = normals_spoke(tip, a);
    let to_b = normals_spoke(tip, b);
    var sum = normals_triangle(view, tip, NormalsSum(vec2(0.0), vec3(0.0)), ab + to_a - to_b, a, b);
    let to_c = normals_spoke(tip, c);
    sum = normals_triangle(view, tip, sum, bc + to_b - to_c, b, c);
    let to_high = normals_spoke(tip, high);
    sum = normals_triangle(view, tip, sum, ch + to_c - to_high, c, high);
    let to_d = normals_spoke(tip, d);
    sum = normals_triangle(view, tip, sum, hd + to_high - to_d, high, d);
    sum = normals_triangle(view, tip, sum, da + to_d - to_a, d, a);
    return normals_total(tip, sum, two_sided || (tip.side > 0.0) == (falls.x == falls.y));
}

/// The reflected light of a convex polygon with 3 to 8 vertices, as in normals_rectangle.
fn normals_polygon(view: NormalsView, vertices: ptr<function, array<vec3<f32>, 8>>, count: u32, two_sided: bool) -> vec2<f32> {
    let number = clamp(count, 3u, 8u);
    var a = (*vertices)[number - 1u];
    var setting = normals_corner(view, a);
    var rising = setting;
    var flux = vec3(0.0);
    var highest = 0.0;
    for (var i = 0u; i < 8u; i++) {
        if (i < number) {
            let b = (*vertices)[i];
            if (a.z > 0.0 || b.z > 0.0) {
                let side = normals_side(view, a, b);
                flux = normals_edge(view, flux, side.begin, side.end);
                if (a.z <= 0.0) {
                    rising = side.begin;
                }
                if (b.z <= 0.0) {
                    setting = side.end;
                }
            }
            highest = max(highest, b.z);
            a = b;
        }
    }
    if (highest <= 0.0) {
        return vec2(0.0);
    }
    let horizon = normals_edge(view, vec3(0.0), setting, rising);
    let tip = normals_tip(view, flux + horizon);
    let spokes = normals_spoke(tip, setting) - normals_spoke(tip, rising);
    var sum = NormalsSum(vec2(0.0), vec3(0.0));
    sum = normals_triangle(view, tip, sum, horizon + spokes, setting, rising);
    for (var i = 0u; i < 8u; i++) {
        if (i < number) {
            let b = (*vertices)[i];
            if (a.z > 0.0 || b.z > 0.0) {
                let side = normals_side(view, a, b);
                let spokes = normals_spoke(tip, side.begin) - normals_spoke(tip, side.end);
                let triangle = normals_edge(view, spokes, side.begin, side.end);
                sum = normals_triangle(view, tip, sum, triangle, side.begin, side.end);
            }
            a = b;
        }
    }
    return normals_total(tip, sum, two_sided || tip.side > 0.0);
}
