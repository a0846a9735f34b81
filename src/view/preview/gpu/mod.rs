//! The renderer on a GPU, or on lavapipe, which is one to Vulkan.

mod device;
#[cfg(test)]
pub(super) mod example;
mod job;
mod shaders;
mod table;
mod target;
mod tiles;

use std::sync::Arc;

use self::{device::Device, target::Target};
pub(super) use job::Job;
pub use shaders::{SHADERS, Shader};

use super::{ShaderTable, renderer::Stop};

/// Other ways to compile the shaders, to be measured against the usual one.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Variant {
    /// Who weighs the entries around a configuration.
    pub weights: Weights,
    /// A constant stands for the table.
    pub lookup_is_constant: bool,
}

/// Who weighs the entries around a configuration.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Weights {
    /// The sampler of a software rasteriser, which is faster there and weighs in f32; else the shader, since GPUs'
    /// samplers have weights of 8 bits.
    #[default]
    Exact,
    /// The shader.
    Shader,
    /// The sampler.
    Sampler,
}

/// Why a GPU did not render.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub(super) enum GpuFailure {
    /// There is none, or none that will do.
    #[error("{0}")]
    Absent(String),
    /// It cannot hold the table.
    #[error("a table of {size:?} texels is larger than the {most} a side that textures may have")]
    TableTooLarge {
        /// Texels a side.
        size: [usize; 3],
        /// Most texels a side.
        most: u32,
    },
    /// It was lost, or an operation failed.
    #[error("{0}")]
    Failed(String),
    /// It does not come back.
    #[error("{0}")]
    Hangs(String),
    /// The caller told it to stop.
    #[error("stopped")]
    Stopped,
}

/// A GPU that is opened by its first picture, and again after it was lost.
#[derive(Debug, Default)]
pub(super) struct Gpu {
    variant: Variant,
    open: Option<Open>,
    /// How often it renders before it fails.
    #[cfg(test)]
    fails_after: Option<u32>,
}

#[derive(Debug)]
struct Open {
    device: Device,
    /// The last table, and the last frame's buffers: most pictures have the same.
    table: Option<(Arc<ShaderTable>, wgpu::BindGroup)>,
    target: Option<Target>,
}

impl Gpu {
    pub(super) fn new(variant: Variant) -> Self {
        Self { variant, ..Self::default() }
    }

    /// Opens the device if it is not, and returns its name.
    pub(super) fn name(&mut self) -> Result<String, GpuFailure> {
        Ok(self.device()?.device.name.clone())
    }

    /// Renders part of a picture and returns the words of all of it. What fails is tried once more on a new device.
    pub(super) fn render(
        &mut self,
        table: &Arc<ShaderTable>,
        job: &Job<'_>,
        stop: Stop<'_>,
    ) -> Result<Vec<u32>, GpuFailure> {
        #[cfg(test)]
        if let Some(times) = &mut self.fails_after {
            *times = times.checked_sub(1).ok_or_else(|| GpuFailure::Failed("told to fail".to_owned()))?;
        }
        match self.attempt(table, job, stop) {
            Err(GpuFailure::Failed(first)) => {
                tracing::warn!("the GPU failed and is opened again: {first}");
                self.open = None;
                self.attempt(table, job, stop).inspect_err(|_| self.open = None)
            }
            Err(failure @ GpuFailure::Hangs(_)) => {
                // Dropping a busy device would wait for it: it is left to itself.
                std::mem::forget(self.open.take());
                Err(failure)
            }
            other => other,
        }
    }

    fn attempt(&mut self, table: &Arc<ShaderTable>, job: &Job<'_>, stop: Stop<'_>) -> Result<Vec<u32>, GpuFailure> {
        let Open { device, table: kept_table, target: kept_target } = self.device()?;
        let bound = match kept_table.take() {
            Some((last, bound)) if Arc::ptr_eq(&last, table) => bound,
            _ => table::upload(device, table)?,
        };
        *kept_table = Some((Arc::clone(table), bound.clone()));
        let target = match kept_target.take() {
            Some(last) if last.fits(job.frame, job.as_bytes) => last,
            _ => Target::new(device, job.frame, job.as_bytes),
        };
        kept_target.insert(target).render(device, &bound, job, stop)
    }

    fn device(&mut self) -> Result<&mut Open, GpuFailure> {
        if self.open.is_none() {
            self.open = Some(Open { device: Device::open(self.variant)?, table: None, target: None });
        }
        self.open.as_mut().ok_or_else(|| GpuFailure::Absent("not open".to_owned()))
    }

    /// Has it fail once it has rendered so many times.
    #[cfg(test)]
    pub(super) fn fail_after(&mut self, times: u32) {
        self.fails_after = Some(times);
    }

    /// Loses the device, as a driver's reset would.
    #[cfg(test)]
    pub(super) fn lose(&mut self) {
        if let Some(open) = &self.open {
            open.device.wgpu.destroy();
        }
    }
}
