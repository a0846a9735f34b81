//! Marks on a picture: light with a dark rim, to be visible on any colour.

use super::Picture;

const LIGHT: [u8; 3] = [255; 3];
const DARK: [u8; 3] = [0; 3];
/// Half the width of a line, and of its dark rim, in pixels.
const LINE: f32 = 1.0;
const RIM: f32 = 2.0;

/// A ring of `radius` pixels around a point.
pub fn ring(picture: &mut Picture, at: [f32; 2], radius: f32) {
    mark(picture, at, radius, |x, y| ((x * x + y * y).sqrt() - radius).abs());
}

/// An upright cross with arms of `radius` pixels.
pub fn cross(picture: &mut Picture, at: [f32; 2], radius: f32) {
    let arm = |along: f32, across: f32| across.abs().max(along.abs() - radius);
    mark(picture, at, radius, |x, y| arm(x, y).min(arm(y, x)));
}

/// Draws the pixels near the mark's line. `distance` returns the distance from this line to a point. The point is
/// relative to the mark's centre.
fn mark(picture: &mut Picture, [x, y]: [f32; 2], radius: f32, distance: impl Fn(f32, f32) -> f32) {
    let reach = radius + RIM + 1.0;
    let pixels = |middle: f32, end: u32| {
        let [low, high] = [middle - reach, middle + reach].map(|edge| edge.clamp(0.0, end as f32) as u32);
        low..high
    };
    for row in pixels(y, picture.height) {
        for column in pixels(x, picture.width) {
            let far = distance(column as f32 + 0.5 - x, row as f32 + 0.5 - y);
            if far <= RIM {
                picture.rgb[(row * picture.width + column) as usize] = if far <= LINE { LIGHT } else { DARK };
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ring_leaves_its_middle_and_a_cross_covers_it() {
        let blank = Picture::filled(21, 21, [9; 3]);
        let at = |picture: &Picture, x: u32, y: u32| picture.rgb[(y * 21 + x) as usize];
        let mut picture = blank.clone();
        ring(&mut picture, [10.5, 10.5], 6.0);
        assert_eq!([at(&picture, 10, 10), at(&picture, 16, 10), at(&picture, 18, 10)], [[9; 3], LIGHT, DARK]);
        let mut picture = blank.clone();
        cross(&mut picture, [10.5, 10.5], 6.0);
        assert_eq!([at(&picture, 10, 10), at(&picture, 10, 15), at(&picture, 13, 13)], [LIGHT, LIGHT, [9; 3]]);
        // A mark is clipped at the edge of the picture.
        let mut picture = blank.clone();
        ring(&mut picture, [0.0, 40.0], 6.0);
        assert_eq!(picture, blank);
    }
}
