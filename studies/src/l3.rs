//! The L3 distance between isotropic GGX lobes and tables as engines read them, for studies/isotropic.md.

use std::{fmt::Write as _, ops::ControlFlow, path::Path};

use glam::{DMat3, DVec3};
use ltcforge::{
    Configuration, Layout, LookedUp, Metric, Recipe, RecipeDocument as _, Shear, Solver, Start, Table,
    fit::{
        FittedEntry, Ltc, Plan,
        brdf::{Brdf, Ggx},
        fit_entries,
        math::{direction, from_half_bits, from_row_major, row_major},
    },
};
use rayon::prelude::*;

use crate::{
    clock,
    tables::{fitted, materials},
};

const MATERIALS: usize = 300;
/// Sample points per distribution, along each side of a square. The distributions are compared at these points.
const SIDE: u32 = 283;
/// Side of the textures that engines ship, in texels.
const TEXELS: usize = 64;
/// Size of a Direct3D 9 DDS header in bytes.
const HEADER: usize = 128;

/// The L3 norm of the difference between a GGX lobe and the LTC of `found` times its amplitude, divided by the norm of
/// the lobe. It is metric `l3` with the amplitude of the table.
///
/// Both distributions are sampled at the points of a square. By multiple importance sampling with the balance
/// heuristic, the sum of `|f - g|^3 / (p_f + p_g)` is the integral of the cube. Only the LTC samples directions below
/// the surface.
#[must_use]
pub fn distance(at: &Configuration, found: &LookedUp, side: u32) -> f64 {
    let ggx = Ggx { alpha_x: at.alpha_x, alpha_y: at.alpha_y };
    let wo = direction(at.theta, at.phi);
    let Some(ltc) = Ltc::new(from_row_major(&found.matrix)) else { return f64::INFINITY };
    let amplitude = found.amplitude.unwrap_or(1.0);
    let cubes = |wi: DVec3, is_drawn_by_ltc: bool| {
        let density = ltc.pdf(wi);
        let (f, p) = match wi.z > 0.0 {
            true => (ggx.eval_cos(wo, wi), ggx.pdf(wo, wi)),
            false if is_drawn_by_ltc => (0.0, 0.0),
            false => return [0.0; 2],
        };
        let per_density = 1.0 / (p + density).max(f64::MIN_POSITIVE);
        [(f - amplitude * density).abs(), f].map(|x| x * x * x * per_density)
    };
    let part = |i: u32| (f64::from(i) + 0.5) / f64::from(side);
    let points = (0..side).flat_map(|i| (0..side).map(move |j| [part(i), part(j)]));
    let samples = points.flat_map(|u| [cubes(ggx.sample(wo, u).wi, false), cubes(ltc.sample(u), true)]);
    let [difference, norm] = samples.fold([0.0; 2], |sum, cubes| [sum[0] + cubes[0], sum[1] + cubes[1]]);
    (difference / norm).cbrt()
}

/// The stored form of `M`: the matrix or its inverse, divided by one of its elements or by the length of its third
/// column.
#[derive(Debug, Clone, Copy)]
struct Form {
    is_inverse: bool,
    over: Option<fn(&DMat3) -> f64>,
}

impl Form {
    fn stored(self, matrix: &DMat3) -> DMat3 {
        let stored = if self.is_inverse { matrix.inverse() } else { *matrix };
        self.over.map_or(stored, |over| stored * (1.0 / over(&stored)))
    }

    fn restored(self, stored: &DMat3) -> DMat3 {
        if self.is_inverse { stored.inverse() } else { *stored }
    }
}

/// Matrices and amplitudes over perceptual roughness and `sqrt(1 - cos theta)`. Both coordinates are evenly spaced from
/// 0 to 1, with bilinear interpolation as in engines.
pub(crate) struct Sampled {
    side: usize,
    form: Form,
    nodes: Vec<(DMat3, f64)>,
}

impl Sampled {
    /// Reads the textures `LTC_1` and `LTC_2` of 2017: DDS files with 64 x 64 texels of four halves.
    ///
    /// # Errors
    /// A file cannot be read, or has another length.
    pub(crate) fn read([matrices, terms]: [&Path; 2]) -> Result<Self, Box<dyn std::error::Error>> {
        let texels = |path: &Path| -> Result<Vec<[f64; 4]>, Box<dyn std::error::Error>> {
            let bytes = std::fs::read(path)?;
            if !bytes.starts_with(b"DDS ") || bytes.len() != HEADER + 8 * TEXELS * TEXELS {
                return Err(format!("{}: not a DDS file of 64 x 64 texels of four halves", path.display()).into());
            }
            let half = |pair: &[u8]| f64::from(from_half_bits(u16::from_le_bytes([pair[0], pair[1]])));
            let texel = |bytes: &[u8]| [0, 2, 4, 6].map(|i| half(&bytes[i..i + 2]));
            Ok(bytes[HEADER..].chunks_exact(8).map(texel).collect())
        };
        let matrix = |[m00, m20, m02, m22]: [f64; 4]| {
            DMat3::from_cols(DVec3::new(m00, 0.0, m20), DVec3::Y, DVec3::new(m02, 0.0, m22))
        };
        let nodes = texels(matrices)?.into_iter().map(matrix).zip(texels(terms)?.into_iter().map(|terms| terms[0]));
        Ok(Self { side: TEXELS, form: Form { is_inverse: true, over: None }, nodes: nodes.collect() })
    }

    /// The fitted entries in a stored form, sorted by alpha and then by theta.
    fn of(entries: &[FittedEntry], side: usize, form: Form) -> Self {
        let node = |x: usize, y: usize| {
            let entry = &entries[x * side + y];
            (form.stored(&from_row_major(&entry.matrix)), entry.amplitude)
        };
        let nodes = (0..side).flat_map(|y| (0..side).map(move |x| (x, y))).map(|(x, y)| node(x, y)).collect();
        Self { side, form, nodes }
    }

    pub(crate) fn lookup(&self, at: &Configuration) -> LookedUp {
        let place = |u: f64| {
            let at = u.clamp(0.0, 1.0) * (self.side - 1) as f64;
            let low = (at as usize).min(self.side - 2);
            (low, at - low as f64)
        };
        let ((x, along), (y, up)) = (place(at.alpha_x.sqrt()), place((1.0 - at.theta.cos()).sqrt()));
        let (mut matrix, mut amplitude) = (DMat3::ZERO, 0.0);
        for (dx, dy, weight) in [
            (0, 0, (1.0 - along) * (1.0 - up)),
            (1, 0, along * (1.0 - up)),
            (0, 1, (1.0 - along) * up),
            (1, 1, along * up),
        ] {
            let (of_node, term) = self.nodes[(y + dy) * self.side + x + dx];
            matrix += of_node * weight;
            amplitude += term * weight;
        }
        LookedUp {
            matrix: row_major(&self.form.restored(&matrix)),
            second: None,
            amplitude: Some(amplitude),
            fresnel: None,
            edge: None,
        }
    }
}

/// The distance of a table at each material.
fn distances(lookup: impl Fn(&Configuration) -> LookedUp + Sync) -> Vec<f64> {
    materials(MATERIALS, true).par_iter().map(|at| distance(at, &lookup(at), SIDE)).collect()
}

fn mean(x: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = x.fold((0.0, 0), |(sum, count), x| (sum + x, count + 1));
    sum / f64::from(count)
}

/// The fits of the first table, as names and recipes.
///
/// # Errors
/// None, because all of them are recipes.
fn recipes() -> Result<[(&'static str, Recipe); 5], ltcforge::Error> {
    let with = |metric, solver| Recipe::builder().layout(Layout::Ltc2017).metric(metric).solver(solver).steps(60);
    let simplex = || with(Metric::L3, Solver::NelderMead).samples(512).directions(16);
    Ok([
        ("`l3`, `nelder_mead`", simplex().build()?),
        ("the same, `start` `independent`", simplex().start(Start::Independent).build()?),
        ("the same, `shear` `z`", simplex().shear(Shear::Z).build()?),
        ("`l3`, `bfgs`", with(Metric::L3, Solver::Bfgs).samples(512).directions(16).build()?),
        ("`sw1`, `bfgs`, 512 x 32", with(Metric::Sw1, Solver::Bfgs).samples(512).directions(32).build()?),
    ])
}

/// The tables, with or without the textures that engines ship.
///
/// # Errors
/// A file cannot be read.
pub fn tables(shipped: Option<[&Path; 2]>) -> Result<String, Box<dyn std::error::Error>> {
    let of_shipped = shipped.map(Sampled::read).transpose()?.map(|shipped| distances(|at| shipped.lookup(at)));
    let mut out = "\
| table | mean distance | over the shipped one's: mean | median, p95 of the cubes' ratios | seconds of a processor |
|---|---|---|---|---|
"
    .to_owned();
    let mut row = |name: &str, found: &[f64], seconds: Option<f64>| {
        let mean_found = mean(found.iter().copied());
        let ratio = of_shipped.as_ref().map_or("| ".to_owned(), |shipped| {
            let over = mean_found / mean(shipped.iter().copied());
            let mut cubes: Vec<f64> = found.iter().zip(shipped).map(|(a, b)| (a / b).powi(3)).collect();
            cubes.sort_by(f64::total_cmp);
            format!("{over:.3} | {:.3}, {:.2}", cubes[cubes.len() / 2], cubes[cubes.len() * 95 / 100])
        });
        let seconds = seconds.map_or(String::new(), |seconds| format!("{seconds:.1} "));
        // Writing to a String cannot fail.
        let _ = writeln!(out, "| {name} | {mean_found:.4} | {ratio} | {seconds}|");
    };
    if let Some(shipped) = &of_shipped {
        row("shipped with engines", shipped, None);
    }
    for (name, recipe) in recipes()? {
        let start = clock::Clock::of_process();
        let table = fitted(&recipe);
        let seconds = start.seconds();
        row(name, &distances(|at| table.lookup(at)), Some(seconds));
    }
    out += "\n| stored | 64 x 64 | 32 x 32 | 16 x 16 |\n|---|---|---|---|\n";
    let fits = [64, 32, 16].map(|side| Ok::<_, ltcforge::Error>((side, entries(side)?)));
    for (name, form) in FORMS {
        let _ = write!(out, "| {name} |");
        for fit in &fits {
            let (side, entries) = fit.as_ref().map_err(ToString::to_string)?;
            let sampled = Sampled::of(entries, *side as usize, form);
            let _ = write!(out, " {} |", with_digits(mean(distances(|at| sampled.lookup(at)).into_iter())));
        }
        out.push('\n');
    }
    Ok(out)
}

/// A number with three digits.
fn with_digits(x: f64) -> String {
    if x < 0.1 { format!("{x:.4}") } else { format!("{x:.3}") }
}

/// The possible stored forms of entries.
const FORMS: [(&str, Form); 7] = [
    ("`M = B m`", Form { is_inverse: false, over: None }),
    (
        "`M` over the length of its third column (`godot`)",
        Form { is_inverse: false, over: Some(|m| m.z_axis.length()) },
    ),
    ("`M` over its last element (`matrix33`)", Form { is_inverse: false, over: Some(|m| m.z_axis.z) }),
    ("`M^-1` (`inverse`)", Form { is_inverse: true, over: None }),
    ("`M^-1` over its first element (`ltc2016`)", Form { is_inverse: true, over: Some(|m| m.x_axis.x) }),
    ("`M^-1` over its middle element (`ltc2017`)", Form { is_inverse: true, over: Some(|m| m.y_axis.y) }),
    ("`M^-1` over its last element (`hdrp`)", Form { is_inverse: true, over: Some(|m| m.z_axis.z) }),
];

/// The entries of the first fit, with `side` nodes on each axis.
///
/// # Errors
/// None, because there are enough nodes.
fn entries(side: u32) -> Result<Vec<FittedEntry>, ltcforge::Error> {
    let builder = Recipe::builder().layout(Layout::Ltc2017).metric(Metric::L3).solver(Solver::NelderMead).steps(60);
    let builder = builder.samples(512).directions(16).resolution("alpha", side).resolution("theta", side);
    let plan = Plan::new(&builder.build()?);
    fit_entries(&plan, &|_| ControlFlow::Continue(())).ok_or(ltcforge::Error::Stopped)
}

/// The mean distance of a table over a few materials.
#[must_use]
pub fn mean_distance(table: &Table, places: usize, side: u32) -> f64 {
    mean(materials(places, true).iter().map(|at| distance(at, &table.lookup(at), side)))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// For a lobe that no LTC equals, the distance does not depend on the number of points.
    #[test]
    fn the_integral_converges() {
        let at = Configuration { alpha_x: 0.1, alpha_y: 0.1, theta: 0.3, phi: 0.0 };
        let found = crate::tables::best(&[at])[0].1;
        let [coarse, fine] = [60, 200].map(|side| distance(&at, &found, side));
        assert!((coarse / fine - 1.0).abs() < 0.01 && fine > 0.0, "{coarse} {fine}");
        let twice = LookedUp { amplitude: found.amplitude.map(|x| 2.0 * x), ..found };
        assert!(distance(&at, &twice, 60) > 5.0 * coarse);
    }
}
