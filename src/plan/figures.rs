//! The errors of a table on each material of a scene, next to the engine's own table and the closed form. Also the
//! changes that help each material.

use serde::Serialize;

use crate::{
    lobes::Lobes,
    needs::Needs,
    prediction::Prediction,
    probes::Probes,
    scene::{LobeKind, Scene, SceneLobe},
    without::FAR_NEARER,
};
use ltcforge_fit::{BrdfKind, Closeness, LobeFresnel, Recipe, Table};
use ltcforge_light::{Lighting, TableUse};

/// Number of configurations of `--check` for each lobe, and the minimum and maximum of all.
const EACH: usize = 128;
const ALL: [usize; 2] = [512, 8192];
/// A change helps if it removes this part of the error.
const HELPS: f64 = 0.2;

/// A change that brings the light of a material nearer to the truth.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Help {
    /// The closed form instead of a table.
    ClosedForm,
    /// More nodes near the roughness of the material.
    Roughness,
    /// More nodes for views.
    Views,
    /// A second table, so that metal and dielectrics have one each.
    SecondSet,
}

impl Help {
    /// The change in words.
    pub(crate) fn in_words(self) -> &'static str {
        match self {
            Self::ClosedForm => "the closed form",
            Self::Roughness => "more nodes near this roughness",
            Self::Views => "more nodes for views",
            Self::SecondSet => "two sets, one for metal and one for plastic",
        }
    }
}

/// The figures of a lobe of a material.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Figure {
    /// The index of the material in the scene.
    pub material: usize,
    /// The kind of the lobe.
    pub kind: LobeKind,
    /// The part of the surface.
    pub share: f64,
    /// Mean error of the table: as a fraction of the lobe's width, or of light under the scene's own lights.
    pub error: f64,
    /// Mean absolute error of the light, by the table, by the table that the engine ships or the default table, and by
    /// the closed form.
    pub light: [Option<f64>; 3],
    /// Whether a light reaches the lobe. If none does, there is no error.
    pub is_lit: bool,
    /// The changes that help.
    pub helps: Vec<Help>,
}

impl Figure {
    /// The material's name, with the kind of a lobe over its surface.
    #[must_use]
    pub fn name(&self, scene: &Scene) -> String {
        let kind = match self.kind {
            LobeKind::Base => "",
            LobeKind::Clearcoat => " (clear coat)",
            LobeKind::Sheen => " (sheen)",
        };
        format!("{}{kind}", scene.materials[self.material].name)
    }

    /// The error of the light, or without lights of the table's scattering model, of the lobe.
    pub(crate) fn shown(&self) -> f64 {
        self.light[0].unwrap_or(self.error)
    }
}

/// A table's light, from one integral for each light.
pub(crate) fn lighting(table: &Table) -> Lighting<'_> {
    Lighting::Table(table, TableUse { blend: table.second_matrices().is_some(), cut: false })
}

/// The figures of each lobe, for a table that is read as if it was fitted to `fresnel`. `light` are the errors of light
/// at each place.
pub(crate) fn figures(
    needs: &Needs<'_>,
    probes: &Probes,
    (table, fresnel): (&Table, &LobeFresnel),
    light: &[Option<Vec<f64>>; 3],
) -> Vec<Figure> {
    let errors = probes.errors_as(table, fresnel, Closeness::Report);
    let figure = |((material, lobe), share): (&(usize, &SceneLobe), f64)| {
        let of = (*material, lobe.kind);
        Figure {
            material: *material,
            kind: lobe.kind,
            share,
            error: probes.mean_of(&errors, of),
            light: light.each_ref().map(|errors| Some(probes.mean_of(errors.as_ref()?, of))),
            is_lit: probes.reaches(of),
            helps: Vec::new(),
        }
    };
    needs.lobes.iter().zip(needs.shares()).map(figure).collect()
}

/// Adds the changes that help each lobe, for the table of a recipe. `prediction` has the finer tables to compare with.
pub(crate) fn add_helps(figures: &mut [Figure], probes: &Probes, prediction: Option<&Prediction>, recipe: &Recipe) {
    let errors = |prediction: &Prediction, axes| {
        probes.errors_as(&prediction.read(recipe, axes), recipe.brdf.fresnel(), Closeness::Report)
    };
    // The table's nodes on all axes, then all nodes of the coarse table for roughnesses, and for views.
    let read = prediction.map(|prediction| [0..4, 2..4, 0..2].map(|axes| errors(prediction, axes)));
    let choices = prediction.map_or(&[][..], |prediction| &prediction.lobes);
    let own = choices.iter().find(|choice| choice.fresnel == *recipe.brdf.fresnel());
    for figure in figures.iter_mut().filter(|figure| figure.is_lit) {
        let of = (figure.material, figure.kind);
        let mean = |errors: &Vec<f64>| probes.mean_of(errors, of);
        figure
            .helps
            .extend(figure.light[2].filter(|form| *form <= FAR_NEARER * figure.shown()).map(|_| Help::ClosedForm));
        let finer = read.iter().flat_map(|[all, rest @ ..]| rest.iter().map(move |finer| mean(all) - mean(finer)));
        let mut gains: Vec<(Help, f64)> = [Help::Roughness, Help::Views].into_iter().zip(finer).collect();
        // Two lobes per entry are two sets.
        if let Some(own) = own.filter(|own| own.fresnel.second().is_none() && mean(&own.errors) > 0.0) {
            let least = choices.iter().map(|choice: &Lobes| mean(&choice.errors)).fold(f64::INFINITY, f64::min);
            gains.push((Help::SecondSet, figure.error * (1.0 - least / mean(&own.errors))));
        }
        gains.sort_by(|a, b| b.1.total_cmp(&a.1));
        figure.helps.extend(gains.iter().filter(|(_, gain)| *gain >= HELPS * figure.error).map(|(help, _)| *help));
    }
}

/// The figures of a table on each lobe of its scattering model in a scene, the worst first. `None` if the scene has no
/// such lobe. Runs on the current rayon pool.
#[must_use]
pub fn check(scene: &Scene, table: &Table) -> Option<Vec<Figure>> {
    let needs = Needs::of(scene, table.brdf() != BrdfKind::Ggx)?;
    let probes = Probes::new(&needs, (EACH * needs.lobes.len()).clamp(ALL[0], ALL[1]));
    let mut figures = figures(&needs, &probes, (table, table.model().fresnel()), &[None, None, None]);
    figures.sort_by(|a, b| b.error.total_cmp(&a.error));
    Some(figures)
}

/// The lobes whose scattering model differs from the table's, each with the name of its material.
#[must_use]
pub fn of_other_models(scene: &Scene, table: &Table) -> Vec<(String, LobeKind)> {
    let is_other = |kind: LobeKind| (kind == LobeKind::Sheen) != (table.brdf() != BrdfKind::Ggx);
    let other = scene.lobes().filter(|(_, lobe)| is_other(lobe.kind));
    other.map(|(index, lobe)| (scene.materials[index].name.clone(), lobe.kind)).collect()
}
