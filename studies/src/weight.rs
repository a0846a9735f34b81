//! The numbers by which model `normals` averages the weight of shadowing: see docs/normals.md, section 6.

use std::fmt::Write as _;

use ltcforge::{
    fit::Sides,
    light::{
        WeightRule,
        normals::{Forms, reflected_with},
    },
};

use crate::{
    lights::{Case, Kind, Lit, cases, errors},
    markdown::spread,
    search::{Model, objective, search},
};

/// How many numbers a rule has.
pub const COUNT: usize = 6 * 4 + 6 * 6 + 2 * 6;
/// Digits behind the point, as the source has them.
const DIGITS: i32 = 3;

/// A rule of the weight, to be found numbers for.
pub struct Weight(pub WeightRule);

impl Model for Weight {
    fn reflected(&self, numbers: &[f64], lit: &Lit) -> [f64; 2] {
        reflected_with(&forms(numbers), lit.alpha(), lit.wo(), &lit.vertices, Sides::Two, self.0)
    }
}

/// The numbers of a rule in one row. Domain: [`COUNT`] numbers.
#[must_use]
pub fn forms(numbers: &[f64]) -> Forms {
    let mut rest = numbers.iter().copied();
    let mut next = || rest.next().unwrap_or(0.0);
    Forms {
        usual: std::array::from_fn(|_| std::array::from_fn(|_| next())),
        wide: std::array::from_fn(|_| std::array::from_fn(|_| next())),
        inner: std::array::from_fn(|_| std::array::from_fn(|_| next())),
    }
}

/// [`forms`] undone.
#[must_use]
pub fn numbers(forms: &Forms) -> Vec<f64> {
    let Forms { usual, wide, inner } = forms;
    [usual.as_flattened(), wide.as_flattened(), inner.as_flattened()].concat()
}

/// Where a search starts that knows nothing: constants, which are those of a straight edge where there are such. The
/// outer sample is the middle of the edge and counts as much as the centroid; the corners count nothing; near a
/// straight horizon the sample is at 13/15 of the way, and the rate there 2/13.
#[must_use]
pub fn plain() -> Vec<f64> {
    let constants = [1.0, 0.02, 0.5, 0.154, 0.3, 0.02];
    let mut plain = Forms { usual: [[0.0; 4]; 6], wide: [[0.0; 6]; 6], inner: [[0.0; 6]; 2] };
    for (i, constant) in constants.into_iter().enumerate() {
        plain.usual[i][0] = constant;
        plain.wide[i][0] = constant;
    }
    plain.inner[0][0] = 0.1;
    numbers(&plain)
}

/// `count` cases, shared evenly among the kinds.
#[must_use]
pub fn drawn(seed: u64, count: usize) -> Vec<Case> {
    let kinds = Kind::ALL.into_iter().enumerate();
    kinds.flat_map(|(i, kind)| cases(kind, 100 * seed + i as u64, count / Kind::ALL.len())).collect()
}

/// As the source has it.
#[must_use]
pub fn rounded(numbers: &[f64]) -> Vec<f64> {
    let one = 10_f64.powi(DIGITS);
    // Not -0.
    numbers.iter().map(|x| (x * one).round() / one + 0.0).collect()
}

fn row(numbers: &[f64]) -> String {
    format!("[{}]", numbers.iter().map(|x| format!("{x:?}")).collect::<Vec<_>>().join(", "))
}

/// The numbers as `src/light/normals/mod.rs` has them.
#[must_use]
pub fn as_rust(name: &str, Forms { usual, wide, inner }: &Forms) -> String {
    let lines = |rows: &[&[f64]]| {
        rows.iter().map(|numbers| format!("        {},", row(numbers))).collect::<Vec<_>>().join("\n")
    };
    let [usual, wide] = [usual.each_ref().map(|x| &x[..]), wide.each_ref().map(|x| &x[..])].map(|rows| lines(&rows));
    let inner = inner.each_ref().map(|numbers| row(numbers)).join(", ");
    format!(
        "const {name}: Forms = Forms {{\n    usual: [\n{usual}\n    ],\n    wide: [\n{wide}\n    ],\n    inner: [{inner}],\n}};\n"
    )
}

/// The numbers as `shaders/normals_weight.wgsl` has them: those of a rule by `let` or for a variable that there is.
#[must_use]
pub fn as_wgsl(forms: &Forms, is_declared: bool) -> String {
    let Forms { usual, wide, inner } = forms;
    let (var, indent) = if is_declared { ("", "        ") } else { ("var ", "    ") };
    let mut out = String::new();
    let mut matrices = |name: &str, rows: &[&[f64]]| {
        let columns = |from: usize, to: usize| {
            let column = |k: usize| rows.iter().map(|row| format!("{:?}", row[k])).collect::<Vec<_>>().join(", ");
            (from..to).map(|k| format!("{indent}    {},", column(k))).collect::<Vec<_>>().join("\n")
        };
        let height = rows.len();
        // Writing to a String cannot fail.
        let _ = write!(out, "{indent}{var}{name} = mat4x{height}(\n{}\n{indent}) * at", columns(0, 4));
        if rows[0].len() > 4 {
            let _ = write!(out, " + mat2x{height}(\n{}\n{indent}) * by_ratio", columns(4, 6));
        }
        out.push_str(";\n");
    };
    // Rows of `edge` and of `horizon` as the shader orders them.
    let usual_rows = |order: [usize; 3]| order.map(|i| &usual[i][..]);
    let wide_rows = |order: [usize; 3]| order.map(|i| &wide[i][..]);
    matrices("edge", &usual_rows([0, 1, 2]));
    matrices("horizon", &usual_rows([3, 4, 5]));
    matrices("wide_edge", &wide_rows([0, 1, 2]));
    matrices("wide_horizon", &wide_rows([3, 4, 5]));
    matrices("inner", &inner.each_ref().map(|x| &x[..]));
    out
}

/// The arguments of `find`.
#[derive(Debug, Clone, Copy)]
pub struct Asked {
    /// The rule.
    pub rule: WeightRule,
    /// Start from constants, not from the numbers that stand.
    pub is_cold: bool,
    /// Cases of the search, and again of the hold-out.
    pub lights: usize,
    /// Most steps.
    pub rounds: usize,
    /// Seed of the cases.
    pub seed: u64,
}

/// The numbers that were found, and the objective of them and of those that stand, on the search's cases and on others.
#[derive(Debug, Clone)]
pub struct Found {
    /// The numbers, rounded as the source has them.
    pub numbers: Vec<f64>,
    /// Objectives on the cases of the search: of the start, of the numbers that stand, of those found.
    pub seen: [f64; 3],
    /// The same on others.
    pub held_out: [f64; 3],
}

/// Finds the numbers of a rule.
pub fn find(asked: &Asked, tell: impl FnMut(usize, f64)) -> Found {
    let model = Weight(asked.rule);
    let standing = numbers(asked.rule.forms());
    let start = if asked.is_cold { plain() } else { standing.clone() };
    let [seen, held_out] = [asked.seed, asked.seed + 1].map(|seed| drawn(seed, asked.lights));
    let found = rounded(&search(&model, &start, &seen, asked.rounds, tell));
    let [seen, held_out] =
        [seen, held_out].map(|cases| [&start, &standing, &found].map(|numbers| objective(&model, numbers, &cases)));
    Found { numbers: found, seen, held_out }
}

/// The errors of some numbers for each kind, on cases of the hold-out, as markdown.
#[must_use]
pub fn by_kind(rule: WeightRule, seed: u64, count: usize, candidates: &[(&str, &[f64])]) -> String {
    let mut out = "| lights |".to_owned();
    for (name, _) in candidates {
        let _ = write!(out, " {name}: mean / p95 / max |");
    }
    let _ = writeln!(out, "\n|---|{}", "---|".repeat(candidates.len()));
    for (i, kind) in Kind::ALL.into_iter().enumerate() {
        let cases = cases(kind, 100 * (seed + 1) + i as u64, count / Kind::ALL.len());
        let _ = write!(out, "| {} |", kind.name());
        for (_, numbers) in candidates {
            let [energy, _] = errors(&cases, |lit| Weight(rule).reflected(numbers, lit));
            let _ = write!(out, " {} |", spread(energy));
        }
        out.push('\n');
    }
    out
}
