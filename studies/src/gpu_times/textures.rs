//! The bindings of shaders: a table's entries or textures with the size that engines use, and pictures on lights.

use std::iter;

use half::f16;
use ltcforge::Table;
use naga::ImageDimension;
use wgpu::util::DeviceExt as _;

/// The number of pictures on lights, and the binary logarithm of their side length.
const PICTURES: usize = 8;
const PICTURE_LEVEL: u32 = 8;

/// The texels of a table, or unit matrices in textures with the size that engines use.
pub(super) fn texture(
    (device, queue): (&wgpu::Device, &wgpu::Queue),
    dimension: ImageDimension,
    table: Option<(&Table, &Vec<[f16; 4]>)>,
) -> wgpu::TextureView {
    let [zero, one] = [f16::ZERO, f16::ONE];
    let is_flat = dimension == ImageDimension::D2;
    let (size, texels) = match table {
        Some((table, texels)) => {
            let axes = table.axes();
            let [width, height] = [axes.phi.len(), axes.ratio.len() * axes.theta.len()];
            ([width, height, texels.len() / (width * height)], texels.clone())
        }
        // In the isotropic table, the first and the last of the four numbers are diagonal elements of the inverse.
        None if is_flat => ([64, 64, 1], vec![[one, zero, zero, one]; 64 * 64]),
        None => ([8, 8, 64], vec![[one, zero, zero, zero]; 8 * 8 * 64]),
    };
    let [width, height, depth_or_array_layers] = size.map(|n| u32::try_from(n).unwrap_or(u32::MAX));
    let descriptor = wgpu::TextureDescriptor {
        label: None,
        size: wgpu::Extent3d { width, height, depth_or_array_layers },
        mip_level_count: 1,
        sample_count: 1,
        dimension: if is_flat { wgpu::TextureDimension::D2 } else { wgpu::TextureDimension::D3 },
        format: wgpu::TextureFormat::Rgba16Float,
        usage: wgpu::TextureUsages::TEXTURE_BINDING,
        view_formats: &[],
    };
    let order = wgpu::util::TextureDataOrder::LayerMajor;
    let bytes: Vec<u8> = texels.as_flattened().iter().flat_map(|x| x.to_le_bytes()).collect();
    let texture = device.create_texture_with_data(queue, &descriptor, order, &bytes);
    texture.create_view(&wgpu::TextureViewDescriptor::default())
}

/// Pictures on lights, one per layer, with noise on all levels.
pub(super) fn pictures((device, queue): (&wgpu::Device, &wgpu::Queue)) -> wgpu::TextureView {
    let mut state = 1_u32;
    let texels = PICTURES * (0..=PICTURE_LEVEL).map(|level| 1 << (2 * level)).sum::<usize>();
    let noise = iter::repeat_with(|| {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        f16::from_f32((state >> 24) as f32 / 256.0).to_le_bytes()
    });
    let bytes: Vec<u8> = noise.take(4 * texels).flatten().collect();
    let side = 1 << PICTURE_LEVEL;
    let descriptor = wgpu::TextureDescriptor {
        label: None,
        size: wgpu::Extent3d { width: side, height: side, depth_or_array_layers: PICTURES as u32 },
        mip_level_count: PICTURE_LEVEL + 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: wgpu::TextureFormat::Rgba16Float,
        usage: wgpu::TextureUsages::TEXTURE_BINDING,
        view_formats: &[],
    };
    let order = wgpu::util::TextureDataOrder::LayerMajor;
    let texture = device.create_texture_with_data(queue, &descriptor, order, &bytes);
    let dimension = Some(wgpu::TextureViewDimension::D2Array);
    texture.create_view(&wgpu::TextureViewDescriptor { dimension, ..Default::default() })
}

/// `m00 m01 m02 m10`, `m11 m12 m20 m21`, `m22 amplitude fresnel 0` of each entry, then of each second lobe.
pub(super) fn texels(table: &Table) -> [Vec<[f16; 4]>; 3] {
    let terms = |i: usize| table.terms().map_or([1.0, 0.0], |terms| [terms.amplitude()[i], terms.fresnel()[i]]);
    let lobes = [Some(table.matrices()), table.second_matrices()].into_iter().flatten();
    let entries: Vec<[f32; 12]> = lobes
        .flat_map(|lobe| {
            lobe.iter().enumerate().map(|(i, [a, b, c, d, e, f, g, h, k])| {
                let [amplitude, fresnel] = terms(i);
                [*a, *b, *c, *d, *e, *f, *g, *h, *k, amplitude, fresnel, 0.0]
            })
        })
        .collect();
    let part =
        |first: usize| entries.iter().map(|entry| [0, 1, 2, 3].map(|i| f16::from_f32(entry[first + i]))).collect();
    [part(0), part(4), part(8)]
}
