//! Cameras: the points that they see, and the directions to them.

use glam::{DMat4, DVec3};

use super::document::Camera;

/// The default aspect ratio.
const ASPECT: f64 = 16.0 / 9.0;

/// A camera in the world.
#[derive(Debug, Clone)]
pub(super) struct Placed {
    eye: DVec3,
    to_camera: DMat4,
    /// Half the width and half the height of the picture: at distance one if the camera has perspective.
    half: [f64; 2],
    depth: [f64; 2],
    is_perspective: bool,
    ahead: DVec3,
}

impl Placed {
    /// A camera at its node, without the scale of parent nodes [glTF 2.0, section 3.10.2]; `None` if it sees nothing.
    pub(super) fn new(camera: &Camera, world: DMat4) -> Option<Self> {
        let axes =
            [world.x_axis, world.y_axis, world.z_axis].map(|axis| axis.truncate().normalize_or_zero().extend(0.0));
        let to_camera = DMat4::from_cols(axes[0], axes[1], axes[2], world.w_axis).inverse();
        let (half, depth) = match (&camera.perspective, &camera.orthographic) {
            (Some(camera), _) => {
                let (sin, cos) = ltcforge_fit::math::sin_cos(0.5 * camera.yfov);
                let height = sin / cos;
                let width = height * camera.aspect_ratio.unwrap_or(ASPECT);
                ([width, height], [camera.znear, camera.zfar.unwrap_or(f64::INFINITY)])
            }
            (None, Some(camera)) => ([camera.xmag.abs(), camera.ymag.abs()], [camera.znear, camera.zfar]),
            (None, None) => return None,
        };
        let placed = Self {
            eye: world.w_axis.truncate(),
            to_camera,
            half,
            depth,
            is_perspective: camera.perspective.is_some(),
            ahead: -world.z_axis.truncate().normalize_or_zero(),
        };
        let is_finite = to_camera.is_finite() && half.iter().all(|x| x.is_finite() && *x > 0.0);
        (is_finite && placed.ahead != DVec3::ZERO).then_some(placed)
    }

    /// The direction from a point to the camera, if the point is in the picture.
    pub(super) fn view(&self, point: DVec3) -> Option<DVec3> {
        let at = self.to_camera.transform_point3(point);
        let depth = -at.z;
        if !(self.depth[0]..=self.depth[1]).contains(&depth) {
            return None;
        }
        let scale = if self.is_perspective { depth } else { 1.0 };
        let is_inside = at.x.abs() <= self.half[0] * scale && at.y.abs() <= self.half[1] * scale;
        is_inside.then(|| if self.is_perspective { (self.eye - point).normalize_or_zero() } else { -self.ahead })
    }
}
