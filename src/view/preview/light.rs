//! A light's outline in the scene.

use std::f64::consts::{FRAC_PI_4, PI, TAU};

use glam::{DMat3, DVec3, Vec3};

use super::{Light, LightKind};

/// A light in the scene.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Outline {
    /// Vertices of the light, or of the polygon that replaces an ellipse for models that only support polygons. The
    /// order is clockwise as seen from the lit side. Spheres, tubes and lines have no vertices.
    pub(super) vertices: Vec<DVec3>,
    /// Unit normal towards the lit side.
    pub(super) normal: DVec3,
    pub(super) area: f64,
    /// Area of the triangles (0, 1, 2) up to (0, i - 1, i), relative to the total area, for each vertex i.
    pub(super) area_up_to: Vec<f64>,
    pub(super) shape: Shape<DVec3, f64>,
}

/// The shape of a light, for vectors and numbers in f64 or f32.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Shape<V, N> {
    Polygon,
    Ellipse(Ellipse<V, N>),
    /// A tube with round ends; a sphere if both ends are equal.
    Tube {
        ends: [V; 2],
        radius: N,
    },
    Line {
        ends: [V; 2],
        width: N,
    },
}

/// The ellipse of a disk.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Ellipse<V, N> {
    pub(super) centre: V,
    /// Two perpendicular half axes. Each has the reciprocal of its squared length.
    pub(super) half_axes: [(V, N); 2],
}

impl Shape<DVec3, f64> {
    /// The ellipse in f32, for uniforms.
    pub(super) fn as_f32(&self) -> Shape<Vec3, f32> {
        match *self {
            Self::Polygon => Shape::Polygon,
            Self::Ellipse(Ellipse { centre, half_axes }) => {
                let half_axes = half_axes.map(|(axis, per_length2)| (axis.as_vec3(), per_length2 as f32));
                Shape::Ellipse(Ellipse { centre: centre.as_vec3(), half_axes })
            }
            Self::Tube { ends, radius } => Shape::Tube { ends: ends.map(DVec3::as_vec3), radius: radius as f32 },
            Self::Line { ends, width } => Shape::Line { ends: ends.map(DVec3::as_vec3), width: width as f32 },
        }
    }
}

impl Light {
    /// The outline of the light, in scene coordinates.
    pub(super) fn outline(&self) -> Outline {
        let centre = DVec3::from(self.centre);
        let frame = facing_origin(centre) * self.turn();
        let [width, height] = self.half_size;
        let vertices: Vec<DVec3> = self
            .kind
            .corners()
            .into_iter()
            .map(|(x, y)| centre + frame * DVec3::new(x * width, y * height, 0.0))
            .collect();
        let triangle = |i: usize| {
            let (first, second) = (vertices[i - 1] - vertices[0], vertices[i] - vertices[0]);
            0.5 * first.cross(second).length()
        };
        let area: f64 = (2..vertices.len()).map(triangle).sum();
        let mut sum = 0.0;
        let area_up_to = (0..vertices.len())
            .map(|i| {
                sum += if i < 2 { 0.0 } else { triangle(i) / area };
                sum
            })
            .collect();
        let half_axes = [frame.x_axis * width, frame.y_axis * height];
        let ends = [centre - half_axes[0], centre + half_axes[0]];
        let shape = match self.kind {
            LightKind::Rectangle | LightKind::Polygon(_) => Shape::Polygon,
            LightKind::Disk => {
                Shape::Ellipse(Ellipse { centre, half_axes: half_axes.map(|axis| (axis, 1.0 / axis.length_squared())) })
            }
            LightKind::Sphere => Shape::Tube { ends: [centre; 2], radius: width },
            LightKind::Tube => Shape::Tube { ends, radius: height },
            LightKind::Line => Shape::Line { ends, width: 2.0 * height },
        };
        Outline { normal: frame.z_axis, area, area_up_to, vertices, shape }
    }

    fn turn(&self) -> DMat3 {
        let [yaw, pitch, roll] = self.rotation;
        DMat3::from_rotation_y(yaw) * DMat3::from_rotation_x(pitch) * DMat3::from_rotation_z(roll)
    }
}

/// The rotation that turns +z from `centre` towards the origin, and +y as far upwards as possible.
fn facing_origin(centre: DVec3) -> DMat3 {
    let z = (-centre).try_normalize().unwrap_or(DVec3::Z);
    let x = DVec3::Y.cross(z).try_normalize().unwrap_or(DVec3::X);
    DMat3::from_cols(x, z.cross(x), z)
}

impl LightKind {
    /// Vertices within the square from -1 to 1, clockwise.
    fn corners(self) -> Vec<(f64, f64)> {
        let regular = |sides: u32, radius: f64, first: f64| -> Vec<(f64, f64)> {
            let angle = |i: u32| first - TAU * f64::from(i) / f64::from(sides);
            (0..sides).map(|i| (radius * angle(i).cos(), radius * angle(i).sin())).collect()
        };
        match self {
            Self::Rectangle => vec![(-1.0, 1.0), (1.0, 1.0), (1.0, -1.0), (-1.0, -1.0)],
            // The octagon has the area of the circle: n / 2 sin(2 pi / n) R^2 = pi.
            Self::Disk => regular(8, (PI / (4.0 * FRAC_PI_4.sin())).sqrt(), 0.5 * FRAC_PI_4),
            Self::Polygon(sides) => regular(sides, 1.0, 0.5 * PI),
            Self::Sphere | Self::Tube | Self::Line => Vec::new(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ltcforge_fit::{Ltc, Sides};

    const KINDS: [LightKind; 4] = [LightKind::Rectangle, LightKind::Disk, LightKind::Polygon(3), LightKind::Polygon(7)];

    #[test]
    fn areas_are_those_of_the_shapes() {
        for (kind, area) in KINDS.into_iter().zip([24.0, 6.0 * PI, 6.0 * 0.75 * 3.0_f64.sqrt(), 0.0]) {
            let light = Light { kind, half_size: [2.0, 3.0], rotation: [0.1, 0.2, 0.3], ..Light::default() };
            let outline = light.outline();
            assert!(area == 0.0 || (outline.area - area).abs() < 1e-12, "{kind:?}: {}", outline.area);
            assert!((outline.area_up_to[outline.vertices.len() - 1] - 1.0).abs() < 1e-12);
        }
    }

    #[test]
    fn the_lit_side_faces_the_origin_and_agrees_with_the_integral() {
        for kind in KINDS {
            let light = Light { kind, centre: [0.3, 0.2, 2.0], ..Light::default() };
            let outline = light.outline();
            assert!(outline.normal.dot(outline.vertices[0]) < 0.0);
            let cosine = Ltc::new(DMat3::IDENTITY).expect("regular");
            assert!(cosine.polygon(&outline.vertices, Sides::One) > 0.03, "{kind:?}");
        }
    }

    #[test]
    fn a_light_straight_above_has_a_frame() {
        let outline = Light { centre: [0.0, 3.0, 0.0], ..Light::default() }.outline();
        assert!((outline.normal - -DVec3::Y).length() < 1e-12);
        assert!(outline.vertices.iter().all(|v| v.is_finite()));
    }
}
