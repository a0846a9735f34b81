//! Reading a table at any configuration, as a shader would.

use super::{Configuration, Layout, PerAxis, Table, fold::Folded};
use crate::math::{from_row_major, row_major, turned_about_z};

/// What a table says of a configuration.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LookedUp {
    /// `M` in the surface's tangent frame, row-major.
    pub matrix: [f64; 9],
    /// Directional albedo for a Fresnel factor of one, if the table has terms.
    pub amplitude: Option<f64>,
    /// Its part weighted by Schlick's fifth power, if the table has terms.
    pub fresnel: Option<f64>,
}

/// A place between two neighbouring nodes of an axis.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Between {
    lower: usize,
    /// Weight of the node after `lower`, in [0, 1]; zero when there is none.
    weight: f64,
}

impl Between {
    /// Where `x` lies among ascending nodes; outside them, at the nearest.
    fn find(nodes: &[f64], x: f64) -> Self {
        let upper = nodes.partition_point(|node| *node <= x);
        if upper == 0 || upper == nodes.len() {
            return Self { lower: upper.saturating_sub(1), weight: 0.0 };
        }
        let (low, high) = (nodes[upper - 1], nodes[upper]);
        Self { lower: upper - 1, weight: (x - low) / (high - low) }
    }

    /// The nodes with their weights; a node without weight is left out, it may not exist.
    fn corners(self) -> impl Iterator<Item = (usize, f64)> {
        [(self.lower, 1.0 - self.weight), (self.lower + 1, self.weight)].into_iter().filter(|(_, weight)| *weight > 0.0)
    }
}

impl Table {
    /// The table at a configuration: all four quadrants of phi, either roughness larger; outside the table's ranges
    /// the nearest configuration inside. Between nodes, weights are linear along each axis.
    ///
    /// Domain: finite numbers. A table without entries has no lookup: its axes are never empty.
    #[must_use]
    pub fn lookup(&self, configuration: &Configuration) -> LookedUp {
        let folded = Folded::of(configuration);
        let axes = &self.axes;
        // A table of isotropic surfaces with one phi serves every phi: the lobe turns with the view.
        let turn = (axes.ratio == [1.0] && axes.phi.len() == 1).then(|| folded.phi - axes.phi[0]);
        let place = PerAxis {
            alpha: Between::find(&axes.alpha, folded.alpha),
            ratio: Between::find(&axes.ratio, folded.ratio),
            theta: Between::find(&axes.theta, configuration.theta),
            phi: Between::find(&axes.phi, folded.phi),
        };
        let mut matrix = [0.0; 9];
        let (mut amplitude, mut fresnel) = (0.0, 0.0);
        for (index, weight) in self.corners(&place) {
            for (sum, stored) in matrix.iter_mut().zip(&self.matrix[index]) {
                *sum += weight * f64::from(*stored);
            }
            if let Some(terms) = &self.terms {
                amplitude += weight * f64::from(terms.amplitude[index]);
                fresnel += weight * f64::from(terms.fresnel[index]);
            }
        }
        let m = from_row_major(&matrix);
        let m = match self.layout {
            Layout::Kt2022 => m,
        };
        let m = turn.map_or(m, |angle| turned_about_z(m, angle));
        LookedUp {
            matrix: row_major(&folded.unfold(m)),
            amplitude: self.terms.as_ref().map(|_| amplitude),
            fresnel: self.terms.as_ref().map(|_| fresnel),
        }
    }

    /// The entries around a place, with weights whose sum is one.
    fn corners(&self, place: &PerAxis<Between>) -> impl Iterator<Item = (usize, f64)> {
        let PerAxis { ratio, theta, phi, .. } = self.axes.lengths();
        let place = *place;
        place.alpha.corners().flat_map(move |(a, wa)| {
            place.ratio.corners().flat_map(move |(r, wr)| {
                place.theta.corners().flat_map(move |(t, wt)| {
                    let row = ((a * ratio + r) * theta + t) * phi;
                    place.phi.corners().map(move |(p, wp)| (row + p, wa * wr * wt * wp))
                })
            })
        })
    }
}

#[cfg(test)]
mod tests;
