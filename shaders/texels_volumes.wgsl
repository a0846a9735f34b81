// A table in three 3D textures, z = alpha. Needs ltc_table.wgsl.

@group(0) @binding(1) var ltc_matrix_a: texture_3d<f32>;
@group(0) @binding(2) var ltc_matrix_b: texture_3d<f32>;
@group(0) @binding(3) var ltc_terms: texture_3d<f32>;
@group(0) @binding(4) var ltc_sampler: sampler;

/// The entry at a texel.
fn ltc_fetch(texel: vec3<u32>) -> LtcTexels {
    return LtcTexels(textureLoad(ltc_matrix_a, texel, 0), textureLoad(ltc_matrix_b, texel, 0), textureLoad(ltc_terms, texel, 0));
}

/// The entries around a place, interpolated by the sampler. `at` runs from 0 to 1 across the textures. alpha counts
/// nodes, from half a node before the first node. `layer` is the layer of the first node.
fn ltc_sample(at: vec2<f32>, alpha: f32, layer: u32) -> LtcTexels {
    let place = vec3(at, (alpha + f32(layer)) * ltc_table.texel.x);
    return LtcTexels(
        textureSampleLevel(ltc_matrix_a, ltc_sampler, place, 0.0),
        textureSampleLevel(ltc_matrix_b, ltc_sampler, place, 0.0),
        textureSampleLevel(ltc_terms, ltc_sampler, place, 0.0),
    );
}
