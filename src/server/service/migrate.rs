//! Copying a data folder's tables and jobs into a shared database and blob store.

use std::sync::Arc;

use serde::Serialize;
use serde_json::Value;

use super::{Config, OpenError, Shared, find_brdf::named_in, light_textures::LIGHT_TEXTURE_START, open::limits};
use crate::{
    queue::{
        embedded::{stored_jobs, stored_results},
        postgres::{PostgresQueue, Process},
    },
    store::{
        Access, Batch, BlobInfo, Blobs as _, Catalogue, ObjectBlobs, PostgresRows, Row, Rows as _, Store, StoreError,
        Tree,
    },
};
use ltcforge_fit::FITTER_VERSION;
use ltcforge_textures::is_light_texture;

/// Counts of the copied items, without those that were there already.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize)]
pub struct Migrated {
    /// Tables, with recipe and manifest.
    pub tables: usize,
    /// Tables that were not copied because their file is missing or damaged.
    pub missing: usize,
    /// Jobs.
    pub jobs: usize,
    /// Their finished shards.
    pub shards: usize,
}

/// The fitter version of a stored recipe. It may be an older one, and only workers of that version go on with the job.
fn fitter_of(recipe: &str) -> u32 {
    let fitter = serde_json::from_str::<Value>(recipe).ok().and_then(|recipe| recipe.get("fitter")?.as_u64());
    fitter.and_then(|fitter| fitter.try_into().ok()).unwrap_or(FITTER_VERSION)
}

/// Copies the tables, their pins, and the jobs of a data folder. The folder is locked meanwhile and does not change. What was copied
/// before is skipped, so that an interrupted migration can be run again.
///
/// # Errors
/// When the folder is in use or has no store, or the database or the blob store cannot be used.
pub fn migrate(config: &Config, shared: &Shared) -> Result<Migrated, OpenError> {
    let folder = &config.data_dir;
    if !folder.join("db").is_dir() {
        return Err(OpenError::NoStore(folder.clone()));
    }
    let store = Store::open(folder).map_err(|error| OpenError::of(folder, error))?;
    let (database, blobs) = shared.open(config, Access::Write)?;
    database.without_limit();
    let process = Process { name: "migrate".to_owned(), fitter: FITTER_VERSION };
    let queue = PostgresQueue::open(Arc::clone(&database), limits(config), process).map_err(OpenError::Shared)?;
    let to = Arc::new(PostgresRows::new(database));
    let mut done = Migrated::default();
    (|| -> Result<(), StoreError> {
        let (from, known) = (Catalogue::new(Arc::clone(&store.rows)), Catalogue::new(Arc::clone(&to) as _));
        let mut cursor = None;
        loop {
            let (tables, next) = from.page(cursor.as_deref(), 64)?;
            for row in tables {
                if known.table(row.digest)?.is_some() && blobs.contains(row.digest)? {
                    continue;
                }
                let (Ok(Some(file)), Some((recipe, _))) =
                    (store.blobs.get(row.digest), from.recipe(row.recipe_digest)?)
                else {
                    done.missing += 1;
                    continue;
                };
                blobs.put(&file)?;
                copy_brdf(&store, &blobs, &recipe)?;
                let mut batch = Catalogue::entry(&row, &recipe)?;
                let manifest = from.manifest(row.digest)?;
                batch.extend(
                    manifest
                        .map_or(Ok(Batch::default()), |manifest| Catalogue::manifest_entry(row.digest, &manifest))?,
                );
                to.commit(&batch)?;
                done.tables += 1;
            }
            cursor = next;
            if cursor.is_none() {
                break;
            }
        }
        let mut pins = Batch::default();
        for Row { key, value } in store.rows.scan(Tree::Pins, &[])? {
            if let Some(value) = value {
                pins.put(Tree::Pins, key, value);
            }
        }
        to.commit(&pins)?;
        for stored in stored_jobs(store.rows.as_ref())? {
            copy_brdf(&store, &blobs, &stored.job.recipe)?;
            let results = stored_results(store.rows.as_ref(), stored.job.id)?;
            if queue.import(&stored.job, fitter_of(&stored.job.recipe), &stored.shard_entries, &results)? {
                done.jobs += 1;
                done.shards += results.len();
            }
        }
        copy_light_textures(&store, &blobs)
    })()
    .map_err(OpenError::Shared)?;
    Ok(done)
}

/// Copies the tabulated BRDF that the recipe names, if it names one and the file is not missing or damaged.
fn copy_brdf(from: &Store, to: &ObjectBlobs, recipe: &str) -> Result<(), StoreError> {
    if let Some(digest) = named_in(recipe)
        && !to.contains(digest)?
        && let Ok(Some(file)) = from.blobs.get(digest)
    {
        to.put(&file)?;
    }
    Ok(())
}

/// Copies the prefiltered pictures of lights that are not damaged. Nothing names them.
fn copy_light_textures(from: &Store, to: &ObjectBlobs) -> Result<(), StoreError> {
    for BlobInfo { digest, .. } in from.blobs.list()? {
        let is_wanted = from.blobs.part(digest, 0, LIGHT_TEXTURE_START)?.is_some_and(|start| is_light_texture(&start));
        if is_wanted
            && !to.contains(digest)?
            && let Ok(Some(file)) = from.blobs.get(digest)
        {
            to.put(&file)?;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_recipe_names_its_fitter() {
        assert_eq!(fitter_of(r#"{"fitter":1,"preset":"paper"}"#), 1);
        assert_eq!(fitter_of("damaged"), FITTER_VERSION);
    }
}
