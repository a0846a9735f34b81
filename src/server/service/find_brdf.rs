//! The file of the tabulated BRDF that a recipe names.

use std::collections::BTreeSet;

use crate::{
    queue::{Queue, StateName},
    store::{Blobs, Catalogue, StoreError},
};
use ltcforge_files::{
    digest::Digest,
    tabulated::{TabulatedError, decode},
};
use ltcforge_fit::TabulatedFile;

/// Why the file that a recipe names was not found.
#[derive(Debug)]
pub(super) enum FindBrdfError {
    /// The file is missing or is no tabulated BRDF: every fault.
    Faults(Vec<String>),
    /// The store failed, which says nothing of the file.
    Store(StoreError),
}

impl FindBrdfError {
    /// The faults, one a line.
    pub(super) fn lines(self) -> Vec<String> {
        match self {
            Self::Faults(faults) => faults,
            Self::Store(error) => vec![error.to_string()],
        }
    }
}

/// The stored file of a name, which has to be a digest.
pub(super) fn find(blobs: &dyn Blobs, name: &str) -> Result<TabulatedFile, FindBrdfError> {
    let fault = |fault: String| FindBrdfError::Faults(vec![fault]);
    let digest: Digest = name.parse().map_err(|_| {
        fault(format!(
            "{name:?} is not a digest: send the file to /v1/brdfs, and name the digest that is answered, sha256:<64 hex digits>"
        ))
    })?;
    let bytes = blobs.get(digest).map_err(FindBrdfError::Store)?;
    let bytes = bytes.ok_or_else(|| fault(format!("no BRDF {digest} is stored: send its file to /v1/brdfs first")))?;
    decode(&bytes).map_err(|TabulatedError(faults)| FindBrdfError::Faults(faults))
}

/// The file that a canonical recipe names.
pub(super) fn named_in(recipe: &str) -> Option<Digest> {
    let recipe: serde_json::Value = serde_json::from_str(recipe).ok()?;
    recipe.get("tabulated")?.as_str()?.parse().ok()
}

/// The tabulated BRDFs that are named by recipes of tables and of queued or running jobs.
pub(super) fn used_brdfs(catalogue: &Catalogue, queue: &dyn Queue) -> Result<BTreeSet<Digest>, StoreError> {
    let mut used: BTreeSet<Digest> = catalogue.recipes()?.iter().filter_map(|recipe| named_in(recipe)).collect();
    used.extend(named_in_unfinished(queue)?);
    Ok(used)
}

/// Those that are named by recipes of queued or running jobs, as often as they are.
pub(super) fn named_in_unfinished(queue: &dyn Queue) -> Result<Vec<Digest>, StoreError> {
    let mut named = Vec::new();
    for state in [StateName::Queued, StateName::Running] {
        let (jobs, _) = queue.list(Some(state), None, usize::MAX >> 1)?;
        named.extend(jobs.iter().filter_map(|job| named_in(&job.recipe)));
    }
    Ok(named)
}
