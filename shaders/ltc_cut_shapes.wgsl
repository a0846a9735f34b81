// Integrates a Linearly Transformed Cosine over disks, spheres, tubes and lines, in closed form. The surface cuts the
// lobe. Needs ltc_shapes.wgsl and ltc_cut.wgsl.
//
// The visible part of a cut ellipse is bounded by an arc of its cone and by an edge along the surface.
// LTC_CHEAP_HORIZON does not change disks and spheres that the surface cuts, nor tubes with both ends visible.

/// An ellipse in the tangent frame, and where the surface cuts it.
struct LtcEllipse {
    /// The centre and both half axes.
    points: mat3x3<f32>,
    cone: LtcCone,
    /// Whether the surface cuts the ellipse. Along the direction of ltc_clip_border, the border rises above the surface
    /// at rise and falls below it at dip.
    is_cut: bool,
    rise: vec3<f32>,
    dip: vec3<f32>,
}

fn ltc_ellipse(inverse: LtcInverse, points: mat3x3<f32>) -> LtcEllipse {
    let c = points[0];
    let x = points[1];
    let y = points[2];
    var ellipse = LtcEllipse(points, ltc_cone(inverse.m * c, inverse.m * x, inverse.m * y), false, vec3(0.0), vec3(0.0));
    let heights = vec2(x.z, y.z);
    let most2 = dot(heights, heights);
    let cut2 = most2 - c.z * c.z;
    if (cut2 > 0.0) {
        // Cosine and sine of the two parameters at which the border has height zero.
        let middle = heights * (-c.z / most2);
        let across = vec2(-y.z, x.z) * (sqrt(cut2) / most2);
        let late = middle + across;
        let early = middle - across;
        let turns = dot(c, cross(x, y)) * inverse.side < 0.0;
        let rise = select(early, late, turns);
        let dip = select(late, early, turns);
        ellipse.is_cut = true;
        ellipse.rise = vec3(c.xy + x.xy * rise.x + y.xy * rise.y, 0.0);
        ellipse.dip = vec3(c.xy + x.xy * dip.x + y.xy * dip.y, 0.0);
    }
    return ellipse;
}

/// The visible disk of a sphere: centre and both half axes. Domain: the shaded point is outside the sphere.
fn ltc_disk_of_sphere(centre: vec3<f32>, radius: f32) -> mat3x3<f32> {
    let towards = ltc_unit(centre);
    let sine2 = radius * radius / max(dot(centre, centre), 1e-36);
    let is_upright = abs(towards.z) > 0.7;
    let x = ltc_unit(cross(select(vec3(0.0, 0.0, 1.0), vec3(1.0, 0.0, 0.0), is_upright), towards));
    let y = cross(towards, x);
    return mat3x3(towards * sqrt(max(1.0 - sine2, 0.0)), x * sqrt(sine2), y * sqrt(sine2));
}

/// Adds an arc of a border above the surface, from a to b.
fn ltc_cut_border(inverse: LtcInverse, clip: LtcClip, cone: LtcCone, a: vec3<f32>, b: vec3<f32>) -> LtcClip {
    var next = clip;
    next.previous = inverse.m * a;
    return ltc_clip_border(next, cone, inverse.m * b);
}

/// The covered part of the lobe. Where the surface or the horizon of the lobe cuts the outline, a line closes it.
fn ltc_cut_close(inverse: LtcInverse, cut: LtcCut) -> f32 {
    var clip = cut.clip;
    if (any(cut.leaves != cut.enters)) {
        clip = ltc_cut_above(inverse, clip, cut.leaves, cut.enters);
    }
    let is_cut = any(clip.leaves != clip.enters);
    let closing = select(0.0, ltc_chord(clip.leaves, clip.enters, clip.origin) + ltc_arc(clip.leaves, clip.enters), is_cut);
    return clamp((clip.sum + closing) * 0.15915494 * ltc_per_part_above(inverse), 0.0, 1.0);
}

fn ltc_cut_ellipse(inverse: LtcInverse, points: mat3x3<f32>) -> f32 {
    let ellipse = ltc_ellipse(inverse, points);
    if (!(ellipse.cone.g > 0.0)) {
        return 0.0;
    }
    if (ellipse.is_cut) {
        var clip = ltc_clip_begin(inverse.m * ellipse.rise);
        clip = ltc_cut_border(inverse, clip, ellipse.cone, ellipse.rise, ellipse.dip);
        return ltc_cut_close(inverse, LtcCut(clip, ellipse.dip, ellipse.rise));
    }
    let covered = min(ltc_cone_covered(ellipse.cone) * ltc_per_part_above(inverse), 1.0);
    return select(0.0, covered, points[0].z > 0.0);
}

/// Like ltc_disk, but without light from below the surface.
fn ltc_cut_disk(inverse: LtcInverse, centre: vec3<f32>, half_x: vec3<f32>, half_y: vec3<f32>, two_sided: bool) -> f32 {
    if (inverse.side == 0.0 || (!two_sided && !(dot(centre, cross(half_x, half_y)) < 0.0))) {
        return 0.0;
    }
    return ltc_cut_ellipse(inverse, mat3x3(centre, half_x, half_y));
}

/// Like ltc_sphere, but without light from below the surface.
fn ltc_cut_sphere(inverse: LtcInverse, centre: vec3<f32>, radius: f32) -> f32 {
    if (inverse.side == 0.0) {
        return 0.0;
    }
    if (dot(centre, centre) <= radius * radius) {
        return 1.0;
    }
    return ltc_cut_ellipse(inverse, ltc_disk_of_sphere(centre, radius));
}

/// Like ltc_line, but without light from below the surface.
fn ltc_cut_line(inverse: LtcInverse, start: vec3<f32>, end: vec3<f32>, width: f32) -> f32 {
    if (start.z <= 0.0 && end.z <= 0.0) {
        return 0.0;
    }
    let below = min(start.z, end.z) <= 0.0;
    let crossing = (start * abs(end.z) + end * abs(start.z)) / max(abs(end.z - start.z), 1e-36);
    let from_point = select(start, crossing, below && start.z <= 0.0);
    let to_point = select(end, crossing, below && end.z <= 0.0);
    return min(ltc_line(inverse, from_point, to_point, width) * ltc_per_part_above(inverse), 1.0);
}

/// Adds the border of a tube's end from a to b, except the part below the surface.
fn ltc_cut_end(inverse: LtcInverse, cut: LtcCut, ellipse: LtcEllipse, a: vec3<f32>, b: vec3<f32>) -> LtcCut {
    var next = cut;
    if (!ellipse.is_cut) {
        if (ellipse.points[0].z > 0.0) {
            next.clip = ltc_cut_border(inverse, next.clip, ellipse.cone, a, b);
        }
        return next;
    }
    let first = ltc_turn_of(ellipse.cone, inverse.m * a);
    let all = ltc_round(first, ltc_turn_of(ellipse.cone, inverse.m * b));
    let begins_up = a.z > 0.0;
    let is_same = begins_up == (b.z > 0.0);
    let leaves = select(begins_up, ltc_round(first, ltc_turn_of(ellipse.cone, inverse.m * ellipse.dip)) < all, is_same);
    let enters = select(!begins_up, ltc_round(first, ltc_turn_of(ellipse.cone, inverse.m * ellipse.rise)) < all, is_same);
    if (leaves) {
        next.leaves = ellipse.dip;
    }
    if (enters) {
        next.enters = ellipse.rise;
    }
    if (leaves && enters && begins_up) {
        next.clip = ltc_cut_border(inverse, next.clip, ellipse.cone, a, ellipse.dip);
        next.clip = ltc_cut_border(inverse, next.clip, ellipse.cone, ellipse.rise, b);
    } else if (leaves || enters || begins_up) {
        let from_point = select(a, ellipse.rise, enters);
        let to_point = select(b, ellipse.dip, leaves);
        next.clip = ltc_cut_border(inverse, next.clip, ellipse.cone, from_point, to_point);
    }
    return next;
}

/// Like ltc_tube, but without light from below the surface.
fn ltc_cut_tube(inverse: LtcInverse, start: vec3<f32>, end: vec3<f32>, radius: f32) -> f32 {
    if (inverse.side == 0.0) {
        return 0.0;
    }
    let along = end - start;
    let axis = ltc_unit(along);
    let distance = sqrt(dot(along, along));
    let nearest = start + axis * clamp(-dot(start, axis), 0.0, distance);
    let beside = start - axis * dot(start, axis);
    let beside2 = dot(beside, beside);
    if (dot(nearest, nearest) <= radius * radius || !(distance > 0.0) || beside2 <= radius * radius) {
        return ltc_cut_sphere(inverse, nearest, radius);
    }
    let towards = beside * (radius / beside2);
    let sideways = cross(axis, beside) * (sqrt(beside2 - radius * radius) / beside2 * inverse.side);
    let left = (towards + sideways) * radius;
    let right = (towards - sideways) * radius;
    let first = start - right;
    var cut = LtcCut(ltc_clip_begin(inverse.m * first), vec3(0.0), vec3(0.0));
    cut = ltc_cut_edge(inverse, cut, first, end - right);
    cut = ltc_cut_end(inverse, cut, ltc_ellipse(inverse, ltc_disk_of_sphere(end, radius)), end - right, end - left);
    cut = ltc_cut_edge(inverse, cut, end - left, start - left);
    cut = ltc_cut_end(inverse, cut, ltc_ellipse(inverse, ltc_disk_of_sphere(start, radius)), start - left, first);
    return ltc_cut_close(inverse, cut);
}
