//! A chart of errors in false colours: theta to the right, alpha upwards.

use crate::picture::{Anchor, GROUND, LINE, Picture, colour, number, write};
use ltcforge_fit::{ErrorMap, PerAxis};

/// Approximate side of the coloured square, in pixels.
const SIDE: u32 = 400;
/// Space at the left for alpha's ticks and labels, and at the top for the axis name.
const LEFT: u32 = 64;
const ABOVE: u32 = LINE + LINE / 2;
/// Space at the bottom for theta's ticks, labels and name.
const BELOW: u32 = TICK + 2 * LINE;
/// Length of a labelled tick. The tick of a node is half as long.
const TICK: u32 = 8;
const TICK_COLOUR: [u8; 3] = [230, 230, 230];
const NODE_COLOUR: [u8; 3] = [140, 140, 140];
/// Labelled values of the axes, if they are within the table's range: alpha, and theta in degrees.
const ALPHAS: [f64; 8] = [0.001, 0.01, 0.05, 0.1, 0.2, 0.4, 0.7, 1.0];
const DEGREES: [f64; 7] = [0.0, 15.0, 30.0, 45.0, 60.0, 75.0, 90.0];

/// The errors at the ends of the colour scale, which is logarithmic.
const ENDS: [f64; 2] = [1e-3, 1.0];

/// Draws errors in false colours, row by row from the smoothest surface, with axes and ticks at the table's nodes.
pub(super) fn draw(map: &ErrorMap, errors: &[f64], axes: &PerAxis<Vec<f64>>) -> Picture {
    let cells = map.cells as u32;
    let scale = SIDE / cells;
    let side = cells * scale;
    let mut picture = Picture::filled(LEFT + side + TICK, ABOVE + side + BELOW, GROUND);
    for (index, error) in (0_u32..).zip(errors) {
        let (column, row) = (index % cells, index / cells);
        let cell = Picture::filled(scale, scale, colour(logarithmic(*error)));
        picture.put(&cell, LEFT + column * scale, ABOVE + side - (row + 1) * scale);
    }
    let width = picture.width;
    let place = |x: f64, [low, high]: [f64; 2]| {
        let part = if high > low { (x - low) / (high - low) } else { 0.5 };
        // Rounding may place an end slightly outside the range.
        (-1e-6..=1.0 + 1e-6).contains(&part).then(|| (part * f64::from(side - 1)).round() as u32)
    };
    let up = |alpha: f64| place(alpha.sqrt(), map.roughness).map(|up| ABOVE + side - 1 - up);
    let right = |theta: f64| place(theta, map.theta).map(|right| LEFT + right);
    for y in axes.alpha.iter().filter_map(|alpha| up(*alpha)) {
        picture.put(&Picture::filled(TICK / 2, 1, NODE_COLOUR), LEFT - TICK / 2, y);
    }
    for x in axes.theta.iter().filter_map(|theta| right(*theta)) {
        picture.put(&Picture::filled(1, TICK / 2, NODE_COLOUR), x, ABOVE + side);
    }
    let alphas = labelled(&ALPHAS, map.roughness.map(|root| root * root), up);
    for (alpha, y) in alphas {
        picture.put(&Picture::filled(TICK, 1, TICK_COLOUR), LEFT - TICK, y);
        write(&mut picture, &number(alpha as f32), LEFT - TICK - 4, y, Anchor::Right, width);
    }
    for (degrees, x) in labelled(&DEGREES, map.theta.map(f64::to_degrees), |degrees| right(degrees.to_radians())) {
        picture.put(&Picture::filled(1, TICK, TICK_COLOUR), x, ABOVE + side);
        write(&mut picture, &number(degrees as f32), x, ABOVE + side + TICK + LINE / 2, Anchor::Middle, width);
    }
    write(&mut picture, "alpha", LEFT - TICK - 4, LINE / 2, Anchor::Right, width);
    let y = ABOVE + side + TICK + LINE + LINE / 2;
    write(&mut picture, "theta, degrees", LEFT + side / 2, y, Anchor::Middle, width);
    picture
}

/// The position of an error on the colour scale: 0 at the lower end, 1 at the upper end.
fn logarithmic(error: f64) -> f32 {
    let [low, high] = ENDS;
    (libm::log(error.max(low) / low) / libm::log(high / low)) as f32
}

/// The ticks to label and their positions, at least two lines of text apart. If fewer than two fit, it returns the two
/// ends of the axis.
fn labelled(ticks: &[f64], ends: [f64; 2], place: impl Fn(f64) -> Option<u32>) -> Vec<(f64, u32)> {
    let mut shown: Vec<(f64, u32)> = Vec::new();
    for tick in ticks {
        let Some(at) = place(*tick) else { continue };
        if shown.last().is_none_or(|(_, last)| last.abs_diff(at) >= 2 * LINE) {
            shown.push((*tick, at));
        }
    }
    if shown.len() >= 2 {
        return shown;
    }
    ends.into_iter().filter_map(|end| Some((end, place(end)?))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_axis_of_any_range_has_two_labels_that_do_not_touch() {
        let on = |[low, high]: [f64; 2]| {
            let place = move |x: f64| (low..=high).contains(&x).then(|| ((x - low) / (high - low) * 399.0) as u32);
            labelled(&DEGREES, [low, high], place)
        };
        assert_eq!(on([0.0, 90.0]).iter().map(|(tick, _)| *tick).collect::<Vec<_>>(), DEGREES);
        assert_eq!(on([46.0, 59.0]), [(46.0, 0), (59.0, 399)]);
        let wide = on([0.0, 900.0]);
        assert!(wide.windows(2).all(|pair| pair[0].1.abs_diff(pair[1].1) >= 2 * LINE) && wide.len() >= 2, "{wide:?}");
    }
}
