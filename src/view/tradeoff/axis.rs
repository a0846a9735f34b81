//! A logarithmic axis of a picture.

/// Maps values to a picture's coordinate by their logarithm.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct LogAxis {
    low: f64,
    high: f64,
    /// Coordinates of `low` and `high`.
    ends: [f64; 2],
}

/// The margin at both ends, as a part of the axis.
const MARGIN: f64 = 0.05;
/// Values are outliers if the axis without them is at most this part as long, and if they are at most this part of all.
const OUTLIER_SPAN: f64 = 0.5;
const OUTLIER_SHARE: f64 = 0.1;
/// Values whose greatest is less than this times their least have no outliers: they are told apart anyway.
const OUTLIER_FACTOR: f64 = 4.0;

impl LogAxis {
    /// An axis that shows all positive `values` but outliers, between the coordinates `ends`. Without any, from 1
    /// to 10.
    pub(super) fn over(values: impl Iterator<Item = f64>, ends: [f64; 2]) -> Self {
        let mut values: Vec<f64> = values.filter(|value| *value > 0.0 && value.is_finite()).collect();
        values.sort_by(f64::total_cmp);
        Self::between(without_outliers(&values), ends)
    }

    /// An axis that shows all positive `values`.
    pub(super) fn over_all(values: impl Iterator<Item = f64>, ends: [f64; 2]) -> Self {
        let mut values: Vec<f64> = values.filter(|value| *value > 0.0 && value.is_finite()).collect();
        values.sort_by(f64::total_cmp);
        Self::between(&values, ends)
    }

    /// An axis over ascending values.
    fn between(values: &[f64], ends: [f64; 2]) -> Self {
        let (low, high) = match values {
            [] => (1.0, 10.0),
            [low, .., high] => (*low, *high),
            [lone] => (*lone, *lone),
        };
        // A lone value stands in the middle of a factor of two.
        let span = (high / low).ln().max(std::f64::consts::LN_2 * 0.5);
        let margin = (MARGIN * span).exp();
        Self { low: low / margin, high: (low * span.exp()).max(high) * margin, ends }
    }

    /// Whether `value` lies beyond the axis, and is drawn at its end.
    pub(super) fn is_beyond(&self, value: f64) -> bool {
        !(self.low..=self.high).contains(&value)
    }

    /// Where `value` is drawn; values beyond the axis are drawn at its end.
    pub(super) fn at(&self, value: f64) -> f64 {
        let part = (value.max(self.low) / self.low).ln() / (self.high / self.low).ln();
        self.ends[0] + (self.ends[1] - self.ends[0]) * part.min(1.0)
    }

    /// Values to mark: of each decade 1, 2 and 5, or all nine where the axis spans less than one.
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

    /// The values to mark: whole decades alone where the others would be closer together than `least`.
    pub(super) fn ticks_apart(&self, least: f64) -> Vec<f64> {
        let ticks = self.ticks();
        let is_close = |pair: &[f64]| (self.at(pair[1]) - self.at(pair[0])).abs() < least;
        if !ticks.windows(2).any(is_close) {
            return ticks;
        }
        let decades: Vec<f64> = ticks.iter().copied().filter(|tick| tick.log10().fract().abs() < 1e-9).collect();
        if decades.len() < 2 { ticks } else { decades }
    }
}

/// Ascending values without the few at either end that would take most of the axis.
fn without_outliers(values: &[f64]) -> &[f64] {
    let most = ((values.len() as f64 * OUTLIER_SHARE) as usize).max(1);
    let span = |values: &[f64]| match values {
        [low, .., high] => (high / low).ln(),
        _ => 0.0,
    };
    if span(values) < OUTLIER_FACTOR.ln() {
        return values;
    }
    // Two values have no common scale that either could be off.
    let is_shorter = |rest: &[f64]| rest.len() > 2 && span(rest) <= OUTLIER_SPAN * span(values);
    // The fewest that do, counted over both ends.
    let mut dropped = (1..=most).flat_map(|all| (0..=all).map(move |below| [below, all - below]));
    let rest = |[below, above]: [usize; 2]| values.get(below..values.len().saturating_sub(above)).unwrap_or_default();
    let found = dropped.find(|ends| is_shorter(rest(*ends)));
    found.map_or(values, rest)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_lie_inside_in_order_and_factors_are_lengths() {
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
    fn an_axis_of_all_values_has_no_outliers_and_its_ticks_leave_room() {
        let values = [3e-4, 0.02, 0.021, 0.022, 0.023, 0.024, 0.025, 0.026, 0.027, 0.028, 0.029];
        let axis = LogAxis::over_all(values.into_iter(), [0.0, 100.0]);
        assert!(values.iter().all(|value| !axis.is_beyond(*value)));
        assert_eq!(axis.ticks_apart(1.0), axis.ticks());
        assert_eq!(axis.ticks_apart(30.0), [1e-3, 1e-2]);
    }

    #[test]
    fn outliers_leave_the_axis_to_the_others() {
        let axis = |values: &[f64]| LogAxis::over(values.iter().copied(), [0.0, 100.0]);
        let crowd = [0.05, 0.051, 0.055, 0.06, 0.08, 0.1];
        for outlier in [1e-4, 9.0] {
            let axis = axis(&[&crowd[..], &[outlier]].concat());
            assert!(axis.is_beyond(outlier) && crowd.iter().all(|value| !axis.is_beyond(*value)), "{outlier}");
            assert!(axis.at(0.1) - axis.at(0.05) > 80.0, "{outlier}");
            assert_eq!(axis.at(outlier), if outlier > 1.0 { 100.0 } else { 0.0 });
        }
        // A wide range that is filled has none.
        let filled: Vec<f64> = (0..12).map(|i| 2_f64.powi(i)).collect();
        assert!(filled.iter().all(|value| !axis(&filled).is_beyond(*value)));
    }
}
