//! A device with its pipelines.

use std::sync::{Arc, Mutex, PoisonError};

use super::{GpuFailure, Weights};
use crate::preview::{
    estimator::Estimator,
    frame::{Frame, FrameShape},
};
use ltcforge_fit::{LobeModel, SecondLobe};
use ltcforge_light::{Gaussian, LightModel, NormalsRule};
use ltcforge_shaders::{Bound, preview_module};

/// A device on the first adapter that Vulkan lists: a GPU, or lavapipe.
#[derive(Debug)]
pub(super) struct Device {
    pub(super) wgpu: wgpu::Device,
    pub(super) queue: wgpu::Queue,
    pub(super) table_layout: wgpu::BindGroupLayout,
    pub(super) frame_layout: wgpu::BindGroupLayout,
    pub(super) picture_layout: wgpu::BindGroupLayout,
    /// The format of prefiltered pictures. Samplers must be able to filter it.
    pub(super) picture_format: wgpu::TextureFormat,
    pub(super) name: String,
    pipeline_layout: wgpu::PipelineLayout,
    module: wgpu::ShaderModule,
    pipelines: Vec<(Program, wgpu::ComputePipeline)>,
    /// Whether the sampler interpolates entries. Otherwise the shader does.
    pub(super) samples_weighed: bool,
    fault: FirstFault,
}

/// An entry point of `sphere.wgsl`, or of `preview_textured.wgsl` for a light with a picture, and its constants.
/// Constants replace branches, because software drivers run both sides of a branch. Constants that an estimator ignores
/// have the same value in all frames, so frames that would differ only in these constants share a pipeline.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Program {
    entry_point: &'static str,
    constants: [(&'static str, f64); 10],
}

impl Program {
    fn new(estimator: Estimator, frame: &Frame) -> Self {
        let has_picture = frame.picture.is_some();
        let (model, rule) = match estimator {
            Estimator::ClosedForm(form) => (form.model(), form.rule()),
            Estimator::Table(lobe) => (LightModel::of_lobe(lobe), NormalsRule::ALL[0]),
            _ => (LightModel::Ltc, NormalsRule::ALL[0]),
        };
        let entry_point = match (estimator, model) {
            (Estimator::Reference, _) => "surface_by_reference",
            (Estimator::TableLobe, _) => "lobe_by_table",
            (Estimator::ReferenceLobe, _) => "lobe_by_reference",
            (_, LightModel::Ltc) if has_picture => "picture_by_table",
            (_, LightModel::Normals) if has_picture => "picture_by_normals",
            (_, LightModel::Ltc) => "surface_by_table",
            (_, LightModel::Normals) => "surface_by_normals",
            (_, LightModel::LtcFormula) => "surface_by_formula",
            (_, LightModel::Sg | LightModel::Asg) => "surface_by_gaussian",
        };
        let is_of_polygons = estimator.is_of_polygons();
        // Estimators for polygons replace an ellipse by a polygon.
        let is_flat = matches!(frame.light.shape, FrameShape::Polygon | FrameShape::Ellipse(_));
        let shape = if estimator.is_lobe() || (is_flat && is_of_polygons) { 0 } else { frame.light.shape.number() };
        let is_cut = frame.is_cut
            && match estimator {
                Estimator::Table(lobe) => lobe == LobeModel::Ltc,
                Estimator::ClosedForm(form) => form.model().is_of_ltcs(),
                _ => matches!(estimator, Estimator::TwoLobes(_)),
            };
        let gaussian = if model == LightModel::Asg { Gaussian::Asg } else { Gaussian::Sg };
        let second_lobe = match estimator {
            Estimator::TwoLobes(SecondLobe::Integrated) => 1.0,
            Estimator::TwoLobes(SecondLobe::Blended) => 2.0,
            _ => 0.0,
        };
        let flag = |is_so: bool| f64::from(u8::from(is_so));
        let constants = [
            ("light_shape", f64::from(shape)),
            ("light_is_polygon", flag(is_of_polygons && frame.light.outline_vertices() != 4)),
            ("light_is_cut", flag(is_cut)),
            ("is_compensated", flag(frame.is_compensated && !estimator.is_lobe())),
            ("light_has_picture", flag(has_picture)),
            ("light_readings", frame.picture.as_ref().map_or(4.0, |picture| picture.readings.count() as f64)),
            ("normals_rule", f64::from(rule as u32)),
            ("gaussian", f64::from(gaussian as u32)),
            ("second_lobe", second_lobe),
            ("gaussian_is_fitted", flag(matches!(estimator, Estimator::Table(_)))),
        ];
        Self { entry_point, constants }
    }
}

/// The first error that was not returned by a call. Without this, wgpu would panic.
#[derive(Debug, Clone, Default)]
struct FirstFault(Arc<Mutex<Option<String>>>);

impl FirstFault {
    fn record(&self, message: String) {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert(message);
    }
}

impl Device {
    /// Opens the device. This takes about 50 ms with lavapipe.
    pub(super) fn open(weights: Weights) -> Result<Self, GpuFailure> {
        let instance = wgpu::Instance::new(wgpu::InstanceDescriptor {
            backends: wgpu::Backends::VULKAN,
            ..wgpu::InstanceDescriptor::new_without_display_handle()
        });
        let request = |force_fallback_adapter| {
            pollster::block_on(instance.request_adapter(&wgpu::RequestAdapterOptions {
                power_preference: wgpu::PowerPreference::HighPerformance,
                force_fallback_adapter,
                ..Default::default()
            }))
        };
        let adapter =
            request(false).or_else(|_| request(true)).map_err(|error| GpuFailure::Absent(error.to_string()))?;
        let filters = adapter.features() & wgpu::Features::FLOAT32_FILTERABLE;
        let info = adapter.get_info();
        let samples_weighed = match weights {
            Weights::Exact => info.device_type == wgpu::DeviceType::Cpu && !filters.is_empty(),
            Weights::Shader => false,
            Weights::Sampler if filters.is_empty() => {
                return Err(GpuFailure::Absent("the adapter cannot filter 32-bit textures".to_owned()));
            }
            Weights::Sampler => true,
        };
        let descriptor = wgpu::DeviceDescriptor { required_features: filters, ..Default::default() };
        let (device, queue) = pollster::block_on(adapter.request_device(&descriptor))
            .map_err(|error| GpuFailure::Absent(error.to_string()))?;
        let fault = FirstFault::default();
        let (uncaptured, lost) = (fault.clone(), fault.clone());
        device.on_uncaptured_error(Arc::new(move |error: wgpu::Error| uncaptured.record(error.to_string())));
        device.set_device_lost_callback(move |reason, message| {
            lost.record(format!("device lost, {reason:?}: {message}"));
        });

        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some("preview"),
            source: wgpu::ShaderSource::Wgsl(preview_module().into()),
        });
        let table_layout = layout(&device, "table", &table_bindings(samples_weighed, Bound::Volumes));
        let uniform = buffer(wgpu::BufferBindingType::Uniform);
        let pixels = buffer(wgpu::BufferBindingType::Storage { read_only: false });
        let tiles = buffer(wgpu::BufferBindingType::Storage { read_only: true });
        let frame_layout = layout(&device, "frame", &[uniform, uniform, pixels, tiles]);
        // Every GPU can filter textures of 16 bits.
        let picture_format = if filters.is_empty() { wgpu::TextureFormat::Rgba16Float } else { FLOATS };
        let picture_layout = layout(&device, "picture", &PICTURE_BINDINGS);
        let pipeline_layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some("preview"),
            bind_group_layouts: &[Some(&table_layout), Some(&frame_layout), Some(&picture_layout)],
            immediate_size: 0,
        });
        let name = format!("{} ({})", info.name, info.driver_info);
        let device = Self {
            wgpu: device,
            queue,
            table_layout,
            frame_layout,
            picture_layout,
            picture_format,
            name,
            pipeline_layout,
            module,
            pipelines: Vec::new(),
            samples_weighed,
            fault,
        };
        device.check()?;
        Ok(device)
    }

    /// The pipeline of an estimator for a frame. It is compiled on first use.
    pub(super) fn pipeline(&mut self, estimator: Estimator, frame: &Frame) -> wgpu::ComputePipeline {
        let program = Program::new(estimator, frame);
        if let Some((_, pipeline)) = self.pipelines.iter().find(|(known, _)| *known == program) {
            return pipeline.clone();
        }
        let Program { entry_point, constants } = program;
        let filter = ("ltc_hardware_filter", f64::from(u8::from(self.samples_weighed)));
        let constants: Vec<_> = constants.into_iter().chain([filter]).collect();
        let pipeline = self.wgpu.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: Some(entry_point),
            layout: Some(&self.pipeline_layout),
            module: &self.module,
            entry_point: Some(entry_point),
            compilation_options: wgpu::PipelineCompilationOptions { constants: &constants, ..Default::default() },
            cache: None,
        });
        self.pipelines.push((program, pipeline.clone()));
        pipeline
    }

    /// Returns the first error since the device was opened, if there was one.
    pub(super) fn check(&self) -> Result<(), GpuFailure> {
        match self.fault.0.lock().unwrap_or_else(PoisonError::into_inner).clone() {
            Some(message) => Err(GpuFailure::Failed(message)),
            None => Ok(()),
        }
    }
}

/// A texture format with 32 bits per channel.
pub(super) const FLOATS: wgpu::TextureFormat = wgpu::TextureFormat::Rgba32Float;

/// The bindings of `light_picture.wgsl`: the picture, its prefiltered levels, and their sampler.
const PICTURE_BINDINGS: [wgpu::BindingType; 3] = [
    picture_binding(false, wgpu::TextureViewDimension::D2),
    picture_binding(true, wgpu::TextureViewDimension::D2Array),
    wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Filtering),
];

const fn picture_binding(filterable: bool, view_dimension: wgpu::TextureViewDimension) -> wgpu::BindingType {
    let sample_type = wgpu::TextureSampleType::Float { filterable };
    wgpu::BindingType::Texture { sample_type, view_dimension, multisampled: false }
}

pub(super) fn buffer(ty: wgpu::BufferBindingType) -> wgpu::BindingType {
    wgpu::BindingType::Buffer { ty, has_dynamic_offset: false, min_binding_size: None }
}

/// The bindings of `ltc_table.wgsl`: three textures with `texels_volumes.wgsl`, one with `texels_array.wgsl`.
pub(super) fn table_bindings(samples_weighed: bool, textures: Bound) -> Vec<wgpu::BindingType> {
    let (count, view_dimension) = match textures {
        Bound::Volumes => (3, wgpu::TextureViewDimension::D3),
        Bound::Array => (1, wgpu::TextureViewDimension::D2Array),
    };
    let texture = wgpu::BindingType::Texture {
        sample_type: wgpu::TextureSampleType::Float { filterable: samples_weighed },
        view_dimension,
        multisampled: false,
    };
    let sampler =
        if samples_weighed { wgpu::SamplerBindingType::Filtering } else { wgpu::SamplerBindingType::NonFiltering };
    let table = buffer(wgpu::BufferBindingType::Uniform);
    let textures = std::iter::repeat_n(texture, count);
    [table].into_iter().chain(textures).chain([wgpu::BindingType::Sampler(sampler)]).collect()
}

/// A layout of compute bindings, numbered from zero.
pub(super) fn layout(device: &wgpu::Device, label: &str, bindings: &[wgpu::BindingType]) -> wgpu::BindGroupLayout {
    let entries: Vec<wgpu::BindGroupLayoutEntry> = (0..)
        .zip(bindings)
        .map(|(binding, ty)| wgpu::BindGroupLayoutEntry {
            binding,
            visibility: wgpu::ShaderStages::COMPUTE,
            ty: *ty,
            count: None,
        })
        .collect();
    device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: Some(label), entries: &entries })
}

impl Drop for Device {
    fn drop(&mut self) {
        // Dropping the device also calls the callback. This is not an error.
        self.wgpu.set_device_lost_callback(|_, _| {});
    }
}
