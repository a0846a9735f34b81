//! Times shaders on the GPU of this machine. It runs the programs of [`gpu_costs`](crate::gpu_costs).
//!
//! Each pixel is a point on a floor that a camera sees. It computes the light of sixteen rectangles one after another.
//! Each rectangle lights a different point with a different roughness, so no work is shared, and the pixel's memory
//! traffic counts little. The time includes the tangent frame and the transform of the corners, as in an engine.

mod gpu;
mod textures;

use std::{
    collections::{HashMap, hash_map::Entry},
    fmt::Write as _,
};

use ltcforge::{Error, Layout, Recipe, RecipeDocument as _, SecondLobe, Table, shaders::GpuCost};

use crate::{gpu_costs::programs, tables::fitted};
use gpu::Gpu;
pub use gpu::{Effort, TimesError};

/// The method of engines. All other shaders are compared with it.
const STOCK: &str = "ltc2017, clipless";

/// Markdown with a row for each shader: milliseconds per light for the picture, their ratio to [`STOCK`], and the same
/// ratio of the inverse throughputs of `gpu-costs`.
///
/// # Errors
/// [`TimesError`]
pub fn text(effort: &Effort) -> Result<String, TimesError> {
    let gpu = Gpu::open(effort)?;
    let mut tables = HashMap::new();
    let mut rows = Vec::new();
    for program in programs() {
        let table = match program.table {
            None => None,
            Some(wanted) => Some(match tables.entry(wanted) {
                Entry::Occupied(known) => known.into_mut(),
                Entry::Vacant(new) => new.insert(table(wanted)?),
            }),
        };
        let time = gpu.milliseconds(&program, table.as_deref(), effort)?;
        rows.push((program.name, time));
    }
    let stock = rows.iter().find(|(name, _)| name == STOCK).map_or(f64::NAN, |(_, time)| *time);
    let counted = |name: &str| GpuCost::of(name).map_or(f64::NAN, |cost| f64::from(cost.inverse_throughput));
    let [width, height] = effort.picture;
    let mut out = format!(
        "{}, {width} x {height} pixels, one light\n\n| shader | ms | of engines' | counted |\n|---|---|---|---|\n",
        gpu.name
    );
    for (name, time) in rows {
        let counted = counted(&name) / counted(STOCK);
        // Writing to a String cannot fail.
        let _ = writeln!(out, "| {name} | {time:.3} | {:.2} | {counted:.2} |", time / stock);
    }
    Ok(out)
}

/// A table with the default axes and a poor fit. The quality of the fit does not change the time.
fn table((layout, has_two): (Layout, bool)) -> Result<Table, Error> {
    let builder = match layout {
        Layout::Materials => {
            Recipe::builder().surfaces(&[0.05, 0.1, 0.2, 0.3, 0.5, 0.7, 0.9, 1.0].map(|alpha| [alpha, 0.5]))
        }
        _ => Recipe::builder().layout(layout),
    };
    let builder = builder.samples(64).directions(8).steps(4);
    let builder = if has_two { builder.two_lobes(SecondLobe::Blended) } else { builder };
    Ok(fitted(&builder.build()?))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_shader_is_timed() {
        let times = match text(&Effort { picture: [64, 64], runs: 1, least: 0.0 }) {
            Err(TimesError::Gpu(reason)) => return println!("skipped: no GPU and no software renderer: {reason}"),
            times => times.expect("every shader lights the floor"),
        };
        for program in programs() {
            let row = times.lines().find(|line| line.starts_with(&format!("| {} |", program.name)));
            let numbers: Vec<f64> =
                row.expect("a row").split('|').filter_map(|cell| cell.trim().parse().ok()).collect();
            assert!(numbers.len() == 3 && numbers.iter().all(|x| *x > 0.0), "{row:?}");
        }
    }
}
