//! A list of materials instead of a scene: roughnesses and weights, or materials of glTF without textures.

use serde::Deserialize;

use super::{
    document::{Material, parsed},
    error::{Faults, SceneError},
    gathered::Gathered,
    material::{LobeAt, LobeKind, Shaded},
    model::{Scene, SceneMaterial},
};
use ltcforge_files::json_size::JsonLimits;
use ltcforge_fit::ALPHA_FLOOR;

/// Maximum number of materials in a list.
const MOST_MATERIALS: u64 = 4096;
/// Limits of the document: a material of glTF has up to a dozen objects and lists.
const LIMITS: JsonLimits = JsonLimits { items: 1 << 16, values: 1 << 18 };
/// The largest weight.
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
    /// Reflectance at normal incidence. The default is a perfect mirror.
    f0: Option<f64>,
    weight: Option<f64>,
    /// A material of glTF instead of roughnesses.
    gltf: Option<Material>,
}

/// Reads a list as a scene that is seen from everywhere.
pub(super) fn read(json: &[u8]) -> Result<Scene, SceneError> {
    if json.trim_ascii_start().starts_with(b"[") {
        // serde would read an array as the fields of `List`.
        return Err(SceneError::fault("", "a bare list; the document must be {\"materials\": [...]}"));
    }
    let List { materials } = parsed(json, LIMITS, "a list of materials")?;
    SceneError::above("/materials", materials.len() as u64, MOST_MATERIALS)?;
    let (mut faults, mut scene) = (Faults::default(), Scene::default());
    for (index, item) in materials.iter().enumerate() {
        let place = format!("/materials/{index}");
        let (weight, f0) = (item.weight.unwrap_or(1.0), item.f0.unwrap_or(1.0));
        faults.within(format!("{place}/weight"), weight, MOST_WEIGHT);
        faults.within(format!("{place}/f0"), f0, 1.0);
        faults.within(format!("{place}/alpha_x"), item.alpha_x.unwrap_or(0.0), 1.0);
        faults.within(format!("{place}/alpha_y"), item.alpha_y.unwrap_or(0.0), 1.0);
        let mut gathered = Gathered::default();
        let (name, uncovered) = match (item.alpha_x, item.alpha_y, &item.gltf) {
            (Some(x), Some(y), None) => {
                let mut lobe = LobeAt::isotropic(LobeKind::Base, 1.0, x.max(y), f0);
                lobe.ratio = x.min(y).max(ALPHA_FLOOR) / lobe.alpha;
                gathered.add(&[lobe], weight, &[]);
                (format!("material {index}"), Vec::new())
            }
            (None, None, Some(material)) => match Shaded::read(material, Some(index), None) {
                Err(SceneError::Faults(found)) => {
                    faults.extend(found);
                    continue;
                }
                read => {
                    let shaded = read?;
                    let (part, lobes) = shaded.lobes(&|_| [0.0; 2]);
                    gathered.add(&lobes, weight * part, &[]);
                    scene.notes.extend(shaded.missing.iter().map(|missing| format!("{}: {missing}", shaded.name)));
                    (shaded.name, shaded.uncovered)
                }
            },
            _ => {
                faults.add(place, "a material has either alpha_x and alpha_y, or gltf");
                continue;
            }
        };
        let name = item.name.clone().filter(|name| !name.is_empty()).unwrap_or(name);
        let material = gathered.finish(name, uncovered, true);
        scene.materials.push(SceneMaterial { area: weight, ..material });
    }
    faults.none()?;
    scene.served()
}
