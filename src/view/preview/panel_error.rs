//! The difference between a model and the reference.

use ltcforge_light::LightModel;

use super::{Material, Radiances, Scene, cpu, frame::Frame};

/// The difference between a model and the reference on one material.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PanelError {
    /// The model.
    pub model: LightModel,
    /// The material's roughness along its tangent.
    pub alpha_x: f64,
    /// The material's roughness across its tangent.
    pub alpha_y: f64,
    /// Mean absolute difference in radiance, over the pixels that the surface covers and over the channels.
    pub mean_absolute: f64,
    /// Mean radiance of the reference over the same pixels and channels.
    pub mean_radiance: f64,
}

/// The error of each material, over the pixels that the material covers.
pub(super) fn panel_errors(
    scene: &Scene,
    frame: &Frame,
    model: LightModel,
    lit: &Radiances,
    reference: &Radiances,
) -> Vec<PanelError> {
    let mut sums = vec![(0.0, 0.0, 0.0); scene.materials.len()];
    let sum = |pixel: [f32; 3]| pixel.map(f64::from).iter().sum::<f64>() / 3.0;
    for (index, (lit, reference)) in (0..).zip(lit.pixels.iter().zip(&reference.pixels)) {
        if let Some(cell) = cpu::covering(frame, [index % frame.size, index / frame.size]) {
            let (apart, radiance, pixels) = &mut sums[cell];
            *apart += sum([0, 1, 2].map(|i| (lit[i] - reference[i]).abs()));
            *radiance += sum(*reference);
            *pixels += 1.0;
        }
    }
    let error = |(material, (apart, radiance, pixels)): (&Material, (f64, f64, f64))| PanelError {
        model,
        alpha_x: material.alpha_x,
        alpha_y: material.alpha_y,
        mean_absolute: apart / pixels.max(1.0),
        mean_radiance: radiance / pixels.max(1.0),
    };
    scene.materials.iter().zip(sums).map(error).collect()
}
