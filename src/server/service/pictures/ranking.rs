//! Which of the stored tables is the best.

use std::{
    cmp::Ordering,
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

/// What a table is ranked by. Its errors are measured within its own ranges, so the error of a table for a part of the
/// domain cannot be compared with that of a table for all of it: the part covered is compared first.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Rank {
    /// Whether it is of the scattering model that recipes have by default, as scenes have.
    is_default_brdf: bool,
    /// The part of the domain that the table's ranges cover.
    coverage: f64,
    /// A table without amplitudes reflects all light.
    has_terms: bool,
    /// `report.between.sw1.mean` of the manifest.
    error: f64,
}

impl Rank {
    fn of(recipe: &Recipe, error: f64) -> Self {
        let range = &recipe.range;
        let lengths = [(range.alpha, 1.0), (range.ratio, 1.0), (range.theta, FRAC_PI_2), (range.phi, FRAC_PI_2)];
        let coverage = lengths.into_iter().map(|([low, high], whole)| (high - low) / whole).product();
        Self { is_default_brdf: recipe.brdf == BrdfKind::ALL[0], coverage, has_terms: recipe.terms, error }
    }

    /// `Less` if this rank is the better one.
    fn compare(&self, other: &Self) -> Ordering {
        let by_brdf = other.is_default_brdf.cmp(&self.is_default_brdf);
        let by_coverage = by_brdf.then(other.coverage.total_cmp(&self.coverage));
        by_coverage.then(other.has_terms.cmp(&self.has_terms)).then(self.error.total_cmp(&other.error))
    }
}

impl Ranking {
    /// The best table: of GGX, then most of the domain covered, then with terms, then the lowest mean distance between nodes, then
    /// the newest. If no table has a manifest of the current version, the newest table.
    pub(super) fn best(&self, tables: &Tables) -> Result<Option<Digest>, ServiceError> {
        let (mut newest, mut best) = (None, None::<(Rank, Digest)>);
        let mut cursor = None;
        loop {
            let (rows, next) = tables.catalogue.page(cursor.as_deref(), PAGE)?;
            for table in rows.iter().map(|row| row.digest) {
                if !tables.contains(table)? {
                    continue;
                }
                newest.get_or_insert(table);
                let Some(rank) = self.rank(tables, table)? else { continue };
                if best.is_none_or(|(best, _)| rank.compare(&best).is_lt()) {
                    best = Some((rank, table));
                }
            }
            if next.is_none() {
                return Ok(best.map(|(_, table)| table).or(newest));
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
        ranked.sort_by(Rank::compare);
        assert_eq!(ranked, [good, poor, bare, narrow, isotropic, other]);
    }
}
