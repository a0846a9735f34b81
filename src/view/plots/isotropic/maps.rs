//! Numbers of every entry over roughness and view.

use super::fits::{Fit, SIDE, table};
use crate::{
    fit::Start,
    view::{
        picture::{Panel, Picture, bar, grid, headed, number},
        plots::matrix::Scale,
    },
};

/// Pixels a side of an entry.
const CELL: u32 = 4;

/// The name of a panel, whether its number may have either sign, and the number.
type Named = (&'static str, bool, fn(&Fit) -> f64);

/// The panels of all numbers.
const NUMBERS: [Named; 14] = [
    ("m11", false, |fit| fit.m11),
    ("m22", false, |fit| fit.m22),
    ("m13", true, |fit| fit.m13),
    ("mean direction, degrees", false, |fit| fit.angle),
    ("M: a", false, |fit| fit.matrix.x_axis.x),
    ("M: b", true, |fit| fit.matrix.z_axis.x),
    ("M: c", false, |fit| fit.matrix.y_axis.y),
    ("M: d", true, |fit| fit.matrix.x_axis.z),
    ("M: e", false, |fit| fit.matrix.z_axis.z),
    ("M^-1 c: first", false, |fit| inverse(fit).x_axis.x),
    ("M^-1 c: upper right", true, |fit| inverse(fit).z_axis.x),
    ("M^-1 c: lower left", true, |fit| inverse(fit).x_axis.z),
    ("M^-1 c: last", false, |fit| inverse(fit).z_axis.z),
    ("m13 / m11", true, |fit| fit.m13 / fit.m11),
];

/// `M^-1` over its middle element.
fn inverse(fit: &Fit) -> glam::DMat3 {
    fit.matrix.inverse() * fit.matrix.y_axis.y
}

/// The numbers of a table with warm starts.
pub(super) fn numbers() -> Picture {
    let fits = table(Start::Warm);
    let panels: Vec<Drawn> = NUMBERS
        .iter()
        .map(|(title, is_signed, of)| {
            let values = values(&fits, *of);
            Drawn::new((*title).to_owned(), &values, &Scale::of(&values, *is_signed))
        })
        .collect();
    let what =
        "GGX by metric l3 and solver nelder_mead: three numbers in the frame of the mean direction, and M of them";
    headed(&[&[what], &[AXES], &[COLOURS]], &together(&panels, 5))
}

/// The skew of every entry by either start.
pub(super) fn starts() -> Picture {
    let mut panels = Vec::new();
    let mut jumps = Vec::new();
    for &start in Start::ALL.iter().rev() {
        let fits = table(start);
        jumps.push(format!("{start} {:.5}", second_difference(&fits)));
        let skews: [Named; 2] = [("m13", true, |fit| fit.m13), ("m13 / m11", true, |fit| fit.m13 / fit.m11)];
        for (name, is_signed, of) in skews {
            let values = values(&fits, of);
            panels.push(Drawn::new(format!("{start}: {name}"), &values, &Scale::of(&values, is_signed)));
        }
    }
    let what = "skew by metric l3 with either start: roughness to the right, view downwards, 64 x 64";
    let how = format!("mean second difference of m13 / m11 along the view: {}", jumps.join(", "));
    headed(&[&[what], &[&how]], &together(&panels, 4))
}

const AXES: &str = "roughness sqrt(alpha) 0 to 1 to the right, sqrt(1 - cos theta) 0 to 1 downwards: 64 x 64";
const COLOURS: &str = "colours hold 98 % of the numbers, grey is zero of signed ones; cyan is below, green above";

fn values(fits: &[Fit], of: fn(&Fit) -> f64) -> Vec<f32> {
    fits.iter().map(|fit| of(fit) as f32).collect()
}

/// Mean absolute second difference of the relative skew along the view.
fn second_difference(fits: &[Fit]) -> f64 {
    let row = |row: &[Fit]| {
        let skew = |fit: &Fit| fit.m13 / fit.m11;
        row.windows(3).map(|s| (skew(&s[0]) - 2.0 * skew(&s[1]) + skew(&s[2])).abs()).sum::<f64>()
    };
    let side = SIDE as usize;
    fits.chunks(side).map(row).sum::<f64>() / (side * (side - 2)) as f64
}

/// A map with its title and its colours.
struct Drawn {
    title: String,
    picture: Picture,
    foot: Picture,
}

impl Drawn {
    fn new(title: String, values: &[f32], scale: &Scale) -> Self {
        let width = SIDE * CELL;
        let mut picture = Picture::filled(width, width, [0; 3]);
        for (index, value) in (0_u32..).zip(values) {
            let (roughness, view) = (index / SIDE, index % SIDE);
            picture.put(&Picture::filled(CELL, CELL, scale.colour(*value)), roughness * CELL, view * CELL);
        }
        let [low, high] = scale.ends().map(number);
        let foot = bar(width, scale.colours(), [&low, &high], &scale.middle());
        Self { title, picture, foot }
    }
}

fn together(drawn: &[Drawn], columns: u32) -> Picture {
    let panels: Vec<Panel<'_>> = drawn
        .iter()
        .map(|Drawn { title, picture, foot }| Panel { title, picture: picture.clone(), foot: foot.clone() })
        .collect();
    grid(&panels, columns)
}
