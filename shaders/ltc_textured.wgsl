/// The result for a light with a picture: the covered part of the lobe, and the picture's mean colour in the lobe.
struct LtcTextured {
    covered: f32,
    colour: vec3<f32>,
}

/// The height of a point above the plane that bounds the lobe, which is the horizon of the cosine.
fn ltc_height(inverse: LtcInverse, p: vec3<f32>) -> f32 {
    return (inverse.m * p).z;
}

/// The lobe on the light's plane, divided by its bump. The bump is exact, so only the height in cosine space remains.
fn ltc_share(inverse: LtcInverse, p: vec3<f32>, quadratic: f32) -> f32 {
    let v = inverse.m * p;
    return max(v.z, 0.0) + 1e-6 * sqrt(max(dot(v, v), 1e-30));
}

/// The bump |M^-1 P|^-4 of the lobe on a plane. Its middle is the foot of the perpendicular in cosine space. Lower
/// bounds on the axes keep all numbers in range.
fn ltc_bump(inverse: LtcInverse, frame: LtcFrame) -> LtcBump {
    let x = inverse.m * frame.x;
    let y = inverse.m * frame.y;
    let corner = inverse.m * frame.corner;
    let eigen = ltc_eigen(vec3(dot(x, x), dot(x, y), dot(y, y)));
    let least = max(1e-7 * eigen.y, 1e-8 * dot(corner, corner) / (frame.size.x * frame.size.y));
    let w = max(eigen.xy, vec2(max(least, 1e-30)));
    let axis = eigen.zw;
    let fall = vec2(-dot(corner, x), -dot(corner, y));
    let shift = vec2(dot(fall, axis), fall.y * axis.x - fall.x * axis.y) / w;
    let middle = shift.x * axis + shift.y * vec2(-axis.y, axis.x);
    let foot = corner + middle.x * x + middle.y * y;
    return LtcBump(middle, axis, max(dot(foot, foot), 1e-30) / w);
}

/// The covered part of the lobe, as in ltc_rectangle, and the mean colour of a picture or of a lamp's profile.
fn ltc_shown_rectangle(
    inverse: LtcInverse,
    corners: array<vec3<f32>, 4>,
    two_sided: bool,
    picture: u32,
    base: f32,
    is_profile: bool,
) -> LtcTextured {
    let covered = ltc_rectangle(inverse, corners, two_sided);
    if (covered <= 0.0) {
        return LtcTextured(0.0, vec3(0.0));
    }
    let frame = ltc_frame(corners);
    return LtcTextured(covered, ltc_colour(inverse, frame, ltc_bump(inverse, frame), picture, base, is_profile));
}

/// ltc_shown_rectangle for a picture.
fn ltc_textured_rectangle(
    inverse: LtcInverse,
    corners: array<vec3<f32>, 4>,
    two_sided: bool,
    picture: u32,
    base: f32,
) -> LtcTextured {
    return ltc_shown_rectangle(inverse, corners, two_sided, picture, base, false);
}

/// ltc_shown_rectangle for the IES profile of a lamp, stored as 512 x 512 texels.
fn ltc_profile_rectangle(
    inverse: LtcInverse,
    corners: array<vec3<f32>, 4>,
    two_sided: bool,
    picture: u32,
) -> LtcTextured {
    return ltc_shown_rectangle(inverse, corners, two_sided, picture, 8.0, true);
}
