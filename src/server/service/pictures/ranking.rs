//! The best of the stored tables.

use std::{
    cmp::Ordering,
    collections::HashMap,
    f64::consts::FRAC_PI_2,
    sync::{Mutex, PoisonError},
};

use crate::{
    files::{digest::Digest, recipe},
    fit::Recipe,
    server::service::{ServiceError, core::Core, manifest::MANIFEST_VERSION},
};

/// Rows of the catalogue that are read at a time.
const PAGE: usize = 256;

/// Standings that were read from manifests: a table's never changes.
#[derive(Debug, Default)]
pub(in crate::server::service) struct Standings(Mutex<HashMap<Digest, Standing>>);

/// What a table is ranked by. Errors are measured within a table's own ranges, so that those of a part of the domain
/// are no match for those of all.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Standing {
    /// The part of the domain that the table's ranges make up.
    covers: f64,
    /// Without amplitudes a table reflects all light.
    has_terms: bool,
    /// The manifest's `report.between.sw1.mean`.
    error: f64,
}

impl Standing {
    fn of(recipe: &Recipe, error: f64) -> Self {
        let range = &recipe.range;
        let lengths = [(range.alpha, 1.0), (range.ratio, 1.0), (range.theta, FRAC_PI_2), (range.phi, FRAC_PI_2)];
        let covers = lengths.into_iter().map(|([low, high], whole)| (high - low) / whole).product();
        Self { covers, has_terms: recipe.terms, error }
    }

    /// `Less` for the better one.
    fn ranked(&self, other: &Self) -> Ordering {
        let by_domain = other.covers.total_cmp(&self.covers);
        by_domain.then(other.has_terms.cmp(&self.has_terms)).then(self.error.total_cmp(&other.error))
    }
}

impl Core {
    /// The table that covers most of the domain, of equals one with terms, of these the one whose manifest has the
    /// lowest mean distance between nodes; where no table has a manifest of this version, the newest. Of equals the
    /// newest.
    pub(super) fn best_table(&self) -> Result<Option<Digest>, ServiceError> {
        let (mut newest, mut best) = (None, None::<(Standing, Digest)>);
        let mut cursor = None;
        loop {
            let (rows, next) = self.catalogue.page(cursor.as_deref(), PAGE)?;
            for table in rows.iter().map(|row| row.digest).filter(|table| self.store.blobs.contains(*table)) {
                newest.get_or_insert(table);
                let Some(standing) = self.standing(table)? else { continue };
                if best.is_none_or(|(best, _)| standing.ranked(&best).is_lt()) {
                    best = Some((standing, table));
                }
            }
            if next.is_none() {
                return Ok(best.map(|(_, table)| table).or(newest));
            }
            cursor = next;
        }
    }

    fn standing(&self, table: Digest) -> Result<Option<Standing>, ServiceError> {
        let known = || self.standings.0.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(standing) = known().get(&table) {
            return Ok(Some(*standing));
        }
        let Some(row) = self.catalogue.manifest(table)?.filter(|row| row.version == MANIFEST_VERSION) else {
            return Ok(None);
        };
        let manifest: serde_json::Value = serde_json::from_str(&row.text).unwrap_or_default();
        let recipe = recipe::parse_stored(manifest["recipe"].to_string().as_bytes()).ok();
        let error = manifest["report"]["between"]["sw1"]["mean"].as_f64();
        let standing = recipe.zip(error).map(|(recipe, error)| Standing::of(&recipe, error));
        if let Some(standing) = standing {
            known().insert(table, standing);
        }
        Ok(standing)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn standing(document: &str, error: f64) -> Standing {
        Standing::of(&recipe::parse(document.as_bytes(), 100_000).expect("a recipe"), error)
    }

    #[test]
    fn a_part_of_the_domain_is_no_match_for_all_of_it() {
        let good = standing(r#"{"preset": "draft"}"#, 0.007);
        let poor = standing(r#"{"preset": "draft", "range": {"theta": [0, 1.5707963267948966]}}"#, 0.009);
        let bare = standing(r#"{"preset": "draft", "terms": false}"#, 0.001);
        let narrow = standing(r#"{"preset": "draft", "range": {"alpha": [0.001, 0.02]}}"#, 0.001);
        let isotropic = standing(r#"{"preset": "draft", "range": {"ratio": [1, 1], "phi": [0, 0]}}"#, 0.0001);
        let mut ranked = [isotropic, bare, narrow, poor, good];
        ranked.sort_by(Standing::ranked);
        assert_eq!(ranked, [good, poor, bare, narrow, isotropic]);
    }
}
