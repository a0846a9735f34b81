//! The costs of the texts are those that the compiler tells.

use std::{
    io::{Write as _, stderr},
    process::Command,
};

use ltcforge::shaders::{COMPILER, GpuCost};

const SOURCE: &str = include_str!("../../src/shaders/gpu_cost.rs");

/// Says past the harness that the test could not look.
fn tell_skipped(reason: &str) {
    // A line that cannot be printed is no failure of what is tested.
    let _ = stderr().write_all(format!("\n*** SKIPPED: the costs of shaders: {reason}\n\n").as_bytes());
}

#[test]
fn every_text_costs_what_the_source_has() {
    let output = Command::new(env!("CARGO_BIN_EXE_ltcforge-studies")).arg("gpu-costs").output().expect("a program");
    let errors = String::from_utf8_lossy(&output.stderr);
    if errors.contains("no driver tells") {
        return tell_skipped(&errors);
    }
    assert!(output.status.success(), "{errors}");
    let told = String::from_utf8(output.stdout).expect("text");
    let mut lines = told.lines();
    let device = lines.next().and_then(|line| line.strip_prefix("// ")).expect("a device");
    let rows: Vec<&str> = lines.collect();
    let names: Vec<String> = GpuCost::names().map(|name| format!("(\"{name}\", ")).collect();
    assert_eq!(rows.len(), names.len(), "{told}");
    for (row, name) in rows.iter().zip(&names) {
        assert!(row.trim_start().starts_with(name), "{row}");
    }
    if device != COMPILER {
        return tell_skipped(&format!("{device} is another compiler than that of the figures, {COMPILER}"));
    }
    for row in rows {
        assert!(SOURCE.contains(row), "{row}: cargo run -p ltcforge-studies -- gpu-costs");
    }
}
