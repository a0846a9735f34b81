//! Looks up a table at any configuration, like a shader.

use glam::DMat3;

use super::{Configuration, Table, Terms, fold::Folded};
use crate::{
    axes::PerAxis,
    brdf::{LobeTerms, edge_of_parts},
    layout::{LobeNumbers, Spacing, nearest_material},
    math::{from_row_major, row_major, turned_about_z},
};

/// The numbers of a table at a configuration.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LookedUp {
    /// `M` in the surface's tangent frame, row-major.
    pub matrix: [f64; 9],
    /// The matrix of the second lobe, if entries have two lobes.
    pub second: Option<[f64; 9]>,
    /// Directional albedo for a Fresnel factor of one, if the table has terms.
    pub amplitude: Option<f64>,
    /// The albedo weighted by Schlick's fifth power, if the table has terms.
    pub fresnel: Option<f64>,
    /// The albedo weighted by [`edge_weight`](crate::brdf::edge_weight), if the table has the edge term.
    pub edge: Option<f64>,
}

/// The two nodes of an axis around a value.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Bracket {
    lower: usize,
    /// Weight of the node after `lower`, in [0, 1]; zero after the last node.
    weight: f64,
}

impl Bracket {
    /// The nodes around `x`; outside of the nodes, the nearest node. Nodes are ascending. The weight is linear in the
    /// steps of `spacing`.
    fn find(nodes: &[f64], x: f64, spacing: Spacing) -> Self {
        let upper = nodes.partition_point(|node| *node <= x);
        if upper == 0 || upper == nodes.len() {
            return Self { lower: upper.saturating_sub(1), weight: 0.0 };
        }
        let [low, x, high] = [nodes[upper - 1], x, nodes[upper]].map(|x| spacing.invert(x));
        Self { lower: upper - 1, weight: (x - low) / (high - low) }
    }

    /// The nodes with their weights. Nodes of zero weight are left out, because they may not exist.
    fn corners(self) -> impl Iterator<Item = (usize, f64)> {
        [(self.lower, 1.0 - self.weight), (self.lower + 1, self.weight)].into_iter().filter(|(_, weight)| *weight > 0.0)
    }
}

/// Clamps `x` to the range of an axis's nodes. Materials are not sorted, so the smallest and largest node are searched
/// for.
fn clamped(x: f64, nodes: &[f64]) -> f64 {
    let least = nodes.iter().copied().fold(f64::INFINITY, f64::min);
    let most = nodes.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    if least <= most { x.clamp(least, most) } else { x }
}

impl Table {
    /// The numbers of the table at a configuration. Phi can be in any quadrant, and either roughness can be larger.
    /// Configurations outside of the table's ranges are clamped to them. Between nodes, weights are linear along each
    /// axis. A table of [materials](crate::Layout::is_of_materials) returns its nearest material.
    ///
    /// Domain: finite numbers, and a table with at least one node on each axis.
    #[must_use]
    pub fn lookup(&self, configuration: &Configuration) -> LookedUp {
        let folded = Folded::of(configuration);
        let axes = &self.axes;
        let turn = self.serves_every_phi().then(|| folded.phi - axes.phi[0]);
        let nearest = PerAxis {
            alpha: clamped(folded.alpha, &axes.alpha),
            ratio: clamped(folded.ratio, &axes.ratio),
            theta: clamped(configuration.theta, &axes.theta),
            phi: clamped(folded.phi, &axes.phi),
        };
        let restored =
            |matrices: &[[f32; 9]]| self.layout.rules().restore(&nearest, &self.interpolate(matrices, &nearest));
        let unfolded =
            |matrix: DMat3| row_major(&folded.unfold(turn.map_or(matrix, |angle| turned_about_z(matrix, angle))));
        let lobe = restored(&self.matrix);
        let second = self.second.as_deref().map(|matrices| unfolded(restored(matrices).matrix));
        let [amplitude, fresnel] =
            [lobe.terms.amplitude, lobe.terms.fresnel].map(|term| self.terms.as_ref().map(|_| term));
        let one_incidence = edge_of_parts([lobe.terms.amplitude, lobe.terms.fresnel]);
        let edge = self.edge_spread_at(&nearest).map(|spread| spread * one_incidence);
        LookedUp { matrix: unfolded(lobe.matrix), second, amplitude, fresnel, edge }
    }

    /// The numbers of a table of [materials](crate::Layout::is_of_materials) for the material at this index, with the
    /// larger roughness along x; `None` for an invalid index.
    #[must_use]
    pub fn lookup_material(&self, material: usize, theta: f64, phi: f64) -> Option<LookedUp> {
        let [alpha, ratio] = self.materials().nth(material)?;
        Some(self.lookup(&Configuration { alpha_x: alpha, alpha_y: alpha * ratio, theta, phi }))
    }

    /// The index of the material that a lookup at a roughness finds; `None` for a table without materials.
    #[must_use]
    pub fn material_near(&self, alpha: f64, ratio: f64) -> Option<usize> {
        self.layout.is_of_materials().then(|| nearest_material(self.materials(), alpha, ratio))
    }

    /// True for a table of isotropic surfaces with one phi. The table is valid for every phi, because the lobe turns
    /// with the view.
    #[must_use]
    pub fn serves_every_phi(&self) -> bool {
        self.axes.ratio.iter().all(|ratio| *ratio == 1.0) && self.axes.phi.len() == 1
    }

    /// The edge spread at a point within the nodes. All layouts store it unchanged.
    fn edge_spread_at(&self, place: &PerAxis<f64>) -> Option<f64> {
        let edge = self.terms.as_ref()?.edge.as_ref()?;
        Some(self.corners(&self.brackets(place)).map(|(index, weight)| weight * f64::from(edge[index])).sum())
    }

    /// The nodes around a point within the nodes.
    fn brackets(&self, place: &PerAxis<f64>) -> PerAxis<Bracket> {
        let axes = &self.axes;
        let spacing = self.layout.rules().weights();
        let [alpha, ratio] = if self.layout.is_of_materials() {
            let material = self.material_near(place.alpha, place.ratio).unwrap_or_default();
            [material, 0].map(|lower| Bracket { lower, weight: 0.0 })
        } else {
            [
                Bracket::find(&axes.alpha, place.alpha, spacing.alpha),
                Bracket::find(&axes.ratio, place.ratio, spacing.ratio),
            ]
        };
        PerAxis {
            alpha,
            ratio,
            theta: Bracket::find(&axes.theta, place.theta, spacing.theta),
            phi: Bracket::find(&axes.phi, place.phi, spacing.phi),
        }
    }

    /// Matrix and terms, interpolated between the entries around a point within the nodes. The terms are zero for a
    /// table without terms.
    fn interpolate(&self, matrices: &[[f32; 9]], place: &PerAxis<f64>) -> LobeNumbers {
        let (mut matrix, mut terms) = ([0.0; 9], [0.0; 2]);
        for (index, weight) in self.corners(&self.brackets(place)) {
            for (sum, stored) in matrix.iter_mut().zip(&matrices[index]) {
                *sum += weight * f64::from(*stored);
            }
            if let Some(Terms { amplitude, fresnel, .. }) = &self.terms {
                terms[0] += weight * f64::from(amplitude[index]);
                terms[1] += weight * f64::from(fresnel[index]);
            }
        }
        let [amplitude, fresnel] = terms;
        LobeNumbers { matrix: from_row_major(&matrix), terms: LobeTerms { amplitude, fresnel } }
    }

    /// The entries around a point, with weights that add up to one.
    fn corners(&self, place: &PerAxis<Bracket>) -> impl Iterator<Item = (usize, f64)> {
        let PerAxis { ratio, theta, phi, .. } = self.lengths();
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
