//! Pareto fronts.

/// For each `[price, error]` pair, whether it is on the Pareto front. A pair is on the front if no other pair is at
/// least as good in both numbers and better in one.
///
/// Domain: finite numbers.
#[must_use]
pub fn front(pairs: &[[f64; 2]]) -> Vec<bool> {
    let mut order: Vec<usize> = (0..pairs.len()).collect();
    order.sort_by(|a, b| {
        let ([price_a, error_a], [price_b, error_b]) = (pairs[*a], pairs[*b]);
        price_a.total_cmp(&price_b).then(error_a.total_cmp(&error_b))
    });
    let mut on_front = vec![false; pairs.len()];
    // The best pair so far. A pair equal to it is also on the front.
    let mut best = [f64::NEG_INFINITY, f64::INFINITY];
    for index in order {
        let [price, error] = pairs[index];
        if error < best[1] || [price, error] == best {
            on_front[index] = true;
            best = [price, error];
        }
    }
    on_front
}

/// The Pareto fronts that contain a row of the trade-off.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
pub struct Fronts {
    /// Error against seconds, over all rows.
    pub seconds: bool,
    /// Error against bytes, over all rows.
    pub bytes: bool,
    /// Error against seconds, over the rows with the base recipe's layout, resolution and precision. The presets choose
    /// only among these rows.
    pub base: bool,
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// Pairs from few different values, so that equal prices, errors and pairs occur.
    fn pairs() -> impl Strategy<Value = Vec<[f64; 2]>> {
        let value = || (0_u32..12).prop_map(f64::from);
        prop::collection::vec((value(), value()).prop_map(|(price, error)| [price, error]), 0..40)
    }

    proptest! {
        #[test]
        fn the_front_is_the_set_of_pairs_that_nothing_dominates(pairs in pairs()) {
            let dominates = |a: &[f64; 2], b: &[f64; 2]| a[0] <= b[0] && a[1] <= b[1] && a != b;
            let expected: Vec<bool> =
                pairs.iter().map(|pair| !pairs.iter().any(|other| dominates(other, pair))).collect();
            prop_assert_eq!(front(&pairs), expected);
        }
    }
}
