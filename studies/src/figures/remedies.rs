//! Figure 3: artefacts, each from one missing remedy.
//!
//! Our solver makes none of these artefacts. It starts at the lobe, its matrices contain no rotation of the cosine, and
//! its samples are as symmetric as the lobe. Therefore each matrix of (b) is rotated by a different angle, as a solver
//! of nine numbers may do. The published gradient descent fits (a) and (c). It starts far from the lobe, and its
//! samples are random.

use std::{f64::consts::TAU, sync::Arc};

use glam::DMat3;
use ltcforge::{
    files::recipe_document::{DEFAULT_ENTRY_LIMIT, parse},
    fit::{
        Configuration, FittedEntry, PerAxis, Plan, Table, assemble,
        brdf::Mirrors,
        lobe::ltc::align,
        math::{from_row_major, row_major},
    },
    view::{
        picture::{Panel, Picture, caption, grid, headed},
        preview::{Camera, Light, Material, Preview, Scene, ShaderTable, TexelFormat},
    },
};

use super::{error::FigureError, fits::entries};

/// Side of a sphere's picture in pixels.
const SIDE: u32 = 320;
/// The paper's resolution and layout.
const RECIPE: &str = r#"{"preset": "paper", "layout": "kt2022"}"#;
/// The recipe for gradient descent, with few samples and steps.
const DESCENT: &str = r#"{"layout": "kt2022", "fit": {"solver": "sgd", "samples": 64, "directions": 4, "steps": 200}}"#;
/// The recipe for gradient descent with the L3 norm.
const DESCENT_BY_L3: &str =
    r#"{"layout": "kt2022", "fit": {"metric": "l3", "solver": "sgd", "samples": 64, "directions": 4, "steps": 200}}"#;
/// A fraction of a turn that is far from all fractions with small denominators.
const TURN: f64 = 0.618_033_988_749_895;
/// The constant `FLATTEST` of layout `kt2022`.
const FLATTEST: f64 = 1e-4;

/// The material of most spheres.
const SATIN: Material = Material { alpha_x: 0.5, alpha_y: 0.15, rotation: 0.0 };
/// The material of (d). Its roughness is between the two least roughnesses of a table.
const GLOSSY: Material = Material { alpha_x: 0.08, alpha_y: 0.05, rotation: 0.0 };
/// The nodes of (d) along theta and along phi. They are so dense that interpolation is not visible.
const FINE: u32 = 64;

/// Draws spheres lit by tables that lack one remedy, next to spheres lit by tables that have it.
pub(super) fn draw(preview: &mut Preview) -> Result<Picture, FigureError> {
    let (plan, exact) = entries(RECIPE)?;
    let (rough_plan, rough) = entries(DESCENT)?;
    let (broken_plan, broken) = entries(DESCENT_BY_L3)?;
    let turned: Vec<FittedEntry> = exact.iter().enumerate().map(|(i, entry)| with(entry, turned(i, entry))).collect();
    let unsymmetrised = |entry: &FittedEntry| align(&from_row_major(&entry.matrix), NO_MIRRORS, FLATTEST);
    let enforced = assemble(&rough_plan, &alike_from_above(&rough_plan, &rough));
    let tables = [
        ("(a) descent by the L3 norm", assemble(&broken_plan, &alike_from_above(&broken_plan, &broken))),
        ("by the sliced Wasserstein distance", enforced.clone()),
        ("(b) matrices not aligned", stored(&plan, &turned, |entry| from_row_major(&entry.matrix))),
        ("aligned", assemble(&plan, &turned)),
        ("(c) symmetries not enforced", stored(&rough_plan, &rough, unsymmetrised)),
        ("enforced", enforced),
    ];
    let aligned = assemble(&plan, &exact);
    let inverses = Table { matrix: aligned.matrix.iter().map(inverted).collect(), ..aligned.clone() };
    let glossy = [
        ("(d) inverses between nodes", read_finely(&inverses, |found| from_row_major(found).inverse())?),
        ("inverted after the lookup", read_finely(&aligned, from_row_major)?),
    ];
    let mut titled = Vec::new();
    let rows = tables.into_iter().map(|named| (named, SATIN)).chain(glossy.into_iter().map(|named| (named, GLOSSY)));
    for ((name, table), material) in rows {
        let table = Arc::new(ShaderTable::new(&table, TexelFormat::F32));
        titled.push((name, preview.render(&table, &scene(material), &|| false)?.picture));
    }
    let panels: Vec<Panel<'_>> = titled
        .iter()
        .map(|(title, picture)| Panel { title, picture: picture.clone(), foot: caption(SIDE, &[""]) })
        .collect();
    Ok(headed(&[&["Spheres by tables that lack a remedy, and that have it"]], &grid(&panels, 2)))
}

const NO_MIRRORS: Mirrors = Mirrors { x: false, y: false };

/// A scene with the light in front. The sphere reflects it where the view is along the normal.
fn scene(material: Material) -> Scene {
    Scene {
        materials: vec![material],
        light: Light { centre: [-0.6, 0.8, 3.0], half_size: [0.9, 0.6], ..Light::default() },
        camera: Camera::default(),
        size: SIDE,
        ..Scene::default()
    }
}

/// The inverse of a stored matrix.
fn inverted(stored: &[f32; 9]) -> [f32; 9] {
    row_major(&from_row_major(&stored.map(f64::from)).inverse()).map(|x| x as f32)
}

/// A table for the glossy material that stores the results of lookups in another table, at many views. `matrix` returns
/// the `M` of a result, because the other table may store inverses, and shaders expect `M`.
fn read_finely(table: &Table, matrix: impl Fn(&[f64; 9]) -> DMat3) -> Result<Table, FigureError> {
    let Material { alpha_x, alpha_y, .. } = GLOSSY;
    let ratio = alpha_y / alpha_x;
    let (range, resolution) = (
        format!(r#""alpha": [{alpha_x}, {alpha_x}], "ratio": [{ratio}, {ratio}]"#),
        format!(r#""theta": {FINE}, "phi": {FINE}"#),
    );
    let recipe = format!(
        r#"{{"layout": "kt2022", "range": {{{range}}}, "resolution": {{"alpha": 1, "ratio": 1, {resolution}}}}}"#
    );
    let plan = Plan::new(&parse(recipe.as_bytes(), DEFAULT_ENTRY_LIMIT)?);
    let nodes = plan.nodes();
    let at = |theta: &f64, phi: &f64| Configuration { alpha_x, alpha_y, theta: *theta, phi: *phi };
    let views = nodes.theta.iter().flat_map(|theta| nodes.phi.iter().map(move |phi| at(theta, phi)));
    let entries: Vec<FittedEntry> = views
        .map(|view| {
            let found = table.lookup(&view);
            let (amplitude, fresnel) = (found.amplitude.unwrap_or(1.0), found.fresnel.unwrap_or(0.0));
            FittedEntry { matrix: row_major(&matrix(&found.matrix)), second: None, amplitude, fresnel, error: 0.0 }
        })
        .collect();
    Ok(assemble(&plan, &entries))
}

fn with(entry: &FittedEntry, matrix: DMat3) -> FittedEntry {
    FittedEntry { matrix: row_major(&matrix), ..*entry }
}

/// Another matrix with the same distribution as the entry.
fn turned(index: usize, entry: &FittedEntry) -> DMat3 {
    from_row_major(&entry.matrix) * DMat3::from_rotation_z(TAU * (TURN * index as f64).fract())
}

/// The entries, where all views from directly above have the entry of the first azimuth. The azimuth does not matter
/// for these views.
fn alike_from_above(plan: &Plan, entries: &[FittedEntry]) -> Vec<FittedEntry> {
    let PerAxis { theta, phi, .. } = plan.nodes().lengths();
    let source = |index: usize| if (index / phi).is_multiple_of(theta) { index - index % phi } else { index };
    (0..entries.len()).map(|index| entries[source(index)]).collect()
}

/// The table with these matrices. Their third columns have unit length.
fn stored(plan: &Plan, entries: &[FittedEntry], matrix: impl Fn(&FittedEntry) -> DMat3) -> Table {
    let mut table = assemble(plan, entries);
    for (stored, entry) in table.matrix.iter_mut().zip(entries) {
        let m = matrix(entry);
        *stored = row_major(&(m * (1.0 / m.z_axis.length()))).map(|x| x as f32);
    }
    table
}
