// The isotropic table as engines read it: one texture with four numbers of the inverse, and one with two terms. Lights
// are integrated by their vector form factor. The part above the horizon is that of a sphere with the same vector form
// factor [Hill and Heitz 2016].
@group(0) @binding(0) var engine_inverse: texture_2d<f32>;
@group(0) @binding(1) var engine_terms: texture_2d<f32>;
@group(0) @binding(2) var engine_sampler: sampler;

// The angle divided by its sine and by a full turn, times the normal of the edge.
fn engine_edge(a: vec3<f32>, b: vec3<f32>) -> vec3<f32> {
    let x = dot(a, b);
    let y = abs(x);
    let upper = (0.8543985 + (0.4965155 + 0.0145206 * y) * y) / (3.417594 + (4.1616724 + y) * y);
    return cross(a, b) * select(0.5 * inverseSqrt(max(1.0 - x * x, 1e-7)) - upper, upper, x > 0.0);
}

fn engine_clipless(alpha: f32, wo: vec3<f32>, corners: array<vec3<f32>, 4>) -> vec4<f32> {
    let place = vec2(sqrt(alpha), sqrt(1.0 - saturate(wo.z))) * (63.0 / 64.0) + 0.5 / 64.0;
    let numbers = textureSampleLevel(engine_inverse, engine_sampler, place, 0.0);
    let terms = textureSampleLevel(engine_terms, engine_sampler, place, 0.0);
    let ahead = normalize(vec3(wo.xy, 0.0));
    let aside = vec3(-ahead.y, ahead.x, 0.0);
    let plane = mat3x3(numbers.x, 0.0, numbers.y, 0.0, 1.0, 0.0, numbers.z, 0.0, numbers.w);
    let inverse = plane * transpose(mat3x3(ahead, aside, vec3(0.0, 0.0, 1.0)));
    let a = normalize(inverse * corners[0]);
    let b = normalize(inverse * corners[1]);
    let c = normalize(inverse * corners[2]);
    let d = normalize(inverse * corners[3]);
    let flux = engine_edge(a, b) + engine_edge(b, c) + engine_edge(c, d) + engine_edge(d, a);
    let length = length(flux);
    let covered = max((length * length + flux.z) / (length + 1.0), 0.0);
    let facing = dot(cross(corners[1] - corners[0], corners[3] - corners[0]), corners[0]) > 0.0;
    return vec4(select(0.0, covered, facing), terms.xyz);
}
