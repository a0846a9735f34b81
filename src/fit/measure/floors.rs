//! Counts the nodes that a recipe requests beyond the limits of the fit. The fit moves these nodes to the limit.

use serde::Serialize;

use crate::{ALPHA_FLOOR, LEAST_ALPHA, Layout, PerAxis, RATIO_FLOOR, THETA_CEILING};

/// The limits of a table's axes, with the number of moved nodes.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Floors {
    /// [`ALPHA_FLOOR`].
    pub alpha: Moved,
    /// [`RATIO_FLOOR`].
    pub ratio: Moved,
    /// [`LEAST_ALPHA`]: pairs of nodes of alpha and ratio whose product is below it. Their entries have the lobe at the
    /// limit.
    pub alpha_y: Moved,
    /// [`THETA_CEILING`], radians.
    pub theta: Moved,
}

/// The nodes and entries that a limit moved.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Moved {
    /// The value of the limit.
    pub floor: f64,
    /// Nodes of the axis that were requested beyond the limit.
    pub nodes: usize,
    /// Entries at these nodes.
    pub entries: usize,
}

impl Floors {
    /// The limits of a table with these axes, whose recipe requested `range`. Each material counts as a node of alpha
    /// and as a node of ratio.
    pub(super) fn of(layout: Layout, axes: &PerAxis<Vec<f64>>, range: &PerAxis<[f64; 2]>) -> Self {
        let PerAxis { alpha, ratio, theta, phi } = layout.lengths(axes);
        let is_of_materials = layout.is_of_materials();
        let moved =
            |floor: f64, nodes: usize, entries_each: usize| Moved { floor, nodes, entries: nodes * entries_each };
        // If a range reaches past the limit, its outermost node is on the limit, or past the limit in layouts whose
        // shaders need a node there.
        let at_limit = |nodes: &[f64], is_at: &dyn Fn(f64) -> bool, reaches_past: bool| {
            if reaches_past { nodes.iter().filter(|node| is_at(**node)).count() } else { 0 }
        };
        // The first entry of each surface has the surface's alpha and ratio.
        let surfaces = (0..alpha * ratio).map(|surface| layout.node(axes, surface * theta * phi));
        let pairs = surfaces.map(|node| node.alpha * node.ratio);
        Self {
            alpha: moved(
                ALPHA_FLOOR,
                at_limit(&axes.alpha, &|node| node <= ALPHA_FLOOR, range.alpha[0] < ALPHA_FLOOR),
                ratio * theta * phi,
            ),
            ratio: moved(
                RATIO_FLOOR,
                at_limit(&axes.ratio, &|node| node <= RATIO_FLOOR, range.ratio[0] < RATIO_FLOOR),
                if is_of_materials { theta * phi } else { alpha * theta * phi },
            ),
            alpha_y: moved(LEAST_ALPHA, pairs.filter(|alpha_y| *alpha_y < LEAST_ALPHA).count(), theta * phi),
            theta: moved(
                THETA_CEILING,
                at_limit(&axes.theta, &|node| node >= THETA_CEILING, range.theta[1] > THETA_CEILING),
                alpha * ratio * phi,
            ),
        }
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::FRAC_PI_2;

    use super::*;

    #[test]
    fn moved_nodes_and_their_entries_are_counted() {
        let axes = PerAxis {
            alpha: vec![ALPHA_FLOOR, 0.5, 1.0],
            ratio: vec![RATIO_FLOOR, 1.0],
            theta: vec![0.0, 0.4, 0.8, THETA_CEILING],
            phi: vec![0.0, 0.3, 0.6, 0.9, 1.2],
        };
        let whole = PerAxis { alpha: [0.0, 1.0], ratio: [0.0, 1.0], theta: [0.0, FRAC_PI_2], phi: [0.0, 1.2] };
        let found = Floors::of(Layout::Kt2022, &axes, &whole);
        let counts = |moved: Moved| (moved.nodes, moved.entries);
        assert_eq!(counts(found.alpha), (1, 40));
        assert_eq!(counts(found.ratio), (1, 60));
        // Only the product of 1e-4 and 1e-4 is below 1e-5.
        assert_eq!(counts(found.alpha_y), (1, 20));
        assert_eq!(counts(found.theta), (1, 30));

        // Nodes requested exactly on the limits are not moved.
        let exact = PerAxis {
            alpha: [ALPHA_FLOOR, 1.0],
            ratio: [RATIO_FLOOR, 1.0],
            theta: [0.0, THETA_CEILING],
            phi: [0.0, 1.2],
        };
        let found = Floors::of(Layout::Kt2022, &axes, &exact);
        assert_eq!([found.alpha, found.ratio, found.theta].map(|moved| moved.nodes), [0; 3]);
    }
}
