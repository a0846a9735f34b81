//! The paper's alignment (equation 12) compared with ours.

use glam::{DMat3, DVec3};
use ltcforge::{
    fit::{
        Ltc, PerAxis,
        brdf::{Brdf, Ggx},
    },
    view::picture::{Panel, Picture, caption, grid, headed},
};

use super::{
    error::FigureError,
    fits::fitted,
    halfway::{Halfway, NEAREST, OURS, Pair},
    hemisphere::{hemisphere, peak},
};

/// Side of a lobe's picture in pixels.
const SIDE: u32 = 176;
/// The least alpha in the figure. Sharper lobes would be too thin to see.
const LEAST_ALPHA: f64 = 0.1;
/// The recipe for anisotropic lobes.
const ANISOTROPIC: &str = r#"{"layout": "kt2022", "resolution": {"alpha": 5, "ratio": 4, "theta": 6, "phi": 5},
    "fit": {"samples": 256, "directions": 16}}"#;
/// The recipe for isotropic lobes. Their matrices contain zeros.
const ISOTROPIC: &str = r#"{"layout": "ltc2017", "resolution": {"alpha": 16, "theta": 16},
    "fit": {"metric": "l3", "solver": "nelder_mead", "samples": 512, "directions": 16, "steps": 60}}"#;

/// Draws two pairs of neighbours in an anisotropic table: for each alignment, the pair for which it is worst compared
/// with the other. The text above them has the errors of all pairs, in this table and in an isotropic table.
pub(super) fn draw() -> Result<Picture, FigureError> {
    let tables = [Halfway::of(ANISOTROPIC)?, Halfway::of(ISOTROPIC)?];
    let mut titled = Vec::new();
    for (alignment, name) in [(NEAREST, "equation 12 furthest behind"), (OURS, "ours furthest behind")] {
        if let Some(pair) = tables[0].furthest_behind(alignment, LEAST_ALPHA) {
            titled.extend(row(pair, name)?);
        }
    }
    let panels: Vec<Panel<'_>> = titled
        .iter()
        .map(|(title, picture, foot)| Panel { title, picture: picture.clone(), foot: caption(SIDE, &[foot]) })
        .collect();
    let errors: Vec<String> = tables.iter().flat_map(error_lines).collect();
    let what = "Halfway between neighbours, aligned by us and by equation 12; colours by the root of the density";
    let unit = "error, off by: the sliced Wasserstein distance from GGX, on samples that the fit did not see";
    let lines: Vec<[&str; 1]> = [[what], [unit]].into_iter().chain(errors.iter().map(|line| [line.as_str()])).collect();
    let lines: Vec<&[&str]> = lines.iter().map(<[&str; 1]>::as_slice).collect();
    Ok(headed(&lines, &grid(&panels, 5)))
}

/// The errors of a table as text.
fn error_lines(table: &Halfway) -> [String; 3] {
    let PerAxis { alpha, ratio, theta, phi } = table.nodes;
    let (layout, different, pairs) = (table.layout, table.different, table.pairs.len());
    let both = |number: fn(&Halfway, usize) -> f64| [number(table, OURS), number(table, NEAREST)];
    let [ours, nearest] = both(Halfway::mean);
    let [times, nearest_times] = both(Halfway::most_times);
    let mirrored = [OURS, NEAREST].map(|alignment| table.mirrored(alignment));
    let [determinant, nearest_determinant] = both(Halfway::least_determinant);
    [
        format!(
            "layout {layout}, {alpha} x {ratio} x {theta} x {phi} nodes, {different} aligned differently; {pairs} pairs"
        ),
        format!(
            "  mean error: ours {ours:.5}, equation 12 {nearest:.5}; at most {times:.2}, {nearest_times:.2} times the other's"
        ),
        format!(
            "  mirrored pairs: {}, {}; least determinant of the others over a node's: {determinant:.2}, {nearest_determinant:.2}",
            mirrored[OURS], mirrored[NEAREST],
        ),
    ]
}

/// The panels for a pair: a node, the mean by our alignment, GGX halfway, the mean by equation 12, and the other node.
/// All panels use the scale of GGX.
fn row(pair: &Pair, title: &str) -> Result<[(String, Picture, String); 5], FigureError> {
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
    let off = |alignment: usize| format!("off by {:.4}", pair.errors[alignment]);
    let [first, second] = pair.nodes[OURS];
    Ok([
        (title.to_owned(), shown(first), "node".to_owned()),
        ("ours".to_owned(), shown(pair.mean(OURS)), off(OURS)),
        ("GGX halfway".to_owned(), hemisphere(SIDE, scale, wanted), at),
        ("equation 12".to_owned(), shown(pair.mean(NEAREST)), off(NEAREST)),
        (String::new(), shown(second), "node".to_owned()),
    ])
}
