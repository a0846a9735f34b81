//! The triangles of a mesh's primitive.

use std::collections::BTreeMap;

use glam::{DMat4, DVec2, DVec3, DVec4, Vec3};

use super::{accessor::Buffers, document::Accessor, error::SceneError, graph::Part};

/// Adds weighted vectors; missing vectors are zero.
fn add(vectors: &mut [[f32; 3]], added: Option<Vec<[f32; 3]>>, weight: f64) {
    for (vector, added) in vectors.iter_mut().zip(added.into_iter().flatten()) {
        *vector = (Vec3::from(*vector) + weight as f32 * Vec3::from(added)).to_array();
    }
}

/// Triangles with the attributes of their corners.
#[derive(Debug, Default)]
pub(super) struct Geometry {
    positions: Vec<[f32; 3]>,
    triangles: Vec<[u32; 3]>,
    normals: Option<Vec<[f32; 3]>>,
    tangents: Option<Vec<[f32; 4]>>,
    uv: BTreeMap<u32, Vec<[f32; 2]>>,
}

impl Geometry {
    /// Reads a primitive in its pose with some sets of texture coordinates, and normals and tangents if `has_frames`.
    /// Points and lines have no triangles.
    pub(super) fn read(
        buffers: &Buffers<'_>,
        part: &Part<'_>,
        sets: &[u32],
        has_frames: bool,
    ) -> Result<Self, SceneError> {
        let primitive = part.primitive;
        let fault = |field: &str, detail: String| Err(SceneError::fault(format!("{}/{field}", part.place()), detail));
        let mode = primitive.mode;
        if mode > 6 {
            return fault("mode", format!("{mode} is not between 0 and 6"));
        }
        let attribute = |name: &str| primitive.attributes.get(name).copied();
        let Some(positions) = attribute("POSITION").filter(|_| mode >= 4) else { return Ok(Self::default()) };
        if let Some(name) = primitive.extensions.keys().find(|name| name.ends_with("_draco_mesh_compression")) {
            return Err(SceneError::Missing(format!("it is compressed by {name}")));
        }
        let positions = buffers.numbers::<3>(positions)?;
        let corners = positions.len();
        let order = match primitive.indices {
            None => (0..corners as u32).collect(),
            Some(indices) => buffers.indices(indices)?,
        };
        if let Some(index) = order.iter().find(|index| **index as usize >= corners) {
            return fault("indices", format!("index {index} of {corners} corners"));
        }
        let of_frame = |name: &str| attribute(name).filter(|_| has_frames);
        let normals = of_frame("NORMAL").map(|index| buffers.numbers::<3>(index)).transpose()?;
        let tangents = of_frame("TANGENT").map(|index| buffers.numbers::<4>(index)).transpose()?;
        let mut uv = BTreeMap::new();
        for set in sets {
            let name = format!("TEXCOORD_{set}");
            let index = attribute(&name);
            let index = index.ok_or_else(|| SceneError::Missing(format!("it has no {name}, which a texture needs")))?;
            uv.insert(*set, buffers.numbers::<2>(index)?);
        }
        let of_frames = normals.iter().map(Vec::len).chain(tangents.iter().map(Vec::len));
        if of_frames.chain(uv.values().map(Vec::len)).min().is_some_and(|least| least < corners) {
            return fault("attributes", format!("an attribute has fewer elements than POSITION, which has {corners}"));
        }
        let triangles = match mode {
            4 => order.as_chunks::<3>().0.to_vec(),
            5 => order.windows(3).map(|corners| [corners[0], corners[1], corners[2]]).collect(),
            _ => order.windows(2).skip(1).map(|pair| [order[0], pair[0], pair[1]]).collect(),
        };
        let mut geometry = Self { positions, triangles, normals, tangents, uv };
        for (target, weight) in primitive.targets.iter().zip(part.weights).filter(|(_, weight)| **weight != 0.0) {
            let added = |name: &str| target.get(name).map(|index| buffers.numbers::<3>(*index)).transpose();
            add(&mut geometry.positions, added("POSITION")?, *weight);
            if let Some(normals) = &mut geometry.normals {
                add(normals, added("NORMAL")?, *weight);
            }
        }
        if !part.joints.is_empty() {
            let of = |name: &str| attribute(name).ok_or_else(|| SceneError::Missing(format!("its skin needs {name}")));
            let (joints, weights) = (of("JOINTS_0")?, of("WEIGHTS_0")?);
            geometry.bend(part.joints, &buffers.numbers::<4>(joints)?, &buffers.numbers::<4>(weights)?);
        }
        Ok(geometry)
    }

    /// Moves each vertex by the weighted mean of its joints' matrices.
    fn bend(&mut self, matrices: &[DMat4], joints: &[[f32; 4]], weights: &[[f32; 4]]) {
        for (vertex, (joints, weights)) in joints.iter().zip(weights).enumerate().take(self.positions.len()) {
            let part = |(joint, weight): (&f32, &f32)| Some(*matrices.get(*joint as usize)? * f64::from(*weight));
            // Further sets of joints are not read, so the weights of this set need not add up to one.
            let sum = f64::from(weights.iter().sum::<f32>());
            let matrix = joints.iter().zip(weights).filter_map(part).fold(DMat4::ZERO, |sum, part| sum + part)
                * (1.0 / if sum > 0.0 { sum } else { 1.0 });
            let moved = |vector: [f32; 3], matrix: &DMat4| {
                matrix.transform_vector3(DVec3::from(vector.map(f64::from))).as_vec3().to_array()
            };
            let from = moved(self.positions[vertex], &matrix);
            self.positions[vertex] = (Vec3::from(from) + matrix.w_axis.truncate().as_vec3()).to_array();
            if let Some(normals) = &mut self.normals {
                normals[vertex] = moved(normals[vertex], &matrix.inverse().transpose());
            }
            if let Some(tangents) = &mut self.tangents {
                let [x, y, z, side] = tangents[vertex];
                let [x, y, z] = moved([x, y, z], &matrix);
                tangents[vertex] = [x, y, z, side];
            }
        }
    }

    /// The number of triangles.
    pub(super) fn len(&self) -> usize {
        self.triangles.len()
    }

    /// Values at the corners of a triangle.
    fn corners<const N: usize, V: From<[f64; N]>>(&self, triangle: usize, values: &[[f32; N]]) -> [V; 3] {
        self.triangles[triangle].map(|corner| V::from(values[corner as usize].map(f64::from)))
    }

    /// The corners of a triangle in the world.
    pub(super) fn triangle(&self, triangle: usize, world: &DMat4) -> [DVec3; 3] {
        self.corners::<3, DVec3>(triangle, &self.positions).map(|corner| world.transform_point3(corner))
    }

    /// The edges of a triangle from its first corner, in the world.
    fn edges(&self, triangle: usize, world: &DMat4) -> [DVec3; 2] {
        let [a, b, c] = self.corners::<3, DVec3>(triangle, &self.positions);
        [b - a, c - a].map(|edge| world.transform_vector3(edge))
    }

    /// The area of a triangle in the world; 0 if it is not finite.
    pub(super) fn area(&self, triangle: usize, world: &DMat4) -> f64 {
        let [ab, ac] = self.edges(triangle, world);
        let area = 0.5 * ab.cross(ac).length();
        if area.is_finite() { area } else { 0.0 }
    }

    /// Texture coordinates at a point of a triangle.
    pub(super) fn uv(&self, triangle: usize, weights: [f64; 3], set: u32) -> [f64; 2] {
        let Some(uv) = self.uv.get(&set) else { return [0.0; 2] };
        let corners = self.corners::<2, DVec2>(triangle, uv);
        corners.into_iter().zip(weights).map(|(uv, weight)| weight * uv).sum::<DVec2>().to_array()
    }

    /// The position and the frame at a point of a triangle, in the world: tangent, bitangent and normal.
    pub(super) fn point(&self, triangle: usize, weights: [f64; 3], world: &DMat4) -> (DVec3, [DVec3; 3]) {
        let mean = |values: [DVec3; 3]| values.into_iter().zip(weights).map(|(x, weight)| weight * x).sum::<DVec3>();
        let position = world.transform_point3(mean(self.corners(triangle, &self.positions)));
        let [ab, ac] = self.edges(triangle, world);
        let normal = self.normals.as_ref().map(|normals| {
            let normal = mean(self.corners(triangle, normals));
            world.inverse().transpose().transform_vector3(normal).normalize_or_zero()
        });
        let normal = normal.filter(|normal| *normal != DVec3::ZERO && normal.is_finite());
        let normal = normal.unwrap_or_else(|| ab.cross(ac).normalize_or_zero());
        let (tangent, side) = match &self.tangents {
            Some(tangents) => {
                let corners = self.corners::<4, DVec4>(triangle, tangents);
                let tangent = world.transform_vector3(mean(corners.map(DVec4::truncate)));
                (tangent, if corners[0].w < 0.0 { -1.0 } else { 1.0 })
            }
            None => (self.along_u(triangle, [ab, ac]), 1.0),
        };
        let tangent = (tangent - tangent.dot(normal) * normal).normalize_or(normal.any_orthonormal_vector());
        (position, [tangent, side * normal.cross(tangent), normal])
    }

    /// The direction in which the first texture coordinate grows.
    fn along_u(&self, triangle: usize, [ab, ac]: [DVec3; 2]) -> DVec3 {
        let Some(uv) = self.uv.values().next() else { return ab };
        let [a, b, c] = self.corners::<2, DVec2>(triangle, uv);
        let (first, second) = (b - a, c - a);
        let area = first.perp_dot(second);
        let along = (second.y * ab - first.y * ac) * area.signum();
        if area != 0.0 && along.is_finite() { along } else { ab }
    }
}

/// The surface area of the bounding box of an accessor of positions, in the world; 1 if the box is missing or empty.
pub(super) fn box_area(positions: &Accessor, world: &DMat4) -> f64 {
    let corner = |numbers: &Option<Vec<f64>>| Some(DVec3::from(*numbers.as_ref()?.first_chunk::<3>()?));
    let Some((min, max)) = corner(&positions.min).zip(corner(&positions.max)) else { return 1.0 };
    let [x, y, z] = DVec3::AXES.map(|axis| world.transform_vector3(axis * (max - min)));
    let area = 2.0 * (x.cross(y).length() + y.cross(z).length() + z.cross(x).length());
    if area.is_finite() && area > 0.0 { area } else { 1.0 }
}
