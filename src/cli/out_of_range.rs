//! Points outside a table's range, and the values that are looked up instead.

use std::{collections::BTreeMap, fmt};

use ltcforge_fit::{Configuration, PerAxis, Table};

/// Tolerance for values that decimal or f32 rounding moves outside a range; absolute below 1, relative above.
const ROUNDING: f64 = 1e-6;

/// A value that was replaced because it lies outside the range of its axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Clamped {
    pub(super) axis: &'static str,
    /// The end of the range, used instead of the value.
    pub(super) to: f64,
    /// Whether the value is below the range.
    is_below: bool,
}

/// The values of a configuration that lie outside the range of a table.
pub(super) fn clamped(configuration: &Configuration, table: &Table, range: &PerAxis<[f64; 2]>) -> Vec<Clamped> {
    let folded = configuration.folded();
    // An isotropic table with one phi covers every phi.
    let serves_every_phi = table.serves_every_phi();
    let axes = folded.named().into_iter().zip(range.named());
    let outside = axes.filter_map(|((axis, value), (_, [low, high]))| {
        let slack = ROUNDING * value.abs().max(1.0);
        if axis == "phi" && serves_every_phi {
            None
        } else if *value < low - slack {
            Some(Clamped { axis, to: *low, is_below: true })
        } else if *value > high + slack {
            Some(Clamped { axis, to: *high, is_below: false })
        } else {
            None
        }
    });
    outside.collect()
}

/// The number of points out of range, by axis and side.
#[derive(Debug, Default)]
pub(super) struct OutOfRangeCount {
    points: u64,
    clamped: u64,
    ends: BTreeMap<(&'static str, bool), (u64, f64)>,
}

impl OutOfRangeCount {
    /// Counts a point.
    pub(super) fn count(&mut self, clamped: &[Clamped]) {
        self.points += 1;
        self.clamped += u64::from(!clamped.is_empty());
        for Clamped { axis, to, is_below } in clamped {
            self.ends.entry((*axis, !is_below)).or_insert((0, *to)).0 += 1;
        }
    }

    /// Whether no point was out of range.
    pub(super) fn is_empty(&self) -> bool {
        self.clamped == 0
    }
}

impl fmt::Display for OutOfRangeCount {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { points, clamped, ends } = self;
        write!(f, "{clamped} of {points} points are outside the table's range and were clamped:")?;
        for ((axis, is_above), (count, to)) in ends {
            let side = if *is_above { "above" } else { "below" };
            write!(f, "\n  {axis} {side} {to}: {count} clamped to {to}")?;
        }
        Ok(())
    }
}
