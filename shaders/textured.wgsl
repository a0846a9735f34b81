/// The number of readings (texture samples) of a light's picture: 1, 2, 4 or 6.
const TEXTURED_READINGS: u32 = 4u;

/// The pictures of all lights, one per layer, with all prefiltered levels. The sampler is linear between texels and
/// between levels, and clamps to the edge.
@group(0) @binding(0) var textured_pictures: texture_2d_array<f32>;
@group(0) @binding(1) var textured_picture_sampler: sampler;

/// A rectangle: its first corner, the unit directions of its sides, and their lengths.
struct TexturedFrame {
    corner: vec3<f32>,
    x: vec3<f32>,
    y: vec3<f32>,
    size: vec2<f32>,
}

/// The bump (1 + Q)^-2 on a rectangle. Q is 1 at the distance sqrt(radii2.x) along the longer axis, and at
/// sqrt(radii2.y) across this axis.
struct TexturedBump {
    middle: vec2<f32>,
    axis: vec2<f32>,
    radii2: vec2<f32>,
}

fn textured_frame(corners: array<vec3<f32>, 4>) -> TexturedFrame {
    let x = corners[1] - corners[0];
    let y = corners[3] - corners[0];
    let size = max(vec2(length(x), length(y)), vec2(1e-15));
    return TexturedFrame(corners[0], x / size.x, y / size.y, size);
}

/// The smaller and the larger eigenvalue of a symmetric matrix given as xx, xy, yy, and the eigenvector of the smaller
/// eigenvalue (zw).
fn textured_eigen(m: vec3<f32>) -> vec4<f32> {
    let mean = 0.5 * (m.x + m.z);
    let apart = 0.5 * (m.x - m.z);
    let distance = sqrt(apart * apart + m.y * m.y);
    let v = select(vec2(distance - apart, -m.y), vec2(-m.y, apart + distance), apart > 0.0);
    let length2 = dot(v, v);
    let axis = select(vec2(1.0, 0.0), v * inverseSqrt(max(length2, 1e-30)), length2 > 1e-30);
    return vec4(mean - distance, mean + distance, axis);
}

/// The quadratic form Q of a bump at the offset d from its middle.
fn textured_quadratic(bump: TexturedBump, d: vec2<f32>) -> f32 {
    let q = vec2(dot(d, bump.axis), d.y * bump.axis.x - d.x * bump.axis.y);
    return q.x * q.x / bump.radii2.x + q.y * q.y / bump.radii2.y;
}

/// The coordinates (xy) at which to read a lamp's profile for point p of the light. The squared radius of this reading,
/// divided by the profile's area (z). The coordinates of a profile are the tangents of the direction to the
/// shaded point, from -4 to 4. The blur is at most the blur of a square with the light's area.
fn textured_profile(frame: TexturedFrame, p: vec2<f32>, radius2: f32) -> vec3<f32> {
    let area = frame.size.x * frame.size.y;
    let distance = abs(dot(frame.corner, cross(frame.x, frame.y)));
    let per_span = 0.125 / max(distance, 1e-6 * (frame.size.x + frame.size.y));
    let foot = -vec2(dot(frame.corner, frame.x), dot(frame.corner, frame.y));
    let narrower = radius2 * (area / (area + 12.0 * radius2));
    return vec3(0.5 + per_span * (foot - p), per_span * per_span * narrower);
}

/// The mean colour of a picture or of a lamp's profile, weighted by the lobe. Readings are along the longer axis of the
/// bump, within the rectangle and above the plane that bounds the lobe. picture is the layer. base is log2(sqrt(width
/// height)) - 1 for the size of the first level.
fn textured_colour(
    lobe: TexturedLobe,
    frame: TexturedFrame,
    bump: TexturedBump,
    picture: u32,
    base: f32,
    is_profile: bool,
) -> vec3<f32> {
    let unit = sqrt(max(bump.radii2.x - bump.radii2.y, 1e-12 * bump.radii2.x));
    let along = bump.axis * unit;
    // height + t rise is the height along the axis. It must not be negative.
    let middle = frame.corner + bump.middle.x * frame.x + bump.middle.y * frame.y;
    let height = textured_height(lobe, middle);
    let rise = textured_height(lobe, along.x * frame.x + along.y * frame.y);
    let per_slope = 1.0 / select(along, vec2(1e-15), abs(along) < vec2(1e-15));
    let halves = 0.5 * frame.size;
    let centre = (halves - bump.middle) * per_slope;
    let reach = halves * abs(per_slope);
    let border = -height / select(rise, 1e-15, abs(rise) < 1e-15);
    let low = max(max(centre.x - reach.x, centre.y - reach.y), select(border, -1e4, rise < 0.0));
    let high = min(min(centre.x + reach.x, centre.y + reach.y), select(1e4, border, rise < 0.0));
    var t = clamp(vec2(low, high), vec2(-1e4), vec2(1e4));
    t = select(t, vec2(0.5 * (t.x + t.y)), t.x > t.y);
    let s = t * inverseSqrt(1.0 + t * t);
    let part = (s.y - s.x) / f32(TEXTURED_READINGS);
    let spread = select(0.9025, 1.5625, TEXTURED_READINGS == 1u);
    let per_area = 1.0 / (frame.size.x * frame.size.y);
    var sum = vec4(0.0);
    for (var i = 0u; i < TEXTURED_READINGS; i++) {
        let at = s.x + part * (f32(i) + 0.5);
        let reach = clamp(at * inverseSqrt(max(1.0 - at * at, 1e-12)), t.x, t.y);
        let stretch2 = 1.0 + reach * reach;
        let gap = 0.35 * unit * min(part * stretch2 * sqrt(stretch2), t.y - t.x);
        let wanted = bump.middle + reach * along;
        let p = clamp(wanted, vec2(0.0), frame.size);
        let moved = wanted - p;
        let radius2 = spread * (bump.radii2.y * stretch2 + gap * gap) + dot(moved, moved);
        var place = vec3(p / frame.size, radius2 * per_area);
        if (is_profile) {
            place = textured_profile(frame, p, radius2);
        }
        let level = base + 0.5 * log2(place.z);
        let quadratic = textured_quadratic(bump, p - bump.middle);
        let weight = textured_share(lobe, frame.corner + p.x * frame.x + p.y * frame.y, quadratic);
        let read = textureSampleLevel(textured_pictures, textured_picture_sampler, place.xy, picture, level);
        sum += weight * vec4(read.xyz, 1.0);
    }
    return sum.xyz / sum.w;
}
