// A table: what is bound of it, and what stands in its textures. Needs texels_volumes.wgsl or texels_array.wgsl. ltc_lookup.wgsl
// reads any table, ltc_lookup_round.wgsl those of isotropic surfaces alone.
//
// Each entry is three texels, x = phi, y = ratio * theta_nodes + theta, z = alpha, which is the order in which a file stores
// its entries:
//     a      m00 m01 m02 m10
//     b      m11 m12 m20 m21
//     terms  m22 amplitude fresnel 0
// 32 or 16 bits a number. A table without terms has amplitude 1 and fresnel 0 in their place. Of a table with two lobes an entry
// all second ones follow all first ones along z.

struct LtcTable {
    /// How many nodes alpha, ratio, theta and phi have.
    nodes: vec4<u32>,
    /// x: the layout's number, which a shader for one layout does not read. y: 1 for a table of isotropic surfaces with one
    /// phi, whose lobes turn with the view. z: how many layers after the first lobes the second ones are, 0 where there are none.
    reading: vec4<u32>,
    /// The first node of each axis in the variable in which the layout's nodes are evenly spaced, the step between nodes, and
    /// one over it; an axis of one node has the step 1.
    start: vec4<f32>,
    spacing: vec4<f32>,
    per_step: vec4<f32>,
    /// For the sampler: one over the layers of alpha, which are its nodes for each lobe; one over those of ratio and theta, those of theta, one over those of phi.
    texel: vec4<f32>,
    /// The first and the last node: of alpha, of ratio; the last and the first cosine of theta; cosine and sine of phi.
    roughness: vec4<f32>,
    cosines: vec4<f32>,
    azimuths: vec4<f32>,
}

@group(0) @binding(0) var<uniform> ltc_table: LtcTable;

/// Lets the sampler interpolate phi and theta, and alpha in volumes, with 2 or 4 fetches in place of 16. Textures then have to
/// be filterable and the sampler linear. Many GPUs interpolate with weights of 8 bits only, which shows on sharp lobes.
override ltc_hardware_filter: bool = false;

/// The least roughness along either axis. Both are raised to it before their ratio is taken, so that mirrors stay isotropic.
const LTC_LEAST_ALPHA: f32 = 1e-5;

/// The lobe of a surface seen from one direction.
struct LtcLobe {
    /// Maps the clamped cosine to the lobe, in the surface's tangent frame.
    m: mat3x3<f32>,
    /// Reflectance is f0 (amplitude - fresnel) + f90 fresnel.
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
