//! Gathers the lobes of a scene's surface. Without cameras, the weight of an untextured material is the area of its
//! triangles. Other materials are read at points that are spread evenly over their surface.

use std::{collections::BTreeMap, f64::consts::TAU};

use glam::{DMat4, DVec3};
use rayon::prelude::*;

use super::{
    accessor::Buffers,
    camera::Placed,
    document::Document,
    error::{SceneError, named},
    gathered::Gathered,
    geometry::{Geometry, box_area},
    graph::Graph,
    lights::SceneLight,
    material::{LobeKind, Shaded},
    model::{Place, Scene},
};
use crate::histogram::STEEPEST;
use ltcforge_fit::{
    Configuration, GoOn,
    math::{atan2, recurrence4, sin_cos},
};

/// Number of points at which materials are read. The error of a histogram is then below 0.1 %.
const POINTS: f64 = (1 << 20) as f64;
/// Maximum number of cameras for which all points are read. If there are more cameras, fewer points are read.
const FULL_CAMERAS: f64 = 16.0;
const MOST_CAMERAS: u64 = 256;
/// Points that are read before the caller is asked whether to continue.
const POINTS_OF_PART: usize = 1 << 10;
/// Points that are read under the scene's lights, times the shapes of all lights, and the least and the most points.
const LIT: f64 = 8192.0;
const LEAST_LIT: f64 = 128.0;
const MOST_LIT: f64 = 2048.0;
/// Minimum number of triangles whose area a thread computes at once.
const LEAST_AREAS: usize = 1 << 12;
/// Number of points over the textures of a primitive whose triangles cannot be read.
const POINTS_OF_BOX: usize = 256;
/// Maximum number of notes about meshes.
const MOST_NOTES: usize = 100;
/// Maximum number of elements in the accessors of all primitives, and of triangles of all instances.
const MOST_CORNERS: u64 = 1 << 27;
const MOST_TRIANGLES: u64 = 1 << 26;

/// Gathers the lobes of every instance of every mesh. `materials` has the document's materials and then the default
/// material. A material that no primitive uses is `None`.
pub(super) fn gather(
    document: &Document,
    buffers: &Buffers<'_>,
    graph: &Graph,
    materials: &[Option<Shaded>],
    lights: Vec<SceneLight>,
    go_on: &GoOn<'_>,
) -> Result<Scene, SceneError> {
    let cameras = graph.cameras.len();
    let has_frames = cameras > 0 || !lights.is_empty();
    SceneError::above("cameras", cameras as u64, MOST_CAMERAS)?;
    let parts = || {
        graph.parts(document).filter_map(|part| {
            let slot = part.primitive.material.unwrap_or(document.materials.len());
            Some((part, slot, materials[slot].as_ref()?))
        })
    };
    let mut scene = Scene { cameras, lights, ..Scene::default() };
    // The area that is read at points, and all area.
    let (mut sampled, mut total, mut instances_of_all, mut corners, mut looks) = (0.0, 0.0, 0, 0, 0_u64);
    for (part, _, material) in parts() {
        SceneError::unless(go_on)?;
        // Elements are counted before they are read.
        let read = part.accessors().chain(part.primitive.targets.iter().flat_map(BTreeMap::values).copied());
        corners = read.map(|accessor| document.accessors[accessor].count).fold(corners, u64::saturating_add);
        SceneError::above("corners and indices of all primitives", corners, MOST_CORNERS)?;
        let geometry = SceneError::split(Geometry::read(buffers, &part, &[], false))?;
        let work = geometry.as_ref().map_or(POINTS_OF_BOX, Geometry::len) as u64;
        let instances = part.worlds.len() as u64;
        // An instance takes time even if it has no triangle.
        looks += work.max(1).saturating_mul(instances);
        SceneError::above("triangles of all instances", looks, MOST_TRIANGLES)?;
        let Ok(geometry) = geometry else { continue };
        scene.triangles += work * instances;
        let area = part.worlds.iter().map(|world| area_of(&reached(&geometry, world))).sum::<f64>();
        total += area;
        instances_of_all += instances;
        if cameras > 0 || material.is_textured() {
            sampled += area;
        }
    }
    let points = POINTS * (FULL_CAMERAS / cameras as f64).min(1.0);
    let per_point = if sampled > 0.0 { sampled / points } else { 1.0 };
    let shapes = scene.lights.iter().map(|light| light.shapes.len()).sum::<usize>();
    let lit = (LIT / shapes as f64).clamp(LEAST_LIT, MOST_LIT);
    let mut so_far = 0.0;
    let order: Vec<usize> = (0..materials.len()).map(|slot| materials[..slot].iter().flatten().count()).collect();
    let mut gathered: Vec<Gathered> = materials.iter().map(|_| Gathered::default()).collect();
    for (part, slot, material) in parts() {
        let mut sets = material.sets();
        let has = |name: &str| part.primitive.attributes.contains_key(name);
        // Without tangents, the direction of a material is along the first texture coordinate.
        let needs_uv = has_frames && material.is_anisotropic() && sets.is_empty() && !has("TANGENT");
        if needs_uv && has("TEXCOORD_0") {
            sets.push(0);
        }
        let read = if needs_uv && sets.is_empty() && has("POSITION") {
            Err(SceneError::Missing("it has no TANGENT, which its anisotropic material needs".to_owned()))
        } else {
            Geometry::read(buffers, &part, &sets, has_frames)
        };
        match SceneError::split(read)? {
            Ok(geometry) => {
                for world in part.worlds {
                    let instance = Instance { material, geometry: &geometry, world, cameras: &graph.cameras };
                    let reached = reached(&geometry, world);
                    instance.gather(&mut gathered[slot], (&reached, per_point), go_on)?;
                    if !scene.lights.is_empty() {
                        // Half of the points are spread by area, and half evenly over the instances.
                        let share = area_of(&reached) / total + 1.0 / instances_of_all as f64;
                        let expected = 0.5 * lit * share;
                        let count = (so_far + expected).floor() - so_far.floor();
                        so_far += expected;
                        scene.places.extend(instance.lit(
                            order[slot],
                            count as usize,
                            (&reached, expected),
                            &scene.lights,
                        ));
                    }
                }
            }
            Err(why) => {
                for world in part.worlds {
                    SceneError::unless(go_on)?;
                    let positions = &document.accessors[part.primitive.attributes["POSITION"]];
                    gather_box(&mut gathered[slot], material, box_area(positions, world));
                }
                let name = named(document.meshes[part.mesh].name.as_deref(), || part.mesh.to_string());
                scene.notes.push(format!(
                    "mesh {name}: {why}; its box is used instead, with the whole textures of its materials, \
                     seen from everywhere"
                ));
                scene.notes.truncate(MOST_NOTES);
            }
        }
    }
    for (gathered, material) in gathered.into_iter().zip(materials) {
        let Some(Shaded { name, missing, uncovered, has_normal_map, .. }) = material else { continue };
        scene.notes.extend(missing.iter().map(|missing| format!("{name}: {missing}")));
        let is_every_view = gathered.is_placeless || *has_normal_map;
        scene.materials.push(gathered.finish(name.clone(), uncovered.clone(), is_every_view));
    }
    Ok(scene)
}

/// The total area up to and including each triangle, in the world.
fn reached(geometry: &Geometry, world: &DMat4) -> Vec<f64> {
    let triangles = (0..geometry.len()).into_par_iter().with_min_len(LEAST_AREAS);
    let areas: Vec<f64> = triangles.map(|triangle| geometry.area(triangle, world)).collect();
    let mut sum = 0.0;
    let up_to = |area: f64| {
        sum += area;
        sum
    };
    areas.into_iter().map(up_to).collect()
}

/// The area of an instance.
fn area_of(reached: &[f64]) -> f64 {
    reached.last().copied().unwrap_or(0.0)
}

/// A point at an even step of the area, one triangle after another: point i at i + 1/2 steps. Returns the triangle and
/// the weights of its corners. `reached` is the total area up to and including each triangle.
fn spread(number: usize, step: f64, reached: &[f64]) -> Option<(usize, [f64; 3])> {
    let triangle = reached.partition_point(|reached| *reached < (number as f64 + 0.5) * step);
    let [u, v, ..] = recurrence4(number, [0.0; 4]);
    let (u, v) = if u + v > 1.0 { (1.0 - u, 1.0 - v) } else { (u, v) };
    (triangle < reached.len()).then_some((triangle, [1.0 - u - v, u, v]))
}

/// Gathers a surface whose position is not known.
fn gather_box(gathered: &mut Gathered, material: &Shaded, area: f64) {
    let points = if material.is_textured() { POINTS_OF_BOX } else { 1 };
    for number in 0..points {
        let [u, v, ..] = recurrence4(number, [0.0; 4]);
        let (part, lobes) = material.lobes(&|_| [u, v]);
        gathered.add(&lobes, area / points as f64 * part, &[]);
    }
    gathered.is_placeless = true;
}

/// An instance of a primitive.
struct Instance<'a> {
    material: &'a Shaded,
    geometry: &'a Geometry,
    world: &'a DMat4,
    cameras: &'a [Placed],
}

impl Instance<'_> {
    /// Gathers the lobes of the instance. If they vary or there are cameras, it reads one point per `per_point` of
    /// area.
    fn gather(
        &self,
        gathered: &mut Gathered,
        (reached, per_point): (&[f64], f64),
        go_on: &GoOn<'_>,
    ) -> Result<(), SceneError> {
        SceneError::unless(go_on)?;
        let total = area_of(reached);
        if self.cameras.is_empty() && !self.material.is_textured() {
            let (part, lobes) = self.material.lobes(&|_| [0.0; 2]);
            gathered.add(&lobes, total * part, &[]);
            return Ok(());
        }
        let points = (total / per_point).ceil().max(1.0);
        let step = total / points;
        for number in (0..points as usize).filter(|_| total > 0.0) {
            if number % POINTS_OF_PART == 0 {
                SceneError::unless(go_on)?;
            }
            let Some((triangle, weights)) = spread(number, step, reached) else { break };
            let (position, frame) = self.geometry.point(triangle, weights, self.world);
            let component = |wo: DVec3| DVec3::new(wo.dot(frame[0]), wo.dot(frame[1]), wo.dot(frame[2]).abs());
            let views: Vec<DVec3> = self.views(position, frame[2]).map(component).collect();
            if self.cameras.is_empty() || !views.is_empty() {
                let (part, lobes) = self.material.lobes(&|set| self.geometry.uv(triangle, weights, set));
                gathered.add(&lobes, step * part, &views);
            }
        }
        Ok(())
    }

    /// The directions to the cameras that see a point. Cameras behind a surface of one side do not see it.
    fn views(&self, position: DVec3, normal: DVec3) -> impl Iterator<Item = DVec3> {
        let views = self.cameras.iter().filter_map(move |camera| camera.view(position));
        views.filter(move |wo| wo.dot(normal) > 0.0 || self.material.double_sided && wo.dot(normal) < 0.0)
    }

    /// `count` points of the instance with their lights, each for an `expected` part of its area.
    fn lit(
        &self,
        material: usize,
        count: usize,
        (reached, expected): (&[f64], f64),
        lights: &[SceneLight],
    ) -> Vec<Place> {
        let (mut found, area) = (Vec::new(), area_of(reached));
        for number in (0..count).filter(|_| area > 0.0) {
            let Some((triangle, weights)) = spread(number, area / count as f64, reached) else { continue };
            let (position, [tangent, bitangent, normal]) = self.geometry.point(triangle, weights, self.world);
            let seen: Vec<DVec3> = self.views(position, normal).collect();
            let [.., u, v] = recurrence4(number, [0.0; 4]);
            let wo = seen.get(number % seen.len().max(1));
            // Without cameras, both sides are seen from everywhere.
            let is_behind = wo.map_or(self.material.double_sided && number % 2 == 1, |wo| wo.dot(normal) < 0.0);
            let normal = if is_behind { -normal } else { normal };
            let (part, lobes) = self.material.lobes(&|set| self.geometry.uv(triangle, weights, set));
            for lobe in lobes.iter().filter(|lobe| lobe.weight > 0.0) {
                let (sin, cos) = sin_cos(lobe.turn);
                let along = cos * tangent + sin * bitangent;
                let frame = [along, normal.cross(along), normal];
                let (theta, phi) = match wo.map(|wo| frame.map(|axis| wo.dot(axis))) {
                    Some([x, y, z]) => (atan2((x * x + y * y).sqrt(), z), atan2(y, x)),
                    None if self.cameras.is_empty() => (u * STEEPEST, v * TAU),
                    None => continue,
                };
                if theta > STEEPEST {
                    continue;
                }
                let lights = lights.iter().enumerate();
                // The formula of a base lobe includes its strength.
                let strength = if lobe.kind == LobeKind::Base { 1.0 } else { lobe.weight };
                found.push(Place {
                    of: (material, lobe.kind),
                    weight: area / expected * part * strength,
                    at: Configuration { alpha_x: lobe.alpha, alpha_y: lobe.alpha * lobe.ratio, theta, phi },
                    fresnel: lobe.formula,
                    lights: lights.flat_map(|(index, light)| light.seen_from(index, position, frame)).collect(),
                });
            }
        }
        found
    }
}
