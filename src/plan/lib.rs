//! From a scene to the table that it needs.
//!
//! Invariant: no clock and no thread count decides anything here: equal scenes and budgets give equal plans.

mod candidates;
mod curve;
mod document;
mod effort;
mod form;
mod held;
mod histogram;
#[cfg(test)]
mod hostile;
mod lobes;
mod needs;
mod outside;
mod picture;
mod placement;
mod plan;
mod prediction;
mod resampled;
mod scene;
mod shipped;
#[cfg(test)]
mod tests;
#[cfg(test)]
mod textured;
mod without;

pub use candidates::{Budget, Candidate};
pub use document::{document, left_out, recipe_value, words};
pub use form::Form;
pub use held::Stopped;
pub use histogram::{Spot, Views};
pub use needs::{Needs, Place};
pub use outside::{Outside, OutsideAxis, of_other_models, other_reflectances, outside};
pub use picture::picture;
pub use plan::{Fitted, Measured, TablePlan, Whole, WholeAt};
pub use scene::{LobeKind, Scene, SceneError, SceneFault, SceneLobe, SceneMaterial};
pub use without::{Beside, GpuLimit, WithoutTable};
