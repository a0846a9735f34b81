//! The renderer on a GPU, or on lavapipe, a software rasteriser that Vulkan lists as one.

#[cfg(test)]
pub(super) mod decoder;
mod device;
#[cfg(test)]
pub(super) mod example;
mod failure;
mod session;
mod table;
mod target;
mod task;
mod tiles;
mod variant;

pub(crate) use failure::GpuFailure;
pub(super) use session::Gpu;
pub(super) use task::RenderTask;
pub use variant::{Variant, Weights};
