//! The fitter as the service uses it.

use std::{
    cell::RefCell,
    collections::VecDeque,
    ops::ControlFlow,
    sync::{Arc, Mutex, PoisonError},
};

use super::{
    ExportFailure, ServiceError, SubmitError,
    find_brdf::{FindBrdfError, find},
};
use crate::{
    queue::NewJob,
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

/// What the service needs of a fitter. Tests have their own.
pub(super) trait Engine: Send + Sync {
    /// Reads a recipe document and plans its job.
    fn plan(&self, document: &[u8], entry_limit: u64) -> Result<NewJob, SubmitError>;

    /// Fetches what the fit of a planned recipe needs from the store, so that its failures are told from the fit's.
    fn prepare(&self, _recipe: &str) -> Result<(), StoreError> {
        Ok(())
    }

    /// The expected duration of the fit of a planned recipe, on one thread of the cost model's machine, and its
    /// expected error, with the solver; `None` for a recipe that this engine does not fit.
    fn expect(&self, recipe: &str) -> Option<(Solver, Expectation)>;

    /// Fits one shard of a planned recipe. `on_progress` is called with the number of entries done and may stop the
    /// fit, whose result is then `None`.
    fn fit_shard(
        &self,
        recipe: &str,
        shard: u32,
        on_progress: &mut dyn FnMut(u64) -> ControlFlow<()>,
    ) -> Result<Option<Vec<u8>>, String>;

    /// Begins to put together the table of a recipe.
    fn assembly(&self, recipe: &str) -> Result<Box<dyn Assembly>, String>;

    /// The canonical recipe of a canonical file, and its digest; `None` for any other bytes.
    fn recognise(&self, file: &[u8]) -> Option<(String, Digest)>;

    /// The manifest of a canonical file; `None` as soon as `go_on` says no. Measures the table on the current rayon pool.
    fn manifest(&self, file: &[u8], go_on: &GoOn) -> Result<Option<String>, TableFileError>;

    /// The exports for which the table of a canonical file has the layout.
    fn exports(&self, file: &[u8]) -> Result<Vec<Export>, ExportFailure>;

    /// The files of an export of a canonical file, whose manifest tells how good it is.
    fn export(&self, file: &[u8], manifest: &str, export: Export) -> Result<Bundle, ExportFailure>;
}

/// A table that is put together of its shards' results, which need not be in memory at the same time.
pub(super) trait Assembly {
    /// Adds the result of the next shard.
    fn add(&mut self, result: &[u8]);

    /// The canonical file of the table, or what is wrong with the first result that is none.
    fn file(self: Box<Self>) -> Result<Vec<u8>, String>;
}

/// The fitter of this crate.
#[derive(Debug, Default)]
pub(super) struct FitEngine {
    /// The plans of the recipes that were used last, the latest first.
    latest: Mutex<VecDeque<(String, Arc<Plan>)>>,
    /// Where the files of tabulated BRDFs are; without it, there are none.
    blobs: Option<Arc<dyn Blobs>>,
}

/// Plans that are kept, at most: jobs take turns shard by shard.
const PLANS: usize = 16;
/// Of these, plans with the file of a tabulated BRDF, at most: each may take 64 MiB.
const PLANS_WITH_FILES: usize = 4;

/// Why there is no plan with all that it needs.
enum PlanError {
    Failed(String),
    Store(StoreError),
}

impl FitEngine {
    /// The engine of a service whose files of tabulated BRDFs are in `blobs`.
    pub(super) fn on(blobs: Arc<dyn Blobs>) -> Self {
        Self { blobs: Some(blobs), ..Self::default() }
    }

    /// The plan of a stored recipe, with the file of a tabulated BRDF.
    fn plan_of(&self, document: &str) -> Result<Arc<Plan>, String> {
        self.complete(document).map_err(|error| match error {
            PlanError::Failed(text) => text,
            PlanError::Store(error) => error.to_string(),
        })
    }

    fn complete(&self, document: &str) -> Result<Arc<Plan>, PlanError> {
        let plan = self.planned(document).map_err(PlanError::Failed)?;
        let Some(name) = plan.recipe().model().file().filter(|file| file.data().is_none()) else { return Ok(plan) };
        let file = self.file(&name.to_string()).map_err(|error| match error {
            FindBrdfError::Store(error) => PlanError::Store(error),
            FindBrdfError::Faults(faults) => PlanError::Failed(format!("its tabulated BRDF: {}", faults.join("; "))),
        })?;
        let plan = Arc::new(Plan::new(&Recipe { brdf: BrdfModel::tabulated(file), ..plan.recipe().clone() }));
        let mut latest = self.latest.lock().unwrap_or_else(PoisonError::into_inner);
        latest.retain(|(of, _)| of != document);
        latest.push_front((document.to_owned(), Arc::clone(&plan)));
        let mut with_files = 0;
        latest.retain(|(_, plan)| {
            with_files += usize::from(plan.recipe().model().file().is_some_and(|file| file.data().is_some()));
            with_files <= PLANS_WITH_FILES || plan.recipe().model().file().is_none()
        });
        latest.truncate(PLANS);
        Ok(plan)
    }

    /// The file of a tabulated BRDF, from a plan in memory or from the store.
    fn file(&self, name: &str) -> Result<TabulatedFile, FindBrdfError> {
        let kept = {
            let latest = self.latest.lock().unwrap_or_else(PoisonError::into_inner);
            let files = latest.iter().filter_map(|(_, plan)| plan.recipe().model().file());
            files.filter(|file| file.data().is_some()).find(|file| file.to_string() == name).cloned()
        };
        match (kept, &self.blobs) {
            (Some(file), _) => Ok(file),
            (None, Some(blobs)) => find(blobs.as_ref(), name),
            (None, None) => Err(FindBrdfError::Faults(vec!["no files of BRDFs are stored here".to_owned()])),
        }
    }

    /// The plan of a stored recipe. The file of a tabulated BRDF may be missing in it.
    fn planned(&self, document: &str) -> Result<Arc<Plan>, String> {
        let mut latest = self.latest.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(found) = latest.iter().position(|(of, _)| of == document) {
            latest.make_contiguous()[..=found].rotate_right(1);
            return Ok(Arc::clone(&latest[0].1));
        }
        // It was checked when it was submitted.
        let parsed = recipe_document::parse_stored(document.as_bytes())
            .map_err(|error| format!("the stored recipe: {error}"))?;
        if parsed.fitter != FITTER_VERSION {
            // Shards of two fitters must not be mixed in one table.
            return Err(format!(
                "the recipe is for fitter {}, and this is fitter {FITTER_VERSION}; submit the recipe again",
                parsed.fitter
            ));
        }
        let plan = Arc::new(Plan::new(&parsed));
        latest.push_front((document.to_owned(), Arc::clone(&plan)));
        latest.truncate(PLANS);
        Ok(plan)
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

/// The entries of a plan so far.
struct FitAssembly {
    plan: Arc<Plan>,
    /// The next shard.
    shard: u32,
    fitted: Result<Vec<FittedEntry>, String>,
}

impl Assembly for FitAssembly {
    fn add(&mut self, result: &[u8]) {
        let shard = self.shard;
        self.shard += 1;
        let Ok(all) = &mut self.fitted else { return };
        match fit::shard_from_bytes(result, entries(&self.plan, shard)) {
            Ok(fitted) => all.extend(fitted),
            Err(error) => self.fitted = Err(format!("shard {shard}: {error}")),
        }
    }

    fn file(self: Box<Self>) -> Result<Vec<u8>, String> {
        let table = fit::assemble(&self.plan, &self.fitted?);
        let file = container::encode(self.plan.recipe(), &table).map_err(|error| error.to_string())?;
        // A file that cannot be read back is not stored.
        container::decode(&file).map_err(|error| error.to_string())?;
        Ok(file)
    }
}

impl Engine for FitEngine {
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
        Ok(NewJob { recipe_digest: Digest::of(text.as_bytes()), recipe: text, shard_entries })
    }

    fn expect(&self, recipe: &str) -> Option<(Solver, Expectation)> {
        let plan = self.planned(recipe).ok()?;
        Some((plan.recipe().fit().solver, fit::expectation(plan.recipe())))
    }

    fn prepare(&self, recipe: &str) -> Result<(), StoreError> {
        match self.complete(recipe) {
            Err(PlanError::Store(error)) => Err(error),
            // What else is wrong, the fit tells.
            Err(PlanError::Failed(_)) | Ok(_) => Ok(()),
        }
    }

    fn fit_shard(
        &self,
        recipe: &str,
        shard: u32,
        on_progress: &mut dyn FnMut(u64) -> ControlFlow<()>,
    ) -> Result<Option<Vec<u8>>, String> {
        let plan = self.plan_of(recipe)?;
        Ok(fit::fit_shard(&plan, shard, on_progress).map(|entries| fit::shard_to_bytes(&entries)))
    }

    fn assembly(&self, recipe: &str) -> Result<Box<dyn Assembly>, String> {
        let plan = self.plan_of(recipe)?;
        let all = Vec::with_capacity((0..plan.shards()).map(|shard| entries(&plan, shard)).sum());
        Ok(Box::new(FitAssembly { plan, shard: 0, fitted: Ok(all) }))
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
        let engine = FitEngine::default();
        let job = engine.plan(br#"{"range": {"phi": [0, 0]}}"#, 10_000).expect("a recipe");
        let older = job.recipe.replace(&format!("\"fitter\":{FITTER_VERSION}"), "\"fitter\":1");
        assert_ne!(older, job.recipe);
        assert!(engine.expect(&job.recipe).is_some_and(|(_, expected)| expected.seconds > 0.0 && expected.error > 0.0));
        assert_eq!(engine.expect(&older), None);
        let error = engine.fit_shard(&older, 0, &mut |_| ControlFlow::Continue(())).expect_err("another fitter's");
        assert!(error.contains("submit the recipe again"), "{error}");
    }
}
