//! The paper's alignment, its equation 12, beside ours.

use glam::{DMat3, DVec3};

use super::{
    error::FigureError,
    fits::fitted,
    halfway::{Halfway, NEAREST, OURS, Pair},
    hemisphere::{hemisphere, peak},
};
use crate::{
    fit::{
        Ltc, PerAxis,
        brdf::{Brdf, Ggx},
    },
    view::picture::{Panel, Picture, caption, grid, headed},
};

/// Pixels a side of a lobe.
const SIDE: u32 = 176;
/// Anisotropic lobes.
const ANISOTROPIC: &str = r#"{"layout": "kt2022", "resolution": {"alpha": 5, "ratio": 4, "theta": 6, "phi": 5},
    "fit": {"samples": 256, "directions": 16}}"#;
/// Isotropic ones, whose matrices have zeros.
const ISOTROPIC: &str = r#"{"layout": "ltc2017", "resolution": {"alpha": 16, "theta": 16},
    "fit": {"metric": "l3", "solver": "nelder_mead", "samples": 512, "directions": 16, "steps": 60}}"#;

/// Draws, of the pairs of neighbours in an anisotropic table, those for which either alignment is furthest behind the
/// other; above them the errors of all pairs, of this table and of an isotropic one.
pub(super) fn draw() -> Result<Picture, FigureError> {
    let tables = [Halfway::of(ANISOTROPIC)?, Halfway::of(ISOTROPIC)?];
    let mut titled = Vec::new();
    for (alignment, name) in [(NEAREST, "equation 12 behind"), (OURS, "ours behind")] {
        if let Some((pair, ratio)) = tables[0].worst(alignment) {
            titled.extend(row(pair, format!("{name} {ratio:.2} times"))?);
        }
    }
    let panels: Vec<Panel<'_>> = titled
        .iter()
        .map(|(title, picture, foot)| Panel { title, picture: picture.clone(), foot: caption(SIDE, &[foot]) })
        .collect();
    let told: Vec<String> = tables.iter().flat_map(told).collect();
    let what = "Halfway between neighbours, aligned by us and by equation 12; colours by the root of the density";
    let lines: Vec<[&str; 1]> = std::iter::once([what]).chain(told.iter().map(|line| [line.as_str()])).collect();
    let lines: Vec<&[&str]> = lines.iter().map(<[&str; 1]>::as_slice).collect();
    Ok(headed(&lines, &grid(&panels, 5)))
}

/// The errors of a table in words.
fn told(table: &Halfway) -> [String; 2] {
    let PerAxis { alpha, ratio, theta, phi } = table.nodes;
    let times = |of: usize| table.worst(of).map_or(1.0, |(_, times)| times);
    [
        format!(
            "{alpha} x {ratio} x {theta} x {phi} nodes, {} pairs: mean off by {:.5} by ours, {:.5} by equation 12; {} nodes differ",
            table.pairs.len(),
            table.mean(OURS),
            table.mean(NEAREST),
            table.different,
        ),
        format!(
            "at most {:.2} times the other's by ours, {:.2} by equation 12; determinants down to {:.2} and {:.2} of a node's",
            times(OURS),
            times(NEAREST),
            table.least_determinant(OURS),
            table.least_determinant(NEAREST),
        ),
    ]
}

/// A node, the mean by ours, GGX halfway, the mean by equation 12, and the other node, to the scale of GGX.
fn row(pair: &Pair, title: String) -> Result<[(String, Picture, String); 5], FigureError> {
    let ([alpha_x, alpha_y], wo) = (pair.at.roughness(), pair.at.view());
    let ggx = Ggx { alpha_x, alpha_y };
    let amplitude = fitted(&ggx, wo)?.amplitude;
    let wanted = |wi: DVec3| ggx.eval_cos(wo, wi) / amplitude;
    let scale = peak(SIDE, wanted);
    let shown = |m: DMat3| {
        let ltc = Ltc::new(m);
        hemisphere(SIDE, scale, move |wi| ltc.as_ref().map_or(0.0, |ltc| ltc.pdf(wi)))
    };
    let PerAxis { theta, phi, .. } = pair.at;
    let at = format!("{alpha_x:.2} {alpha_y:.2}, theta {:.0}, phi {:.0}", theta.to_degrees(), phi.to_degrees());
    let off = |of: usize| format!("off by {:.4}", pair.errors[of]);
    let [first, second] = pair.nodes[OURS];
    Ok([
        (title, shown(first), "node".to_owned()),
        ("ours".to_owned(), shown(pair.mean(OURS)), off(OURS)),
        ("GGX halfway".to_owned(), hemisphere(SIDE, scale, wanted), at),
        ("equation 12".to_owned(), shown(pair.mean(NEAREST)), off(NEAREST)),
        (String::new(), shown(second), "node".to_owned()),
    ])
}
