//! Surfaces under their lights, with the light that they truly reflect.

use rayon::prelude::*;

use super::{AnyLight, LightError, Lighting, ltc::covered, measure::with_terms, truth_of};
use ltcforge_fit::{BrdfModel, Configuration, LookedUp, math::from_row_major};

/// The tolerance of the reference for each light: a tenth of the error of the best model under random lights.
const TOLERANCE: f64 = 1e-5;

/// A surface, a view of it, and its lights.
#[derive(Debug, Clone)]
pub struct LitSurface {
    /// Roughnesses and view.
    pub at: Configuration,
    /// Reflectance at normal and at grazing incidence.
    pub fresnel: [f64; 2],
    /// The lights relative to the surface, each with its radiance.
    pub lights: Vec<(f64, AnyLight)>,
}

/// Surfaces of one scattering model, with the true light of each.
#[derive(Debug, Clone)]
pub struct LitSurfaces {
    brdf: BrdfModel,
    surfaces: Vec<LitSurface>,
    /// For each surface, the true light of each of its lights.
    truth: Vec<Vec<f64>>,
}

impl LitSurfaces {
    /// Computes the true light. Runs on the current rayon pool. The size of the pool does not change the result.
    ///
    /// # Errors
    /// The errors of [`truth_of`].
    pub fn new(brdf: BrdfModel, surfaces: Vec<LitSurface>) -> Result<Self, LightError> {
        let of_surface = |surface: &LitSurface| -> Result<Vec<f64>, LightError> {
            let [f0, f90] = surface.fresnel;
            let truth = |(radiance, light): &(f64, AnyLight)| {
                Ok(radiance * truth_of(&brdf, TOLERANCE, &surface.at, light)?.schlick(f0, f90))
            };
            surface.lights.iter().map(truth).collect()
        };
        let truth = surfaces.par_iter().map(of_surface).collect::<Result<_, _>>()?;
        Ok(Self { brdf, surfaces, truth })
    }

    /// For each surface, the true light of each of its lights.
    #[must_use]
    pub fn truth(&self) -> &[Vec<f64>] {
        &self.truth
    }

    /// For each surface and each of its lights, a model's light minus the true light. A table without terms has those
    /// of its scattering model. Runs on the current rayon pool.
    ///
    /// # Errors
    /// The errors of [`light_error`](super::light_error).
    pub fn errors(&self, model: Lighting<'_>) -> Result<Vec<Vec<f64>>, LightError> {
        let own = with_terms(model, &self.brdf)?;
        let model = own.as_ref().map_or(model, |table| model.with_table(table));
        self.differences(self.surfaces.len(), |_, surface, light| {
            model.of_material(&surface.at, light, surface.fresnel)
        })
    }

    /// Like [`LitSurfaces::errors`], for lobes of LTCs with terms at the first surfaces.
    ///
    /// # Errors
    /// [`LightError::NoTerms`] for a lobe without terms, [`LightError::Singular`].
    pub fn errors_of(&self, lobes: &[LookedUp]) -> Result<Vec<Vec<f64>>, LightError> {
        self.differences(lobes.len(), |index, surface, light| {
            let LookedUp { matrix, amplitude, fresnel, .. } = &lobes[index];
            let (amplitude, fresnel) = amplitude.zip(*fresnel).ok_or(LightError::NoTerms)?;
            let [f0, f90] = surface.fresnel;
            Ok((f0 * (amplitude - fresnel) + f90 * fresnel) * covered(&from_row_major(matrix), light.into(), false)?)
        })
    }

    fn differences(
        &self,
        count: usize,
        reflected: impl Fn(usize, &LitSurface, &AnyLight) -> Result<f64, LightError> + Sync,
    ) -> Result<Vec<Vec<f64>>, LightError> {
        let of_surface = |index: usize| {
            let (surface, truth) = (&self.surfaces[index], &self.truth[index]);
            let lights = surface.lights.iter().zip(truth);
            lights.map(|((radiance, light), truth)| Ok(radiance * reflected(index, surface, light)? - truth)).collect()
        };
        (0..count).into_par_iter().map(of_surface).collect()
    }
}
