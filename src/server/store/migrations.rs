//! Changes of the on-disk schema, each applied once, in order.
//!
//! Invariant: an applied migration never changes; its digest is stored and compared at every start. Each change of a
//! migration can be repeated, so a migration that a crash interrupted is applied again.

use serde::{Deserialize, Serialize};

use super::rows;
use ltcforge_files::digest::Digest;

/// All migrations, oldest first: number N is at index N - 1.
pub(super) const ALL: &[&str] = &[
    include_str!("../migrations/0001_initial.json"),
    include_str!("../migrations/0002_manifests.json"),
    include_str!("../migrations/0003_journal.json"),
    include_str!("../migrations/0004_revisions.json"),
    include_str!("../migrations/0005_journal_alone.json"),
    include_str!("../migrations/0006_uses.json"),
];

/// The migration from which on jobs have a journal.
pub(super) const WITH_JOURNAL: usize = 3;

/// Bytes of the revision in front of a job that an earlier version stored in the database.
pub(super) const REVISION_BYTES: usize = 8;

/// The tree that records the applied migrations.
const RECORD: &str = "migrations";

/// Why the schema cannot be brought up to date.
#[derive(Debug, thiserror::Error)]
pub(super) enum MigrationError {
    /// The store is of a later schema than this program knows.
    #[error("the store has schema {found}; this program knows schemas up to {known}")]
    FromTheFuture { found: u32, known: u32 },
    /// A migration differs from the one that was applied.
    #[error("migration {0} differs from the one that was applied to this store")]
    Changed(u32),
    /// A migration of this program is not well formed.
    #[error("migration {number} cannot be read: {reason}")]
    Malformed { number: u32, reason: String },
    /// The database failed.
    #[error(transparent)]
    Sled(#[from] sled::Error),
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Migration {
    /// Its purpose.
    #[serde(rename = "about")]
    _about: String,
    #[serde(rename = "steps")]
    changes: Vec<SchemaChange>,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
enum SchemaChange {
    /// Creates an empty tree.
    Create(String),
    /// Moves all rows of a tree to a tree of another name, and puts revision 0 in front of each value.
    Number { from: String, to: String },
    /// Removes a tree with its rows.
    Drop(String),
}

#[derive(Debug, Serialize, Deserialize)]
struct Applied {
    digest: Digest,
}

/// Applies those of `migrations` that were not applied to `db` yet. Returns how many.
///
/// # Errors
/// When the store is newer than `migrations`, had different ones applied, or fails.
pub(super) fn apply(db: &sled::Db, migrations: &[&str]) -> Result<usize, MigrationError> {
    let record = db.open_tree(RECORD)?;
    let known = u32::try_from(migrations.len()).unwrap_or(u32::MAX);
    let newest = record.last()?.and_then(|(key, _)| Some(u32::from_be_bytes(key.as_ref().try_into().ok()?)));
    if let Some(found) = newest.filter(|found| *found > known) {
        return Err(MigrationError::FromTheFuture { found, known });
    }
    let mut applied = 0;
    for (number, text) in (1_u32..).zip(migrations) {
        let key = number.to_be_bytes();
        let digest = Digest::of(text.as_bytes());
        if let Some(sealed) = record.get(key)? {
            let applied_before = rows::unseal(RECORD, &key, &sealed)
                .and_then(|value| serde_json::from_slice::<Applied>(&value).ok())
                .ok_or(sled::Error::Corruption { at: None, bt: () })?;
            if applied_before.digest != digest {
                return Err(MigrationError::Changed(number));
            }
        } else {
            let malformed =
                |reason: serde_json::Error| MigrationError::Malformed { number, reason: reason.to_string() };
            let migration: Migration = serde_json::from_str(text).map_err(malformed)?;
            for change in &migration.changes {
                change.apply(db)?;
            }
            let value = serde_json::to_vec(&Applied { digest }).map_err(malformed)?;
            record.insert(key, rows::seal(RECORD, &key, &value))?;
            db.flush()?;
            applied += 1;
        }
    }
    Ok(applied)
}

impl SchemaChange {
    fn apply(&self, db: &sled::Db) -> Result<(), sled::Error> {
        match self {
            Self::Create(name) => db.open_tree(name).map(drop),
            Self::Drop(name) => db.drop_tree(name).map(drop),
            Self::Number { from, to } => number_rows(db, from, to),
        }
    }
}

/// Moves all rows of the tree `from` to the tree `to`, with revision 0. A damaged row stays damaged.
fn number_rows(db: &sled::Db, from: &str, to: &str) -> Result<(), sled::Error> {
    let (old, new) = (db.open_tree(from)?, db.open_tree(to)?);
    for row in &old {
        let (key, sealed) = row?;
        // The hash in front of a value covers the tree's name.
        match rows::unseal(from, &key, &sealed) {
            Some(value) => new.insert(&key, rows::seal(to, &key, &[&[0; REVISION_BYTES], &value[..]].concat()))?,
            None => new.insert(&key, sealed)?,
        };
    }
    db.flush()?;
    drop(old);
    db.drop_tree(from).map(drop)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::store::{Tree, sled_rows::open_sled};

    const CREATE: &str = r#"{"about": "one", "steps": [{"create": "old"}, {"create": "useless"}]}"#;
    const NUMBER: &str =
        r#"{"about": "two", "steps": [{"number": {"from": "old", "to": "new"}}, {"drop": "useless"}]}"#;

    fn names(db: &sled::Db) -> Vec<String> {
        let mut names: Vec<_> = db.tree_names().iter().map(|name| String::from_utf8_lossy(name).into_owned()).collect();
        names.retain(|name| name != RECORD && !name.starts_with("__sled"));
        names.sort();
        names
    }

    #[test]
    fn every_earlier_schema_is_brought_up_to_date() {
        for version in 0..=ALL.len() {
            let dir = tempfile::tempdir().unwrap();
            let db = open_sled(dir.path()).unwrap();
            assert_eq!(apply(&db, &ALL[..version]).unwrap(), version);
            drop(db);
            let db = open_sled(dir.path()).unwrap();
            assert_eq!(apply(&db, ALL).unwrap(), ALL.len() - version);
            assert_eq!(apply(&db, ALL).unwrap(), 0);
            let mut wanted: Vec<_> = Tree::ALL.iter().map(|tree| tree.name().to_owned()).collect();
            wanted.sort();
            assert_eq!(names(&db), wanted, "from version {version}");
        }
    }

    #[test]
    fn numbered_rows_have_revision_0_once_even_after_a_crash_and_damaged_ones_stay_damaged() {
        let dir = tempfile::tempdir().unwrap();
        let db = open_sled(dir.path()).unwrap();
        apply(&db, &[CREATE]).unwrap();
        let old = db.open_tree("old").unwrap();
        for key in [b"a", b"b"] {
            old.insert(key, rows::seal("old", key, b"value")).unwrap();
        }
        old.insert(b"c", b"12345678another").unwrap();
        // The crash: one row was moved, and nothing was recorded.
        db.open_tree("new").unwrap().insert(b"a", rows::seal("new", b"a", b"\0\0\0\0\0\0\0\0value")).unwrap();
        drop(old);
        assert_eq!(apply(&db, &[CREATE, NUMBER]).unwrap(), 1);
        assert_eq!(names(&db), ["new"]);
        let value = |key: &[u8]| rows::unseal("new", key, &db.open_tree("new").unwrap().get(key).unwrap().unwrap());
        for key in [b"a", b"b"] {
            assert_eq!(value(key).unwrap(), b"\0\0\0\0\0\0\0\0value");
        }
        assert_eq!(value(b"c"), None);
    }

    #[test]
    fn a_newer_store_and_a_changed_migration_are_refused() {
        let dir = tempfile::tempdir().unwrap();
        let db = open_sled(dir.path()).unwrap();
        apply(&db, &[CREATE, NUMBER]).unwrap();
        assert!(matches!(apply(&db, &[CREATE]), Err(MigrationError::FromTheFuture { found: 2, known: 1 })));
        let edited = NUMBER.replace("two", "2");
        assert!(matches!(apply(&db, &[CREATE, &edited]), Err(MigrationError::Changed(2))));
    }

    /// An applied migration never changes. Add a new file instead, and its digest here.
    #[test]
    fn released_migrations_have_not_changed() {
        let digests: Vec<_> = ALL.iter().map(|text| Digest::of(text.as_bytes()).hex()).collect();
        let released = [
            "d6f4a993fc81717fc255956392ce5166714f28cfcf23a5156073a2fdbb566eb9",
            "aa98c8f367c15a579372af5582546b03d64f3c596dcf530b71736772cf48480c",
            "dbc16aa4beab189c92db9c04b2c5c3b160f0806d3bdb5bf23a62c7b6c63d4d5a",
            "8930f66c14094e34d5e00865f1d3e734d9e5456dce0b9c992caa8dfec3c420e6",
            "ceddb31a710d744eec72fe9348157ecf5d2ad0d351eeff5d7016be379200c79a",
            "7fffc9ecc3a5a6069fae6cf2cc6998e842610afa6c5fb5fe9c68dd784edfb489",
        ];
        assert_eq!(digests, released);
    }
}
