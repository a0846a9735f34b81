//! Renders a scene with a table to a picture, on a GPU or the CPU.

use std::{borrow::Cow, sync::Arc};

use super::{
    Material, Mode, PreviewError, Radiances, Scene, ScenePicture, ShaderTable, TableFault,
    compose::Composer,
    cpu,
    estimator::{Estimator, Stop},
    frame::Frame,
    gpu::{Gpu, GpuFailure, RenderTask, Weights},
    panel_error::{PanelError, panel_errors},
    scene::COMPARED,
    shadows, tone,
};
use crate::picture::Picture;
use ltcforge_fit::{BrdfKind, BrdfModel, named_list};
use ltcforge_light::LightModel;

/// The name of the CPU as an adapter.
const CPU: &str = "cpu";

/// The reflectance for which Schlick's factor is one for every view.
const NO_FRESNEL: [f64; 3] = [1.0; 3];
/// Samples that the CPU renders between two calls of `stop`. They take some hundredths of a second on one slow core.
const SAMPLES: u32 = 1 << 18;

named_list! {
    /// The choice of the renderer.
    pub enum Adapter {
        /// A GPU if Vulkan lists one, otherwise the CPU.
        Any = "any",
        /// A GPU. Fails if there is no GPU.
        Gpu = "gpu",
        /// The CPU.
        Cpu = "cpu",
    }
}

/// A picture, with the name of its renderer and its errors.
#[derive(Debug, Clone, PartialEq)]
pub struct Rendered {
    /// The rendered picture.
    pub picture: Picture,
    /// The name of the GPU adapter, or `cpu`.
    pub adapter: String,
    /// The error of each material, in the scene's order. Only modes that compare have errors.
    pub errors: Vec<PanelError>,
    /// In modes that show the table: the materials whose roughness is outside the table's nodes. For them the picture
    /// uses the nearest entries.
    pub out_of_range: Vec<Material>,
}

/// Renders pictures one after another. The first picture opens the device.
#[derive(Debug)]
pub struct Preview {
    adapter: Adapter,
    gpu: Gpu,
    /// True if no usable GPU was found. The CPU then renders all pictures.
    has_no_gpu: bool,
    /// True if a GPU was open before.
    had_gpu: bool,
}

/// Renders the parts of a picture on the GPU, or on the CPU if there is no GPU.
struct Pass<'a> {
    gpu: Option<&'a mut Gpu>,
    table: &'a Arc<ShaderTable>,
    frame: &'a Frame,
    stop: Stop<'a>,
}

impl Preview {
    /// A renderer that opens its device on first use.
    #[must_use]
    pub fn new(adapter: Adapter) -> Self {
        Self::with_weights(adapter, Weights::default())
    }

    /// A renderer whose shaders interpolate as `weights` says. The CPU always interpolates in f32.
    #[must_use]
    pub fn with_weights(adapter: Adapter, weights: Weights) -> Self {
        Self { adapter, gpu: Gpu::new(weights), has_no_gpu: false, had_gpu: false }
    }

    /// Renders a scene.
    ///
    /// # Errors
    /// Parameters are out of bounds, the scene cannot show the table, or `stop` returned true. With [`Adapter::Gpu`]
    /// also: there is no GPU, the GPU failed twice, or no shader has the reference.
    pub fn render(
        &mut self,
        table: &Arc<ShaderTable>,
        scene: &Scene,
        stop: Stop<'_>,
    ) -> Result<Rendered, PreviewError> {
        let mut faults = faults_of_table(table, scene);
        faults.extend(fault_of_f0(&table.brdf, scene));
        let scene_faults = scene.faults();
        if !scene_faults.is_empty() {
            return Err(PreviewError::Scene(scene_faults, faults));
        }
        let is_for_cpu = self.check(table, scene, faults)? || scene.mode == Mode::Shadows;
        let scene = &*material_shown(&table.brdf, scene);
        let by_gpu = |gpu: &mut Gpu| attempt(Some(gpu), table, scene, stop);
        // One renderer makes the whole picture: if the GPU fails in the middle, the CPU starts again.
        if let Some(rendered) = if is_for_cpu { None } else { self.on_gpu(by_gpu)? } {
            return Ok(rendered);
        }
        attempt(None, table, scene, stop).map_err(|_| PreviewError::Stopped)
    }

    /// Whether only the CPU can render a scene, because no shader has its reference. Returns an error if `faults` is
    /// not empty.
    fn check(&self, table: &ShaderTable, scene: &Scene, faults: Vec<TableFault>) -> Result<bool, PreviewError> {
        if !faults.is_empty() {
            return Err(PreviewError::Table(faults));
        }
        let is_for_cpu = table.has_reference_on_cpu_only(scene);
        if let Some(file) = table.brdf.file().filter(|_| is_for_cpu && !table.brdf.is_complete()) {
            return Err(PreviewError::NoBrdfFile(file.to_string()));
        }
        if is_for_cpu && self.adapter == Adapter::Gpu {
            return Err(PreviewError::CpuOnly(table.brdf.kind()));
        }
        Ok(is_for_cpu)
    }

    /// The name of the renderer: a GPU adapter's name, or `cpu`.
    ///
    /// # Errors
    /// The adapter is [`Adapter::Gpu`], and there is no GPU.
    pub fn adapter_name(&mut self) -> Result<String, PreviewError> {
        let name = self.on_gpu(Gpu::name)?;
        Ok(name.unwrap_or_else(|| CPU.to_owned()))
    }

    /// The result of `work` on the GPU. `None` if the CPU must do the work.
    fn on_gpu<T>(&mut self, work: impl FnOnce(&mut Gpu) -> Result<T, GpuFailure>) -> Result<Option<T>, PreviewError> {
        if self.adapter == Adapter::Cpu || (self.adapter == Adapter::Any && self.has_no_gpu) {
            return Ok(None);
        }
        let failure = match work(&mut self.gpu) {
            Ok(done) => {
                self.had_gpu = true;
                return Ok(Some(done));
            }
            Err(GpuFailure::Stopped) => return Err(PreviewError::Stopped),
            Err(failure) => failure,
        };
        if self.adapter == Adapter::Any {
            tracing::warn!("rendering on the CPU instead of a GPU: {failure}");
            // A lost GPU can come back.
            self.has_no_gpu = matches!(failure, GpuFailure::Absent(_)) && !self.had_gpu;
            return Ok(None);
        }
        Err(match failure {
            GpuFailure::Absent(reason) => PreviewError::NoAdapter(reason),
            failure => PreviewError::Gpu(failure.to_string()),
        })
    }
}

/// Renders a picture on the GPU or on the CPU. The CPU only fails if it is stopped.
fn attempt(
    gpu: Option<&mut Gpu>,
    table: &Arc<ShaderTable>,
    scene: &Scene,
    stop: Stop<'_>,
) -> Result<Rendered, GpuFailure> {
    let frame = Frame::new(scene, scene.mode == Mode::Lobe);
    let mut pass = Pass { gpu, table, frame: &frame, stop };
    let out_of_range = out_of_range(table, scene);
    let composer = Composer { scene, table, out_of_range: &out_of_range };
    let mut errors = Vec::new();
    let picture = match scene.mode {
        Mode::Ltc => composer.warned(pass.picture(Estimator::of(scene.model, scene.rule, table))?),
        Mode::Reference => pass.picture(Estimator::Reference)?,
        Mode::Difference | Mode::Strip => {
            let lit = pass.radiances(Estimator::of(scene.model, scene.rule, table))?;
            let reference = pass.radiances(Estimator::Reference)?;
            errors = panel_errors(scene, &frame, scene.model, &lit, &reference);
            composer.compared(&frame, &lit, &reference, &errors)
        }
        Mode::Models => {
            let reference = pass.radiances(Estimator::Reference)?;
            let mut lit = Vec::new();
            for model in COMPARED {
                let radiances = pass.radiances(Estimator::of(model, scene.rule, table))?;
                errors.extend(panel_errors(scene, &frame, model, &radiances, &reference));
                lit.push((model, radiances));
            }
            composer.models(&frame, &lit, &reference, &errors)
        }
        Mode::Shadows => {
            let panels = shadows::panels(scene, &frame, stop).ok_or(GpuFailure::Stopped)?;
            let picture = composer.shadows(&panels);
            return Ok(Rendered { picture, adapter: CPU.to_owned(), errors, out_of_range });
        }
        Mode::Lobe => {
            let ltc = pass.radiances(Estimator::TableLobe)?;
            let reference = pass.radiances(Estimator::ReferenceLobe)?;
            composer.lobes(&frame, &ltc, &reference)
        }
    };
    let adapter = pass.gpu.map_or_else(|| Ok(CPU.to_owned()), Gpu::name)?;
    Ok(Rendered { picture, adapter, errors, out_of_range })
}

impl Pass<'_> {
    /// A frame, tone-mapped for display.
    fn picture(&mut self, estimator: Estimator) -> Result<Picture, GpuFailure> {
        Ok(tone::displayed(self.frame.exposure, &self.radiances(estimator)?))
    }

    /// A frame as radiance.
    fn radiances(&mut self, estimator: Estimator) -> Result<Radiances, GpuFailure> {
        let Self { table, frame, stop, .. } = *self;
        let Some(gpu) = &mut self.gpu else { return on_cpu(table, frame, estimator, stop) };
        let pixels = gpu.render(table, &RenderTask::whole(frame, estimator), stop)?;
        Ok(Radiances { width: frame.size, pixels })
    }
}

/// The scene with a reflectance that fits the scattering model. It is one for models without a Fresnel factor.
fn material_shown<'a>(brdf: &BrdfModel, scene: &'a Scene) -> Cow<'a, Scene> {
    if takes_f0(brdf, scene) { Cow::Borrowed(scene) } else { Cow::Owned(Scene { f0: NO_FRESNEL, ..scene.clone() }) }
}

/// Whether a picture uses a Fresnel factor, and therefore f0.
fn takes_f0(brdf: &BrdfModel, scene: &Scene) -> bool {
    brdf.kind().has_fresnel() || scene.mode == Mode::Lobe
}

/// The fault of a scene that sets f0 for a scattering model without it.
fn fault_of_f0(brdf: &BrdfModel, scene: &Scene) -> Option<TableFault> {
    let is_given = scene.f0 != NO_FRESNEL && scene.f0 != Scene::default().f0;
    (is_given && !takes_f0(brdf, scene)).then_some(TableFault::NoFresnel(brdf.kind()))
}

/// All reasons why a scene cannot show a table.
fn faults_of_table(table: &ShaderTable, scene: &Scene) -> Vec<TableFault> {
    let kind = table.brdf.kind();
    let is_of_ggx = LightModel::ALL.iter().any(|model| !model.needs_table() && scene.shows(*model));
    let is_lobe = scene.mode == Mode::Lobe;
    let has_picture = scene.picture != ScenePicture::None && scene.needs_table() && !is_lobe;
    let loses_nothing = scene.compensate && !is_lobe && !table.brdf.follows_reflection();
    let faults = [
        (table.brdf != BrdfKind::Ggx && is_of_ggx).then_some(TableFault::OtherBrdf(kind)),
        loses_nothing.then_some(TableFault::NoFacets(kind)),
        (has_picture && table.lobe.gaussian().is_some()).then_some(TableFault::GaussianPicture(table.lobe)),
        (is_lobe && table.lobe.gaussian().is_some()).then_some(TableFault::GaussianLobe(table.lobe)),
    ];
    faults.into_iter().flatten().collect()
}

/// The shown materials with a roughness outside the table's nodes.
fn out_of_range(table: &ShaderTable, scene: &Scene) -> Vec<Material> {
    let shown = match scene.mode {
        _ if !scene.needs_table() => 0,
        Mode::Lobe => 1,
        _ => scene.materials.len(),
    };
    let shown = scene.materials.iter().take(shown).copied();
    shown.filter(|m| !cpu::covers(table, m.alpha_x as f32, m.alpha_y as f32)).collect()
}

/// A frame as radiance, on the CPU.
fn on_cpu(table: &ShaderTable, frame: &Frame, estimator: Estimator, stop: Stop<'_>) -> Result<Radiances, GpuFailure> {
    let mut pixels = Vec::with_capacity((frame.size * frame.size) as usize);
    for (corner, extent) in cpu_parts(frame.size, estimator.cost(frame.spp)) {
        if stop() {
            return Err(GpuFailure::Stopped);
        }
        pixels.extend(cpu::render(frame, table, estimator, corner, extent).pixels);
    }
    Ok(Radiances { width: frame.size, pixels })
}

/// The parts of a frame that the CPU renders one after another, as corner and extent. A part has whole rows, or pixels
/// of one row if a row has more samples than [`SAMPLES`]. Together their pixels are in the order of the frame.
fn cpu_parts(size: u32, samples: u32) -> impl Iterator<Item = ([u32; 2], [u32; 2])> {
    let pixels = (SAMPLES / samples).max(1);
    let (width, height) = (pixels.min(size), (pixels / size).max(1));
    (0..size).step_by(height as usize).flat_map(move |top| {
        let extent = move |left: u32| [width.min(size - left), height.min(size - top)];
        (0..size).step_by(width as usize).map(move |left| ([left, top], extent(left)))
    })
}

#[cfg(test)]
mod tests;
