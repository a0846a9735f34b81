//! How the bits of a position are shared between a cell and a place inside it.

/// Mantissa bits that number the cells of an octave: 16 cells, a core cell is 1/16 of the lobe's width.
pub(super) const CELL_BITS: u32 = 4;
/// Cells of an octave.
pub(super) const OCTAVE: usize = 1 << CELL_BITS;
/// Mantissa bits that are left for the position inside a cell.
pub(super) const FRACTION_BITS: u32 = f32::MANTISSA_DIGITS - 1 - CELL_BITS;
/// Most cells; a power of two, so that a mask keeps indices inside.
pub(super) const CELLS: usize = 2048;
