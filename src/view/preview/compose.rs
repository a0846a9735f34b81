//! Differences, strips and lobes.

use super::{
    Mode, Scene,
    radiances::{BELOW, BESIDE, Radiances},
    tone,
};
use crate::view::picture::{Panel, Picture, bar, caption, colour, fitting, grid, number};

/// What is beside a sphere of directions, and on it where nothing is below the horizon.
const BESIDE_COLOUR: [u8; 3] = [48, 48, 48];
const BELOW_COLOUR: [u8; 3] = [30, 34, 44];

/// Mean of the channels' absolute differences.
fn difference(a: [f32; 3], b: [f32; 3]) -> f32 {
    ((a[0] - b[0]).abs() + (a[1] - b[1]).abs() + (a[2] - b[2]).abs()) / 3.0
}

/// Linear values from zero to `scale` in false colours.
fn false_colours(width: u32, values: impl Iterator<Item = f32>, scale: f32) -> Picture {
    let rgb: Vec<[u8; 3]> = values
        .map(|value| match value {
            BESIDE => BESIDE_COLOUR,
            BELOW => BELOW_COLOUR,
            _ => colour(value / scale),
        })
        .collect();
    Picture { width, height: rgb.len() as u32 / width, rgb }
}

fn differences(ltc: &Radiances, reference: &Radiances, scale: f32) -> Picture {
    let values = ltc.pixels.iter().zip(&reference.pixels).map(|(a, b)| difference(*a, *b));
    false_colours(ltc.width, values, scale)
}

/// The picture of mode `difference` or `strip`. `mean` is the mean absolute error.
pub(super) fn compared(scene: &Scene, ltc: &Radiances, reference: &Radiances, mean: f64) -> Picture {
    let exposure = scene.exposure as f32;
    let scale = scene.difference_scale as f32;
    let apart = differences(ltc, reference, scale);
    let width = apart.width;
    let foot = bar(width, ["0", &number(scale)], "radiance");
    let difference = fitting(&["|LTC - reference|", "difference"], width);
    if scene.mode == Mode::Difference {
        return grid(&[Panel { title: difference, picture: apart, foot }], 1);
    }
    let ltc = tone::displayed(exposure, ltc);
    let reference = tone::displayed(exposure, reference);
    let samples = caption(width, &[&format!("{} samples a pixel", scene.spp), &format!("{} spp", scene.spp)]);
    let mean = number(mean as f32);
    let mean = caption(width, &[&format!("mean error {mean}"), &mean]);
    let panels = [
        Panel { title: fitting(&["GGX reference", "reference"], width), picture: reference, foot: samples },
        Panel { title: "LTC", picture: ltc, foot: mean },
        Panel { title: difference, picture: apart, foot },
    ];
    grid(&panels, 3)
}

/// The picture of mode `lobe`: densities over directions, both on the scale of the reference.
pub(super) fn lobes(ltc: &Radiances, reference: &Radiances) -> Picture {
    let peak = reference.pixels.iter().map(|pixel| pixel[0]).fold(1e-9_f32, f32::max);
    let panel = |lobe: &Radiances| false_colours(lobe.width, lobe.pixels.iter().map(|pixel| pixel[0]), peak);
    let (ltc, reference) = (panel(ltc), panel(reference));
    let panels = [("GGX", reference), ("LTC", ltc)].map(|(title, picture)| {
        let foot = bar(picture.width, ["0", &number(peak)], "per steradian");
        Panel { title, picture, foot }
    });
    grid(&panels, 2)
}
