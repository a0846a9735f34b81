//! The triangles of a mesh's primitive.

use std::collections::BTreeMap;

use glam::{DMat4, DVec2, DVec3, DVec4};

use super::{
    accessor::{Buffers, bounds},
    document::{Document, Primitive},
    error::SceneError,
};

/// Triangles with what stands at their corners.
#[derive(Debug)]
pub(super) struct Geometry {
    positions: Vec<[f32; 3]>,
    triangles: Vec<[u32; 3]>,
    normals: Option<Vec<[f32; 3]>>,
    tangents: Option<Vec<[f32; 4]>>,
    uv: BTreeMap<u32, Vec<[f32; 2]>>,
}

/// The shape of a primitive.
#[derive(Debug)]
pub(super) enum Shape {
    /// Its triangles.
    Triangles(Geometry),
    /// They cannot be read: why, and the box that they lie in, if the document tells it.
    Box { why: String, bounds: Option<[[f64; 3]; 2]> },
    /// It has no surface.
    None,
}

/// What is needed at a primitive's corners.
#[derive(Debug, Clone, Default)]
pub(super) struct Wanted {
    pub(super) sets: Vec<u32>,
    pub(super) frames: bool,
}

impl Shape {
    /// Reads a primitive. `place` is its pointer.
    pub(super) fn read(
        document: &Document,
        buffers: &Buffers,
        primitive: &Primitive,
        place: &str,
        wanted: &Wanted,
    ) -> Result<Self, SceneError> {
        if primitive.mode < 4 {
            return Ok(Self::None);
        }
        if primitive.mode > 6 {
            return Err(SceneError::fault(format!("{place}/mode"), format!("{} is not 0 to 6", primitive.mode)));
        }
        let Some(&of_positions) = primitive.attributes.get("POSITION") else { return Ok(Self::None) };
        let boxed = |why: String| Ok(Self::Box { why, bounds: bounds(&document.accessors[of_positions]) });
        if let Some(name) = primitive.extensions.keys().find(|name| name.ends_with("_draco_mesh_compression")) {
            return boxed(format!("it is compressed by {name}"));
        }
        let positions = match buffers.numbers::<3>(document, of_positions)? {
            Ok(positions) => positions,
            Err(why) => return boxed(why),
        };
        let order = match primitive.indices {
            None => (0..positions.len() as u32).collect(),
            Some(indices) => match buffers.indices(document, indices)? {
                Ok(indices) => indices,
                Err(why) => return boxed(why),
            },
        };
        if let Some(index) = order.iter().find(|index| **index as usize >= positions.len()) {
            let detail = format!("index {index} of {} corners", positions.len());
            return Err(SceneError::fault(format!("{place}/indices"), detail));
        }
        let attribute = |name: &str| primitive.attributes.get(name).copied();
        let (mut normals, mut tangents, mut uv) = (None, None, BTreeMap::new());
        // What stands there and cannot be read must not count as if it did not.
        if let Some(index) = attribute("NORMAL").filter(|_| wanted.frames) {
            match buffers.numbers::<3>(document, index)? {
                Ok(read) => normals = Some(read),
                Err(why) => return boxed(format!("its normals: {why}")),
            }
        }
        if let Some(index) = attribute("TANGENT").filter(|_| wanted.frames) {
            match buffers.numbers::<4>(document, index)? {
                Ok(read) => tangents = Some(read),
                Err(why) => return boxed(format!("its tangents: {why}")),
            }
        }
        for set in &wanted.sets {
            let Some(index) = attribute(&format!("TEXCOORD_{set}")) else {
                return boxed(format!("it has no TEXCOORD_{set}, at which its material has textures"));
            };
            match buffers.numbers::<2>(document, index)? {
                Ok(read) => uv.insert(*set, read),
                Err(why) => return boxed(format!("its texture coordinates: {why}")),
            };
        }
        let corners = positions.len();
        let short = [normals.as_ref().map(Vec::len), tangents.as_ref().map(Vec::len)];
        if short.iter().flatten().chain(uv.values().map(Vec::len).collect::<Vec<_>>().iter()).any(|n| *n < corners) {
            return Err(SceneError::fault(
                format!("{place}/attributes"),
                format!("one has fewer than {corners} elements"),
            ));
        }
        Ok(Self::Triangles(Geometry { positions, triangles: triangles(primitive.mode, &order), normals, tangents, uv }))
    }
}

/// Corners of triangles: those of a list, a strip or a fan.
fn triangles(mode: u32, order: &[u32]) -> Vec<[u32; 3]> {
    match mode {
        4 => order.as_chunks::<3>().0.to_vec(),
        5 => order.windows(3).map(|corners| [corners[0], corners[1], corners[2]]).collect(),
        _ => order.windows(2).skip(1).map(|pair| [order[0], pair[0], pair[1]]).collect(),
    }
}

/// A point of a triangle, in the world.
#[derive(Debug)]
pub(super) struct Point {
    pub(super) position: DVec3,
    pub(super) normal: DVec3,
    /// Along the surface, at a right angle to the normal, and the other one.
    pub(super) tangent: DVec3,
    pub(super) bitangent: DVec3,
}

impl Geometry {
    /// How many triangles there are.
    pub(super) fn len(&self) -> usize {
        self.triangles.len()
    }

    fn corners(&self, triangle: usize) -> [DVec3; 3] {
        self.triangles[triangle].map(|corner| DVec3::from(self.positions[corner as usize].map(f64::from)))
    }

    /// The surface of a triangle in the world; 0 where it is not finite.
    pub(super) fn area(&self, triangle: usize, world: &DMat4) -> f64 {
        let [a, b, c] = self.corners(triangle);
        let across = world.transform_vector3(b - a).cross(world.transform_vector3(c - a));
        let area = 0.5 * across.length();
        if area.is_finite() { area } else { 0.0 }
    }

    /// Texture coordinates at a point of a triangle, of a set.
    pub(super) fn uv(&self, triangle: usize, weights: [f64; 3], set: u32) -> [f64; 2] {
        let Some(uv) = self.uv.get(&set) else { return [0.0; 2] };
        let corners = self.triangles[triangle].map(|corner| DVec2::from(uv[corner as usize].map(f64::from)));
        corners.into_iter().zip(weights).map(|(uv, weight)| weight * uv).sum::<DVec2>().to_array()
    }

    /// The place and the frame at a point of a triangle.
    pub(super) fn point(&self, triangle: usize, weights: [f64; 3], world: &DMat4) -> Point {
        let corners = self.corners(triangle);
        let between = |values: [DVec3; 3]| values.into_iter().zip(weights).map(|(x, weight)| weight * x).sum::<DVec3>();
        let position = world.transform_point3(between(corners));
        let [ab, ac] = [corners[1] - corners[0], corners[2] - corners[0]].map(|edge| world.transform_vector3(edge));
        let flat = ab.cross(ac).normalize_or_zero();
        let order = self.triangles[triangle];
        let normal = self.normals.as_ref().map(|normals| {
            let normal = between(order.map(|corner| DVec3::from(normals[corner as usize].map(f64::from))));
            world.inverse().transpose().transform_vector3(normal).normalize_or_zero()
        });
        let normal = normal.filter(|normal| *normal != DVec3::ZERO && normal.is_finite()).unwrap_or(flat);
        let (tangent, side) = match &self.tangents {
            Some(tangents) => {
                let [a, b, c] = order.map(|corner| DVec4::from(tangents[corner as usize].map(f64::from)));
                (world.transform_vector3(between([a, b, c].map(DVec4::truncate))), if a.w < 0.0 { -1.0 } else { 1.0 })
            }
            None => (self.along_u(order, [ab, ac]), 1.0),
        };
        let tangent = (tangent - tangent.dot(normal) * normal).normalize_or(normal.any_orthonormal_vector());
        Point { position, normal, tangent, bitangent: side * normal.cross(tangent) }
    }

    /// The direction in which the first texture coordinate grows.
    fn along_u(&self, order: [u32; 3], [ab, ac]: [DVec3; 2]) -> DVec3 {
        let Some(uv) = self.uv.values().next() else { return ab };
        let [a, b, c] = order.map(|corner| DVec2::from(uv[corner as usize].map(f64::from)));
        let (first, second) = (b - a, c - a);
        let area = first.perp_dot(second);
        let along = (second.y * ab - first.y * ac) * area.signum();
        if area != 0.0 && along.is_finite() { along } else { ab }
    }
}

/// The surface of a box in the world.
pub(super) fn box_area(bounds: Option<[[f64; 3]; 2]>, world: &DMat4) -> f64 {
    let Some([min, max]) = bounds.map(|bounds| bounds.map(DVec3::from)) else { return 1.0 };
    let size = max - min;
    let [x, y, z] = [DVec3::X * size.x, DVec3::Y * size.y, DVec3::Z * size.z].map(|edge| world.transform_vector3(edge));
    let area = 2.0 * (x.cross(y).length() + y.cross(z).length() + z.cross(x).length());
    if area.is_finite() && area > 0.0 { area } else { 1.0 }
}
