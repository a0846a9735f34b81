//! Migrations of the schema in sled. Each migration is applied once, in order.
//!
//! Invariant: an applied migration never changes. Its digest is stored and compared at every start. Every change can be
//! repeated, so a migration is applied again if a crash interrupted it.

use serde::Deserialize;
use serde_json::json;

use super::{
    OpenError,
    seal::{seal, unseal},
};
use ltcforge_files::digest::Digest;

/// All migrations, oldest first. Migration N has index N - 1.
pub(super) const ALL: &[&str] = &[include_str!("../migrations/0001_initial.json")];

/// The tree that records the applied migrations.
const RECORD: &str = "migrations";

#[derive(Deserialize)]
struct Applied {
    digest: Digest,
}

/// The numbers and digests of the applied migrations, in order.
fn applied(record: &sled::Tree) -> Result<Vec<(u32, Digest)>, OpenError> {
    let entry = |row: sled::Result<(sled::IVec, sled::IVec)>| {
        let (key, sealed) = row?;
        let number = key.as_ref().try_into().map(u32::from_be_bytes).ok();
        let applied = unseal(RECORD, &key, &sealed).and_then(|value| serde_json::from_slice::<Applied>(&value).ok());
        number.zip(applied).map(|(number, applied)| (number, applied.digest)).ok_or_else(other)
    };
    record.iter().map(entry).collect()
}

fn other() -> OpenError {
    OpenError::Damaged("its record of migrations is damaged, or an unreleased version wrote it".to_owned())
}

/// Records the migrations that are not recorded yet. They only create trees, which already happens when the database is
/// opened. An empty record is an error unless the database is new.
///
/// # Errors
/// When the database is newer than `migrations`, when other migrations were applied to it, or when it fails.
pub(super) fn apply(db: &sled::Db, is_new: bool, migrations: &[&str]) -> Result<(), OpenError> {
    let known = u32::try_from(migrations.len()).unwrap_or(u32::MAX);
    let record = db.open_tree(RECORD)?;
    let applied = applied(&record)?;
    let is_ours = |((number, text), (found, digest)): ((u32, &&str), &(u32, Digest))| {
        number == *found && *digest == Digest::of(text.as_bytes())
    };
    if !(1..).zip(migrations).zip(&applied).all(is_ours) || (applied.is_empty() && !is_new) {
        return Err(other());
    }
    if let Some((found, _)) = applied.last().filter(|(found, _)| *found > known) {
        return Err(OpenError::FromTheFuture { found: *found, known });
    }
    for (number, text) in (1_u32..).zip(migrations).skip(applied.len()) {
        let (key, digest) = (number.to_be_bytes(), Digest::of(text.as_bytes()));
        record.insert(key, seal(RECORD, &key, json!({ "digest": digest }).to_string().as_bytes()))?;
        db.flush()?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    const ONE: &str = r#"{"about": "one", "steps": [{"create": "a"}]}"#;
    const TWO: &str = r#"{"about": "two", "steps": [{"create": "b"}]}"#;

    #[test]
    fn migrations_are_applied_once_and_newer_and_changed_ones_are_told_apart() {
        let dir = tempfile::tempdir().unwrap();
        let db = sled::open(dir.path()).unwrap();
        assert!(matches!(apply(&db, false, &[ONE]), Err(OpenError::Damaged(_))), "not new, and without a record");
        apply(&db, true, &[ONE]).unwrap();
        apply(&db, false, &[ONE, TWO]).unwrap();
        apply(&db, false, &[ONE, TWO]).unwrap();
        let newer = apply(&db, false, &[ONE]);
        assert!(matches!(newer, Err(OpenError::FromTheFuture { found: 2, known: 1 })));
        assert!(matches!(apply(&db, false, &[TWO]), Err(OpenError::Damaged(_))));
    }

    /// An applied migration never changes. Add a new file instead, and its digest here.
    #[test]
    fn released_migrations_have_not_changed() {
        let digests: Vec<_> = ALL.iter().map(|text| Digest::of(text.as_bytes()).hex()).collect();
        assert_eq!(digests, ["8dcc56fb51f422e652a15c073397a264dfd950bf2e56105d8991b715bdde8374"]);
    }
}
