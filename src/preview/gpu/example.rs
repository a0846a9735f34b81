//! Runs `ltc_example` of a shader as users take it home.

use wgpu::util::DeviceExt as _;

use super::{
    GpuFailure, Variant,
    device::{Device, buffer, layout},
    table,
};
use crate::preview::ShaderTable;

/// `LtcExampleCase`: ten vectors.
pub(in crate::preview) type Case = [f32; 40];
/// `LtcExampleResult`: the columns of `M`, then amplitude, Fresnel term and what is covered.
pub(in crate::preview) type Found = [f32; 16];

/// The results of `cases` by the WGSL of `source` with a table.
pub(in crate::preview) fn run(source: &str, table: &ShaderTable, cases: &[Case]) -> Result<Vec<Found>, GpuFailure> {
    let gpu = Device::open(Variant::default())?;
    let module = gpu.wgpu.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: Some("example"),
        source: wgpu::ShaderSource::Wgsl(source.into()),
    });
    let case_layout = layout(
        &gpu.wgpu,
        "case",
        &[buffer(wgpu::BufferBindingType::Uniform), buffer(wgpu::BufferBindingType::Storage { read_only: false })],
    );
    let pipeline_layout = gpu.wgpu.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: None,
        bind_group_layouts: &[Some(&gpu.table_layout), Some(&case_layout)],
        immediate_size: 0,
    });
    let pipeline = gpu.wgpu.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
        label: None,
        layout: Some(&pipeline_layout),
        module: &module,
        entry_point: Some("ltc_example"),
        compilation_options: wgpu::PipelineCompilationOptions::default(),
        cache: None,
    });
    let bound = table::upload(&gpu, table)?;
    let bytes = size_of::<Found>() as u64;
    let made = |usage| {
        gpu.wgpu.create_buffer(&wgpu::BufferDescriptor { label: None, size: bytes, usage, mapped_at_creation: false })
    };
    let found = made(wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC);
    let readback = made(wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST);
    let mut all = Vec::new();
    for case in cases {
        let case = gpu.wgpu.create_buffer_init(&wgpu::util::BufferInitDescriptor {
            label: None,
            contents: bytemuck::cast_slice(case),
            usage: wgpu::BufferUsages::UNIFORM,
        });
        let group = gpu.wgpu.create_bind_group(&wgpu::BindGroupDescriptor {
            label: None,
            layout: &case_layout,
            entries: &[
                wgpu::BindGroupEntry { binding: 0, resource: case.as_entire_binding() },
                wgpu::BindGroupEntry { binding: 1, resource: found.as_entire_binding() },
            ],
        });
        let mut encoder = gpu.wgpu.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        {
            let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
            pass.set_pipeline(&pipeline);
            pass.set_bind_group(0, &bound, &[]);
            pass.set_bind_group(1, &group, &[]);
            pass.dispatch_workgroups(1, 1, 1);
        }
        encoder.copy_buffer_to_buffer(&found, 0, &readback, 0, bytes);
        gpu.queue.submit([encoder.finish()]);
        readback.slice(..).map_async(wgpu::MapMode::Read, |_| {});
        let failed = |error: &dyn std::fmt::Display| GpuFailure::Failed(error.to_string());
        gpu.wgpu.poll(wgpu::PollType::wait_indefinitely()).map_err(|error| failed(&error))?;
        gpu.check()?;
        let view = readback.slice(..).get_mapped_range().map_err(|error| failed(&error))?;
        all.push(bytemuck::pod_read_unaligned(&view[..]));
        drop(view);
        readback.unmap();
    }
    Ok(all)
}
