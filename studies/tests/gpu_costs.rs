//! Checks that the costs of shaders in the source equal the costs that the compiler reports.

use std::{
    io::{Write as _, stderr},
    process::Command,
};

use ltcforge::shaders::{COMPILER, GpuCost};

const SOURCE: &str = include_str!("../../src/shaders/gpu_cost.rs");

/// Reports a skipped test directly on standard error, which the test harness does not capture.
fn report_skipped(reason: &str) {
    // A failed print should not fail the test.
    let _ = stderr().write_all(format!("\n*** SKIPPED: the costs of shaders: {reason}\n\n").as_bytes());
}

#[test]
fn every_shader_has_the_costs_of_the_source() {
    let output = Command::new(env!("CARGO_BIN_EXE_ltcforge-studies")).arg("gpu-costs").output().expect("a program");
    let errors = String::from_utf8_lossy(&output.stderr);
    if errors.contains("no driver reports costs") {
        return report_skipped(&errors);
    }
    assert!(output.status.success(), "{errors}");
    let printed = String::from_utf8(output.stdout).expect("text");
    let mut lines = printed.lines();
    let device = lines.next().and_then(|line| line.strip_prefix("// ")).expect("a device");
    let rows: Vec<&str> = lines.collect();
    let names: Vec<String> = GpuCost::names().map(|name| format!("(\"{name}\", ")).collect();
    assert_eq!(rows.len(), names.len(), "{printed}");
    for (row, name) in rows.iter().zip(&names) {
        assert!(row.trim_start().starts_with(name), "{row}");
    }
    if device != COMPILER {
        return report_skipped(&format!("the compiler is {device}, but the figures are from {COMPILER}"));
    }
    for row in rows {
        assert!(SOURCE.contains(row), "{row}: cargo run -p ltcforge-studies -- gpu-costs");
    }
}
