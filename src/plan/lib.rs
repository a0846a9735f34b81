//! Plans the table that a scene needs.
//!
//! Invariant: neither a clock nor the number of threads changes a plan. Equal scenes and budgets give equal plans.

mod candidates;
mod curve;
mod document;
mod figures;
mod form;
mod histogram;
#[cfg(test)]
mod hostile;
#[cfg(test)]
mod lit;
mod lobes;
mod needs;
mod plan;
mod prediction;
mod probes;
mod scene;
#[cfg(test)]
mod tests;
#[cfg(test)]
mod textured;
mod without;
mod words;

pub use candidates::{Budget, Candidate};
pub use document::{document, recipe_value};
pub use figures::{Figure, Help, check, of_other_models};
pub use form::Form;
pub use histogram::{Spot, Views};
pub use ltcforge_files::recipe_document::Fault as SceneFault;
pub use ltcforge_shaders::GpuLimit;
pub use needs::Needs;
pub use plan::{Fitted, TablePlan, Whole};
pub use probes::Stopped;
pub use scene::{LobeKind, Scene, SceneError, SceneLight, SceneLobe, SceneMaterial};
pub use without::WithoutTable;
pub use words::{left_out, words};
