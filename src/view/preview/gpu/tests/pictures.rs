//! Runs an entry point that reads pictures on lights.

use bytemuck::Pod;
use wgpu::util::DeviceExt as _;

use super::super::{GpuFailure, Weights, device::Device};
use ltcforge_light::textured::{LightImage, LightPyramid};

/// The results of an entry point of the WGSL `source`, for groups of cases. Group 0 has the picture and its sampler,
/// from binding `first` on. Group 1 has a uniform `Case` and a storage buffer with one `Found`.
pub(in crate::preview) fn run<Case: Pod, Found: Pod>(
    source: &str,
    entry_point: &str,
    (picture, first): (&LightPyramid, u32),
    cases: &[Case],
) -> Result<Vec<Found>, GpuFailure> {
    let gpu = Device::open(Weights::default())?;
    if !gpu.wgpu.features().contains(wgpu::Features::FLOAT32_FILTERABLE) {
        return Err(GpuFailure::Absent("the adapter cannot filter 32-bit textures".to_owned()));
    }
    let module = gpu.wgpu.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: None,
        source: wgpu::ShaderSource::Wgsl(source.into()),
    });
    // The layout has only the resources that the entry point uses.
    let pipeline = gpu.wgpu.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
        label: None,
        layout: None,
        module: &module,
        entry_point: Some(entry_point),
        compilation_options: wgpu::PipelineCompilationOptions::default(),
        cache: None,
    });
    gpu.check()?;
    let view = upload(&gpu, picture);
    let sampler = gpu.wgpu.create_sampler(&wgpu::SamplerDescriptor {
        mag_filter: wgpu::FilterMode::Linear,
        min_filter: wgpu::FilterMode::Linear,
        mipmap_filter: wgpu::MipmapFilterMode::Linear,
        ..Default::default()
    });
    let made = |bytes: usize, usage| {
        let size = bytes as u64;
        gpu.wgpu.create_buffer(&wgpu::BufferDescriptor { label: None, size, usage, mapped_at_creation: false })
    };
    let found = made(size_of::<Found>(), wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC);
    let given = made(size_of::<Case>(), wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST);
    let all = made(size_of::<Found>() * cases.len(), wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST);
    let group = |index: u32, entries: &[wgpu::BindGroupEntry<'_>]| {
        let layout = &pipeline.get_bind_group_layout(index);
        gpu.wgpu.create_bind_group(&wgpu::BindGroupDescriptor { label: None, layout, entries })
    };
    let entry = |binding, resource| wgpu::BindGroupEntry { binding, resource };
    let pictures = group(
        0,
        &[
            entry(first, wgpu::BindingResource::TextureView(&view)),
            entry(first + 1, wgpu::BindingResource::Sampler(&sampler)),
        ],
    );
    let buffers = group(1, &[entry(0, given.as_entire_binding()), entry(1, found.as_entire_binding())]);
    let failed = |error: &dyn std::fmt::Display| GpuFailure::Failed(error.to_string());
    for (i, case) in cases.iter().enumerate() {
        gpu.queue.write_buffer(&given, 0, bytemuck::bytes_of(case));
        let mut encoder = gpu.wgpu.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        {
            let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
            pass.set_pipeline(&pipeline);
            pass.set_bind_group(0, &pictures, &[]);
            pass.set_bind_group(1, &buffers, &[]);
            pass.dispatch_workgroups(1, 1, 1);
        }
        encoder.copy_buffer_to_buffer(&found, 0, &all, (size_of::<Found>() * i) as u64, found.size());
        gpu.queue.submit([encoder.finish()]);
        gpu.wgpu.poll(wgpu::PollType::wait_indefinitely()).map_err(|error| failed(&error))?;
    }
    all.slice(..).map_async(wgpu::MapMode::Read, |_| {});
    gpu.wgpu.poll(wgpu::PollType::wait_indefinitely()).map_err(|error| failed(&error))?;
    gpu.check()?;
    let view = all.slice(..).get_mapped_range().map_err(|error| failed(&error))?;
    Ok(bytemuck::pod_collect_to_vec(&view[..]))
}

/// A picture with all its levels, as an array of one layer.
fn upload(gpu: &Device, picture: &LightPyramid) -> wgpu::TextureView {
    let levels = picture.levels();
    let texels = levels.iter().flat_map(LightImage::texels).flat_map(|[r, g, b]| [*r, *g, *b, 1.0]);
    let texels: Vec<f32> = texels.collect();
    let size = |texels: usize| u32::try_from(texels).unwrap_or(u32::MAX);
    let descriptor = wgpu::TextureDescriptor {
        label: Some("picture"),
        size: wgpu::Extent3d {
            width: size(levels[0].width()),
            height: size(levels[0].height()),
            depth_or_array_layers: 1,
        },
        mip_level_count: size(levels.len()),
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: wgpu::TextureFormat::Rgba32Float,
        usage: wgpu::TextureUsages::TEXTURE_BINDING,
        view_formats: &[],
    };
    let order = wgpu::util::TextureDataOrder::LayerMajor;
    let texture = gpu.wgpu.create_texture_with_data(&gpu.queue, &descriptor, order, bytemuck::cast_slice(&texels));
    let dimension = Some(wgpu::TextureViewDimension::D2Array);
    texture.create_view(&wgpu::TextureViewDescriptor { dimension, ..Default::default() })
}
