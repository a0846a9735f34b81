//! The buffers that a GPU renders into, and the transfer back to the CPU.

use std::time::Instant;

use super::{
    GpuFailure,
    device::Device,
    table::bind,
    task::RenderTask,
    tiles::{SIDE, Tiles},
};
use crate::preview::{
    estimator::Stop,
    frame::{Frame, Part},
};

/// Buffers for frames of one size.
#[derive(Debug)]
pub(super) struct RenderTarget {
    size: u32,
    light: wgpu::Buffer,
    scene: wgpu::Buffer,
    pixels: wgpu::Buffer,
    tiles: wgpu::Buffer,
    readback: wgpu::Buffer,
    group: wgpu::BindGroup,
}

impl RenderTarget {
    pub(super) fn new(gpu: &Device, frame: &Frame) -> Self {
        let bytes = u64::from(frame.size) * u64::from(frame.size) * size_of::<[f32; 3]>() as u64;
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
        let tiles = 4 * u64::from(frame.size.div_ceil(SIDE)).pow(2);
        let tiles = buffer(tiles, wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_DST);
        let readback = buffer(bytes, wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST);
        let resources = [&light, &scene, &pixels, &tiles].map(wgpu::Buffer::as_entire_binding);
        let group = bind(gpu, &gpu.frame_layout, &resources);
        Self { size: frame.size, light, scene, pixels, tiles, readback, group }
    }

    /// Whether the buffers have the right sizes for a frame.
    pub(super) fn fits(&self, frame: &Frame) -> bool {
        self.size == frame.size
    }

    /// Renders the part of the task and returns the pixels of the whole picture.
    pub(super) fn render(
        &self,
        gpu: &mut Device,
        [table, picture]: [&wgpu::BindGroup; 2],
        task: &RenderTask<'_>,
        stop: Stop<'_>,
    ) -> Result<Vec<[f32; 3]>, GpuFailure> {
        let pipeline = gpu.pipeline(task.estimator, task.frame);
        gpu.check()?;
        let tiles = Tiles::of(task.frame, task.estimator, task.corner, task.extent);
        let packed: Vec<u32> = tiles.visible.iter().map(|[x, y]| x | (y << 16)).collect();
        gpu.queue.write_buffer(&self.light, 0, bytemuck::cast_slice(&task.frame.light_words()));
        gpu.queue.write_buffer(&self.tiles, 0, bytemuck::cast_slice(&packed));
        let mut parts = task.parts(packed.len() as u32);
        let mut took = None;
        while let Some(part) = parts.next(took) {
            if stop() {
                return Err(GpuFailure::Stopped);
            }
            let start = Instant::now();
            let words = task.frame.scene_words(&part);
            gpu.queue.write_buffer(&self.scene, 0, bytemuck::cast_slice(&words));
            let mut encoder = gpu.wgpu.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
            {
                let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
                pass.set_pipeline(&pipeline);
                pass.set_bind_group(0, table, &[]);
                pass.set_bind_group(1, &self.group, &[]);
                pass.set_bind_group(2, picture, &[]);
                pass.dispatch_workgroups(part.tiles, 1, 1);
            }
            wait(gpu, gpu.queue.submit([encoder.finish()]))?;
            took = Some(start.elapsed());
        }
        let mut pixels = self.read(gpu)?;
        for [left, top] in tiles.background {
            for y in top..(top + SIDE).min(self.size) {
                let row = (y * self.size + left)..(y * self.size + (left + SIDE).min(self.size));
                pixels[row.start as usize..row.end as usize].fill(task.frame.background.to_array());
            }
        }
        Ok(pixels)
    }

    fn read(&self, gpu: &Device) -> Result<Vec<[f32; 3]>, GpuFailure> {
        let mut encoder = gpu.wgpu.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        encoder.copy_buffer_to_buffer(&self.pixels, 0, &self.readback, 0, self.readback.size());
        let submission = gpu.queue.submit([encoder.finish()]);
        let slice = self.readback.slice(..);
        slice.map_async(wgpu::MapMode::Read, |_| {});
        wait(gpu, submission)?;
        let failed = |error: wgpu::MapRangeError| GpuFailure::Failed(error.to_string());
        let view = slice.get_mapped_range().map_err(failed)?;
        let pixels = bytemuck::pod_collect_to_vec(&view[..]);
        drop(view);
        self.readback.unmap();
        gpu.check()?;
        Ok(pixels)
    }
}

/// Waits for a submission, without a time limit. The caller decides when to stop.
fn wait(gpu: &Device, submission: wgpu::SubmissionIndex) -> Result<(), GpuFailure> {
    let until = wgpu::PollType::Wait { submission_index: Some(submission), timeout: None };
    match gpu.wgpu.poll(until) {
        Ok(_) => gpu.check(),
        // A lost device does not know its submissions.
        Err(error) => Err(gpu.check().err().unwrap_or_else(|| GpuFailure::Failed(error.to_string()))),
    }
}
