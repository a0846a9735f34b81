//! Errors over theta, to the right, and alpha, upwards.

use super::Slice;
use crate::{
    fit::{ErrorMap, Table, error_map},
    view::picture::{Anchor, GROUND, LINE, Panel, Picture, bar, colour, grid, headed, number, write},
};

/// Configurations measured a side: about four to a cell of the default table.
const CELLS: usize = 40;
/// Pixels a configuration.
const SCALE: u32 = 10;
/// Colours run from the one error to the other, evenly in its logarithm.
const ENDS: [f64; 2] = [1e-3, 1.0];
/// Room for the labels of alpha, and of theta.
const LEFT: u32 = 56;
const BELOW: u32 = LINE + TICK;
/// Length of the mark of a node.
const TICK: u32 = 6;
const TICK_COLOUR: [u8; 3] = [200, 200, 200];
/// Where the axes are labelled, as far as the table goes.
const ALPHAS: [f64; 6] = [0.01, 0.05, 0.15, 0.35, 0.65, 1.0];
const DEGREES: [f64; 4] = [0.0, 30.0, 60.0, 85.0];

/// Both errors side by side.
pub(super) fn draw(table: &Table, slice: Slice) -> Picture {
    let map = error_map(table, slice.ratio, slice.phi, CELLS);
    let panels = [("distance, % of the lobe's width", &map.width), ("light, % of the lobe", &map.light)].map(
        |(title, errors)| {
            let picture = panel(table, &map, errors);
            let foot = bar(picture.width, ["0.1 %", "100 %"], "logarithmic");
            Panel { title, picture, foot }
        },
    );
    let at = format!("errors at ratio {}, phi {} rad", number(map.ratio as f32), number(map.phi as f32));
    let how = "theta in degrees to the right, alpha upwards, evenly in its square root; ticks: nodes";
    headed(&[&[&at], &[how]], &grid(&panels, 2))
}

/// One error with its axes.
fn panel(table: &Table, map: &ErrorMap, errors: &[f64]) -> Picture {
    let side = CELLS as u32 * SCALE;
    let mut picture = Picture::filled(LEFT + side + TICK, side + BELOW, GROUND);
    for (index, error) in (0_u32..).zip(errors) {
        let (column, row) = (index % CELLS as u32, index / CELLS as u32);
        let cell = Picture::filled(SCALE, SCALE, colour(logarithmic(*error)));
        picture.put(&cell, LEFT + column * SCALE, side - (row + 1) * SCALE);
    }
    let width = picture.width;
    let along = |x: f64, [low, high]: [f64; 2]| {
        let part = if high > low { (x - low) / (high - low) } else { 0.5 };
        // A hair beyond an end is that end.
        (-1e-6..=1.0 + 1e-6).contains(&part).then(|| (part * f64::from(side - 1)).round() as u32)
    };
    for alpha in &table.axes.alpha {
        if let Some(up) = along(alpha.sqrt(), map.roughness) {
            picture.put(&Picture::filled(TICK, 1, TICK_COLOUR), LEFT - TICK, side - 1 - up);
        }
    }
    for theta in &table.axes.theta {
        if let Some(right) = along(*theta, map.theta) {
            picture.put(&Picture::filled(1, TICK, TICK_COLOUR), LEFT + right, side);
        }
    }
    for alpha in ALPHAS {
        if let Some(up) = along(alpha.sqrt(), map.roughness) {
            let y = (side - 1 - up).max(LINE / 2);
            write(&mut picture, &number(alpha as f32), LEFT - TICK - 4, y, Anchor::Right, width);
        }
    }
    for degrees in DEGREES {
        if let Some(right) = along(degrees.to_radians(), map.theta) {
            write(&mut picture, &number(degrees as f32), LEFT + right, side + TICK + LINE / 2, Anchor::Middle, width);
        }
    }
    picture
}

/// The place of an error between the ends of the colours.
fn logarithmic(error: f64) -> f32 {
    let [low, high] = ENDS;
    (libm::log(error.max(low) / low) / libm::log(high / low)) as f32
}
