//! The lobes of a scene's surface, weighed by the surface that has them: exactly where a material is the same all over
//! and there is no camera, else at points that are spread evenly over all of it.

use std::ops::Range;

use glam::{DMat4, DVec3};
use rayon::prelude::*;

use super::{
    accessor::Buffers,
    camera::Placed,
    document::Document,
    error::SceneError,
    geometry::{Geometry, Shape, Wanted, box_area},
    graph::{Graph, Instance},
    material::{LobeAt, LobeKind, Shaded, folded},
    model::{SceneLobe, SceneMaterial},
};
use crate::histogram::{Histogram, Views};
use ltcforge_fit::{GoOn, math::recurrence4};

/// Points at which materials are looked up: their histograms are then within a part in a thousand.
const POINTS: f64 = (1 << 20) as f64;
/// Cameras that look at all of them, and the most that there may be.
const FULL_CAMERAS: f64 = 16.0;
const MOST_CAMERAS: u64 = 256;
/// Points that one thread looks at before another may; before them the caller is asked whether to go on.
const POINTS_OF_PART: usize = 1 << 10;
/// Triangles whose surface one thread tells at once.
const LEAST_AREAS: usize = 1 << 12;
/// Points over the textures of a primitive whose triangles cannot be read.
const POINTS_OF_BOX: usize = 256;
/// Notes about meshes: more would only repeat them.
const MOST_NOTES: usize = 100;
/// Elements of the accessors of all primitives, and triangles of all instances.
const MOST_CORNERS: u64 = 1 << 27;
const MOST_TRIANGLES: u64 = 1 << 26;

/// The lobes of a material as they are gathered.
#[derive(Debug, Default)]
struct Gathered {
    lobes: Vec<(LobeKind, Histogram, Views)>,
    area: f64,
    /// Whether a part of it has no place, so that every view of it counts.
    is_placeless: bool,
}

/// All materials of a surface.
#[derive(Debug)]
pub(super) struct Surface<'a> {
    pub(super) document: &'a Document,
    pub(super) buffers: &'a Buffers,
    /// One for each of the document's, then the default one; those that no primitive has are not read.
    pub(super) materials: &'a [Option<Shaded>],
    pub(super) triangles: u64,
    pub(super) notes: Vec<String>,
    gathered: Vec<Gathered>,
}

impl<'a> Surface<'a> {
    pub(super) fn new(document: &'a Document, buffers: &'a Buffers, materials: &'a [Option<Shaded>]) -> Self {
        let gathered = materials.iter().map(|_| Gathered::default()).collect();
        Self { document, buffers, materials, triangles: 0, notes: Vec::new(), gathered }
    }

    /// Gathers the lobes of every instance of every mesh.
    pub(super) fn gather(&mut self, graph: &Graph, go_on: &GoOn<'_>) -> Result<(), SceneError> {
        let mut of_mesh = vec![Vec::new(); self.document.meshes.len()];
        graph.instances.iter().for_each(|Instance { mesh, world }| of_mesh[*mesh].push(*world));
        SceneError::above("cameras", graph.cameras.len() as u64, MOST_CAMERAS)?;
        let total = self.sampled_area(&of_mesh, !graph.cameras.is_empty(), go_on)?;
        // Each camera looks at each point, so that many have fewer.
        let points = POINTS * (FULL_CAMERAS / graph.cameras.len() as f64).min(1.0);
        let per_point = if total > 0.0 { total / points } else { 1.0 };
        for (mesh, worlds) in of_mesh.iter().enumerate().filter(|(_, worlds)| !worlds.is_empty()) {
            for primitive in 0..self.document.meshes[mesh].primitives.len() {
                let slot = self.slot(mesh, primitive);
                let Some(material) = &self.materials[slot] else { continue };
                match self.shape(mesh, primitive, material, !graph.cameras.is_empty())? {
                    Shape::Triangles(geometry) => {
                        for world in worlds {
                            let seen = Seen { cameras: &graph.cameras, world, per_point, go_on };
                            self.gathered[slot].add(material, &geometry, &seen)?;
                        }
                    }
                    Shape::Box { why, bounds } => {
                        for world in worlds {
                            SceneError::unless(go_on)?;
                            self.gathered[slot].add_box(material, box_area(bounds, world));
                        }
                        self.note_box(mesh, &why);
                    }
                    Shape::None => {}
                }
            }
        }
        Ok(())
    }

    fn slot(&self, mesh: usize, primitive: usize) -> usize {
        self.document.meshes[mesh].primitives[primitive].material.unwrap_or(self.materials.len() - 1)
    }

    fn shape(&self, mesh: usize, primitive: usize, material: &Shaded, frames: bool) -> Result<Shape, SceneError> {
        let mut sets = material.sets();
        if frames && material.is_anisotropic() && sets.is_empty() {
            sets.push(0);
        }
        let place = format!("/meshes/{mesh}/primitives/{primitive}");
        let of = &self.document.meshes[mesh].primitives[primitive];
        Shape::read(self.document, self.buffers, of, &place, &Wanted { sets, frames })
    }

    /// The surface whose points have to be looked at, and the number of all triangles.
    fn sampled_area(&mut self, of_mesh: &[Vec<DMat4>], has_cameras: bool, go_on: &GoOn<'_>) -> Result<f64, SceneError> {
        let (mut total, mut corners, mut looks) = (0.0, 0, 0_u64);
        for (mesh, worlds) in of_mesh.iter().enumerate().filter(|(_, worlds)| !worlds.is_empty()) {
            for primitive in 0..self.document.meshes[mesh].primitives.len() {
                let Some(material) = &self.materials[self.slot(mesh, primitive)] else { continue };
                let place = format!("/meshes/{mesh}/primitives/{primitive}");
                let of = &self.document.meshes[mesh].primitives[primitive];
                SceneError::unless(go_on)?;
                // What is read is counted before it is.
                let count = |accessor: usize| self.document.accessors[accessor].count;
                let read = of.attributes.values().copied().chain(of.indices).map(count);
                corners = read.fold(corners, u64::saturating_add);
                SceneError::above("corners and indices of all primitives", corners, MOST_CORNERS)?;
                let shape = Shape::read(self.document, self.buffers, of, &place, &Wanted::default())?;
                let (triangles, work) = match &shape {
                    Shape::Triangles(geometry) => (geometry.len() as u64, geometry.len() as u64),
                    Shape::Box { .. } => (0, POINTS_OF_BOX as u64),
                    Shape::None => (0, 0),
                };
                let instances = worlds.len() as u64;
                self.triangles += triangles * instances;
                // An instance takes time even if it has no triangle.
                looks += work.max(1).saturating_mul(instances);
                SceneError::above("triangles of all instances", looks, MOST_TRIANGLES)?;
                if let Shape::Triangles(geometry) = &shape
                    && (has_cameras || material.is_textured())
                {
                    total += worlds.iter().flat_map(|world| areas(geometry, world)).sum::<f64>();
                }
            }
        }
        Ok(total)
    }

    fn note_box(&mut self, mesh: usize, why: &str) {
        if self.notes.len() >= MOST_NOTES {
            return;
        }
        let name = self.document.meshes[mesh].name.as_deref().unwrap_or("");
        let name: String = name.chars().filter(|c| !c.is_control()).take(80).collect();
        let name = if name.is_empty() { name } else { format!(" {name}") };
        self.notes.push(format!(
            "mesh {mesh}{name}: {why}; its materials weigh as the surface of its box, all of their textures alike, seen from \
             everywhere"
        ));
    }

    /// The materials that the surface has, in the document's order.
    pub(super) fn finish(self) -> (Vec<SceneMaterial>, Vec<String>) {
        let (mut notes, mut materials) = (self.notes, Vec::new());
        let used =
            self.gathered.into_iter().zip(self.materials).filter_map(|(gathered, of)| Some((gathered, of.as_ref()?)));
        for (gathered, of) in used {
            notes.extend(of.missing.iter().map(|missing| format!("{}: {missing}", of.name)));
            let every_view = gathered.is_placeless || of.has_normal_map;
            let lobe = |(kind, histogram, views): (LobeKind, Histogram, Views)| SceneLobe {
                kind,
                spots: histogram.spots(),
                views: if every_view { Views::default() } else { views },
                f0: histogram.f0(),
            };
            materials.push(SceneMaterial {
                name: of.name.clone(),
                area: gathered.area,
                lobes: gathered.lobes.into_iter().map(lobe).filter(|lobe| !lobe.spots.is_empty()).collect(),
                uncovered: of.uncovered.clone(),
            });
        }
        (materials, notes)
    }
}

/// The surface of each triangle in the world.
fn areas(geometry: &Geometry, world: &DMat4) -> Vec<f64> {
    let all = (0..geometry.len()).into_par_iter().with_min_len(LEAST_AREAS);
    all.map(|triangle| geometry.area(triangle, world)).collect()
}

/// How an instance is looked at.
struct Seen<'a> {
    cameras: &'a [Placed],
    world: &'a DMat4,
    /// Surface for each point.
    per_point: f64,
    go_on: &'a GoOn<'a>,
}

impl Gathered {
    fn lobe(&mut self, kind: LobeKind) -> &mut (LobeKind, Histogram, Views) {
        let index = self.lobes.iter().position(|(of, ..)| *of == kind).unwrap_or_else(|| {
            self.lobes.push((kind, Histogram::default(), Views::default()));
            self.lobes.len() - 1
        });
        &mut self.lobes[index]
    }

    /// Adds lobes that a piece of surface has, and the directions from which it is seen with their azimuths' axes.
    fn note(&mut self, lobes: &[LobeAt], weight: f64, views: &[DVec3]) {
        if weight <= 0.0 {
            return;
        }
        self.area += weight;
        for at in lobes.iter().filter(|at| at.weight > 0.0) {
            let weight = weight * at.weight;
            let (_, histogram, of_views) = self.lobe(at.kind);
            histogram.add(at.alpha, at.ratio, weight);
            histogram.add_f0(at.metal, at.dielectric, weight);
            for view in views {
                let across = view.truncate().length();
                let theta = ltcforge_fit::math::atan2(across, view.z);
                of_views.add(theta, folded(view.x, view.y, at.turn), weight / views.len() as f64);
            }
        }
    }

    /// Adds an instance of a primitive.
    fn add(&mut self, material: &Shaded, geometry: &Geometry, seen: &Seen<'_>) -> Result<(), SceneError> {
        SceneError::unless(seen.go_on)?;
        let areas = areas(geometry, seen.world);
        let total: f64 = areas.iter().sum();
        if seen.cameras.is_empty() && !material.is_textured() {
            let mut lobes = Vec::new();
            let there = material.lobes(&|_| [0.0; 2], &mut lobes);
            self.note(&lobes, total * there, &[]);
            return Ok(());
        }
        if total <= 0.0 {
            return Ok(());
        }
        // Points stand at even steps of the surface, one triangle after another: that of number i at i + 1/2 steps.
        let points = (total / seen.per_point).ceil().max(1.0);
        let (step, count) = (total / points, points as usize);
        let reached: Vec<f64> =
            areas.iter().scan(0.0, |sum, area| Some(*sum + area).inspect(|is| *sum = *is)).collect();
        let parts = (0..count.div_ceil(POINTS_OF_PART)).into_par_iter().map(|part| {
            SceneError::unless(seen.go_on)?;
            let numbers = part * POINTS_OF_PART..((part + 1) * POINTS_OF_PART).min(count);
            Ok(Self::of_points(material, geometry, seen, numbers, (step, &reached)))
        });
        // Sums have one order, on any number of threads.
        parts.collect::<Result<Vec<_>, SceneError>>()?.iter().for_each(|part| self.merge(part));
        Ok(())
    }

    /// The points of some numbers: `step` is the surface of each, and `reached` that of the triangles up to each.
    fn of_points(
        material: &Shaded,
        geometry: &Geometry,
        seen: &Seen<'_>,
        numbers: Range<usize>,
        (step, reached): (f64, &[f64]),
    ) -> Self {
        let (mut found, mut lobes, mut views) = (Self::default(), Vec::new(), Vec::new());
        let mut triangle = reached.partition_point(|reached| *reached < (numbers.start as f64 + 0.5) * step);
        for number in numbers {
            let at = (number as f64 + 0.5) * step;
            while triangle < reached.len() && reached[triangle] < at {
                triangle += 1;
            }
            if triangle == reached.len() {
                break;
            }
            let [u, v, ..] = recurrence4(number, [0.0; 4]);
            let (u, v) = if u + v > 1.0 { (1.0 - u, 1.0 - v) } else { (u, v) };
            let weights = [1.0 - u - v, u, v];
            views.clear();
            if !seen.cameras.is_empty() {
                let point = geometry.point(triangle, weights, seen.world);
                let towards = seen.cameras.iter().filter_map(|camera| {
                    let wo = camera.view(point.position)?;
                    let up = wo.dot(point.normal);
                    let up = if material.double_sided { up.abs() } else { up };
                    (up > 0.0).then(|| DVec3::new(wo.dot(point.tangent), wo.dot(point.bitangent), up))
                });
                views.extend(towards);
            }
            if seen.cameras.is_empty() || !views.is_empty() {
                let there = material.lobes(&|set| geometry.uv(triangle, weights, set), &mut lobes);
                found.note(&lobes, step * there, &views);
            }
        }
        found
    }

    /// Adds all that a part gathered.
    fn merge(&mut self, part: &Self) {
        self.area += part.area;
        for (kind, histogram, views) in &part.lobes {
            let (_, all, all_views) = self.lobe(*kind);
            all.merge(histogram);
            all_views.merge(views);
        }
    }

    /// Adds surface whose place is not known.
    fn add_box(&mut self, material: &Shaded, area: f64) {
        let points = if material.is_textured() { POINTS_OF_BOX } else { 1 };
        let mut lobes = Vec::new();
        for number in 0..points {
            let [u, v, ..] = recurrence4(number, [0.0; 4]);
            let there = material.lobes(&|_| [u, v], &mut lobes);
            self.note(&lobes, area / points as f64 * there, &[]);
        }
        self.is_placeless = true;
    }
}
