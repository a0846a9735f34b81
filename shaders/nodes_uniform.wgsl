// The nodes of a table's axes in a uniform, for languages without storage buffers: at most 512 of them. Of the 224 vectors
// that WebGL 2 grants a fragment shader at least, that leaves 96.

struct LtcNodes {
    /// Four to a vector.
    four: array<vec4<f32>, 128>,
}

@group(0) @binding(1) var<uniform> ltc_nodes: LtcNodes;

/// The node at a place in the list: alpha's first, then ratio's, theta's and phi's.
fn ltc_node(place: u32) -> f32 {
    let four = ltc_nodes.four[place / 4u];
    return four[place % 4u];
}
