//! A table's axes as shaders read them.

use std::array::from_fn;

use super::spacing::Spacing;
use crate::{axes::PerAxis, math::sin_cos};

/// A table's axes as shaders read them: `LtcTable` of `shaders/ltc_table.wgsl`, whose fields say more.
///
/// Nodes are evenly spaced in a variable that the layout has, so that a lookup needs no search for them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ShaderAxes {
    /// How many nodes each axis has.
    pub nodes: [u32; 4],
    /// The layout's number; 1 for a table of isotropic surfaces with one phi; from the layers of the first lobe to those of a
    /// second one, 0 where there is none.
    pub reading: [u32; 4],
    /// The first node of each axis in the variable in which nodes are evenly spaced.
    pub start: [f32; 4],
    /// The step between nodes; 1 for a single node.
    pub step: [f32; 4],
    /// One over it.
    pub per_step: [f32; 4],
    /// One over the layers of alpha, which are its nodes for each lobe; one over those of ratio and theta, those of theta, one over those of phi.
    pub texel: [f32; 4],
    /// The first and the last alpha, the first and the last ratio.
    pub roughness: [f32; 4],
    /// The cosines of the last and of the first theta.
    pub cosines: [f32; 4],
    /// Cosine and sine of the first phi and of the last.
    pub azimuths: [f32; 4],
}

impl ShaderAxes {
    /// Those of a layout with a number, whose nodes are spaced so. Domain: nodes of this layout.
    pub(super) fn new(number: u32, spacing: PerAxis<Spacing>, axes: &PerAxis<Vec<f64>>) -> Self {
        let spaced = [
            (&axes.alpha, spacing.alpha),
            (&axes.ratio, spacing.ratio),
            (&axes.theta, spacing.theta),
            (&axes.phi, spacing.phi),
        ];
        // From the end: the first node may have been moved onto a floor.
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

    /// The same for a table of two lobes an entry, whose second ones stand after all first ones.
    pub(crate) fn with_second(self) -> Self {
        let [number, turns, ..] = self.reading;
        let [per_layer, x, y, z] = self.texel;
        Self { reading: [number, turns, self.nodes[0], 0], texel: [0.5 * per_layer, x, y, z], ..self }
    }

    /// The same, of a numbered axis of materials, with the extents of their roughnesses in these axes.
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

    /// The words of the uniform, in its order.
    #[must_use]
    pub fn words(&self) -> [u32; 36] {
        let Self { start, step, per_step, texel, roughness, cosines, azimuths, .. } = *self;
        let numbers = [start, step, per_step, texel, roughness, cosines, azimuths];
        let words = self.nodes.into_iter().chain(self.reading).chain(numbers.into_iter().flatten().map(f32::to_bits));
        let mut all = [0; 36];
        all.iter_mut().zip(words).for_each(|(place, word)| *place = word);
        all
    }

    /// The place of variables in which nodes are evenly spaced: twin of `ltc_place`.
    pub(super) fn place(&self, steps: [f32; 4]) -> ShaderPlace {
        let at: [f32; 4] = from_fn(|i| (steps[i] - self.start[i]) * self.per_step[i]);
        let lower = from_fn(|i| at[i].floor().max(0.0).min((self.nodes[i] as f32 - 2.0).max(0.0)));
        ShaderPlace { lower, weight: from_fn(|i| (at[i] - lower[i]).clamp(0.0, 1.0)) }
    }

    /// The places of the nodes below and above in the variable in which nodes are evenly spaced.
    pub(super) fn around(&self, lower: [f32; 4]) -> [[f32; 4]; 2] {
        let below: [f32; 4] = from_fn(|i| self.start[i] + lower[i] * self.step[i]);
        [below, from_fn(|i| below[i] + self.step[i])]
    }
}

/// A place between the nodes `lower` and `lower + 1` of each axis; the latter's weight. Twin of `LtcPlace`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ShaderPlace {
    /// Number of the node below.
    pub lower: [f32; 4],
    /// Weight of the node above; 0 beyond the last node.
    pub weight: [f32; 4],
}
