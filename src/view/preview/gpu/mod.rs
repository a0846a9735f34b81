//! The renderer on a GPU, or on lavapipe: a software rasteriser that Vulkan lists like a GPU.

mod device;
mod failure;
mod picture;
mod session;
mod table;
mod target;
mod task;
#[cfg(test)]
pub(super) mod tests;
mod tiles;
mod weights;

pub(crate) use failure::GpuFailure;
pub(super) use session::Gpu;
pub(super) use task::RenderTask;
pub use weights::Weights;
