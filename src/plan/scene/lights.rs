//! The area lights of a scene.

use glam::{DMat4, DVec3};

use super::{
    accessor::Buffers,
    document::{AreaLight, AreaLights, Document, Emission},
    error::{Faults, SceneError, Unread, named, shown},
    extensions::{EXT_LIGHTS_AREA, extension},
    geometry::Geometry,
    graph::Graph,
    material::{LobeKind, luminance},
};
use ltcforge_fit::{Configuration, Sides};
use ltcforge_light::{AnyLight, LightShape, PlacedLight};

/// Maximum number of lights, and of vertices of a mesh whose triangles are lights.
const MOST_LIGHTS: usize = 32;
const MOST_VERTICES: u64 = 64;
/// The largest size, aspect, intensity and radiance of a light.
const MOST: f64 = 1e9;

/// An area light in the coordinates of a scene.
#[derive(Debug, Clone, PartialEq)]
pub struct SceneLight {
    /// The light's name.
    pub name: String,
    /// Its shape in the coordinates of the scene.
    pub light: PlacedLight,
    /// The radiance: the luminance of `rgb`.
    pub radiance: f64,
    /// The radiance in linear red, green and blue.
    pub rgb: [f64; 3],
}

impl SceneLight {
    /// A light with the luminance of a colour.
    #[must_use]
    pub fn new(name: String, light: PlacedLight, rgb: [f64; 3]) -> Self {
        Self { name, light, radiance: luminance(rgb), rgb }
    }
}

/// A point of a scene's surface with one of its lobes, as it is seen and lit.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct ScenePoint {
    /// The index of the material, and the kind of the lobe.
    pub(crate) of: (usize, LobeKind),
    /// The area that the point stands for, times the part of it that has the lobe.
    pub(crate) weight: f64,
    pub(crate) at: Configuration,
    /// Reflectance at normal and at grazing incidence, by the specification.
    pub(crate) fresnel: [f64; 2],
    /// The lights that reach the point, by their index.
    pub(crate) lights: Vec<(usize, AnyLight)>,
}

/// The area lights of a document, and notes about lights that are not read.
pub(super) fn read(
    document: &Document,
    buffers: &Buffers<'_>,
    graph: &Graph,
) -> Result<(Vec<SceneLight>, Vec<String>), SceneError> {
    let AreaLights { lights: listed, .. } = extension("", &document.extensions, EXT_LIGHTS_AREA)?;
    let (mut lights, mut notes) = (Vec::new(), Vec::new());
    for (node, world) in &graph.lights {
        let place = format!("/nodes/{node}");
        let AreaLights { light, .. } = extension(&place, &document.nodes[*node].extensions, EXT_LIGHTS_AREA)?;
        let missing =
            || SceneError::fault(format!("{place}/extensions/{EXT_LIGHTS_AREA}/light"), "there is no such light");
        let index = light.filter(|light| *light < listed.len()).ok_or_else(missing)?;
        let name = named(listed[index].name.as_deref(), || format!("light {index}"));
        match area_light(&listed[index], index, world)? {
            Some((light, rgb)) => lights.push(SceneLight::new(name, light, rgb)),
            None => notes.push(format!("{name}: a light of type {} is not read", shown(&listed[index].kind))),
        }
    }
    emissive(document, buffers, graph, &mut lights, &mut notes)?;
    if document.extensions.contains_key("KHR_lights_punctual") {
        notes
            .push("KHR_lights_punctual: point, spot and directional lights are not read: they have no area".to_owned());
    }
    lights.retain(|light| light.radiance > 0.0);
    if lights.len() > MOST_LIGHTS {
        notes.push(format!("lights that are ignored: {}; the limit is {MOST_LIGHTS}", lights.len() - MOST_LIGHTS));
        lights.sort_by(|a, b| b.radiance.total_cmp(&a.radiance));
        lights.truncate(MOST_LIGHTS);
    }
    Ok((lights, notes))
}

/// A light of `EXT_lights_area` with its radiance. It shines along -Z. `None` for an unknown shape.
fn area_light(light: &AreaLight, index: usize, world: &DMat4) -> Result<Option<(PlacedLight, [f64; 3])>, SceneError> {
    let (size, aspect, intensity) =
        (light.size.unwrap_or(1.0), light.rect.aspect.unwrap_or(1.0), light.intensity.unwrap_or(1.0));
    let color = light.color.unwrap_or([1.0; 3]);
    let mut faults = Faults::default();
    let numbers = [("size", size), ("rect/aspect", aspect), ("intensity", intensity)];
    for (field, value) in numbers.into_iter().chain(color.map(|part| ("color", part))) {
        faults.within(format!("/extensions/{EXT_LIGHTS_AREA}/lights/{index}/{field}"), value, MOST);
    }
    faults.none()?;
    let (x, y) = (0.5 * size * aspect * DVec3::X, 0.5 * size * DVec3::Y);
    // Vertices run clockwise as seen from the lit side.
    let (shape, mut points) = match light.kind.as_str() {
        "rect" => {
            (LightShape::Polygon, [-x - y, x - y, x + y, y - x].map(|corner| world.transform_point3(corner)).to_vec())
        }
        "disk" => {
            let [u, v] = [y, 0.5 * size * DVec3::X].map(|axis| world.transform_vector3(axis));
            (LightShape::Disk, vec![world.w_axis.truncate(), u, v])
        }
        _ => return Ok(None),
    };
    if world.determinant() < 0.0 {
        let first = usize::from(shape == LightShape::Disk);
        points[first..].reverse();
    }
    Ok(Some((PlacedLight { shape, sides: Sides::One, points, length: 0.0 }, color.map(|part| intensity * part))))
}

/// Adds the triangles of small meshes that emit light.
fn emissive(
    document: &Document,
    buffers: &Buffers<'_>,
    graph: &Graph,
    lights: &mut Vec<SceneLight>,
    notes: &mut Vec<String>,
) -> Result<(), SceneError> {
    for (posed, worlds) in &graph.worlds {
        let mesh = &document.meshes[posed.mesh];
        let name = named(mesh.name.as_deref(), || format!("mesh {}", posed.mesh));
        for (number, primitive) in mesh.primitives.iter().enumerate() {
            let Some(index) = primitive.material else { continue };
            let material = &document.materials[index];
            let emission: Emission =
                extension(&format!("/materials/{index}"), &material.extensions, "KHR_materials_emissive_strength")?;
            let strength = emission.emissive_strength.unwrap_or(1.0);
            let rgb = material.emissive_factor.map(|part| strength * part);
            let radiance = luminance(rgb);
            if !(radiance > 0.0 && radiance <= MOST) {
                continue;
            }
            let read = primitive.attributes.values().copied().chain(primitive.indices);
            let is_small = read.map(|accessor| document.accessors[accessor].count).max() <= Some(MOST_VERTICES)
                && lights.len() <= MOST_LIGHTS;
            if !is_small || material.emissive_texture.is_some() {
                let why =
                    if is_small { "its emissive texture" } else { "its emission (a large mesh, or too many lights)" };
                notes.push(format!("{name}: {why} is not read as a light"));
                continue;
            }
            let place = format!("/meshes/{}/primitives/{number}", posed.mesh);
            let pose = graph.pose(document, posed);
            let Ok(geometry) = Unread::split(Geometry::read(buffers, (primitive, &place), &pose, &[], false))? else {
                continue;
            };
            for world in worlds.iter().take(MOST_LIGHTS + 1) {
                for triangle in 0..geometry.len() {
                    let mut points = geometry.triangle(triangle, world).to_vec();
                    if world.determinant() > 0.0 {
                        points.reverse();
                    }
                    let sides = if material.double_sided { Sides::Two } else { Sides::One };
                    let light = PlacedLight { shape: LightShape::Polygon, sides, points, length: 0.0 };
                    lights.push(SceneLight::new(name.clone(), light, rgb));
                }
            }
        }
    }
    Ok(())
}
