//! Times of the texts on the GPU that is there: the programs of [`gpu_costs`](crate::gpu_costs), run.
//!
//! Each pixel of a picture is a place on a floor, as a camera sees it, with [`LIGHTS`] rectangles one after another, each from
//! a place and by a roughness of its own, so that nothing is computed once for all and what a pixel reads and writes counts
//! little. The frame and the corners that are turned into it are part of it, as they are of a surface in an engine.

use std::{
    collections::{HashMap, hash_map::Entry},
    fmt::Write as _,
    time::Instant,
};

use half::f16;
use ltcforge::{Error, Layout, Recipe, RecipeDocument as _, SecondLobe, Table, shaders::GpuCost};
use naga::{AddressSpace, ImageDimension, TypeInner};
use wgpu::util::DeviceExt as _;

use crate::{
    gpu_costs::{Program, programs},
    tables::fitted,
};

/// Lights of a pixel; [`MAIN`] has them too.
const LIGHTS: u32 = 16;
/// The part of the pixels that light has to reach, or nothing was measured.
const LEAST_LIT: f64 = 0.5;
/// A rectangle that stands on the floor and faces the camera, at the origin.
const LIGHT: [[f32; 4]; 4] =
    [[-3.0, 9.0, 2.0, 0.0], [3.0, 9.0, 2.0, 0.0], [3.0, 9.0, -1.2, 0.0], [-3.0, 9.0, -1.2, 0.0]];
/// The text that others are compared with: what engines pay.
const STOCK: &str = "ltc2017, clipless";

const MAIN: &str = "
@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    var surface = surfaces[id.x];
    var sum = vec4(0.0);
    for (var i = 0u; i < 16u; i++) {
        sum += lit(surface.alpha, seen_from(surface));
        surface.position.x += 0.05;
        surface.alpha = max(fract(surface.alpha + 0.137), vec2(0.05));
    }
    reflected[id.x] = sum;
}
";

/// How much is run.
pub struct Effort {
    /// Pixels of the picture.
    pub picture: [u32; 2],
    /// Runs of each text, of which the median is told.
    pub runs: usize,
    /// The least seconds of a run, far more than it takes to submit one.
    pub least: f64,
}

impl Effort {
    /// A screen; a few seconds for all texts on a GPU, an hour on a processor.
    pub const WHOLE: Self = Self { picture: [1920, 1080], runs: 15, least: 0.03 };
}

/// Why nothing was timed.
#[derive(Debug, thiserror::Error)]
pub enum TimesError {
    /// No GPU, or none that runs these texts.
    #[error("no GPU to time texts on: {0}")]
    Gpu(String),
    /// No table to read.
    #[error(transparent)]
    Table(#[from] Error),
    /// A text with faults, or one that lights nothing.
    #[error("{name}: {reason}")]
    Text {
        /// The text.
        name: String,
        /// What is wrong.
        reason: String,
    },
}

/// A row a text, in Markdown: milliseconds a light over the picture, their ratio to [`STOCK`], and that of the counts of
/// `gpu-costs`.
///
/// # Errors
/// [`TimesError`]
pub fn told(effort: &Effort) -> Result<String, TimesError> {
    let gpu = Gpu::open(effort)?;
    let mut tables = HashMap::new();
    let mut rows = Vec::new();
    for program in programs() {
        let table = match program.table {
            None => None,
            Some(wanted) => Some(match tables.entry(wanted) {
                Entry::Occupied(known) => known.into_mut(),
                Entry::Vacant(new) => new.insert(table(wanted)?),
            }),
        };
        let time = gpu.milliseconds(&program, table.as_deref(), effort)?;
        rows.push((program.name, time));
    }
    let stock = rows.iter().find(|(name, _)| name == STOCK).map_or(f64::NAN, |(_, time)| *time);
    let counted = |name: &str| GpuCost::of(name).map_or(f64::NAN, |cost| f64::from(cost.inverse_throughput));
    let [width, height] = effort.picture;
    let mut out = format!(
        "{}, {width} x {height} pixels, one light\n\n| text | ms | of engines' | counted |\n|---|---|---|---|\n",
        gpu.name
    );
    for (name, time) in rows {
        let counted = counted(&name) / counted(STOCK);
        // Writing to a String cannot fail.
        let _ = writeln!(out, "| {name} | {time:.3} | {:.2} | {counted:.2} |", time / stock);
    }
    Ok(out)
}

/// A table of the default axes. Fitted with little, since no time depends on it.
fn table((layout, has_two): (Layout, bool)) -> Result<Table, Error> {
    let builder = Recipe::builder().layout(layout).samples(64).directions(8).steps(4);
    let builder = if has_two { builder.two_lobes(SecondLobe::Blended) } else { builder };
    Ok(fitted(&builder.build()?))
}

struct Gpu {
    name: String,
    device: wgpu::Device,
    queue: wgpu::Queue,
    surfaces: wgpu::Buffer,
    reflected: wgpu::Buffer,
    light: wgpu::Buffer,
    pixels: u32,
}

impl Gpu {
    fn open(effort: &Effort) -> Result<Self, TimesError> {
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

    /// Milliseconds of a light over the picture, the median of the runs.
    fn milliseconds(&self, program: &Program, table: Option<&Table>, effort: &Effort) -> Result<f64, TimesError> {
        let refused = |reason: String| TimesError::Text { name: program.name.clone(), reason };
        let (pipeline, groups) = self.pipeline(program, table).map_err(refused)?;
        self.run(&pipeline, &groups, 1).map_err(refused)?;
        let lit = self.part_lit().map_err(refused)?;
        if lit < LEAST_LIT {
            return Err(refused(format!("light reaches {lit:.2} of the pixels, at least {LEAST_LIT} are wanted")));
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
        let mut buffers = vec![(10, &self.surfaces), (11, &self.reflected), (12, &self.light)];
        let mut samplers = Vec::new();
        for (_, global) in module.global_variables.iter() {
            let Some(binding) = global.binding.as_ref().map(|binding| binding.binding) else { continue };
            match (global.space, &module.types[global.ty].inner) {
                (AddressSpace::Uniform, _) if binding == 0 => buffers.extend(header.as_ref().map(|header| (0, header))),
                (_, TypeInner::Sampler { .. }) => samplers.push(binding),
                (_, TypeInner::Image { dim, .. }) => {
                    let part = views.len();
                    views.push((binding, self.texture(*dim, table.zip(texels.as_ref().map(|texels| &texels[part])))));
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

    /// A table's texels, or a matrix of ones in the size of engines' textures.
    fn texture(&self, dimension: ImageDimension, table: Option<(&Table, &Vec<[f16; 4]>)>) -> wgpu::TextureView {
        let [zero, one] = [f16::ZERO, f16::ONE];
        let is_flat = dimension == ImageDimension::D2;
        let (size, texels) = match table {
            Some((table, texels)) => {
                let axes = table.axes();
                let [width, height] = [axes.phi.len(), axes.ratio.len() * axes.theta.len()];
                ([width, height, texels.len() / (width * height)], texels.clone())
            }
            // The inverse of the isotropic table has its second one last.
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
        let texture = self.device.create_texture_with_data(&self.queue, &descriptor, order, &bytes);
        texture.create_view(&wgpu::TextureViewDescriptor::default())
    }

    /// Seconds until as many dispatches are done.
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

    /// The part of the pixels that light reaches.
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

/// The floor as a camera 1.5 above it sees it, eight by eight pixels after another: normal, alphas, position, padding.
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

/// `m00 m01 m02 m10`, `m11 m12 m20 m21`, `m22 amplitude fresnel 0` of each entry, then of each second lobe.
fn texels(table: &Table) -> [Vec<[f16; 4]>; 3] {
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_text_is_timed() {
        let times = match told(&Effort { picture: [64, 64], runs: 1, least: 0.0 }) {
            Err(TimesError::Gpu(reason)) => return println!("skipped: no GPU, not even in software: {reason}"),
            times => times.expect("every text lights the floor"),
        };
        for program in programs() {
            let row = times.lines().find(|line| line.starts_with(&format!("| {} |", program.name)));
            let numbers: Vec<f64> =
                row.expect("a row").split('|').filter_map(|cell| cell.trim().parse().ok()).collect();
            assert!(numbers.len() == 3 && numbers.iter().all(|x| *x > 0.0), "{row:?}");
        }
    }
}
