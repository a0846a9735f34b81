//! Checked lights other than polygons, and lights of any shape.

use glam::DVec3;

use super::{LightError, PolygonLight, TubeEnds, ellipse, line, tube};
use ltcforge_fit::{Sides, named_list};

named_list! {
    /// The shapes of lights.
    pub enum LightShape {
        /// A convex polygon.
        Polygon = "polygon",
        /// A disk or an ellipse.
        Disk = "disk",
        /// A sphere.
        Sphere = "sphere",
        /// A tube with round ends.
        Tube = "tube",
        /// A line of a small width.
        Line = "line",
    }
}

/// The parameters of a light, in the order in which they are given.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ShapeParameter {
    /// The number of lit sides: 1 or 2.
    Sides,
    /// A point or a vector, with the names of its coordinates.
    Point([&'static str; 3]),
    /// A positive length, with its name.
    Length(&'static str),
    /// The vertices of a convex polygon, the last parameter: `x0`, `y0`, `z0`, `x1` ...
    Vertices,
}

impl LightShape {
    /// The parameters of a light with this shape.
    #[must_use]
    pub fn parameters(self) -> &'static [ShapeParameter] {
        use ShapeParameter::{Length, Point, Sides, Vertices};
        const ENDS: [ShapeParameter; 2] = [Point(["ax", "ay", "az"]), Point(["bx", "by", "bz"])];
        match self {
            Self::Polygon => &[Sides, Vertices],
            Self::Disk => &[Sides, Point(["cx", "cy", "cz"]), Point(["ux", "uy", "uz"]), Point(["vx", "vy", "vz"])],
            Self::Sphere => &[Point(["x", "y", "z"]), Length("radius")],
            Self::Tube => &[ENDS[0], ENDS[1], Length("radius")],
            Self::Line => &[ENDS[0], ENDS[1], Length("width")],
        }
    }

    /// The light with these parameters. Parameters that the shape does not have are ignored. Domain: the number of
    /// points of the shape.
    ///
    /// # Errors
    /// The errors of [`PolygonLight::new`] and of the constructors of [`ShapedLight`].
    pub fn light(self, sides: Sides, points: &[DVec3], length: f64) -> Result<AnyLight, LightError> {
        let shaped = match self {
            Self::Polygon => return PolygonLight::new(points.to_vec(), sides).map(AnyLight::Polygon),
            Self::Disk => ShapedLight::ellipse(points[0], [points[1], points[2]], sides),
            Self::Sphere => ShapedLight::sphere(points[0], length),
            Self::Tube => ShapedLight::tube([points[0], points[1]], length),
            Self::Line => ShapedLight::line([points[0], points[1]], length),
        };
        shaped.map(AnyLight::Shaped)
    }
}

/// The smallest sine of the angle between the half axes of an ellipse. Below it they count as parallel.
const PARALLEL: f64 = 1e-12;

/// A length below this part of the light's largest number counts as zero.
const TOUCHING: f64 = 1e-12;

/// A light of radiance one that is not a polygon, relative to a shaded point in its tangent frame, normal +z. The
/// shaded point is outside of it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ShapedLight(Form);

/// The shape, scaled such that the largest number is one. The visible part of a light depends only on directions.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Form {
    Ellipse { centre: DVec3, half_axes: [DVec3; 2], sides: Sides },
    Sphere { centre: DVec3, radius: f64 },
    Tube { ends: [DVec3; 2], radius: f64 },
    Line { ends: [DVec3; 2], width: f64 },
}

impl ShapedLight {
    /// The ellipse `centre + cos t half_axes[0] + sin t half_axes[1]`, for any two half axes. It is a disk if they have
    /// equal lengths and are perpendicular. Its lit side is the side of `half_axes[0] x half_axes[1]`.
    ///
    /// # Errors
    /// [`LightError::Domain`] for a coordinate that is not finite, [`LightError::Flat`] for half axes that are parallel
    /// or zero, [`LightError::Inside`] for a shaded point in the ellipse.
    pub fn ellipse(centre: DVec3, half_axes: [DVec3; 2], sides: Sides) -> Result<Self, LightError> {
        let [x, y] = half_axes;
        check_points([("the centre", centre), ("the first half axis", x), ("the second half axis", y)])?;
        let [centre, x, y] = scaled([centre, x, y]);
        let normal = x.cross(y);
        if normal.length() <= PARALLEL * x.length() * y.length() {
            return Err(LightError::Flat);
        }
        // The coordinates of the shaded point in units of the half axes, if it is in the plane.
        let across2 = normal.length_squared();
        let (u, v) = (y.cross(centre).dot(normal) / across2, centre.cross(x).dot(normal) / across2);
        if centre.dot(normal).abs() <= TOUCHING * normal.length() && u * u + v * v <= 1.0 + TOUCHING {
            return Err(LightError::Inside);
        }
        Ok(Self(Form::Ellipse { centre, half_axes: [x, y], sides }))
    }

    /// A sphere.
    ///
    /// # Errors
    /// [`LightError::Domain`] for a coordinate that is not finite or a radius that is not above zero,
    /// [`LightError::Inside`] for a shaded point in the sphere or on it.
    pub fn sphere(centre: DVec3, radius: f64) -> Result<Self, LightError> {
        check_points([("the centre", centre)])?;
        check_above_zero("the radius", radius)?;
        let [centre, DVec3 { x: radius, .. }] = scaled([centre, DVec3::X * radius]);
        if centre.length() <= radius {
            return Err(LightError::Inside);
        }
        Ok(Self(Form::Sphere { centre, radius }))
    }

    /// A tube with round ends: all points up to `radius` from the line between `ends`. With equal ends it is a sphere.
    ///
    /// # Errors
    /// The errors of [`Self::sphere`].
    pub fn tube(ends: [DVec3; 2], radius: f64) -> Result<Self, LightError> {
        check_points([("the first end", ends[0]), ("the second end", ends[1])])?;
        check_above_zero("the radius", radius)?;
        let [a, b, DVec3 { x: radius, .. }] = scaled([ends[0], ends[1], DVec3::X * radius]);
        if nearest([a, b]).length() <= radius {
            return Err(LightError::Inside);
        }
        Ok(Self(Form::Tube { ends: [a, b], radius }))
    }

    /// A line with a small width that faces the shaded point everywhere. It is the limit of a thin tube whose diameter
    /// is the width.
    ///
    /// # Errors
    /// [`LightError::Domain`] for a coordinate that is not finite, a width that is not above zero or equal ends,
    /// [`LightError::Inside`] for a shaded point on the line.
    pub fn line(ends: [DVec3; 2], width: f64) -> Result<Self, LightError> {
        check_points([("the first end", ends[0]), ("the second end", ends[1])])?;
        check_above_zero("the width", width)?;
        if ends[0] == ends[1] {
            let allowed = "the two ends must differ";
            return Err(LightError::Domain { what: "the length of the line", value: 0.0, allowed });
        }
        let [a, b, DVec3 { x: width, .. }] = scaled([ends[0], ends[1], DVec3::X * width]);
        if nearest([a, b]).length() <= TOUCHING {
            return Err(LightError::Inside);
        }
        Ok(Self(Form::Line { ends: [a, b], width }))
    }

    /// The shape of the light.
    #[must_use]
    pub fn shape(&self) -> LightShape {
        match self.0 {
            Form::Ellipse { .. } => LightShape::Disk,
            Form::Sphere { .. } => LightShape::Sphere,
            Form::Tube { .. } => LightShape::Tube,
            Form::Line { .. } => LightShape::Line,
        }
    }

    /// The convex polygon that replaces the shape in models that only handle polygons: see [`ellipse`], [`tube`] and
    /// [`line()`].
    ///
    /// # Errors
    /// [`LightError::OnOutline`] and [`LightError::Inside`] for a shaded point on or in the polygon of an ellipse.
    pub fn outline(&self) -> Result<PolygonLight, LightError> {
        match self.0 {
            Form::Ellipse { centre, half_axes, sides } => ellipse(centre, half_axes, sides),
            Form::Sphere { centre, radius } => tube([centre; 2], radius, TubeEnds::Round),
            Form::Tube { ends, radius } => tube(ends, radius, TubeEnds::Round),
            Form::Line { ends, width } => line(ends, width),
        }
    }

    pub(super) fn form(&self) -> &Form {
        &self.0
    }
}

/// A light of any shape.
#[derive(Debug, Clone, PartialEq)]
pub enum AnyLight {
    /// A polygon.
    Polygon(PolygonLight),
    /// Another shape.
    Shaped(ShapedLight),
}

impl<'a> From<&'a AnyLight> for AreaLight<'a> {
    fn from(light: &'a AnyLight) -> Self {
        match light {
            AnyLight::Polygon(light) => light.into(),
            AnyLight::Shaped(light) => light.into(),
        }
    }
}

/// A light of any shape, borrowed.
#[derive(Debug, Clone, Copy)]
pub enum AreaLight<'a> {
    /// A polygon.
    Polygon(&'a PolygonLight),
    /// Another shape.
    Shaped(&'a ShapedLight),
}

impl<'a> From<&'a PolygonLight> for AreaLight<'a> {
    fn from(light: &'a PolygonLight) -> Self {
        Self::Polygon(light)
    }
}

impl<'a> From<&'a ShapedLight> for AreaLight<'a> {
    fn from(light: &'a ShapedLight) -> Self {
        Self::Shaped(light)
    }
}

impl AreaLight<'_> {
    /// The vertices and lit sides of the polygon, or of the polygon that replaces another shape.
    pub(super) fn polygon(&self) -> Result<(Vec<[f64; 3]>, Sides), LightError> {
        let read = |light: &PolygonLight| (light.vertices().iter().map(DVec3::to_array).collect(), light.sides());
        Ok(match self {
            Self::Polygon(light) => read(light),
            Self::Shaped(light) => read(&light.outline()?),
        })
    }
}

/// The point nearest to the origin on the line between two points.
fn nearest([a, b]: [DVec3; 2]) -> DVec3 {
    let along = b - a;
    let axis = along.normalize_or_zero();
    a + axis * (-a).dot(axis).clamp(0.0, along.length())
}

/// Divides vectors by their largest component, because products of lengths near the limits of f64 would overflow.
fn scaled<const N: usize>(vectors: [DVec3; N]) -> [DVec3; N] {
    let largest = vectors.iter().fold(0.0_f64, |largest, v| largest.max(v.abs().max_element()));
    if largest > 0.0 { vectors.map(|v| v / largest) } else { vectors }
}

fn check_points<const N: usize>(points: [(&'static str, DVec3); N]) -> Result<(), LightError> {
    let coordinates = points.into_iter().flat_map(|(what, point)| point.to_array().map(|value| (what, value)));
    match coordinates.into_iter().find(|(_, value)| !value.is_finite()) {
        Some((what, value)) => Err(LightError::Domain { what, value, allowed: "its coordinates must be finite" }),
        None => Ok(()),
    }
}

fn check_above_zero(what: &'static str, value: f64) -> Result<(), LightError> {
    if value.is_finite() && value > 0.0 {
        Ok(())
    } else {
        Err(LightError::Domain { what, value, allowed: "it must be finite and above 0" })
    }
}
