//! A table with other nodes, read off one that has them closer together.

use ltcforge_fit::{PerAxis, Table, Terms};

/// The table with its stored numbers at other nodes within its own, linear between its own. Domain: no edge
/// term, and a layout whose weights are linear in the values of the axes.
pub(crate) fn resampled(table: &Table, axes: PerAxis<Vec<f64>>) -> Table {
    let own = table.lengths();
    let between =
        |own: &[f64], nodes: &[f64]| -> Vec<[(usize, f64); 2]> { nodes.iter().map(|x| around(own, *x)).collect() };
    let alpha = between(&table.axes.alpha, &axes.alpha);
    let ratio = between(&table.axes.ratio, &axes.ratio);
    let theta = between(&table.axes.theta, &axes.theta);
    let phi = between(&table.axes.phi, &axes.phi);
    let mut matrix = Vec::new();
    let mut second = table.second.as_ref().map(|_| Vec::new());
    let mut terms = table.terms.as_ref().map(|_| Terms { amplitude: Vec::new(), fresnel: Vec::new(), edge: None });
    let mut node_error = Vec::new();
    for a in &alpha {
        for r in &ratio {
            for t in &theta {
                for p in &phi {
                    let mut sum = [0.0; 21];
                    for corner in 0..16_usize {
                        let of = [a, r, t, p];
                        let at = |axis: usize| of[axis][corner >> axis & 1];
                        let weight = at(0).1 * at(1).1 * at(2).1 * at(3).1;
                        if weight == 0.0 {
                            continue;
                        }
                        let index = ((at(0).0 * own.ratio + at(1).0) * own.theta + at(2).0) * own.phi + at(3).0;
                        let terms =
                            table.terms.as_ref().map_or([0.0; 2], |of| [of.amplitude[index], of.fresnel[index]]);
                        let of_second = table.second.as_ref().map_or([0.0; 9], |second| second[index]);
                        let numbers = table.matrix[index].iter().chain(&terms).chain([&table.node_error[index]]);
                        let numbers = numbers.chain(&of_second);
                        sum.iter_mut().zip(numbers).for_each(|(sum, number)| *sum += weight * f64::from(*number));
                    }
                    matrix.push(std::array::from_fn(|i| sum[i] as f32));
                    if let Some(second) = &mut second {
                        second.push(std::array::from_fn(|i| sum[12 + i] as f32));
                    }
                    if let Some(terms) = &mut terms {
                        terms.amplitude.push(sum[9] as f32);
                        terms.fresnel.push(sum[10] as f32);
                    }
                    node_error.push(sum[11] as f32);
                }
            }
        }
    }
    Table { axes, matrix, second, terms, node_error, ..table.clone() }
}

/// The nodes around a value, with their weights.
fn around(nodes: &[f64], x: f64) -> [(usize, f64); 2] {
    let upper = nodes.partition_point(|node| *node <= x).clamp(1, nodes.len().max(2) - 1);
    if nodes.len() < 2 {
        return [(0, 1.0), (0, 0.0)];
    }
    let (low, high) = (nodes[upper - 1], nodes[upper]);
    let weight = ((x - low) / (high - low)).clamp(0.0, 1.0);
    [(upper - 1, 1.0 - weight), (upper, weight)]
}
