/// The reflection of a light with a picture: the two parts as in normals_rectangle, and the mean colour of the picture.
struct NormalsTextured {
    parts: vec2<f32>,
    colour: vec3<f32>,
}

/// The height of a point above the plane that bounds the lobe, which is the surface.
fn normals_height(view: NormalsView, p: vec3<f32>) -> f32 {
    return p.z;
}

/// The lobe on the light's plane, divided by a bump with quadratic form Q, up to a factor.
fn normals_share(view: NormalsView, p: vec3<f32>, quadratic: f32) -> f32 {
    let r = sqrt(dot(p, p));
    let c = view.image * r + p * vec3(view.per_alpha, 1.0);
    let ratio = max(r + dot(view.wo, p), 1e-6 * r) / max(dot(c, c), 1e-30);
    let stretched = vec3(view.alpha * p.xy, p.z);
    let z = max(p.z, 0.0);
    let shadowed = view.length * z + view.wo.z * sqrt(dot(stretched, stretched));
    let fall = (1.0 + quadratic) * ratio;
    return fall * fall * (z + 1e-6 * shadowed) / max(r * shadowed, 1e-30);
}

/// The bump closest to the lobe. On the light's plane, q = |c|^2 sqrt(r) / (r + wo . P) is nearly quadratic. The bump
/// is the expansion of q around the point of the light that the mean normal A c reflects to the viewer.
fn normals_bump(view: NormalsView, frame: NormalsFrame, flux: vec3<f32>) -> NormalsBump {
    let h = vec3(view.alpha * flux.xy, flux.z);
    let wi = 2.0 * dot(view.wo, h) * h - dot(h, h) * view.wo;
    let normal = cross(frame.x, frame.y);
    let distance = dot(frame.corner, normal);
    let facing = select(1.0, -1.0, distance < 0.0);
    let descent = max(max(facing * dot(wi, normal), 1e-4 * dot(h, h)), 1e-30);
    let hit = (facing * distance / descent) * wi - frame.corner;
    let at = clamp(vec2(dot(frame.x, hit), dot(frame.y, hit)), vec2(0.0), frame.size);

    let p = frame.corner + at.x * frame.x + at.y * frame.y;
    let per_r = inverseSqrt(max(dot(p, p), 1e-30));
    let r = dot(p, p) * per_r;
    let c = view.image * r + p * vec3(view.per_alpha, 1.0);
    let per_n = 1.0 / max(dot(c, c), 1e-30);
    let per_e = 1.0 / max(r + dot(view.wo, p), 1e-6 * r);
    // Derivatives of r, c, ln |c|^2 and ln (r + wo . P) along the sides of the light.
    let dr = per_r * vec2(dot(p, frame.x), dot(p, frame.y));
    let cx = view.image * dr.x + frame.x * vec3(view.per_alpha, 1.0);
    let cy = view.image * dr.y + frame.y * vec3(view.per_alpha, 1.0);
    let n = 2.0 * per_n * vec2(dot(c, cx), dot(c, cy));
    let e = per_e * (dr + vec2(dot(view.wo, frame.x), dot(view.wo, frame.y)));
    let gradient = n + 0.5 * per_r * dr - e;
    let bend = per_r * (2.0 * per_n * dot(c, view.image) + 0.5 * per_r - per_e);
    let bent = bend + 0.5 * per_r * per_r;
    let second = 2.0 * per_n * vec3(dot(cx, cx), dot(cx, cy), dot(cy, cy)) + vec3(bend, 0.0, bend) + normals_square(e)
        + normals_square(gradient) - normals_square(n) - bent * normals_square(dr);

    let eigen = normals_eigen(second);
    let w = max(eigen.xy, vec2(0.1 / (frame.size.x * frame.size.y)));
    let axis = eigen.zw;
    let g = vec2(dot(gradient, axis), gradient.y * axis.x - gradient.x * axis.y);
    let shift = g / w;
    let twice = 2.0 * max(1.0 - 0.5 * dot(g, shift), 0.1);
    return NormalsBump(at - shift.x * axis - shift.y * vec2(-axis.y, axis.x), axis, twice / w);
}

/// xx, xy and yy of the outer product of a vector with itself.
fn normals_square(v: vec2<f32>) -> vec3<f32> {
    return vec3(v.x * v.x, v.x * v.y, v.y * v.y);
}

/// A rectangle with a picture or a lamp's profile: the two parts of the whole light, and the mean reflected colour.
fn normals_shown_rectangle(
    view: NormalsView,
    corners: array<vec3<f32>, 4>,
    two_sided: bool,
    picture: u32,
    base: f32,
    is_profile: bool,
) -> NormalsTextured {
    let lit = normals_rectangle_lit(view, corners, two_sided);
    if (lit.light.x <= 0.0) {
        return NormalsTextured(vec2(0.0), vec3(0.0));
    }
    let frame = normals_frame(corners);
    let colour = normals_colour(view, frame, normals_bump(view, frame, lit.flux), picture, base, is_profile);
    return NormalsTextured(lit.light, colour);
}

/// A rectangle with a picture.
fn normals_textured_rectangle(
    view: NormalsView,
    corners: array<vec3<f32>, 4>,
    two_sided: bool,
    picture: u32,
    base: f32,
) -> NormalsTextured {
    return normals_shown_rectangle(view, corners, two_sided, picture, base, false);
}

/// A lamp with an IES profile, stored as 512 x 512 texels.
fn normals_profile_rectangle(
    view: NormalsView,
    corners: array<vec3<f32>, 4>,
    two_sided: bool,
    picture: u32,
) -> NormalsTextured {
    return normals_shown_rectangle(view, corners, two_sided, picture, 8.0, true);
}
