// The bindings and textures of a table. Needs texels_volumes.wgsl or texels_array.wgsl. ltc_lookup.wgsl reads any
// table; ltc_lookup_round.wgsl reads tables of isotropic surfaces.
//
// Each entry is three texels, at x = phi, y = ratio * theta_nodes + theta, z = alpha. This is the order of entries in a
// table file:
//     a      m00 m01 m02 m10
//     b      m11 m12 m20 m21
//     terms  m22 amplitude fresnel 0
// Numbers have 32 or 16 bits. A table without terms has amplitude 1 and fresnel 0. In a table with two lobes per entry,
// all second lobes follow all first lobes along z.

struct LtcTable {
    /// The number of nodes of alpha, ratio, theta and phi.
    nodes: vec4<u32>,
    /// x: number of the layout, which shaders for a single layout do not read. y: 1 for a table of isotropic surfaces
    /// with one phi, whose lobes rotate with the view. z: number of layers from a first lobe to its second lobe; 0
    /// without second lobes.
    reading: vec4<u32>,
    /// For each axis, in the coordinate in which the layout's nodes are evenly spaced: the first node, the step between
    /// nodes, and one over the step. An axis with one node has step 1.
    start: vec4<f32>,
    spacing: vec4<f32>,
    per_step: vec4<f32>,
    /// For the sampler. x: 1 / number of layers, including those of second lobes. y: 1 / (ratio_nodes * theta_nodes).
    /// z: theta_nodes. w: 1 / phi_nodes.
    texel: vec4<f32>,
    /// roughness: the first and last node of alpha, then of ratio. cosines: the cosines of the last and of the first
    /// theta. azimuths: cosine and sine of the first phi, then of the last phi.
    roughness: vec4<f32>,
    cosines: vec4<f32>,
    azimuths: vec4<f32>,
}

@group(0) @binding(0) var<uniform> ltc_table: LtcTable;

/// Whether the sampler interpolates phi, theta and (in volumes) alpha, with 2 or 4 fetches instead of 16. Textures must
/// be filterable and the sampler linear. Many GPUs interpolate with 8-bit weights, which is visible on sharp lobes.
override ltc_hardware_filter: bool = false;

/// The smallest roughness along either axis. Both are clamped before their ratio is taken, so mirrors stay isotropic.
const LTC_LEAST_ALPHA: f32 = 1e-5;

/// The lobe of a surface seen from one direction.
struct LtcLobe {
    /// The matrix that maps the clamped cosine to the lobe, in the tangent frame.
    m: mat3x3<f32>,
    /// The albedo is f0 (amplitude - fresnel) + f90 fresnel.
    amplitude: f32,
    fresnel: f32,
}

/// The three texels of an entry.
struct LtcTexels {
    a: vec4<f32>,
    b: vec4<f32>,
    terms: vec4<f32>,
}

fn ltc_mix(low: LtcTexels, high: LtcTexels, weight: f32) -> LtcTexels {
    return LtcTexels(mix(low.a, high.a, weight), mix(low.b, high.b, weight), mix(low.terms, high.terms, weight));
}
