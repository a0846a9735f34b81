//! Errors of a table over theta and alpha, at one ratio and phi.

use serde_json::json;

use super::{ErrorSlice, chart};
use crate::picture::{Panel, Picture, bar, colour, grid, headed, number};
use ltcforge_fit::{ErrorMap, GoOn, Table, error_map_while};

/// Configurations along each side of the map: four or five for each step between nodes of the default table.
pub(super) const CELLS: usize = 40;

/// Draws both errors next to each other. Returns `None` as soon as `go_on` returns false.
pub(super) fn draw_while(go_on: &GoOn, table: &Table, name: &str, slice: ErrorSlice) -> Option<Picture> {
    Some(shown(&error_map_while(go_on, table, slice.ratio, slice.phi, CELLS)?, table, name))
}

/// The errors of a table at one ratio and phi, as JSON. `alpha` and `theta` have 40 values each, and `width` and
/// `light` have one row per alpha, from the smoothest surface. `go_on` is called before each configuration. Returns
/// `None` as soon as it returns false.
#[must_use]
pub fn error_numbers_while(go_on: &GoOn, table: &Table, slice: ErrorSlice) -> Option<String> {
    let map = error_map_while(go_on, table, slice.ratio, slice.phi, CELLS)?;
    let middles = |[low, high]: [f64; 2]| {
        (0..map.cells).map(|i| low + (high - low) * (i as f64 + 0.5) / map.cells as f64).collect::<Vec<_>>()
    };
    // Measurements are accurate to fewer than four significant digits.
    let short = |error: &f64| format!("{error:.3e}").parse().unwrap_or(*error);
    let rows = |errors: &[f64]| -> Vec<Vec<f64>> {
        errors.chunks(map.cells).map(|row| row.iter().map(short).collect()).collect()
    };
    let alpha: Vec<f64> = middles(map.roughness).iter().map(|root| root * root).collect();
    let numbers = json!({
        "ratio": map.ratio, "phi": map.phi, "alpha": alpha, "theta": middles(map.theta),
        "width": rows(&map.width), "light": rows(&map.light),
    });
    Some(numbers.to_string())
}

fn shown(map: &ErrorMap, table: &Table, name: &str) -> Picture {
    let panels =
        [("lobe error, % of the lobe's width", &map.width), ("light error, % of the lobe's energy", &map.light)].map(
            |(title, errors)| {
                let picture = chart::draw(map, errors, &table.axes);
                let foot = bar(picture.width, colour, ["0.1 %", "100 %"], &["logarithmic"]);
                Panel { title, picture, foot }
            },
        );
    let at = format!("{name}: errors at ratio {}, phi {} rad", number(map.ratio as f32), number(map.phi as f32));
    let how = "alpha is spaced evenly in its square root; short ticks are the table's nodes";
    headed(&[&[&at], &[how]], &grid(&panels, 2))
}
