//! From fitted entries to the table of a layout.

use half::f16;

use super::{
    Plan, Precision,
    align::{align, align_to},
    entry::{FittedEntry, mirrors},
    target::LobeTerms,
};
use crate::fit::{
    ltc::{Layout, PerAxis, Reflection, Table, Terms},
    math::{from_row_major, pow, row_major},
};

/// The least ratio of a stored block's eigenvalues. A lobe that is a curved line, at grazing angles, fits best with none;
/// numbers of 24 or 11 bits hold a matrix upright whose block is some 100 or 8 times wider than their last bit. Where
/// the block is the lobe's own, ten times wider keeps a shader's inverse of a needle at the horizon within 1e-3.
fn flattest(precision: Precision, layout: Layout) -> f64 {
    match (precision, layout) {
        (Precision::F32, Layout::Reflected) => 1e-5,
        (Precision::F32, Layout::Kt2022) => 1e-4,
        (Precision::F16, _) => 1.0 / 256.0,
    }
}

/// An entry's numbers as they are stored, before rounding.
struct Stored {
    matrix: [f64; 9],
    amplitude: f64,
    fresnel: f64,
}

/// Aligns, normalises and rounds all entries of a plan, given in storage order, into its table.
#[must_use]
pub fn assemble(plan: &Plan, entries: &[FittedEntry]) -> Table {
    let recipe = plan.recipe();
    let round = |x: f64| match recipe.precision {
        Precision::F32 => x as f32,
        // The crate's portable conversion: the processor's own rounds twice on its way from f64.
        Precision::F16 => f16::from_f64_const(x).to_f32_const(),
    };
    let stored: Vec<Stored> = (0..).zip(entries).map(|(index, entry)| store(plan, index, entry)).collect();
    let column = |value: fn(&Stored) -> f64| stored.iter().map(|entry| round(value(entry))).collect();
    Table {
        layout: recipe.layout,
        axes: plan.nodes().clone(),
        matrix: stored.iter().map(|entry| entry.matrix.map(round)).collect(),
        terms: recipe
            .terms
            .then(|| Terms { amplitude: column(|entry| entry.amplitude), fresnel: column(|entry| entry.fresnel) }),
        node_error: entries.iter().map(|entry| round(entry.error)).collect(),
    }
}

fn store(plan: &Plan, index: u64, entry: &FittedEntry) -> Stored {
    let place = plan.place(index);
    let wo = place.view();
    let FittedEntry { matrix, amplitude, fresnel, .. } = *entry;
    let (m, mirrors, flattest) =
        (from_row_major(&matrix), mirrors(wo), flattest(plan.recipe().precision, plan.recipe().layout));
    let m = match plan.recipe().layout {
        Layout::Kt2022 => align(&m, mirrors, flattest),
        Layout::Reflected => align_to(&Reflection::of(&place.surface(), wo).matrix, &m, mirrors, flattest),
    };
    let LobeTerms { amplitude, fresnel } = stored_terms(plan.recipe().layout, &place, LobeTerms { amplitude, fresnel });
    Stored { matrix: row_major(&(m * (1.0 / m.z_axis.length()))), amplitude, fresnel }
}

/// A lobe's terms as a layout stores them.
pub(super) fn stored_terms(layout: Layout, place: &PerAxis<f64>, terms: LobeTerms) -> LobeTerms {
    match layout {
        Layout::Kt2022 => terms,
        Layout::Reflected => {
            let reflection = Reflection::of(&place.surface(), place.view());
            // The inverse of `Reflection::terms`. The lobe of a view above the horizon has an amplitude.
            let grazing = pow(terms.fresnel / terms.amplitude, 0.2);
            LobeTerms { amplitude: terms.amplitude / reflection.amplitude, fresnel: grazing - reflection.grazing }
        }
    }
}
