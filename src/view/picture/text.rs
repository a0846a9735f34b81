//! Labels in a bitmap font.

use std::convert::Infallible;

use embedded_graphics::{
    Drawable as _, Pixel,
    draw_target::DrawTarget,
    geometry::{OriginDimensions, Point, Size},
    mono_font::{MonoFont, MonoTextStyle, ascii::FONT_6X10, ascii::FONT_9X15},
    pixelcolor::{Rgb888, RgbColor as _},
    text::{Alignment, Baseline, Text, TextStyleBuilder},
};

use super::Picture;

/// The background of labels.
pub const GROUND: [u8; 3] = [24, 24, 24];
/// Height of a line of text beside which nothing else stands.
pub const LINE: u32 = 18;
/// Panels narrower than this have the smaller font.
const NARROW: u32 = 200;

impl OriginDimensions for Picture {
    fn size(&self) -> Size {
        Size::new(self.width, self.height)
    }
}

impl DrawTarget for Picture {
    type Color = Rgb888;
    type Error = Infallible;

    fn draw_iter<I: IntoIterator<Item = Pixel<Rgb888>>>(&mut self, pixels: I) -> Result<(), Infallible> {
        for Pixel(at, colour) in pixels {
            let (Ok(x), Ok(y)) = (u32::try_from(at.x), u32::try_from(at.y)) else { continue };
            if x < self.width && y < self.height {
                self.rgb[(y * self.width + x) as usize] = [colour.r(), colour.g(), colour.b()];
            }
        }
        Ok(())
    }
}

/// The digits by which a picture names a table.
#[must_use]
pub fn short_digest(digest: &str) -> &str {
    digest.get(..8).unwrap_or(digest)
}

/// Where a text is placed relative to its point.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Anchor {
    /// It begins there.
    Left,
    /// Its middle is there.
    Middle,
    /// It ends there.
    Right,
}

/// The first of some wordings that a panel of `width` has room for, or else nothing.
#[must_use]
pub fn fitting<'a>(wordings: &[&'a str], width: u32) -> &'a str {
    let fits = |text: &&&str| text_width(text, width) <= width;
    wordings.iter().find(fits).copied().unwrap_or_default()
}

/// How wide a line of text is in a panel of `width`, pixels.
#[must_use]
pub fn text_width(text: &str, width: u32) -> u32 {
    text.len() as u32 * font(width).character_size.width
}

fn font(width: u32) -> &'static MonoFont<'static> {
    if width < NARROW { &FONT_6X10 } else { &FONT_9X15 }
}

/// Writes a line whose vertical middle is at `y`, for a panel of `width`.
pub fn write(picture: &mut Picture, text: &str, x: u32, y: u32, anchor: Anchor, width: u32) {
    let alignment = match anchor {
        Anchor::Left => Alignment::Left,
        Anchor::Middle => Alignment::Center,
        Anchor::Right => Alignment::Right,
    };
    let style = TextStyleBuilder::new().alignment(alignment).baseline(Baseline::Middle).build();
    let at = Point::new(i32::try_from(x).unwrap_or(i32::MAX), i32::try_from(y).unwrap_or(i32::MAX));
    let Ok(_) = Text::with_text_style(text, at, MonoTextStyle::new(font(width), Rgb888::WHITE), style).draw(picture);
}

/// Beside a tag and within it.
const TAG_MARGIN: u32 = 3;

fn tag_size(text: &str, width: u32) -> Size {
    let letter = font(width).character_size;
    Size::new(text.len() as u32 * letter.width + 2 * TAG_MARGIN, letter.height + TAG_MARGIN)
}

/// Whether a part of a picture, `width` wide, has room for a [`tag`].
#[must_use]
pub fn tag_fits(text: &str, width: u32) -> bool {
    tag_size(text, width).width + 2 * TAG_MARGIN <= width
}

/// Writes `text` on ground of its own into the lower left corner, `(left, bottom)`, of a part of a picture, `width`
/// wide. Nothing is written where there is no room.
pub fn tag(picture: &mut Picture, text: &str, [left, bottom]: [u32; 2], width: u32) {
    let size = tag_size(text, width);
    if !tag_fits(text, width) || bottom < size.height + TAG_MARGIN {
        return;
    }
    let (x, y) = (left + TAG_MARGIN, bottom - TAG_MARGIN - size.height);
    picture.put(&Picture::filled(size.width, size.height, GROUND), x, y);
    write(picture, text, x + TAG_MARGIN, y + size.height / 2, Anchor::Left, width);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_longest_wording_that_fits_is_taken() {
        let wordings = ["|LTC - reference|", "difference", "d"];
        assert_eq!(
            [512, 153, 64, 59, 5].map(|width| fitting(&wordings, width)),
            ["|LTC - reference|", "|LTC - reference|", "difference", "d", ""]
        );
    }

    #[test]
    fn a_tag_stays_within_its_part() {
        let blank = Picture::filled(512, 300, [90; 3]);
        let mut picture = blank.clone();
        tag(&mut picture, "alpha .05, .25: mean .003", [256, 300], 256);
        let changed = |picture: &Picture| -> Vec<usize> {
            (0..picture.rgb.len()).filter(|index| picture.rgb[*index] != blank.rgb[*index]).collect()
        };
        assert!(changed(&picture).iter().all(|index| index % 512 >= 256 && index / 512 > 270));
        assert!(!changed(&picture).is_empty());
        let mut picture = blank.clone();
        tag(&mut picture, "alpha .05, .25", [0, 300], 64);
        assert!(changed(&picture).is_empty(), "a label wider than its part");
    }
}
