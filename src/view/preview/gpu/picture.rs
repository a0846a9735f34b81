//! Uploads the picture of a light to the GPU.

use half::f16;
use wgpu::util::DeviceExt as _;

use super::{
    GpuFailure,
    device::{Device, FLOATS},
    table::bind,
};
use crate::preview::light_picture::LightPicture;
use ltcforge_light::textured::LightImage;

/// Group 2 of the shaders. Without a picture, each texture is one black texel. Fails if the picture exceeds the size
/// limit of textures.
pub(super) fn upload(gpu: &Device, picture: Option<&LightPicture>) -> Result<wgpu::BindGroup, GpuFailure> {
    let most = gpu.wgpu.limits().max_texture_dimension_2d;
    let images = picture.iter().flat_map(|picture| [&*picture.image, &picture.pyramid.levels()[0]]);
    if let Some(image) = images.into_iter().find(|image| image.width().max(image.height()) > most as usize) {
        return Err(GpuFailure::TooLarge { what: "picture", size: vec![image.width(), image.height()], most });
    }
    let image = picture.map_or(BLACK, |picture| Level::of(&picture.image));
    let levels = picture.map_or(vec![BLACK], |picture| picture.pyramid.levels().iter().map(Level::of).collect());
    let image = texture(gpu, &[image], FLOATS);
    let levels = texture(gpu, &levels, gpu.picture_format);
    let image = image.create_view(&wgpu::TextureViewDescriptor::default());
    let dimension = Some(wgpu::TextureViewDimension::D2Array);
    let levels = levels.create_view(&wgpu::TextureViewDescriptor { dimension, ..Default::default() });
    let sampler = gpu.wgpu.create_sampler(&wgpu::SamplerDescriptor {
        label: Some("picture"),
        mag_filter: wgpu::FilterMode::Linear,
        min_filter: wgpu::FilterMode::Linear,
        mipmap_filter: wgpu::MipmapFilterMode::Linear,
        ..Default::default()
    });
    let views = [&image, &levels].map(wgpu::BindingResource::TextureView);
    let resources: Vec<_> = views.into_iter().chain([wgpu::BindingResource::Sampler(&sampler)]).collect();
    Ok(bind(gpu, &gpu.picture_layout, &resources))
}

/// The width and height of a level, and its texels.
struct Level<'a> {
    size: [usize; 2],
    texels: &'a [[f32; 3]],
}

/// A single texel.
const BLACK: Level<'static> = Level { size: [1, 1], texels: &[[0.0; 3]] };

impl<'a> Level<'a> {
    fn of(image: &'a LightImage) -> Self {
        Self { size: [image.width(), image.height()], texels: image.texels() }
    }

    fn bytes(&self, format: wgpu::TextureFormat) -> Vec<u8> {
        let numbers = self.texels.iter().flat_map(|[r, g, b]| [*r, *g, *b, 1.0]);
        if format == FLOATS {
            return numbers.flat_map(f32::to_ne_bytes).collect();
        }
        numbers.flat_map(|x| f16::from_f32(x.min(f16::MAX.to_f32())).to_ne_bytes()).collect()
    }
}

/// A texture with these levels, the finest first.
fn texture(gpu: &Device, levels: &[Level<'_>], format: wgpu::TextureFormat) -> wgpu::Texture {
    let [width, height] = levels.first().map_or([1, 1], |level| level.size);
    let [width, height, count] = [width, height, levels.len()].map(|n| u32::try_from(n).unwrap_or(u32::MAX));
    let descriptor = wgpu::TextureDescriptor {
        label: Some("picture"),
        size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
        mip_level_count: count,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage: wgpu::TextureUsages::TEXTURE_BINDING,
        view_formats: &[],
    };
    let bytes: Vec<u8> = levels.iter().flat_map(|level| level.bytes(format)).collect();
    gpu.wgpu.create_texture_with_data(&gpu.queue, &descriptor, wgpu::util::TextureDataOrder::LayerMajor, &bytes)
}
