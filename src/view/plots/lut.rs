//! The values and errors of a lookup table.

use crate::picture::{Panel, Picture, bar, colour, grid, headed};
use ltcforge_fit::albedo::{Lut, LutMap, LutRecipe, MeasuredLut};

/// The side of a map in pixels.
const SIDE: u32 = 260;

/// Draws values and errors of each channel, with the view to the right and roughness upwards, evenly in the parameters
/// of the axes, in the middle of the other axes. Runs on the current rayon pool.
#[must_use]
pub fn draw_lut(recipe: &LutRecipe, lut: &Lut, name: &str) -> Picture {
    let measured = MeasuredLut::slice(recipe);
    let maps = recipe.channels().iter().enumerate().map(|(i, channel)| (*channel, measured.map(lut, i)));
    let maps: Vec<(String, LutMap)> = maps.map(|(channel, map)| (format!("{channel}, error"), map)).collect();
    let panels = maps.iter().flat_map(|(title, map)| {
        let worst = map.errors.iter().fold(1e-12_f64, |worst, x| worst.max(*x));
        let values = square(map, &map.values, &|x| x as f32);
        let errors = square(map, &map.errors, &|x| (x / worst) as f32);
        let ends = format!("{worst:.5}");
        [
            Panel {
                title: title.trim_end_matches(", error"),
                picture: values,
                foot: bar(SIDE, colour, ["0", "1"], &[""]),
            },
            Panel { title, picture: errors, foot: bar(SIDE, colour, ["0", &ends], &["linear"]) },
        ]
    });
    let short = format!("table {} of {}", recipe.table, recipe.brdf);
    let at = format!("{name}: {short}");
    let axes = recipe.axis_names();
    let how = match axes.as_slice() {
        [roughness, view] => format!("x: {view}, y: {roughness}"),
        [_, roughness, view] => format!("x: {view}, y: {roughness}, at ior 1.5"),
        _ => "x: theta, y: alpha, in the middle of ratio and phi".to_owned(),
    };
    headed(&[&[&at, &short], &[&how]], &grid(&panels.collect::<Vec<_>>(), 2))
}

/// The nearest place at each pixel, smooth surfaces at the bottom.
fn square(map: &LutMap, numbers: &[f64], amount: &dyn Fn(f64) -> f32) -> Picture {
    let rows = numbers.len() / map.columns;
    let mut picture = Picture::filled(SIDE, SIDE, [0; 3]);
    let place = |pixel: u32, count: usize| (pixel as usize * count) / SIDE as usize;
    for (y, x) in (0..SIDE).flat_map(|y| (0..SIDE).map(move |x| (y, x))) {
        let number = numbers[place(SIDE - 1 - y, rows) * map.columns + place(x, map.columns)];
        picture.put(&Picture::filled(1, 1, colour(amount(number))), x, y);
    }
    picture
}
