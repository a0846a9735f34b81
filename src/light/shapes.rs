//! Lights of other shapes, as the polygons of their outlines.

mod flat;
mod tube;

pub use flat::{ELLIPSE_VERTICES, disk, ellipse, line, rectangle};
pub use tube::{TubeEnds, tube};
