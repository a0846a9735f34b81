//! A fake backend: it counts fits, and stops or fails as a test asks.

use std::{
    collections::HashMap,
    ops::ControlFlow,
    sync::{Arc, Condvar, Mutex},
    thread,
    time::Duration,
};

use super::super::backend::{Assembly, Backend, ExpectedFit, PlanError, PlannedFit, StoredRecipe};
use crate::{
    queue::NewJob,
    service::{ExportFailure, SubmitError},
};
use ltcforge_files::{container::TableFileError, digest::Digest, recipe_document::RecipeError};
use ltcforge_fit::{Expectation, GoOn, Solver};
use ltcforge_textures::{Bundle, Engine, Export, RoundingError, TextureFile};

/// Entries of a shard.
const ENTRIES: u32 = 4;

/// How often an endless fit asks, which takes many seconds: nobody began another task meanwhile.
const MOST_ASKED: u32 = 20_000_000;

/// The behaviour of the fake backend, and a record of its calls.
#[derive(Debug, Default)]
pub(super) struct Behaviour {
    /// Fits begun, by recipe and shard.
    pub(super) begun: HashMap<(String, u32), u32>,
    /// The recipes of these fits, in the order in which they were begun.
    pub(super) order: Vec<String>,
    /// Manifests made.
    pub(super) manifests: u32,
    /// Exports begun.
    pub(super) exports: u32,
    /// Fits that end in a panic, from the first of each shard.
    pub(super) panics: u32,
    /// While set, each fit pauses after its first entry.
    pub(super) held: bool,
    /// Fits of this recipe do not get beyond their first entry; they go on asking whether to stop, [`MOST_ASKED`]
    /// times.
    pub(super) endless: Option<String>,
    /// Measuring the table of this recipe does not end.
    pub(super) endless_measure: Option<String>,
    /// How long a plan is on its way from the store.
    pub(super) loading: Duration,
    /// Endless fits that asked so often.
    pub(super) gave_up: u32,
}

#[derive(Debug, Default)]
pub(super) struct Shared {
    pub(super) behaviour: Mutex<Behaviour>,
    changed: Condvar,
}

impl Shared {
    pub(super) fn set(&self, change: impl FnOnce(&mut Behaviour)) {
        change(&mut self.behaviour.lock().unwrap());
        self.changed.notify_all();
    }

    pub(super) fn begun(&self) -> u32 {
        self.behaviour.lock().unwrap().begun.values().sum()
    }

    pub(super) fn wait_for_exports(&self, exports: u32) {
        let behaviour = self.behaviour.lock().unwrap();
        drop(self.changed.wait_while(behaviour, |b| b.exports < exports).unwrap());
    }

    pub(super) fn wait_for_manifests(&self, manifests: u32) {
        let behaviour = self.behaviour.lock().unwrap();
        drop(self.changed.wait_while(behaviour, |b| b.manifests < manifests).unwrap());
    }

    pub(super) fn wait_for_begun(&self, fits: u32) {
        let behaviour = self.behaviour.lock().unwrap();
        drop(self.changed.wait_while(behaviour, |b| b.begun.values().sum::<u32>() < fits).unwrap());
    }
}

/// A recipe is `NAME SHARDS`; its table is `TABLE NAME SHARDS` and its shards' names.
pub(super) struct FakeBackend(pub(super) Arc<Shared>);

struct FakePlan {
    recipe: String,
    shared: Arc<Shared>,
}

struct FakeAssembly(Vec<u8>);

impl Assembly for FakeAssembly {
    fn add(&mut self, result: &[u8]) {
        self.0.extend(result);
    }

    fn file(self: Box<Self>) -> Result<Vec<u8>, String> {
        Ok(self.0)
    }
}

impl PlannedFit for FakePlan {
    fn fit_shard(&self, shard: u32, on_progress: &mut dyn FnMut(u64) -> ControlFlow<()>) -> Option<Vec<u8>> {
        let Self { recipe, shared } = self;
        let panics = {
            let mut behaviour = shared.behaviour.lock().unwrap();
            behaviour.order.push(recipe.clone());
            let begun = behaviour.begun.entry((recipe.clone(), shard)).or_default();
            *begun += 1;
            *begun <= behaviour.panics
        };
        shared.changed.notify_all();
        assert!(!panics, "the lobe fell over");
        let mut asked = 0;
        while shared.behaviour.lock().unwrap().endless.as_deref().is_some_and(|endless| recipe.starts_with(endless)) {
            if on_progress(1).is_break() {
                return None;
            }
            asked += 1;
            if asked == MOST_ASKED {
                shared.behaviour.lock().unwrap().gave_up += 1;
                break;
            }
            thread::yield_now();
        }
        for done in 1..=u64::from(ENTRIES) {
            if on_progress(done).is_break() {
                return None;
            }
            let behaviour = shared.behaviour.lock().unwrap();
            drop(shared.changed.wait_while(behaviour, |b| b.held).unwrap());
        }
        Some(format!(" {shard}").into_bytes())
    }

    fn assembly(&self) -> Box<dyn Assembly + '_> {
        Box::new(FakeAssembly(format!("TABLE {}", self.recipe).into_bytes()))
    }
}

impl Backend for FakeBackend {
    fn plan(&self, document: &[u8], _entry_limit: u64) -> Result<NewJob, SubmitError> {
        let refuse = || RecipeError::Json("NAME SHARDS".to_owned());
        let recipe = String::from_utf8(document.to_vec()).map_err(|_| refuse())?;
        let shards = recipe.split_once(' ').and_then(|(_, n)| n.parse().ok()).ok_or_else(refuse)?;
        Ok(NewJob { recipe_digest: Digest::of(document), recipe, shard_entries: vec![ENTRIES; shards], by: None })
    }

    fn expect(&self, _recipe: StoredRecipe<'_>) -> Option<ExpectedFit> {
        let model = Expectation { seconds: 8.0, error: 0.25, bytes: 1000 };
        Some(ExpectedFit { solver: Solver::Bfgs, shards: 4, model })
    }

    fn load(&self, recipe: StoredRecipe<'_>) -> Result<Arc<dyn PlannedFit>, PlanError> {
        let loading = self.0.behaviour.lock().unwrap().loading;
        thread::sleep(loading);
        Ok(Arc::new(FakePlan { recipe: recipe.text.to_owned(), shared: Arc::clone(&self.0) }))
    }

    fn recognise(&self, file: &[u8]) -> Option<(String, Digest)> {
        let text = std::str::from_utf8(file).ok()?.strip_prefix("TABLE ")?;
        let recipe: Vec<_> = text.split(' ').take(2).collect();
        let recipe = recipe.join(" ");
        let digest = Digest::of(recipe.as_bytes());
        Some((recipe, digest))
    }

    fn forget_files(&self) {}

    fn exports(&self, _file: &[u8]) -> Result<Vec<Export>, ExportFailure> {
        Ok(vec![Export::Engine(Engine::Three)])
    }

    /// A file of a hundred bytes at most; of Godot none, and Bevy's ends in a panic.
    fn export(&self, file: &[u8], manifest: &str, export: Export) -> Result<Bundle, ExportFailure> {
        self.0.behaviour.lock().unwrap().exports += 1;
        self.0.changed.notify_all();
        let behaviour = self.0.behaviour.lock().unwrap();
        drop(self.0.changed.wait_while(behaviour, |b| b.held).unwrap());
        assert_ne!(export, Export::Engine(Engine::Bevy), "the export fell over");
        if export == Export::Engine(Engine::Godot) {
            return Err(ExportFailure::TooLarge { entries: 2, limit: 1 });
        }
        let bytes = format!("{export} of {}, {manifest}", String::from_utf8_lossy(file)).into_bytes();
        let file = TextureFile { path: "file".to_owned(), bytes, rounding: RoundingError::default() };
        Ok(Bundle { files: vec![file], steps: vec![] })
    }

    fn manifest(&self, file: &[u8], go_on: &GoOn) -> Result<Option<String>, TableFileError> {
        self.0.behaviour.lock().unwrap().manifests += 1;
        self.0.changed.notify_all();
        let (recipe, _) = self.recognise(file).unwrap();
        let is_endless = |b: &Behaviour| b.endless_measure.as_ref() == Some(&recipe);
        while is_endless(&self.0.behaviour.lock().unwrap()) && go_on() {
            // Asked again soon, or at once when it is to end.
            let behaviour = self.0.behaviour.lock().unwrap();
            let pause = Duration::from_millis(1);
            drop(self.0.changed.wait_timeout_while(behaviour, pause, |b| is_endless(b)).unwrap());
        }
        Ok(go_on().then(|| format!("of {} bytes", file.len())))
    }
}
