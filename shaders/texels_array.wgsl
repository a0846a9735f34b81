// A table in one 2D array, for renderers that have no 3D textures or no samplers to spare: a layer for each alpha, first of what
// ltc_table.wgsl calls a, then of b, then of terms; those of second lobes follow the first ones of the same part.

@group(0) @binding(1) var ltc_layers: texture_2d_array<f32>;
@group(0) @binding(2) var ltc_sampler: sampler;

/// The entry at a texel; z counts the layers of one part.
fn ltc_fetch(texel: vec3<u32>) -> LtcTexels {
    let count = ltc_table.nodes.x + ltc_table.reading.z;
    return LtcTexels(
        textureLoad(ltc_layers, texel.xy, texel.z, 0),
        textureLoad(ltc_layers, texel.xy, texel.z + count, 0),
        textureLoad(ltc_layers, texel.xy, texel.z + 2u * count, 0),
    );
}

/// The sampler's mean of the entries around a place, within the layers of one alpha. at runs from 0 to 1 across them.
fn ltc_sample_layers(at: vec2<f32>, alpha: u32) -> LtcTexels {
    let count = ltc_table.nodes.x + ltc_table.reading.z;
    return LtcTexels(
        textureSampleLevel(ltc_layers, ltc_sampler, at, alpha, 0.0),
        textureSampleLevel(ltc_layers, ltc_sampler, at, alpha + count, 0.0),
        textureSampleLevel(ltc_layers, ltc_sampler, at, alpha + 2u * count, 0.0),
    );
}

/// The same between two layers, which no sampler weighs; alpha counts nodes, from half a node before the first, whose layer is
/// given.
fn ltc_sample(at: vec2<f32>, alpha: f32, layer: u32) -> LtcTexels {
    let from_first = max(alpha - 0.5, 0.0);
    let lower = u32(from_first);
    let above = min(lower + 1u, ltc_table.nodes.x - 1u);
    return ltc_mix(ltc_sample_layers(at, lower + layer), ltc_sample_layers(at, above + layer), fract(from_first));
}
