//! Runs an entry point, such as `ltc_example` of an exported shader, for a list of cases.

use bytemuck::Pod;

use super::super::{
    GpuFailure, Weights,
    device::{Device, buffer, layout, table_bindings},
    table::{self, bind, bound, texture},
};
use crate::preview::ShaderTable;
use ltcforge_shaders::Bound;

/// The results of an entry point of the WGSL `source`, one for each case. Group 0 is the table, if the entry point
/// reads a table. The next group holds a uniform `Case` and a storage buffer with one `Found`.
pub(in crate::preview) fn run<Case: Pod, Found: Pod>(
    source: &str,
    entry_point: &str,
    table: Option<(&ShaderTable, Bound)>,
    cases: &[Case],
) -> Result<Vec<Found>, GpuFailure> {
    run_with(Weights::default(), source, entry_point, table, cases)
}

/// [`run`] with the given `weights`.
pub(in crate::preview) fn run_with<Case: Pod, Found: Pod>(
    weights: Weights,
    source: &str,
    entry_point: &str,
    table: Option<(&ShaderTable, Bound)>,
    cases: &[Case],
) -> Result<Vec<Found>, GpuFailure> {
    let by_sampler = weights == Weights::Sampler;
    run_on(&Device::open(weights)?, by_sampler, wgpu::ShaderSource::Wgsl(source.into()), entry_point, table, cases)
}

/// [`run`] for a source in WGSL or SPIR-V.
pub(in crate::preview) fn run_source<Case: Pod, Found: Pod>(
    source: wgpu::ShaderSource<'_>,
    entry_point: &str,
    table: Option<(&ShaderTable, Bound)>,
    cases: &[Case],
) -> Result<Vec<Found>, GpuFailure> {
    run_on(&Device::open(Weights::default())?, false, source, entry_point, table, cases)
}

fn run_on<Case: Pod, Found: Pod>(
    gpu: &Device,
    by_sampler: bool,
    source: wgpu::ShaderSource<'_>,
    entry_point: &str,
    table: Option<(&ShaderTable, Bound)>,
    cases: &[Case],
) -> Result<Vec<Found>, GpuFailure> {
    let filter = [("ltc_hardware_filter", 1.0)];
    let label = Some(entry_point);
    let module = gpu.wgpu.create_shader_module(wgpu::ShaderModuleDescriptor { label, source });
    let case_layout = layout(
        &gpu.wgpu,
        "case",
        &[buffer(wgpu::BufferBindingType::Uniform), buffer(wgpu::BufferBindingType::Storage { read_only: false })],
    );
    let table_layout =
        table.map(|(_, textures)| layout(&gpu.wgpu, "table", &table_bindings(gpu.samples_weighed, textures)));
    let groups: Vec<_> = table_layout.iter().chain([&case_layout]).map(Some).collect();
    let pipeline_layout = gpu.wgpu.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: None,
        bind_group_layouts: &groups,
        immediate_size: 0,
    });
    let pipeline = gpu.wgpu.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
        label: None,
        layout: Some(&pipeline_layout),
        module: &module,
        entry_point: Some(entry_point),
        compilation_options: wgpu::PipelineCompilationOptions {
            constants: if by_sampler { &filter } else { &[] },
            ..Default::default()
        },
        cache: None,
    });
    let bound = match table.zip(table_layout.as_ref()) {
        None => None,
        Some(((table, Bound::Volumes), _)) => Some(table::upload(gpu, table)?),
        Some(((table, Bound::Array), layout)) => Some(upload_array(gpu, table, layout)),
    };
    let made = |bytes: usize, usage| {
        let size = bytes as u64;
        gpu.wgpu.create_buffer(&wgpu::BufferDescriptor { label: None, size, usage, mapped_at_creation: false })
    };
    let given = made(size_of::<Case>(), wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST);
    let found = made(size_of::<Found>(), wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC);
    let all = made(size_of::<Found>() * cases.len(), wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST);
    let group = bind(gpu, &case_layout, &[given.as_entire_binding(), found.as_entire_binding()]);
    let failed = |error: &dyn std::fmt::Display| GpuFailure::Failed(error.to_string());
    for (i, case) in cases.iter().enumerate() {
        gpu.queue.write_buffer(&given, 0, bytemuck::bytes_of(case));
        let mut encoder = gpu.wgpu.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        {
            let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
            pass.set_pipeline(&pipeline);
            if let Some(bound) = &bound {
                pass.set_bind_group(0, bound, &[]);
            }
            pass.set_bind_group(u32::from(bound.is_some()), &group, &[]);
            pass.dispatch_workgroups(1, 1, 1);
        }
        encoder.copy_buffer_to_buffer(&found, 0, &all, (size_of::<Found>() * i) as u64, found.size());
        gpu.queue.submit([encoder.finish()]);
        // Thousands of submissions in flight would slow each other down.
        gpu.wgpu.poll(wgpu::PollType::wait_indefinitely()).map_err(|error| failed(&error))?;
    }
    all.slice(..).map_async(wgpu::MapMode::Read, |_| {});
    gpu.wgpu.poll(wgpu::PollType::wait_indefinitely()).map_err(|error| failed(&error))?;
    gpu.check()?;
    let view = all.slice(..).get_mapped_range().map_err(|error| failed(&error))?;
    Ok(bytemuck::pod_collect_to_vec(&view[..]))
}

/// Group 0 of the shaders for a table, for `texels_array.wgsl`: its three textures are the layers of one array.
fn upload_array(gpu: &Device, table: &ShaderTable, layout: &wgpu::BindGroupLayout) -> wgpu::BindGroup {
    let array = texture(gpu, table, wgpu::TextureDimension::D2, &table.texels.concat());
    bound(gpu, table, layout, &[array])
}
