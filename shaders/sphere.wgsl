// The preview: spheres or a floor of anisotropic metal under a light. Needs all other files except the examples.

struct Scene {
    /// xyz: position of the eye. w: width of a pixel at distance one.
    eye: vec4<f32>,
    /// The image plane at distance one: vectors from its middle to the right edge and to the upper edge, and the view
    /// direction.
    right: vec4<f32>,
    up: vec4<f32>,
    forward: vec4<f32>,
    /// xyz: reflectance at normal incidence. w: exposure.
    f0: vec4<f32>,
    /// xyz: background. w: distance at which the floor ends.
    background: vec4<f32>,
    /// The view direction of a lobe.
    lobe_wo: vec4<f32>,
    /// alpha_x, alpha_y, cosine and sine of the tangent frame's rotation. alpha_x < 0: the cell is empty.
    materials: array<vec4<f32>, 4>,
    /// x: pixels per side. y: cells per side. z: surface, see SURFACE_*. w: samples.
    options: vec4<u32>,
    /// x: tile of the first workgroup. y, z: first sample and number of samples of this pass. The samples of all passes
    /// add up.
    output: vec4<u32>,
}

@group(1) @binding(1) var<uniform> scene: Scene;
/// The picture: red, green and blue of each pixel.
@group(1) @binding(2) var<storage, read_write> pixels: array<f32>;
/// The visible tiles of 8 x 8 pixels, one per workgroup: the upper left pixel, with x in the lower and y in the upper
/// 16 bits.
@group(1) @binding(3) var<storage, read> tiles: array<u32>;

/// The rule of model normals; the kind of Gaussian, and whether a table stores the Gaussians. All overrides here are
/// pipeline constants, because software drivers run both sides of a branch.
override normals_rule: u32 = RULE_BALANCED;
override gaussian: u32 = 0u;
override gaussian_is_fitted: bool = false;
/// The use of a table's second lobe, see SECOND_*.
override second_lobe: u32 = SECOND_NONE;
/// Whether the light, for models without a table, is a polygon other than a rectangle.
override light_is_polygon: bool = true;
/// Whether lobes end at the surface. Otherwise, an LTC lets light through from below.
override light_is_cut: bool = false;
/// Whether to restore the energy lost to shadowing.
override is_compensated: bool = false;

const RULE_BALANCED: u32 = 0u;
const RULE_FAST: u32 = 1u;
const RULE_FINE: u32 = 2u;

const SECOND_NONE: u32 = 0u;
const SECOND_INTEGRATED: u32 = 1u;
const SECOND_BLENDED: u32 = 2u;

const SURFACE_SPHERE: u32 = 0u;
const SURFACE_FLOOR: u32 = 1u;

/// The smallest cosine of a view direction. A view along the horizon reflects nothing.
const LOWEST_VIEW: f32 = 1e-3;
/// The smallest distance from a pole at which circles of latitude have a direction.
const POLE: f32 = 1e-4;
/// The smallest height from which the floor is visible.
const LOWEST_EYE: f32 = 1e-3;

struct Hit {
    at: Shaded,
    /// The fraction of the pixel that the surface covers.
    coverage: f32,
    /// The distance from the eye.
    distance: f32,
}

/// The pixel of an invocation. In tiles at the edge, it may be outside the picture.
fn pixel_of(group: vec3<u32>, local: vec3<u32>) -> vec2<u32> {
    let corner = tiles[scene.output.x + group.x];
    return vec2(corner & 0xffffu, corner >> 16u) + local.xy;
}

/// The place of a pixel's middle within its cell (xy), from -1 to 1, y upwards; the number of the cell (z).
fn place_of(pixel: vec2<u32>) -> vec3<f32> {
    let side = scene.options.x / scene.options.y;
    let cell = min(pixel / side, vec2(scene.options.y - 1u));
    let within = (vec2<f32>(pixel - cell * side) + 0.5) / f32(side) * 2.0 - 1.0;
    return vec3(within.x, -within.y, f32(cell.y * scene.options.y + cell.x));
}

/// The visible surface at a place: the unit sphere around the origin, or the floor y = 0.
fn hit_at(place: vec3<f32>) -> Hit {
    let ray = normalize(scene.forward.xyz + scene.right.xyz * place.x + scene.up.xyz * place.y);
    let eye = scene.eye.xyz;
    var hit: Hit;
    var position: vec3<f32>;
    var normal: vec3<f32>;
    var along: vec3<f32>;
    if (scene.options.z == SURFACE_FLOOR) {
        let t = -eye.y / min(ray.y, -1e-6);
        position = eye + t * ray;
        position.y = 0.0;
        hit.distance = t;
        normal = vec3(0.0, 1.0, 0.0);
        along = vec3(1.0, 0.0, 0.0);
        let fades = 1.0 - t / scene.background.w;
        hit.coverage = select(0.0, clamp(2.0 * fades, 0.0, 1.0), ray.y < -1e-6 && eye.y > LOWEST_EYE);
    } else {
        // A ray that misses the sphere takes the nearest point of the sphere. Pixels at the rim are partly covered.
        let closest = -dot(eye, ray);
        let nearest = eye + closest * ray;
        let distance2 = dot(nearest, nearest);
        let rim = (1.0 - sqrt(distance2)) / (scene.eye.w * closest);
        hit.coverage = select(0.0, clamp(rim + 0.5, 0.0, 1.0), closest > 0.0);
        let depth = sqrt(max(1.0 - distance2, 0.0));
        position = normalize(nearest - depth * ray);
        hit.distance = closest - depth;
        normal = position;
        let circle = vec3(normal.z, 0.0, -normal.x);
        let length2 = dot(circle, circle);
        along = select(vec3(1.0, 0.0, 0.0), circle / sqrt(max(length2, 1e-12)), length2 > POLE * POLE);
    }
    let material = scene.materials[u32(place.z)];
    hit.coverage = select(hit.coverage, 0.0, material.x < 0.0);
    let across = cross(normal, along);
    hit.at.position = position;
    hit.at.x = material.z * along + material.w * across;
    hit.at.y = material.z * across - material.w * along;
    hit.at.z = normal;
    let view = normalize(eye - position);
    let wo = vec3(dot(view, hit.at.x), dot(view, hit.at.y), max(dot(view, normal), LOWEST_VIEW));
    hit.at.wo = normalize(wo);
    hit.at.alpha = max(material.xy, vec2(LTC_LEAST_ALPHA));
    return hit;
}

/// Radiance towards the eye, by the table.
fn shade_by_table(at: Shaded) -> vec3<f32> {
    if (second_lobe == SECOND_NONE) {
        let lobe = ltc_lookup(at.alpha.x, at.alpha.y, at.wo);
        return reflected(vec2(lobe.amplitude, lobe.fresnel) * covered_by(lobe.m, at), lobe.amplitude);
    }
    let lobes = ltc_lookup_both(at.alpha.x, at.alpha.y, at.wo);
    let parts = vec2(lobes.first.amplitude, lobes.first.fresnel);
    if (second_lobe == SECOND_BLENDED) {
        let f0 = dot(scene.f0.xyz, vec3(1.0 / 3.0));
        return reflected(parts * covered_by(ltc_blend(lobes, f0, 1.0), at), parts.x);
    }
    return reflected(parts * vec2(covered_by(lobes.first.m, at), covered_by(lobes.second, at)), parts.x);
}

/// Radiance towards the eye, by an LTC without a table.
fn shade_by_formula(at: Shaded) -> vec3<f32> {
    let f0 = dot(scene.f0.xyz, vec3(1.0 / 3.0));
    let lobe = ltc_formula(at.alpha.x, at.alpha.y, at.wo, f0, 1.0);
    if (light_has_picture) {
        let covered = covered_picture(lobe.inverse, at);
        return reflected_colours(lobe.amplitude * covered, lobe.fresnel * covered, lobe.amplitude);
    }
    return reflected(vec2(lobe.amplitude, lobe.fresnel) * covered_by_inverse(lobe.inverse, at), lobe.amplitude);
}

/// The part of the lobe of matrix m that the light covers.
fn covered_by(m: mat3x3<f32>, at: Shaded) -> f32 {
    return covered_by_inverse(ltc_inverse(m), at);
}

fn covered_by_inverse(inverse: LtcInverse, at: Shaded) -> f32 {
    if (light_is_cut) {
        return covered_above(inverse, at);
    }
    // A single matrix transforms from world space to cosine space.
    let to_cosine = inverse.m * transpose(mat3x3(at.x, at.y, at.z));
    if (light_shape != LIGHT_POLYGON) {
        return shape_covered(LtcInverse(to_cosine, inverse.side), at.position);
    }
    // The outline of the light relative to the shaded point, in world space.
    if (light.options.x == 4u) {
        let p = at.position;
        let corners = array<vec3<f32>, 4>(
            light.vertices[0].xyz - p,
            light.vertices[1].xyz - p,
            light.vertices[2].xyz - p,
            light.vertices[3].xyz - p,
        );
        return ltc_rectangle(LtcInverse(to_cosine, inverse.side), corners, light.options.y == 1u);
    }
    var clip = ltc_clip_begin(to_cosine * (light.vertices[light.options.x - 1u].xyz - at.position));
    for (var i = 0u; i < light.options.x; i++) {
        clip = ltc_clip_edge(clip, to_cosine * (light.vertices[i].xyz - at.position));
    }
    return ltc_clip_finish(clip, inverse.side, light.options.y == 1u);
}

/// The part of the lobe that an ellipse, a sphere, a tube or a line covers.
fn shape_covered(inverse: LtcInverse, position: vec3<f32>) -> f32 {
    let start = light.centre.xyz - position;
    if (light_shape == LIGHT_ELLIPSE) {
        return ltc_disk(inverse, start, light.half_axes[0].xyz, light.half_axes[1].xyz, light.options.y == 1u);
    }
    let end = light.half_axes[0].xyz - position;
    if (light_shape == LIGHT_LINE) {
        return ltc_line(inverse, start, end, light.centre.w);
    }
    return ltc_tube(inverse, start, end, light.centre.w);
}

/// The vertices of the light for models that support only polygons, relative to the shaded point, in its tangent frame.
fn outline_of(at: Shaded) -> array<vec3<f32>, 8> {
    let to_local = transpose(mat3x3(at.x, at.y, at.z));
    var vertices: array<vec3<f32>, 8>;
    if (light_shape >= LIGHT_TUBE) {
        vertices = solid_outline(at.position, at.z);
        for (var i = 0u; i < 8u; i++) {
            vertices[i] = to_local * vertices[i];
        }
        return vertices;
    }
    // Written without a loop, because software drivers are slow at indices that are not constant.
    vertices[0] = to_local * (light.vertices[0].xyz - at.position);
    vertices[1] = to_local * (light.vertices[1].xyz - at.position);
    vertices[2] = to_local * (light.vertices[2].xyz - at.position);
    vertices[3] = to_local * (light.vertices[3].xyz - at.position);
    if (light_is_polygon) {
        vertices[4] = to_local * (light.vertices[4].xyz - at.position);
        vertices[5] = to_local * (light.vertices[5].xyz - at.position);
        vertices[6] = to_local * (light.vertices[6].xyz - at.position);
        vertices[7] = to_local * (light.vertices[7].xyz - at.position);
    }
    return vertices;
}

/// Radiance towards the eye, by model normals.
fn shade_by_normals(at: Shaded) -> vec3<f32> {
    var vertices = outline_of(at);
    let corners = array<vec3<f32>, 4>(vertices[0], vertices[1], vertices[2], vertices[3]);
    let count = light.options.x;
    let two_sided = light.options.y == 1u;
    if (normals_rule == RULE_FAST) {
        let view = fast_view(at.alpha.x, at.alpha.y, at.wo);
        if (light_is_polygon) {
            return reflected(fast_polygon(view, &vertices, count, two_sided), albedo_of(at));
        }
        return reflected(fast_rectangle(view, corners, two_sided), albedo_of(at));
    }
    if (normals_rule == RULE_FINE) {
        let view = fine_view(at.alpha.x, at.alpha.y, at.wo);
        if (light_is_polygon) {
            return reflected(fine_polygon(view, &vertices, count, two_sided), albedo_of(at));
        }
        return reflected(fine_rectangle(view, corners, two_sided), albedo_of(at));
    }
    let view = balanced_view(at.alpha.x, at.alpha.y, at.wo);
    if (light_is_polygon) {
        return reflected(balanced_polygon(view, &vertices, count, two_sided), albedo_of(at));
    }
    return reflected(balanced_rectangle(view, corners, two_sided), albedo_of(at));
}

/// Radiance towards the eye, by a Gaussian.
fn shade_by_gaussian(at: Shaded) -> vec3<f32> {
    var view: GaussiansView;
    if (gaussian_is_fitted) {
        view = gaussians_lookup(gaussian, at.alpha.x, at.alpha.y, at.wo);
    } else {
        view = gaussians_view(gaussian, at.alpha.x, at.alpha.y, at.wo);
    }
    let count = select(4u, light.options.x, light_is_polygon);
    var vertices = outline_of(at);
    var outline = gaussians_outline_begin(view, vertices[count - 1u]);
    for (var i = 0u; i < count; i++) {
        outline = gaussians_outline_edge(view, outline, vertices[i]);
    }
    return reflected(gaussians_outline_finish(view, outline, light.options.y == 1u), albedo_of(at));
}

/// The albedo of GGX for a Fresnel factor of one; 1 if it is not used.
fn albedo_of(at: Shaded) -> f32 {
    if (is_compensated) {
        return ltc_albedo(at.alpha.x, at.alpha.y, at.wo);
    }
    return 1.0;
}

/// Radiance from the two parts of reflected white light, f90 = 1, and the albedo of the surface.
fn reflected(parts: vec2<f32>, albedo: f32) -> vec3<f32> {
    return reflected_colours(vec3(parts.x), vec3(parts.y), albedo);
}

/// Radiance from the two parts of reflected coloured light.
fn reflected_colours(all: vec3<f32>, fresnel: vec3<f32>, albedo: f32) -> vec3<f32> {
    let once = (scene.f0.xyz * (all - fresnel) + fresnel) * light.radiance.x;
    if (is_compensated) {
        return once * (vec3(1.0) + scene.f0.xyz * (1.0 / max(albedo, 0.01) - 1.0));
    }
    return once;
}

fn write(pixel: vec2<u32>, radiance: vec3<f32>) {
    let index = 3u * (pixel.y * scene.options.x + pixel.x);
    for (var i = 0u; i < 3u; i++) {
        let before = select(0.0, pixels[index + i], scene.output.y > 0u);
        pixels[index + i] = before + radiance[i];
    }
}

@compute @workgroup_size(8, 8)
fn surface_by_table(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_id) local: vec3<u32>) {
    let pixel = pixel_of(group, local);
    if (any(pixel >= vec2(scene.options.x))) {
        return;
    }
    let place = place_of(pixel);
    let hit = hit_at(place);
    var shaded = vec3(0.0);
    if (hit.coverage > 0.0) {
        shaded = shade_by_table(hit.at);
    }
    write(pixel, composed(place, hit, shaded, 1.0));
}

@compute @workgroup_size(8, 8)
fn surface_by_normals(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_id) local: vec3<u32>) {
    let pixel = pixel_of(group, local);
    if (any(pixel >= vec2(scene.options.x))) {
        return;
    }
    let place = place_of(pixel);
    let hit = hit_at(place);
    var shaded = vec3(0.0);
    if (hit.coverage > 0.0) {
        shaded = shade_by_normals(hit.at);
    }
    write(pixel, composed(place, hit, shaded, 1.0));
}

@compute @workgroup_size(8, 8)
fn surface_by_formula(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_id) local: vec3<u32>) {
    let pixel = pixel_of(group, local);
    if (any(pixel >= vec2(scene.options.x))) {
        return;
    }
    let place = place_of(pixel);
    let hit = hit_at(place);
    var shaded = vec3(0.0);
    if (hit.coverage > 0.0) {
        shaded = shade_by_formula(hit.at);
    }
    write(pixel, composed(place, hit, shaded, 1.0));
}

@compute @workgroup_size(8, 8)
fn surface_by_gaussian(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_id) local: vec3<u32>) {
    let pixel = pixel_of(group, local);
    if (any(pixel >= vec2(scene.options.x))) {
        return;
    }
    let place = place_of(pixel);
    let hit = hit_at(place);
    var shaded = vec3(0.0);
    if (hit.coverage > 0.0) {
        shaded = shade_by_gaussian(hit.at);
    }
    write(pixel, composed(place, hit, shaded, 1.0));
}

@compute @workgroup_size(8, 8)
fn surface_by_reference(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_id) local: vec3<u32>) {
    let pixel = pixel_of(group, local);
    if (any(pixel >= vec2(scene.options.x))) {
        return;
    }
    let place = place_of(pixel);
    let hit = hit_at(place);
    let all = f32(scene.options.w);
    var shaded = vec3(0.0);
    if (hit.coverage > 0.0) {
        let key = pixel.y * scene.options.x + pixel.x;
        let parts = ggx_reference(hit.at, scene.output.y, scene.output.z, key);
        shaded = reflected_colours(parts.all / all, parts.fresnel / all, albedo_of(hit.at));
    }
    write(pixel, composed(place, hit, shaded, f32(scene.output.z) / all));
}
