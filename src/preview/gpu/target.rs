//! Where a GPU writes a picture, and how it comes back.

use std::time::Duration;

use super::{
    GpuFailure,
    device::Device,
    job::{GROUP, Job},
    table::bind,
};
use crate::preview::{
    frame::{Frame, Part},
    renderer::Stop,
};

/// A tile takes some hundred milliseconds; one that takes longer than this hangs.
const PATIENCE: Duration = Duration::from_secs(10);

/// Buffers for frames of one size.
#[derive(Debug)]
pub(super) struct Target {
    size: u32,
    /// 32-bit words a pixel: one to display, three of radiance.
    words: u32,
    light: wgpu::Buffer,
    scene: wgpu::Buffer,
    pixels: wgpu::Buffer,
    readback: wgpu::Buffer,
    group: wgpu::BindGroup,
}

impl Target {
    pub(super) fn new(gpu: &Device, frame: &Frame, as_bytes: bool) -> Self {
        let words = if as_bytes { 1 } else { 3 };
        let bytes = u64::from(frame.size) * u64::from(frame.size) * u64::from(words) * 4;
        let buffer = |size: u64, usage| {
            gpu.wgpu.create_buffer(&wgpu::BufferDescriptor {
                label: Some("frame"),
                size,
                usage,
                mapped_at_creation: false,
            })
        };
        let uniform = wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST;
        let light = buffer(4 * frame.light_words().len() as u64, uniform);
        let scene = buffer(4 * frame.scene_words(&Part::default()).len() as u64, uniform);
        let pixels = buffer(bytes, wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC);
        let readback = buffer(bytes, wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST);
        let resources = [light.as_entire_binding(), scene.as_entire_binding(), pixels.as_entire_binding()];
        let group = bind(gpu, &gpu.frame_layout, &resources);
        Self { size: frame.size, words, light, scene, pixels, readback, group }
    }

    /// Whether frames like this fit.
    pub(super) fn fits(&self, frame: &Frame, as_bytes: bool) -> bool {
        self.size == frame.size && (self.words == 1) == as_bytes
    }

    /// Renders the job's part, and returns the words of the whole picture.
    pub(super) fn render(
        &self,
        gpu: &mut Device,
        table: &wgpu::BindGroup,
        job: &Job<'_>,
        stop: Stop<'_>,
    ) -> Result<Vec<u32>, GpuFailure> {
        let pipeline = gpu.pipeline(job.estimator);
        gpu.check()?;
        gpu.queue.write_buffer(&self.light, 0, bytemuck::cast_slice(&job.frame.light_words()));
        for part in job.parts() {
            if stop() {
                return Err(GpuFailure::Stopped);
            }
            let words = job.frame.scene_words(&part);
            gpu.queue.write_buffer(&self.scene, 0, bytemuck::cast_slice(&words));
            let mut encoder = gpu.wgpu.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
            {
                let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
                pass.set_pipeline(&pipeline);
                pass.set_bind_group(0, table, &[]);
                pass.set_bind_group(1, &self.group, &[]);
                pass.dispatch_workgroups(part.extent[0].div_ceil(GROUP), part.extent[1].div_ceil(GROUP), 1);
            }
            wait(gpu, gpu.queue.submit([encoder.finish()]))?;
        }
        self.read(gpu)
    }

    fn read(&self, gpu: &Device) -> Result<Vec<u32>, GpuFailure> {
        let mut encoder = gpu.wgpu.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        encoder.copy_buffer_to_buffer(&self.pixels, 0, &self.readback, 0, self.readback.size());
        let submission = gpu.queue.submit([encoder.finish()]);
        let slice = self.readback.slice(..);
        slice.map_async(wgpu::MapMode::Read, |_| {});
        wait(gpu, submission)?;
        let failed = |error: wgpu::MapRangeError| GpuFailure::Failed(error.to_string());
        let view = slice.get_mapped_range().map_err(failed)?;
        let words = bytemuck::pod_collect_to_vec(&view[..]);
        drop(view);
        self.readback.unmap();
        gpu.check()?;
        Ok(words)
    }
}

fn wait(gpu: &Device, submission: wgpu::SubmissionIndex) -> Result<(), GpuFailure> {
    let until = wgpu::PollType::Wait { submission_index: Some(submission), timeout: Some(PATIENCE) };
    match gpu.wgpu.poll(until) {
        Ok(_) => gpu.check(),
        Err(wgpu::PollError::Timeout) => Err(GpuFailure::Hangs(format!("no answer within {PATIENCE:?}"))),
        // What was submitted to a lost device is unknown to it.
        Err(error) => Err(gpu.check().err().unwrap_or_else(|| GpuFailure::Failed(error.to_string()))),
    }
}
