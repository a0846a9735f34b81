//! Differences, strips and lobes: panels, labels and colour bars.

use super::{
    Mode, Picture, Scene,
    colours::colour,
    image::{BELOW, BESIDE, Radiances},
    text::{self, Anchor, LINE},
    tone,
};

/// What is behind labels.
const GROUND: [u8; 3] = [24, 24, 24];
/// What is beside a sphere of directions, and on it where nothing is below the horizon.
const BESIDE_COLOUR: [u8; 3] = [48, 48, 48];
const BELOW_COLOUR: [u8; 3] = [30, 34, 44];
/// Between panels.
const GAP: u32 = 4;
/// A colour bar's height and its distance from the panel's sides.
const BAR: u32 = 10;
const MARGIN: u32 = 8;
/// Under a panel: the bar, and a line for its ends.
const FOOT: u32 = BAR + LINE + 8;

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

/// The colours from zero to `scale` across `width` pixels, with both ends and the unit written under them.
fn bar(width: u32, scale: f32, unit: &str) -> Picture {
    let mut picture = Picture::filled(width, FOOT, GROUND);
    let length = width - 2 * MARGIN;
    for x in 0..length {
        let part = Picture::filled(1, BAR, colour((x as f32 + 0.5) / length as f32));
        picture.put(&part, MARGIN + x, 4);
    }
    let y = 4 + BAR + LINE / 2;
    let most = number(scale);
    text::write(&mut picture, "0", MARGIN, y, Anchor::Left, width);
    text::write(&mut picture, &most, width - MARGIN, y, Anchor::Right, width);
    // Where the unit does not fit between the ends, it is left to the reader.
    if !text::fitting(&[&format!("0 {most}{most} {unit}")], length).is_empty() {
        text::write(&mut picture, unit, width / 2, y, Anchor::Middle, width);
    }
    picture
}

/// Three digits, without zeros at the end.
fn number(x: f32) -> String {
    let digits = (2 - x.abs().max(1e-9).log10().floor() as i32).max(0) as usize;
    let text = format!("{x:.digits$}");
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}

/// Panels of equal width side by side, each with its label above and what belongs under it.
fn side_by_side(panels: &[(&str, &Picture, Option<Picture>)]) -> Picture {
    let (width, height) = panels.first().map_or((1, 1), |(_, panel, _)| (panel.width, panel.height));
    let count = panels.len() as u32;
    let top = LINE + 4;
    let mut whole = Picture::filled(count * (width + GAP) - GAP, top + height + FOOT, GROUND);
    for (i, (label, panel, foot)) in (0_u32..).zip(panels) {
        let left = i * (width + GAP);
        whole.put(panel, left, top);
        text::write(&mut whole, label, left + width / 2, top / 2, Anchor::Middle, width);
        if let Some(foot) = foot {
            whole.put(foot, left, top + height);
        }
    }
    whole
}

/// A line of text on the ground, as wide as a panel, in the first wording that fits.
fn caption(width: u32, wordings: &[&str]) -> Picture {
    let mut picture = Picture::filled(width, FOOT, GROUND);
    let line = text::fitting(wordings, width);
    text::write(&mut picture, line, width / 2, 4 + LINE / 2, Anchor::Middle, width);
    picture
}

/// The picture of mode `difference` or `strip`. `mean` is the mean absolute error.
pub(super) fn compared(scene: &Scene, ltc: &Radiances, reference: &Radiances, mean: f64) -> Picture {
    let exposure = scene.exposure as f32;
    let scale = scene.difference_scale as f32;
    let apart = differences(ltc, reference, scale);
    let foot = bar(apart.width, scale, "radiance");
    let width = apart.width;
    let difference = text::fitting(&["|LTC - reference|", "difference"], width);
    if scene.mode == Mode::Difference {
        return side_by_side(&[(difference, &apart, Some(foot))]);
    }
    let ltc = tone::displayed(exposure, ltc);
    let reference = tone::displayed(exposure, reference);
    let samples = caption(width, &[&format!("{} samples a pixel", scene.spp), &format!("{} spp", scene.spp)]);
    let mean = number(mean as f32);
    let mean = caption(width, &[&format!("mean error {mean}"), &mean]);
    side_by_side(&[
        (text::fitting(&["GGX reference", "reference"], width), &reference, Some(samples)),
        ("LTC", &ltc, Some(mean)),
        (difference, &apart, Some(foot)),
    ])
}

/// The picture of mode `lobe`: densities over directions, both on the scale of the reference.
pub(super) fn lobes(ltc: &Radiances, reference: &Radiances) -> Picture {
    let peak = reference.pixels.iter().map(|pixel| pixel[0]).fold(1e-9_f32, f32::max);
    let panel = |lobe: &Radiances| false_colours(lobe.width, lobe.pixels.iter().map(|pixel| pixel[0]), peak);
    let (ltc, reference) = (panel(ltc), panel(reference));
    let foot = || Some(bar(ltc.width, peak, "per steradian"));
    side_by_side(&[("GGX", &reference, foot()), ("LTC", &ltc, foot())])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_three_digits() {
        let cases =
            [(0.5, "0.5"), (0.012_345, "0.0123"), (12.0, "12"), (1234.0, "1234"), (0.0, "0"), (2.5e-5, "0.000025")];
        for (x, text) in cases {
            assert_eq!(number(x), text);
        }
    }

    #[test]
    fn the_bar_runs_from_zero_to_the_scale() {
        let bar = bar(256, 0.5, "radiance");
        let at = |x: u32| bar.rgb[(6 * bar.width + x) as usize];
        assert_eq!(at(MARGIN), colour(0.5 / 240.0));
        assert_eq!(at(255 - MARGIN), colour(239.5 / 240.0));
        assert!(bar.rgb[(14 * 256) as usize..].contains(&[255; 3]), "no text");
    }
}
