//! Nodes of an axis that are not evenly spaced: a scene's own values, or closer together where more of its surface is.

use crate::needs::decimal;
use ltcforge_fit::{Layout, PerAxis, math::pow};

/// How many values of a scene may be nodes of an axis: more than evenly spaced nodes are sure to fall on, and not many.
const VALUES: std::ops::RangeInclusive<usize> = 3..=16;
/// Parts of an axis by which weights are told.
const PARTS: u32 = 64;
/// The part of the weight that is spread evenly, so that no stretch of an axis is without nodes.
const SPREAD: f64 = 0.05;

/// Nodes of an axis that a recipe gives one by one.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Placed {
    /// The nodes, ascending.
    pub(crate) nodes: Vec<f64>,
    /// The error that they add to the coarse table's; `None` of the scene's own values, which have none between them.
    pub(crate) added: Option<f64>,
}

/// The scene's values as nodes, where they are few.
pub(crate) fn of_values(values: &[f64]) -> Option<Placed> {
    VALUES.contains(&values.len()).then(|| Placed { nodes: values.to_vec(), added: None })
}

/// Nodes from one end of a range to the other, with as much of the cube root of the weight between any two: the error of linear
/// interpolation grows with the square of a step, and its weighted sum is least then. The measure of an axis, 0 for alpha and 1 for ratio, is
/// that in which the layout's nodes are evenly spaced. Domain: a range of several values, two nodes at least.
pub(crate) fn by_weight(
    layout: Layout,
    range: &PerAxis<[f64; 2]>,
    axis: usize,
    spots: &[(f64, f64)],
    count: u32,
) -> Vec<f64> {
    let all = PerAxis { alpha: PARTS + 1, ratio: PARTS + 1, theta: 2, phi: 2 };
    let placed = layout.nodes(range, &all);
    let edges = if axis == 0 { placed.alpha } else { placed.ratio };
    let mut weights = vec![0.0; PARTS as usize];
    for (value, weight) in spots {
        let part = edges.partition_point(|edge| edge <= value).clamp(1, PARTS as usize) - 1;
        weights[part] += weight;
    }
    let total: f64 = weights.iter().sum();
    let least = SPREAD / f64::from(PARTS);
    let density = |weight: &f64| pow(weight / total * (1.0 - SPREAD) + least, 1.0 / 3.0);
    let sums: Vec<f64> = weights
        .iter()
        .scan(0.0, |sum, weight| {
            *sum += density(weight);
            Some(*sum)
        })
        .collect();
    let whole = sums[sums.len() - 1];
    let last = count - 1;
    let at = |node: u32| {
        let wanted = whole * f64::from(node) / f64::from(last);
        let part = sums.partition_point(|sum| *sum < wanted).min(sums.len() - 1);
        let before = if part == 0 { 0.0 } else { sums[part - 1] };
        let within = (wanted - before) / (sums[part] - before);
        edges[part] + (edges[part + 1] - edges[part]) * within
    };
    let inner = (1..last).map(|node| decimal(at(node)));
    [edges[0]].into_iter().chain(inner).chain([edges[edges.len() - 1]]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn placed(spots: &[(f64, f64)]) -> Vec<f64> {
        let range = PerAxis { alpha: [0.04, 0.64], ratio: [1.0; 2], theta: [0.0, 1.5], phi: [0.0; 2] };
        by_weight(Layout::Reflected, &range, 0, spots, 6)
    }

    #[test]
    fn equal_weights_are_spaced_as_the_layout_spaces_nodes() {
        let range = PerAxis { alpha: [0.04, 0.64], ratio: [1.0; 2], theta: [0.0, 1.5], phi: [0.0; 2] };
        let nodes =
            |count| Layout::Reflected.nodes(&range, &PerAxis { alpha: count, ratio: 1, theta: 2, phi: 1 }).alpha;
        // The middles of as many parts have one weight each.
        let spots: Vec<(f64, f64)> = nodes(129).into_iter().skip(1).step_by(2).map(|alpha| (alpha, 1.0)).collect();
        for (found, even) in placed(&spots).iter().zip(nodes(6)) {
            assert!((found - even).abs() < 1e-3, "{found} {even}");
        }
    }

    #[test]
    fn nodes_are_closer_together_where_more_surface_is() {
        let nodes = placed(&[(0.1, 8.0), (0.11, 8.0), (0.12, 8.0), (0.5, 1.0)]);
        assert_eq!((nodes.len(), nodes[0], nodes[5]), (6, 0.04, 0.64));
        assert!(nodes.windows(2).all(|pair| pair[0] < pair[1]), "{nodes:?}");
        let near = nodes.iter().filter(|node| (0.08..0.14).contains(*node)).count();
        assert!(near >= 2, "{nodes:?}");
    }
}
