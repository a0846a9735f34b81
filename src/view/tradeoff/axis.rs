//! A logarithmic axis of a picture.

/// Maps values to coordinates of a picture, by their logarithm.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct LogAxis {
    low: f64,
    high: f64,
    /// Coordinates of `low` and `high`.
    ends: [f64; 2],
}

/// The margin at both ends, as a share of the axis.
const MARGIN: f64 = 0.05;

impl LogAxis {
    /// An axis that shows all positive `values` between the coordinates `ends`. Without values it shows 1 to 10.
    pub(super) fn over(values: impl Iterator<Item = f64>, ends: [f64; 2]) -> Self {
        let shown = values.filter(|value| *value > 0.0 && value.is_finite());
        let [low, high] = shown.fold([f64::INFINITY, 0.0_f64], |[low, high], value| [low.min(value), high.max(value)]);
        let [low, high] = if low > high { [1.0, 10.0] } else { [low, high] };
        // An axis of a single value begins just below it and spans a factor of more than sqrt(2).
        let span = (high / low).ln().max(std::f64::consts::LN_2 * 0.5);
        let margin = (MARGIN * span).exp();
        Self { low: low / margin, high: (low * span.exp()).max(high) * margin, ends }
    }

    /// The coordinate of `value`. Values beyond the axis are placed at its end.
    pub(super) fn at(&self, value: f64) -> f64 {
        let part = (value.max(self.low) / self.low).ln() / (self.high / self.low).ln();
        self.ends[0] + (self.ends[1] - self.ends[0]) * part.min(1.0)
    }

    /// Values to mark in each decade: 1, 2 and 5; more on an axis that spans a small factor, only 1 on a long axis.
    pub(super) fn ticks(&self) -> Vec<f64> {
        let steps: &[f64] = match self.high / self.low {
            span if span < 6.0 => &[1.0, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0],
            span if span < 2e3 => &[1.0, 2.0, 5.0],
            _ => &[1.0],
        };
        let decades = self.low.log10().floor() as i32..=self.high.log10().ceil() as i32;
        let all = decades.flat_map(|decade| steps.iter().map(move |step| step * 10_f64.powi(decade)));
        all.filter(|tick| (self.low..=self.high).contains(tick)).collect()
    }

    /// Values of [`Self::ticks`] that are at least `least` apart. Powers of ten come first, then 5, then 2.
    pub(super) fn ticks_apart(&self, least: f64) -> Vec<f64> {
        let mut ticks = self.ticks();
        ticks.sort_by_key(|tick| match (tick / 10_f64.powf((tick.log10() + 1e-9).floor())).round() as u32 {
            1 => 0,
            5 => 1,
            2 => 2,
            _ => 3,
        });
        let mut kept: Vec<f64> = Vec::new();
        for tick in ticks {
            if kept.iter().all(|other| (self.at(*other) - self.at(tick)).abs() >= least) {
                kept.push(tick);
            }
        }
        kept.sort_by(f64::total_cmp);
        kept
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_inside_in_order_and_equal_factors_have_equal_lengths() {
        let axis = LogAxis::over([0.02, 0.2, 2.0].into_iter(), [100.0, 500.0]);
        let [a, b, c] = [0.02, 0.2, 2.0].map(|value| axis.at(value));
        assert!(100.0 < a && a < b && b < c && c < 500.0, "{a} {b} {c}");
        assert!(((b - a) - (c - b)).abs() < 1e-9);
        assert_eq!(axis.at(0.0), 100.0);
    }

    #[test]
    fn every_axis_has_ticks_within_it() {
        for values in [vec![], vec![3.0], vec![0.11, 0.12], vec![0.05, 0.3], vec![0.1, 90.0], vec![1e-3, 1e6]] {
            let axis = LogAxis::over(values.iter().copied(), [0.0, 1.0]);
            let ticks = axis.ticks();
            assert!(!ticks.is_empty() && ticks.len() < 14, "{values:?}: {ticks:?}");
            assert!(ticks.iter().all(|tick| (0.0..=1.0).contains(&axis.at(*tick))));
        }
    }

    #[test]
    fn ticks_leave_room() {
        let values = [3e-4, 0.02, 0.021, 0.022, 0.023, 0.024, 0.025, 0.026, 0.027, 0.028, 0.029];
        let axis = LogAxis::over(values.into_iter(), [0.0, 100.0]);
        assert_eq!(axis.ticks_apart(1.0), axis.ticks());
        assert_eq!(axis.ticks_apart(30.0), [1e-3, 1e-2]);
        // Two round numbers close together, on an axis with a single power of ten.
        let axis = LogAxis::over([520.0, 2150.0].into_iter(), [0.0, 480.0]);
        assert_eq!(axis.ticks_apart(52.0), [500.0, 600.0, 800.0, 1000.0, 1500.0, 2000.0]);
    }
}
