//! Polygon lights.

use std::f64::consts::TAU;

use glam::DVec3;

use super::LightError;
use ltcforge_fit::{Sides, math::atan2};

/// The tolerance of convexity. Three vertices turn the wrong way if their volume with the shaded point is below zero by
/// more than this part of the largest squared distance times the longest edge. Rounding to f32 moves vertices by less.
const STRAIGHT: f64 = 1e-6;

/// The largest distance of a vertex from the plane of the polygon, relative to the largest coordinate.
const FLAT: f64 = 1e-4;

/// The tolerance for an edge through the shaded point, relative to the distance of the farthest vertex.
const TOUCHING: f64 = 1e-12;

/// A convex polygon of radiance one, as seen from a shaded point.
///
/// The vertices run clockwise as seen from its lit side.
#[derive(Debug, Clone, PartialEq)]
pub struct PolygonLight {
    vertices: Vec<DVec3>,
    sides: Sides,
    /// The largest coordinate before scaling.
    unit: f64,
}

impl PolygonLight {
    /// The light with these vertices, relative to the shaded point in its tangent frame, normal +z.
    ///
    /// Vertices can coincide or lie in line; they then have no effect. A polygon is convex if all its triples of
    /// vertices turn the same way as seen from the shaded point.
    ///
    /// # Errors
    /// [`LightError::TooFewVertices`], [`LightError::NotFinite`], [`LightError::OnOutline`], [`LightError::NotConvex`],
    /// and [`LightError::Inside`] for a shaded point in the polygon.
    pub fn new(vertices: Vec<DVec3>, sides: Sides) -> Result<Self, LightError> {
        if vertices.len() < 3 {
            return Err(LightError::TooFewVertices(vertices.len()));
        }
        if let Some(index) = vertices.iter().position(|v| !v.is_finite()) {
            return Err(LightError::NotFinite { index });
        }
        // The vertices are scaled, because products of lengths near the limits of f64 would overflow. Directions do not
        // depend on scale.
        let farthest = vertices.iter().fold(0.0_f64, |far, v| far.max(v.abs().max_element()));
        let vertices: Vec<DVec3> =
            if farthest > 0.0 { vertices.into_iter().map(|v| v / farthest).collect() } else { vertices };
        let ends = |edge: usize| (vertices[edge], vertices[(edge + 1) % vertices.len()]);
        if let Some(edge) = (0..vertices.len()).find(|edge| from_origin(ends(*edge)) < TOUCHING) {
            return Err(LightError::OnOutline { edge });
        }
        if has_inside(&vertices) {
            return Err(LightError::Inside);
        }
        match wrong_turn(&vertices) {
            Some(vertices) => Err(LightError::NotConvex { vertices }),
            None => Ok(Self { vertices, sides, unit: farthest }),
        }
    }

    /// The vertices, scaled such that the largest coordinate is one. The visible part of a light depends only on
    /// directions.
    #[must_use]
    pub fn vertices(&self) -> &[DVec3] {
        &self.vertices
    }

    /// Checks that all vertices lie in one plane. The closed forms do not need this, because they depend only on
    /// directions.
    ///
    /// # Errors
    /// [`LightError::NotPlanar`].
    pub fn check_plane(&self) -> Result<(), LightError> {
        let first = self.vertices[0];
        let edges = || self.vertices.iter().zip(self.vertices.iter().cycle().skip(1));
        let normal: DVec3 = edges().map(|(a, b)| (*a - first).cross(*b - first)).sum();
        let normal = normal.normalize_or_zero();
        let away = |v: &DVec3| (*v - first).dot(normal).abs();
        match (0..self.vertices.len()).find(|index| away(&self.vertices[*index]) > FLAT) {
            Some(index) => Err(LightError::NotPlanar { index, distance: away(&self.vertices[index]) }),
            None => Ok(()),
        }
    }

    /// The distance from the shaded point to the light's plane in a direction of unit length.
    #[must_use]
    pub fn distance(&self, wi: DVec3) -> f64 {
        let first = self.vertices[0];
        let edges = self.vertices.iter().zip(self.vertices.iter().cycle().skip(1));
        let normal: DVec3 = edges.map(|(a, b)| (*a - first).cross(*b - first)).sum();
        self.unit * first.dot(normal) / wi.dot(normal)
    }

    /// The sides from which the light is visible.
    #[must_use]
    pub fn sides(&self) -> Sides {
        self.sides
    }
}

/// The distance of an edge from the origin.
fn from_origin((a, b): (DVec3, DVec3)) -> f64 {
    let along = b - a;
    let length2 = along.length_squared();
    let t = if length2 > 0.0 { (-a.dot(along) / length2).clamp(0.0, 1.0) } else { 0.0 };
    (a + along * t).length()
}

/// True if the origin is in a polygon: in its plane, up to rounding, with the outline around it.
///
/// A polygon seen from within its plane has no side. From a point inside the outline, its solid angle would be zero or
/// a hemisphere, depending on the last digit. From a point outside the outline, it is seen edge-on and covers nothing.
fn has_inside(vertices: &[DVec3]) -> bool {
    let edges = || vertices.iter().zip(vertices.iter().cycle().skip(1));
    let normal: DVec3 = edges().map(|(a, b)| (*a - vertices[0]).cross(*b - vertices[0])).sum();
    let normal = normal.normalize_or_zero();
    let farthest = vertices.iter().map(|v| v.length()).fold(0.0, f64::max);
    if normal == DVec3::ZERO || vertices.iter().any(|v| v.dot(normal).abs() > STRAIGHT * farthest) {
        return false;
    }
    // The outline goes around a whole turn if the origin is inside, half a turn if it is on an edge, and no turn if it
    // is outside.
    let around: f64 = edges().map(|(a, b)| atan2(a.cross(*b).dot(normal), a.dot(*b))).sum();
    around.abs() > 0.75 * TAU
}

/// Three vertices, in order, that turn against the first triple that turns at all.
///
/// An outline is convex and goes around once if and only if all triples turn the same way. This also excludes stars and
/// outlines that go around twice, which look convex edge by edge.
fn wrong_turn(vertices: &[DVec3]) -> Option<[usize; 3]> {
    let count = vertices.len();
    let longest = vertices.iter().map(|v| v.distance(vertices[0])).fold(0.0, f64::max);
    let farthest2 = vertices.iter().map(|v| v.length_squared()).fold(0.0, f64::max);
    let tolerance = STRAIGHT * farthest2 * longest;
    let mut sense = 0.0;
    for i in 0..count {
        for j in i + 1..count {
            for k in j + 1..count {
                let volume = vertices[i].dot((vertices[j] - vertices[i]).cross(vertices[k] - vertices[i]));
                if volume.abs() > tolerance {
                    if sense * volume < 0.0 {
                        return Some([i, j, k]);
                    }
                    sense = volume;
                }
            }
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::{DQuat, EulerRot};

    fn outline(angles: impl Iterator<Item = f64>) -> Vec<DVec3> {
        angles.map(|angle| DVec3::new(angle.cos() + 0.3, angle.sin(), 2.0)).collect()
    }

    fn regular(count: u32, step: u32) -> Vec<DVec3> {
        outline((0..count).map(|i| TAU * f64::from(i * step) / f64::from(count)))
    }

    #[test]
    fn convex_outlines_are_lights_in_both_directions() {
        for count in 3..=9 {
            let mut vertices = regular(count, 1);
            assert!(PolygonLight::new(vertices.clone(), Sides::One).is_ok(), "{count}");
            vertices.reverse();
            assert!(PolygonLight::new(vertices.clone(), Sides::One).is_ok(), "{count}");
            // A far polygon rounded to f32, with a vertex in the middle of an edge and a vertex that occurs twice.
            vertices.insert(1, vertices[0].midpoint(vertices[1]));
            vertices.insert(0, vertices[0]);
            let far: Vec<DVec3> =
                vertices.iter().map(|v| (*v + DVec3::new(30.0, 1.0, 7.0)).as_vec3().as_dvec3()).collect();
            assert!(PolygonLight::new(far, Sides::One).is_ok(), "{count}");
        }
    }

    #[test]
    fn other_outlines_are_not() {
        let star = regular(5, 2);
        let twice = outline((0..8).map(|i| f64::from(i) * TAU / 4.0));
        let mut dented = regular(6, 1);
        dented[3] = DVec3::new(0.4, 0.0, 2.0);
        let mut crossed = regular(4, 1);
        crossed.swap(0, 1);
        for vertices in [star, twice, dented, crossed] {
            let refused = PolygonLight::new(vertices.clone(), Sides::Two);
            assert!(matches!(refused, Err(LightError::NotConvex { .. })), "{vertices:?}: {refused:?}");
        }
        assert_eq!(PolygonLight::new(regular(4, 1)[..2].to_vec(), Sides::One), Err(LightError::TooFewVertices(2)));
        let mut endless = regular(4, 1);
        endless[2].y = f64::INFINITY;
        assert_eq!(PolygonLight::new(endless, Sides::One), Err(LightError::NotFinite { index: 2 }));
    }

    #[test]
    fn an_outline_through_the_shaded_point_is_none() {
        let square = |centre: DVec3| {
            [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)]
                .map(|(x, z)| centre + DVec3::new(x, 0.5 * z, z))
                .to_vec()
        };
        // Tests a vertex at the shaded point, an edge through it, and an edge that passes very close to it.
        let vertex = PolygonLight::new(square(DVec3::new(1.0, 0.5, 1.0)), Sides::Two);
        assert_eq!(vertex, Err(LightError::OnOutline { edge: 0 }));
        let through = PolygonLight::new(square(DVec3::new(-1.0, 0.0, 0.0)), Sides::Two);
        assert_eq!(through, Err(LightError::OnOutline { edge: 1 }));
        assert!(PolygonLight::new(square(DVec3::new(-1.0 - 1e-6, 0.0, 0.0)), Sides::Two).is_ok());
        assert_eq!(PolygonLight::new(vec![DVec3::ZERO; 4], Sides::Two), Err(LightError::OnOutline { edge: 0 }));
    }

    /// Tests polygons with every number of vertices, in any plane, in both orders, with one vertex twice, in f64 and
    /// rounded to f32 and to six digits.
    #[test]
    fn a_shaded_point_within_a_polygon_is_refused_and_one_beside_or_above_is_not() {
        let mut refused = 0;
        for (count, k) in (3..=9_u32).flat_map(|count| (0..8_u32).map(move |k| (count, k))) {
            let turned = DQuat::from_euler(EulerRot::XYZ, f64::from(k), 0.7 * f64::from(k), 0.3);
            let scale = [1e-3, 1.0, 4e4][k as usize % 3];
            let at = |centre: DVec3| -> Vec<DVec3> {
                let corners = regular(count, 1).into_iter().map(|v| v - DVec3::new(0.3, 0.0, 2.0));
                corners.map(|v| turned * (v + centre) * scale).collect()
            };
            let variants = |vertices: Vec<DVec3>| {
                let as_f32 = vertices.iter().map(|v| v.as_vec3().as_dvec3()).collect();
                let digits = |v: &DVec3| DVec3::from(v.to_array().map(|x| (x / scale * 1e6).round() / 1e6));
                let written = vertices.iter().map(digits).collect();
                let reversed = vertices.iter().rev().copied().collect();
                let twice = vertices.iter().chain(vertices.last()).copied().collect();
                [vertices, as_f32, written, reversed, twice]
            };
            // A triangle of this size reaches 0.5 from its centre.
            for within in [DVec3::ZERO, DVec3::new(0.3, 0.1, 0.0), DVec3::new(-0.1, -0.4, 0.0)] {
                for vertices in variants(at(within)) {
                    for sides in [Sides::One, Sides::Two] {
                        let light = PolygonLight::new(vertices.clone(), sides);
                        assert_eq!(light, Err(LightError::Inside), "{count} {k} {within}");
                        refused += 1;
                    }
                }
            }
            for without in [
                DVec3::new(1.2, 0.5, 0.0),
                DVec3::new(0.0, -7.0, 0.0),
                DVec3::new(0.1, 0.2, 1e-4),
                DVec3::new(0.0, 0.0, -0.5),
            ] {
                for vertices in variants(at(without)) {
                    let light = PolygonLight::new(vertices, Sides::Two);
                    assert_ne!(light, Err(LightError::Inside), "{count} {k} {without}");
                }
            }
        }
        assert_eq!(refused, 7 * 8 * 3 * 5 * 2);
        // A tiny light straight above: the shaded point is in front of all its edges.
        let tiny = regular(4, 1).into_iter().map(|v| (v - DVec3::new(0.3, 0.0, 2.0)) * 1e-9 + DVec3::Z).collect();
        assert!(PolygonLight::new(tiny, Sides::Two).is_ok());
    }

    #[test]
    fn the_largest_numbers_are_seen_as_the_smallest() {
        for scale in [1e300, 1e-300] {
            let huge = regular(4, 1).into_iter().map(|v| v * scale).collect();
            let light = PolygonLight::new(huge, Sides::One).expect("convex");
            let unit = PolygonLight::new(regular(4, 1), Sides::One).expect("convex");
            for (a, b) in light.vertices().iter().zip(unit.vertices()) {
                assert!((*a - *b).length() < 1e-15, "{a} {b}");
            }
        }
    }
}
