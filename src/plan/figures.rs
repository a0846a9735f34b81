//! The errors of a table on each material of a scene, next to the engine's own table and the closed form.

use serde::Serialize;

use crate::{
    needs::Needs,
    probes::Probes,
    scene::{LobeKind, Scene, SceneLobe},
};
use ltcforge_fit::{BrdfKind, Closeness, LobeFresnel, Table};
use ltcforge_light::{Lighting, TableUse};

/// Number of configurations of `--check` for each lobe, and the minimum and maximum of all.
const EACH: usize = 128;
const ALL: [usize; 2] = [512, 8192];

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
}

/// A table's light, from one integral for each light.
pub(crate) fn lighting(table: &Table) -> Lighting<'_> {
    Lighting::Table(table, TableUse { blend: table.second_matrices().is_some(), cut: false })
}

/// The figures of each lobe with a place, for a table that is read as if it was fitted to `fresnel`. `light` are the errors of light
/// at each place.
pub(crate) fn figures(
    needs: &Needs<'_>,
    probes: &Probes,
    (table, fresnel): (&Table, &LobeFresnel),
    light: &[Option<Vec<f64>>; 3],
) -> Vec<Figure> {
    let errors = probes.errors_as(table, fresnel, Closeness::Report);
    let figure = |(lobe, ((material, of), share)): (usize, (&(usize, &SceneLobe), f64))| Figure {
        material: *material,
        kind: of.kind,
        share,
        error: probes.mean_of(&errors, lobe),
        light: light.each_ref().map(|errors| Some(probes.mean_of(errors.as_ref()?, lobe))),
    };
    // A lobe that no light reaches has no error.
    let has_place = |(lobe, _): &(usize, _)| probes.places.iter().any(|place| place.lobe == *lobe);
    needs.lobes.iter().zip(needs.shares()).enumerate().filter(has_place).map(figure).collect()
}

/// The largest error of a table on a lobe.
pub(crate) fn worst(figures: &[Figure]) -> f64 {
    figures.iter().map(|figure| figure.error).fold(0.0, f64::max)
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
