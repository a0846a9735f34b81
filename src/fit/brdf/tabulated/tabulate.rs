//! Tabulates another scattering model. The result is an example of the file format, and tests use it.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use super::{TabulatedAxes, TabulatedBrdf, TabulatedFault};
use crate::{axes::LEAST_ALPHA, brdf::BrdfKind, math::direction};

/// The distance of the last evaluated node from the horizon, radians. At the horizon most formulas are 0 / 0.
const FROM_HORIZON: f64 = 1e-4;

/// The last view, at 85 degrees. Beyond this angle, models change too steeply for linear interpolation between these
/// nodes.
const LAST_VIEW: f64 = 1.483_529_864_195_18;

impl TabulatedAxes {
    /// Axes that suit most models: `thetas` polar angles from 0 to pi/2, and `phis` uniform azimuths. The polar angles
    /// are at `1 - (1 - u)^2` of the quarter turn, and therefore denser towards the horizon. Views have the same polar
    /// angles as lights, but end at 85 degrees. Domain: at least two of each.
    #[must_use]
    pub fn spread(alpha: Vec<f64>, thetas: u16, phis: u16) -> Self {
        let even = |n: u16| (0..n).map(move |i| f64::from(i) / f64::from(n - 1));
        let theta_i: Vec<f64> = even(thetas).map(|u| FRAC_PI_2 * (1.0 - (1.0 - u) * (1.0 - u))).collect();
        let theta_o = theta_i.iter().copied().filter(|theta| *theta <= LAST_VIEW).collect();
        Self { alpha, theta_o, theta_i, phi: even(phis).map(|u| PI * u).collect(), ..Self::default() }
    }

    /// Converts these axes to axes for anisotropic surfaces of the given ratios, with `views` uniform azimuths of the
    /// view. The light keeps its number of azimuths on each side of the view, at `1 - (1 - u)^2` of the way to pi. The
    /// azimuths are denser opposite to the view, because lobes of grazing views are narrow there. Domain: isotropic
    /// axes, at least two azimuths.
    #[must_use]
    pub fn with_azimuths(self, ratio: Vec<f64>, views: u16) -> Self {
        let phi_o = (0..views).map(|i| FRAC_PI_2 * f64::from(i) / f64::from(views - 1)).collect();
        let closer = |phi: &f64| PI * (1.0 - (1.0 - phi / PI) * (1.0 - phi / PI));
        let side: Vec<f64> = self.phi.iter().map(closer).collect();
        let mirrored = side.iter().rev().skip(1).map(|phi| TAU - phi);
        let phi = side.iter().copied().chain(mirrored).collect();
        Self { ratio, phi_o, phi, ..self }
    }
}

impl TabulatedBrdf {
    /// Tabulates a model at these nodes. Domain: the same as for [`BrdfKind::surface`]. Without `ratio`, an anisotropic
    /// model has equal roughnesses. Without `alpha`, the surface has the largest roughness.
    ///
    /// # Errors
    /// The same as [`TabulatedBrdf::new`]. With too few nodes for a sharp lobe, the interpolated BRDF reflects too much
    /// light, which is a fault.
    pub fn tabulate(kind: BrdfKind, axes: TabulatedAxes) -> Result<Self, Vec<TabulatedFault>> {
        const HORIZON: f64 = FRAC_PI_2 - FROM_HORIZON;
        let or = |nodes: &[f64], only: f64| if nodes.is_empty() { vec![only] } else { nodes.to_vec() };
        let (alphas, ratios, azimuths) = (or(&axes.alpha, 1.0), or(&axes.ratio, 1.0), or(&axes.phi_o, 0.0));
        let mut values = Vec::with_capacity(axes.shape().iter().product());
        for (alpha, ratio) in alphas.iter().flat_map(|alpha| ratios.iter().map(move |ratio| (alpha, ratio))) {
            let surface = kind.surface([*alpha, alpha * ratio].map(|alpha| alpha.max(LEAST_ALPHA)));
            let views =
                axes.theta_o.iter().flat_map(|theta| azimuths.iter().map(move |phi| (theta.min(HORIZON), *phi)));
            for (theta_o, phi_o) in views {
                let wo = direction(theta_o, phi_o);
                for theta_i in axes.theta_i.iter().map(|theta| theta.min(HORIZON)) {
                    for wi in axes.phi.iter().map(|phi| direction(theta_i, phi_o + phi)) {
                        values.push(surface.eval_cos(wo, wi) / wi.z);
                    }
                }
            }
        }
        Self::new(axes, values)
    }
}
