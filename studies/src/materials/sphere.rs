//! A sphere seen from afar, and where a light is from each of its points.

use glam::DVec3;

use ltcforge::fit::{Configuration, Sides, math::atan2};
use ltcforge_light::{LightError, PolygonLight};

/// The sphere's radius, in sides of a panel.
const RADIUS: f64 = 0.47;
/// Points nearer to the outline than this part of the radius are shaded as if they were there: the outline itself is seen
/// along the surface, and reflects nothing.
const FARTHEST: f64 = 0.995;

/// A rectangle that faces the sphere: its middle, and half its width and height. Lengths are in radii of the sphere, x
/// points right, y up and z to the viewer.
#[derive(Debug, Clone, Copy)]
pub(super) struct Lamp {
    pub(super) centre: DVec3,
    pub(super) half_size: [f64; 2],
}

/// A point of the sphere, seen and lit, in its tangent frame: x along the circle of latitude, z outwards.
pub(super) struct Point {
    /// The direction of the viewer.
    pub(super) wo: DVec3,
    /// Vertices of the lamp.
    pub(super) lamp: [DVec3; 4],
}

/// How much of a pixel the sphere covers, 0 to 1, and the point of it that the pixel shows: that of its middle, or the
/// nearest. `None` where the sphere covers nothing. Panels are `side` pixels wide and high.
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
    /// The view of a surface of these roughnesses.
    pub(super) fn of(&self, [alpha_x, alpha_y]: [f64; 2]) -> Configuration {
        let DVec3 { x, y, z } = self.wo;
        Configuration { alpha_x, alpha_y, theta: atan2((x * x + y * y).sqrt(), z), phi: atan2(y, x) }
    }

    /// The lamp, of radiance one.
    ///
    /// # Errors
    /// Those of [`PolygonLight::new`].
    pub(super) fn light(&self) -> Result<PolygonLight, LightError> {
        PolygonLight::new(self.lamp.to_vec(), Sides::Two)
    }
}
