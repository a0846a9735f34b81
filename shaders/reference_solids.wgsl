// Spheres, tubes and lines in the preview: sampling for the reference, and polygons that face the shaded point. Light
// models that support only polygons use these polygons. Needs ltc_math.wgsl, ltc_light.wgsl and ggx_reference.wgsl.
//
// Struct Light stores the ends of these lights in centre.xyz and half_axes[0].xyz, and the radius or width in centre.w.
// Both ends of a sphere are equal.

/// Two unit vectors perpendicular to a unit vector and to each other.
fn solid_basis(axis: vec3<f32>) -> mat2x3<f32> {
    let is_upright = abs(axis.z) > 0.7;
    let x = normalize(cross(select(vec3(0.0, 0.0, 1.0), vec3(1.0, 0.0, 0.0), is_upright), axis));
    return mat2x3(x, cross(axis, x));
}

/// The point nearest to the shaded point on the segment between both ends, relative to the shaded point.
fn solid_nearest(position: vec3<f32>) -> vec3<f32> {
    let start = light.centre.xyz - position;
    let along = light.half_axes[0].xyz - light.centre.xyz;
    return start + along * clamp(-dot(start, along) / max(dot(along, along), 1e-36), 0.0, 1.0);
}

/// The distance to a tube along wi (x), and the cosine between its outward normal and -wi (y). x is negative if the ray
/// misses the tube. Domain: the shaded point is outside.
fn tube_hit(position: vec3<f32>, wi: vec3<f32>) -> vec2<f32> {
    let radius = light.centre.w;
    let along = light.half_axes[0].xyz - light.centre.xyz;
    let from_start = position - light.centre.xyz;
    var found = vec2(-1.0, 0.0);
    // Intersect the spheres at both ends. The nearest hit of all parts counts.
    for (var i = 0u; i < 2u; i++) {
        let from_end = select(from_start, from_start - along, i == 1u);
        let away = -dot(wi, from_end);
        let beside = from_end + wi * away;
        let height2 = radius * radius - dot(beside, beside);
        let distance = away - sqrt(max(height2, 0.0));
        if (height2 > 0.0 && distance > 0.0 && (found.x < 0.0 || distance < found.x)) {
            found = vec2(distance, sqrt(height2) / radius);
        }
    }
    // Intersect the cylinder between them. The distance between the ray and the axis keeps the digits of thin tubes.
    let normal = cross(wi, along);
    let sine2 = dot(normal, normal);
    let apart = dot(from_start, normal);
    let height2 = radius * radius * sine2 - apart * apart;
    if (sine2 > 1e-12 * dot(along, along) && height2 > 0.0) {
        let length2 = dot(along, along);
        let forth = length2 * dot(wi, from_start) - dot(from_start, along) * dot(wi, along);
        let distance = -(forth + sqrt(height2 * length2)) / sine2;
        let share = dot(from_start + wi * distance, along) / length2;
        if (distance > 0.0 && share > 0.0 && share < 1.0 && (found.x < 0.0 || distance < found.x)) {
            let outwards = from_start + wi * distance - along * share;
            found = vec2(distance, max(-dot(outwards, wi) / radius, 0.0));
        }
    }
    return found;
}

/// The area of a tube (x), and the cylinder's share of this area (y).
fn tube_area(along: vec3<f32>, radius: f32) -> vec2<f32> {
    let distance = sqrt(dot(along, along));
    let area = 6.2831853 * radius * (distance + 2.0 * radius);
    return vec2(area, distance / (distance + 2.0 * radius));
}

/// The density of solid_sample, as in light_pdf. Zero if the shaded point is inside the light. A line is too thin to
/// hit.
fn solid_pdf(position: vec3<f32>, wi: vec3<f32>) -> f32 {
    if (light_shape == LIGHT_LINE) {
        return -1.0;
    }
    let radius = light.centre.w;
    let nearest = solid_nearest(position);
    let distance2 = dot(nearest, nearest);
    if (distance2 <= radius * radius) {
        return 0.0;
    }
    let along = light.half_axes[0].xyz - light.centre.xyz;
    if (dot(along, along) == 0.0) {
        let beside = cross(wi, nearest);
        let is_hit = dot(beside, beside) < radius * radius && dot(wi, nearest) > 0.0;
        return select(-1.0, 0.15915494 / sphere_cap(radius * radius / distance2), is_hit);
    }
    let hit = tube_hit(position, wi);
    let density = hit.x * hit.x / (tube_area(along, radius).x * max(hit.y, 1e-6));
    return select(-1.0, density, hit.x > 0.0);
}

/// One minus the cosine of a cap's half angle, from the square of its sine.
fn sphere_cap(sine2: f32) -> f32 {
    return sine2 / (1.0 + sqrt(max(1.0 - sine2, 0.0)));
}

/// Samples a direction towards the light, with its density, as in light_sample. It samples the cone of a sphere, the
/// surface of a tube or the angle along a line.
fn solid_sample(position: vec3<f32>, u: vec2<f32>) -> vec4<f32> {
    let start = light.centre.xyz - position;
    let end = light.half_axes[0].xyz - position;
    let along = end - start;
    let size = light.centre.w;
    if (light_shape == LIGHT_LINE) {
        let normal = cross(start, end);
        let area = sqrt(dot(normal, normal));
        let angle = ltc_atan2(area, dot(start, end));
        let towards = normalize(start);
        let turn = ltc_sin_cos(u.x * angle * 0.15915494);
        let direction = towards * turn.y + cross(normal / max(area, 1e-18), towards) * turn.x;
        // The distance to the line along `direction` is the distance to the line's nearest point, divided by the cosine
        // of the angle between `direction` and `nearest`.
        let own = area / sqrt(dot(along, along));
        let nearest = normalize(cross(along, normal));
        let distance = own / max(dot(direction, nearest), 1e-18);
        return vec4(direction, select(0.0, distance / (size * max(angle, 1e-18)), area > 0.0 && size > 0.0));
    }
    let nearest = solid_nearest(position);
    let distance2 = dot(nearest, nearest);
    if (distance2 <= size * size) {
        return vec4(0.0);
    }
    if (dot(along, along) == 0.0) {
        let cap = sphere_cap(size * size / distance2);
        let towards = nearest / sqrt(distance2);
        let turn = ltc_sin_cos(u.y) * sqrt(max(u.x * cap * (2.0 - u.x * cap), 0.0));
        let direction = solid_basis(towards) * turn.yx + towards * (1.0 - u.x * cap);
        return vec4(direction, 0.15915494 / cap);
    }
    let axis = normalize(along);
    let area = tube_area(along, size);
    let turn = ltc_sin_cos(u.y);
    let around = solid_basis(axis) * turn.yx;
    var outwards = around;
    var place = start + along * (u.x / area.y);
    if (u.x >= area.y) {
        let height = 1.0 - 2.0 * (u.x - area.y) / (1.0 - area.y);
        outwards = axis * height + around * sqrt(max(1.0 - height * height, 0.0));
        place = select(start, end, height > 0.0);
    }
    place += outwards * size;
    let away2 = dot(place, place);
    let direction = place / sqrt(away2);
    let facing = -dot(outwards, direction);
    return vec4(direction, select(0.0, away2 / (area.x * max(facing, 1e-6)), facing > 0.0));
}

/// The polygon that replaces the light in models that support only polygons, relative to the shaded point. For a line,
/// it has the four corners of a strip. Otherwise, it is an octagon with the area of the light's outline. If the shaded
/// point is inside the light, the polygon covers the whole sky.
fn solid_outline(position: vec3<f32>, up: vec3<f32>) -> array<vec3<f32>, 8> {
    let start = light.centre.xyz - position;
    let end = light.half_axes[0].xyz - position;
    let along = end - start;
    let size = light.centre.w;
    if (light_shape == LIGHT_LINE) {
        let across = ltc_unit(cross(start, end)) * (0.5 * size);
        let a = start - across;
        let b = start + across;
        return array<vec3<f32>, 8>(a, b, end + across, end - across, a, a, a, a);
    }
    var nearest = solid_nearest(position);
    var radius = size;
    let beside = start - along * (dot(start, along) / max(dot(along, along), 1e-36));
    let beside2 = dot(beside, beside);
    let is_inside = dot(nearest, nearest) <= size * size;
    if (is_inside) {
        nearest = up;
        radius = 0.999;
    }
    if (is_inside || dot(along, along) == 0.0 || beside2 <= size * size) {
        // sqrt(pi / (4 sin(pi / 4))) is the radius of an octagon with the area of a unit disk.
        let sine2 = radius * radius / dot(nearest, nearest);
        let basis = solid_basis(ltc_unit(nearest)) * (radius * sqrt(1.0 - sine2) * 1.0539074);
        var octagon: array<vec3<f32>, 8>;
        for (var i = 0u; i < 8u; i++) {
            octagon[i] = nearest * (1.0 - sine2) + basis * ltc_sin_cos((0.5 - f32(i)) * 0.125).yx;
        }
        return octagon;
    }
    let sideways = normalize(cross(along, beside));
    let at_start = tube_end(start, -along, beside, sideways, size);
    let at_end = tube_end(end, along, beside, -sideways, size);
    return array<vec3<f32>, 8>(
        at_start[0], at_start[1], at_start[2], at_start[3], at_end[0], at_end[1], at_end[2], at_end[3]);
}

/// The outline of one end of a tube, between the two planes that touch both spheres: two points of the sphere's
/// outline, and between them two points moved outwards to keep the area.
fn tube_end(end: vec3<f32>, outwards: vec3<f32>, beside: vec3<f32>, sideways: vec3<f32>, size: f32) -> array<vec3<f32>, 4> {
    let sine2 = size * size / dot(end, end);
    let centre = end * (1.0 - sine2);
    let radius = size * sqrt(max(1.0 - sine2, 0.0));
    let ahead = ltc_unit(outwards - end * (dot(outwards, end) / dot(end, end)));
    let beside2 = dot(beside, beside);
    let touched = -(beside * (size / beside2) - sideways * (sqrt(beside2 - size * size) / sqrt(beside2))) * size;
    // The angle from the middle of the arc to its end.
    let to_end = end + touched - centre;
    let half_arc = ltc_atan2(max(dot(to_end, sideways), 0.0), dot(to_end, ahead));
    let turn = ltc_sin_cos(half_arc * 0.053051648);
    let sine = 2.0 * turn.x * turn.y;
    let out = select(1.0, sqrt(1.0 + 2.0 * half_arc / max(sine, 1e-6)) - 1.0, half_arc > 1e-3);
    let cos_end = dot(to_end, ahead);
    let sin_end = dot(to_end, sideways);
    return array<vec3<f32>, 4>(
        centre + ahead * cos_end + sideways * sin_end,
        centre + (ahead * turn.y + sideways * turn.x) * (radius * out),
        centre + (ahead * turn.y - sideways * turn.x) * (radius * out),
        centre + ahead * cos_end - sideways * sin_end,
    );
}
