//! Figures in the docs that change with the code: sizes of shaders and of compact tables.

use std::{fs, path::Path};

use ltcforge::shaders::GpuCost;

use crate::common::command::run;

/// The cells of a table row in docs/`document`. The row starts with `first`, which is not returned.
#[track_caller]
fn row(document: &str, first: &str) -> Vec<String> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs").join(document);
    let text = fs::read_to_string(path).expect("a document");
    let mut rows = text.lines().filter_map(|line| line.strip_prefix("| ")?.strip_prefix(first)?.strip_prefix(" | "));
    let row = rows.next().unwrap_or_else(|| panic!("{document}: no row of {first}"));
    row.trim_end_matches(" |").split(" | ").map(str::to_owned).collect()
}

/// The number with a comma between thousands: 12,345.
fn with_comma(count: usize) -> String {
    if count < 1000 { count.to_string() } else { format!("{},{:03}", count / 1000, count % 1000) }
}

#[test]
fn the_bytes_of_shaders_agree_with_the_documents() {
    let here = tempfile::tempdir().expect("a folder");
    for language in ["wgsl", "glsl", "glsl-es", "hlsl", "msl"] {
        let lengths = [["--layout", "reflected"], ["--model", "ltc-formula"]].map(|model| {
            let lengths = ["all", "polygons", "rectangles"].map(|lights| {
                let words = ["shader", "--language", language, "--lights", lights];
                with_comma(run(here.path(), words.iter().chain(&model)).exited(0).stdout.len())
            });
            lengths.join(", ")
        });
        assert_eq!(row("lights.md", &format!("`{language}`")), lengths, "docs/lights.md, {language}");
    }
}

#[test]
fn the_bytes_of_compact_tables_agree_with_the_documents() {
    let folder = tempfile::tempdir().expect("a folder");
    let here = folder.path();
    let table = run(here, ["fit", "standard", "-o", "tables"]).exited(0).stdout;
    let table = table.lines().next().expect("the file").to_owned();
    let length = |container: &str, file: &str| {
        run(here, ["export", &table, "--container", container, "-o", container]).exited(0);
        with_comma(fs::metadata(here.join(container).join(file)).expect("a file").len() as usize)
    };
    let compact = length("compact", "ltc.compact");
    let with_source = |container, file| format!("{compact} + {}", length(container, file));
    let (rust, wgsl) = (with_source("compact-rust", "ltc.compact.rs"), with_source("compact-wgsl", "ltc.compact.wgsl"));
    let mut output = row("layouts.md", "default `reflected`");
    // The gzipped length comes from another program.
    output.remove(2);
    assert_eq!(output, [compact, length("compact-js", "ltc.compact.js"), rust, wgsl]);
}

#[test]
fn the_costs_of_shaders_agree_with_the_documents() {
    let text = |path: &str| fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join(path)).expect("a document");
    let (readme, normals) = (text("README.md"), text("docs/normals.md"));
    let cost = |name: &str| GpuCost::of(name).unwrap_or_else(|| panic!("no cost of {name}"));
    let cells = |cost: GpuCost| format!("| {} | {} |", cost.registers, with_comma(cost.instructions as usize));
    for (row, name) in [
        ("`normals`, rule `fast` ", "normals fast"),
        ("`normals`, rule `balanced`, the default ", "normals balanced"),
        ("`normals`, rule `fine` ", "normals fine"),
        ("`ltc`, default table ", "ltc reflected"),
        ("`kt2022`, method of KT et al. ", "kt2022, its own"),
        ("`ltc-formula`, no table ", "ltc-formula"),
        ("`ltc2017`, method of engines ", "ltc2017, clipless"),
    ] {
        let row = format!("| {row}{}", cells(cost(name)));
        assert!(readme.lines().any(|line| line.starts_with(&row)), "README.md: {row}");
    }
    for rule in ["fast", "balanced", "fine"] {
        let cost = cost(&format!("normals {rule}"));
        let row = format!("| `{rule}` {} {} |", cells(cost), with_comma(cost.inverse_throughput as usize));
        assert!(normals.lines().any(|line| line.starts_with(&row)), "docs/normals.md: {row}");
    }
}
