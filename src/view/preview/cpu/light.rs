//! Twin of `ltc_light.wgsl`. The edges are in [`Clip`], and the other shapes in [`CosineSpace`].

use glam::{Mat3, Vec3};

use crate::preview::frame::{FrameLight, FrameShape};
use ltcforge_fit::{Clip, Sides};
use ltcforge_light::CosineSpace;

pub(super) struct Inverse {
    pub(super) m: Mat3,
    side: f32,
}

impl Inverse {
    pub(super) fn of(m: Mat3) -> Self {
        let x = m.y_axis.cross(m.z_axis);
        let y = m.z_axis.cross(m.x_axis);
        let z = m.x_axis.cross(m.y_axis);
        let most = x.abs().max(y.abs()).max(z.abs());
        let largest = most.x.max(most.y).max(most.z);
        let determinant = m.z_axis.dot(z);
        if !(largest > 1e-30 && largest < 1e30) || determinant == 0.0 {
            return Self { m: Mat3::ZERO, side: 0.0 };
        }
        let side = determinant.signum();
        let scale = side / largest;
        Self { m: Mat3::from_cols(x * scale, y * scale, z * scale).transpose(), side }
    }

    /// The inverse with these rows and a positive determinant.
    pub(super) fn of_rows(rows: [[f32; 3]; 3]) -> Self {
        Self { m: Mat3::from_cols_array_2d(&rows).transpose(), side: 1.0 }
    }

    /// The part of the distribution that the light covers, as seen from `position`. `to_local` transforms into the
    /// tangent frame at `position`.
    pub(super) fn covered(&self, light: &FrameLight, position: Vec3, to_local: Mat3) -> f32 {
        if !matches!(light.shape, FrameShape::Polygon) {
            return self.cosine_space(to_local).map_or(0.0, |space| shape_covered(&space, light, position));
        }
        let to_cosine = self.m * to_local;
        let vertex = |v: &Vec3| (to_cosine * (*v - position)).to_array();
        let Some(last) = light.vertices.last() else { return 0.0 };
        let mut clip = Clip::begin(vertex(last));
        for v in &light.vertices {
            clip.edge_to(vertex(v));
        }
        let covered = clip.finish() * self.side;
        (if light.two_sided { covered.abs() } else { covered }).clamp(0.0, 1.0)
    }

    /// [`Self::covered`], but only for the part of the distribution above the surface. Twin of `ltc_cut.wgsl` and
    /// `ltc_cut_shapes.wgsl`.
    pub(super) fn covered_above(&self, light: &FrameLight, position: Vec3, to_local: Mat3) -> f32 {
        let Some(space) = self.cosine_space(Mat3::IDENTITY) else { return 0.0 };
        let above = space.above_surface();
        let around = |v: Vec3| to_local * (v - position);
        let sides = if light.two_sided { Sides::Two } else { Sides::One };
        match light.shape {
            FrameShape::Polygon => {
                let vertices: Vec<Vec3> = light.vertices.iter().map(|v| around(*v)).collect();
                above.polygon(&vertices, sides)
            }
            FrameShape::Ellipse(ellipse) => {
                let half_axes = ellipse.half_axes.map(|(axis, _)| to_local * axis);
                above.ellipse(around(ellipse.centre), half_axes, sides)
            }
            FrameShape::Tube { ends, radius } => above.tube(ends.map(around), radius),
            FrameShape::Line { ends, width } => above.line(ends.map(around), width),
        }
    }

    /// The transform from the space of the scene into the space of the clamped cosine. `to_local` transforms from the
    /// space of the scene into the tangent frame. `None` if nothing is lit. Twin of `ltc_shapes.wgsl`.
    pub(super) fn cosine_space(&self, to_local: Mat3) -> Option<CosineSpace<f32>> {
        let to_cosine = self.m * to_local;
        (self.side != 0.0).then(|| CosineSpace::new(to_cosine.transpose().to_cols_array_2d()))
    }

    /// The distribution's density at `wi`.
    pub(super) fn density(&self, wi: Vec3) -> f32 {
        let c = self.m * wi;
        let length2 = c.dot(c);
        c.z.max(0.0) * self.m.determinant().abs() / (std::f32::consts::PI * (length2 * length2).max(1e-36))
    }
}

/// The part of the lobe that an ellipse, a sphere, a tube or a line covers.
fn shape_covered(space: &CosineSpace<f32>, light: &FrameLight, position: Vec3) -> f32 {
    let around = |v: Vec3| v - position;
    match light.shape {
        FrameShape::Polygon => 0.0,
        FrameShape::Ellipse(ellipse) => {
            let sides = if light.two_sided { Sides::Two } else { Sides::One };
            space.ellipse(around(ellipse.centre), ellipse.half_axes.map(|(axis, _)| axis), sides)
        }
        FrameShape::Tube { ends, radius } => space.tube(ends.map(around), radius),
        FrameShape::Line { ends, width } => space.line(ends.map(around), width),
    }
}
