//! Maps of the numbers of all entries, over roughness and view.

use ltcforge::{
    fit::Start,
    view::{
        picture::{Panel, Picture, bar, grid, headed, number},
        plots::Scale,
    },
};

use super::fits::{Fit, SIDE, table, table_from_cosine};

/// Side of an entry in the map, in pixels.
const CELL: u32 = 4;

/// The name of a panel, whether its number can have either sign, and the function that returns the number.
type Named = (&'static str, bool, fn(&Fit) -> f64);

/// The panels for all numbers.
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

/// `M^-1` divided by its middle element.
fn inverse(fit: &Fit) -> glam::DMat3 {
    fit.matrix.inverse() * fit.matrix.y_axis.y
}

/// The numbers of a table that was fitted with warm starts.
pub(in crate::figures) fn numbers() -> Picture {
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

/// The skew of every entry, for searches from the cosine and for both kinds of starts of recipes.
pub(in crate::figures) fn starts() -> Picture {
    let own = Start::ALL.iter().rev().map(|start| (start.name(), table(*start)));
    let tables: Vec<(&str, Vec<Fit>)> = std::iter::once(("from the cosine", table_from_cosine())).chain(own).collect();
    let skews: [Named; 2] = [("m13", true, |fit| fit.m13), ("m13 / m11", true, |fit| fit.m13 / fit.m11)];
    let mut panels = Vec::new();
    for (name, is_signed, of) in skews {
        // All panels use the scale of the last table.
        let scale = tables.last().map(|(_, fits)| Scale::of(&values(fits, of), is_signed));
        for (start, fits) in &tables {
            let values = values(fits, of);
            let scale = scale.unwrap_or_else(|| Scale::of(&values, is_signed));
            panels.push(Drawn::new(format!("{start}: {name}"), &values, &scale));
        }
    }
    let jumps = |of: fn(&Fit) -> f64| {
        let differences = tables.iter().map(|(start, fits)| format!("{start} {:.5}", second_difference(fits, of)));
        differences.collect::<Vec<_>>().join(", ")
    };
    let what = "skew by metric l3 from three starts: roughness to the right, view downwards, 64 x 64";
    let how = "mean second difference along the view";
    let [skew, relative] = skews.map(|(name, _, of)| format!("  of {name}: {}", jumps(of)));
    headed(&[&[what], &[how], &[&skew], &[&relative]], &together(&panels, 3))
}

const AXES: &str = "roughness sqrt(alpha) 0 to 1 to the right, sqrt(1 - cos theta) 0 to 1 downwards: 64 x 64";
const COLOURS: &str = "colours hold 98 % of the numbers, grey is zero of signed ones; cyan is below, green above";

fn values(fits: &[Fit], of: fn(&Fit) -> f64) -> Vec<f32> {
    fits.iter().map(|fit| of(fit) as f32).collect()
}

/// Mean absolute second difference of a number along the view axis.
fn second_difference(fits: &[Fit], of: fn(&Fit) -> f64) -> f64 {
    let row = |row: &[Fit]| row.windows(3).map(|s| (of(&s[0]) - 2.0 * of(&s[1]) + of(&s[2])).abs()).sum::<f64>();
    let side = SIDE as usize;
    fits.chunks(side).map(row).sum::<f64>() / (side * (side - 2)) as f64
}

/// A map with its title and its colour scale.
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
