//! Opens the GPU and runs shaders on it.

use std::time::Instant;

use ltcforge::{Error, Table};
use naga::{AddressSpace, TypeInner};
use wgpu::util::DeviceExt as _;

use super::textures::{pictures, texels, texture};
use crate::gpu_costs::Program;

/// Lights per pixel, as in [`MAIN`].
const LIGHTS: u32 = 16;
/// Light must reach at least this part of the pixels. Otherwise the study reports an error.
const LEAST_LIT: f64 = 0.5;
/// A rectangle on the floor that faces the camera. The camera is at the origin.
const LIGHT: [[f32; 4]; 4] =
    [[-3.0, 9.0, 2.0, 0.0], [3.0, 9.0, 2.0, 0.0], [3.0, 9.0, -1.2, 0.0], [-3.0, 9.0, -1.2, 0.0]];
const MAIN: &str = "
@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    var surface = surfaces[id.x];
    var sum = vec4(0.0);
    for (var i = 0u; i < 16u; i++) {
        sum += lit(surface.alpha, local_view(surface));
        surface.position.x += 0.05;
        surface.alpha = max(fract(surface.alpha + 0.137), vec2(0.05));
    }
    reflected[id.x] = sum;
}
";

/// How much work the study does.
pub struct Effort {
    /// Size of the picture in pixels.
    pub picture: [u32; 2],
    /// Runs of each shader. The study prints their median.
    pub runs: usize,
    /// The least duration of a run, in seconds. It is far longer than the submission takes.
    pub least: f64,
}

impl Effort {
    /// A full screen. All shaders together take a few seconds on a GPU, and an hour on a processor.
    pub const WHOLE: Self = Self { picture: [1920, 1080], runs: 15, least: 0.03 };
}

/// The reason that shaders were not timed.
#[derive(Debug, thiserror::Error)]
pub enum TimesError {
    /// No GPU can run these shaders.
    #[error("no GPU can run the shaders: {0}")]
    Gpu(String),
    /// The table of a shader could not be fitted.
    #[error(transparent)]
    Table(#[from] Error),
    /// A shader has errors or lights nothing.
    #[error("{name}: {reason}")]
    Text {
        /// The shader.
        name: String,
        /// The error.
        reason: String,
    },
}

/// A device, and the picture that the shaders light on it.
pub(super) struct Gpu {
    pub(super) name: String,
    device: wgpu::Device,
    queue: wgpu::Queue,
    surfaces: wgpu::Buffer,
    reflected: wgpu::Buffer,
    light: wgpu::Buffer,
    pixels: u32,
}

impl Gpu {
    pub(super) fn open(effort: &Effort) -> Result<Self, TimesError> {
        let absent = |error: &dyn std::fmt::Display| TimesError::Gpu(error.to_string());
        let instance = wgpu::Instance::new(wgpu::InstanceDescriptor {
            backends: wgpu::Backends::VULKAN,
            ..wgpu::InstanceDescriptor::new_without_display_handle()
        });
        let options = wgpu::RequestAdapterOptions {
            power_preference: wgpu::PowerPreference::HighPerformance,
            ..Default::default()
        };
        let adapter = pollster::block_on(instance.request_adapter(&options)).map_err(|error| absent(&error))?;
        let descriptor = wgpu::DeviceDescriptor::default();
        let (device, queue) =
            pollster::block_on(adapter.request_device(&descriptor)).map_err(|error| absent(&error))?;
        let surfaces = surfaces(effort.picture);
        let pixels = u32::try_from(surfaces.len()).unwrap_or(u32::MAX);
        let buffer = |contents: &[u8], usage| {
            device.create_buffer_init(&wgpu::util::BufferInitDescriptor { label: None, contents, usage })
        };
        let info = adapter.get_info();
        Ok(Self {
            name: format!("{}, {}", info.name, info.driver_info),
            surfaces: buffer(bytemuck::cast_slice(&surfaces), wgpu::BufferUsages::STORAGE),
            reflected: device.create_buffer(&wgpu::BufferDescriptor {
                label: None,
                size: u64::from(pixels) * 16,
                usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC,
                mapped_at_creation: false,
            }),
            light: buffer(bytemuck::cast_slice(&LIGHT), wgpu::BufferUsages::UNIFORM),
            device,
            queue,
            pixels,
        })
    }

    /// Milliseconds per light for the whole picture: the median of the runs.
    pub(super) fn milliseconds(
        &self,
        program: &Program,
        table: Option<&Table>,
        effort: &Effort,
    ) -> Result<f64, TimesError> {
        let refused = |reason: String| TimesError::Text { name: program.name.clone(), reason };
        let (pipeline, groups) = self.pipeline(program, table).map_err(refused)?;
        self.run(&pipeline, &groups, 1).map_err(refused)?;
        let lit = self.part_lit().map_err(refused)?;
        if lit < LEAST_LIT {
            return Err(refused(format!("light reaches {lit:.2} of the pixels, but must reach at least {LEAST_LIT}")));
        }
        let mut dispatches = 1;
        let mut seconds = self.run(&pipeline, &groups, dispatches).map_err(refused)?;
        while seconds < effort.least {
            dispatches *= 2;
            seconds = self.run(&pipeline, &groups, dispatches).map_err(refused)?;
        }
        let mut runs = Vec::new();
        for _ in 0..effort.runs {
            runs.push(self.run(&pipeline, &groups, dispatches).map_err(refused)?);
        }
        runs.sort_by(f64::total_cmp);
        Ok(1e3 * runs[runs.len() / 2] / f64::from(dispatches * LIGHTS))
    }

    fn pipeline(
        &self,
        program: &Program,
        table: Option<&Table>,
    ) -> Result<(wgpu::ComputePipeline, wgpu::BindGroup), String> {
        let wgsl = format!("{}{MAIN}", program.wgsl);
        let module = naga::front::wgsl::parse_str(&wgsl).map_err(|error| error.emit_to_string(&wgsl))?;
        let descriptor = wgpu::ShaderModuleDescriptor { label: None, source: wgpu::ShaderSource::Wgsl(wgsl.into()) };
        let shader = self.device.create_shader_module(descriptor);
        let overrides = module.overrides.iter().filter_map(|(_, known)| known.name.as_deref());
        let constants: Vec<(&str, f64)> =
            overrides.filter(|name| *name == "ltc_hardware_filter").map(|name| (name, 1.0)).collect();
        let pipeline = self.device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: None,
            layout: None,
            module: &shader,
            entry_point: Some("main"),
            compilation_options: wgpu::PipelineCompilationOptions { constants: &constants, ..Default::default() },
            cache: None,
        });
        let sampler = self.device.create_sampler(&wgpu::SamplerDescriptor {
            mag_filter: wgpu::FilterMode::Linear,
            min_filter: wgpu::FilterMode::Linear,
            mipmap_filter: wgpu::MipmapFilterMode::Linear,
            ..Default::default()
        });
        let header = table.map(|table| {
            self.device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
                label: None,
                contents: bytemuck::cast_slice(&table.shader_axes().words()),
                usage: wgpu::BufferUsages::UNIFORM,
            })
        });
        let texels = table.map(texels);
        let mut views = Vec::new();
        let mut parts = texels.iter().flatten();
        let mut buffers = vec![(10, &self.surfaces), (11, &self.reflected), (12, &self.light)];
        let mut samplers = Vec::new();
        for (_, global) in module.global_variables.iter() {
            let Some(binding) = global.binding.as_ref().map(|binding| binding.binding) else { continue };
            match (global.space, &module.types[global.ty].inner) {
                (AddressSpace::Uniform, _) if binding == 0 => buffers.extend(header.as_ref().map(|header| (0, header))),
                (_, TypeInner::Sampler { .. }) => samplers.push(binding),
                (_, TypeInner::Image { arrayed: true, .. }) => {
                    views.push((binding, pictures((&self.device, &self.queue))));
                }
                (_, TypeInner::Image { dim, .. }) => {
                    views.push((binding, texture((&self.device, &self.queue), *dim, table.zip(parts.next()))));
                }
                _ => {}
            }
        }
        let of_buffers = buffers.iter().map(|(binding, buffer)| (*binding, buffer.as_entire_binding()));
        let of_views = views.iter().map(|(binding, view)| (*binding, wgpu::BindingResource::TextureView(view)));
        let of_samplers = samplers.iter().map(|binding| (*binding, wgpu::BindingResource::Sampler(&sampler)));
        let entries: Vec<_> = of_buffers
            .chain(of_views)
            .chain(of_samplers)
            .map(|(binding, resource)| wgpu::BindGroupEntry { binding, resource })
            .collect();
        let group = self.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: None,
            layout: &pipeline.get_bind_group_layout(0),
            entries: &entries,
        });
        Ok((pipeline, group))
    }

    /// Duration of `dispatches` dispatches, in seconds.
    fn run(&self, pipeline: &wgpu::ComputePipeline, group: &wgpu::BindGroup, dispatches: u32) -> Result<f64, String> {
        let mut encoder = self.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
        pass.set_pipeline(pipeline);
        pass.set_bind_group(0, group, &[]);
        for _ in 0..dispatches {
            pass.dispatch_workgroups(self.pixels / 64, 1, 1);
        }
        drop(pass);
        let commands = encoder.finish();
        let start = Instant::now();
        self.queue.submit([commands]);
        self.device.poll(wgpu::PollType::wait_indefinitely()).map_err(|error| error.to_string())?;
        Ok(start.elapsed().as_secs_f64())
    }

    /// The part of the pixels that the light reaches.
    fn part_lit(&self) -> Result<f64, String> {
        let size = self.reflected.size();
        let copy = self.device.create_buffer(&wgpu::BufferDescriptor {
            label: None,
            size,
            usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
            mapped_at_creation: false,
        });
        let mut encoder = self.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        encoder.copy_buffer_to_buffer(&self.reflected, 0, &copy, 0, size);
        self.queue.submit([encoder.finish()]);
        copy.map_async(wgpu::MapMode::Read, .., |_| {});
        self.device.poll(wgpu::PollType::wait_indefinitely()).map_err(|error| error.to_string())?;
        let bytes = copy.get_mapped_range(..).map_err(|error| error.to_string())?;
        let lit = bytemuck::cast_slice::<u8, [f32; 4]>(&bytes).iter().filter(|sum| sum[0].is_finite() && sum[0] > 0.0);
        Ok(lit.count() as f64 / f64::from(self.pixels))
    }
}

/// The floor as a camera 1.5 above it sees it, in blocks of eight by eight pixels. A pixel has normal, alphas, position
/// and padding.
fn surfaces([width, height]: [u32; 2]) -> Vec<[f32; 8]> {
    let tiles = (0..height / 8).flat_map(|y| (0..width / 8).map(move |x| [8 * x, 8 * y]));
    let pixel = |[x, y]: [u32; 2]| {
        let [u, v] = [f64::from(x) / f64::from(width) - 0.5, f64::from(y) / f64::from(height)];
        let distance = 2.0 / (0.25 + 0.75 * v);
        let alpha = 0.05 + 0.9 * (u + 0.5);
        let bump = 0.05 * (40.0 * u).sin();
        [bump, 0.0, alpha, 0.5 * alpha + 0.02, 1.6 * u * distance, distance, -1.5, 0.0].map(|x| x as f32)
    };
    tiles.flat_map(|[x, y]| (0..64).map(move |i| pixel([x + i % 8, y + i / 8]))).collect()
}
