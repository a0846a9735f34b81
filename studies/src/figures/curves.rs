//! Curves in a frame with two axes, or as polar graphs of a half plane.

use ltcforge::view::picture::{Anchor, GROUND, LINE, Picture, number, text_width, write};

/// Side of the area within the axes in pixels.
const SIDE: u32 = 288;
/// Space for the numbers at the left and at the bottom, and for half of the last number.
const LEFT: u32 = 56;
const BELOW: u32 = LINE + 8;
const RIGHT: u32 = 16;
/// Half the width of a curve, in pixels.
const HALF_WIDTH: f64 = 1.0;
const AXIS: [u8; 3] = [120, 120, 120];
const GRID: [u8; 3] = [58, 58, 62];

/// A curve, in the units of its frame.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Curve {
    pub(super) points: Vec<[f64; 2]>,
    pub(super) colour: [u8; 3],
}

/// The axes: their ranges and ticks, for x and y.
#[derive(Debug, Clone, Copy)]
pub(super) struct Frame<'a> {
    pub(super) x: [f64; 2],
    pub(super) y: [f64; 2],
    pub(super) x_ticks: &'a [f64],
    pub(super) y_ticks: &'a [f64],
}

impl Frame<'_> {
    /// Draws the curves with their axes. Curves are clipped at the axes.
    pub(super) fn draw(&self, curves: &[Curve]) -> Picture {
        let mut picture = Picture::filled(LEFT + SIDE + RIGHT, SIDE + BELOW + LINE / 2, GROUND);
        let (width, top) = (picture.width, LINE / 2);
        for tick in self.x_ticks {
            let x = LEFT + (self.at([*tick, self.y[0]])[0].round() as u32).min(SIDE - 1);
            picture.put(&Picture::filled(1, SIDE, GRID), x, top);
            write(&mut picture, &number(*tick as f32), x, top + SIDE + BELOW / 2, Anchor::Middle, width);
        }
        for tick in self.y_ticks {
            let y = top + (self.at([self.x[0], *tick])[1].round() as u32).min(SIDE - 1);
            picture.put(&Picture::filled(SIDE, 1, GRID), LEFT, y);
            write(&mut picture, &number(*tick as f32), LEFT - 6, y, Anchor::Right, width);
        }
        picture.put(&Picture::filled(1, SIDE, AXIS), LEFT, top);
        picture.put(&Picture::filled(SIDE, 1, AXIS), LEFT, top + SIDE - 1);
        for curve in curves {
            self.stroke(&mut picture, curve, [LEFT, top]);
        }
        picture
    }

    /// The position of a point relative to the upper left corner of the axes, in pixels.
    fn at(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let part = |value: f64, [low, high]: [f64; 2]| (value - low) / (high - low);
        [part(x, self.x) * f64::from(SIDE), (1.0 - part(y, self.y)) * f64::from(SIDE)]
    }

    /// Draws a curve within the axes, whose upper left corner is at `left` and `top`.
    fn stroke(&self, picture: &mut Picture, curve: &Curve, [left, top]: [u32; 2]) {
        let places: Vec<[f64; 2]> = curve.points.iter().map(|point| self.at(*point)).collect();
        let side = SIDE as usize;
        let mut distance = vec![f64::INFINITY; side * side];
        for ends in places.windows(2) {
            let range = |axis: usize| {
                let (a, b) = (ends[0][axis], ends[1][axis]);
                let pixel = |x: f64| x.clamp(0.0, f64::from(SIDE)) as usize;
                pixel(a.min(b) - 2.0)..pixel(a.max(b) + 3.0)
            };
            for y in range(1) {
                for x in range(0) {
                    let near = &mut distance[y * side + x];
                    *near = near.min(to_segment([x as f64 + 0.5, y as f64 + 0.5], ends[0], ends[1]));
                }
            }
        }
        for (index, distance) in distance.into_iter().enumerate() {
            let cover = (HALF_WIDTH + 0.5 - distance).clamp(0.0, 1.0);
            if cover > 0.0 {
                let (x, y) = (left as usize + index % side, top as usize + index / side);
                let pixel = &mut picture.rgb[y * picture.width as usize + x];
                *pixel = [0, 1, 2]
                    .map(|k| (f64::from(pixel[k]) * (1.0 - cover) + f64::from(curve.colour[k]) * cover).round() as u8);
            }
        }
    }
}

/// The distance from a point to the line segment between two other points.
fn to_segment(p: [f64; 2], a: [f64; 2], b: [f64; 2]) -> f64 {
    let (along, from) = ([b[0] - a[0], b[1] - a[1]], [p[0] - a[0], p[1] - a[1]]);
    let length2 = along[0] * along[0] + along[1] * along[1];
    let t = if length2 > 0.0 { (from[0] * along[0] + from[1] * along[1]) / length2 } else { 0.0 };
    let t = t.clamp(0.0, 1.0);
    let (x, y) = (from[0] - t * along[0], from[1] - t * along[1]);
    (x * x + y * y).sqrt()
}

/// The length of the line next to a name, and the gaps before and after it.
const DASH: u32 = 12;
const GAP: u32 = 4;

/// The names of the curves in their colours. They are as wide as a frame, with equal gaps.
pub(super) fn legend(width: u32, names: &[(&str, [u8; 3])]) -> Picture {
    let mut picture = Picture::filled(width, LINE + 4, GROUND);
    let own = |name: &str| GAP + DASH + GAP + text_width(name, width);
    let all: u32 = names.iter().map(|(name, _)| own(name)).sum();
    let between = width.saturating_sub(all) / names.len().max(1) as u32;
    let mut x = 0;
    for (name, colour) in names {
        picture.put(&Picture::filled(DASH, 3, *colour), x + GAP, LINE / 2 + 1);
        write(&mut picture, name, x + GAP + DASH + GAP, LINE / 2 + 2, Anchor::Left, width);
        x += own(name) + between;
    }
    picture
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_curve_follows_its_numbers_and_is_clipped_at_the_axes() {
        let frame = Frame { x: [0.0, 2.0], y: [0.0, 4.0], x_ticks: &[0.0, 2.0], y_ticks: &[4.0] };
        let colour = [250, 100, 30];
        let points = vec![[0.0, 1.0], [1.0, 1.0], [2.0, 9.0]];
        let drawn = frame.draw(&[Curve { points, colour }]);
        let at = |x: u32, y: u32| drawn.rgb[((LINE / 2 + y) * drawn.width + LEFT + x) as usize];
        // The curve is at a quarter of the height for half of the width. Then it rises steeply and leaves the frame.
        assert_eq!([at(20, SIDE * 3 / 4), at(SIDE / 2 - 9, SIDE * 3 / 4 - 1)], [colour; 2]);
        assert!(at(20, SIDE / 2) != colour && at(SIDE - 20, SIDE * 3 / 4) != colour);
        let above = drawn.rgb[..(LINE / 2 * drawn.width) as usize].iter();
        assert_eq!(above.filter(|pixel| **pixel == colour).count(), 0);
        assert!(drawn.rgb.iter().filter(|pixel| **pixel == colour).count() > 300);
    }

    /// There must be background after the last name. A cut-off name would reach the last column of the picture.
    #[test]
    fn names_of_curves_have_room() {
        let names: [(&str, [u8; 3]); 4] =
            [("GGX", [235, 235, 235]), ("sg", [240, 160, 60]), ("asg", [90, 190, 250]), ("normal", [190, 110, 230])];
        let width = LEFT + SIDE + RIGHT;
        let drawn = legend(width, &names);
        let column = |x: u32| (0..drawn.height).map(move |y| (y * width + x) as usize);
        let is_ground = |x: u32| column(x).all(|at| drawn.rgb[at] == GROUND);
        assert!((width - 3..width).all(is_ground), "a name is cut");
        let last = (0..width).rev().find(|x| !is_ground(*x)).expect("names");
        let dash = |colour: [u8; 3]| (0..width).find(|x| column(*x).any(|at| drawn.rgb[at] == colour));
        let begins = dash(names[3].1).expect("the last name's dash") + DASH + GAP;
        // The last letter is complete.
        assert!(last - begins >= text_width("norma", width), "{begins} {last}");
    }
}
