//! Summarises many measurements in a few numbers.

use serde::Serialize;

use super::figures::Figures;

/// The number of worst configurations in a report.
const WORST: usize = 5;

/// The errors of a table over a set of configurations.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Accuracy {
    /// The number of measured configurations.
    pub points: usize,
    /// Sliced Wasserstein-1 distance between lobe and LTC, in radians for small angles.
    pub sw1: Spread,
    /// The distance `sw1` relative to the lobe's width. The width is the mean absolute deviation of its projections
    /// from their median.
    pub width: Spread,
    /// For each configuration, the mean absolute error of the fraction of the lobe's energy that a few square lights
    /// cover.
    pub light: Spread,
    /// Absolute error of the amplitude; `None` for a table without terms.
    pub amplitude: Option<TermError>,
    /// Absolute error of the Fresnel term; `None` for a table without terms.
    pub fresnel: Option<TermError>,
    /// The configurations with the largest `width`, worst first.
    pub worst: Vec<Worst>,
}

/// Mean, 95th percentile (nearest rank) and maximum.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Spread {
    /// Mean.
    pub mean: f64,
    /// The error that one configuration in twenty exceeds.
    pub p95: f64,
    /// Largest.
    pub max: f64,
}

/// Absolute error of a term.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct TermError {
    /// Mean.
    pub mean: f64,
    /// Largest.
    pub max: f64,
}

/// A configuration and its error.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Worst {
    /// GGX roughness along x.
    pub alpha_x: f64,
    /// GGX roughness along y.
    pub alpha_y: f64,
    /// Polar angle of the view direction, radians.
    pub theta: f64,
    /// Azimuth of the view direction, radians.
    pub phi: f64,
    /// Sliced Wasserstein-1 distance.
    pub sw1: f64,
    /// The distance `sw1` relative to the lobe's width.
    pub width: f64,
}

impl Accuracy {
    /// Summarises the figures of all configurations. Domain: at least one measurement.
    pub(super) fn of(figures: &[Figures]) -> Self {
        let mut by_width: Vec<&Figures> = figures.iter().collect();
        // The sort is stable: equal errors keep the order of measurement.
        by_width.sort_by(|a, b| b.width.total_cmp(&a.width));
        let term = |k: usize| {
            let errors: Option<Vec<f64>> = figures.iter().map(|f| f.terms.map(|terms| terms[k])).collect();
            errors.map(Spread::of).map(|Spread { mean, max, .. }| TermError { mean, max })
        };
        let spread = |value: fn(&Figures) -> f64| Spread::of(figures.iter().map(value).collect());
        Self {
            points: figures.len(),
            sw1: spread(|f| f.sw1),
            width: spread(|f| f.width),
            light: spread(|f| f.light),
            amplitude: term(0),
            fresnel: term(1),
            worst: by_width.into_iter().take(WORST).map(worst).collect(),
        }
    }
}

fn worst(figures: &Figures) -> Worst {
    let Figures { at, sw1, width, .. } = *figures;
    Worst { alpha_x: at.alpha_x, alpha_y: at.alpha_y, theta: at.theta, phi: at.phi, sw1, width }
}

impl Spread {
    fn of(mut values: Vec<f64>) -> Self {
        let mean = values.iter().sum::<f64>() / values.len() as f64;
        values.sort_by(|a, b| b.total_cmp(a));
        // The nearest rank from below is ceil(0.95 n). Counted from the largest, floor(0.05 n) values are above it.
        Self { mean, p95: values[values.len() / 20], max: values[0] }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Configuration;

    #[test]
    fn the_worst_are_named_by_width_and_ranks_are_the_nearest() {
        let figures: Vec<Figures> = (0..40_u32)
            .map(|i| {
                let (rank, i) = (f64::from(i * 7 % 40), f64::from(i));
                let at = Configuration { alpha_x: 0.5, alpha_y: 0.25, theta: i, phi: 0.0 };
                Figures { at, sw1: i, width: rank, light: 0.5, terms: Some([i, 0.0]) }
            })
            .collect();
        let found = Accuracy::of(&figures);
        assert_eq!(found.points, 40);
        assert_eq!(found.sw1, Spread { mean: 19.5, p95: 37.0, max: 39.0 });
        assert_eq!(found.amplitude, Some(TermError { mean: 19.5, max: 39.0 }));
        assert_eq!(found.worst.iter().map(|w| w.width).collect::<Vec<_>>(), [39.0, 38.0, 37.0, 36.0, 35.0]);
        // The largest rank is 39, for i = 17: 7 * 17 mod 40 = 39.
        assert_eq!((found.worst[0].theta, found.worst[0].sw1), (17.0, 17.0));
        let bare: Vec<Figures> = figures.iter().map(|f| Figures { terms: None, ..*f }).collect();
        assert_eq!(Accuracy::of(&bare).fresnel, None);
    }
}
