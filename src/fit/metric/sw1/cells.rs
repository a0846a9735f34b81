//! The division of the bits of a position into a cell and a position inside the cell.

/// Mantissa bits for the cell within an octave: 16 cells. A core cell is 1/16 of the lobe's width.
pub(super) const CELL_BITS: u32 = 4;
/// Cells of an octave.
pub(super) const OCTAVE: usize = 1 << CELL_BITS;
/// Mantissa bits for the position inside a cell.
pub(super) const FRACTION_BITS: u32 = f32::MANTISSA_DIGITS - 1 - CELL_BITS;
/// The largest number of cells. It is a power of two, so a mask bounds indices.
pub(super) const CELLS: usize = 2048;
