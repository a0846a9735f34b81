//! Parses each recipe once, and keeps its plan under the recipe's digest.

use std::{cell::RefCell, ops::ControlFlow, sync::Arc};

use quick_cache::sync::Cache;

use super::{ExportFailure, ServiceError, SubmitError};
use crate::{
    queue::{NewJob, Shard},
    store::{Blobs, StoreError},
};
use ltcforge_files::{
    container::{self, AnyFile, LutFile, TableFile, TableFileError, decode_any, encode_lut},
    digest::Digest,
    manifest::{lut_manifest, manifest_json_while, mean_error},
    recipe_document::{self, AnyRecipe},
    tabulated::{TabulatedError, decode},
};
use ltcforge_fit::albedo::{LutPlan, MeasuredLut};
use ltcforge_fit::{self as fit, BrdfModel, Expectation, FITTER_VERSION, GoOn, Plan, Recipe, Solver, TabulatedFile};
use ltcforge_textures::{About, Bundle, Export, LutExport};

/// Number of plans that are kept in memory, because workers alternate between the shards of several jobs.
const PLANS: usize = 64;
/// Number of decoded BRDFs that are kept in memory. Each may take 64 MiB.
const BRDFS: usize = 4;
/// Maximum number of entries of an exported table. Its numbers take 24 MB, and five times as much in a text file.
const MOST_EXPORTED: usize = 500_000;

/// A parsed recipe, with its plan and its forecast.
#[derive(Debug)]
pub(super) struct PlannedRecipe {
    /// The plan, without the numbers of a tabulated BRDF.
    plan: AnyPlan,
    /// The predicted seconds on one thread of the cost model's machine, and the predicted error.
    pub(super) expectation: Expectation,
}

/// The plan of a table of either kind.
#[derive(Debug, Clone)]
pub(super) enum AnyPlan {
    /// Of a table of linearly transformed cosines.
    Ltc(Box<Plan>),
    /// Of a lookup table.
    Lut(LutPlan),
}

impl AnyPlan {
    fn entries(&self) -> u64 {
        match self {
            Self::Ltc(plan) => plan.entries(),
            Self::Lut(plan) => plan.recipe().entries(),
        }
    }

    /// Fits a shard and encodes its result; `None` if `on_progress` stops it.
    pub(super) fn fit_shard(&self, shard: u32, on_progress: &mut dyn FnMut(u64) -> ControlFlow<()>) -> Option<Vec<u8>> {
        match self {
            Self::Ltc(plan) => Some(fit::shard_to_bytes(&fit::fit_shard(plan, shard, on_progress)?)),
            Self::Lut(plan) => {
                let values = plan.fit_shard(shard, on_progress)?;
                Some(values.into_iter().flat_map(f64::to_le_bytes).collect())
            }
        }
    }
}

impl PlannedRecipe {
    /// The solver; `None` for a lookup table, which has none.
    pub(super) fn solver(&self) -> Option<Solver> {
        match &self.plan {
            AnyPlan::Ltc(plan) => Some(plan.recipe().fit().solver),
            AnyPlan::Lut(_) => None,
        }
    }

    pub(super) fn shards(&self) -> u32 {
        match &self.plan {
            AnyPlan::Ltc(plan) => plan.shards(),
            AnyPlan::Lut(plan) => plan.shards(),
        }
    }

    /// The fraction of all entries that a shard contains.
    pub(super) fn part(&self, shard: u32) -> f64 {
        let AnyPlan::Ltc(plan) = &self.plan else { return 1.0 / f64::from(self.shards()) };
        let range = plan.shard_entries(shard);
        (range.end - range.start) as f64 / self.plan.entries().max(1) as f64
    }
}

/// Why the plan of a recipe could not be loaded.
#[derive(Debug, thiserror::Error)]
pub(super) enum LoadError {
    /// The recipe cannot be fitted here.
    #[error("{0}")]
    Failed(String),
    /// The store failed. The recipe may be valid.
    #[error(transparent)]
    Store(StoreError),
}

/// Parses recipes and keeps their plans.
#[derive(Debug)]
pub(super) struct Fitter {
    plans: Cache<Digest, Arc<PlannedRecipe>>,
    brdfs: Cache<String, TabulatedFile>,
    blobs: Arc<dyn Blobs>,
}

impl Fitter {
    /// A fitter that reads BRDFs from `blobs`.
    pub(super) fn new(blobs: Arc<dyn Blobs>) -> Self {
        Self { plans: Cache::new(PLANS), brdfs: Cache::new(BRDFS), blobs }
    }

    /// Parses a recipe document, and returns its job.
    ///
    /// # Errors
    /// All faults of the document, or the store's error.
    pub(super) fn new_job(&self, document: &[u8], entry_limit: u64) -> Result<NewJob, SubmitError> {
        let failed = RefCell::new(None);
        let find = |name: &str| {
            self.brdf(name).map_err(|error| {
                let lines = error.to_string().split("; ").map(str::to_owned).collect();
                if let LoadError::Store(error) = error {
                    failed.replace(Some(error));
                }
                lines
            })
        };
        let parsed = recipe_document::parse_any(document, entry_limit, &find);
        if let Some(error) = failed.into_inner() {
            return Err(ServiceError::from(error).into());
        }
        let recipe = recipe_document::canonical_json(&parsed?);
        let recipe_digest = Digest::of(recipe.as_bytes());
        let planned = self.planned(recipe_digest, &recipe).map_err(ServiceError::Storage)?;
        let shard = |n| {
            let part = planned.part(n);
            let entries = (part * planned.plan.entries() as f64).round() as u32;
            Shard { entries, seconds: part * planned.expectation.seconds }
        };
        let shards = (0..planned.shards()).map(shard).collect();
        Ok(NewJob { recipe, recipe_digest, shards, fitter: FITTER_VERSION, submitted_by: None })
    }

    /// The plan of a canonical recipe. A recipe of another fitter version is an error.
    pub(super) fn planned(&self, digest: Digest, recipe: &str) -> Result<Arc<PlannedRecipe>, String> {
        self.plans.get_or_insert_with(&digest, || {
            let parsed = recipe_document::parse_any_stored(recipe.as_bytes())
                .map_err(|error| format!("the stored recipe is invalid: {error}"))?;
            let fitter = match &parsed {
                AnyRecipe::Ltc(recipe) => recipe.fitter,
                AnyRecipe::Lut(recipe) => recipe.fitter,
            };
            if fitter != FITTER_VERSION {
                // Shards of two fitters must not be mixed in one table.
                return Err(format!(
                    "the recipe is for fitter {fitter}, but this is fitter {FITTER_VERSION}; submit the recipe again"
                ));
            }
            Ok(Arc::new(match &parsed {
                AnyRecipe::Ltc(parsed) => {
                    let plan = AnyPlan::Ltc(Box::new(Plan::new(parsed)));
                    PlannedRecipe { plan, expectation: fit::expectation(parsed) }
                }
                AnyRecipe::Lut(recipe) => {
                    PlannedRecipe { plan: AnyPlan::Lut(LutPlan::new(recipe)), expectation: recipe.expectation() }
                }
            }))
        })
    }

    /// The plan of a canonical recipe, including the numbers of its tabulated BRDF.
    ///
    /// # Errors
    /// When the recipe is for another fitter version, or its BRDF cannot be read.
    pub(super) fn plan(&self, digest: Digest, recipe: &str) -> Result<AnyPlan, LoadError> {
        let planned = self.planned(digest, recipe).map_err(LoadError::Failed)?;
        let AnyPlan::Ltc(plan) = &planned.plan else { return Ok(planned.plan.clone()) };
        let Some(name) = plan.recipe().model().file() else { return Ok(planned.plan.clone()) };
        let brdf = BrdfModel::tabulated(self.brdf(&name.to_string())?);
        Ok(AnyPlan::Ltc(Box::new(Plan::new(&Recipe { brdf, ..plan.recipe().clone() }))))
    }

    /// The tabulated BRDF named `name`, which must be a digest.
    fn brdf(&self, name: &str) -> Result<TabulatedFile, LoadError> {
        self.brdfs.get_or_insert_with(name, || {
            let digest: Digest = name.parse().map_err(|_| {
                LoadError::Failed(format!(
                    "{name:?} is not a digest: send the file to /v1/brdfs and use the digest in the response"
                ))
            })?;
            let bytes = self.blobs.get(digest).map_err(LoadError::Store)?.ok_or_else(|| {
                LoadError::Failed(format!("no BRDF {digest} is stored: send its file to /v1/brdfs first"))
            })?;
            decode(&bytes).map_err(|TabulatedError(faults)| LoadError::Failed(faults.join("; ")))
        })
    }

    /// Removes all decoded BRDFs from memory. Called after a BRDF was deleted.
    pub(super) fn forget_brdfs(&self) {
        self.brdfs.clear();
    }

    /// The canonical recipe in a table file, and the recipe's digest. `None` if `file` is not a table.
    pub(super) fn recognise(file: &[u8]) -> Option<(String, Digest)> {
        let text = decode_any(file).ok()?.recipe_json();
        let digest = Digest::of(text.as_bytes());
        Some((text, digest))
    }

    /// Assembles the results of all shards, and returns the table's file. Runs on the current rayon pool.
    ///
    /// # Errors
    /// The first invalid result.
    pub(super) fn assemble(plan: &AnyPlan, results: &[Vec<u8>]) -> Result<Vec<u8>, String> {
        let plan = match plan {
            AnyPlan::Ltc(plan) => plan,
            AnyPlan::Lut(plan) => return assemble_lut(plan, results),
        };
        let mut fitted = Vec::new();
        for (shard, result) in (0..).zip(results) {
            fitted
                .extend(fit::shard_from_bytes(plan, shard, result).map_err(|error| format!("shard {shard}: {error}"))?);
        }
        let table = fit::assemble(plan, &fitted);
        let file = container::encode(plan.recipe(), &table).map_err(|error| error.to_string())?;
        // A file that cannot be read back is not stored.
        container::decode(&file).map_err(|error| error.to_string())?;
        Ok(file)
    }

    /// Measures a table and makes its manifest, on the current rayon pool. `None` if `go_on` stops it.
    pub(super) fn manifest(&self, file: &[u8], go_on: &GoOn) -> Result<Option<String>, TableFileError> {
        if let Ok(AnyFile::Lut(LutFile { recipe, lut })) = decode_any(file) {
            let report = MeasuredLut::new(&recipe).report(&lut);
            return lut_manifest(file, &recipe, &report)
                .map(Some)
                .map_err(|error| TableFileError::Container(error.to_string()));
        }
        manifest_json_while(go_on, file, &|name| self.brdf(name).map_err(|error| vec![error.to_string()]))
    }

    /// Decodes a table's file, and adds its tabulated BRDF if the BRDF is stored.
    pub(super) fn table(&self, digest: Digest, file: &[u8]) -> Result<TableFile, ServiceError> {
        if let Ok(AnyFile::Lut(_)) = decode_any(file) {
            return Err(ServiceError::LookupTable(digest));
        }
        let mut file =
            container::decode(file).map_err(|error| ServiceError::Storage(format!("the blob {digest}: {error}")))?;
        // A missing BRDF is an error only for callers that need it.
        let _ = file.find_brdf(&|name| self.brdf(name).map_err(|error| vec![error.to_string()]));
        Ok(file)
    }

    /// The exports that the layout of a table allows.
    pub(super) fn exports(&self, digest: Digest, file: &[u8]) -> Result<Vec<Export>, ExportFailure> {
        if let Ok(AnyFile::Lut(LutFile { recipe, .. })) = decode_any(file) {
            return Ok(LutExport::all(&recipe).map(Export::Lut).collect());
        }
        let table = self.table(digest, file)?.table;
        Ok(Export::all().filter(|export| export.layout(&table).is_ok()).collect())
    }

    /// Exports a table. Its `manifest` contains its measured error.
    pub(super) fn export(
        &self,
        digest: Digest,
        file: &[u8],
        manifest: &str,
        export: Export,
    ) -> Result<Bundle, ExportFailure> {
        if let Ok(AnyFile::Lut(of)) = decode_any(file) {
            // The same engine can have a table of either kind.
            return Ok(export.to_string().parse::<LutExport>()?.bundle(&of, digest)?);
        }
        let TableFile { table, recipe } = self.table(digest, file)?;
        let entries = table.matrix.len();
        if entries > MOST_EXPORTED {
            return Err(ExportFailure::TooLarge(entries, MOST_EXPORTED));
        }
        let error = mean_error(manifest).map_err(|error| ServiceError::Storage(error.to_string()))?;
        Ok(export.bundle(&table, About::of_table(digest, Some(&recipe), Some(error)))?)
    }
}

/// Solves for the texels of a lookup table, and returns its file.
fn assemble_lut(plan: &LutPlan, results: &[Vec<u8>]) -> Result<Vec<u8>, String> {
    let mut values = Vec::new();
    for (shard, result) in (0..).zip(results) {
        values.extend(plan.shard_from_bytes(shard, result).map_err(|error| format!("shard {shard}: {error}"))?);
    }
    let file = encode_lut(plan.recipe(), &plan.assemble(&values)).map_err(|error| error.to_string())?;
    decode_any(&file).map_err(|error| error.to_string())?;
    Ok(file)
}
