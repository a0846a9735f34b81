// The nodes of a table's axes in a storage buffer.

@group(0) @binding(1) var<storage, read> ltc_nodes: array<f32>;

/// The node at a place in the list: alpha's first, then ratio's, theta's and phi's.
fn ltc_node(place: u32) -> f32 {
    return ltc_nodes[place];
}
