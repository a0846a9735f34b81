/// What an LTC covers of a light with a picture, and the picture's colour.
struct LtcTextured {
    covered: f32,
    colour: vec3<f32>,
}

/// How high a point is above where the light ends, the horizon of the cosine.
fn ltc_height(inverse: LtcInverse, p: vec3<f32>) -> f32 {
    return (inverse.m * p).z;
}

/// The lobe on a light's plane, up to a factor.
fn ltc_density(inverse: LtcInverse, p: vec3<f32>) -> f32 {
    let v = inverse.m * p;
    let per_length = inverseSqrt(max(dot(v, v), 1e-30));
    return (max(v.z, 0.0) * per_length + 1e-6) * (per_length * per_length) * per_length;
}

/// The bump |M^-1 P|^-4, which a lobe is on a plane: its middle is the foot of the perpendicular.
fn ltc_bump(inverse: LtcInverse, frame: LtcFrame) -> LtcBump {
    let x = inverse.m * frame.x;
    let y = inverse.m * frame.y;
    let corner = inverse.m * frame.corner;
    let eigen = ltc_eigen(vec3(dot(x, x), dot(x, y), dot(y, y)));
    let w = max(eigen.xy, vec2(1e-30));
    let axis = eigen.zw;
    let fall = vec2(-dot(corner, x), -dot(corner, y));
    let shift = vec2(dot(fall, axis), fall.y * axis.x - fall.x * axis.y) / w;
    let middle = shift.x * axis + shift.y * vec2(-axis.y, axis.x);
    let foot = corner + middle.x * x + middle.y * y;
    return LtcBump(middle, axis, max(dot(foot, foot), 1e-30) / w);
}

/// A rectangle with a picture: what the lobe covers, as ltc_rectangle has it, and the colour of what it reflects.
fn ltc_textured_rectangle(
    inverse: LtcInverse,
    corners: array<vec3<f32>, 4>,
    two_sided: bool,
    picture: u32,
    base: f32,
) -> LtcTextured {
    let covered = ltc_rectangle(inverse, corners, two_sided);
    if (covered <= 0.0) {
        return LtcTextured(0.0, vec3(0.0));
    }
    let frame = ltc_frame(corners);
    return LtcTextured(covered, ltc_colour(inverse, frame, ltc_bump(inverse, frame), picture, base));
}
