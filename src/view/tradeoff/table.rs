//! The trade-off as CSV and JSON.

use serde_json::{Value, json};

use super::{FittedRecipe, ModelRows, POINTS};

/// The columns, as paths in a row's JSON. A column's name is its path with underscores.
const COLUMNS: &str = "recipe_digest preset layout resolution/alpha resolution/ratio resolution/theta resolution/phi samples directions \
                       steps precision entries bytes compact_bytes seconds wall_seconds error_mean error_p95 sw1_mean sw1_p95 light_mean \
                       light_p95 predicted_seconds predicted_error on_front/seconds on_front/bytes on_front/base";

/// The rows as CSV, with a header. No field needs quotes.
#[must_use]
pub fn csv(rows: &[FittedRecipe]) -> String {
    let header = COLUMNS.replace("resolution/", "").replace('/', "_").replace(' ', ",");
    let cell = |row: &Value, column: &str| match row.pointer(&format!("/{column}")) {
        Some(Value::String(text)) => text.clone(),
        Some(Value::Number(number)) if number.is_f64() => format!("{:.6}", number.as_f64().unwrap_or_default()),
        None | Some(Value::Null) => String::new(),
        Some(other) => other.to_string(),
    };
    let lines = rows.iter().map(|row| {
        let row = json!(row);
        COLUMNS.split(' ').map(|column| cell(&row, column)).collect::<Vec<_>>().join(",")
    });
    std::iter::once(header).chain(lines).map(|line| line + "\n").collect()
}

/// One JSON document: the measurement, the rows, and the models.
#[must_use]
pub fn json(rows: &[FittedRecipe], models: &ModelRows, threads: usize) -> String {
    let document = json!({ "points": POINTS, "threads": threads, "rows": rows, "models": models });
    format!("{document:#}\n")
}
