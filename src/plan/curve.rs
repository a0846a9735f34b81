//! How the errors of tables depend on their nodes, read from one coarse table.

use crate::{
    needs::Needs,
    placement::{Placed, by_weight, of_values},
    probes::{Probes, Stopped},
};
use ltcforge_fit::{Closeness, GoOn, Layout, LobeFresnel, PerAxis, Recipe, Table};

/// The coarse table is read again with these numbers of nodes on an axis.
const FEWER: [u32; 11] = [20, 16, 12, 9, 8, 7, 6, 5, 4, 3, 2];

/// The errors of tables with the same lobes.
#[derive(Debug, Clone)]
pub(crate) struct Curve {
    /// The lobes.
    pub(crate) fresnel: LobeFresnel,
    /// The error of the coarse table.
    pub(crate) of_base: f64,
    /// For each axis: squared steps (see `ltcforge_fit::Layout::steps`), and the error that each step adds to the
    /// coarse table's error.
    pub(crate) added: [Vec<[f64; 2]>; 4],
    /// Nodes of alpha, and of ratio, that are not evenly spaced.
    pub(crate) given: [Vec<Placed>; 2],
}

impl Curve {
    /// Reads a curve for each choice of lobes from a coarse table and its recipe. `any_nodes` allows nodes that are not
    /// evenly spaced. Runs on the current rayon pool. The size of the pool does not change the result.
    ///
    /// # Errors
    /// [`Stopped`] if `go_on` returns `false`.
    pub(crate) fn read(
        (table, base): (&Table, &Recipe),
        lobes: impl Iterator<Item = LobeFresnel>,
        (needs, probes): (&Needs<'_>, &Probes),
        any_nodes: bool,
        go_on: &GoOn<'_>,
    ) -> Result<Vec<Self>, Stopped> {
        let Recipe { layout, range, resolution, .. } = base;
        let is_free = layout.only_ranges().is_none();
        let any_nodes = any_nodes && is_free;
        let coarse_error = |table: &Table, lobes: &LobeFresnel| probes.error_as(table, lobes, Closeness::Coarse);
        let begun = |fresnel: LobeFresnel| {
            let of_coarse = coarse_error(table, &fresnel);
            let curve = Self {
                of_base: probes.error_as(table, &fresnel, Closeness::Report),
                added: squared_steps(*layout, range, resolution).map(|squared| vec![[squared, 0.0]]),
                given: [0, 1].map(|axis| of_values(needs, axis).filter(|_| any_nodes).into_iter().collect()),
                fresnel,
            };
            (curve, of_coarse)
        };
        let mut curves: Vec<(Self, f64)> = lobes.map(begun).collect();
        for axis in 0..4 {
            let nodes = *resolution.named()[axis].1;
            for fewer in FEWER.into_iter().filter(|fewer| is_free && *fewer < nodes) {
                if !go_on() {
                    return Err(Stopped);
                }
                let squared = squared_steps(*layout, range, &resolution.with(axis, fewer))[axis];
                let even = table.coarser(base, axis, fewer);
                let placed = (any_nodes && axis < 2 && fewer > 2).then(|| {
                    let values = needs.spots().map(|(spot, _)| ([spot.alpha, spot.ratio][axis], spot.weight));
                    let nodes = by_weight(*layout, range, axis, values, fewer);
                    (table.resampled(axis, nodes.clone()), nodes)
                });
                for (curve, of_coarse) in &mut curves {
                    let more = coarse_error(&even, &curve.fresnel) - *of_coarse;
                    curve.added[axis].push([squared, more.max(0.0)]);
                    let Some((placed, nodes)) = &placed else { continue };
                    let by_weight = coarse_error(placed, &curve.fresnel) - *of_coarse;
                    if by_weight < more {
                        curve.given[axis].push(Placed { nodes: nodes.clone(), added: Some(by_weight.max(0.0)) });
                    }
                }
            }
        }
        Ok(curves.into_iter().map(|(curve, _)| curve).collect())
    }

    /// The error that evenly spaced nodes add to the coarse table's error, for the squared step of each axis.
    pub(crate) fn interpolation(&self, squared: [f64; 4]) -> f64 {
        (0..4).map(|axis| self.along(axis, squared[axis])).sum()
    }

    /// The error that a squared step adds on an axis, by linear interpolation between the points around it, or by
    /// linear extrapolation from the first or last two points.
    pub(crate) fn along(&self, axis: usize, squared: f64) -> f64 {
        let points = &self.added[axis];
        let pair = points.windows(2).find(|pair| squared <= pair[1][0]).or_else(|| points.windows(2).last());
        match pair {
            Some(&[[x, y], [x1, y1]]) => y + (y1 - y) * (squared - x) / (x1 - x),
            _ => points[0][1],
        }
    }

    /// The same curve with all errors multiplied.
    pub(crate) fn scaled(mut self, factor: f64) -> Self {
        self.of_base *= factor;
        self.added.iter_mut().flatten().for_each(|[_, error]| *error *= factor);
        self.given.iter_mut().flatten().filter_map(|placed| placed.added.as_mut()).for_each(|error| *error *= factor);
        self
    }
}

/// The squared step of each axis.
pub(crate) fn squared_steps(layout: Layout, range: &PerAxis<[f64; 2]>, resolution: &PerAxis<u32>) -> [f64; 4] {
    layout.steps(range, resolution).named().map(|(_, step)| step * step)
}
