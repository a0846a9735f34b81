//! An open GPU, and the resources that it keeps from one picture to the next.

use std::sync::Arc;

use super::{GpuFailure, RenderTask, Weights, device::Device, picture, table, target::RenderTarget};
use crate::preview::{ShaderTable, estimator::Stop, light_picture::LightPicture};

/// A GPU. The first picture opens the device. If the device is lost, the next picture opens it again.
#[derive(Debug, Default)]
pub(in crate::preview) struct Gpu {
    weights: Weights,
    pub(super) open: Option<Open>,
    /// The number of pictures to render before it fails.
    #[cfg(test)]
    pub(super) fails_after: Option<u32>,
}

#[derive(Debug)]
pub(super) struct Open {
    pub(super) device: Device,
    /// The last table and picture, and the buffers of the last frame. Most pictures use the same table and buffers as
    /// the picture before.
    table: Option<(Arc<ShaderTable>, wgpu::BindGroup)>,
    picture: Option<(Option<Arc<LightPicture>>, wgpu::BindGroup)>,
    target: Option<RenderTarget>,
}

impl Gpu {
    pub(in crate::preview) fn new(weights: Weights) -> Self {
        Self { weights, ..Self::default() }
    }

    /// Opens the device if it is not open, and returns its name.
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
            *times = times.checked_sub(1).ok_or_else(|| GpuFailure::Failed("a test makes it fail".to_owned()))?;
        }
        match self.attempt(table, task, stop) {
            Err(GpuFailure::Failed(first)) => {
                tracing::warn!("the GPU failed; opening it again: {first}");
                self.open = None;
                self.attempt(table, task, stop).inspect_err(|_| self.open = None)
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
        let last = kept_table.take().filter(|(last, _)| Arc::ptr_eq(last, table));
        let new = || Ok((Arc::clone(table), table::upload(device, table)?));
        let (_, bound) = kept_table.insert(last.map_or_else(new, Ok)?);
        let wanted = &task.frame.picture;
        let last = kept_picture.take().filter(|(last, _)| last == wanted);
        let new = || Ok((wanted.clone(), picture::upload(device, wanted.as_deref())?));
        let (_, picture) = kept_picture.insert(last.map_or_else(new, Ok)?);
        let last = kept_target.take().filter(|last| last.fits(task.frame));
        let target = kept_target.insert(last.unwrap_or_else(|| RenderTarget::new(device, task.frame)));
        target.render(device, [bound, picture], task, stop)
    }

    fn device(&mut self) -> Result<&mut Open, GpuFailure> {
        if self.open.is_none() {
            self.open = Some(Open { device: Device::open(self.weights)?, table: None, picture: None, target: None });
        }
        self.open.as_mut().ok_or_else(|| GpuFailure::Absent("not open".to_owned()))
    }
}
