//! Nodes of an axis that are not evenly spaced: a scene's own values, or nodes that are closer together where the scene
//! has more surface.

use crate::{histogram::decimal, needs::Needs};
use ltcforge_fit::{Layout, PerAxis, math::pow};

/// The number of scene values that may be listed as nodes of an axis. Two values are the ends of the range, which are
/// always nodes.
const VALUES: std::ops::RangeInclusive<usize> = 3..=16;
/// Number of parts of an axis. The weights in each part are summed.
const PARTS: u32 = 64;
/// The part of the weight that is spread evenly, so that no part of an axis is without nodes.
const SPREAD: f64 = 0.05;

/// Listed nodes of an axis.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Placed {
    /// The nodes, ascending.
    pub(crate) nodes: Vec<f64>,
    /// The error that the nodes add to the coarse table's error; `None` for the scene's own values, which need no
    /// interpolation.
    pub(crate) added: Option<f64>,
}

/// A scene's values of alpha or ratio as nodes, if there are few values.
pub(crate) fn of_values(needs: &Needs<'_>, axis: usize) -> Option<Placed> {
    let mut nodes: Vec<f64> = needs.spots().map(|(spot, _)| spot.pair()[axis]).collect();
    nodes.sort_by(f64::total_cmp);
    nodes.dedup();
    VALUES.contains(&nodes.len()).then_some(Placed { nodes, added: None })
}

/// Nodes of alpha (axis 0) or ratio (axis 1) for weighted values. Each interval between nodes has the same part of the
/// cube root of the weight. The error of linear interpolation grows with the square of a step, so these nodes have the
/// least weighted error. Steps are measured in the layout's spacing of nodes. Domain: a range of several values, at
/// least two nodes.
pub(crate) fn by_weight(
    layout: Layout,
    range: &PerAxis<[f64; 2]>,
    axis: usize,
    values: impl Iterator<Item = (f64, f64)>,
    count: u32,
) -> Vec<f64> {
    let parts = layout.nodes(range, &PerAxis { alpha: PARTS + 1, ratio: PARTS + 1, theta: 2, phi: 2 });
    let edges = parts.named()[axis].1;
    let mut weights = vec![0.0; PARTS as usize];
    for (value, weight) in values {
        weights[edges.partition_point(|edge| *edge <= value).clamp(1, PARTS as usize) - 1] += weight;
    }
    let total: f64 = weights.iter().sum();
    let least = SPREAD / f64::from(PARTS);
    let density = |weight: &f64| pow(weight / total * (1.0 - SPREAD) + least, 1.0 / 3.0);
    // The sum of the densities before each part, and the total.
    let mut sums = vec![0.0];
    sums.extend(weights.iter().scan(0.0, |sum, weight| {
        *sum += density(weight);
        Some(*sum)
    }));
    let last = count - 1;
    let at = |node: u32| {
        let wanted = sums[PARTS as usize] * f64::from(node) / f64::from(last);
        let part = sums[1..].partition_point(|sum| *sum < wanted).min(PARTS as usize - 1);
        let within = (wanted - sums[part]) / (sums[part + 1] - sums[part]);
        edges[part] + (edges[part + 1] - edges[part]) * within
    };
    let inner = (1..last).map(|node| decimal(at(node)));
    [edges[0]].into_iter().chain(inner).chain([edges[PARTS as usize]]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn placed(spots: &[(f64, f64)]) -> Vec<f64> {
        let range = PerAxis { alpha: [0.04, 0.64], ratio: [1.0; 2], theta: [0.0, 1.5], phi: [0.0; 2] };
        by_weight(Layout::Reflected, &range, 0, spots.iter().copied(), 6)
    }

    #[test]
    fn equal_weights_are_spaced_as_the_layout_spaces_nodes() {
        let range = PerAxis { alpha: [0.04, 0.64], ratio: [1.0; 2], theta: [0.0, 1.5], phi: [0.0; 2] };
        let nodes =
            |count| Layout::Reflected.nodes(&range, &PerAxis { alpha: count, ratio: 1, theta: 2, phi: 1 }).alpha;
        // One weight in the middle of each of the 64 parts.
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
