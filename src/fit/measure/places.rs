//! The configurations at which a table is measured.

use std::f64::consts::FRAC_PI_2;

use crate::{ALPHA_FLOOR, Configuration, LEAST_ALPHA, Layout, PerAxis, THETA_CEILING, Table, math::recurrence4};

/// The largest angle of views between nodes, 89 degrees. Beyond this angle most of a lobe is below the horizon, where
/// it is not visible.
const STEEPEST: f64 = 0.99 * FRAC_PI_2;
/// The shift of the sequence of configurations between nodes.
const SHIFT: [f64; 4] = [0.449_489_742_783_178, 0.316_624_790_355_4, 0.872_983_346_207_417, 0.123_105_625_617_661];
/// 1 / golden ratio. Multiples of this step cover a circle most evenly.
const GOLDEN_STEP: f64 = 0.618_033_988_749_894_9;

/// The nodes that a lookup can reach; if there are more than `most` of them, `most` nodes, evenly spread.
///
/// The indices are `k stride mod n`. The stride is near n / golden ratio and has no common divisor with n. Therefore no
/// node occurs twice, and the nodes of each axis are evenly covered.
pub(super) fn nodes(layout: Layout, axes: &PerAxis<Vec<f64>>, most: usize) -> Vec<Configuration> {
    let reached = reached(layout, axes);
    let n = reached.len();
    if n <= most {
        return reached;
    }
    let mut stride = ((n as f64 * GOLDEN_STEP) as usize).max(1);
    while common_divisor(stride, n) > 1 {
        stride += 1;
    }
    (1..=most).map(|k| reached[k * stride % n]).collect()
}

/// The nodes in storage order, without nodes whose smaller roughness is below [`LEAST_ALPHA`]. A lookup at such a node
/// raises this roughness and the ratio, and therefore reads between other nodes. Returns all nodes if there are only
/// such nodes.
fn reached(layout: Layout, axes: &PerAxis<Vec<f64>>) -> Vec<Configuration> {
    let entries = layout.lengths(axes).named().iter().map(|(_, n)| **n).product::<usize>();
    let nodes = || (0..entries).map(|index| node(layout, axes, index));
    let reached: Vec<Configuration> = nodes().filter(|node| node.alpha_y >= LEAST_ALPHA).collect();
    if reached.is_empty() { nodes().collect() } else { reached }
}

fn common_divisor(a: usize, b: usize) -> usize {
    if b == 0 { a } else { common_divisor(b, a % b) }
}

/// The configuration of the entry `index` in storage order: phi varies fastest. At the horizon no light is reflected,
/// so a node there has the lobe of the most grazing fitted view.
pub(super) fn node(layout: Layout, axes: &PerAxis<Vec<f64>>, index: usize) -> Configuration {
    let PerAxis { alpha, ratio, theta, phi } = layout.node(axes, index);
    configuration(alpha, ratio, theta.min(THETA_CEILING), phi)
}

/// `count` configurations within the axes, distributed as artists set them: evenly in perceptual roughness (the square
/// root of alpha), ratio, theta and phi.
pub(super) fn between(axes: &PerAxis<Vec<f64>>, count: usize) -> Vec<Configuration> {
    let (roughness, theta) = roughness_and_theta(axes);
    let (ratio, phi) = (ends(&axes.ratio), ends(&axes.phi));
    let at = |[low, high]: [f64; 2], u: f64| low + (high - low) * u;
    (0..count)
        .map(|i| {
            let [a, r, t, p] = recurrence4(i, SHIFT);
            let roughness = at(roughness, a);
            configuration(roughness * roughness, at(ratio, r), at(theta, t), at(phi, p))
        })
        .collect()
}

/// `count` configurations of a table. For tables of [materials](crate::Layout::is_of_materials), each material occurs
/// equally often, at views between the nodes. For other tables, equals [`between`].
pub(super) fn within(table: &Table, count: usize) -> Vec<Configuration> {
    let pairs: Vec<[f64; 2]> = table.materials().collect();
    let mut places = between(&table.axes, count);
    if !pairs.is_empty() {
        for (i, place) in places.iter_mut().enumerate() {
            let [u, ..] = recurrence4(i, SHIFT);
            let [alpha, ratio] = pairs[((u * pairs.len() as f64) as usize).min(pairs.len() - 1)];
            (place.alpha_x, place.alpha_y) = (alpha, alpha * ratio);
        }
    }
    places
}

/// The ranges of perceptual roughness and theta in which a table is measured between its nodes.
pub(super) fn roughness_and_theta(axes: &PerAxis<Vec<f64>>) -> ([f64; 2], [f64; 2]) {
    let [low, high] = ends(&axes.theta);
    (extent(&axes.alpha).map(|alpha| alpha.max(ALPHA_FLOOR).sqrt()), [low, high.min(STEEPEST).max(low)])
}

fn ends(nodes: &[f64]) -> [f64; 2] {
    [nodes[0], nodes[nodes.len() - 1]]
}

/// The smallest and the largest of some nodes.
pub(super) fn extent(nodes: &[f64]) -> [f64; 2] {
    nodes.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| [low.min(*x), high.max(*x)])
}

pub(super) fn configuration(alpha: f64, ratio: f64, theta: f64, phi: f64) -> Configuration {
    Configuration { alpha_x: alpha, alpha_y: alpha * ratio, theta, phi }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn axes() -> PerAxis<Vec<f64>> {
        PerAxis {
            alpha: vec![0.04, 0.1, 0.5, 1.0],
            ratio: vec![0.25, 0.5, 1.0],
            theta: vec![0.0, 0.5, 1.0, 1.5, 1.570_639],
            phi: vec![0.0, 0.7, FRAC_PI_2],
        }
    }

    #[test]
    fn a_few_nodes_are_spread_over_every_axis_and_none_comes_twice() {
        let (all, some) = (nodes(Layout::Kt2022, &axes(), 180), nodes(Layout::Kt2022, &axes(), 40));
        assert_eq!((all.len(), some.len()), (180, 40));
        assert_eq!(all[179], configuration(1.0, 1.0, 1.570_639, FRAC_PI_2));
        for (i, place) in some.iter().enumerate() {
            assert!(all.contains(place) && !some[..i].contains(place), "{place:?}");
        }
        let met = |wanted: fn(&Configuration, f64) -> bool, nodes: &[f64]| {
            nodes.iter().all(|node| some.iter().filter(|place| wanted(place, *node)).count() >= 6)
        };
        assert!(met(|place, node| place.alpha_x == node, &axes().alpha));
        assert!(met(|place, node| place.alpha_y == place.alpha_x * node, &axes().ratio));
        assert!(met(|place, node| place.theta == node, &axes().theta));
        assert!(met(|place, node| place.phi == node, &axes().phi));
    }

    #[test]
    fn nodes_that_no_lookup_reaches_are_left_out_unless_there_are_no_others() {
        // Only the product of 1e-4 and 0.01 is below 1e-5: 15 of 180 nodes.
        let sharp = PerAxis { alpha: vec![1e-4, 0.1, 0.5, 1.0], ratio: vec![0.01, 0.5, 1.0], ..axes() };
        let found = nodes(Layout::Kt2022, &sharp, 180);
        assert_eq!(found.len(), 165);
        assert!(found.iter().all(|place| place.alpha_y >= LEAST_ALPHA));
        assert!(found.contains(&configuration(1e-4, 0.5, 0.0, 0.0)));
        let sharpest = PerAxis { alpha: vec![1e-4], ratio: vec![0.01], ..axes() };
        assert_eq!(nodes(Layout::Kt2022, &sharpest, 180).len(), 15);
    }

    #[test]
    fn between_lies_within_the_ranges_and_roughness_is_perceptual() {
        let places = between(&axes(), 512);
        for place in &places {
            assert!((0.04..=1.0).contains(&place.alpha_x) && (0.25..=1.0).contains(&(place.alpha_y / place.alpha_x)));
            assert!((0.0..=STEEPEST).contains(&place.theta) && (0.0..=FRAC_PI_2).contains(&place.phi));
        }
        // Perceptual roughness ranges from 0.2 to 1, and the midpoint is 0.6.
        let smoother = places.iter().filter(|place| place.alpha_x < 0.36).count();
        assert!((246..=266).contains(&smoother), "{smoother}");
    }

    #[test]
    fn a_single_node_is_the_only_value() {
        let single = PerAxis { alpha: vec![0.3], ratio: vec![1.0], theta: vec![1.57], phi: vec![0.0] };
        let only = Configuration { alpha_x: 0.3, alpha_y: 0.3, theta: 1.57, phi: 0.0 };
        let places = between(&single, 3);
        assert!(places.iter().all(|place| (place.alpha_x - 0.3).abs() < 1e-15 && place.theta == 1.57), "{places:?}");
        assert_eq!(nodes(Layout::Kt2022, &single, 32), [only]);
    }
}
