// The preview's shading by a table whose lobes end at the surface. Needs ltc_cut.wgsl, ltc_cut_shapes.wgsl,
// ggx_reference.wgsl.

/// The fraction of the lobe above the surface that the light covers.
fn covered_above(inverse: LtcInverse, at: Shaded) -> f32 {
    let two_sided = light.options.y == 1u;
    let to_local = transpose(mat3x3(at.x, at.y, at.z));
    if (light_shape == LIGHT_POLYGON) {
        var previous = to_local * (light.vertices[light.options.x - 1u].xyz - at.position);
        var cut = LtcCut(ltc_clip_begin(inverse.m * previous), vec3(0.0), vec3(0.0));
        for (var i = 0u; i < light.options.x; i++) {
            let vertex = to_local * (light.vertices[i].xyz - at.position);
            cut = ltc_cut_edge(inverse, cut, previous, vertex);
            previous = vertex;
        }
        return ltc_cut_finish(inverse, cut, two_sided);
    }
    let start = to_local * (light.centre.xyz - at.position);
    if (light_shape == LIGHT_ELLIPSE) {
        return ltc_cut_disk(inverse, start, to_local * light.half_axes[0].xyz, to_local * light.half_axes[1].xyz, two_sided);
    }
    let end = to_local * (light.half_axes[0].xyz - at.position);
    if (light_shape == LIGHT_LINE) {
        return ltc_cut_line(inverse, start, end, light.centre.w);
    }
    return ltc_cut_tube(inverse, start, end, light.centre.w);
}
