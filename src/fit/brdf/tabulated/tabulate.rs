//! Another scattering model as numbers: a template of the format, and a test of it.

use std::f64::consts::{FRAC_PI_2, PI};

use super::{TabulatedAxes, TabulatedBrdf, TabulatedFault};
use crate::{axes::LEAST_ALPHA, brdf::BrdfKind, math::direction};

/// How far from the horizon the last node is evaluated, radians: at it, most formulas are 0 / 0.
const FROM_HORIZON: f64 = 1e-4;

/// The last view, 85 degrees: beyond, models bend too steeply for nodes that lie at an even distance from each other.
const LAST_VIEW: f64 = 1.483_529_864_195_18;

impl TabulatedAxes {
    /// Axes that suit most models: `thetas` polar angles from 0 to pi/2, `1 - (1 - u)^2` of the way, so that they lie
    /// closer towards the horizon, the same for lights and for views, which end at 85 degrees; and `phis` even
    /// azimuths. Domain: two at least of each.
    #[must_use]
    pub fn spread(alpha: Vec<f64>, thetas: u16, phis: u16) -> Self {
        let even = |n: u16| (0..n).map(move |i| f64::from(i) / f64::from(n - 1));
        let theta_i: Vec<f64> = even(thetas).map(|u| FRAC_PI_2 * (1.0 - (1.0 - u) * (1.0 - u))).collect();
        let theta_o = theta_i.iter().copied().filter(|theta| *theta <= LAST_VIEW).collect();
        Self { alpha, theta_o, theta_i, phi: even(phis).map(|u| PI * u).collect() }
    }
}

impl TabulatedBrdf {
    /// A model of formulas at these nodes. Domain: as [`BrdfKind::surface`]; of an anisotropic model, its surfaces of
    /// equal roughnesses. A file without `alpha` has the roughest surface.
    ///
    /// # Errors
    /// As [`TabulatedBrdf::new`]: linear interpolation between few nodes reflects more light than a sharp lobe does.
    pub fn tabulate(kind: BrdfKind, axes: TabulatedAxes) -> Result<Self, Vec<TabulatedFault>> {
        const HORIZON: f64 = FRAC_PI_2 - FROM_HORIZON;
        let alphas = if axes.alpha.is_empty() { vec![1.0] } else { axes.alpha.clone() };
        let mut values = Vec::with_capacity(axes.lengths().iter().product());
        for alpha in alphas {
            let surface = kind.surface([alpha.max(LEAST_ALPHA); 2]);
            for wo in axes.theta_o.iter().map(|theta| direction(theta.min(HORIZON), 0.0)) {
                for theta_i in axes.theta_i.iter().map(|theta| theta.min(HORIZON)) {
                    for wi in axes.phi.iter().map(|phi| direction(theta_i, *phi)) {
                        values.push(surface.eval_cos(wo, wi) / wi.z);
                    }
                }
            }
        }
        Self::new(axes, values)
    }
}
