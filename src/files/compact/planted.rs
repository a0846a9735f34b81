//! Tables with known numbers, and their bytes.

use super::{CHANNELS, Rounding, Table, encode_rounded, header_of};
use crate::recipe_document;
use ltcforge_fit::{Layout, Recipe};

pub(super) fn recipe(layout: Layout, nodes: [u32; 4]) -> Recipe {
    let isotropic = layout.only_ranges().is_some();
    let [alpha, ratio, theta, phi] = if isotropic { [nodes[0], 1, nodes[2], 1] } else { nodes };
    let range = if isotropic { r#", "range": {"ratio": [1, 1], "phi": [0, 0]}"# } else { "" };
    let resolution = format!(r#"{{"alpha": {alpha}, "ratio": {ratio}, "theta": {theta}, "phi": {phi}}}"#);
    let document = format!(r#"{{"layout": "{layout}", "resolution": {resolution}{range}}}"#);
    recipe_document::parse(document.as_bytes(), u64::MAX).expect("a recipe")
}

/// A table whose numbers vary smoothly along each axis, from known values at the first nodes to known values at the last
/// nodes, plus `bump` of the channel and the position in [0, 1] on each axis.
///
/// # Panics
/// Never: the recipe is valid.
#[must_use]
pub fn planted(layout: Layout, nodes: [u32; 4], has_terms: bool, bump: impl Fn(usize, [f64; 4]) -> f64) -> Table {
    let recipe = recipe(layout, nodes);
    let axes = recipe.nodes();
    let lengths = axes.lengths().named().map(|(_, n)| *n);
    let part = |i: usize, n: usize| i as f64 / n.saturating_sub(1).max(1) as f64;
    let numbers = (0..lengths.iter().product()).map(|i: usize| {
        let [_, ratio, theta, phi] = lengths;
        let place = [
            part(i / (phi * theta * ratio), lengths[0]),
            part(i / (phi * theta) % ratio, ratio),
            part(i / phi % theta, theta),
            part(i % phi, phi),
        ];
        let bow: f64 = place.iter().map(|u| u * (1.5 - u)).sum::<f64>() / 4.0;
        let base = [1.0, 0.0, 0.8, 0.0, 0.0, 0.0, 0.0, 0.9, 0.1];
        let far = [1.3, -0.3, 1.1, 0.2, -0.1, -0.3, 0.2, 0.6, 0.2];
        std::array::from_fn(|channel| base[channel] + (far[channel] - base[channel]) * bow + bump(channel, place))
    });
    let numbers: Vec<[f64; CHANNELS]> = numbers.collect();
    Table::of_smooth_numbers((recipe.brdf(), recipe.lobe, recipe.layout), axes, &numbers, has_terms)
}

/// The bytes with the first steps, without measuring the error, because planted lobes are not real.
///
/// # Panics
/// The table has no compact form.
#[must_use]
pub fn unmeasured(table: &Table) -> Vec<u8> {
    let header = header_of(table).expect("a header");
    encode_rounded(table, header, &table.smooth_numbers(), Rounding::of(table)).expect("bytes")
}
