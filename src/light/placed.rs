//! Lights at a place in a scene.

use glam::DVec3;

use super::{AnyLight, LightShape};
use ltcforge_fit::Sides;

/// A light in the coordinates of a scene.
#[derive(Debug, Clone, PartialEq)]
pub struct PlacedLight {
    /// The shape.
    pub shape: LightShape,
    /// The lit sides.
    pub sides: Sides,
    /// The points and vectors of the shape, see [`LightShape::parameters`].
    pub points: Vec<DVec3>,
    /// The length of the shape, if it has one.
    pub length: f64,
}

impl PlacedLight {
    /// The light as seen from a point, in its frame of tangent, bitangent and normal. `None` for a light that touches
    /// the point or is not convex. Domain: the number of points of the shape.
    #[must_use]
    pub fn seen_from(&self, position: DVec3, frame: [DVec3; 3]) -> Option<AnyLight> {
        // The half axes of a disk are vectors.
        let is_vector = |index: usize| self.shape == LightShape::Disk && index > 0;
        let moved = |(index, point): (usize, &DVec3)| {
            let from = if is_vector(index) { DVec3::ZERO } else { position };
            DVec3::from(frame.map(|axis| (*point - from).dot(axis)))
        };
        let points: Vec<DVec3> = self.points.iter().enumerate().map(moved).collect();
        self.shape.light(self.sides, &points, self.length).ok()
    }
}
