//! Labels in `DejaVu Sans`. The licence of the font is in font/LICENSE.

use std::sync::LazyLock;

use ab_glyph::{Font as _, FontRef, PxScaleFont, ScaleFont as _, point};

use super::Picture;

/// The background of labels.
pub const GROUND: [u8; 3] = [24, 24, 24];
/// Height of a line of text.
pub const LINE: u32 = 18;
/// Panels narrower than this have smaller letters.
const NARROW: u32 = 200;
/// Height of the letters in narrow and in other panels, in pixels, including descenders.
const HEIGHTS: [f32; 2] = [12.0, 16.0];

static FONT: LazyLock<FontRef<'static>> = LazyLock::new(|| {
    FontRef::try_from_slice(include_bytes!("font/dejavu_sans.ttf")).expect("the compiled-in font is valid")
});

/// The first digits of a table's digest, which name the table in pictures.
#[must_use]
pub fn short_digest(digest: &str) -> &str {
    digest.get(..8).unwrap_or(digest)
}

/// The part of a text that is at a given point.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Anchor {
    /// The text begins at the point.
    Left,
    /// The middle of the text is at the point.
    Middle,
    /// The text ends at the point.
    Right,
}

/// The first wording that fits in a panel of `width`, or an empty string.
#[must_use]
pub fn fitting<'a>(wordings: &[&'a str], width: u32) -> &'a str {
    let fits = |text: &&&str| text_width(text, width) <= width;
    wordings.iter().find(fits).copied().unwrap_or_default()
}

/// The width of a line of text in a panel of `width`, in pixels.
#[must_use]
pub fn text_width(text: &str, width: u32) -> u32 {
    let font = font(width);
    text.chars().map(|letter| font.h_advance(font.glyph_id(letter))).sum::<f32>().ceil() as u32
}

fn font(width: u32) -> PxScaleFont<&'static FontRef<'static>> {
    FONT.as_scaled(HEIGHTS[usize::from(width >= NARROW)])
}

/// Writes a line of white text, vertically centred at `y`, for a panel of `width`.
pub fn write(picture: &mut Picture, text: &str, x: u32, y: u32, anchor: Anchor, width: u32) {
    let font = font(width);
    let before = match anchor {
        Anchor::Left => 0,
        Anchor::Middle => text_width(text, width) / 2,
        Anchor::Right => text_width(text, width),
    };
    let mut pen = point(x as f32 - before as f32, (y as f32 + 0.5 * (font.ascent() + font.descent())).round());
    for letter in text.chars() {
        let glyph = font.glyph_id(letter).with_scale_and_position(font.scale(), pen);
        pen.x += font.h_advance(glyph.id);
        // A space has no outline.
        let Some(outline) = font.outline_glyph(glyph) else { continue };
        let corner = outline.px_bounds().min;
        outline.draw(|x, y, coverage| picture.blend_white(corner.x + x as f32, corner.y + y as f32, coverage));
    }
}

/// The margin around a tag and within it.
const TAG_MARGIN: u32 = 3;

/// Width and height of a tag.
fn tag_size(text: &str, width: u32) -> [u32; 2] {
    [text_width(text, width) + 2 * TAG_MARGIN, font(width).height().ceil() as u32 + TAG_MARGIN]
}

/// Whether a part of a picture has room for a [`tag`]. The part is `width` pixels wide.
#[must_use]
pub fn tag_fits(text: &str, width: u32) -> bool {
    tag_size(text, width)[0] + 2 * TAG_MARGIN <= width
}

/// Writes `text` with a background into the lower left corner of a part of a picture. The corner is `(left, bottom)`,
/// and the part is `width` pixels wide. Writes nothing if there is no room.
pub fn tag(picture: &mut Picture, text: &str, [left, bottom]: [u32; 2], width: u32) {
    let [across, high] = tag_size(text, width);
    if !tag_fits(text, width) || bottom < high + TAG_MARGIN {
        return;
    }
    let (x, y) = (left + TAG_MARGIN, bottom - TAG_MARGIN - high);
    picture.put(&Picture::filled(across, high, GROUND), x, y);
    write(picture, text, x + TAG_MARGIN, y + high / 2, Anchor::Left, width);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_longest_wording_that_fits_is_used() {
        let wordings = ["|LTC - reference|", "difference", "d"];
        assert_eq!(
            [512, 153, 64, 30, 5].map(|width| fitting(&wordings, width)),
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
