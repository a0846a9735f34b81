//! An open GPU, and the resources that it keeps from one picture to the next.

use std::sync::Arc;

use super::{GpuFailure, RenderTask, Weights, device::Device, picture, table, target::RenderTarget};
use crate::preview::{ShaderTable, estimator::Stop, light_picture::LightPicture};

/// A GPU that its first picture opens, and the next picture opens again after it was lost.
#[derive(Debug, Default)]
pub(in crate::preview) struct Gpu {
    weights: Weights,
    open: Option<Open>,
    /// How many more pictures it renders before it fails.
    #[cfg(test)]
    fails_after: Option<u32>,
}

#[derive(Debug)]
struct Open {
    device: Device,
    /// The last table and picture, and the last frame's buffers: most pictures have the same.
    table: Option<(Arc<ShaderTable>, wgpu::BindGroup)>,
    picture: Option<(Option<Arc<LightPicture>>, wgpu::BindGroup)>,
    target: Option<RenderTarget>,
}

impl Gpu {
    pub(in crate::preview) fn new(weights: Weights) -> Self {
        Self { weights, ..Self::default() }
    }

    /// Opens the device if it is not, and returns its name.
    pub(in crate::preview) fn name(&mut self) -> Result<String, GpuFailure> {
        Ok(self.device()?.device.name.clone())
    }

    /// Renders part of a picture and returns the pixels of the whole picture. After a failure it tries once more on a
    /// new device.
    pub(in crate::preview) fn render(
        &mut self,
        table: &Arc<ShaderTable>,
        task: &RenderTask<'_>,
        stop: Stop<'_>,
    ) -> Result<Vec<[f32; 3]>, GpuFailure> {
        #[cfg(test)]
        if let Some(times) = &mut self.fails_after {
            *times = times.checked_sub(1).ok_or_else(|| GpuFailure::Failed("told to fail".to_owned()))?;
        }
        match self.attempt(table, task, stop) {
            Err(GpuFailure::Failed(first)) => {
                tracing::warn!("the GPU failed and is opened again: {first}");
                self.open = None;
                self.attempt(table, task, stop).inspect_err(|_| self.open = None)
            }
            Err(failure @ GpuFailure::Hangs(_)) => {
                // Dropping a busy device would wait for it, so it is leaked.
                std::mem::forget(self.open.take());
                Err(failure)
            }
            other => other,
        }
    }

    fn attempt(
        &mut self,
        table: &Arc<ShaderTable>,
        task: &RenderTask<'_>,
        stop: Stop<'_>,
    ) -> Result<Vec<[f32; 3]>, GpuFailure> {
        let Open { device, table: kept_table, picture: kept_picture, target: kept_target } = self.device()?;
        let bound = match kept_table.take() {
            Some((last, bound)) if Arc::ptr_eq(&last, table) => bound,
            _ => table::upload(device, table)?,
        };
        *kept_table = Some((Arc::clone(table), bound.clone()));
        let wanted = &task.frame.picture;
        let picture = match kept_picture.take() {
            Some((last, bound)) if last == *wanted => bound,
            _ => picture::upload(device, wanted.as_deref())?,
        };
        *kept_picture = Some((wanted.clone(), picture.clone()));
        let target = match kept_target.take() {
            Some(last) if last.fits(task.frame) => last,
            _ => RenderTarget::new(device, task.frame),
        };
        kept_target.insert(target).render(device, [&bound, &picture], task, stop)
    }

    fn device(&mut self) -> Result<&mut Open, GpuFailure> {
        if self.open.is_none() {
            self.open = Some(Open { device: Device::open(self.weights)?, table: None, picture: None, target: None });
        }
        self.open.as_mut().ok_or_else(|| GpuFailure::Absent("not open".to_owned()))
    }

    /// Makes it fail after it has rendered so many times.
    #[cfg(test)]
    pub(in crate::preview) fn fail_after(&mut self, times: u32) {
        self.fails_after = Some(times);
    }

    /// Loses the device, as a driver's reset would.
    #[cfg(test)]
    pub(in crate::preview) fn lose(&mut self) {
        if let Some(open) = &self.open {
            open.device.wgpu.destroy();
        }
    }
}
