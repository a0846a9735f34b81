// The reference: anisotropic GGX with height-correlated Smith masking [KT et al. 2022, section 3.1] under a light.
// Monte Carlo integration with multiple importance sampling [Veach and Guibas 1995, balance heuristic]. Each sample
// takes one visible normal [Dupuy and Benyoub 2023] and one point of the light. Needs ltc_math.wgsl,
// reference_solids.wgsl and light_picture.wgsl.

/// A light in the scene's coordinates.
struct Light {
    /// xyz: a vertex of the polygon, or of the polygon that replaces an ellipse; clockwise as seen from the side that
    /// emits. w: area of the triangles (0, 1, 2) to (0, i - 1, i), divided by the area of the polygon.
    vertices: array<vec4<f32>, 8>,
    /// xyz: centre of an ellipse, or one end of a tube or line. w: radius of the tube or width of the line.
    centre: vec4<f32>,
    /// xyz: half axes of an ellipse. w: one over their squared length. The first entry holds the other end of a tube or
    /// line.
    half_axes: array<vec4<f32>, 2>,
    /// xyz: unit normal on the side that emits. w: area.
    normal: vec4<f32>,
    /// x: radiance. w: argument `base` of textured_colour for the light's picture.
    radiance: vec4<f32>,
    /// x: number of vertices. y: 1 if both sides emit.
    options: vec4<u32>,
}

@group(1) @binding(0) var<uniform> light: Light;

/// The shape of the light. It is a pipeline constant, because software drivers run both sides of a branch.
override light_shape: u32 = 0u;

const LIGHT_POLYGON: u32 = 0u;
const LIGHT_ELLIPSE: u32 = 1u;
/// A tube with round ends. It is a sphere if both ends are equal.
const LIGHT_TUBE: u32 = 2u;
const LIGHT_LINE: u32 = 3u;

/// A shaded point of the surface, with its tangent frame and roughness.
struct Shaded {
    position: vec3<f32>,
    x: vec3<f32>,
    y: vec3<f32>,
    z: vec3<f32>,
    /// View direction in the tangent frame.
    wo: vec3<f32>,
    alpha: vec2<f32>,
}

/// Directions with a smaller cosine count as below the horizon.
const GGX_HORIZON: f32 = 1e-6;

fn reference_hash(key: u32) -> u32 {
    var x = key;
    x = (x ^ (x >> 16u)) * 0x7feb352du;
    x = (x ^ (x >> 15u)) * 0x846ca68bu;
    return x ^ (x >> 16u);
}

/// Point i of the R2 sequence [Roberts 2018], shifted by seed, in [0, 1). Fixed point keeps all digits.
fn reference_point(i: u32, seed: vec2<u32>) -> vec2<f32> {
    let u = vec2(i * 0xc13fa9a9u, i * 0x91e10da5u) + seed;
    return vec2<f32>(u >> vec2(8u)) * (1.0 / 16777216.0);
}

/// Smith Lambda(w) = (sqrt(1 + alpha^2 tan^2 theta) - 1) / 2. Domain: w.z > 0.
fn ggx_lambda(alpha: vec2<f32>, w: vec3<f32>) -> f32 {
    let t = alpha * w.xy / w.z;
    return 0.5 * (sqrt(1.0 + dot(t, t)) - 1.0);
}

/// The GGX distribution of microfacet normals.
fn ggx_distribution(alpha: vec2<f32>, wm: vec3<f32>) -> f32 {
    let t = wm.xy / alpha;
    let q = dot(t, t) + wm.z * wm.z;
    return 1.0 / (3.14159265 * alpha.x * alpha.y * q * q);
}

/// Samples a normal visible from wo, by spherical caps [Dupuy and Benyoub 2023].
fn ggx_visible_normal(alpha: vec2<f32>, wo: vec3<f32>, u: vec2<f32>) -> vec3<f32> {
    let standard = normalize(vec3(alpha * wo.xy, wo.z));
    let z = (1.0 - u.y) * (1.0 + standard.z) - standard.z;
    let radius = sqrt(max(1.0 - z * z, 0.0));
    let turn = ltc_sin_cos(u.x);
    let wm = vec3(radius * turn.y, radius * turn.x, z) + standard;
    return normalize(vec3(alpha * wm.xy, max(wm.z, 0.0)));
}

/// Whether the light emits towards the shaded point. cosine is the dot product of the light's normal and the direction
/// to the light.
fn light_faces(cosine: f32) -> bool {
    let towards = select(-cosine, abs(cosine), light.options.y == 1u);
    return towards > GGX_HORIZON;
}

/// The density, per steradian, with which light_sample draws the direction wi. Negative if wi misses the light.
fn light_pdf(position: vec3<f32>, wi: vec3<f32>) -> f32 {
    if (light_shape >= LIGHT_TUBE) {
        return solid_pdf(position, wi);
    }
    let cosine = dot(light.normal.xyz, wi);
    if (!light_faces(cosine)) {
        return -1.0;
    }
    let distance = dot(light.normal.xyz, light.vertices[0].xyz - position) / cosine;
    if (distance <= 0.0) {
        return -1.0;
    }
    let hit = position + distance * wi;
    let density = distance * distance / (light.normal.w * abs(cosine));
    if (light_shape == LIGHT_ELLIPSE) {
        let offset = hit - light.centre.xyz;
        let across = vec2(dot(offset, light.half_axes[0].xyz), dot(offset, light.half_axes[1].xyz)) *
            vec2(light.half_axes[0].w, light.half_axes[1].w);
        return select(-1.0, density, dot(across, across) <= 1.0);
    }
    var is_hit = true;
    var a = light.vertices[light.options.x - 1u].xyz;
    for (var i = 0u; i < light.options.x; i++) {
        let b = light.vertices[i].xyz;
        is_hit = is_hit && dot(cross(b - a, hit - a), light.normal.xyz) <= 0.0;
        a = b;
    }
    return select(-1.0, density, is_hit);
}

/// A direction towards the light (xyz) and its density per steradian (w). w is zero if the light does not emit towards
/// the point.
fn light_sample(position: vec3<f32>, u: vec2<f32>) -> vec4<f32> {
    if (light_shape >= LIGHT_TUBE) {
        return solid_sample(position, u);
    }
    let to_light = light_point(u) - position;
    let distance2 = dot(to_light, to_light);
    let direction = to_light / sqrt(max(distance2, 1e-36));
    let facing = dot(light.normal.xyz, direction);
    let density = distance2 / (light.normal.w * max(abs(facing), GGX_HORIZON));
    return vec4(direction, select(0.0, density, light_faces(facing)));
}

/// A point of the polygon or ellipse, uniformly distributed over the area.
fn light_point(u: vec2<f32>) -> vec3<f32> {
    if (light_shape == LIGHT_ELLIPSE) {
        let turn = sqrt(u.x) * ltc_sin_cos(u.y);
        return light.centre.xyz + turn.y * light.half_axes[0].xyz + turn.x * light.half_axes[1].xyz;
    }
    // Loop over all triangles, so that every lane takes the same number of steps.
    var i = 2u;
    for (var k = 2u; k + 1u < light.options.x; k++) {
        i += select(0u, 1u, u.x >= light.vertices[k].w);
    }
    let before = light.vertices[i - 1u].w;
    let share = clamp((u.x - before) / (light.vertices[i].w - before), 0.0, 1.0);
    let root = sqrt(share);
    let origin = light.vertices[0].xyz;
    let first = light.vertices[i - 1u].xyz - origin;
    let second = light.vertices[i].xyz - origin;
    return origin + root * ((1.0 - u.y) * first + u.y * second);
}

/// The reflected light of each colour channel: for a Fresnel factor of one, and weighted by Schlick's (1 - wo . wm)^5.
struct ReferenceParts {
    all: vec3<f32>,
    fresnel: vec3<f32>,
}

/// The sum over samples `first` to `first + samples - 1`. Some drivers end loops after 65535 steps, including the steps
/// of nested loops, so take at most 1024 samples at a time.
fn ggx_reference(at: Shaded, first: u32, samples: u32, key: u32) -> ReferenceParts {
    let a = reference_hash(key);
    let b = reference_hash(a ^ 0x9e3779b9u);
    let c = reference_hash(b ^ 0x9e3779b9u);
    let d = reference_hash(c ^ 0x9e3779b9u);
    let lambda_o = ggx_lambda(at.alpha, at.wo);
    let to_pdf = 1.0 / (4.0 * at.wo.z * (1.0 + lambda_o));
    var sum = ReferenceParts(vec3(0.0), vec3(0.0));
    for (var i = first; i < first + samples; i++) {
        // Sample a visible normal. Add its light if the reflected direction hits the light.
        var wm = ggx_visible_normal(at.alpha, at.wo, reference_point(i, vec2(a, b)));
        let cosine = dot(at.wo, wm);
        var wi = 2.0 * cosine * wm - at.wo;
        if (wi.z > GGX_HORIZON) {
            let towards = at.x * wi.x + at.y * wi.y + at.z * wi.z;
            let pdf_light = light_pdf(at.position, towards);
            if (pdf_light >= 0.0) {
                let pdf_brdf = ggx_distribution(at.alpha, wm) * to_pdf;
                let g2_over_g1 = (1.0 + lambda_o) / (1.0 + lambda_o + ggx_lambda(at.alpha, wi));
                let parts = ggx_fresnel(cosine) * (g2_over_g1 * (pdf_brdf / (pdf_brdf + pdf_light)));
                sum = reference_sum(sum, parts, light_colour(at.position, towards));
            }
        }
        // Sample a point of the light.
        let drawn = light_sample(at.position, reference_point(i, vec2(c, d)));
        let pdf_light = drawn.w;
        wi = vec3(dot(drawn.xyz, at.x), dot(drawn.xyz, at.y), dot(drawn.xyz, at.z));
        if (wi.z > GGX_HORIZON && pdf_light > 0.0) {
            wm = normalize(at.wo + wi);
            let pdf_brdf = ggx_distribution(at.alpha, wm) * to_pdf;
            let g2_over_g1 = (1.0 + lambda_o) / (1.0 + lambda_o + ggx_lambda(at.alpha, wi));
            // No reflected direction hits a line exactly, so only light sampling counts.
            let pdf_both = select(pdf_brdf, 0.0, light_shape == LIGHT_LINE) + pdf_light;
            let parts = ggx_fresnel(dot(at.wo, wm)) * (g2_over_g1 * (pdf_brdf / pdf_both));
            sum = reference_sum(sum, parts, light_colour(at.position, drawn.xyz));
        }
    }
    return sum;
}

/// The sum plus one sample's parts times the colour of the light.
fn reference_sum(sum: ReferenceParts, parts: vec2<f32>, colour: vec3<f32>) -> ReferenceParts {
    return ReferenceParts(sum.all + parts.x * colour, sum.fresnel + parts.y * colour);
}

/// x: one. y: Schlick's (1 - cosine)^5.
fn ggx_fresnel(cosine: f32) -> vec2<f32> {
    let m = clamp(1.0 - cosine, 0.0, 1.0);
    let m2 = m * m;
    return vec2(1.0, m2 * m2 * m);
}
