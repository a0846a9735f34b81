// Integrates a Linearly Transformed Cosine over disks, spheres, lines and tubes, in closed form. Needs ltc_math.wgsl
// and ltc_light.wgsl.
//
// Lights are relative to the shaded point, in its tangent frame, normal +z.

/// The cone of directions to an ellipse, in cosine space. Its border is axes * (a cos t, b sin t, g). For the ellipse
/// c + x cos t + y sin t, the axes are the eigenvectors of x x^T + y y^T - c c^T with eigenvalues a^2, b^2 and -g^2.
struct LtcCone {
    a: f32,
    b: f32,
    /// Zero for an empty cone.
    g: f32,
    /// Positive if the horizon cuts the cone.
    cut2: f32,
    /// The height of the ellipse's centre.
    height: f32,
    axes: mat3x3<f32>,
}

/// An arc of a cone's border. sines holds the difference and the product of the sines at both ends; cosines holds those
/// of the cosines. turn is the sine of the angle between the ends.
struct LtcBorder {
    sines: vec2<f32>,
    cosines: vec2<f32>,
    turn: f32,
}

/// The angle of (x, y) from +x, in [-pi, pi].
fn ltc_angle(y: f32, x: f32) -> f32 {
    let upper = ltc_atan2(abs(y), x);
    return select(upper, -upper, y < 0.0);
}

/// Scales the turn (cosine, sine) to unit length; (1, 0) for a zero vector.
fn ltc_unit_turn(turn: vec2<f32>) -> vec2<f32> {
    let size = max(abs(turn.x), abs(turn.y));
    if (!(size > 0.0)) {
        return vec2(1.0, 0.0);
    }
    let scaled = turn / size;
    return scaled / sqrt(dot(scaled, scaled));
}

/// The positive root of l^3 + trace l^2 + minors l - last, whose other roots are negative, by Newton's method from
/// above.
fn ltc_cone_root(trace: f32, minors: f32, last: f32) -> f32 {
    var root = (2.0 * sqrt(max(trace * trace - 3.0 * minors, 0.0)) - trace) * 0.33333333;
    if (trace > 0.0) {
        // An upper bound: the root without the cubic term, in the form that does not subtract positive numbers.
        let size = sqrt(minors * minors + 4.0 * trace * last);
        if (minors > 0.0) {
            root = min(root, 2.0 * last / (minors + size));
        } else {
            root = min(root, (size - minors) / (2.0 * trace));
        }
    }
    for (var i = 0; i < 4; i++) {
        let value = ((root + trace) * root + minors) * root - last;
        let next = root - value / ((3.0 * root + 2.0 * trace) * root + minors);
        if (next < root && next > 0.0) {
            root = next;
        }
    }
    return root;
}

/// The cone of an ellipse, from its centre and any two conjugate half axes, all in cosine space.
fn ltc_cone(centre: vec3<f32>, half_x: vec3<f32>, half_y: vec3<f32>) -> LtcCone {
    var cone = LtcCone();
    let most = max(max(abs(centre), abs(half_x)), abs(half_y));
    let size = max(max(most.x, most.y), most.z);
    if (!(size > 0.0)) {
        return cone;
    }
    let c = centre / size;
    let x = half_x / size;
    let y = half_y / size;
    let x_y = cross(x, y);
    let y_c = cross(y, c);
    let c_x = cross(c, x);
    let volume = abs(dot(c, x_y));
    let trace = dot(x, x) + dot(y, y) - dot(c, c);
    let minors = dot(x_y, x_y) - dot(y_c, y_c) - dot(c_x, c_x);
    let l3 = ltc_cone_root(trace, minors, volume * volume);
    if (!(l3 > 0.0 && volume > 0.0)) {
        return cone;
    }
    // The columns of a multiple of middle * middle^T. Cross products keep the small eigenvalues of needle-shaped
    // ellipses.
    let rest = l3 * (trace + l3);
    let col_x = x_y * x_y.x - y_c * y_c.x - c_x * c_x.x - l3 * (x * x.x + y * y.x - c * c.x) + vec3(rest, 0.0, 0.0);
    let col_y = x_y * x_y.y - y_c * y_c.y - c_x * c_x.y - l3 * (x * x.y + y * y.y - c * c.y) + vec3(0.0, rest, 0.0);
    let col_z = x_y * x_y.z - y_c * y_c.z - c_x * c_x.z - l3 * (x * x.z + y * y.z - c * c.z) + vec3(0.0, 0.0, rest);
    var middle = select(col_y, col_x, col_x.x > col_y.y);
    middle = select(middle, col_z, col_z.z >= max(col_x.x, col_y.y));
    let largest = max(max(abs(middle.x), abs(middle.y)), abs(middle.z));
    if (!(largest > 0.0)) {
        return cone;
    }
    middle /= largest;
    middle /= sqrt(dot(middle, middle));
    middle = select(middle, -middle, dot(middle, c) < 0.0);
    // e and f are two directions across middle; turn is the rotation from them to the half axes.
    let flat = sqrt(dot(middle.xy, middle.xy));
    var e = select(vec3(1.0, 0.0, 0.0), vec3(-middle.y, middle.x, 0.0) / max(flat, 1e-6), flat > 1e-6);
    e -= middle * dot(middle, e);
    let f = cross(middle, e);
    let of_e = vec3(dot(e, x), dot(e, y), dot(e, c));
    let of_f = vec3(dot(f, x), dot(f, y), dot(f, c));
    let ee = dot(of_e.xy, of_e.xy) - of_e.z * of_e.z;
    let ef = dot(of_e.xy, of_f.xy) - of_e.z * of_f.z;
    let ff = dot(of_f.xy, of_f.xy) - of_f.z * of_f.z;
    let difference = 0.5 * (ee - ff);
    let spread = sqrt(difference * difference + ef * ef);
    let l1 = max(0.5 * (ee + ff) + spread, 0.0);
    let l2 = min(volume * (volume / max(l3 * l1, 1e-36)), l1);
    // turn is half the angle of (difference, ef).
    var turn = vec2(1.0, 0.0);
    if (spread > 0.0) {
        if (difference > 0.0) {
            turn = ltc_unit_turn(vec2(difference + spread, ef));
        } else {
            turn = ltc_unit_turn(vec2(abs(ef), spread - difference));
            turn.y = select(-turn.y, turn.y, ef > 0.0);
        }
    }
    let first = e * turn.x + f * turn.y;
    cone.a = sqrt(l1);
    cone.b = sqrt(l2);
    cone.g = sqrt(l3);
    cone.cut2 = x.z * x.z + y.z * y.z - c.z * c.z;
    cone.height = c.z;
    cone.axes = mat3x3(first, cross(middle, first), middle);
    return cone;
}

/// (artanh(k s_1) - artanh(k s_0)) / k, from the difference s.x and the product s.y of s_1 and s_0.
fn ltc_artanh_over(k: f32, s: vec2<f32>) -> f32 {
    let bottom = max(1.0 - k * k * s.y, 1e-18);
    let tangent = abs(k * s.x) / bottom;
    let tangent2 = tangent * tangent;
    // The logarithm of a number near one loses digits; the series does not.
    var value = 1.0 + tangent2 * (0.33333333 + tangent2 * (0.2 + tangent2 * (0.14285714 + tangent2 * 0.11111111)));
    if (tangent2 >= 0.01) {
        value = 0.5 * ltc_log((1.0 + tangent) / max(1.0 - tangent, 1e-12)) / tangent;
    }
    return s.x / bottom * value;
}

/// (arctan(k c_1) - arctan(k c_0)) / k, from the difference c.x and the product c.y of c_1 and c_0.
fn ltc_arctan_over(k: f32, c: vec2<f32>) -> f32 {
    if (k > 1e-6) {
        return ltc_angle(k * c.x, 1.0 + k * k * c.y) / k;
    }
    return c.x;
}

/// The integral of (p x dp).z / |p|^2 along an arc of the border: 2 pi times the arc's part of the form factor.
fn ltc_along(cone: LtcCone, border: LtcBorder) -> f32 {
    let a_g2 = cone.g * cone.g + cone.a * cone.a;
    let b_g2 = cone.g * cone.g + cone.b * cone.b;
    let a_g = sqrt(a_g2);
    let b_g = sqrt(b_g2);
    let k = sqrt(max((cone.a - cone.b) * (cone.a + cone.b), 0.0));
    let sines = ltc_artanh_over(k / a_g, border.sines) / a_g;
    let cosines = ltc_arctan_over(k / b_g, border.cosines) / b_g;
    let turned = ltc_angle(a_g * b_g * border.turn, a_g2 * border.cosines.y + b_g2 * border.sines.y);
    let around = select(turned, turned + 6.2831853, turned < 0.0);
    let n = vec3(cone.axes[0].z, cone.axes[1].z, cone.axes[2].z);
    return n.z * (cone.a / a_g) * (cone.b / b_g) * around - n.x * (cone.b * cone.g / a_g) * sines
        + n.y * (cone.a * cone.g / b_g) * cosines;
}

/// The highest point of a border that the horizon cuts (xy), and half of its arc above the horizon (zw), as turns.
fn ltc_cone_horizon(cone: LtcCone) -> vec4<f32> {
    let top = ltc_unit_turn(vec2(cone.a * cone.axes[0].z, cone.b * cone.axes[1].z));
    return vec4(top, ltc_unit_turn(vec2(-cone.g * cone.axes[2].z, sqrt(max(cone.cut2, 0.0)))));
}

/// The part of the clamped cosine that a cone covers, from 0 to 1.
fn ltc_cone_covered(cone: LtcCone) -> f32 {
    if (!(cone.g > 0.0)) {
        return 0.0;
    }
    let n = vec3(cone.axes[0].z, cone.axes[1].z, cone.axes[2].z);
    let a_g = sqrt(cone.g * cone.g + cone.a * cone.a);
    let b_g = sqrt(cone.g * cone.g + cone.b * cone.b);
    let whole = cone.a / a_g * (cone.b / b_g);
    if (LTC_CHEAP_HORIZON) {
        return clamp(whole * (whole + n.z) / (whole + 1.0), 0.0, 1.0);
    }
    if (!(cone.cut2 > 0.0)) {
        return clamp(select(0.0, whole * n.z, cone.height > 0.0), 0.0, 1.0);
    }
    let horizon = ltc_cone_horizon(cone);
    let top = horizon.xy;
    let q = horizon.z;
    let h = horizon.w;
    // All differences of sines and cosines are written as products.
    var border: LtcBorder;
    border.sines = vec2(2.0 * h * top.x, top.y * q * top.y * q - top.x * h * top.x * h);
    border.cosines = vec2(-2.0 * h * top.y, top.x * q * top.x * q - top.y * h * top.y * h);
    border.turn = 2.0 * q * h;
    // An arc along the horizon closes the border.
    let across = cone.b * cone.g * abs(n.x * top.x) + cone.a * cone.g * abs(n.y * top.y) + cone.a * cone.b * abs(n.z * q);
    let ahead = cone.g * cone.g + cone.a * cone.a * border.cosines.y + cone.b * cone.b * border.sines.y;
    return clamp((ltc_along(cone, border) + ltc_atan2(2.0 * h * across, ahead)) * 0.15915494, 0.0, 1.0);
}

/// The covered part of the lobe for a disk or ellipse. The half axes need not be perpendicular. The light emits towards
/// half_x x half_y.
fn ltc_disk(inverse: LtcInverse, centre: vec3<f32>, half_x: vec3<f32>, half_y: vec3<f32>, two_sided: bool) -> f32 {
    if (inverse.side == 0.0 || (!two_sided && !(dot(centre, cross(half_x, half_y)) < 0.0))) {
        return 0.0;
    }
    return ltc_cone_covered(ltc_cone(inverse.m * centre, inverse.m * half_x, inverse.m * half_y));
}

/// The cone of a sphere. Domain: the shaded point is outside.
fn ltc_sphere_cone(inverse: LtcInverse, centre: vec3<f32>, radius: f32) -> LtcCone {
    let towards = ltc_unit(centre);
    let sine2 = radius * radius / max(dot(centre, centre), 1e-36);
    let is_upright = abs(towards.z) > 0.7;
    let x = ltc_unit(cross(select(vec3(0.0, 0.0, 1.0), vec3(1.0, 0.0, 0.0), is_upright), towards));
    let y = cross(towards, x);
    let sine = sqrt(sine2);
    return ltc_cone(inverse.m * (towards * sqrt(max(1.0 - sine2, 0.0))), inverse.m * (x * sine), inverse.m * (y * sine));
}

/// The covered part of the lobe for a sphere; 1 if the shaded point is inside.
fn ltc_sphere(inverse: LtcInverse, centre: vec3<f32>, radius: f32) -> f32 {
    if (inverse.side == 0.0) {
        return 0.0;
    }
    if (dot(centre, centre) <= radius * radius) {
        return 1.0;
    }
    return ltc_cone_covered(ltc_sphere_cone(inverse, centre, radius));
}

/// The covered part of the lobe for a line between two points. Its width faces the shaded point everywhere, so the line
/// is the limit of a thin tube of this diameter. It is darker than the tube, by about 2 % if the radius is a fiftieth
/// of the distance.
fn ltc_line(inverse: LtcInverse, start: vec3<f32>, end: vec3<f32>, width: f32) -> f32 {
    // For a line that points at the shaded point, normal and distance are only rounding errors. These errors cancel,
    // because normal and distance both come from the difference of the ends and are used for both ends.
    let middle = 0.5 * (start + end);
    let lit = cross(middle, end - start);
    var p = inverse.m * start;
    var q = inverse.m * end;
    let along = inverse.m * (end - start);
    let normal = cross(inverse.m * middle, along);
    let area2 = dot(normal, normal);
    if (!(area2 > 1e-36) || (p.z <= 0.0 && q.z <= 0.0)) {
        return 0.0;
    }
    let length = sqrt(dot(along, along));
    let per_width = sqrt(dot(lit, lit)) * abs(determinant(inverse.m)) * length / area2;
    // t is the direction of the line; o points from the shaded point to the nearest point of the line.
    let t = along / length;
    let o = cross(t, normal / sqrt(area2));
    if (p.z < 0.0) {
        p = (p * q.z - q * p.z) / (q.z - p.z);
    } else if (q.z < 0.0) {
        q = (p * q.z - q * p.z) / (q.z - p.z);
    }
    let distance = sqrt(area2) / length;
    let at_p = vec2(distance, dot(p, t));
    let at_q = vec2(distance, dot(q, t));
    let from_p = at_p / max(sqrt(dot(at_p, at_p)), 1e-18);
    let from_q = at_q / max(sqrt(dot(at_q, at_q)), 1e-18);
    // The angles of p and q run from o towards t. sine is the sine of their difference; sum is the cosine and sine of
    // their sum.
    let sine = abs(from_p.x * from_q.y - from_p.y * from_q.x);
    let angle = ltc_atan2(sine, dot(from_p, from_q));
    let sum = vec2(from_p.x * from_q.x - from_p.y * from_q.y, from_p.y * from_q.x + from_p.x * from_q.y);
    let integral = o.z * angle + (o.z * sum.x + t.z * sum.y) * sine;
    return clamp(width * per_width * integral * 0.15915494, 0.0, 1.0);
}

/// The parameter of a direction on a cone's border, as a turn.
fn ltc_turn_of(cone: LtcCone, direction: vec3<f32>) -> vec2<f32> {
    return ltc_unit_turn(vec2(dot(direction, cone.axes[0]) * cone.b, dot(direction, cone.axes[1]) * cone.a));
}

/// The direction of a parameter on a cone's border.
fn ltc_direction_of(cone: LtcCone, turn: vec2<f32>) -> vec3<f32> {
    return cone.axes * vec3(cone.a * turn.x, cone.b * turn.y, cone.g);
}

/// A number from 0 to 4 that grows with the angle from one turn to another.
fn ltc_round(first: vec2<f32>, second: vec2<f32>) -> f32 {
    let sine = first.x * second.y - first.y * second.x;
    let cosine = dot(first, second);
    return select(1.0 - cosine, 3.0 + cosine, sine < 0.0);
}

/// The integral along an arc of a cone's border, relative to an origin as in ltc_chord.
fn ltc_border(cone: LtcCone, first: vec2<f32>, second: vec2<f32>, origin: vec3<f32>) -> f32 {
    let p = ltc_unit(ltc_direction_of(cone, first));
    let q = ltc_unit(ltc_direction_of(cone, second));
    let moved = ltc_chord(p, q, origin) - (p.x * q.y - p.y * q.x);
    var border: LtcBorder;
    border.sines = vec2(second.y - first.y, first.y * second.y);
    border.cosines = vec2(second.x - first.x, first.x * second.x);
    border.turn = first.x * second.y - first.y * second.x;
    return ltc_along(cone, border) + moved;
}

/// Adds the arc of a cone's border from the previous point to b, except the part below the horizon.
fn ltc_clip_border(clip: LtcClip, cone: LtcCone, b: vec3<f32>) -> LtcClip {
    var next = clip;
    next.previous = b;
    next.previous_unit = ltc_unit(b);
    var first = ltc_turn_of(cone, clip.previous);
    var second = ltc_turn_of(cone, b);
    if (!(cone.cut2 > 0.0)) {
        if (cone.height > 0.0 && cone.g > 0.0) {
            next.sum += ltc_border(cone, first, second, clip.origin);
        }
        return next;
    }
    let horizon = ltc_cone_horizon(cone);
    let rise = vec2(horizon.x * horizon.z + horizon.y * horizon.w, horizon.y * horizon.z - horizon.x * horizon.w);
    let dip = vec2(horizon.x * horizon.z - horizon.y * horizon.w, horizon.y * horizon.z + horizon.x * horizon.w);
    let begins_up = clip.previous.z > 0.0;
    let ends_up = b.z > 0.0;
    let all = ltc_round(first, second);
    let is_same = begins_up == ends_up;
    let leaves = select(begins_up, ltc_round(first, dip) < all, is_same);
    let enters = select(ends_up, ltc_round(first, rise) < all, is_same);
    if (leaves) {
        next.leaves = ltc_unit(ltc_direction_of(cone, dip));
    }
    if (enters) {
        next.enters = ltc_unit(ltc_direction_of(cone, rise));
    }
    if (leaves && enters && begins_up) {
        next.sum += ltc_border(cone, first, dip, clip.origin) + ltc_border(cone, rise, second, clip.origin);
    } else if (leaves || enters || begins_up) {
        first = select(first, rise, enters);
        second = select(second, dip, leaves);
        next.sum += ltc_border(cone, first, second, clip.origin);
    }
    return next;
}

/// The covered part of the lobe for a tube with round ends; 1 if the shaded point is inside. The tube contains all
/// points within the radius of the segment from start to end. Its outline has an arc of the sphere at each end, and two
/// straight edges in the planes that touch both spheres.
fn ltc_tube(inverse: LtcInverse, start: vec3<f32>, end: vec3<f32>, radius: f32) -> f32 {
    if (inverse.side == 0.0) {
        return 0.0;
    }
    let along = end - start;
    let axis = ltc_unit(along);
    let distance = sqrt(dot(along, along));
    let nearest = start + axis * clamp(-dot(start, axis), 0.0, distance);
    if (dot(nearest, nearest) <= radius * radius) {
        return 1.0;
    }
    let beside = start - axis * dot(start, axis);
    let beside2 = dot(beside, beside);
    // A tube seen along its axis is hidden by the sphere at its nearer end.
    if (!(distance > 0.0) || beside2 <= radius * radius) {
        return ltc_cone_covered(ltc_sphere_cone(inverse, nearest, radius));
    }
    let towards = beside * (radius / beside2);
    let sideways = cross(axis, beside) * (sqrt(beside2 - radius * radius) / beside2 * inverse.side);
    let left = (towards + sideways) * radius;
    let right = (towards - sideways) * radius;
    let last = inverse.m * (start - right);
    var clip = ltc_clip_begin(last);
    clip = ltc_clip_exact_edge(clip, inverse.m * (end - right));
    clip = ltc_clip_border(clip, ltc_sphere_cone(inverse, end, radius), inverse.m * (end - left));
    clip = ltc_clip_exact_edge(clip, inverse.m * (start - left));
    clip = ltc_clip_border(clip, ltc_sphere_cone(inverse, start, radius), last);
    return ltc_clip_exact_finish(clip, 1.0, false);
}
