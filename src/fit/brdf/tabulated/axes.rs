//! The axes of a tabulated BRDF.

use std::f64::consts::{FRAC_PI_2, PI};

use super::TabulatedFault;

/// The ends of axes that have to be reached, and the nearest that two nodes may be: an f32 does not tell less of pi.
const TOLERANCE: f64 = 1e-6;

/// The nodes of a tabulated BRDF, each axis strictly ascending.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct TabulatedAxes {
    /// Roughness, the alpha of tables, in [0, 1]. Empty for a surface that has no roughness.
    pub alpha: Vec<f64>,
    /// Polar angle of the view direction, radians, within [0, pi/2]; two nodes at least.
    pub theta_o: Vec<f64>,
    /// Polar angle of the light direction, radians, from 0 to pi/2.
    pub theta_i: Vec<f64>,
    /// Difference of the azimuths of light and view, radians, from 0 (both on one side) to pi.
    pub phi: Vec<f64>,
}

impl TabulatedAxes {
    /// The axes with their names, in storage order.
    #[must_use]
    pub fn named(&self) -> [(&'static str, &[f64]); 4] {
        [("alpha", &self.alpha), ("theta_o", &self.theta_o), ("theta_i", &self.theta_i), ("phi", &self.phi)]
    }

    /// Nodes on each axis; an axis without nodes counts as one.
    #[must_use]
    pub fn lengths(&self) -> [usize; 4] {
        self.named().map(|(_, nodes)| nodes.len().max(1))
    }

    /// Notes the faults of each axis, and moves ends that are meant for quarter turns there.
    pub(super) fn check(&mut self, faults: &mut Vec<TabulatedFault>) {
        let whole = |end: f64| Some([0.0, end]);
        check_axis("alpha", &mut self.alpha, [0.0, 1.0], 0, None, faults);
        check_axis("theta_o", &mut self.theta_o, [0.0, FRAC_PI_2], 2, None, faults);
        check_axis("theta_i", &mut self.theta_i, [0.0, FRAC_PI_2], 2, whole(FRAC_PI_2), faults);
        check_axis("phi", &mut self.phi, [0.0, PI], 2, whole(PI), faults);
    }

    /// The node at an index of the values, for messages.
    pub(super) fn place(&self, mut index: usize) -> String {
        let mut named = self.named().map(|(name, nodes)| (name, nodes, 0));
        for (_, nodes, at) in named.iter_mut().rev() {
            let length = nodes.len().max(1);
            *at = index % length;
            index /= length;
        }
        let known = named.iter().filter(|(_, nodes, _)| !nodes.is_empty());
        known.map(|(name, nodes, at)| format!("{name} {:.4}", nodes[*at])).collect::<Vec<_>>().join(", ")
    }
}

fn check_axis(
    name: &'static str,
    nodes: &mut [f64],
    [low, high]: [f64; 2],
    least: usize,
    ends: Option<[f64; 2]>,
    faults: &mut Vec<TabulatedFault>,
) {
    let mut note = |detail: String| faults.push(TabulatedFault { tensor: name, detail });
    if nodes.len() < least {
        note(format!("{} nodes; allowed: {least} and more", nodes.len()));
    }
    if let Some(at) = nodes.iter().position(|x| !x.is_finite()) {
        return note(format!("node {at} is {}, not a finite number", nodes[at]));
    }
    for node in nodes.iter_mut() {
        for quarter in [low, high] {
            if (*node - quarter).abs() <= TOLERANCE {
                *node = quarter;
            }
        }
    }
    if let Some(at) = nodes.iter().position(|x| !(low..=high).contains(x)) {
        note(format!("node {at} is {}; allowed: {low} to {high}", nodes[at]));
    }
    if let Some(at) = nodes.windows(2).position(|pair| pair[1] - pair[0] < TOLERANCE) {
        let [one, next] = [nodes[at], nodes[at + 1]];
        note(format!("node {} is {next} after {one}; nodes ascend by {TOLERANCE} at least", at + 1));
    }
    if let (Some([low, high]), Some(first), Some(last)) = (ends, nodes.first(), nodes.last())
        && [*first, *last] != [low, high]
    {
        note(format!("it goes from {first} to {last}; allowed: from {low} to {high}, all of it"));
    }
}
