// The nodes of a table's axes in a uniform, for languages without storage buffers: at most 1024 of them.

struct LtcNodes {
    /// Four to a vector.
    four: array<vec4<f32>, 256>,
}

@group(0) @binding(1) var<uniform> ltc_nodes: LtcNodes;

/// The node at a place in the list: alpha's first, then ratio's, theta's and phi's.
fn ltc_node(place: u32) -> f32 {
    let four = ltc_nodes.four[place / 4u];
    return four[place % 4u];
}
