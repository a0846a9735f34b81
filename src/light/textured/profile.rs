//! Photometric lights: rectangles whose radiance depends only on direction, such as a lamp with an IES profile.
//!
//! A point p of the light's plane emits towards the shaded point in the direction `(f - p, h)`, with the foot f of the
//! perpendicular and the distance h. As a function of the tangents `g = (f - p) / h`, a profile is a picture, and the
//! light shows a window of it. The picture is prefiltered once, and a lobe's readings of the light are readings of the
//! picture.

use super::{Reading, TexturedLight};

/// The largest tangent of the angle to a lamp's axis in the picture of a profile, along both sides: 76 degrees.
pub const PROFILE_TANGENT: f64 = 4.0;

/// The variance of a square's points along a side, divided by its area. It limits kernels to the width of the light.
const OF_AREA: f64 = 1.0 / 12.0;
/// The smallest distance from the light's plane, relative to the sum of the sides' lengths.
const LEAST_HEIGHT: f64 = 1e-6;

/// The part of a lamp's profile that the readings of a light use.
#[derive(Debug, Clone, Copy)]
pub struct ProfileWindow {
    foot: [f64; 2],
    size: [f64; 2],
    height: f64,
}

impl ProfileWindow {
    /// The window of the profile for a light and a shaded point.
    #[must_use]
    pub fn new(light: &TexturedLight) -> Self {
        let corners = light.polygon().vertices();
        let size = light.size();
        let axes = [(corners[1] - corners[0]) / size[0], (corners[3] - corners[0]) / size[1]];
        let foot = axes.map(|axis| -corners[0].dot(axis));
        let height = axes[0].cross(axes[1]).dot(corners[0]).abs().max(LEAST_HEIGHT * (size[0] + size[1]));
        Self { foot, size, height }
    }

    /// The tangents of the direction from a point of the light to the shaded point. The point is in parts of the
    /// light's sides.
    #[must_use]
    pub fn tangents(&self, uv: [f64; 2]) -> [f64; 2] {
        [0, 1].map(|i| (self.foot[i] - uv[i] * self.size[i]) / self.height)
    }

    /// Converts a reading of a picture on the light to a reading of the profile's picture, whose tangents begin at
    /// `-PROFILE_TANGENT`.
    #[must_use]
    pub fn of_profile(&self, reading: &Reading<f64>) -> Reading<f64> {
        let span = 2.0 * PROFILE_TANGENT;
        let uv = self.tangents(reading.uv).map(|g| (0.5 + g / span).clamp(0.0, 1.0));
        let narrower = 1.0 / (1.0 / reading.radius.powi(2) + 1.0 / OF_AREA);
        let area = self.size[0] * self.size[1];
        Reading { uv, radius: (narrower * area).sqrt() / (self.height * span), weight: reading.weight }
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;
    use ltcforge_fit::Sides;

    use super::*;
    use crate::PolygonLight;

    #[test]
    fn directions_come_from_the_place_on_the_light() {
        let vertices = [[-1.0, 1.0], [1.0, 1.0], [1.0, -1.0], [-1.0, -1.0]].map(|[x, y]| DVec3::new(x, y, 2.0));
        let light = PolygonLight::new(vertices.to_vec(), Sides::Two).and_then(TexturedLight::new).expect("a rectangle");
        let window = ProfileWindow::new(&light);
        for (uv, wanted) in [([0.5, 0.5], [0.0, 0.0]), ([0.0, 0.5], [0.5, 0.0]), ([0.5, 1.0], [0.0, -0.5])] {
            assert_eq!(window.tangents(uv), wanted);
        }
        // A kernel far wider than the light gets the width of the light. A narrow kernel keeps its width.
        let read = |radius| window.of_profile(&Reading { uv: [0.25, 0.5], radius, weight: 2.0 });
        let of_one = 2.0 / (2.0 * 2.0 * PROFILE_TANGENT);
        assert!((read(1e3).radius / (OF_AREA.sqrt() * of_one) - 1.0).abs() < 1e-3);
        assert!((read(1e-3).radius / (1e-3 * of_one) - 1.0).abs() < 1e-3);
        assert_eq!((read(1.0).uv, read(1.0).weight), ([0.5 + 0.125 / PROFILE_TANGENT, 0.5], 2.0));
    }
}
