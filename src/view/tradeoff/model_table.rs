//! The models in the picture as a table: errors, times and bytes.

use std::fmt::Write as _;

use super::{
    ModelRows,
    number::{bytes, two_digits},
};

/// Left end of the table, right ends of its columns, and the distance of its lines.
const LEFT: f64 = 64.0;
const COLUMNS: [f64; 7] = [340.0, 460.0, 590.0, 720.0, 850.0, 980.0, 1104.0];
const LINE: f64 = 26.0;

/// Writes the table from the height `top` of the picture on.
pub(super) fn write(out: &mut String, top: f64, models: &ModelRows) -> std::fmt::Result {
    let heads = ["mean error", "p95", "ms a frame", "on the GPU", "file", "code, WGSL", "seconds to fit"];
    let mut line = |y: f64, name: &str, cells: [String; 7], class: &str| -> std::fmt::Result {
        writeln!(out, r#"<text class="{class}" x="{LEFT}" y="{y}">{name}</text>"#)?;
        for (cell, right) in cells.iter().zip(COLUMNS) {
            writeln!(out, r#"<text class="end {class}" x="{right}" y="{y}">{cell}</text>"#)?;
        }
        Ok(())
    };
    line(top + 12.0, "model", heads.map(str::to_owned), "title")?;
    for (number, row) in (1..).zip(&models.rows) {
        let cells = [
            format!("{:.5}", row.light_error.mean),
            format!("{:.4}", row.light_error.p95),
            format!("{:.1}", row.frame_milliseconds),
            few_bytes(row.gpu_bytes),
            few_bytes(row.file_bytes),
            few_bytes(row.shader_bytes),
            two_digits(row.fit_seconds).to_string(),
        ];
        line(top + 12.0 + f64::from(number) * LINE, &row.name(), cells, "model")?;
    }
    let y = top + 16.0 + (models.rows.len() + 1) as f64 * LINE;
    writeln!(out, r#"<text x="{LEFT}" y="{y}">frames by {}</text>"#, escaped(&models.adapter))
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
