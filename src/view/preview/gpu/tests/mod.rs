//! Runs shaders without the preview, as users run them.

pub(crate) mod decoder;
pub(in crate::preview) mod example;
pub(in crate::preview) mod pictures;
pub(in crate::preview) mod prefilter;

use super::Gpu;

impl Gpu {
    /// Makes the GPU fail after it has rendered `times` pictures.
    pub(in crate::preview) fn fail_after(&mut self, times: u32) {
        self.fails_after = Some(times);
    }

    /// Loses the device, as a driver reset does.
    pub(in crate::preview) fn lose(&mut self) {
        if let Some(open) = &self.open {
            open.device.wgpu.destroy();
        }
    }
}
