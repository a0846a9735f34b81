//! Finds lobes that even the best LTC or Gaussian approximates poorly.

use serde::Serialize;

use super::figures::Figures;

/// The error relative to the lobe's width above which a highlight looks visibly different.
pub const POOR_WIDTH: f64 = 0.15;

/// Nodes whose stored lobe has an error above [`POOR_WIDTH`]. A table with more nodes has the same error there, because
/// the error does not come from interpolation.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Poor {
    /// [`POOR_WIDTH`].
    pub limit: f64,
    /// The number of poor nodes among the measured nodes.
    pub nodes: usize,
    /// Smallest and largest roughness of these nodes, alpha; `None` without poor nodes.
    pub alpha: Option<[f64; 2]>,
    /// Smallest and largest polar angle of the view of these nodes, radians.
    pub theta: Option<[f64; 2]>,
}

impl Poor {
    /// The poor nodes among the measured nodes.
    pub(super) fn of(at_nodes: &[Figures]) -> Self {
        let poor: Vec<&Figures> = at_nodes.iter().filter(|figures| figures.width > POOR_WIDTH).collect();
        let extent = |value: fn(&Figures) -> f64| {
            let values = poor.iter().map(|figures| value(figures));
            values.map(|x| [x, x]).reduce(|[low, high], [x, _]| [low.min(x), high.max(x)])
        };
        Self {
            limit: POOR_WIDTH,
            nodes: poor.len(),
            alpha: extent(|figures| figures.at.alpha_x.max(figures.at.alpha_y)),
            theta: extent(|figures| figures.at.theta),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Configuration;

    #[test]
    fn poor_nodes_are_counted_and_located() {
        let figures = [(0.3, 0.1, 0.2, 0.151), (0.2, 0.7, 1.5, 0.9), (0.9, 0.9, 0.1, 0.15), (0.4, 0.4, 0.9, 0.2)];
        let figures = figures.map(|(alpha_x, alpha_y, theta, width)| Figures {
            at: Configuration { alpha_x, alpha_y, theta, phi: 0.0 },
            sw1: 0.1,
            width,
            light: 0.1,
            terms: None,
        });
        let all = Poor::of(&figures);
        assert_eq!((all.nodes, all.alpha, all.theta), (3, Some([0.3, 0.7]), Some([0.2, 1.5])));
        let none = Poor::of(&figures[2..3]);
        assert_eq!((none.nodes, none.alpha, none.theta, none.limit), (0, None, None, 0.15));
    }
}
