//! The mark of a point: its shape and colour tell the layout of a table, or the model of a closed form.

use std::fmt::Write as _;

use ltcforge_fit::Layout;
use ltcforge_light::LightModel;

/// Half a mark.
pub(super) const MARK: f64 = 4.0;

/// What lights a surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Kind {
    Table(Layout),
    ClosedForm(LightModel),
}

/// The mark of a table or a closed form; `classes` begin with a space.
pub(super) fn mark(out: &mut String, [x, y]: [f64; 2], kind: Kind, classes: &str) -> std::fmt::Result {
    let number = match kind {
        Kind::Table(layout) => layout as usize,
        Kind::ClosedForm(model) => {
            let class = if model == LightModel::Normals { "normals" } else { "gaussian" };
            return diamond(out, [x, y], class, classes);
        }
    };
    if number == 0 {
        return writeln!(out, r#"<circle class="layout0{classes}" cx="{x:.1}" cy="{y:.1}" r="{MARK}"/>"#);
    }
    let side = 2.0 * MARK - 1.0;
    let (left, top) = (x - 0.5 * side, y - 0.5 * side);
    writeln!(
        out,
        r#"<rect class="layout{number}{classes}" x="{left:.1}" y="{top:.1}" width="{side}" height="{side}"/>"#
    )
}

/// The mark of the size that ships of a table.
pub(super) fn shipped(out: &mut String, at: [f64; 2], layout: Layout, classes: &str) -> std::fmt::Result {
    diamond(out, at, &format!("layout{}", layout as usize), classes)
}

fn diamond(out: &mut String, [x, y]: [f64; 2], class: &str, classes: &str) -> std::fmt::Result {
    writeln!(out, r#"<path class="{class}{classes}" d="M{:.1} {y:.1}l4 -4l4 4l-4 4Z"/>"#, x - MARK)
}
