//! The mark of a table: its shape and colour tell the layout.

use std::fmt::Write as _;

use ltcforge_fit::Layout;

/// Half a mark.
pub(super) const MARK: f64 = 4.0;

/// A mark of a table; `classes` begin with a space.
pub(super) fn mark(out: &mut String, [x, y]: [f64; 2], layout: Layout, classes: &str) -> std::fmt::Result {
    match Layout::ALL.iter().position(|known| *known == layout).unwrap_or(0) {
        0 => writeln!(out, r#"<circle class="layout0{classes}" cx="{x:.1}" cy="{y:.1}" r="{MARK}"/>"#),
        number => {
            let side = 2.0 * MARK - 1.0;
            let (left, top) = (x - 0.5 * side, y - 0.5 * side);
            writeln!(
                out,
                r#"<rect class="layout{number}{classes}" x="{left:.1}" y="{top:.1}" width="{side}" height="{side}"/>"#
            )
        }
    }
}
