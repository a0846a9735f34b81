//! The fitter as the service uses it.

use std::{cell::RefCell, ops::ControlFlow, sync::Arc};

use quick_cache::sync::Cache;

use super::{
    ExportFailure, ServiceError, SubmitError,
    find_brdf::{FindBrdfError, find},
};
use crate::{
    queue::{Job, LeasedTask, NewJob},
    store::{Blobs, StoreError},
};
use ltcforge_files::{
    container::{self, TableFile, TableFileError},
    digest::Digest,
    manifest::{manifest_json_while, mean_error},
    recipe_document,
};
use ltcforge_fit::{
    self as fit, BrdfModel, Expectation, FITTER_VERSION, FittedEntry, GoOn, Plan, Recipe, Solver, TabulatedFile,
};
use ltcforge_textures::{About, Bundle, Export};

/// A fitter, as far as the service needs one. Tests have their own.
pub(super) trait Backend: Send + Sync {
    /// Reads a recipe document and plans its job.
    fn plan(&self, document: &[u8], entry_limit: u64) -> Result<NewJob, SubmitError>;

    /// The plan of a stored recipe, with all that its fit needs from the store.
    fn load(&self, recipe: StoredRecipe<'_>) -> Result<Arc<dyn PlannedFit>, PlanError>;

    /// What is expected of the fit of a stored recipe; `None` for a recipe that this backend does not fit.
    fn expect(&self, recipe: StoredRecipe<'_>) -> Option<ExpectedFit>;

    /// The canonical recipe of a canonical file, and its digest; `None` for any other bytes.
    fn recognise(&self, file: &[u8]) -> Option<(String, Digest)>;

    /// The manifest of a canonical file; `None` as soon as `go_on` says no. Measures the table on the current rayon
    /// pool.
    fn manifest(&self, file: &[u8], go_on: &GoOn) -> Result<Option<String>, TableFileError>;

    /// Forgets the files of tabulated BRDFs that it keeps: one of them was deleted.
    fn forget_files(&self);

    /// The exports for which the table of a canonical file has the layout.
    fn exports(&self, file: &[u8]) -> Result<Vec<Export>, ExportFailure>;

    /// The files of an export of a canonical file, whose manifest tells how good it is.
    fn export(&self, file: &[u8], manifest: &str, export: Export) -> Result<Bundle, ExportFailure>;
}

/// What is expected of a fit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct ExpectedFit {
    pub(super) solver: Solver,
    /// The shards that workers take one by one.
    pub(super) shards: u32,
    /// With the seconds of one thread of the cost model's machine.
    pub(super) model: Expectation,
}

/// A recipe as it is stored: canonical JSON.
#[derive(Debug, Clone, Copy)]
pub(super) struct StoredRecipe<'a> {
    pub(super) digest: Digest,
    pub(super) text: &'a str,
}

impl<'a> From<&'a Job> for StoredRecipe<'a> {
    fn from(job: &'a Job) -> Self {
        Self { digest: job.recipe_digest, text: &job.recipe }
    }
}

impl<'a> From<&'a NewJob> for StoredRecipe<'a> {
    fn from(job: &'a NewJob) -> Self {
        Self { digest: job.recipe_digest, text: &job.recipe }
    }
}

impl<'a> From<&'a LeasedTask> for StoredRecipe<'a> {
    fn from(task: &'a LeasedTask) -> Self {
        Self { digest: task.recipe_digest, text: &task.recipe }
    }
}

/// A plan that is ready to be fitted.
pub(super) trait PlannedFit: Send + Sync {
    /// Fits one shard. `on_progress` is called with the number of entries done and may stop the fit, whose result is
    /// then `None`.
    fn fit_shard(&self, shard: u32, on_progress: &mut dyn FnMut(u64) -> ControlFlow<()>) -> Option<Vec<u8>>;

    /// Begins to put the table together.
    fn assembly(&self) -> Box<dyn Assembly + '_>;
}

/// A table that is put together of its shards' results, which need not be in memory at the same time.
pub(super) trait Assembly: Send {
    /// Adds the result of the next shard.
    fn add(&mut self, result: &[u8]);

    /// The canonical file of the table, or the fault of the first invalid result. Runs on the current rayon pool.
    fn file(self: Box<Self>) -> Result<Vec<u8>, String>;
}

/// The fitter of this crate.
pub(super) struct FitBackend {
    /// Plans by the digests of their recipes. The files of tabulated BRDFs are missing in them.
    plans: Cache<Digest, Arc<Plan>>,
    /// Files of tabulated BRDFs by their names.
    files: Cache<String, TabulatedFile>,
    /// The store of these files; `None` for a backend without files.
    blobs: Option<Arc<dyn Blobs>>,
}

/// Plans that are kept, at most: jobs are fitted shard by shard in turn.
const PLANS: usize = 16;
/// Files of tabulated BRDFs that are kept, at most: each may take 64 MiB.
const FILES: usize = 4;

/// Why there is no plan with all that it needs.
#[derive(Debug)]
pub(super) enum PlanError {
    /// The recipe cannot be fitted here.
    Failed(String),
    /// The store failed, which says nothing of the recipe.
    Store(StoreError),
}

impl FitBackend {
    /// The backend of a service whose files of tabulated BRDFs are in `blobs`.
    pub(super) fn new(blobs: Option<Arc<dyn Blobs>>) -> Self {
        Self { plans: Cache::new(PLANS), files: Cache::new(FILES), blobs }
    }

    /// The file of a tabulated BRDF.
    fn file(&self, name: &str) -> Result<TabulatedFile, FindBrdfError> {
        self.files.get_or_insert_with(name, || match &self.blobs {
            Some(blobs) => find(blobs.as_ref(), name),
            None => Err(FindBrdfError::Faults(vec!["no files of BRDFs are stored here".to_owned()])),
        })
    }

    /// The plan of a stored recipe. The file of a tabulated BRDF is missing in it.
    fn planned(&self, recipe: StoredRecipe<'_>) -> Result<Arc<Plan>, String> {
        self.plans.get_or_insert_with(&recipe.digest, || {
            // It was checked when it was submitted.
            let parsed = recipe_document::parse_stored(recipe.text.as_bytes())
                .map_err(|error| format!("the stored recipe: {error}"))?;
            if parsed.fitter != FITTER_VERSION {
                // Shards of two fitters must not be mixed in one table.
                return Err(format!(
                    "the recipe is for fitter {}, and this is fitter {FITTER_VERSION}; submit the recipe again",
                    parsed.fitter
                ));
            }
            Ok(Arc::new(Plan::new(&parsed)))
        })
    }
}

/// Entries of a table, at most, that is exported: 24 MB of numbers, of which a text takes five times as many bytes.
const MOST_EXPORTED: usize = 500_000;

fn unreadable(error: impl std::fmt::Display) -> ExportFailure {
    ServiceError::Storage(error.to_string()).into()
}

fn entries(plan: &Plan, shard: u32) -> usize {
    let range = plan.shard_entries(shard);
    usize::try_from(range.end - range.start).unwrap_or(usize::MAX)
}

impl PlannedFit for Plan {
    fn fit_shard(&self, shard: u32, on_progress: &mut dyn FnMut(u64) -> ControlFlow<()>) -> Option<Vec<u8>> {
        fit::fit_shard(self, shard, on_progress).map(|entries| fit::shard_to_bytes(&entries))
    }

    fn assembly(&self) -> Box<dyn Assembly + '_> {
        let all = Vec::with_capacity((0..self.shards()).map(|shard| entries(self, shard)).sum());
        Box::new(FitAssembly { plan: self, shard: 0, fitted: Ok(all) })
    }
}

/// The entries of a plan so far.
struct FitAssembly<'a> {
    plan: &'a Plan,
    /// The next shard.
    shard: u32,
    fitted: Result<Vec<FittedEntry>, String>,
}

impl Assembly for FitAssembly<'_> {
    fn add(&mut self, result: &[u8]) {
        let shard = self.shard;
        self.shard += 1;
        let Ok(all) = &mut self.fitted else { return };
        match fit::shard_from_bytes(self.plan, shard, result) {
            Ok(fitted) => all.extend(fitted),
            Err(error) => self.fitted = Err(format!("shard {shard}: {error}")),
        }
    }

    fn file(self: Box<Self>) -> Result<Vec<u8>, String> {
        let table = fit::assemble(self.plan, &self.fitted?);
        let file = container::encode(self.plan.recipe(), &table).map_err(|error| error.to_string())?;
        // A file that cannot be read back is not stored.
        container::decode(&file).map_err(|error| error.to_string())?;
        Ok(file)
    }
}

impl Backend for FitBackend {
    fn plan(&self, document: &[u8], entry_limit: u64) -> Result<NewJob, SubmitError> {
        let failed = RefCell::new(None);
        let find = |name: &str| {
            self.file(name).map_err(|error| match error {
                FindBrdfError::Faults(faults) => faults,
                FindBrdfError::Store(error) => {
                    let lines = vec![error.to_string()];
                    failed.replace(Some(error));
                    lines
                }
            })
        };
        let parsed = recipe_document::parse_with(document, entry_limit, &find);
        if let Some(error) = failed.into_inner() {
            return Err(ServiceError::from(error).into());
        }
        let parsed = parsed?;
        let plan = Plan::new(&parsed);
        let shard_entries = (0..plan.shards()).map(|n| u32::try_from(entries(&plan, n)).unwrap_or(u32::MAX)).collect();
        let text = recipe_document::canonical_json(&parsed);
        Ok(NewJob { recipe_digest: Digest::of(text.as_bytes()), recipe: text, shard_entries, by: None })
    }

    fn load(&self, recipe: StoredRecipe<'_>) -> Result<Arc<dyn PlannedFit>, PlanError> {
        let plan = self.planned(recipe).map_err(PlanError::Failed)?;
        let Some(name) = plan.recipe().model().file() else { return Ok(plan) };
        let file = self.file(&name.to_string()).map_err(|error| match error {
            FindBrdfError::Store(error) => PlanError::Store(error),
            FindBrdfError::Faults(faults) => PlanError::Failed(format!("its tabulated BRDF: {}", faults.join("; "))),
        })?;
        Ok(Arc::new(Plan::new(&Recipe { brdf: BrdfModel::tabulated(file), ..plan.recipe().clone() })))
    }

    fn expect(&self, recipe: StoredRecipe<'_>) -> Option<ExpectedFit> {
        let plan = self.planned(recipe).ok()?;
        let (solver, model) = (plan.recipe().fit().solver, fit::expectation(plan.recipe()));
        Some(ExpectedFit { solver, shards: plan.shards(), model })
    }

    fn recognise(&self, file: &[u8]) -> Option<(String, Digest)> {
        let table = container::decode(file).ok()?;
        let text = recipe_document::canonical_json(&table.recipe);
        let digest = Digest::of(text.as_bytes());
        Some((text, digest))
    }

    fn manifest(&self, file: &[u8], go_on: &GoOn) -> Result<Option<String>, TableFileError> {
        manifest_json_while(go_on, file, &|name| self.file(name).map_err(FindBrdfError::lines))
    }

    fn forget_files(&self) {
        self.files.clear();
    }

    fn exports(&self, file: &[u8]) -> Result<Vec<Export>, ExportFailure> {
        let table = container::decode(file).map_err(unreadable)?.table;
        Ok(Export::all().filter(|export| export.layout(&table).is_ok()).collect())
    }

    fn export(&self, file: &[u8], manifest: &str, export: Export) -> Result<Bundle, ExportFailure> {
        let TableFile { table, recipe } = container::decode(file).map_err(unreadable)?;
        let entries = table.matrix.len();
        if entries > MOST_EXPORTED {
            return Err(ExportFailure::TooLarge { entries, limit: MOST_EXPORTED });
        }
        let error = mean_error(manifest).map_err(unreadable)?;
        let about = About::of_table(Digest::of(file), Some(&recipe), Some(error));
        Ok(export.bundle(&table, about)?)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_job_of_another_fitter_is_not_mixed_with_this_one_s() {
        let backend = FitBackend::new(None);
        let job = backend.plan(br#"{"range": {"phi": [0, 0]}}"#, 10_000).expect("a recipe");
        let older = job.recipe.replace(&format!("\"fitter\":{FITTER_VERSION}"), "\"fitter\":1");
        assert_ne!(older, job.recipe);
        let older = StoredRecipe { digest: Digest::of(older.as_bytes()), text: &older };
        let expected = backend.expect((&job).into());
        assert!(expected.is_some_and(|fit| fit.shards as usize == job.shard_entries.len()
            && fit.model.seconds > 0.0
            && fit.model.error > 0.0));
        assert_eq!(backend.expect(older), None);
        let Err(PlanError::Failed(error)) = backend.load(older) else { panic!("it is another fitter's") };
        assert!(error.contains("submit the recipe again"), "{error}");
    }
}
