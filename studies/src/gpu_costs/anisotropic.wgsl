// The anisotropic table in three volumes of 8 x 8 x 64 texels, with 8 nodes of ratio for each of 8 alphas. The shader
// interpolates along the last axis, inverts the matrix of each pixel, and clips lights at the lobe's horizon case by
// case [KT et al. 2022].
@group(0) @binding(0) var engine_a: texture_3d<f32>;
@group(0) @binding(1) var engine_b: texture_3d<f32>;
@group(0) @binding(2) var engine_c: texture_3d<f32>;
@group(0) @binding(3) var engine_sampler: sampler;

const ENGINE_QUARTER: f32 = 1.57079633;

struct EngineTexels {
    a: vec4<f32>,
    b: vec4<f32>,
    c: vec4<f32>,
}

fn engine_sample(place: vec3<f32>) -> EngineTexels {
    return EngineTexels(
        textureSampleLevel(engine_a, engine_sampler, place, 0.0),
        textureSampleLevel(engine_b, engine_sampler, place, 0.0),
        textureSampleLevel(engine_c, engine_sampler, place, 0.0),
    );
}

fn engine_lookup(u: vec4<f32>) -> EngineTexels {
    let slice = 7.0 * u.w;
    let lower = floor(slice);
    let upper = min(lower + 1.0, 7.0);
    let xy = (7.0 * u.xy + 0.5) / 8.0;
    let low = engine_sample(vec3(xy, (7.0 * u.z + 8.0 * lower + 0.5) / 64.0));
    let high = engine_sample(vec3(xy, (7.0 * u.z + 8.0 * upper + 0.5) / 64.0));
    let weight = fract(slice);
    return EngineTexels(mix(low.a, high.a, weight), mix(low.b, high.b, weight), mix(low.c, high.c, weight));
}

fn engine_inverted(m: mat3x3<f32>) -> mat3x3<f32> {
    let x = cross(m[1], m[2]);
    let per_determinant = 1.0 / dot(m[0], x);
    return transpose(mat3x3(x, cross(m[2], m[0]), cross(m[0], m[1]))) * per_determinant;
}

fn engine_edge(a: vec3<f32>, b: vec3<f32>) -> f32 {
    let angle = acos(dot(a, b));
    return cross(a, b).z * select(1.0, angle / sin(angle), angle > 0.001);
}

// The point where an edge crosses the horizon.
fn engine_cut(above: vec3<f32>, below: vec3<f32>) -> vec3<f32> {
    return above.z * below - below.z * above;
}

// The corners of the light above the horizon, and their number.
fn engine_clip(l: ptr<function, array<vec3<f32>, 5>>) -> u32 {
    let above = vec4((*l)[0].z, (*l)[1].z, (*l)[2].z, (*l)[3].z) > vec4(0.0);
    let cases = dot(vec4<u32>(above), vec4(1u, 2u, 4u, 8u));
    let a = (*l)[0];
    let b = (*l)[1];
    let c = (*l)[2];
    let d = (*l)[3];
    switch cases {
        case 1u: { (*l)[1] = engine_cut(a, b); (*l)[2] = engine_cut(a, d); (*l)[3] = a; return 3u; }
        case 2u: { (*l)[0] = engine_cut(b, a); (*l)[2] = engine_cut(b, c); (*l)[3] = (*l)[0]; return 3u; }
        case 3u: { (*l)[2] = engine_cut(b, c); (*l)[3] = engine_cut(a, d); (*l)[4] = a; return 4u; }
        case 4u: { (*l)[0] = engine_cut(c, d); (*l)[1] = engine_cut(c, b); (*l)[3] = (*l)[0]; return 3u; }
        case 6u: { (*l)[0] = engine_cut(b, a); (*l)[3] = engine_cut(c, d); (*l)[4] = (*l)[0]; return 4u; }
        case 7u: { (*l)[4] = engine_cut(a, d); (*l)[3] = engine_cut(c, d); return 5u; }
        case 8u: { (*l)[0] = engine_cut(d, a); (*l)[1] = engine_cut(d, c); (*l)[2] = d; (*l)[3] = (*l)[0]; return 3u; }
        case 9u: { (*l)[1] = engine_cut(a, b); (*l)[2] = engine_cut(d, c); (*l)[4] = a; return 4u; }
        case 11u: { (*l)[4] = d; (*l)[3] = engine_cut(d, c); (*l)[2] = engine_cut(b, c); return 5u; }
        case 12u: { (*l)[1] = engine_cut(c, b); (*l)[0] = engine_cut(d, a); (*l)[4] = (*l)[0]; return 4u; }
        case 13u: { (*l)[4] = d; (*l)[3] = c; (*l)[2] = engine_cut(c, b); (*l)[1] = engine_cut(a, b); return 5u; }
        case 14u: { (*l)[4] = engine_cut(d, a); (*l)[0] = engine_cut(b, a); return 5u; }
        case 15u: { (*l)[4] = a; return 4u; }
        default: { return 0u; }
    }
}

fn lit(alpha: vec2<f32>, local: Local) -> vec4<f32> {
    // The table has the larger roughness along x, and views in the first quadrant. Surface, view and light are rotated
    // and mirrored accordingly.
    let swaps = alpha.y > alpha.x;
    let larger = max(alpha.x, alpha.y);
    let ratio = min(alpha.x, alpha.y) / larger;
    let flat = select(local.wo.xy, local.wo.yx, swaps);
    let mirror = select(vec2(1.0), vec2(-1.0), flat < vec2(0.0));
    let phi = atan2(abs(flat.y), abs(flat.x));
    let found = engine_lookup(vec4(phi / ENGINE_QUARTER, acos(local.wo.z) / ENGINE_QUARTER, ratio, (larger - 0.001) / 0.999));
    let m = transpose(mat3x3(found.a.xyz, vec3(found.a.w, found.b.xy), vec3(found.b.zw, found.c.x)));
    let inverse = engine_inverted(m);
    var l: array<vec3<f32>, 5>;
    for (var i = 0u; i < 4u; i++) {
        let corner = local.corners[i];
        l[i] = inverse * vec3(select(corner.xy, corner.yx, swaps) * mirror, corner.z);
    }
    let count = engine_clip(&l);
    if (count == 0u) {
        return vec4(0.0);
    }
    for (var i = 0u; i < 5u; i++) {
        l[i] = normalize(l[i]);
    }
    var sum = engine_edge(l[0], l[1]) + engine_edge(l[1], l[2]) + engine_edge(l[2], l[3]);
    if (count >= 4u) {
        sum += engine_edge(l[3], l[4]);
    }
    if (count == 5u) {
        sum += engine_edge(l[4], l[0]);
    }
    let turn = select(1.0, -1.0, swaps) * mirror.x * mirror.y;
    return vec4(max(turn * sum, 0.0) / (4.0 * ENGINE_QUARTER), found.c.yz, 0.0);
}
