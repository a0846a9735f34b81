//! The axes of a tabulated BRDF.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use super::TabulatedFault;

/// The tolerance for the ends of axes and the smallest distance between two nodes. It exceeds the rounding error of pi
/// in f32.
const TOLERANCE: f64 = 1e-6;

/// The nodes of a tabulated BRDF. Each axis ascends strictly.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct TabulatedAxes {
    /// Roughness, the alpha of tables, in [0, 1]. Empty for a surface without a roughness.
    pub alpha: Vec<f64>,
    /// Smaller divided by larger roughness, in [0, 1]. Empty for surfaces of one ratio, and if `phi_o` is empty.
    pub ratio: Vec<f64>,
    /// Polar angle of the view direction, radians, within [0, pi/2]; at least two nodes.
    pub theta_o: Vec<f64>,
    /// Azimuth of the view direction from the axis of larger roughness, radians, from 0 to pi/2. Empty for isotropic
    /// surfaces.
    pub phi_o: Vec<f64>,
    /// Polar angle of the light direction, radians, from 0 to pi/2.
    pub theta_i: Vec<f64>,
    /// Azimuth of the light relative to the view, radians. For isotropic surfaces it ranges from 0 (same side as the
    /// view) to pi. In files with `phi_o` it turns in the same direction as `phi_o` and ranges from 0 to 2 pi, with
    /// nodes symmetric about pi.
    pub phi: Vec<f64>,
}

impl TabulatedAxes {
    /// The axes with their names, in storage order.
    #[must_use]
    pub fn named(&self) -> [(&'static str, &[f64]); 6] {
        let Self { alpha, ratio, theta_o, phi_o, theta_i, phi } = self;
        [("alpha", alpha), ("ratio", ratio), ("theta_o", theta_o), ("phi_o", phi_o), ("theta_i", theta_i), ("phi", phi)]
    }

    /// True if surfaces look the same from all azimuths: the file has no azimuths of the view.
    #[must_use]
    pub fn is_isotropic(&self) -> bool {
        self.phi_o.is_empty()
    }

    /// The factor for light integrated over the axis `phi`: 2 for isotropic surfaces, whose axis covers one of two
    /// equal sides.
    pub(super) fn sides(&self) -> f64 {
        if self.is_isotropic() { 2.0 } else { 1.0 }
    }

    /// The number of nodes on each axis of the values; an axis without nodes counts as one. Isotropic surfaces have the
    /// axes alpha, `theta_o`, `theta_i` and phi. Other surfaces have all six axes.
    #[must_use]
    pub fn shape(&self) -> Vec<usize> {
        let is_whole = !self.is_isotropic() || !self.ratio.is_empty();
        let has_axis = |name: &str| is_whole || !matches!(name, "ratio" | "phi_o");
        self.named().iter().filter(|(name, _)| has_axis(name)).map(|(_, nodes)| nodes.len().max(1)).collect()
    }

    /// Collects the faults of each axis. Moves nodes that are within the tolerance of a limit to the limit.
    pub(super) fn check(&mut self, faults: &mut Vec<TabulatedFault>) {
        let whole = |end: f64| Some([0.0, end]);
        let (views, turn) = if self.is_isotropic() { (0, PI) } else { (2, TAU) };
        check_axis("alpha", &mut self.alpha, [0.0, 1.0], 0, None, faults);
        check_axis("ratio", &mut self.ratio, [0.0, 1.0], 0, None, faults);
        if self.is_isotropic() && !self.ratio.is_empty() {
            let detail = "phi_o is missing: surfaces of ratios below 1 change with the azimuth of the view".to_owned();
            faults.push(TabulatedFault { tensor: "ratio", detail });
        }
        check_axis("theta_o", &mut self.theta_o, [0.0, FRAC_PI_2], 2, None, faults);
        check_axis("phi_o", &mut self.phi_o, [0.0, FRAC_PI_2], views, whole(FRAC_PI_2), faults);
        check_axis("theta_i", &mut self.theta_i, [0.0, FRAC_PI_2], 2, whole(FRAC_PI_2), faults);
        check_axis("phi", &mut self.phi, [0.0, turn], 2, whole(turn), faults);
        // Missing ends are already among the faults.
        if [self.phi.first(), self.phi.last()] == [Some(&0.0), Some(&TAU)] {
            faults.extend(self.phi_fault());
        }
    }

    /// The fault of the first node of phi that has no mirror image at `2 pi - phi`.
    fn phi_fault(&self) -> Option<TabulatedFault> {
        let pairs = self.phi.iter().zip(self.phi.iter().rev());
        let (at, (node, image)) = pairs.enumerate().find(|(_, (a, b))| (*a + *b - TAU).abs() > 2.0 * TOLERANCE)?;
        let detail = format!(
            "node {at} is {node}, but its mirror image is {image}; nodes must be symmetric about pi: phi and 2 pi - phi"
        );
        Some(TabulatedFault { tensor: "phi", detail })
    }

    /// The coordinates of the node at an index of the values, for messages.
    pub(super) fn place(&self, index: usize) -> String {
        place_among(&self.named(), index)
    }

    /// The coordinates of the node at an index of surface and view, for messages.
    pub(super) fn place_of_view(&self, index: usize) -> String {
        place_among(&self.named()[..4], index)
    }
}

fn place_among(axes: &[(&str, &[f64])], mut index: usize) -> String {
    let mut coordinates = Vec::new();
    for (name, nodes) in axes.iter().rev().filter(|(_, nodes)| !nodes.is_empty()) {
        coordinates.push(format!("{name} {:.4}", nodes[index % nodes.len()]));
        index /= nodes.len();
    }
    coordinates.reverse();
    coordinates.join(", ")
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
        note(format!("{} nodes; allowed: {least} or more", nodes.len()));
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
        note(format!("node {} is {next} after {one}; nodes must ascend by at least {TOLERANCE}", at + 1));
    }
    if let (Some([low, high]), Some(first), Some(last)) = (ends, nodes.first(), nodes.last())
        && [*first, *last] != [low, high]
    {
        note(format!("nodes go from {first} to {last}; they must go from {low} to {high}"));
    }
}
