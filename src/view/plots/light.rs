//! Errors of light over theta and alpha, over all ratios and azimuths: the measure that tables and closed forms share.

use super::chart::Chart;
use crate::picture::{Panel, Picture, bar, colour, grid, headed, short_digest};
use ltcforge_fit::{BrdfKind, BrdfModel, PerAxis, Table};
use ltcforge_light::{EVERYWHERE, LightError, LightModel, Lighting, NormalsRule, light_map};

/// Cells a side.
const CELLS: usize = 25;
/// The errors at the ends of the colours.
const ENDS: [f64; 2] = [1e-4, 1e-1];

/// A table and its names: its file's digest in hexadecimal, and the range that it covers.
#[derive(Debug, Clone, Copy)]
pub struct NamedTable<'a> {
    /// The table.
    pub table: &'a Table,
    /// The digest of its file, in hexadecimal.
    pub digest: &'a str,
    /// The ranges of its axes.
    pub range: &'a PerAxis<[f64; 2]>,
}

/// Draws how far off the closed form in the space of normals is under a rule, and before it a table if one is given, by
/// `count` random lights in each cell. A table of another scattering model than GGX stands alone. Measures on the
/// current rayon pool; its size changes nothing.
///
/// # Errors
/// [`LightError`] for a table that does not tell, and one of a tabulated model without its numbers.
pub fn light_errors(table: Option<NamedTable<'_>>, rule: NormalsRule, count: usize) -> Result<Picture, LightError> {
    let ggx = BrdfModel::from(BrdfKind::Ggx);
    let brdf = table.map_or(&ggx, |named| named.table.model());
    let closed = LightModel::Normals.closed_form(Some(rule)).filter(|_| *brdf == BrdfKind::Ggx);
    let models: Vec<Lighting<'_>> =
        table.iter().map(|named| Lighting::by(named.table)).chain(closed.map(Lighting::ClosedForm)).collect();
    let range = table.map_or(EVERYWHERE, |named| *named.range);
    let map = light_map(&models, brdf, &range, CELLS, count)?;
    let nodes = table.map_or([&[][..], &[][..]], |NamedTable { table, .. }| [&table.axes.alpha, &table.axes.theta]);
    let chart = Chart { cells: CELLS, roughness: map.roughness, theta: map.theta, nodes, ends: ENDS };
    let titles = table
        .iter()
        .map(|named| format!("LTC, table {}", short_digest(named.digest)))
        .chain(closed.map(|_| format!("model normals, rule {rule}")));
    let titles: Vec<String> = titles
        .zip(&map.errors)
        .map(|(title, errors)| format!("{title}: mean {:.5}", errors.iter().sum::<f64>() / errors.len() as f64))
        .collect();
    let panels: Vec<Panel<'_>> = titles
        .iter()
        .zip(&map.errors)
        .map(|(title, errors)| {
            let picture = chart.draw(errors);
            let foot = bar(picture.width, colour, ["0.0001", "0.1"], &["logarithmic"]);
            Panel { title, picture, foot }
        })
        .collect();
    let what = format!("mean absolute error of the light of {count} rectangles of radiance one a cell");
    let how = "alpha is spaced evenly in its square root; all ratios and azimuths";
    Ok(headed(&[&[&what, "mean error of light"], &[how]], &grid(&panels, panels.len() as u32)))
}
