//! The identity by which a database and a store of blobs know each other.
//!
//! It is a row of the database and an object of the store, written once, when both have none.

use super::{Database, ObjectBlobs, StoreError, objects::IDENTITY};

/// Number of the advisory lock: the one of migrations is before it.
const LOCK: i64 = 0x6c74_6366_6f72_6766;

/// Why a database and a store of blobs are not used together.
#[derive(Debug, thiserror::Error)]
pub enum PairError {
    /// They have other identities.
    #[error(
        "the blob store and the database do not belong together: the store's object {IDENTITY} has {}, the database \
         has {}; if they do belong together, write the database's identity into the object, or remove the object if \
         the database has none", shown(.store.as_ref()), shown(.database.as_ref())
    )]
    Strangers {
        /// That of the store.
        store: Option<String>,
        /// That of the database.
        database: Option<String>,
    },
    /// They have no identity yet.
    #[error(
        "the blob store and the database are new to each other: start `ltcforge serve` or `ltcforge work` on them once"
    )]
    Unpaired,
    /// One of them failed.
    #[error(transparent)]
    Store(#[from] StoreError),
}

fn shown(identity: Option<&String>) -> String {
    identity.map_or_else(|| "no identity".to_owned(), |identity| format!("the identity «{identity}»"))
}

/// Checks that `database` and `blobs` have the same identity. If both have none, they get `new`; without `new`, that is
/// [`PairError::Unpaired`].
///
/// # Errors
/// See [`PairError`].
pub fn pair(database: &Database, blobs: &ObjectBlobs, new: Option<&str>) -> Result<(), PairError> {
    let (stored, known) = database.run(async |client| {
        let transaction = client.transaction().await?;
        transaction.execute("SELECT pg_advisory_xact_lock($1)", &[&LOCK]).await?;
        let select = "SELECT convert_from(value, 'UTF8') FROM ltcforge.rows WHERE tree = 'identity' AND key = ''";
        let known: Option<String> = transaction.query_opt(select, &[]).await?.map(|row| row.get(0));
        let stored = blobs.identity().await?;
        // An earlier try may have written the object.
        let (None, Some(new)) = (&known, new.filter(|new| stored.as_deref().is_none_or(|stored| stored == *new)))
        else {
            return Ok((stored, known));
        };
        let insert = "INSERT INTO ltcforge.rows (tree, key, value) VALUES ('identity', '', $1)";
        transaction.execute(insert, &[&new.as_bytes()]).await?;
        blobs.identify(new).await?;
        transaction.commit().await?;
        Ok((Some(new.to_owned()), Some(new.to_owned())))
    })?;
    match (stored, known) {
        (None, None) => Err(PairError::Unpaired),
        (store, database) if store != database => Err(PairError::Strangers { store, database }),
        _ => Ok(()),
    }
}
