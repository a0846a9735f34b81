//! The values and errors of a lookup table.

use crate::picture::{Panel, Picture, bar, colour, grid, headed};
use ltcforge_fit::albedo::{Lut, LutRecipe, MeasuredLut};

/// The side of a map in pixels.
const SIDE: u32 = 260;

/// Draws values and errors of each channel, with the view to the right and roughness upwards, evenly in the parameters
/// of the axes, in the middle of the other axes. Runs on the current rayon pool.
#[must_use]
pub fn draw_lut(recipe: &LutRecipe, lut: &Lut, name: &str) -> Picture {
    let measured = MeasuredLut::slice(recipe);
    let channels = recipe.channels();
    let titles: Vec<String> = channels.iter().map(|channel| format!("{channel}, error")).collect();
    let panels = (0..channels.len()).flat_map(|i| {
        let errors = measured.errors(&lut.texels, i);
        let worst = errors.iter().copied().fold(1e-12, f64::max);
        let end = format!("{worst:.5}");
        let values = square(&measured.values(i), 1.0);
        [
            Panel { title: channels[i], picture: values, foot: bar(SIDE, colour, ["0", "1"], &[""]) },
            Panel {
                title: &titles[i],
                picture: square(&errors, worst),
                foot: bar(SIDE, colour, ["0", &end], &["linear"]),
            },
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

/// The nearest place of a square slice at each pixel, smooth surfaces at the bottom. `most` has the last colour.
fn square(numbers: &[f64], most: f64) -> Picture {
    let count = numbers.len().isqrt();
    let mut picture = Picture::filled(SIDE, SIDE, [0; 3]);
    let place = |pixel: u32| pixel as usize * count / SIDE as usize;
    for (y, x) in (0..SIDE).flat_map(|y| (0..SIDE).map(move |x| (y, x))) {
        let number = numbers[place(SIDE - 1 - y) * count + place(x)];
        picture.put(&Picture::filled(1, 1, colour((number / most) as f32)), x, y);
    }
    picture
}
