//! A table in a GPU's memory.

use half::f16;
use wgpu::util::DeviceExt as _;

use super::{GpuFailure, device::Device};
use crate::view::preview::{ShaderTable, TexelFormat};

/// Group 0 of the shaders for a table. Fails for one that is larger than textures may be.
pub(super) fn upload(gpu: &Device, table: &ShaderTable) -> Result<wgpu::BindGroup, GpuFailure> {
    let counts = table.nodes.lengths();
    let size = [counts.phi, counts.ratio * counts.theta, counts.alpha];
    let most = gpu.wgpu.limits().max_texture_dimension_3d;
    let [width, height, depth] = size.map(|n| u32::try_from(n).unwrap_or(u32::MAX));
    if width > most || height > most || depth > most {
        return Err(GpuFailure::TableTooLarge { size, most });
    }
    let format = match table.format {
        TexelFormat::F32 => wgpu::TextureFormat::Rgba32Float,
        TexelFormat::F16 => wgpu::TextureFormat::Rgba16Float,
    };
    let bytes = |texels: &[[f32; 4]]| -> Vec<u8> {
        match table.format {
            TexelFormat::F32 => bytemuck::cast_slice(texels).to_vec(),
            TexelFormat::F16 => texels.as_flattened().iter().flat_map(|x| f16::from_f32(*x).to_le_bytes()).collect(),
        }
    };
    let views = [0, 1, 2].map(|i| {
        let descriptor = wgpu::TextureDescriptor {
            label: Some("table"),
            size: wgpu::Extent3d { width, height, depth_or_array_layers: depth },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D3,
            format,
            usage: wgpu::TextureUsages::TEXTURE_BINDING,
            view_formats: &[],
        };
        let order = wgpu::util::TextureDataOrder::LayerMajor;
        let texture = gpu.wgpu.create_texture_with_data(&gpu.queue, &descriptor, order, &bytes(&table.texels[i]));
        texture.create_view(&wgpu::TextureViewDescriptor::default())
    });
    let filter = if gpu.samples_weighed { wgpu::FilterMode::Linear } else { wgpu::FilterMode::Nearest };
    let sampler = gpu.wgpu.create_sampler(&wgpu::SamplerDescriptor {
        label: Some("table"),
        mag_filter: filter,
        min_filter: filter,
        ..Default::default()
    });
    let buffer = |contents: &[u8], usage| {
        gpu.wgpu.create_buffer_init(&wgpu::util::BufferInitDescriptor { label: Some("table"), contents, usage })
    };
    let counts = [counts.alpha, counts.ratio, counts.theta, counts.phi].map(|n| n as u32);
    let header = [counts, [table.layout_code(), u32::from(table.turns_with_view), 0, 0]];
    let header = buffer(bytemuck::cast_slice(&header), wgpu::BufferUsages::UNIFORM);
    let nodes: Vec<f32> = table.nodes.named().into_iter().flat_map(|(_, nodes)| nodes).copied().collect();
    let nodes = buffer(bytemuck::cast_slice(&nodes), wgpu::BufferUsages::STORAGE);
    let [a, b, c] = &views;
    let resources = [
        header.as_entire_binding(),
        nodes.as_entire_binding(),
        wgpu::BindingResource::TextureView(a),
        wgpu::BindingResource::TextureView(b),
        wgpu::BindingResource::TextureView(c),
        wgpu::BindingResource::Sampler(&sampler),
    ];
    Ok(bind(gpu, &gpu.table_layout, &resources))
}

/// A bind group of resources in the order of their bindings.
pub(super) fn bind(
    gpu: &Device,
    layout: &wgpu::BindGroupLayout,
    resources: &[wgpu::BindingResource<'_>],
) -> wgpu::BindGroup {
    let entries: Vec<wgpu::BindGroupEntry<'_>> = (0..)
        .zip(resources)
        .map(|(binding, resource)| wgpu::BindGroupEntry { binding, resource: resource.clone() })
        .collect();
    gpu.wgpu.create_bind_group(&wgpu::BindGroupDescriptor { label: None, layout, entries: &entries })
}
