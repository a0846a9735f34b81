//! Converts fitted entries to a table in the layout of the recipe.

use super::{
    between,
    brdf::{LobeTerms, Mirrors},
    entry::FittedEntry,
    layout::{LobeNumbers, Precision, Reflection},
    math::{from_half_bits, from_row_major, half_bits_f64, row_major},
    recipe::StoredTerms,
    second,
    shard::Plan,
    table::{Table, Terms},
    terms::edge_spreads,
};

/// Aligns, normalises and rounds all entries of a plan, given in storage order, into its table.
#[must_use]
pub fn assemble(plan: &Plan, entries: &[FittedEntry]) -> Table {
    let recipe = plan.recipe();
    let round = |x: f64| match recipe.precision {
        Precision::F32 => x as f32,
        // The processor's conversion from f64 to f16 rounds twice, so the conversion is done in software.
        Precision::F16 => from_half_bits(half_bits_f64(x)),
    };
    let stored = stored(plan, entries);
    let matrices = |stored: &[LobeNumbers]| stored.iter().map(|entry| row_major(&entry.matrix).map(round)).collect();
    let column = |value: fn(&LobeNumbers) -> f64| stored.iter().map(|entry| round(value(entry))).collect();
    Table {
        brdf: recipe.brdf.clone(),
        lobe: recipe.lobe,
        layout: recipe.layout,
        axes: plan.nodes().clone(),
        matrix: matrices(&stored),
        second: second::entries(plan, entries).map(|entries| matrices(&self::stored(plan, &entries))),
        terms: recipe.terms.any().then(|| Terms {
            amplitude: column(|entry| entry.terms.amplitude),
            fresnel: column(|entry| entry.terms.fresnel),
            edge: (recipe.terms == StoredTerms::F82)
                .then(|| edge_spreads(&recipe.brdf, recipe.layout, plan.nodes()).into_iter().map(round).collect()),
        }),
        node_error: entries.iter().map(|entry| round(entry.error)).collect(),
    }
}

/// The numbers that the layout stores for each entry.
fn stored(plan: &Plan, entries: &[FittedEntry]) -> Vec<LobeNumbers> {
    let own: Vec<LobeNumbers> = (0..).zip(entries).map(|(index, entry)| store(plan, index, entry)).collect();
    let chosen = if plan.recipe().is_searched() { between::chosen(plan, entries, &own) } else { None };
    chosen.unwrap_or(own)
}

/// The numbers that a layout stores for an entry.
fn store(plan: &Plan, index: u64, entry: &FittedEntry) -> LobeNumbers {
    let (place, recipe) = (plan.place(index), plan.recipe());
    let FittedEntry { matrix, amplitude, fresnel, .. } = *entry;
    let rules = recipe.layout.rules();
    let mut matrix = from_row_major(&matrix);
    if rules.is_relative() {
        matrix = recipe.lobe.rules().relative_to(&Reflection::at(&place).matrix, &matrix);
    }
    let lobe = LobeNumbers { matrix, terms: LobeTerms { amplitude, fresnel } };
    let LobeNumbers { matrix, terms } = rules.store(&place, &lobe, Mirrors::of(place.view()), recipe.precision);
    LobeNumbers { matrix: matrix * (1.0 / rules.norm(&matrix)), terms }
}
