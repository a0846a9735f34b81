//! The choice of the best stored table.

use std::{
    cmp::Reverse,
    collections::HashMap,
    f64::consts::FRAC_PI_2,
    sync::{Mutex, PoisonError},
};

use crate::service::{ServiceError, tables::Tables};
use ltcforge_files::{digest::Digest, recipe_document};
use ltcforge_fit::{BrdfKind, Recipe};

/// Rows of the catalogue that are read at a time.
const PAGE: usize = 256;

/// Ranks tables. Ranks read from manifests are kept, for a table's rank never changes.
#[derive(Debug, Default)]
pub(super) struct Ranking(Mutex<HashMap<Digest, Rank>>);

/// The rank of a table: the fields are compared in order, and the greater rank is better. The error is measured within
/// the table's own ranges, so it cannot be compared with that of a table that covers more of the domain.
#[derive(Debug, Clone, Copy, PartialEq, PartialOrd)]
struct Rank {
    /// Whether it is of the scattering model that recipes have by default, as scenes have.
    is_default_brdf: bool,
    /// The part of the domain that the table's ranges cover.
    coverage: f64,
    /// A table without amplitudes reflects all light.
    has_terms: bool,
    /// `report.between.sw1.mean` of the manifest.
    error: Reverse<f64>,
}

impl Rank {
    fn of(recipe: &Recipe, error: f64) -> Self {
        let range = &recipe.range;
        let lengths = [(range.alpha, 1.0), (range.ratio, 1.0), (range.theta, FRAC_PI_2), (range.phi, FRAC_PI_2)];
        let coverage = lengths.into_iter().map(|([low, high], whole)| (high - low) / whole).product();
        let is_default_brdf = recipe.brdf == BrdfKind::ALL[0] && recipe.brdf.fresnel().is_one();
        Self { is_default_brdf, coverage, has_terms: recipe.terms.any(), error: Reverse(error) }
    }
}

impl Ranking {
    /// The best table: GGX first, then the larger part of the domain, then terms, then the lower mean distance between
    /// nodes, then the newer table. If no table has a manifest of the current version, the newest table.
    pub(super) fn best(&self, tables: &Tables) -> Result<Option<Digest>, ServiceError> {
        let (mut best, mut cursor) = (None::<(Option<Rank>, Digest)>, None);
        loop {
            let (rows, next) = tables.catalogue.page(cursor.as_deref(), PAGE)?;
            for table in rows.iter().map(|row| row.digest) {
                if !tables.contains(table)? {
                    continue;
                }
                // A table without a rank is less than one with.
                let rank = self.rank(tables, table)?;
                if best.is_none_or(|(best, _)| rank > best) {
                    best = Some((rank, table));
                }
            }
            if next.is_none() {
                return Ok(best.map(|(_, table)| table));
            }
            cursor = next;
        }
    }

    fn rank(&self, tables: &Tables, table: Digest) -> Result<Option<Rank>, ServiceError> {
        let known = || self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(rank) = known().get(&table) {
            return Ok(Some(*rank));
        }
        let Some(text) = tables.stored_manifest(table)? else { return Ok(None) };
        let manifest: serde_json::Value = serde_json::from_str(&text).unwrap_or_default();
        let recipe = recipe_document::parse_stored(manifest["recipe"].to_string().as_bytes()).ok();
        let error = manifest["report"]["between"]["sw1"]["mean"].as_f64();
        let rank = recipe.zip(error).map(|(recipe, error)| Rank::of(&recipe, error));
        if let Some(rank) = rank {
            known().insert(table, rank);
        }
        Ok(rank)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rank(document: &str, error: f64) -> Rank {
        Rank::of(&recipe_document::parse(document.as_bytes(), 100_000).expect("a recipe"), error)
    }

    #[test]
    fn coverage_comes_before_terms_and_terms_before_error() {
        let good = rank(r#"{"preset": "draft"}"#, 0.007);
        let poor = rank(r#"{"preset": "draft", "range": {"theta": [0, 1.5707963267948966]}}"#, 0.009);
        let bare = rank(r#"{"preset": "draft", "terms": false}"#, 0.001);
        let narrow = rank(r#"{"preset": "draft", "range": {"alpha": [0.001, 0.02]}}"#, 0.001);
        let isotropic = rank(r#"{"preset": "draft", "range": {"ratio": [1, 1], "phi": [0, 0]}}"#, 0.0001);
        let other = rank(r#"{"preset": "draft", "brdf": "beckmann"}"#, 0.0001);
        let mut ranked = [other, isotropic, bare, narrow, poor, good];
        ranked.sort_by(|a, b| b.partial_cmp(a).expect("numbers"));
        assert_eq!(ranked, [good, poor, bare, narrow, isotropic, other]);
    }
}
