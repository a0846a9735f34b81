//! Labels in a bitmap font.

use std::convert::Infallible;

use embedded_graphics::{
    Drawable as _, Pixel,
    draw_target::DrawTarget,
    geometry::{OriginDimensions, Point, Size},
    mono_font::{MonoTextStyle, ascii::FONT_6X10, ascii::FONT_9X15},
    pixelcolor::{Rgb888, RgbColor as _},
    text::{Alignment, Baseline, Text, TextStyleBuilder},
};

use super::Picture;

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

/// Where a text stands from its point.
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
    let letter = if width < NARROW { FONT_6X10 } else { FONT_9X15 }.character_size.width;
    wordings.iter().find(|text| text.len() as u32 * letter <= width).copied().unwrap_or_default()
}

/// Writes a line whose vertical middle is at `y`, for a panel of `width`.
pub fn write(picture: &mut Picture, text: &str, x: u32, y: u32, anchor: Anchor, width: u32) {
    let font = if width < NARROW { &FONT_6X10 } else { &FONT_9X15 };
    let alignment = match anchor {
        Anchor::Left => Alignment::Left,
        Anchor::Middle => Alignment::Center,
        Anchor::Right => Alignment::Right,
    };
    let style = TextStyleBuilder::new().alignment(alignment).baseline(Baseline::Middle).build();
    let at = Point::new(i32::try_from(x).unwrap_or(i32::MAX), i32::try_from(y).unwrap_or(i32::MAX));
    let Ok(_) = Text::with_text_style(text, at, MonoTextStyle::new(font, Rgb888::WHITE), style).draw(picture);
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
}
