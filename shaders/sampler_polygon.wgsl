// Draws directions to polygons.

/// A polygon as seen from a point, ready to draw directions.
struct SamplerPolygon {
    map: SamplerMap,
    /// The corners of the part above the surface, in the space of the map, of unit length. The first is the highest.
    corners: array<vec3<f32>, 9>,
    /// Half of the solid angles of the triangles between the first corner and an edge.
    halves: array<f32, 7>,
    total: f32,
    /// The density at a direction p is scale / |to p|^3.
    scale: f32,
}

/// The part of a polygon above the surface: the highest corner, and the positions of the others relative to it.
struct SamplerOutline {
    highest: vec3<f32>,
    corners: array<vec3<f32>, 9>,
    count: u32,
}

fn sampler_outline(vertices: ptr<function, array<vec3<f32>, 8>>, count: u32, two_sided: bool) -> SamplerOutline {
    let number = clamp(count, 3u, 8u);
    var top = 0u;
    for (var i = 0u; i < 8u; i++) {
        if (i < number && (*vertices)[i].z > (*vertices)[top].z) {
            top = i;
        }
    }
    let highest = (*vertices)[top];
    var outline: SamplerOutline;
    outline.highest = highest;
    outline.count = 1u;
    var facing = 0.0;
    var a = highest;
    for (var i = 1u; i < 9u; i++) {
        if (i <= number) {
            let b = (*vertices)[(top + i) % number];
            facing += dot(highest, cross(a - highest, b - highest));
            if ((a.z > 0.0) != (b.z > 0.0)) {
                // The point where the edge crosses the surface.
                let t = a.z / (a.z - b.z);
                outline.corners[min(outline.count, 8u)] = (a - highest) + t * (b - a);
                outline.count += 1u;
            }
            if (b.z > 0.0 && i < number) {
                outline.corners[min(outline.count, 8u)] = b - highest;
                outline.count += 1u;
            }
            a = b;
        }
    }
    if (highest.z <= 0.0 || (!two_sided && facing <= 0.0)) {
        outline.count = 0u;
    }
    return outline;
}

fn sampler_begin_polygon(map: SamplerMap, outline: SamplerOutline) -> SamplerPolygon {
    var light: SamplerPolygon;
    light.map = map;
    let highest = map.to * outline.highest;
    let g = sampler_unit(highest);
    light.corners[0] = g;
    let per_volume = map.det * inverseSqrt(dot(highest, highest) + 1e-36);
    var before = vec3(0.0);
    var a = g;
    var per_a = 0.0;
    for (var i = 1u; i < 9u; i++) {
        if (i < outline.count) {
            let b = highest + map.to * outline.corners[i];
            let per_b = inverseSqrt(dot(b, b) + 1e-36);
            light.corners[i] = b * per_b;
            if (i > 1u) {
                let volume = dot(cross(before, outline.corners[i]), outline.highest) * per_volume * per_a * per_b;
                let half_angle = sampler_half(g, a, b * per_b, volume);
                light.halves[i - 2u] = half_angle;
                light.total += half_angle;
            }
            before = outline.corners[i];
            a = b * per_b;
            per_a = per_b;
        }
    }
    light.scale = select(0.0, 0.5 * map.det / light.total, light.total > 0.0);
    return light;
}

/// The sampler of a convex polygon with 3 to 8 vertices for GGX, as sampler_normals.
fn sampler_normals_polygon(alpha_x: f32, alpha_y: f32, wo: vec3<f32>, vertices: ptr<function, array<vec3<f32>, 8>>, count: u32, two_sided: bool) -> SamplerPolygon {
    let alpha = max(vec2(alpha_x, alpha_y), vec2(1e-5));
    let outline = sampler_outline(vertices, count, two_sided);
    let to = sampler_lobe(alpha, wo).to;
    let highest = to * outline.highest;
    let g = sampler_unit(highest);
    var flux = vec3(0.0);
    var sum = g;
    var a = g;
    for (var i = 1u; i < 9u; i++) {
        if (i < outline.count) {
            let b = sampler_unit(highest + to * outline.corners[i]);
            flux += sampler_arc(a, b);
            sum += b;
            a = b;
        }
    }
    return sampler_begin_polygon(sampler_about(alpha, wo, flux + sampler_arc(a, g), sum), outline);
}

/// The same for the flux of normals_polygon_lit. It costs less.
fn sampler_normals_about_polygon(alpha_x: f32, alpha_y: f32, wo: vec3<f32>, flux: vec3<f32>, vertices: ptr<function, array<vec3<f32>, 8>>, count: u32, two_sided: bool) -> SamplerPolygon {
    let alpha = max(vec2(alpha_x, alpha_y), vec2(1e-5));
    let outline = sampler_outline(vertices, count, two_sided);
    return sampler_begin_polygon(sampler_about_mean(alpha, wo, flux, outline.highest), outline);
}

/// The sampler of a convex polygon with 3 to 8 vertices for an LTC, as sampler_ltc.
fn sampler_ltc_polygon(m: mat3x3<f32>, vertices: ptr<function, array<vec3<f32>, 8>>, count: u32, two_sided: bool) -> SamplerPolygon {
    return sampler_begin_polygon(sampler_ltc_map(m), sampler_outline(vertices, count, two_sided));
}

/// A direction to the light, for two random numbers in [0, 1).
fn sampler_draw_polygon(light: SamplerPolygon, u: vec2<f32>) -> SamplerDrawn {
    var rest = u.x * light.total;
    // The last triangle that is not empty.
    var last = 0u;
    for (var i = 1u; i < 7u; i++) {
        last = select(last, i, light.halves[i] > 0.0);
    }
    var chosen = 0u;
    for (var i = 0u; i < 6u; i++) {
        if (chosen == i && i < last && rest > light.halves[i]) {
            rest -= light.halves[i];
            chosen = i + 1u;
        }
    }
    rest = min(rest, light.halves[chosen]);
    let y = sampler_in_triangle(light.corners[0], light.corners[chosen + 1u], light.corners[chosen + 2u], rest, u.y);
    return sampler_drawn(light.map, light.scale, y);
}

/// The density of a direction that hits the light.
fn sampler_pdf_polygon(light: SamplerPolygon, wi: vec3<f32>) -> f32 {
    return sampler_density(light.map, light.scale, wi);
}
