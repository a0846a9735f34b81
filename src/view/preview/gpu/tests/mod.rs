//! Runs shaders by themselves, as they run at users'.

pub(crate) mod decoder;
pub(in crate::preview) mod example;
pub(in crate::preview) mod pictures;
pub(in crate::preview) mod prefilter;

use super::Gpu;

impl Gpu {
    /// Makes it fail after it has rendered so many times.
    pub(in crate::preview) fn fail_after(&mut self, times: u32) {
        self.fails_after = Some(times);
    }

    /// Loses the device, as a driver's reset would.
    pub(in crate::preview) fn lose(&mut self) {
        if let Some(open) = &self.open {
            open.device.wgpu.destroy();
        }
    }
}
