//! The numbers of a network, and how the source and the shaders write them.

use std::fmt::Write as _;

use ltcforge::{
    fit::Sides,
    light::{
        NormalsRule,
        normals::{Network, Region, region},
    },
};

use crate::lights::Lit;

/// Significant digits of a number in the source.
const DIGITS: i32 = 4;

/// The numbers of a network.
#[derive(Debug, Clone, PartialEq)]
pub struct Numbers {
    /// Rows of the units, as in [`Network`].
    pub units: Vec<Vec<f64>>,
    /// Rows of the outputs.
    pub outputs: Vec<Vec<f64>>,
}

impl From<Network<'_>> for Numbers {
    fn from(network: Network<'_>) -> Self {
        let rows = |rows: &[&[f64]]| rows.iter().map(|row| row.to_vec()).collect();
        Self { units: rows(network.units), outputs: rows(network.outputs) }
    }
}

impl Numbers {
    /// The light by a rule, with these numbers.
    #[must_use]
    pub fn reflected(&self, rule: NormalsRule, lit: &Lit) -> [f64; 2] {
        let (units, outputs) = (slices(&self.units), slices(&self.outputs));
        let network = Network { units: &units, outputs: &outputs };
        region_of(rule, lit).map_or([0.0; 2], |region| region.reflected(&network))
    }

    /// The numbers as written in `src/light/normals/numbers.rs`.
    #[must_use]
    pub fn as_rust(&self, rule: NormalsRule) -> String {
        let rows = |rows: &[Vec<f64>]| {
            let row = |row: &Vec<f64>| format!("        &[{}],\n", listed(row));
            rows.iter().map(row).collect::<String>()
        };
        format!(
            "pub(super) const {}: Network<'static> = Network {{\n    units: &[\n{}    ],\n    outputs: &[\n{}    ],\n}};\n",
            rule.name().to_uppercase(),
            rows(&self.units),
            rows(&self.outputs),
        )
    }

    /// The numbers as written in the shader of the rule: matrices in column order, each with at most four inputs and
    /// four units. The fifth output is a separate dot product.
    #[must_use]
    pub fn as_wgsl(&self, rule: NormalsRule) -> String {
        let mut out = String::new();
        let (group, inputs) = (self.units.len().min(4), rule.inputs());
        for (i, units) in self.units.chunks(group).enumerate() {
            let term = |(from, name): (usize, &str)| format!("{} * {name}", matrix(units, from, inputs.min(from + 4)));
            let terms: Vec<String> = (0..inputs).step_by(4).zip(["first", "second", "third"]).map(term).collect();
            let bias = listed(&units.iter().map(|row| row[inputs]).collect::<Vec<_>>());
            let _ = writeln!(
                out,
                "    let sum_{i} = {}\n        + vec{group}({bias});\n    let units_{i} = sum_{i} + sqrt(sum_{i} * sum_{i} + 1.0);",
                terms.join("\n        + "),
            );
        }
        let (first_four, fifth) = self.outputs.split_at(self.outputs.len().min(4));
        let groups = 0..self.units.len() / group;
        for (name, rows) in [("outputs", first_four), ("fifth", fifth)].into_iter().filter(|(_, rows)| !rows.is_empty())
        {
            let count = rows.len();
            let term = |i: usize| {
                let matrix = matrix(rows, i * group, (i + 1) * group);
                if count == 1 { format!("dot({matrix}, units_{i})") } else { format!("{matrix} * units_{i}") }
            };
            let terms: Vec<String> = groups.clone().map(term).collect();
            let bias = listed(&rows.iter().map(|row| row[self.units.len()]).collect::<Vec<_>>());
            let bias = if count == 1 { bias } else { format!("vec{count}({bias})") };
            let _ = writeln!(out, "    let {name} = {}\n        + {bias};", terms.join("\n        + "));
        }
        out
    }
}

pub(super) fn region_of(rule: NormalsRule, lit: &Lit) -> Option<Region<f64>> {
    region(lit.alpha(), lit.wo(), &lit.vertices, Sides::Two, rule)
}

fn slices(rows: &[Vec<f64>]) -> Vec<&[f64]> {
    rows.iter().map(Vec::as_slice).collect()
}

/// Some columns of the rows, as a WGSL matrix, or as a vector if there is one row or one column.
fn matrix(rows: &[Vec<f64>], from: usize, to: usize) -> String {
    let column = |k: usize| listed(&rows.iter().map(|row| row[k]).collect::<Vec<_>>());
    let columns: Vec<String> = (from..to).map(column).collect();
    let name = match (to - from, rows.len()) {
        (1, count) | (count, 1) => format!("vec{count}"),
        (columns, rows) => format!("mat{columns}x{rows}"),
    };
    format!("{name}({})", columns.join(", "))
}

fn listed(numbers: &[f64]) -> String {
    numbers.iter().map(|x| format!("{x:?}")).collect::<Vec<_>>().join(", ")
}

/// A number rounded to the digits of the source.
pub(super) fn rounded(x: f64) -> f64 {
    if x == 0.0 {
        return 0.0;
    }
    let one = 10_f64.powi(DIGITS - 1 - x.abs().log10().floor() as i32);
    // The quotient of two whole numbers is the nearest f64, so it prints with these digits. A number without decimals
    // is a product instead.
    if one >= 1.0 { (x * one).round() / one } else { (x * one).round() * one.recip().round() }
}
