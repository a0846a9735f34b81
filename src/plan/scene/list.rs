//! A list of materials in place of a scene: roughnesses and weights, or materials of glTF without textures.

use serde::Deserialize;

use super::{
    document::{Material, parsed},
    error::{Faults, SceneError, SceneFault},
    material::{LobeAt, LobeKind, Shaded},
    model::{Scene, SceneLobe, SceneMaterial},
};
use crate::histogram::{Histogram, Views};
use ltcforge_files::json_size::JsonLimits;
use ltcforge_fit::ALPHA_FLOOR;

/// Materials of a list.
const MOST_MATERIALS: u64 = 4096;
/// What the document may hold: a material of glTF has up to a dozen objects and lists.
const LIMITS: JsonLimits = JsonLimits { items: 1 << 16, values: 1 << 18 };
/// The greatest weight.
const MOST_WEIGHT: f64 = 1e9;

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct List {
    materials: Vec<Item>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Item {
    name: Option<String>,
    alpha_x: Option<f64>,
    alpha_y: Option<f64>,
    /// Reflectance seen from above: that of a perfect mirror where it is left out.
    #[serde(default = "one")]
    f0: f64,
    #[serde(default = "one")]
    weight: f64,
    /// A material of glTF in place of roughnesses.
    gltf: Option<Material>,
}

fn one() -> f64 {
    1.0
}

/// The scene of a list. Every view of it counts.
pub(super) fn read(json: &[u8]) -> Result<Scene, SceneError> {
    if json.trim_ascii_start().starts_with(b"[") {
        // Otherwise it would be read as a list of the document's fields.
        return Err(SceneError::fault("", "a bare list; the document is {\"materials\": [...]}"));
    }
    let List { materials } = parsed(json, LIMITS, "no list of materials")?;
    SceneError::above("/materials", materials.len() as u64, MOST_MATERIALS)?;
    let mut faults = Faults::default();
    let mut scene = Scene::default();
    for (index, item) in materials.iter().enumerate() {
        let place = format!("/materials/{index}");
        let mut within = |field: &str, value: f64, most: f64| {
            if !(0.0..=most).contains(&value) {
                faults.note(format!("{place}/{field}"), format!("{value} is not from 0 to {most}"));
            }
        };
        within("weight", item.weight, MOST_WEIGHT);
        within("f0", item.f0, 1.0);
        let roughness = [item.alpha_x, item.alpha_y];
        roughness
            .iter()
            .zip(["alpha_x", "alpha_y"])
            .for_each(|(alpha, field)| within(field, alpha.unwrap_or(0.0), 1.0));
        let (name, lobes, uncovered) = match (roughness, &item.gltf) {
            ([Some(x), Some(y)], None) => {
                let [larger, smaller] = [x.max(y), x.min(y)].map(|alpha| alpha.max(ALPHA_FLOOR));
                let at = LobeAt {
                    kind: LobeKind::Base,
                    weight: 1.0,
                    alpha: larger,
                    ratio: smaller / larger,
                    turn: 0.0,
                    metal: [0.0; 2],
                    dielectric: item.f0,
                };
                (format!("material {index}"), vec![at], Vec::new())
            }
            ([None, None], Some(material)) => match Shaded::read(material, Some(index), None) {
                Ok(shaded) => {
                    let mut lobes = Vec::new();
                    let there = shaded.lobes(&|_| [0.0; 2], &mut lobes);
                    for lobe in &mut lobes {
                        lobe.weight *= there;
                    }
                    scene.notes.extend(shaded.missing.iter().map(|missing| format!("{}: {missing}", shaded.name)));
                    (shaded.name, lobes, shaded.uncovered)
                }
                Err(SceneError::Faults(found)) => {
                    for SceneFault { pointer, detail } in found {
                        faults.note(pointer, detail);
                    }
                    continue;
                }
                Err(error) => return Err(error),
            },
            _ => {
                let detail = "a material has alpha_x and alpha_y, or gltf with a material of glTF".to_owned();
                faults.note(place.clone(), detail);
                continue;
            }
        };
        let lobe = |at: LobeAt| {
            let mut histogram = Histogram::default();
            histogram.add(at.alpha, at.ratio, item.weight * at.weight);
            histogram.add_f0(at.metal, at.dielectric, item.weight * at.weight);
            SceneLobe { kind: at.kind, spots: histogram.spots(), views: Views::default(), f0: histogram.f0() }
        };
        let name = item.name.clone().filter(|name| !name.is_empty()).unwrap_or(name);
        let lobes = lobes.into_iter().map(lobe).filter(|lobe| !lobe.spots.is_empty()).collect();
        scene.materials.push(SceneMaterial { name, area: item.weight, lobes, uncovered });
    }
    faults.none()?;
    if scene.materials.iter().all(|material| material.lobes.is_empty()) {
        return Err(SceneError::Empty);
    }
    Ok(scene)
}
