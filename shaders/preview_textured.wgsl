// The preview's light with a picture: shading by a table, shading by model normals, and the light as the camera sees
// it. Needs ltc_textured.wgsl, normals_textured.wgsl, textured.wgsl, light_picture.wgsl and sphere.wgsl.

/// The camera traces RAYS x RAYS rays per pixel to the light.
const RAYS: u32 = 4u;

/// The corners of the light relative to the shaded point, in its tangent frame.
fn corners_of(at: Shaded) -> array<vec3<f32>, 4> {
    let to_local = transpose(mat3x3(at.x, at.y, at.z));
    return array<vec3<f32>, 4>(
        to_local * (light.vertices[0].xyz - at.position),
        to_local * (light.vertices[1].xyz - at.position),
        to_local * (light.vertices[2].xyz - at.position),
        to_local * (light.vertices[3].xyz - at.position),
    );
}

/// The covered part of the lobe, times the mean colour of the picture in this lobe.
fn covered_picture(inverse: LtcInverse, at: Shaded) -> vec3<f32> {
    let textured = ltc_textured_rectangle(inverse, corners_of(at), light.options.y == 1u, 0u, light.radiance.w);
        // Weights may overflow, but only for matrices that no fit produces.
    let colour = select(vec3(0.0), textured.colour, textured.colour < vec3(1e30));
    if (light_is_cut) {
        return colour * covered_above(inverse, at);
    }
    return colour * textured.covered;
}

/// Radiance towards the eye, by the table.
fn shade_picture_by_table(at: Shaded) -> vec3<f32> {
    if (second_lobe == SECOND_NONE) {
        let lobe = ltc_lookup(at.alpha.x, at.alpha.y, at.wo);
        let covered = covered_picture(ltc_inverse(lobe.m), at);
        return reflected_colours(lobe.amplitude * covered, lobe.fresnel * covered, lobe.amplitude);
    }
    let lobes = ltc_lookup_both(at.alpha.x, at.alpha.y, at.wo);
    var first = lobes.first.m;
    if (second_lobe == SECOND_BLENDED) {
        first = ltc_blend(lobes, dot(scene.f0.xyz, vec3(1.0 / 3.0)), 1.0);
    }
    let covered = covered_picture(ltc_inverse(first), at);
    var of_fresnel = covered;
    if (second_lobe == SECOND_INTEGRATED) {
        of_fresnel = covered_picture(ltc_inverse(lobes.second), at);
    }
    let amplitude = lobes.first.amplitude;
    return reflected_colours(amplitude * covered, lobes.first.fresnel * of_fresnel, amplitude);
}

/// Radiance towards the eye, by model normals.
fn shade_picture_by_normals(at: Shaded) -> vec3<f32> {
    let corners = corners_of(at);
    let two_sided = light.options.y == 1u;
    let base = light.radiance.w;
    if (normals_rule == RULE_FAST) {
        let view = fast_view(at.alpha.x, at.alpha.y, at.wo);
        let fast = fast_textured_rectangle(view, corners, two_sided, 0u, base);
        return reflected_colours(fast.parts.x * fast.colour, fast.parts.y * fast.colour, albedo_of(at));
    }
    if (normals_rule == RULE_FINE) {
        let view = fine_view(at.alpha.x, at.alpha.y, at.wo);
        let fine = fine_textured_rectangle(view, corners, two_sided, 0u, base);
        return reflected_colours(fine.parts.x * fine.colour, fine.parts.y * fine.colour, albedo_of(at));
    }
    let view = balanced_view(at.alpha.x, at.alpha.y, at.wo);
    let balanced = balanced_textured_rectangle(view, corners, two_sided, 0u, base);
    return reflected_colours(balanced.parts.x * balanced.colour, balanced.parts.y * balanced.colour, albedo_of(at));
}

@compute @workgroup_size(8, 8)
fn picture_by_table(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_id) local: vec3<u32>) {
    let pixel = pixel_of(group, local);
    if (any(pixel >= vec2(scene.options.x))) {
        return;
    }
    let place = place_of(pixel);
    let hit = hit_at(place);
    var shaded = vec3(0.0);
    if (hit.coverage > 0.0) {
        shaded = shade_picture_by_table(hit.at);
    }
    write(pixel, composed(place, hit, shaded, 1.0));
}

@compute @workgroup_size(8, 8)
fn picture_by_normals(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_id) local: vec3<u32>) {
    let pixel = pixel_of(group, local);
    if (any(pixel >= vec2(scene.options.x))) {
        return;
    }
    let place = place_of(pixel);
    let hit = hit_at(place);
    var shaded = vec3(0.0);
    if (hit.coverage > 0.0) {
        shaded = shade_picture_by_normals(hit.at);
    }
    write(pixel, composed(place, hit, shaded, 1.0));
}

/// A share of a pixel's radiance: the background, then the surface in front of it, then the visible part of the light.
fn composed(place: vec3<f32>, hit: Hit, shaded: vec3<f32>, share: f32) -> vec3<f32> {
    let radiance = mix(share * scene.background.xyz, shaded, hit.coverage);
    if (light_has_picture) {
        let light_hit = light_in(place, select(1e30, hit.distance, hit.coverage > 0.0));
        return (1.0 - light_hit.w) * radiance + share * light_hit.xyz;
    }
    return radiance;
}

/// The light as the camera sees it: radiance times coverage (xyz), and coverage (w). Only parts nearer than `behind`
/// count. The back of the light is black.
fn light_in(place: vec3<f32>, behind: f32) -> vec4<f32> {
    let pixel = 2.0 / f32(scene.options.x / scene.options.y);
    var sum = vec4(0.0);
    for (var i = 0u; i < RAYS * RAYS; i++) {
        let at = place.xy + pixel * ((vec2(f32(i % RAYS), f32(i / RAYS)) + 0.5) / f32(RAYS) - 0.5);
        let ray = normalize(scene.forward.xyz + scene.right.xyz * at.x + scene.up.xyz * at.y);
        let met = light_met(scene.eye.xyz, ray);
        let is_met = met.z > 0.0 && met.z < behind && all(met.xy >= vec2(0.0)) && all(met.xy <= vec2(1.0));
        let emits = light_faces(dot(light.normal.xyz, ray));
        let colour = select(vec3(0.0), light.radiance.x * light_texel(met.xy), emits);
        sum += select(vec4(0.0), vec4(colour, 1.0), is_met);
    }
    return sum / f32(RAYS * RAYS);
}
