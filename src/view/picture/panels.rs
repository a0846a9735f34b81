//! Panels with titles and colour bars.

use super::{
    Picture,
    text::{self, Anchor, GROUND, LINE},
};

/// Pixels between panels.
const GAP: u32 = 4;
/// Height of a colour bar, and its distance from the panel's sides.
const BAR: u32 = 10;
const MARGIN: u32 = 8;
/// Height of a panel's foot: the bar, and a line of text for the labels of its ends.
const FOOT: u32 = BAR + LINE + 8;

/// A colour bar from 0 to 1, `width` pixels wide. The labels below it are both ends and, between them, the first of
/// `units` that fits.
#[must_use]
pub fn bar(width: u32, colour: fn(f32) -> [u8; 3], [low, high]: [&str; 2], units: &[&str]) -> Picture {
    let mut picture = Picture::filled(width, FOOT, GROUND);
    let length = width.saturating_sub(2 * MARGIN);
    for x in 0..length {
        let part = Picture::filled(1, BAR, colour((x as f32 + 0.5) / length as f32));
        picture.put(&part, MARGIN + x, 4);
    }
    let y = 4 + BAR + LINE / 2;
    text::write(&mut picture, low, MARGIN, y, Anchor::Left, width);
    text::write(&mut picture, high, width - MARGIN, y, Anchor::Right, width);
    // A unit is left out if it does not fit between the ends.
    let widest = if low.len() > high.len() { low } else { high };
    let fits = |unit: &&&str| !text::fitting(&[&format!("-- {widest} {unit} {widest}")], width).is_empty();
    if let Some(unit) = units.iter().find(fits) {
        text::write(&mut picture, unit, width / 2, y, Anchor::Middle, width);
    }
    picture
}

/// A number with three digits, without trailing zeros. Very small numbers have an exponent.
#[must_use]
pub fn number(x: f32) -> String {
    if x != 0.0 && x.abs() < 1e-4 {
        return format!("{x:.1e}");
    }
    let digits = (2 - libm::log10f(x.abs().max(1e-9)).floor() as i32).max(0) as usize;
    let text = format!("{x:.digits$}");
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}

/// A line of text on the background, `width` pixels wide. The text is the first of `wordings` that fits.
#[must_use]
pub fn caption(width: u32, wordings: &[&str]) -> Picture {
    let mut picture = Picture::filled(width, FOOT, GROUND);
    let line = text::fitting(wordings, width);
    text::write(&mut picture, line, width / 2, 4 + LINE / 2, Anchor::Middle, width);
    picture
}

/// A picture with a title above and a strip below.
#[derive(Debug)]
pub struct Panel<'a> {
    /// The title.
    pub title: &'a str,
    /// The picture.
    pub picture: Picture,
    /// The strip below, as wide as the picture.
    pub foot: Picture,
}

/// Panels of equal size, row by row.
#[must_use]
pub fn grid(panels: &[Panel<'_>], columns: u32) -> Picture {
    let (width, height) = panels.first().map_or((1, 1), |panel| (panel.picture.width, panel.picture.height));
    let rows = (panels.len() as u32).div_ceil(columns);
    let top = LINE + 4;
    let (across, down) = (width + GAP, top + height + FOOT);
    let mut canvas = Picture::filled(columns * across - GAP, rows * down, GROUND);
    for (i, panel) in (0_u32..).zip(panels) {
        let (left, above) = (i % columns * across, i / columns * down);
        canvas.put(&panel.picture, left, above + top);
        text::write(&mut canvas, panel.title, left + width / 2, above + top / 2, Anchor::Middle, width);
        canvas.put(&panel.foot, left, above + top + height);
    }
    canvas
}

/// Pictures next to each other, aligned at the top.
#[must_use]
pub fn beside(pictures: &[Picture]) -> Picture {
    let width = pictures.iter().map(|picture| picture.width + GAP).sum::<u32>().saturating_sub(GAP);
    let height = pictures.iter().map(|picture| picture.height).max().unwrap_or_default();
    let mut canvas = Picture::filled(width.max(1), height.max(1), GROUND);
    let mut left = 0;
    for picture in pictures {
        canvas.put(picture, left, 0);
        left += picture.width + GAP;
    }
    canvas
}

/// A picture with lines of text above it. Each line is the first of its wordings that fits.
#[must_use]
pub fn headed(lines: &[&[&str]], picture: &Picture) -> Picture {
    let width = picture.width;
    let top = lines.len() as u32 * LINE + 4;
    let mut canvas = Picture::filled(width, top + picture.height, GROUND);
    for (i, wordings) in (0_u32..).zip(lines) {
        let y = 2 + i * LINE + LINE / 2;
        text::write(&mut canvas, text::fitting(wordings, width), MARGIN, y, Anchor::Left, width);
    }
    canvas.put(picture, 0, top);
    canvas
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::picture::colour;

    #[test]
    fn numbers_have_three_digits() {
        let cases =
            [(0.5, "0.5"), (0.012_345, "0.0123"), (12.0, "12"), (1234.0, "1234"), (0.0, "0"), (-2.5e-5, "-2.5e-5")];
        for (x, text) in cases {
            assert_eq!(number(x), text);
        }
    }

    #[test]
    fn the_bar_runs_from_zero_to_the_scale() {
        let bar = bar(256, colour, ["0", "0.5"], &["radiance"]);
        let at = |x: u32| bar.rgb[(6 * bar.width + x) as usize];
        assert_eq!(at(MARGIN), colour(0.5 / 240.0));
        assert_eq!(at(255 - MARGIN), colour(239.5 / 240.0));
        assert!(bar.rgb[(14 * 256) as usize..].contains(&[255; 3]), "no text");
    }
}
