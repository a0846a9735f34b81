//! A table's axes as shaders read them.

use std::array::from_fn;

use super::spacing::Spacing;
use crate::{axes::PerAxis, math::sin_cos};

/// The axes of a table as shaders read them. The struct `LtcTable` of `shaders/ltc_table.wgsl` documents its fields.
///
/// Nodes are evenly spaced in a variable of the layout, so a lookup finds them without a search.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ShaderAxes {
    /// The number of nodes on each axis.
    pub nodes: [u32; 4],
    /// Four words: the layout's number; 1 for a table of isotropic surfaces with one phi, else 0; the distance in
    /// layers from the first lobe to the second, 0 for one lobe; an unused word.
    pub reading: [u32; 4],
    /// The first node of each axis in the variable in which nodes are evenly spaced.
    pub start: [f32; 4],
    /// The step between nodes; 1 for a single node.
    pub step: [f32; 4],
    /// The reciprocal of the step.
    pub per_step: [f32; 4],
    /// Four factors: 1 / (alphas times lobes), 1 / (ratios times thetas), the number of thetas, and 1 / phis.
    pub texel: [f32; 4],
    /// The first and the last alpha, the first and the last ratio.
    pub roughness: [f32; 4],
    /// The cosines of the last and the first theta.
    pub cosines: [f32; 4],
    /// Cosine and sine of the first phi, then of the last phi.
    pub azimuths: [f32; 4],
}

impl ShaderAxes {
    /// The axes of a layout with this number and spacing. Domain: nodes of this layout.
    pub(super) fn new(number: u32, spacing: PerAxis<Spacing>, axes: &PerAxis<Vec<f64>>) -> Self {
        let spaced = [
            (&axes.alpha, spacing.alpha),
            (&axes.ratio, spacing.ratio),
            (&axes.theta, spacing.theta),
            (&axes.phi, spacing.phi),
        ];
        // Start and step come from the last nodes, because the first node may have been raised to a floor.
        let spaced = spaced.map(|(nodes, spacing)| match nodes[..] {
            [.., before, last] => {
                let [before, last] = [before, last].map(|node| spacing.invert(node));
                let step = last - before;
                [last - step * (nodes.len() - 1) as f64, step]
            }
            [only] => [spacing.invert(only), 1.0],
            [] => [0.0, 1.0],
        });
        let ends = |nodes: &[f64]| [nodes.first(), nodes.last()].map(|node| node.copied().unwrap_or(0.0));
        let [alpha, ratio, theta, phi] = axes.named().map(|(_, nodes)| ends(nodes));
        let nodes = axes.named().map(|(_, nodes)| u32::try_from(nodes.len()).unwrap_or(u32::MAX));
        let [of_alpha, of_ratio, of_theta, of_phi] = nodes.map(|count| count as f32);
        let turns = axes.ratio == [1.0] && axes.phi.len() == 1;
        let [[sin_first, cos_first], [sin_last, cos_last]] = phi.map(|phi| {
            let (sin, cos) = sin_cos(phi);
            [sin as f32, cos as f32]
        });
        Self {
            nodes,
            reading: [number, u32::from(turns), 0, 0],
            start: spaced.map(|[start, _]| start as f32),
            step: spaced.map(|[_, step]| step as f32),
            per_step: spaced.map(|[_, step]| (1.0 / step) as f32),
            texel: [1.0 / of_alpha, 1.0 / (of_ratio * of_theta), of_theta, 1.0 / of_phi],
            roughness: [alpha[0], alpha[1], ratio[0], ratio[1]].map(|x| x as f32),
            cosines: [sin_cos(theta[1]).1 as f32, sin_cos(theta[0]).1 as f32, 0.0, 0.0],
            azimuths: [cos_first, sin_first, cos_last, sin_last],
        }
    }

    /// These axes for a table with two lobes per entry. The texture stores all first lobes, then all second lobes.
    pub(crate) fn with_second(self) -> Self {
        let [number, turns, ..] = self.reading;
        let [per_layer, x, y, z] = self.texel;
        Self { reading: [number, turns, self.nodes[0], 0], texel: [0.5 * per_layer, x, y, z], ..self }
    }

    /// These axes for materials, where alpha is an index. The ranges of roughness come from `axes`.
    pub(super) fn of_materials(self, axes: &PerAxis<Vec<f64>>) -> Self {
        let [number, _, z, w] = self.reading;
        let extent = |nodes: &[f64]| {
            nodes.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| [low.min(*x), high.max(*x)])
        };
        let [alpha, ratio] = [extent(&axes.alpha), extent(&axes.ratio)];
        let turns = ratio == [1.0; 2] && axes.phi.len() == 1;
        Self {
            reading: [number, u32::from(turns), z, w],
            roughness: [alpha[0], alpha[1], ratio[0], ratio[1]].map(|x| x as f32),
            ..self
        }
    }

    /// The words of the uniform buffer, in order.
    #[must_use]
    pub fn words(&self) -> [u32; 36] {
        let Self { start, step, per_step, texel, roughness, cosines, azimuths, .. } = *self;
        let numbers = [start, step, per_step, texel, roughness, cosines, azimuths];
        let words = self.nodes.into_iter().chain(self.reading).chain(numbers.into_iter().flatten().map(f32::to_bits));
        let mut all = [0; 36];
        all.iter_mut().zip(words).for_each(|(place, word)| *place = word);
        all
    }

    /// The position of a point, given in the variables in which nodes are evenly spaced. Twin of `ltc_place`.
    pub(super) fn place(&self, steps: [f32; 4]) -> ShaderPlace {
        let at: [f32; 4] = from_fn(|i| (steps[i] - self.start[i]) * self.per_step[i]);
        let lower = from_fn(|i| at[i].floor().max(0.0).min((self.nodes[i] as f32 - 2.0).max(0.0)));
        ShaderPlace { lower, weight: from_fn(|i| (at[i] - lower[i]).clamp(0.0, 1.0)) }
    }

    /// The nodes below and above, in the variables in which nodes are evenly spaced.
    pub(super) fn around(&self, lower: [f32; 4]) -> [[f32; 4]; 2] {
        let below: [f32; 4] = from_fn(|i| self.start[i] + lower[i] * self.step[i]);
        [below, from_fn(|i| below[i] + self.step[i])]
    }
}

/// A position between the nodes `lower` and `lower + 1` of each axis. Twin of `LtcPlace`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ShaderPlace {
    /// Index of the node below.
    pub lower: [f32; 4],
    /// Weight of the node above; 0 beyond the last node.
    pub weight: [f32; 4],
}
