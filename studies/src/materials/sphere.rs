//! A sphere seen from far away, and the position of a lamp relative to each of its points.

use glam::DVec3;

use ltcforge::fit::{Configuration, Sides, math::atan2};
use ltcforge_light::{LightError, PolygonLight};

/// The sphere's radius, relative to the side of a panel.
const RADIUS: f64 = 0.47;
/// Points farther out than this part of the radius are shaded as if they were at this distance. At the outline itself
/// the view is along the surface, and the surface reflects nothing.
const FARTHEST: f64 = 0.995;

/// A rectangle that faces the sphere: its centre, and half its width and height. Lengths are in radii of the sphere. x
/// points to the right, y upwards, and z to the viewer.
#[derive(Debug, Clone, Copy)]
pub(super) struct Lamp {
    pub(super) centre: DVec3,
    pub(super) half_size: [f64; 2],
}

/// A visible point of the sphere in its tangent frame: x along the circle of latitude, z outwards.
pub(super) struct Point {
    /// The direction to the viewer.
    pub(super) wo: DVec3,
    /// Vertices of the lamp.
    pub(super) lamp: [DVec3; 4],
}

/// The part of a pixel that the sphere covers, 0 to 1, and the point that the pixel shows: the point at the pixel's
/// middle, or the nearest one. `None` if the sphere does not cover the pixel. Panels have `side` x `side` pixels.
pub(super) fn seen(side: u32, [column, row]: [u32; 2], lamp: &Lamp) -> Option<(f64, Point)> {
    let at = |k: u32| (f64::from(k) + 0.5 - 0.5 * f64::from(side)) / (RADIUS * f64::from(side));
    let (x, y) = (at(column), -at(row));
    let away = (x * x + y * y).sqrt();
    let coverage = ((1.0 - away) * RADIUS * f64::from(side) + 0.5).clamp(0.0, 1.0);
    if coverage == 0.0 {
        return None;
    }
    let inwards = (FARTHEST / away.max(FARTHEST)).min(1.0);
    let (x, y) = (x * inwards, y * inwards);
    let normal = DVec3::new(x, y, (1.0 - x * x - y * y).sqrt());
    let along = DVec3::Y.cross(normal).normalize();
    let frame = [along, normal.cross(along), normal];
    let local = |v: DVec3| DVec3::new(frame[0].dot(v), frame[1].dot(v), frame[2].dot(v));
    Some((coverage, Point { wo: local(DVec3::Z), lamp: lamp.vertices().map(|vertex| local(vertex - normal)) }))
}

impl Lamp {
    fn vertices(&self) -> [DVec3; 4] {
        let right = DVec3::Y.cross(self.centre).normalize();
        let up = self.centre.cross(right).normalize();
        let [width, height] = self.half_size;
        [[-1.0, -1.0], [-1.0, 1.0], [1.0, 1.0], [1.0, -1.0]]
            .map(|[x, y]| self.centre + x * width * right + y * height * up)
    }
}

impl Point {
    /// The view direction, for a surface with these roughnesses.
    pub(super) fn of(&self, [alpha_x, alpha_y]: [f64; 2]) -> Configuration {
        let DVec3 { x, y, z } = self.wo;
        Configuration { alpha_x, alpha_y, theta: atan2((x * x + y * y).sqrt(), z), phi: atan2(y, x) }
    }

    /// The lamp, with radiance one.
    ///
    /// # Errors
    /// The errors of [`PolygonLight::new`].
    pub(super) fn light(&self) -> Result<PolygonLight, LightError> {
        PolygonLight::new(self.lamp.to_vec(), Sides::Two)
    }
}
