//! Converts a table to numbers that vary smoothly, and back.

use super::{Table, Terms};
use crate::{
    axes::PerAxis,
    brdf::{BrdfKind, LobeTerms},
    layout::{Layout, LobeNumbers, SMOOTH_NUMBERS},
    lobe::LobeModel,
    math::{from_row_major, row_major},
};

impl Table {
    /// The [`SMOOTH_NUMBERS`] of each entry. The two numbers of the terms are zero for a table without terms.
    #[must_use]
    pub fn smooth_numbers(&self) -> Vec<[f64; SMOOTH_NUMBERS]> {
        let entry = |(index, matrix): (usize, &[f32; 9])| {
            let terms = self.terms.as_ref().map(|terms| (terms.amplitude[index], terms.fresnel[index]));
            let (amplitude, fresnel) = terms.map_or((1.0, 0.0), |(a, f)| (f64::from(a), f64::from(f)));
            let matrix = from_row_major(&matrix.map(f64::from));
            let stored = LobeNumbers { matrix, terms: LobeTerms { amplitude, fresnel } };
            let mut numbers = self.layout.to_smooth(&self.node(index), &stored);
            if self.terms.is_none() {
                numbers[SMOOTH_NUMBERS - 2..].fill(0.0);
            }
            numbers
        };
        self.matrix.iter().enumerate().map(entry).collect()
    }

    /// Converts these numbers, one row for each entry, to a table. They do not contain `node_error`, which is set to
    /// NaN.
    #[must_use]
    pub fn of_smooth_numbers(
        (brdf, lobe, layout): (BrdfKind, LobeModel, Layout),
        axes: PerAxis<Vec<f64>>,
        numbers: &[[f64; SMOOTH_NUMBERS]],
        has_terms: bool,
    ) -> Self {
        let stored: Vec<LobeNumbers> = numbers
            .iter()
            .enumerate()
            .map(|(index, numbers)| layout.of_smooth(&layout.node(&axes, index), numbers))
            .collect();
        let terms = has_terms.then(|| Terms {
            amplitude: stored.iter().map(|entry| entry.terms.amplitude as f32).collect(),
            fresnel: stored.iter().map(|entry| entry.terms.fresnel as f32).collect(),
            edge: None,
        });
        let matrix = stored.iter().map(|entry| row_major(&entry.matrix).map(|x| x as f32)).collect();
        Self {
            brdf: brdf.into(),
            lobe,
            layout,
            axes,
            matrix,
            second: None,
            terms,
            node_error: vec![f32::NAN; numbers.len()],
        }
    }
}
