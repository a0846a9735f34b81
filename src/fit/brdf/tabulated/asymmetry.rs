//! Measures how far a tabulated BRDF is from reciprocity.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use super::{
    TabulatedAxes, TabulatedBrdf,
    grid::{Cell, Place},
};

/// The largest deviation of a BRDF from reciprocity, `f(o, i) = f(i, o)`.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct Asymmetry {
    /// The largest difference between two values that should be equal, relative to the largest value of the same
    /// surface.
    pub largest: f64,
    /// The alpha of the largest difference, if the file has this axis.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub alpha: Option<f64>,
    /// The ratio of roughnesses of the largest difference, if the file has this axis.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub ratio: Option<f64>,
    /// The polar angle of the view, radians.
    pub theta_o: f64,
    /// The azimuth of the view, if the file has this axis.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub phi_o: Option<f64>,
    /// The polar angle of the light, radians.
    pub theta_i: f64,
    /// The azimuth of the light relative to the view, radians.
    pub phi: f64,
}

impl TabulatedBrdf {
    /// Compares the values at nodes with the interpolated values for exchanged view and light. Light directions outside
    /// the range of the views are skipped. `None` if nothing can be compared.
    ///
    /// On anisotropic surfaces, the azimuths after the exchange lie between nodes, so the result includes interpolation
    /// error.
    #[must_use]
    pub fn asymmetry(&self) -> Option<Asymmetry> {
        let [alphas, ratios, azimuths] =
            [&self.axes().alpha, &self.axes().ratio, &self.axes().phi_o].map(|nodes| nodes.len().max(1));
        let mut found: Option<Asymmetry> = None;
        for (alpha, ratio) in (0..alphas).flat_map(|alpha| (0..ratios).map(move |ratio| (alpha, ratio))) {
            let views = self.axes().theta_o.len() * azimuths;
            let surface = (alpha * ratios + ratio) * views;
            let of_surface = &self.values()[self.row(surface, 0)..self.row(surface + views, 0)];
            let most = of_surface.iter().copied().fold(0.0, f64::max);
            for view in 0..views {
                let (o, v) = (view / azimuths, view % azimuths);
                let at =
                    Place { alpha: Cell::at(alpha), ratio: Cell::at(ratio), theta_o: Cell::at(o), phi_o: Cell::at(v) };
                for (value, exchanged, [i, p]) in self.exchanged(at, surface + view) {
                    let largest = (value - exchanged).abs() / most;
                    if found.is_none_or(|found| largest > found.largest) {
                        found = Some(self.axes().asymmetry_at(largest, at, [i, p]));
                    }
                }
            }
        }
        found
    }

    /// For each value of one view: the value, the value with view and light exchanged, and the nodes of `theta_i` and
    /// `phi`.
    fn exchanged(&self, at: Place, view: usize) -> impl Iterator<Item = (f64, f64, [usize; 2])> {
        let axes = self.axes();
        let [first, last] = [axes.theta_o.first(), axes.theta_o.last()].map(|end| end.copied().unwrap_or(f64::NAN));
        let theta_i = Cell::of(&axes.theta_i, axes.theta_o[at.theta_o.node]);
        let is_compared = move |theta: f64| (first..=last).contains(&theta);
        let lights = axes.theta_i.iter().enumerate().filter(move |(_, theta)| is_compared(**theta));
        lights.flat_map(move |(i, theta)| {
            let theta_o = Cell::of(&axes.theta_o, *theta);
            (0..axes.phi.len()).map(move |p| {
                let (phi_o, phi) = axes.exchanged_azimuths(at.phi_o.node, p);
                let value = self.values()[self.row(view, i) + p];
                (value, self.value(Place { theta_o, phi_o, ..at }, theta_i, phi), [i, p])
            })
        })
    }
}

impl TabulatedAxes {
    /// The azimuths after view and light are exchanged: of the new view, and of the new light relative to the new view.
    fn exchanged_azimuths(&self, phi_o: usize, phi: usize) -> (Cell, Cell) {
        if self.is_isotropic() {
            return (Cell::at(0), Cell::at(phi));
        }
        let apart = self.phi[phi];
        let azimuth = (self.phi_o[phi_o] + apart).rem_euclid(PI);
        // In the mirrored quadrant, the relative azimuth changes its sign.
        let (azimuth, apart) = if azimuth <= FRAC_PI_2 { (azimuth, TAU - apart) } else { (PI - azimuth, apart) };
        (Cell::of(&self.phi_o, azimuth), Cell::of(&self.phi, apart))
    }

    fn asymmetry_at(&self, largest: f64, at: Place, [theta_i, phi]: [usize; 2]) -> Asymmetry {
        Asymmetry {
            largest,
            alpha: self.alpha.get(at.alpha.node).copied(),
            ratio: self.ratio.get(at.ratio.node).copied(),
            theta_o: self.theta_o[at.theta_o.node],
            phi_o: self.phi_o.get(at.phi_o.node).copied(),
            theta_i: self.theta_i[theta_i],
            phi: self.phi[phi],
        }
    }
}
