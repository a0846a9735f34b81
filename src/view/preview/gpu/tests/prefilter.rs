//! Runs the passes that prefilter a picture, as compute shaders or as fragment shaders.

use wgpu::util::DeviceExt as _;

use super::super::{
    GpuFailure, Weights,
    device::{Device, buffer},
};
use ltcforge_light::textured::LightImage;
use ltcforge_shaders::joined;

/// The kind of shader that runs the passes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::preview) enum Passes {
    Compute,
    Fragment,
}

/// The programs that call the functions. A pass has the size of its target.
const PROGRAMS: &str = "
struct Pass { picture: vec2<u32>, fine: vec2<u32>, coarse: vec2<u32>, level: u32, kind: u32 }
@group(0) @binding(2) var<uniform> made: Pass;
@group(0) @binding(3) var written: texture_storage_2d<rgba32float, write>;

fn of_texel(texel: vec2<u32>) -> vec4<f32> {
    switch made.kind {
        case 0u: { return vec4(prefilter_halved(texel, made.fine, made.coarse), 1.0); }
        case 1u: { return vec4(prefilter_row(texel.y, made.picture.x), 1.0); }
        case 2u: { return vec4(prefilter_mean(made.picture.y), 1.0); }
        default: { return vec4(prefilter_level(texel, made.picture, made.level), 1.0); }
    }
}

@compute @workgroup_size(8, 8)
fn computed(@builtin(global_invocation_id) at: vec3<u32>) {
    if all(at.xy < textureDimensions(written)) { textureStore(written, at.xy, of_texel(at.xy)); }
}

@vertex
fn corner(@builtin(vertex_index) i: u32) -> @builtin(position) vec4<f32> {
    return vec4(f32(i & 1u) * 4.0 - 1.0, f32(i >> 1u) * 4.0 - 1.0, 0.0, 1.0);
}

@fragment
fn painted(@builtin(position) at: vec4<f32>) -> @location(0) vec4<f32> {
    return of_texel(vec2<u32>(at.xy));
}
";

const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba32Float;

/// A pass, with its kind, sizes and level.
#[derive(Debug, Clone, Copy)]
struct Pass {
    kind: u32,
    fine: [u32; 2],
    coarse: [u32; 2],
    level: u32,
}

/// The levels of a picture's pyramid, the finest first. A texel is red, green, blue and one.
pub(in crate::preview) fn run(image: &LightImage, passes: Passes) -> Result<Vec<Vec<[f32; 4]>>, GpuFailure> {
    let runner = Runner::new(Device::open(Weights::default())?, passes);
    let picture = [image.width() as u32, image.height() as u32];
    let count = picture[0].max(picture[1]).ilog2() + 1;
    let size = |level: u32| picture.map(|side| (side >> level).max(1));
    let texels: Vec<f32> = image.texels().iter().flat_map(|[r, g, b]| [*r, *g, *b, 1.0]).collect();
    let mut chain = vec![runner.texture(picture, Some(&texels))];
    let pass = |kind, level: u32| Pass { kind, fine: size(level.max(1) - 1), coarse: size(level), level };
    for level in 1..count.saturating_sub(1) {
        let source = &chain[level as usize - 1];
        chain.push(runner.made(picture, pass(0, level), source, source, size(level)));
    }
    let rows = runner.made(picture, pass(1, 0), &chain[0], &chain[0], [1, picture[1]]);
    let mut levels = vec![runner.made(picture, pass(2, 0), &rows, &rows, [1, 1])];
    for level in (0..count - 1).rev() {
        let above = &levels[levels.len() - 1];
        levels.push(runner.made(picture, pass(3, level), &chain[level as usize], above, size(level)));
    }
    levels.iter().rev().map(|level| runner.read(level)).collect()
}

struct Runner {
    gpu: Device,
    layout: wgpu::BindGroupLayout,
    program: Program,
}

enum Program {
    Compute(wgpu::ComputePipeline),
    Fragment(wgpu::RenderPipeline),
}

impl Runner {
    fn new(gpu: Device, passes: Passes) -> Self {
        let source = wgpu::ShaderSource::Wgsl((joined(&["prefilter"]) + PROGRAMS).into());
        let module = gpu.wgpu.create_shader_module(wgpu::ShaderModuleDescriptor { label: None, source });
        let texture = wgpu::BindingType::Texture {
            sample_type: wgpu::TextureSampleType::Float { filterable: false },
            view_dimension: wgpu::TextureViewDimension::D2,
            multisampled: false,
        };
        let written = wgpu::BindingType::StorageTexture {
            access: wgpu::StorageTextureAccess::WriteOnly,
            format: FORMAT,
            view_dimension: wgpu::TextureViewDimension::D2,
        };
        let uniform = buffer(wgpu::BufferBindingType::Uniform);
        let mut bindings = vec![texture, texture, uniform];
        bindings.extend((passes == Passes::Compute).then_some(written));
        let visibility = match passes {
            Passes::Compute => wgpu::ShaderStages::COMPUTE,
            Passes::Fragment => wgpu::ShaderStages::FRAGMENT,
        };
        let entry = |(binding, ty)| wgpu::BindGroupLayoutEntry { binding, visibility, ty, count: None };
        let entries: Vec<_> = (0..).zip(bindings).map(entry).collect();
        let layout =
            gpu.wgpu.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: None, entries: &entries });
        let pipeline_layout = gpu.wgpu.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: None,
            bind_group_layouts: &[Some(&layout)],
            immediate_size: 0,
        });
        let program = match passes {
            Passes::Compute => Program::Compute(gpu.wgpu.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
                label: None,
                layout: Some(&pipeline_layout),
                module: &module,
                entry_point: Some("computed"),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                cache: None,
            })),
            Passes::Fragment => Program::Fragment(gpu.wgpu.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
                label: None,
                layout: Some(&pipeline_layout),
                vertex: wgpu::VertexState {
                    module: &module,
                    entry_point: Some("corner"),
                    compilation_options: wgpu::PipelineCompilationOptions::default(),
                    buffers: &[],
                },
                primitive: wgpu::PrimitiveState::default(),
                depth_stencil: None,
                multisample: wgpu::MultisampleState::default(),
                fragment: Some(wgpu::FragmentState {
                    module: &module,
                    entry_point: Some("painted"),
                    compilation_options: wgpu::PipelineCompilationOptions::default(),
                    targets: &[Some(FORMAT.into())],
                }),
                multiview_mask: None,
                cache: None,
            })),
        };
        Self { gpu, layout, program }
    }

    fn texture(&self, [width, height]: [u32; 2], texels: Option<&[f32]>) -> wgpu::Texture {
        let usage = wgpu::TextureUsages::TEXTURE_BINDING
            | wgpu::TextureUsages::COPY_SRC
            | match self.program {
                Program::Compute(_) => wgpu::TextureUsages::STORAGE_BINDING,
                Program::Fragment(_) => wgpu::TextureUsages::RENDER_ATTACHMENT,
            };
        let descriptor = wgpu::TextureDescriptor {
            label: None,
            size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: FORMAT,
            usage,
            view_formats: &[],
        };
        match texels {
            None => self.gpu.wgpu.create_texture(&descriptor),
            Some(texels) => {
                let order = wgpu::util::TextureDataOrder::LayerMajor;
                let bytes = bytemuck::cast_slice(texels);
                self.gpu.wgpu.create_texture_with_data(&self.gpu.queue, &descriptor, order, bytes)
            }
        }
    }

    /// Creates the texture that a pass writes.
    fn made(
        &self,
        picture: [u32; 2],
        pass: Pass,
        source: &wgpu::Texture,
        above: &wgpu::Texture,
        size: [u32; 2],
    ) -> wgpu::Texture {
        let target = self.texture(size, None);
        let view = |texture: &wgpu::Texture| texture.create_view(&wgpu::TextureViewDescriptor::default());
        let Pass { kind, fine, coarse, level } = pass;
        let words = [picture[0], picture[1], fine[0], fine[1], coarse[0], coarse[1], level, kind];
        let uniform = self.gpu.wgpu.create_buffer_init(&wgpu::util::BufferInitDescriptor {
            label: None,
            contents: bytemuck::cast_slice(&words),
            usage: wgpu::BufferUsages::UNIFORM,
        });
        let (source, above, written) = (view(source), view(above), view(&target));
        let mut resources = vec![
            wgpu::BindingResource::TextureView(&source),
            wgpu::BindingResource::TextureView(&above),
            uniform.as_entire_binding(),
        ];
        if matches!(self.program, Program::Compute(_)) {
            resources.push(wgpu::BindingResource::TextureView(&written));
        }
        let entries: Vec<_> =
            (0..).zip(resources).map(|(binding, resource)| wgpu::BindGroupEntry { binding, resource }).collect();
        let group = self.gpu.wgpu.create_bind_group(&wgpu::BindGroupDescriptor {
            label: None,
            layout: &self.layout,
            entries: &entries,
        });
        let mut encoder = self.gpu.wgpu.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        match &self.program {
            Program::Compute(pipeline) => {
                let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
                pass.set_pipeline(pipeline);
                pass.set_bind_group(0, &group, &[]);
                pass.dispatch_workgroups(size[0].div_ceil(8), size[1].div_ceil(8), 1);
            }
            Program::Fragment(pipeline) => {
                let attachment = wgpu::RenderPassColorAttachment {
                    view: &written,
                    depth_slice: None,
                    resolve_target: None,
                    ops: wgpu::Operations::default(),
                };
                let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
                    color_attachments: &[Some(attachment)],
                    ..Default::default()
                });
                pass.set_pipeline(pipeline);
                pass.set_bind_group(0, &group, &[]);
                pass.draw(0..3, 0..1);
            }
        }
        self.gpu.queue.submit([encoder.finish()]);
        target
    }

    fn read(&self, texture: &wgpu::Texture) -> Result<Vec<[f32; 4]>, GpuFailure> {
        let failed = |error: &dyn std::fmt::Display| GpuFailure::Failed(error.to_string());
        let (width, height) = (texture.width(), texture.height());
        let row_bytes = (width * 16).next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
        let all = self.gpu.wgpu.create_buffer(&wgpu::BufferDescriptor {
            label: None,
            size: u64::from(row_bytes * height),
            usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let mut encoder = self.gpu.wgpu.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        let layout = wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(row_bytes), rows_per_image: None };
        let to = wgpu::TexelCopyBufferInfo { buffer: &all, layout };
        encoder.copy_texture_to_buffer(texture.as_image_copy(), to, texture.size());
        self.gpu.queue.submit([encoder.finish()]);
        all.slice(..).map_async(wgpu::MapMode::Read, |_| {});
        self.gpu.wgpu.poll(wgpu::PollType::wait_indefinitely()).map_err(|error| failed(&error))?;
        self.gpu.check()?;
        let view = all.slice(..).get_mapped_range().map_err(|error| failed(&error))?;
        let rows = view.chunks_exact(row_bytes as usize).map(|row| &row[..width as usize * 16]);
        Ok(rows.flat_map(bytemuck::pod_collect_to_vec::<u8, [f32; 4]>).collect())
    }
}
