//! `sample`: directions to area lights, drawn where a surface reflects them.

use std::path::PathBuf;

use clap::Args;
use serde_json::json;

use super::{CommandFailure, Context, CsvLines, Exit, LineFailure, Rows, light_case::CaseFormat};
use ltcforge_fit::math::Lattice;
use ltcforge_light::{AnyLight, LightShape, sample::LightSampler};

/// `sample`.
#[derive(Debug, Args)]
pub struct SampleArgs {
    /// CSV of surfaces, views and polygons, as for `light`; `-` for stdin
    #[arg(value_name = "LIGHTS")]
    pub lights: PathBuf,
    /// Directions to draw for each light
    #[arg(long, value_name = "N", default_value_t = 16, value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    pub count: u32,
    /// Sample the solid angle uniformly, for comparison
    #[arg(long)]
    pub solid_angle: bool,
}

/// The names of the columns.
const COLUMNS: [&str; 5] = ["light", "x", "y", "z", "pdf"];

/// Prints the directions of each line as soon as the line is read. A light that is not visible has none.
pub(super) fn run(args: &SampleArgs, context: &mut Context<'_>) -> Result<Exit, CommandFailure> {
    let lines = CsvLines::open(&args.lights, "lights")?;
    let mut rows = Rows::new(context, &COLUMNS.map(str::to_owned));
    let format = CaseFormat { shape: LightShape::Polygon, material: None };
    let mut number = 0;
    lines.each(
        |line| format.is_header(line),
        |line| {
            let Some(case) = format.parse(line).map_err(LineFailure::Line)? else { return Ok(()) };
            let AnyLight::Polygon(light) = &case.light else { return Ok(()) };
            let sampler = if args.solid_angle {
                LightSampler::solid_angle(light)
            } else {
                LightSampler::normals(&case.at, light)
            };
            let sampler = sampler.map_err(|error| LineFailure::Line(error.to_string()))?;
            number += 1;
            for drawn in Lattice::new(args.count as usize, [0.0; 2]).points().filter_map(|u| sampler.sample(u)) {
                let ([x, y, z], pdf) = (drawn.wi.to_array(), drawn.pdf);
                rows.print(
                    None,
                    || format!("{number},{x},{y},{z},{pdf}"),
                    || json!({ "light": number, "x": x, "y": y, "z": z, "pdf": pdf }),
                )?;
            }
            Ok(())
        },
    )?;
    rows.end()
}
