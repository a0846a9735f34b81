//! The models in the picture as a table: errors, times and bytes.

use std::fmt::Write as _;

use super::{
    ModelRows,
    number::{bytes, two_digits},
};
use ltcforge_fit::Spread;
use ltcforge_shaders::GpuCost;

/// Left end of the table, right ends of its columns, and the distance of its lines.
const LEFT: f64 = 64.0;
const COLUMNS: [f64; 9] = [320.0, 400.0, 492.0, 600.0, 700.0, 806.0, 892.0, 992.0, 1104.0];
pub(super) const LINE: f64 = 26.0;

/// Writes the table from the height `top` of the picture on.
pub(super) fn write(out: &mut String, top: f64, models: &ModelRows) -> std::fmt::Result {
    let heads = [
        "mean error",
        "p95",
        "registers",
        "instructions",
        "ms a frame",
        "on the GPU",
        "file",
        "code, WGSL",
        "seconds to fit",
    ];
    let mut line = |y: f64, name: &str, cells: [String; 9], class: &str| -> std::fmt::Result {
        writeln!(out, r#"<text class="{class}" x="{LEFT}" y="{y}">{name}</text>"#)?;
        for (cell, right) in cells.iter().zip(COLUMNS) {
            writeln!(out, r#"<text class="end {class}" x="{right}" y="{y}">{cell}</text>"#)?;
        }
        Ok(())
    };
    line(top + 12.0, "model", heads.map(str::to_owned), "title")?;
    for (number, row) in (1..).zip(&models.rows) {
        let [mean, p95, registers, instructions] = told(&row.light_error, row.gpu_cost);
        let cells = [
            mean,
            p95,
            registers,
            instructions,
            format!("{:.1}", row.frame_milliseconds),
            few_bytes(row.gpu_bytes),
            few_bytes(row.file_bytes),
            few_bytes(row.shader_bytes),
            two_digits(row.fit_seconds).to_string(),
        ];
        line(top + 12.0 + f64::from(number) * LINE, &row.name(), cells, "model")?;
    }
    for (number, row) in (models.rows.len() + 1..).zip(&models.engines) {
        let [mean, p95, registers, instructions] = told(&row.light_error, row.gpu_cost);
        let none = String::new;
        let cells = [mean, p95, registers, instructions, none(), none(), none(), none(), none()];
        line(top + 12.0 + number as f64 * LINE, row.way.name(), cells, "model")?;
    }
    let y = top + 16.0 + (models.rows.len() + models.engines.len() + 1) as f64 * LINE;
    let (adapter, compiler) = (escaped(&models.adapter), escaped(models.compiler));
    writeln!(out, r#"<text x="{LEFT}" y="{y}">frames by {adapter}; registers and instructions by {compiler}</text>"#)
}

/// The cells that all rows have.
fn told(error: &Spread, cost: Option<GpuCost>) -> [String; 4] {
    let number = |of: fn(GpuCost) -> u32| cost.map_or_else(String::new, |cost| of(cost).to_string());
    [
        format!("{:.5}", error.mean),
        format!("{:.4}", error.p95),
        number(|cost| cost.registers),
        number(|cost| cost.instructions),
    ]
}

/// Bytes with two digits.
fn few_bytes(count: u64) -> String {
    if count == 0 { "0".to_owned() } else { bytes(two_digits(count as f64)) }
}

/// A driver's name as text of an XML document.
fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

#[cfg(test)]
mod tests {
    use super::{super::model::tests::rows, *};

    #[test]
    fn every_model_is_told() {
        let models = ModelRows { adapter: "a <b> & c".to_owned(), ..rows() };
        let mut svg = String::new();
        write(&mut svg, 100.0, &models).expect("a string");
        for row in &models.rows {
            assert_eq!(svg.matches(&format!(">{}</text>", row.name())).count(), 1, "{svg}");
        }
        assert!(svg.contains(">180 kB</text>") && svg.contains(">0</text>"), "{svg}");
        assert!(svg.contains("a &lt;b&gt; &amp; c") && !svg.contains("NaN"), "{svg}");
    }
}
