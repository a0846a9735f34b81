//! The area lights of a scene.

use glam::{DMat4, DVec3};

use super::{
    accessor::Buffers,
    document::{AreaLight, AreaLights, Document, Emission, Material, Rect},
    error::{Faults, SceneError, named, shown},
    extensions::{EXT_LIGHTS_AREA, extension, unknown},
    geometry::Geometry,
    graph::Graph,
    material::luminance,
};
use ltcforge_fit::{GoOn, Sides};
use ltcforge_light::{AnyLight, LightShape, PlacedLight};

/// Maximum number of polygons and disks of all lights, and of vertices of a mesh that is a light.
const MOST_SHAPES: usize = 64;
const MOST_VERTICES: u64 = 64;
/// Maximum number of nodes with lights, of lights that are compared, and of primitives in all poses of their meshes.
const MOST_NODES: u64 = 1 << 12;
const MOST_COMPARED: usize = 1 << 12;
const MOST_PRIMITIVES: u64 = 1 << 24;
/// Maximum number of notes about lights.
const MOST_NOTES: usize = 100;
/// The largest size, aspect, intensity and radiance of a light, and the largest coordinate.
const MOST: f64 = 1e9;

/// An area light in the coordinates of a scene.
#[derive(Debug, Clone, PartialEq)]
pub struct SceneLight {
    /// The light's name.
    pub name: String,
    /// Its shapes in the coordinates of the scene: one, or the triangles of a mesh.
    pub shapes: Vec<PlacedLight>,
    /// The radiance: the luminance of `rgb`.
    pub radiance: f64,
    /// The radiance in linear red, green and blue.
    pub rgb: [f64; 3],
}

impl SceneLight {
    /// A light with the luminance of a colour.
    #[must_use]
    pub fn new(name: String, shapes: Vec<PlacedLight>, rgb: [f64; 3]) -> Self {
        Self { name, shapes, radiance: luminance(rgb), rgb }
    }

    /// The shapes as seen from a point, in its frame of tangent, bitangent and normal, each with the `index` of the
    /// light.
    pub(crate) fn seen_from(
        &self,
        index: usize,
        position: DVec3,
        frame: [DVec3; 3],
    ) -> impl Iterator<Item = (usize, AnyLight)> {
        self.shapes.iter().filter_map(move |shape| Some((index, shape.seen_from(position, frame)?)))
    }
}

/// The area lights of a document, and notes about lights that are not read.
pub(super) fn read(
    document: &Document,
    buffers: &Buffers<'_>,
    graph: &Graph,
    go_on: &GoOn<'_>,
) -> Result<(Vec<SceneLight>, Vec<String>), SceneError> {
    SceneError::above("nodes with lights", graph.lights.len() as u64, MOST_NODES)?;
    let AreaLights { lights: listed, .. } = extension("", &document.extensions, EXT_LIGHTS_AREA)?;
    let (mut lights, mut notes) = (Vec::new(), Vec::new());
    for (node, world) in &graph.lights {
        let place = format!("/nodes/{node}");
        let AreaLights { light, .. } = extension(&place, &document.nodes[*node].extensions, EXT_LIGHTS_AREA)?;
        let missing =
            || SceneError::fault(format!("{place}/extensions/{EXT_LIGHTS_AREA}/light"), "there is no such light");
        let index = light.filter(|light| *light < listed.len()).ok_or_else(missing)?;
        let name = named(listed[index].name.as_deref(), || format!("light {index}"));
        match SceneError::split(area_light(&listed[index], index, world))? {
            Ok((shape, rgb)) => lights.push(SceneLight::new(name, vec![shape], rgb)),
            Err(why) => notes.push(format!("{name}: {why}")),
        }
    }
    emissive(document, buffers, graph, (&mut lights, &mut notes), go_on)?;
    let unread = unknown(document.extensions_used.iter()).filter(|name| name.contains("_lights_"));
    notes.extend(unread.map(|name| format!("{}: its lights are not read", shown(name))));
    if document.extensions.contains_key("KHR_lights_punctual") {
        notes
            .push("KHR_lights_punctual: point, spot and directional lights are not read: they have no area".to_owned());
    }
    lights.retain(|light| light.radiance > 0.0);
    // The brightest lights stay.
    lights.sort_by(|a, b| b.radiance.total_cmp(&a.radiance));
    let (all, mut left) = (lights.len(), MOST_SHAPES);
    lights.retain(|light| {
        let fits = light.shapes.len() <= left;
        left -= if fits { light.shapes.len() } else { 0 };
        fits
    });
    let ignored = all - lights.len();
    if ignored > 0 {
        notes.push(format!("lights that are ignored: {ignored}; all lights may have {MOST_SHAPES} polygons and disks"));
    }
    notes.truncate(MOST_NOTES);
    Ok((lights, notes))
}

/// A light of `EXT_lights_area` with its radiance. It shines along -Z.
fn area_light(light: &AreaLight, index: usize, world: &DMat4) -> Result<(PlacedLight, [f64; 3]), SceneError> {
    let AreaLight { size, intensity, color, rect: Rect { aspect }, .. } = *light;
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
        _ => return Err(SceneError::Missing(format!("a light of type {} is not read", shown(&light.kind)))),
    };
    if world.determinant() < 0.0 {
        let first = usize::from(shape == LightShape::Disk);
        points[first..].reverse();
    }
    let placed = PlacedLight { shape, sides: Sides::One, points, length: 0.0 };
    if !is_near(&placed) {
        return Err(SceneError::Missing("a light with a coordinate above 1e9 is not read".to_owned()));
    }
    Ok((placed, color.map(|part| intensity * part)))
}

/// Whether all coordinates of a light are within [`MOST`].
fn is_near(light: &PlacedLight) -> bool {
    light.points.iter().all(|point| point.abs().max_element() <= MOST)
}

/// The radiance of a material's emission.
fn radiance((index, material): (usize, &Material)) -> Result<[f64; 3], SceneError> {
    let place = format!("/materials/{index}");
    let emission: Emission = extension(&place, &material.extensions, "KHR_materials_emissive_strength")?;
    let strength = emission.emissive_strength;
    let mut faults = Faults::default();
    for part in material.emissive_factor {
        faults.within(format!("{place}/emissiveFactor"), part, f64::MAX);
    }
    faults.within(format!("{place}/extensions/KHR_materials_emissive_strength/emissiveStrength"), strength, f64::MAX);
    faults.none()?;
    Ok(material.emissive_factor.map(|part| strength * part))
}

/// Adds small meshes that emit light: one light for each instance of a primitive.
fn emissive(
    document: &Document,
    buffers: &Buffers<'_>,
    graph: &Graph,
    (lights, notes): (&mut Vec<SceneLight>, &mut Vec<String>),
    go_on: &GoOn<'_>,
) -> Result<(), SceneError> {
    let radiances: Vec<[f64; 3]> = document.materials.iter().enumerate().map(radiance).collect::<Result<_, _>>()?;
    for (number, part) in graph.parts(document).enumerate() {
        SceneError::unless(go_on)?;
        SceneError::above("primitives of all meshes in their poses", number as u64, MOST_PRIMITIVES)?;
        let index = part.primitive.material.filter(|index| luminance(radiances[*index]) > 0.0);
        let Some(index) = index else { continue };
        let (material, rgb) = (&document.materials[index], radiances[index]);
        let name = || named(document.meshes[part.mesh].name.as_deref(), || format!("mesh {}", part.mesh));
        let is_large = part.accessors().any(|accessor| document.accessors[accessor].count > MOST_VERTICES);
        let read = if luminance(rgb) > MOST {
            Err("its emission is above 1e9".to_owned())
        } else if material.emissive_texture.is_some() {
            Err("its emission has a texture".to_owned())
        } else if is_large {
            Err(format!("it has more than {MOST_VERTICES} vertices or indices"))
        } else if lights.len() + part.worlds.len() > MOST_COMPARED {
            Err("there are too many lights".to_owned())
        } else {
            SceneError::split(Geometry::read(buffers, &part, &[], false))?
        };
        let sides = if material.double_sided { Sides::Two } else { Sides::One };
        let placed = |geometry: &Geometry, world: &DMat4| -> Vec<PlacedLight> {
            let triangle = |triangle: usize| {
                let mut points = geometry.triangle(triangle, world).to_vec();
                if world.determinant() > 0.0 {
                    points.reverse();
                }
                PlacedLight { shape: LightShape::Polygon, sides, points, length: 0.0 }
            };
            (0..geometry.len()).filter(|i| geometry.area(*i, world) > 0.0).map(triangle).filter(is_near).collect()
        };
        let before = lights.len();
        let why = match read {
            Ok(geometry) => {
                let all = part.worlds.iter().map(|world| placed(&geometry, world)).filter(|shapes| !shapes.is_empty());
                lights.extend(all.map(|shapes| SceneLight::new(name(), shapes, rgb)));
                "its triangles are empty or too far away".to_owned()
            }
            Err(why) => why,
        };
        if lights.len() == before && notes.len() < MOST_NOTES {
            notes.push(format!("{}: not used as a light: {why}", name()));
        }
    }
    Ok(())
}
