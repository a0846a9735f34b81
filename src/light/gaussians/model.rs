//! The Gaussians as models of light.

use super::{Gaussian, Warp, reflected, reflected_around};
use crate::{
    AreaLight, LightError, NormalsRule, ReflectedLight,
    rules::{Formula, LitPoint, ModelOfLight, lit},
};
use ltcforge_fit::{Configuration, LobeModel};

/// A Gaussian as an item of [`crate::LightModel`].
pub(crate) struct GaussianModel(Gaussian);

/// The round Gaussian.
pub(crate) const SG: GaussianModel = GaussianModel(Gaussian::Sg);
/// The stretched Gaussian.
pub(crate) const ASG: GaussianModel = GaussianModel(Gaussian::Asg);

impl ModelOfLight for GaussianModel {
    fn formula(&self) -> Option<&dyn Formula> {
        Some(self)
    }

    fn lobe(&self) -> Option<LobeModel> {
        LobeModel::ALL.iter().copied().find(|lobe| lobe.gaussian() == Some(self.0))
    }

    fn table_cost(&self) -> u32 {
        10
    }
}

impl Formula for GaussianModel {
    fn cost(&self) -> u32 {
        6
    }

    fn reflected(&self, lit: &LitPoint<'_, f64>, _: NormalsRule) -> [f64; 2] {
        reflected(self.0, lit.alpha, lit.wo, lit.vertices, lit.sides)
    }

    fn reflected_f32(&self, lit: &LitPoint<'_, f32>, _: NormalsRule) -> [f32; 2] {
        reflected(self.0, lit.alpha, lit.wo, lit.vertices, lit.sides)
    }
}

/// The light that a surface reflects, computed with a Gaussian in f64. Shapes are handled as in
/// [`by_normals`](crate::by_normals).
///
/// # Errors
/// The errors of [`by_normals`](crate::by_normals).
pub fn by_gaussian<'a>(
    at: &Configuration,
    light: impl Into<AreaLight<'a>>,
    gaussian: Gaussian,
) -> Result<ReflectedLight, LightError> {
    by_warp(at, light, gaussian, Warp::Visible)
}

/// Like [`by_gaussian`], with the Gaussian of a warp.
///
/// # Errors
/// The errors of [`by_gaussian`].
pub fn by_warp<'a>(
    at: &Configuration,
    light: impl Into<AreaLight<'a>>,
    gaussian: Gaussian,
    warp: Warp,
) -> Result<ReflectedLight, LightError> {
    lit(at, light.into(), |lit| reflected_around(warp, gaussian, (lit.alpha, lit.wo), lit.vertices, lit.sides))
}
