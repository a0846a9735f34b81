//! The order of searches. Each search starts from the result of another.

use ltcforge::view::picture::{Panel, Picture, grid, headed};

use crate::figures::curves::{Curve, Frame, legend};

const DOWN_IN_ROUGHNESS: [u8; 3] = [235, 80, 70];
const DOWN_IN_VIEW: [u8; 3] = [90, 150, 250];
const ENTRY: [u8; 3] = [150, 150, 150];
/// The roughnesses of the drawn rows.
const ROUGHNESSES: [f64; 3] = [0.15, 0.45, 0.8];
/// Half the side of a mark, in units of the axes.
const MARK: f64 = 0.008;

/// Draws marks at some nodes, and the paths of searches to three rows of a table.
pub(in crate::figures) fn draw() -> Picture {
    let mut curves = Vec::new();
    let steps = |count: u32| (0..=count).map(move |i| f64::from(i) / f64::from(count));
    for (u, v) in steps(16).flat_map(|u| steps(16).map(move |v| (u, v))) {
        curves.push(Curve { points: vec![[u - MARK, v], [u + MARK, v]], colour: ENTRY });
    }
    for (row, roughness) in ROUGHNESSES.into_iter().enumerate() {
        // All paths run along the same edge, so they are drawn next to each other.
        let edge = 1.0 - 0.015 * row as f64;
        let mut u = 1.0_f64;
        while u > roughness {
            // Halving alpha divides the roughness by the square root of two.
            let next = (u * std::f64::consts::FRAC_1_SQRT_2).max(roughness);
            arrow(&mut curves, [u, edge], [next, edge], DOWN_IN_ROUGHNESS);
            u = next;
        }
        arrow(&mut curves, [roughness, edge], [roughness, 0.0], DOWN_IN_VIEW);
    }
    let ticks = [0.0, 0.5, 1.0];
    let picture = Frame { x: [0.0, 1.02], y: [0.0, 1.02], x_ticks: &ticks, y_ticks: &ticks }.draw(&curves);
    let names = [("alpha halves", DOWN_IN_ROUGHNESS), ("node by node", DOWN_IN_VIEW)];
    let foot = legend(picture.width, &names);
    let panel = Panel { title: "roughness; up: views less grazing", picture, foot };
    let what = "warm starts: each arrow starts a search";
    headed(&[&[what], &["from the result at its tail"]], &grid(&[panel], 1))
}

/// Adds an arrow to the curves.
fn arrow(curves: &mut Vec<Curve>, from: [f64; 2], to: [f64; 2], colour: [u8; 3]) {
    curves.push(Curve { points: vec![from, to], colour });
    let along = [to[0] - from[0], to[1] - from[1]];
    let length = (along[0] * along[0] + along[1] * along[1]).sqrt().max(1e-9);
    let [x, y] = along.map(|part| part / length * 0.03);
    for side in [-0.5, 0.5] {
        curves.push(Curve { points: vec![[to[0] - x - side * y, to[1] - y + side * x], to], colour });
    }
}
