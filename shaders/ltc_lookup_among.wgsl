// Reads tables of isotropic surfaces with ltc_lookup.wgsl, in a shader that reads several layouts. Needs
// ltc_lookup.wgsl and layout_isotropic.wgsl.

/// Finds the place from coordinates in which the nodes of alpha and theta are evenly spaced.
fn ltc_place_round(steps: vec2<f32>) -> LtcPlace {
    return ltc_place(vec4(steps.x, ltc_table.start.y, steps.y, ltc_table.start.w));
}

/// The numbers of a matrix that is symmetric about the plane of incidence.
fn ltc_plane_of(stored: LtcLobe) -> LtcPlane {
    let m = stored.m;
    return LtcPlane(m[0].xz, m[1].y, m[2].xz);
}

/// The lobe with the matrix `plane` and the terms of `stored`.
fn ltc_lobe_of(plane: LtcPlane, stored: LtcLobe) -> LtcLobe {
    let m = mat3x3(vec3(plane.x.x, 0.0, plane.x.y), vec3(0.0, plane.y, 0.0), vec3(plane.z.x, 0.0, plane.z.y));
    return LtcLobe(m, stored.amplitude, stored.fresnel);
}
