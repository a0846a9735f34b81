//! The mark of a point in a chart. Its shape and colour show the layout of a table or the model of a closed form.

use std::fmt::Write as _;

use ltcforge_fit::Layout;
use ltcforge_light::LightModel;

/// Half the side of a mark.
pub(super) const MARK: f64 = 4.0;

/// The method that lights a surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Kind {
    Table(Layout),
    ClosedForm(LightModel),
}

/// Writes the mark of a table or a closed form. `classes` must start with a space.
pub(super) fn mark(out: &mut String, [x, y]: [f64; 2], kind: Kind, classes: &str) -> std::fmt::Result {
    let class = class(kind);
    match kind {
        Kind::ClosedForm(_) => diamond(out, [x, y], kind, classes),
        Kind::Table(layout) if layout == Layout::ALL[0] => {
            writeln!(out, r#"<circle class="{class}{classes}" cx="{x:.1}" cy="{y:.1}" r="{MARK}"/>"#)
        }
        Kind::Table(_) => {
            let side = 2.0 * MARK - 1.0;
            let (left, top) = (x - 0.5 * side, y - 0.5 * side);
            writeln!(
                out,
                r#"<rect class="{class}{classes}" x="{left:.1}" y="{top:.1}" width="{side}" height="{side}"/>"#
            )
        }
    }
}

/// Writes a diamond: the mark of a closed form, and of a table's compact form.
pub(super) fn diamond(out: &mut String, [x, y]: [f64; 2], kind: Kind, classes: &str) -> std::fmt::Result {
    writeln!(out, r#"<path class="{}{classes}" d="M{:.1} {y:.1}l4 -4l4 4l-4 4Z"/>"#, class(kind), x - MARK)
}

fn class(kind: Kind) -> String {
    match kind {
        Kind::Table(layout) => format!("layout{}", layout as usize),
        Kind::ClosedForm(LightModel::Normals) => "normals".to_owned(),
        Kind::ClosedForm(LightModel::LtcFormula) => "formula".to_owned(),
        Kind::ClosedForm(_) => "gaussian".to_owned(),
    }
}
