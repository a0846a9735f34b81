// A table in a single 2D array, for renderers without 3D textures or without spare samplers. It has three parts with
// one layer for each alpha: the texels that ltc_table.wgsl calls a, then b, then terms. Within a part, second lobes
// follow first lobes.

@group(0) @binding(1) var ltc_layers: texture_2d_array<f32>;
@group(0) @binding(2) var ltc_sampler: sampler;

/// The entry at a texel; z is the layer within a part.
fn ltc_fetch(texel: vec3<u32>) -> LtcTexels {
    let count = ltc_table.nodes.x + ltc_table.reading.z;
    return LtcTexels(
        textureLoad(ltc_layers, texel.xy, texel.z, 0),
        textureLoad(ltc_layers, texel.xy, texel.z + count, 0),
        textureLoad(ltc_layers, texel.xy, texel.z + 2u * count, 0),
    );
}

/// The entries around a place, interpolated by the sampler, in layer `alpha` of each part. `at` runs from 0 to 1 across
/// a layer.
fn ltc_sample_layers(at: vec2<f32>, alpha: u32) -> LtcTexels {
    let count = ltc_table.nodes.x + ltc_table.reading.z;
    return LtcTexels(
        textureSampleLevel(ltc_layers, ltc_sampler, at, alpha, 0.0),
        textureSampleLevel(ltc_layers, ltc_sampler, at, alpha + count, 0.0),
        textureSampleLevel(ltc_layers, ltc_sampler, at, alpha + 2u * count, 0.0),
    );
}

/// Interpolates between two layers in the shader. alpha counts nodes, from half a node before the first node. `layer`
/// is the layer of the first node.
fn ltc_sample(at: vec2<f32>, alpha: f32, layer: u32) -> LtcTexels {
    let from_first = max(alpha - 0.5, 0.0);
    let lower = u32(from_first);
    let above = min(lower + 1u, ltc_table.nodes.x - 1u);
    return ltc_mix(ltc_sample_layers(at, lower + layer), ltc_sample_layers(at, above + layer), fract(from_first));
}
