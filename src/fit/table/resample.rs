//! A table with other nodes on one axis or with fewer lobes, read from a table with more.

use super::{LookedUp, Table, Terms};
use crate::{
    axes::PerAxis,
    brdf::{LobeFresnel, LobeTerms},
    recipe::Recipe,
};

impl<T> PerAxis<T> {
    /// Replaces the value of one axis, by the axis's index.
    #[must_use]
    pub fn with(mut self, axis: usize, value: T) -> Self {
        *[&mut self.alpha, &mut self.ratio, &mut self.theta, &mut self.phi][axis] = value;
        self
    }
}

impl Table {
    /// The table with other nodes on one axis, interpolated linearly. Domain: nodes within the table's range, no edge
    /// term, and a layout whose weights are linear in the values of the axes.
    #[must_use]
    pub fn resampled(&self, axis: usize, nodes: Vec<f64>) -> Self {
        let lengths = self.axes.named().map(|(_, nodes)| nodes.len());
        // Later axes vary faster.
        let entries_of_node: usize = lengths[axis + 1..].iter().product();
        let brackets: Vec<_> = nodes.iter().map(|x| bracket(self.axes.named()[axis].1, *x)).collect();
        let mut corners = Vec::new();
        for first in (0..self.matrix.len()).step_by(lengths[axis] * entries_of_node) {
            for bracket in &brackets {
                let entry = |i| bracket.map(|(node, weight)| (first + node * entries_of_node + i, weight));
                corners.extend((0..entries_of_node).map(entry));
            }
        }
        let blend = |corners: &[(usize, f64); 2], number: &dyn Fn(usize) -> f32| {
            corners.iter().map(|(entry, weight)| weight * f64::from(number(*entry))).sum::<f64>() as f32
        };
        let numbers =
            |stored: &Vec<f32>| corners.iter().map(|corners| blend(corners, &|entry| stored[entry])).collect();
        let matrices = |stored: &Vec<[f32; 9]>| -> Vec<[f32; 9]> {
            let matrix = |corners| std::array::from_fn(|i| blend(corners, &|entry| stored[entry][i]));
            corners.iter().map(matrix).collect()
        };
        let terms = |terms: &Terms| Terms {
            amplitude: numbers(&terms.amplitude),
            fresnel: numbers(&terms.fresnel),
            edge: None,
        };
        Table {
            axes: self.axes.clone().with(axis, nodes),
            matrix: matrices(&self.matrix),
            second: self.second.as_ref().map(matrices),
            terms: self.terms.as_ref().map(terms),
            node_error: numbers(&self.node_error),
            ..self.clone()
        }
    }

    /// The table of a recipe with `count` evenly spaced nodes on one axis. Domain: see [`Table::resampled`].
    #[must_use]
    pub fn coarser(&self, recipe: &Recipe, axis: usize, count: u32) -> Self {
        let nodes = recipe.layout.nodes(&recipe.range, &recipe.resolution.with(axis, count));
        self.resampled(axis, nodes.named()[axis].1.clone())
    }

    /// The table of one lobe for each entry, the blend of two lobes for the reflectance that one lobe would be fitted
    /// to. A table without a second lobe or terms does not change.
    #[must_use]
    pub fn with_one_lobe(&self, fresnel: &LobeFresnel) -> Self {
        let (Some(second), Some(terms)) = (&self.second, &self.terms) else { return self.clone() };
        let blended = |entry: usize| {
            let (amplitude, schlick) = (terms.amplitude[entry].into(), terms.fresnel[entry].into());
            let [matrix, second] = [&self.matrix, second].map(|stored| stored[entry].map(f64::from));
            let (second, edge) = (Some(second), None);
            let both = LookedUp { matrix, second, amplitude: Some(amplitude), fresnel: Some(schlick), edge };
            both.blended_for(fresnel.f0(&LobeTerms { amplitude, fresnel: schlick })).matrix.map(|x| x as f32)
        };
        let matrix = (0..self.matrix.len()).map(blended).collect();
        Self { brdf: self.brdf.clone().with_fresnel(fresnel.clone()), second: None, matrix, ..self.clone() }
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
