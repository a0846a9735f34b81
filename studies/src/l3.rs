//! The L3 distance between isotropic lobes of GGX and tables as engines read them: the tables of docs/isotropic.md.

use std::{fmt::Write as _, path::Path};

use glam::{DMat3, DVec3};
use half::f16;
use ltcforge::{
    Configuration, Layout, LookedUp, Metric, Recipe, RecipeDocument as _, Shear, Solver, Start, Table,
    fit::{
        Ltc,
        brdf::{Brdf, Ggx},
        math::{direction, from_row_major, row_major},
    },
};
use rayon::prelude::*;

use crate::{
    clock,
    tables::{fitted, materials},
};

const MATERIALS: usize = 300;
/// Points of either distribution at which both are compared: a square of so many a side.
const SIDE: u32 = 283;
/// Texels a side of the textures that engines ship.
const TEXELS: usize = 64;
/// Bytes of a DDS header of Direct3D 9.
const HEADER: usize = 128;

/// The L3 norm of the difference between a lobe of GGX and the LTC of `found` times its amplitude, over the lobe's own norm:
/// metric `l3`, but for the amplitude, which is the table's.
///
/// Both are drawn at the points of a square; by multiple importance sampling with the balance heuristic the sum of
/// `|f - g|^3 / (p_f + p_g)` is the integral of the cube. Directions below the surface are the LTC's to find.
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
    let drawn = points.flat_map(|u| [cubes(ggx.sample(wo, u).wi, false), cubes(ltc.sample(u), true)]);
    let [apart, whole] = drawn.fold([0.0; 2], |sum, cubes| [sum[0] + cubes[0], sum[1] + cubes[1]]);
    (apart / whole).cbrt()
}

/// The textures `LTC_1` and `LTC_2` of 2017 as engines sample them.
pub struct Shipped {
    texels: [Vec<[f64; 4]>; 2],
}

impl Shipped {
    /// Reads both files: DDS with 64 x 64 texels of four halves.
    ///
    /// # Errors
    /// A file that cannot be read or has another length.
    pub fn read(matrices: &Path, terms: &Path) -> Result<Self, Box<dyn std::error::Error>> {
        let texels = |path: &Path| -> Result<Vec<[f64; 4]>, Box<dyn std::error::Error>> {
            let bytes = std::fs::read(path)?;
            if !bytes.starts_with(b"DDS ") || bytes.len() != HEADER + 8 * TEXELS * TEXELS {
                return Err(format!("{}: not a DDS file of 64 x 64 texels of four halves", path.display()).into());
            }
            let half = |pair: &[u8]| f64::from(f16::from_le_bytes([pair[0], pair[1]]));
            let texel = |bytes: &[u8]| [0, 2, 4, 6].map(|i| half(&bytes[i..i + 2]));
            Ok(bytes[HEADER..].chunks_exact(8).map(texel).collect())
        };
        Ok(Self { texels: [texels(matrices)?, texels(terms)?] })
    }

    /// Bilinear between the centres of texels, which are nodes.
    fn sampled(&self, texture: usize, x: f64, y: f64) -> [f64; 4] {
        let place = |u: f64| {
            let at = u.clamp(0.0, 1.0) * (TEXELS - 1) as f64;
            let low = (at as usize).min(TEXELS - 2);
            (low, at - low as f64)
        };
        let ((x, along), (y, up)) = (place(x), place(y));
        let texel = |dx: usize, dy: usize| self.texels[texture][(y + dy) * TEXELS + x + dx];
        let corners = [
            (0, 0, (1.0 - along) * (1.0 - up)),
            (1, 0, along * (1.0 - up)),
            (0, 1, (1.0 - along) * up),
            (1, 1, along * up),
        ];
        corners.iter().fold([0.0; 4], |sum, (dx, dy, weight)| {
            let texel = texel(*dx, *dy);
            std::array::from_fn(|i| sum[i] + weight * texel[i])
        })
    }

    fn lookup(&self, at: &Configuration) -> LookedUp {
        let (x, y) = (at.alpha_x.sqrt(), (1.0 - at.theta.cos()).sqrt());
        let [m00, m20, m02, m22] = self.sampled(0, x, y);
        let inverse = DMat3::from_cols(DVec3::new(m00, 0.0, m20), DVec3::Y, DVec3::new(m02, 0.0, m22));
        let [amplitude, fresnel, ..] = self.sampled(1, x, y);
        LookedUp { matrix: row_major(&inverse.inverse()), amplitude: Some(amplitude), fresnel: Some(fresnel) }
    }
}

/// Distances of a table at each material.
fn distances(lookup: impl Fn(&Configuration) -> LookedUp + Sync) -> Vec<f64> {
    materials(MATERIALS, true).par_iter().map(|at| distance(at, &lookup(at), SIDE)).collect()
}

fn mean(x: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = x.fold((0.0, 0), |(sum, count), x| (sum + x, count + 1));
    sum / f64::from(count)
}

/// The fits of the first table: what they are called, and their recipes.
///
/// # Errors
/// None, unless one is no recipe.
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

/// The tables, with the files that engines ship or without.
///
/// # Errors
/// Files that cannot be read.
pub fn tables(shipped: Option<(&Path, &Path)>) -> Result<String, Box<dyn std::error::Error>> {
    let shipped = shipped.map(|(matrices, terms)| Shipped::read(matrices, terms)).transpose()?;
    let of_shipped = shipped.as_ref().map(|shipped| distances(|at| shipped.lookup(at)));
    let mut out = "\
| table | mean distance | over the shipped one's: mean | median of the cubes' ratios | seconds of a processor |
|---|---|---|---|---|
"
    .to_owned();
    let mut row = |name: &str, found: &[f64], seconds: Option<f64>| {
        let mean_found = mean(found.iter().copied());
        let beside = of_shipped.as_ref().map_or("| ".to_owned(), |shipped| {
            let over = mean_found / mean(shipped.iter().copied());
            let mut cubes: Vec<f64> = found.iter().zip(shipped).map(|(a, b)| (a / b).powi(3)).collect();
            cubes.sort_by(f64::total_cmp);
            format!("{over:.3} | {:.3}", cubes[cubes.len() / 2])
        });
        let seconds = seconds.map_or(String::new(), |seconds| format!("{seconds:.1}"));
        // Writing to a String cannot fail.
        let _ = writeln!(out, "| {name} | {mean_found:.4} | {beside} | {seconds} |");
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
    Ok(out)
}

/// The mean distance of a table at a few materials.
#[must_use]
pub fn mean_distance(table: &Table, places: usize, side: u32) -> f64 {
    mean(materials(places, true).iter().map(|at| distance(at, &table.lookup(at), side)))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A view and a lobe that an LTC cannot be: the distance does not depend on how finely it is integrated.
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
