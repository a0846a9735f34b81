//! All numbers of a table. Each number of an entry has a panel. A panel has a tile for each ratio and phi, and a tile
//! has a cell for each alpha and theta.

use super::Scale;
use crate::picture::{GROUND, Panel, Picture, bar, caption, grid, headed, number};
use ltcforge_fit::{PerAxis, Table};

/// The width and height that cells are enlarged to fill, in pixels. A panel is smaller if its cells reach the largest
/// size.
const SIDE: usize = 240;
/// Largest side of a cell, in pixels.
const LARGEST_CELL: usize = 24;
/// Largest number of cells along a panel's side. If a table has more nodes, some are not shown.
const MOST_CELLS: usize = 512;
/// Pixels between tiles.
const GAP: usize = 2;
/// Panel titles, row by row. A row has three columns of the matrix, another number of an entry, and three columns of
/// the second lobe's matrix.
const NAMES: [[&str; 7]; 3] = [
    ["m00", "m01", "m02", "amplitude", "second 00", "second 01", "second 02"],
    ["m10", "m11", "m12", "fresnel", "second 10", "second 11", "second 12"],
    ["m20", "m21", "m22", "node error", "second 20", "second 21", "second 22"],
];
/// The number of columns for a table with one lobe.
const OF_ONE_LOBE: usize = 4;

/// Draws all panels. Each panel has its own colour scale.
pub(super) fn draw(table: &Table, name: &str) -> Picture {
    let tiling = Tiling::new(table.lengths());
    let width = tiling.width().max(SIDE) as u32;
    let columns = if table.second_matrices().is_some() { NAMES[0].len() } else { OF_ONE_LOBE };
    let places = (0..).zip(NAMES).flat_map(|(row, names)| {
        names.into_iter().take(columns).enumerate().map(move |(column, title)| ([row, column], title))
    });
    let panels: Vec<Panel<'_>> = places
        .map(|(place, title)| {
            if let Some(numbers) = numbers(table, place) {
                let scale = Scale::of(&numbers, is_off_diagonal(place));
                let picture = tiling.panel(width, &numbers, &scale);
                let [low, high] = scale.ends().map(number);
                return Panel { title, picture, foot: bar(width, scale.colours(), [&low, &high], &scale.middle()) };
            }
            let picture = Picture::filled(width, tiling.height() as u32, GROUND);
            Panel { title, picture, foot: caption(width, &["not in this table", "none"]) }
        })
        .collect();
    let PerAxis { alpha, ratio, theta, phi } = tiling.nodes;
    let entries = format!("{name}: {alpha} x {ratio} x {theta} x {phi} entries: alpha x ratio x theta x phi");
    let how = "in a tile theta to the right, alpha upwards; tiles: phi to the right, ratio upwards";
    let beyond = "98 % of the numbers are within the scale; cyan: below, green: above; grey: zero, if signed";
    headed(&[&[&entries], &[how], &[beyond], &[&tiling.left_out()]], &grid(&panels, columns as u32))
}

/// A number of each entry, in storage order. `None` if the table does not store this number.
fn numbers(table: &Table, [row, column]: [usize; 2]) -> Option<Vec<f32>> {
    let numbers_of = |matrices: &[[f32; 9]], column: usize| matrices.iter().map(|m| m[3 * row + column]).collect();
    match (column, row) {
        (0..=2, _) => Some(numbers_of(table.matrices(), column)),
        (OF_ONE_LOBE.., _) => table.second_matrices().map(|matrices| numbers_of(matrices, column - OF_ONE_LOBE)),
        (_, 0) => table.terms.as_ref().map(|terms| terms.amplitude.clone()),
        (_, 1) => table.terms.as_ref().map(|terms| terms.fresnel.clone()),
        // Tables from other programs have no node error.
        _ => Some(table.node_error.clone()).filter(|errors| errors.iter().all(|error| error.is_finite())),
    }
}

/// Whether a panel shows an off-diagonal number of a matrix. These numbers can have either sign.
fn is_off_diagonal([row, column]: [usize; 2]) -> bool {
    column != OF_ONE_LOBE - 1 && row != column % OF_ONE_LOBE
}

/// The layout of a panel: tiles and cells.
#[derive(Debug)]
struct Tiling {
    nodes: PerAxis<usize>,
    /// The step between shown nodes, on each axis.
    step: PerAxis<usize>,
    /// Side of a cell in pixels.
    cell: usize,
}

impl Tiling {
    fn new(nodes: PerAxis<usize>) -> Self {
        let (theta, phi) = steps(nodes.theta, nodes.phi);
        let (alpha, ratio) = steps(nodes.alpha, nodes.ratio);
        let mut tiling = Self { nodes, step: PerAxis { alpha, ratio, theta, phi }, cell: 1 };
        let cells = (tiling.across()[0] * tiling.across()[1]).max(tiling.down()[0] * tiling.down()[1]);
        tiling.cell = (SIDE / cells).clamp(1, LARGEST_CELL);
        tiling
    }

    /// Cells in a tile, and tiles in a panel, from left to right.
    fn across(&self) -> [usize; 2] {
        [self.nodes.theta.div_ceil(self.step.theta), self.nodes.phi.div_ceil(self.step.phi)]
    }

    /// Cells in a tile, and tiles in a panel, upwards.
    fn down(&self) -> [usize; 2] {
        [self.nodes.alpha.div_ceil(self.step.alpha), self.nodes.ratio.div_ceil(self.step.ratio)]
    }

    fn width(&self) -> usize {
        length(self.across(), self.cell)
    }

    fn height(&self) -> usize {
        length(self.down(), self.cell)
    }

    /// Draws a panel, `width` pixels wide.
    fn panel(&self, width: u32, numbers: &[f32], scale: &Scale) -> Picture {
        let mut picture = Picture::filled(width, self.height() as u32, GROUND);
        let (cell, step) = (self.cell as u32, &self.step);
        let margin = (width as usize - self.width()) / 2;
        for (index, value) in numbers.iter().enumerate() {
            let (rest, phi) = (index / self.nodes.phi, index % self.nodes.phi);
            let (rest, theta) = (rest / self.nodes.theta, rest % self.nodes.theta);
            let (alpha, ratio) = (rest / self.nodes.ratio, rest % self.nodes.ratio);
            if alpha % step.alpha + ratio % step.ratio + theta % step.theta + phi % step.phi > 0 {
                continue;
            }
            let left = place(theta / step.theta, phi / step.phi, self.across()[0], self.cell);
            let up = place(alpha / step.alpha, ratio / step.ratio, self.down()[0], self.cell);
            let entry = Picture::filled(cell, cell, scale.colour(*value));
            picture.put(&entry, (margin + left) as u32, (self.height() - up - self.cell) as u32);
        }
        picture
    }

    /// The nodes that the picture leaves out, as text.
    fn left_out(&self) -> String {
        let thinned = self.step.named().into_iter().filter(|(_, step)| **step > 1);
        let words: Vec<String> = thinned.map(|(axis, step)| format!("one node of {step} along {axis}")).collect();
        if words.is_empty() { String::new() } else { format!("only {}", words.join(", ")) }
    }
}

/// Width or height in pixels of `tiles` tiles with `cells` cells each.
fn length([cells, tiles]: [usize; 2], cell: usize) -> usize {
    tiles * (cells * cell + GAP) - GAP
}

/// The first pixel of a cell.
fn place(cell_index: usize, tile: usize, cells: usize, cell: usize) -> usize {
    tile * (cells * cell + GAP) + cell_index * cell
}

/// The steps between shown nodes on two axes. The shown nodes make at most [`MOST_CELLS`] cells.
fn steps(a: usize, b: usize) -> (usize, usize) {
    let (mut step_a, mut step_b) = (1, 1);
    while a.div_ceil(step_a) * b.div_ceil(step_b) > MOST_CELLS {
        if a.div_ceil(step_a) >= b.div_ceil(step_b) { step_a += 1 } else { step_b += 1 }
    }
    (step_a, step_b)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn large_tables_are_thinned_along_their_longer_axes() {
        assert_eq!(steps(10, 7), (1, 1));
        assert_eq!(steps(16, 32), (1, 1));
        assert_eq!(steps(16_384, 1), (32, 1));
        let (a, b) = steps(1000, 60);
        assert!(1000_usize.div_ceil(a) * 60_usize.div_ceil(b) <= MOST_CELLS, "{a} {b}");
        let tiling = Tiling::new(PerAxis { alpha: 16_384, ratio: 1, theta: 8, phi: 7 });
        assert_eq!(tiling.left_out(), "only one node of 32 along alpha");
        assert_eq!(tiling.height(), 512);
    }

    #[test]
    fn every_entry_has_its_own_cells() {
        let tiling = Tiling::new(PerAxis { alpha: 3, ratio: 2, theta: 4, phi: 5 });
        let numbers: Vec<f32> = (0..120_u8).map(f32::from).collect();
        let scale = Scale::of(&numbers, false);
        let picture = tiling.panel(tiling.width() as u32, &numbers, &scale);
        // The scale excludes the least and the greatest of 120 numbers.
        assert_eq!(scale.ends(), [1.0, 118.0]);
        let cells = tiling.cell * tiling.cell;
        let covered = picture.rgb.iter().filter(|pixel| **pixel != GROUND).count();
        assert_eq!(covered, 120 * cells);
        // Entry (0, 0, 0, 0) is at the lower left; the last is at the upper right.
        let (width, height) = (picture.width as usize, picture.height as usize);
        assert_eq!(picture.rgb[(height - 1) * width], scale.colour(0.0));
        assert_eq!(picture.rgb[width - 1], scale.colour(119.0));
        // (alpha 0, ratio 1, theta 2, phi 3) is in the upper row of tiles, in the fourth tile from the left.
        let value = numbers[(4 + 2) * 5 + 3];
        let (left, up) = (3 * (4 * tiling.cell + GAP) + 2 * tiling.cell, 3 * tiling.cell + GAP);
        assert_eq!(picture.rgb[(height - 1 - up) * width + left], scale.colour(value));
    }
}
