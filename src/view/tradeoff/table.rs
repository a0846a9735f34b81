//! The trade-off as CSV and JSON.

use std::fmt::Write as _;

use serde_json::json;

use super::{FittedRecipe, ModelRows, POINTS};
use ltcforge_fit::PerAxis;

const HEADER: &str = "recipe_digest,preset,layout,alpha,ratio,theta,phi,samples,directions,steps,precision,entries,bytes,compact_bytes,seconds,\
                      wall_seconds,error_mean,error_p95,sw1_mean,sw1_p95,light_mean,light_p95,predicted_seconds,\
                      predicted_error,on_front_seconds,on_front_bytes,on_front_base";

/// A header and a line per row; no field needs quotes.
#[must_use]
pub fn csv(rows: &[FittedRecipe]) -> String {
    let mut out = format!("{HEADER}\n");
    for row in rows {
        // Writing to a String cannot fail.
        let _ = write_line(&mut out, row);
    }
    out
}

fn write_line(out: &mut String, row: &FittedRecipe) -> std::fmt::Result {
    let PerAxis { alpha, ratio, theta, phi } = row.resolution;
    // The names of recipe documents.
    let name = |value: serde_json::Value| value.as_str().unwrap_or_default().to_owned();
    let (layout, precision) = (name(json!(row.layout)), name(json!(row.precision)));
    let FittedRecipe { samples, directions, steps, entries, bytes, compact_bytes, on_front, .. } = row;
    write!(out, "{},{},{layout},{alpha},{ratio},{theta},{phi},", row.recipe_digest, row.preset.unwrap_or_default())?;
    write!(out, "{samples},{directions},{steps},{precision},{entries},{bytes},")?;
    write!(out, "{},", compact_bytes.map_or_else(String::new, |bytes| bytes.to_string()))?;
    write!(out, "{:.4},{:.4},", row.seconds, row.wall_seconds)?;
    write!(out, "{:.6},{:.6},{:.6},{:.6},", row.error_mean, row.error_p95, row.sw1_mean, row.sw1_p95)?;
    write!(out, "{:.6},{:.6},", row.light_mean, row.light_p95)?;
    write!(out, "{:.4},{:.6},", row.predicted_seconds, row.predicted_error)?;
    writeln!(out, "{},{},{}", on_front.seconds, on_front.bytes, on_front.base)
}

/// One document: how it was measured, the rows, and the models.
#[must_use]
pub fn json(rows: &[FittedRecipe], models: &ModelRows, threads: usize) -> String {
    let document = json!({ "points": POINTS, "threads": threads, "rows": rows, "models": models });
    format!("{document:#}\n")
}
