//! Measures a table at the corners of its domain, where lobes degenerate and renderers divide by zero.

use std::f64::consts::{FRAC_PI_2, PI};

use glam::{DMat3, DVec3, Mat3};
use rayon::prelude::*;
use serde::Serialize;

use super::{
    distance::{FARTHEST, Probe, Workspace},
    lobe::Lobe,
    sequence::net,
};
use crate::{
    Configuration, THETA_CEILING, Table,
    math::{concentric_cosine, direction, from_row_major, row_major},
};

/// Larger roughness: a mirror, values below and around the floor, and the roughest surface.
const ALPHAS: [f64; 6] = [0.0, 1e-8, 1e-5, 1e-4, 1e-3, 1.0];
/// Smaller divided by larger roughness: a line, needles, isotropic.
const RATIOS: [f64; 4] = [0.0, 1e-6, 1e-3, 1.0];
/// Polar angles of the view, from the normal to the horizon.
const THETAS: [f64; 5] = [0.0, 1e-9, FRAC_PI_2 - 1e-3, FRAC_PI_2 - 1e-9, FRAC_PI_2];
/// Azimuths at which a lookup mirrors or swaps axes. [`BETWEEN`] has azimuths without a fold.
const FOLDS: [f64; 5] = [0.0, FRAC_PI_2, PI, 1.5 * PI, 2.0 * PI];
const BETWEEN: [f64; 2] = [0.4, 2.5];
/// Lookups are also made at these distances from a fold, in units in the last place.
const ULPS: std::ops::RangeInclusive<i64> = -2..=2;
/// A step between configurations, radians. A step across a fold must not move a lobe farther than a step next to the
/// fold.
const STEP: f64 = 1e-6;
/// Samples for the comparison of two LTCs: `2^8`. Both LTCs use the same samples.
const LOG2_SAMPLES: u32 = 8;
/// The sharpest lobe that can be sampled. Sharper lobes differ from it by less than the precision of the distance.
const SHARPEST: f64 = 1e-8;

/// The results of a table at one corner, over all azimuths of the view on and around the folds.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Corner {
    /// Larger roughness.
    pub alpha: f64,
    /// Smaller divided by larger roughness.
    pub ratio: f64,
    /// Polar angle of the view, radians.
    pub theta: f64,
    /// The number of lookups.
    pub lookups: usize,
    /// Lookups whose matrix is not finite or whose determinant is not positive.
    pub broken: usize,
    /// Largest sliced Wasserstein-1 distance to the lobe of the exact configuration, which is not raised to the floor.
    pub sw1: f64,
    /// The largest jump at a fold, in widths of the LTC: how much farther a step of 1e-6 across a fold moves the LTC
    /// than the same step next to the fold.
    pub jump: f64,
    /// Largest distance by which inverting a matrix in f32 moves its LTC, radians.
    pub inversion: f64,
    /// The distance `inversion` in widths of the LTC.
    pub inversion_width: f64,
}

/// Measures a table at every corner. Runs on the current rayon pool. The size of the pool does not change the result.
#[must_use]
pub fn extremes(table: &Table) -> Vec<Corner> {
    let probe = Probe::new();
    let cosines: Vec<DVec3> = net(LOG2_SAMPLES, [0, 0]).map(concentric_cosine).collect();
    let places: Vec<(f64, f64, f64)> = ALPHAS
        .into_iter()
        .flat_map(|alpha| RATIOS.into_iter().flat_map(move |ratio| THETAS.map(|theta| (alpha, ratio, theta))))
        .collect();
    let corner = |work: &mut Workspace, place: &(f64, f64, f64)| corner(table, *place, &probe, &cosines, work);
    places.par_iter().map_init(Workspace::default, corner).collect()
}

fn corner(
    table: &Table,
    (alpha, ratio, theta): (f64, f64, f64),
    probe: &Probe,
    cosines: &[DVec3],
    work: &mut Workspace,
) -> Corner {
    let at = |phi: f64| Configuration { alpha_x: alpha, alpha_y: alpha * ratio, theta, phi };
    let look = |configuration: Configuration| from_row_major(&table.lookup(&configuration).matrix);
    let mut corner = Corner {
        alpha,
        ratio,
        theta,
        lookups: 0,
        broken: 0,
        sw1: 0.0,
        jump: 0.0,
        inversion: 0.0,
        inversion_width: 0.0,
    };
    let around = FOLDS.into_iter().flat_map(|fold| ULPS.map(move |ulps| next(fold, ulps)));
    for phi in around.chain(BETWEEN) {
        for configuration in [at(phi), swapped(at(phi))] {
            let m = look(configuration);
            corner.lookups += 1;
            if !(m.is_finite() && m.determinant() > 0.0) {
                corner.broken += 1;
                corner.sw1 = FARTHEST;
                corner.inversion = FARTHEST;
                continue;
            }
            let moved = distance(&m, &inverted_in_f32(&m), cosines);
            corner.inversion = corner.inversion.max(moved);
            corner.inversion_width = corner.inversion_width.max(moved / width(&m, cosines));
        }
    }
    for phi in BETWEEN.into_iter().chain([0.0, FRAC_PI_2]) {
        let m = look(at(phi));
        if m.is_finite() && m.determinant() != 0.0 {
            corner.sw1 = corner.sw1.max(error(table, &at(phi), &m, probe, work));
        }
    }
    for fold in FOLDS {
        let walk = [-1.5, -0.5, 0.5, 1.5].map(|steps| look(at(fold + steps * STEP)));
        corner.jump = corner.jump.max(jump(&walk, cosines));
    }
    if ratio == 1.0 {
        // This walk crosses equal roughness, where the axes swap.
        let walk = [-1.5, -0.5, 0.5, 1.5].map(|steps: f64| {
            let by = steps * STEP;
            let (x, y) = (alpha * (1.0 + by.min(0.0)), alpha * (1.0 - by.max(0.0)));
            look(Configuration { alpha_x: x, alpha_y: y, theta, phi: BETWEEN[0] })
        });
        corner.jump = corner.jump.max(jump(&walk, cosines));
    }
    corner
}

/// The configuration of the surface turned by a right angle. Its lobe is the same lobe, turned.
fn swapped(c: Configuration) -> Configuration {
    Configuration { alpha_x: c.alpha_y, alpha_y: c.alpha_x, phi: c.phi + FRAC_PI_2, ..c }
}

/// The number `ulps` steps after `x`. Steps back from zero give negative numbers.
fn next(x: f64, ulps: i64) -> f64 {
    if x == 0.0 {
        return f64::from_bits(ulps.unsigned_abs()) * if ulps < 0 { -1.0 } else { 1.0 };
    }
    f64::from_bits(x.to_bits().saturating_add_signed(ulps))
}

/// Distance between an LTC and the lobe that it represents. At the horizon no light is reflected, so the lobe at the
/// ceiling is used there.
fn error(table: &Table, at: &Configuration, m: &DMat3, probe: &Probe, work: &mut Workspace) -> f64 {
    let wo = direction(at.theta.min(THETA_CEILING), at.phi);
    let surface = table.brdf.lobe_surface([at.alpha_x.max(SHARPEST), at.alpha_y.max(SHARPEST)], wo);
    let lobe = Lobe::sample(&*surface, wo);
    let model = table.lobe.distribution(&row_major(m));
    probe.distance(&lobe, model.as_deref(), work).sw1
}

/// The excess of the middle step over the longer of its neighbours, in widths.
fn jump(walk: &[DMat3; 4], cosines: &[DVec3]) -> f64 {
    let [before, across, after] = [0, 1, 2].map(|k| distance(&walk[k], &walk[k + 1], cosines));
    (across - before.max(after)).max(0.0) / width(&walk[1], cosines)
}

/// Mean distance between the directions of two matrices for the same samples. It is an upper bound of the Wasserstein
/// distance between their LTCs. Returns [`FARTHEST`] if a matrix does not define directions.
fn distance(a: &DMat3, b: &DMat3, cosines: &[DVec3]) -> f64 {
    let sum: f64 = cosines.iter().map(|c| ((*a * *c).normalize() - (*b * *c).normalize()).length()).sum();
    let mean = sum / cosines.len() as f64;
    if mean.is_finite() { mean } else { FARTHEST }
}

/// Mean distance of an LTC's directions from their mean; a positive number.
fn width(m: &DMat3, cosines: &[DVec3]) -> f64 {
    let directions = || cosines.iter().map(|c| (*m * *c).normalize());
    let mean = directions().sum::<DVec3>() / cosines.len() as f64;
    let width = directions().map(|w| (w - mean).length()).sum::<f64>() / cosines.len() as f64;
    width.max(f64::MIN_POSITIVE)
}

/// The matrix after an inversion in a shader: rounded to f32, inverted in f32 by cofactors, and inverted back.
fn inverted_in_f32(m: &DMat3) -> DMat3 {
    let inverse: Mat3 = m.as_mat3().inverse();
    inverse.as_dmat3().inverse()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{BrdfKind, Layout, LobeModel, PerAxis};

    fn table(matrix: [f32; 9]) -> Table {
        Table {
            brdf: BrdfKind::Ggx.into(),
            lobe: LobeModel::Ltc,
            layout: Layout::Kt2022,
            axes: PerAxis { alpha: vec![1e-4], ratio: vec![1e-4, 1.0], theta: vec![0.0], phi: vec![0.0] },
            matrix: vec![matrix; 2],
            terms: None,
            second: None,
            node_error: vec![0.0; 2],
        }
    }

    #[test]
    fn broken_matrices_and_jumps_at_folds_are_reported() {
        let good = extremes(&table([0.1, 0.0, 0.0, 0.0, 0.2, 0.0, 0.0, 0.0, 1.0]));
        assert_eq!(good.len(), ALPHAS.len() * RATIOS.len() * THETAS.len());
        assert!(good.iter().all(|c| c.broken == 0 && c.inversion < 1e-6), "{good:?}");
        // A lobe that leans along x. A fold at phi = pi/2 moves it to the other side.
        let leaning = extremes(&table([0.1, 0.0, 0.5, 0.0, 0.1, 0.0, 0.0, 0.0, 1.0]));
        assert!(leaning.iter().all(|c| c.broken == 0 && c.jump > 1.0), "{leaning:?}");
        let turned_over = extremes(&table([0.1, 0.0, 0.0, 0.0, -0.1, 0.0, 0.0, 0.0, 1.0]));
        assert!(turned_over.iter().all(|c| c.broken == c.lookups), "{turned_over:?}");
    }

    #[test]
    fn inaccurate_inversions_in_f32_are_reported() {
        let corner = extremes(&table([1e-4, 1e-4, 0.6, 1e-4, 1.000_01e-4, 0.0, 0.0, 0.0, 0.8]))[0];
        assert!(corner.inversion > 1e-6 && corner.inversion_width > 1e-3, "{corner:?}");
    }
}
