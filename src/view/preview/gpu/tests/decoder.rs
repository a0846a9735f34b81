//! Runs the decoder of a compact form: two passes over three storage buffers.

use super::super::{
    GpuFailure, Weights,
    device::{Device, buffer, layout},
    table::bind,
};

/// The buffer of texels after the passes `ltc_read` and `ltc_expand` of the WGSL `source`. `integers` and `texels` are
/// the sizes of the second and third buffer in bytes. The first pass is dispatched `reads` times. The second pass has
/// `workgroups` workgroups.
pub(crate) fn run(
    source: &str,
    bytes: &[u8],
    [integers, texels]: [u64; 2],
    [reads, workgroups]: [u32; 2],
) -> Result<Vec<f32>, GpuFailure> {
    let gpu = Device::open(Weights::default())?;
    let module = gpu.wgpu.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: None,
        source: wgpu::ShaderSource::Wgsl(source.into()),
    });
    let storage = |read_only| buffer(wgpu::BufferBindingType::Storage { read_only });
    let group_layout = layout(&gpu.wgpu, "decoder", &[storage(true), storage(false), storage(false)]);
    let pipeline_layout = gpu.wgpu.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: None,
        bind_group_layouts: &[Some(&group_layout)],
        immediate_size: 0,
    });
    let made = |size, usage| {
        gpu.wgpu.create_buffer(&wgpu::BufferDescriptor { label: None, size, usage, mapped_at_creation: false })
    };
    let mut padded = bytes.to_vec();
    padded.resize(bytes.len().next_multiple_of(4), 0);
    let given = made(padded.len() as u64, wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_DST);
    gpu.queue.write_buffer(&given, 0, &padded);
    let work = made(integers, wgpu::BufferUsages::STORAGE);
    let found = made(texels, wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC);
    let read = made(texels, wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST);
    let group =
        bind(&gpu, &group_layout, &[given.as_entire_binding(), work.as_entire_binding(), found.as_entire_binding()]);
    let mut encoder = gpu.wgpu.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    for (entry_point, times, workgroups) in [("ltc_read", reads, 1), ("ltc_expand", 1, workgroups)] {
        let pipeline = gpu.wgpu.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: None,
            layout: Some(&pipeline_layout),
            module: &module,
            entry_point: Some(entry_point),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            cache: None,
        });
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
        pass.set_pipeline(&pipeline);
        pass.set_bind_group(0, &group, &[]);
        for _ in 0..times {
            pass.dispatch_workgroups(workgroups, 1, 1);
        }
    }
    encoder.copy_buffer_to_buffer(&found, 0, &read, 0, texels);
    gpu.queue.submit([encoder.finish()]);
    let failed = |error: &dyn std::fmt::Display| GpuFailure::Failed(error.to_string());
    read.slice(..).map_async(wgpu::MapMode::Read, |_| {});
    gpu.wgpu.poll(wgpu::PollType::wait_indefinitely()).map_err(|error| failed(&error))?;
    gpu.check()?;
    let view = read.slice(..).get_mapped_range().map_err(|error| failed(&error))?;
    Ok(bytemuck::pod_collect_to_vec(&view[..]))
}
