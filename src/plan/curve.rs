//! How the errors of tables depend on their nodes, read from one coarse table.

use crate::{
    needs::Needs,
    probes::{Probes, Stopped},
};
use ltcforge_fit::{Closeness, GoOn, Layout, LobeFresnel, PerAxis, Recipe, Table};

/// The coarse table is read again with these numbers of nodes on an axis.
const FEWER: [u32; 11] = [20, 16, 12, 9, 8, 7, 6, 5, 4, 3, 2];
/// The number of scene values that may be listed as nodes of an axis. Two values are the ends of the range, which are
/// always nodes.
const VALUES: std::ops::RangeInclusive<usize> = 3..=16;

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
    /// The scene's own values of alpha, and of ratio, as nodes. They need no interpolation.
    pub(crate) given: [Option<Vec<f64>>; 2],
}

impl Curve {
    /// Reads a curve for each choice of lobes from a coarse table and its recipe. `any_nodes` allows the scene's own
    /// values as nodes. Runs on the current rayon pool. The size of the pool does not change the result.
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
                given: [0, 1]
                    .map(|axis| Some(values(needs, axis)).filter(|nodes| any_nodes && VALUES.contains(&nodes.len()))),
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
                for (curve, of_coarse) in &mut curves {
                    let more = coarse_error(&even, &curve.fresnel) - *of_coarse;
                    // Under a few lights, the errors of nodes may cancel those of lobes.
                    curve.added[axis].push([squared, if probes.are_lit() { more } else { more.max(0.0) }]);
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
}

/// The distinct values of alpha (axis 0) or ratio (axis 1) in a scene.
fn values(needs: &Needs<'_>, axis: usize) -> Vec<f64> {
    let mut nodes: Vec<f64> = needs.spots().map(|(spot, _)| spot.pair()[axis]).collect();
    nodes.sort_by(f64::total_cmp);
    nodes.dedup();
    nodes
}

/// The squared step of each axis.
pub(crate) fn squared_steps(layout: Layout, range: &PerAxis<[f64; 2]>, resolution: &PerAxis<u32>) -> [f64; 4] {
    layout.steps(range, resolution).named().map(|(_, step)| step * step)
}
