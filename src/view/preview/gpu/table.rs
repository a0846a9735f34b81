//! Uploads a table to the GPU.

use half::f16;
use wgpu::util::DeviceExt as _;

use super::{GpuFailure, device::Device};
use crate::preview::{ShaderTable, TexelFormat};

/// Group 0 of the shaders for a table. Fails if the table exceeds the size limit of textures.
pub(super) fn upload(gpu: &Device, table: &ShaderTable) -> Result<wgpu::BindGroup, GpuFailure> {
    let [_, ratio, theta, phi] = table.axes.nodes.map(|n| n as usize);
    let layers = table.texels[0].len() / (ratio * theta * phi);
    let size = [phi, ratio * theta, layers];
    let most = gpu.wgpu.limits().max_texture_dimension_3d;
    if size.iter().any(|n| *n > most as usize) {
        return Err(GpuFailure::TooLarge { what: "table", size: size.to_vec(), most });
    }
    let views = table.texels.each_ref().map(|texels| texture(gpu, table, wgpu::TextureDimension::D3, texels));
    Ok(bound(gpu, table, &gpu.table_layout, &views))
}

/// A texture of some of the table's texels. The number of texels determines its depth, or the number of its layers.
pub(super) fn texture(
    gpu: &Device,
    table: &ShaderTable,
    dimension: wgpu::TextureDimension,
    texels: &[[f32; 4]],
) -> wgpu::TextureView {
    let [_, ratio, theta, phi] = table.axes.nodes.map(|n| n as usize);
    let (width, height) = (phi, ratio * theta);
    let (format, bytes) = match table.format {
        TexelFormat::F32 => (wgpu::TextureFormat::Rgba32Float, bytemuck::cast_slice(texels).to_vec()),
        TexelFormat::F16 => {
            let halves = texels.as_flattened().iter().flat_map(|x| f16::from_f32(*x).to_le_bytes());
            (wgpu::TextureFormat::Rgba16Float, halves.collect::<Vec<u8>>())
        }
    };
    let [width, height, depth] =
        [width, height, texels.len() / (width * height)].map(|n| u32::try_from(n).unwrap_or(u32::MAX));
    let descriptor = wgpu::TextureDescriptor {
        label: Some("table"),
        size: wgpu::Extent3d { width, height, depth_or_array_layers: depth },
        mip_level_count: 1,
        sample_count: 1,
        dimension,
        format,
        usage: wgpu::TextureUsages::TEXTURE_BINDING,
        view_formats: &[],
    };
    let order = wgpu::util::TextureDataOrder::LayerMajor;
    let texture = gpu.wgpu.create_texture_with_data(&gpu.queue, &descriptor, order, &bytes);
    let is_array = dimension == wgpu::TextureDimension::D2;
    let dimension = is_array.then_some(wgpu::TextureViewDimension::D2Array);
    texture.create_view(&wgpu::TextureViewDescriptor { dimension, ..Default::default() })
}

/// The bind group of a table, with these textures.
pub(super) fn bound(
    gpu: &Device,
    table: &ShaderTable,
    layout: &wgpu::BindGroupLayout,
    views: &[wgpu::TextureView],
) -> wgpu::BindGroup {
    let filter = if gpu.samples_weighed { wgpu::FilterMode::Linear } else { wgpu::FilterMode::Nearest };
    let sampler = gpu.wgpu.create_sampler(&wgpu::SamplerDescriptor {
        label: Some("table"),
        mag_filter: filter,
        min_filter: filter,
        ..Default::default()
    });
    let header = gpu.wgpu.create_buffer_init(&wgpu::util::BufferInitDescriptor {
        label: Some("table"),
        contents: bytemuck::cast_slice(&table.axes.words()),
        usage: wgpu::BufferUsages::UNIFORM,
    });
    let mut resources = vec![header.as_entire_binding()];
    resources.extend(views.iter().map(wgpu::BindingResource::TextureView));
    resources.push(wgpu::BindingResource::Sampler(&sampler));
    bind(gpu, layout, &resources)
}

/// A bind group of resources, in the order of their bindings.
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
