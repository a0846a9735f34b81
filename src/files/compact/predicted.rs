//! The bytes of compact forms, predicted from a coarse table.
//!
//! We encode the coarse table, and for each axis the table with every second node along this axis. The two sizes give the growth of the bytes with the number of nodes on this axis, as a
//! power. Powers of different axes multiply.

use super::{decode, encode, encode_lobes};
use ltcforge_fit::{
    Recipe, Table,
    math::{ln, pow},
};

/// The bytes of a second lobe's form, divided by the bytes of the first lobe's form. For the default table, the forms
/// have 9,760 and 14,105 bytes.
const SECOND: f64 = 0.69;

/// Predicts the bytes of compact forms.
#[derive(Debug, Clone, PartialEq)]
pub struct CompactBytes {
    of_base: f64,
    nodes: [u32; 4],
    powers: [f64; 4],
}

impl CompactBytes {
    /// Encodes the coarse table with all of its nodes, and with every second node along each axis in turn; `None` if
    /// it has no compact form. Domain: an odd number of nodes on each axis.
    #[must_use]
    pub fn of(table: &Table, base: &Recipe) -> Option<Self> {
        let bytes = |table: &Table| encode(table).ok().map(|bytes| bytes.len() as f64);
        let of_base = bytes(table)?;
        let nodes = base.resolution().named().map(|(_, n)| *n);
        let mut powers = [0.0; 4];
        for (axis, power) in powers.iter_mut().enumerate().filter(|(axis, _)| nodes[*axis] > 2) {
            let half = nodes[axis].div_ceil(2);
            let of_half = bytes(&table.coarser(base, axis, half))?;
            *power = (ln(of_base / of_half) / ln(f64::from(nodes[axis]) / f64::from(half))).max(0.0);
        }
        Some(Self { of_base, nodes, powers })
    }

    /// The bytes of the compact form of a recipe's table. Domain: evenly spaced nodes over the ranges of the coarse
    /// table.
    #[must_use]
    pub fn bytes(&self, recipe: &Recipe) -> u64 {
        let resolution = recipe.resolution().named().map(|(_, n)| *n);
        let grown =
            (0..4).map(|axis| pow(f64::from(resolution[axis]) / f64::from(self.nodes[axis]), self.powers[axis]));
        let second = if recipe.model().fresnel().second().is_some() { SECOND } else { 0.0 };
        (self.of_base * (1.0 + second) * grown.product::<f64>()).ceil() as u64
    }
}

/// Encodes a table and decodes the compact form. Returns the decoded table and the bytes of the form; `None` if the
/// table has no compact form.
#[must_use]
pub fn encoded_and_decoded(table: &Table) -> Option<(Table, u64)> {
    let forms = encode_lobes(table).ok()?;
    let decoded: Option<Vec<Table>> = forms.iter().map(|form| decode(&form.bytes).ok()).collect();
    let mut decoded = decoded?.into_iter();
    let first = decoded.next()?;
    let second = decoded.next().map(|second| second.matrix);
    let bytes = forms.iter().map(|form| form.bytes.len() as u64).sum();
    Some((Table { brdf: table.model().clone(), second, ..first }, bytes))
}
