//! The tables of docs/refraction.md for light through a rough interface: the error of the closed form against a
//! quadrature over the light's area, and the difference between f32 and f64.

use std::fmt::Write as _;

use ltcforge_light::transmission::cases::{self, Set, f32_errors};

use crate::markdown::short;

/// Lights per row of the first table, and per cell of the second.
const LIGHTS: [usize; 2] = [500, 4000];
/// The tolerance of the quadrature.
const TOLERANCE: f64 = 1e-7;
/// The rows of the first table, for each refractive index.
const SETS: [(Set, &str); 7] = [
    (Set::Isotropic, "isotropic, alpha .05 to 1"),
    (Set::Anisotropic, "anisotropic, .05 to 1"),
    (Set::Sharp, ".001 to .05"),
    (Set::Cut, "cut at the surface"),
    (Set::Facing, "clipped by `wo . h > 0` or `wi . h < 0`"),
    (Set::Horizon, "clipped by `h.z > 0`"),
    (Set::Anywhere, "in any direction below"),
];
/// The rows of the second table: names and ranges of the refractive index.
const INDICES: [(&str, [f64; 2]); 8] = [
    ("1.5", [1.5, 1.5]),
    ("1/1.5", [1.0 / 1.5, 1.0 / 1.5]),
    ("1.002 to 1.005 (outside the domain)", [1.002, 1.005]),
    ("1.01 to 1.02 (outside)", [1.01, 1.02]),
    ("1.02 to 1.2", [1.02, 1.2]),
    (".83 to .98", [0.83, 0.98]),
    ("1.8 to 3", [1.8, 3.0]),
    ("1/3 to .55", [1.0 / 3.0, 0.55]),
];
/// The columns of the second table: ranges of alpha.
const ALPHAS: [[f64; 2]; 4] = [[0.05, 1.0], [0.005, 0.05], [5e-4, 0.005], [1e-4, 5e-4]];

/// The rows with errors against the quadrature. They take minutes.
#[must_use]
pub fn errors() -> String {
    let mut rows = String::new();
    let mut row = |name: &str, eta: f64, (set, lights): (Set, &str)| {
        let [visible, rest @ ..] = cases::errors(set, eta, LIGHTS[0], TOLERANCE);
        let cells = rest.map(|errors| errors.map(number).join(" / ")).join(" | ");
        // Writing to a string cannot fail.
        let _ = writeln!(rows, "| {name} | {lights} | {} | {cells} |", scientific(visible));
    };
    for (name, eta) in [("1.5", 1.5), ("1/1.5", 1.0 / 1.5)] {
        for set in SETS {
            row(name, eta, set);
        }
    }
    for (name, eta) in [("1.05", 1.05), (".95", 0.95), ("2.5", 2.5), (".4", 0.4)] {
        row(name, eta, SETS[1]);
    }
    rows
}

/// The rows with differences between f32 and f64.
#[must_use]
pub fn differences() -> String {
    let row = |(name, etas): (&str, [f64; 2])| {
        format!("| {name} | {} |\n", ALPHAS.map(|alphas| scientific(f32_errors(etas, alphas, LIGHTS[1]))).join(" | "))
    };
    INDICES.into_iter().map(row).collect()
}

fn scientific(errors: [f64; 2]) -> String {
    errors.map(|x| format!("{x:.1e}")).join(" / ")
}

fn number(x: f64) -> String {
    if x < 1e-4 { format!("{x:.1e}") } else { short(x, 2) }
}
