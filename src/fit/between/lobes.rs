//! Estimates the best lobes between the nodes by interpolating the lobes at the nodes. Lobes that follow the reflection
//! are interpolated relative to the reflection.

use glam::DMat3;

use crate::{
    axes::PerAxis,
    brdf::{LobeTerms, Mirrors},
    entry::FittedEntry,
    layout::{Layout, LobeNumbers, Precision, Spacing, within_limits},
    math::from_row_major,
    shard::Plan,
};

use super::least_squares::corners;

/// A lobe between nodes.
pub(super) struct InterpolatedLobe {
    pub(super) place: PerAxis<f64>,
    pub(super) lobe: LobeNumbers,
    /// The error of a lobe fitted at this point.
    pub(super) error: f64,
}

/// The fitted lobes, as numbers that change little between nodes. The numbers are relative to the reflection if the
/// lobes follow the reflection.
pub(super) struct Lobes {
    spacing: PerAxis<Spacing>,
    /// The layout whose numbers change little between nodes.
    smooth: Layout,
    /// Nodes of alpha and theta, on the scale in which the interpolation weights are linear.
    alpha: Vec<f64>,
    theta: Vec<f64>,
    /// Polar angles of the nodes, radians.
    angles: Vec<f64>,
    beside: Vec<(LobeNumbers, f64)>,
}

impl Lobes {
    /// The lobes of a plan with one ratio and one phi.
    pub(super) fn of(plan: &Plan, entries: &[FittedEntry]) -> Self {
        let nodes = plan.nodes();
        let spacing = plan.recipe().layout.rules().weights();
        let smooth = if plan.recipe().brdf.follows_reflection() { Layout::Reflected } else { Layout::Kt2022 };
        let beside = |(index, entry): (u64, &FittedEntry)| {
            let place = plan.place(index);
            let lobe = LobeNumbers {
                matrix: from_row_major(&entry.matrix),
                terms: LobeTerms { amplitude: entry.amplitude, fresnel: entry.fresnel },
            };
            let rules = smooth.rules();
            let mut stored = rules.store(&place, &lobe, Mirrors::of(place.view()), Precision::F32);
            stored.matrix *= 1.0 / rules.norm(&stored.matrix);
            (stored, entry.error)
        };
        Self {
            spacing,
            smooth,
            alpha: nodes.alpha.iter().map(|alpha| spacing.alpha.invert(*alpha)).collect(),
            theta: nodes.theta.iter().map(|theta| spacing.theta.invert(*theta)).collect(),
            angles: nodes.theta.clone(),
            beside: (0..).zip(entries).map(beside).collect(),
        }
    }

    /// The difference in radians between the theta nodes `column` and `column + 1`.
    pub(super) fn angle(&self, column: usize) -> f64 {
        self.angles[column + 1] - self.angles[column]
    }

    /// The lobe in the cell whose first corner is the node at `row` and `column`. `at` is the position in the cell, in
    /// [0, 1].
    pub(super) fn between(&self, [row, column]: [usize; 2], at: [f64; 2]) -> InterpolatedLobe {
        let middle = |steps: &[f64], part: f64| steps[0] + (steps[1] - steps[0]) * part;
        let place = within_limits(PerAxis {
            alpha: self.spacing.alpha.value(middle(&self.alpha[row..], at[0])),
            ratio: 1.0,
            theta: self.spacing.theta.value(middle(&self.theta[column..], at[1])),
            phi: 0.0,
        });
        let (mut matrix, mut amplitude, mut fresnel, mut error) = (DMat3::ZERO, 0.0, 0.0, 0.0);
        for (down, right, phi) in corners(at) {
            let (beside, of_fit) = &self.beside[(row + down) * self.theta.len() + column + right];
            matrix += beside.matrix * phi;
            amplitude += beside.terms.amplitude * phi;
            fresnel += beside.terms.fresnel * phi;
            error += of_fit * phi;
        }
        let beside = LobeNumbers { matrix, terms: LobeTerms { amplitude, fresnel } };
        InterpolatedLobe { place, lobe: self.smooth.rules().restore(&place, &beside), error }
    }
}
