//! The errors of tables of some lobes by their nodes, read off one coarse table.

use crate::{
    held::{Held, Stopped},
    needs::Needs,
    placement::{Placed, by_weight, of_values},
    resampled::resampled,
};
use ltcforge_fit::{Layout, LobeFresnel, PerAxis, Recipe, Table};

/// Places at which the table with fewer nodes is held to that with all of them.
const POINTS_OF_AXIS: usize = 64;
/// Nodes of an axis with which the coarse table is read again.
const FEWER: [u32; 11] = [20, 16, 12, 9, 8, 7, 6, 5, 4, 3, 2];

/// The errors of tables of some lobes.
#[derive(Debug, Clone)]
pub(crate) struct Curve {
    /// The lobes.
    pub(crate) fresnel: LobeFresnel,
    /// The error of the coarse table.
    pub(crate) of_base: f64,
    /// For each axis squared steps, see `ltcforge_fit::Layout::steps`, and the error that each adds to the coarse table's.
    pub(crate) added: [Vec<[f64; 2]>; 4],
    /// Nodes of alpha, and of ratio, that are not evenly spaced: the scene's values, where they are few, and nodes by their weight.
    pub(crate) given: [Vec<Placed>; 2],
}

impl Curve {
    /// Reads a curve for each of some lobes off a coarse table and its recipe. `any_nodes` says whether nodes may be given one by
    /// one. Runs on the current rayon pool, whose size changes nothing; `go_on` may stop it.
    ///
    /// # Errors
    /// [`Stopped`] where `go_on` says no.
    pub(crate) fn read(
        (table, base): (&Table, &Recipe),
        lobes: impl Iterator<Item = LobeFresnel>,
        (needs, held): (&Needs<'_>, &Held),
        any_nodes: bool,
        go_on: &(dyn Fn() -> bool + Sync),
    ) -> Result<Vec<Self>, Stopped> {
        let Recipe { layout, range, resolution, .. } = base;
        let is_free = layout.only_ranges().is_none();
        let any_nodes = any_nodes && is_free;
        let of_values = || needs.values().map(|values| of_values(&values).into_iter().collect());
        let squared = squared_steps(*layout, range, resolution);
        let coarse_error = |table: &Table, lobes: &LobeFresnel| held.coarse_error_as(table, lobes, POINTS_OF_AXIS);
        let begun = |fresnel: LobeFresnel| {
            let of_some = coarse_error(table, &fresnel);
            let curve = Self {
                of_base: held.error_as(table, &fresnel),
                added: squared.map(|squared| vec![[squared, 0.0]]),
                given: if any_nodes { of_values() } else { Default::default() },
                fresnel,
            };
            (curve, of_some)
        };
        let mut curves: Vec<(Self, f64)> = lobes.map(begun).collect();
        let weighed = needs.weighed();
        for axis in 0..4 {
            let nodes = *resolution.named()[axis].1;
            for fewer in FEWER.into_iter().filter(|fewer| is_free && *fewer < nodes) {
                if !go_on() {
                    return Err(Stopped);
                }
                let mut coarse = *resolution;
                *[&mut coarse.alpha, &mut coarse.ratio, &mut coarse.theta, &mut coarse.phi][axis] = fewer;
                let squared = squared_steps(*layout, range, &coarse)[axis];
                let axes = layout.nodes(range, &coarse);
                let placed = (any_nodes && axis < 2 && fewer > 2).then(|| {
                    let nodes = by_weight(*layout, range, axis, &weighed[axis], fewer);
                    let mut axes = axes.clone();
                    [&mut axes.alpha, &mut axes.ratio][axis].clone_from(&nodes);
                    (resampled(table, axes), nodes)
                });
                let even = resampled(table, axes);
                for (curve, of_some) in &mut curves {
                    let more = coarse_error(&even, &curve.fresnel) - *of_some;
                    curve.added[axis].push([squared, more.max(0.0)]);
                    let Some((placed, nodes)) = &placed else { continue };
                    let by_weight = coarse_error(placed, &curve.fresnel) - *of_some;
                    if by_weight < more {
                        curve.given[axis].push(Placed { nodes: nodes.clone(), added: Some(by_weight.max(0.0)) });
                    }
                }
            }
        }
        Ok(curves.into_iter().map(|(curve, _)| curve).collect())
    }

    /// The error that evenly spaced nodes add to that of the coarse table, by the squared step of each axis.
    pub(crate) fn interpolation(&self, squared: [f64; 4]) -> f64 {
        self.added.iter().zip(squared).map(|(added, squared)| along(added, squared)).sum()
    }

    /// By how much more than evenly spaced nodes of an axis those that are given add.
    pub(crate) fn beyond_even(&self, axis: usize, added: f64, squared: f64) -> f64 {
        added - along(&self.added[axis], squared)
    }

    /// The same with all errors multiplied.
    pub(crate) fn scaled(&self, factor: f64) -> Self {
        let added =
            self.added.clone().map(|axis| axis.into_iter().map(|[step, error]| [step, factor * error]).collect());
        let scaled = |placed: Placed| Placed { added: placed.added.map(|error| factor * error), ..placed };
        let given = self.given.clone().map(|placed| placed.into_iter().map(scaled).collect());
        Self { fresnel: self.fresnel.clone(), of_base: factor * self.of_base, added, given }
    }
}

/// The line through the points around `x`, or through the first or last two. Domain: ascending first numbers, one point at
/// least.
fn along(points: &[[f64; 2]], x: f64) -> f64 {
    let [.., last] = points else { return 0.0 };
    let pair = points.windows(2).find(|pair| x <= pair[1][0]).or_else(|| points.windows(2).last());
    pair.map_or(last[1], |pair| pair[0][1] + (pair[1][1] - pair[0][1]) * (x - pair[0][0]) / (pair[1][0] - pair[0][0]))
}

/// The squared step of each axis.
pub(crate) fn squared_steps(layout: Layout, range: &PerAxis<[f64; 2]>, resolution: &PerAxis<u32>) -> [f64; 4] {
    layout.steps(range, resolution).named().map(|(_, step)| step * step)
}
