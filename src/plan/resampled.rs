//! A table with other nodes on one axis, read from a table with more nodes.

use ltcforge_fit::{PerAxis, Recipe, Table, Terms};

/// Replaces the value of one axis.
pub(crate) fn with<T>(mut axes: PerAxis<T>, axis: usize, value: T) -> PerAxis<T> {
    *[&mut axes.alpha, &mut axes.ratio, &mut axes.theta, &mut axes.phi][axis] = value;
    axes
}

/// The table of a recipe with `count` evenly spaced nodes on one axis. Domain: see [`resampled`].
pub(crate) fn coarser(table: &Table, recipe: &Recipe, axis: usize, count: u32) -> Table {
    let nodes = recipe.layout.nodes(&recipe.range, &with(recipe.resolution, axis, count));
    resampled(table, axis, nodes.named()[axis].1.clone())
}

/// The table with other nodes on one axis, interpolated linearly. Domain: nodes within the table's range, no edge term,
/// and a layout whose weights are linear in the values of the axes.
pub(crate) fn resampled(table: &Table, axis: usize, nodes: Vec<f64>) -> Table {
    let lengths = table.axes.named().map(|(_, nodes)| nodes.len());
    // Later axes vary faster.
    let entries_of_node: usize = lengths[axis + 1..].iter().product();
    let brackets: Vec<_> = nodes.iter().map(|x| bracket(table.axes.named()[axis].1, *x)).collect();
    let mut corners = Vec::new();
    for first in (0..table.matrix.len()).step_by(lengths[axis] * entries_of_node) {
        for bracket in &brackets {
            let entry = |i| bracket.map(|(node, weight)| (first + node * entries_of_node + i, weight));
            corners.extend((0..entries_of_node).map(entry));
        }
    }
    let blend = |corners: &[(usize, f64); 2], number: &dyn Fn(usize) -> f32| {
        corners.iter().map(|(entry, weight)| weight * f64::from(number(*entry))).sum::<f64>() as f32
    };
    let numbers = |stored: &Vec<f32>| corners.iter().map(|corners| blend(corners, &|entry| stored[entry])).collect();
    let matrices = |stored: &Vec<[f32; 9]>| -> Vec<[f32; 9]> {
        let matrix = |corners| std::array::from_fn(|i| blend(corners, &|entry| stored[entry][i]));
        corners.iter().map(matrix).collect()
    };
    let terms =
        |terms: &Terms| Terms { amplitude: numbers(&terms.amplitude), fresnel: numbers(&terms.fresnel), edge: None };
    Table {
        axes: with(table.axes.clone(), axis, nodes),
        matrix: matrices(&table.matrix),
        second: table.second.as_ref().map(matrices),
        terms: table.terms.as_ref().map(terms),
        node_error: numbers(&table.node_error),
        ..table.clone()
    }
}

/// The nodes around a value with their weights.
fn bracket(nodes: &[f64], x: f64) -> [(usize, f64); 2] {
    if nodes.len() < 2 {
        return [(0, 1.0), (0, 0.0)];
    }
    let upper = nodes.partition_point(|node| *node <= x).clamp(1, nodes.len() - 1);
    let (low, high) = (nodes[upper - 1], nodes[upper]);
    let weight = ((x - low) / (high - low)).clamp(0.0, 1.0);
    [(upper - 1, 1.0 - weight), (upper, weight)]
}
