//! Light cases: CSV lines of a surface, a view direction and a light.

use std::f64::consts::FRAC_PI_2;

use glam::DVec3;

use ltcforge_fit::{Configuration, MAX_VERTICES, Sides};
use ltcforge_light::{AnisotropicRoughness, AnyLight, LightShape, PlacedLight, ShapeParameter};

/// The names of the columns before the light. Lines without their own material lack the first two.
const COLUMNS: [&str; 4] = ["alpha_x", "alpha_y", "theta", "phi"];
const ROUGHNESS_COLUMNS: usize = 2;
const MIN_VERTICES: usize = 3;

/// The surface, the view direction and the light of a line.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct LightCase {
    pub(super) at: Configuration,
    pub(super) light: AnyLight,
}

/// The format of all lines: the shape of the lights, and the material if all surfaces share it.
#[derive(Debug, Clone, Copy)]
pub(super) struct CaseFormat {
    pub(super) shape: LightShape,
    /// The material of all surfaces. With a material, view and light are in the frame of the surface's tangent.
    pub(super) material: Option<AnisotropicRoughness>,
}

fn has_vertices(shape: LightShape) -> bool {
    shape.parameters().contains(&ShapeParameter::Vertices)
}

impl CaseFormat {
    /// The names of the columns before the light.
    fn surface_columns(&self) -> &'static [&'static str] {
        if self.material.is_some() { &COLUMNS[ROUGHNESS_COLUMNS..] } else { &COLUMNS }
    }

    /// The names of all columns except those of a polygon's vertices.
    fn own_columns(&self) -> Vec<&'static str> {
        let names = |parameter: &'static ShapeParameter| match parameter {
            ShapeParameter::Sides => &["sides"][..],
            ShapeParameter::Point(names) => names,
            ShapeParameter::Length(name) => std::slice::from_ref(name),
            ShapeParameter::Vertices => &[],
        };
        self.surface_columns().iter().chain(self.shape.parameters().iter().flat_map(names)).copied().collect()
    }

    /// The column names of a line with this many fields. Columns of vertices are `x0`, `y0`, `z0`, `x1` ...
    fn columns(&self, fields: usize) -> Vec<String> {
        let own = self.own_columns();
        let vertices = if has_vertices(self.shape) { fields.saturating_sub(own.len()) } else { 0 };
        let coordinate = |i: usize| format!("{}{}", ["x", "y", "z"][i % 3], i / 3);
        own.into_iter().map(str::to_owned).chain((0..vertices).map(coordinate)).collect()
    }

    /// The expected columns, for error messages.
    fn expected(&self) -> String {
        let names = self.own_columns().join(",");
        if has_vertices(self.shape) {
            return format!("{names} and then x,y,z of {MIN_VERTICES} to {MAX_VERTICES} vertices");
        }
        names
    }

    /// Reads a line; `None` for an empty line.
    ///
    /// # Errors
    /// Every invalid field with its allowed values. If all fields are valid, the reason why the light is invalid.
    pub(super) fn parse(&self, line: &str) -> Result<Option<LightCase>, String> {
        let case = |(at, PlacedLight { shape, sides, points, length })| {
            let light = shape.light(sides, &points, length).map_err(|error| error.to_string())?;
            Ok(LightCase { at, light })
        };
        self.placed(line)?.map(case).transpose()
    }

    /// Reads a line; the light may be anywhere. `None` for an empty line.
    ///
    /// # Errors
    /// Every invalid field with its allowed values.
    pub(super) fn placed(&self, line: &str) -> Result<Option<(Configuration, PlacedLight)>, String> {
        if line.trim().is_empty() {
            return Ok(None);
        }
        let shape = self.shape;
        let fields: Vec<&str> = line.split(',').map(str::trim).collect();
        let more = fields.len().checked_sub(self.own_columns().len());
        let are_vertices = |more: usize| more.is_multiple_of(3) && (MIN_VERTICES..=MAX_VERTICES).contains(&(more / 3));
        let is_whole = more.is_some_and(|more| if has_vertices(shape) { are_vertices(more) } else { more == 0 });
        if !is_whole {
            let kind = if has_vertices(shape) { "light" } else { shape.name() };
            return Err(format!("{} fields; a {kind} has {}", fields.len(), self.expected()));
        }
        let mut fields = Fields { format: self, texts: fields, faults: Vec::new() };
        let at = fields.surface_and_view();
        let light = fields.light();
        if fields.faults.is_empty() { Ok(Some((at, light))) } else { Err(fields.faults.join("; ")) }
    }

    /// Whether a line is the header. The header of polygons may name any number of vertices.
    pub(super) fn is_header(&self, line: &str) -> bool {
        let fields: Vec<&str> = line.split(',').map(str::trim).collect();
        let min = self.own_columns().len() + usize::from(has_vertices(self.shape));
        fields.len() >= min && self.columns(fields.len()) == fields
    }
}

/// The fields of a line, and their errors.
struct Fields<'a> {
    format: &'a CaseFormat,
    texts: Vec<&'a str>,
    faults: Vec<String>,
}

impl Fields<'_> {
    fn refuse(&mut self, index: usize, allowed: &str) {
        let name = &self.format.columns(self.texts.len())[index];
        self.faults.push(format!("{name} is «{}»; {allowed}", self.texts[index]));
    }

    /// Parses a field as a number. If it is invalid, adds an error and returns NaN.
    fn number(&mut self, index: usize, is_allowed: impl Fn(f64) -> bool, allowed: &str) -> f64 {
        match self.texts[index].parse::<f64>() {
            Ok(value) if value.is_finite() && is_allowed(value) => value,
            _ => {
                self.refuse(index, allowed);
                f64::NAN
            }
        }
    }

    fn roughness(&mut self, index: usize) -> f64 {
        self.number(index, |x| x > 0.0 && x <= 1.0, "roughness must be above 0 and at most 1")
    }

    fn surface_and_view(&mut self) -> Configuration {
        let roughness = match self.format.material {
            Some(material) => material,
            None => AnisotropicRoughness { alpha_x: self.roughness(0), alpha_y: self.roughness(1), rotation: 0.0 },
        };
        let first = self.format.surface_columns().len() - 2;
        let is_above = |x| (0.0..FRAC_PI_2).contains(&x);
        let theta = self.number(first, is_above, "a polar angle must be at least 0 and below pi/2, in radians");
        let phi = self.number(first + 1, |_| true, "an azimuth must be a finite number, in radians");
        roughness.seen_from(theta, phi)
    }

    fn sides(&mut self, index: usize) -> Sides {
        match self.texts[index] {
            "1" => return Sides::One,
            "2" => {}
            _ => self.refuse(index, "a light has 1 or 2 lit sides"),
        }
        Sides::Two
    }

    fn point(&mut self, first: usize) -> DVec3 {
        let [x, y, z] = [0, 1, 2].map(|i| self.number(first + i, |_| true, "a coordinate must be a finite number"));
        let point = DVec3::new(x, y, z);
        self.format.material.map_or(point, |material| material.turned(point))
    }

    fn length(&mut self, index: usize, name: &str) -> f64 {
        self.number(index, |x| x > 0.0, &format!("a {name} must be above 0"))
    }

    /// The light. Its numbers are NaN where fields are invalid.
    fn light(&mut self) -> PlacedLight {
        let (mut sides, mut points, mut length) = (Sides::Two, Vec::new(), f64::NAN);
        let shape = self.format.shape;
        let mut index = self.format.surface_columns().len();
        for parameter in shape.parameters() {
            match parameter {
                ShapeParameter::Sides => {
                    sides = self.sides(index);
                    index += 1;
                }
                ShapeParameter::Point(_) => {
                    points.push(self.point(index));
                    index += 3;
                }
                ShapeParameter::Length(name) => {
                    length = self.length(index, name);
                    index += 1;
                }
                ShapeParameter::Vertices => {
                    points.extend((index..self.texts.len()).step_by(3).map(|index| self.point(index)));
                }
            }
        }
        PlacedLight { shape, sides, points, length }
    }
}

#[cfg(test)]
mod tests {
    use super::{LightShape::Polygon, *};
    use ltcforge_light::{PolygonLight, ShapedLight};

    const SQUARE: &str = "0.5,0.25,0.7,-7e1,1,-1,-1,2,1,-1,2,1,1,2,-1,1,2";

    fn of(shape: LightShape) -> CaseFormat {
        CaseFormat { shape, material: None }
    }

    fn parse(shape: LightShape, line: &str) -> Result<Option<LightCase>, String> {
        of(shape).parse(line)
    }

    fn is_header(shape: LightShape, line: &str) -> bool {
        of(shape).is_header(line)
    }

    fn polygon(case: &LightCase) -> &PolygonLight {
        let AnyLight::Polygon(light) = &case.light else { panic!("{case:?}") };
        light
    }

    #[test]
    fn a_line_is_a_surface_a_view_and_a_light() {
        let case =
            parse(Polygon, &format!(" {} \r", SQUARE.replace(',', " , "))).expect("a light case").expect("not empty");
        assert_eq!(case.at, Configuration { alpha_x: 0.5, alpha_y: 0.25, theta: 0.7, phi: -70.0 });
        assert_eq!((polygon(&case).vertices().len(), polygon(&case).sides()), (4, Sides::One));
        assert_eq!(parse(Polygon, "  \r"), Ok(None));
        let eight: String = [(4, 1), (3, 3), (1, 4), (-1, 4), (-3, 3), (-4, 1), (-4, -1), (0, -4)]
            .map(|(x, y)| format!(",{x},{y},2"))
            .concat();
        let case = parse(Polygon, &format!("1,1,0,0,2{eight}")).expect("a light case").expect("not empty");
        assert_eq!((polygon(&case).vertices().len(), polygon(&case).sides()), (8, Sides::Two));
        assert!(parse(Polygon, &format!("1,1,0,0,2{eight},2,-3,2")).expect_err("nine vertices").contains("32 fields"));
    }

    #[test]
    fn a_wrong_field_is_named_with_its_allowed_values() {
        let with = |index: usize, field: &str| {
            let mut fields: Vec<&str> = SQUARE.split(',').collect();
            fields[index] = field;
            fields.join(",")
        };
        let cases = [
            (with(0, "1.5"), "alpha_x is «1.5»; roughness must be above 0"),
            (with(1, "0"), "alpha_y is «0»; roughness"),
            (
                with(2, "1.5707963267948966"),
                "theta is «1.5707963267948966»; a polar angle must be at least 0 and below",
            ),
            (with(3, "inf"), "phi is «inf»; an azimuth"),
            (with(4, "3"), "sides is «3»; a light has 1 or 2"),
            (with(4, "one"), "sides is «one»"),
            (with(6, "NaN"), "y0 is «NaN»; a coordinate"),
            (with(13, "x"), "z2 is «x»; a coordinate"),
            (with(16, ""), "z3 is «»"),
            (with(16, "-9"), "not convex"),
            (
                "0.5,0.5,0,0".to_owned(),
                "4 fields; a light has alpha_x,alpha_y,theta,phi,sides and then x,y,z of 3 to 8",
            ),
            ("0.5,0.5,0,0,1,0,0,1,0,1,1".to_owned(), "11 fields"),
            (format!("{SQUARE},1"), "18 fields"),
        ];
        for (line, said) in cases {
            let refused = parse(Polygon, &line).expect_err(&line);
            assert!(refused.contains(said), "{line}: {refused}");
        }
    }

    #[test]
    fn the_header_is_known_by_its_names() {
        assert!(is_header(Polygon, "alpha_x, alpha_y,theta,phi,sides,x0,y0,z0,x1,y1,z1,x2,y2,z2\r"));
        assert!(is_header(Polygon, "alpha_x,alpha_y,theta,phi,sides,x0"));
        assert!(!is_header(Polygon, "alpha_x,alpha_y,theta,phi"));
        assert!(!is_header(Polygon, SQUARE));
    }

    /// A line for each shape except polygons, with the light that it describes.
    fn shaped() -> [(LightShape, &'static str, ShapedLight); 4] {
        let (a, b) = (DVec3::new(-1.0, 0.5, 2.0), DVec3::new(1.0, 0.0, 1.5));
        let (x, y) = (DVec3::new(0.5, 0.0, 0.0), DVec3::new(0.0, 0.2, 0.1));
        [
            (LightShape::Disk, "1,-1,0.5,2,0.5,0,0,0,0.2,0.1", ShapedLight::ellipse(a, [x, y], Sides::One)),
            (LightShape::Sphere, "-1,0.5,2,0.25", ShapedLight::sphere(a, 0.25)),
            (LightShape::Tube, "-1,0.5,2,1,0,1.5,0.25", ShapedLight::tube([a, b], 0.25)),
            (LightShape::Line, "-1,0.5,2,1,0,1.5,0.01", ShapedLight::line([a, b], 0.01)),
        ]
        .map(|(shape, line, light)| (shape, line, light.expect("a light")))
    }

    #[test]
    fn every_shape_has_its_own_columns_and_header() {
        for (shape, light, wanted) in shaped() {
            let case =
                parse(shape, &format!("0.5,0.25,0.7,-7e1, {light}\r")).expect("a light case").expect("not empty");
            assert_eq!(case.light, AnyLight::Shaped(wanted), "{shape}");
            assert_eq!((case.at.phi, wanted.shape()), (-70.0, shape));
            assert_eq!(parse(shape, " "), Ok(None));
            let header = of(shape).expected();
            assert!(is_header(shape, &format!("{header}\r")) && !is_header(shape, &format!("{header},x0")), "{header}");
            assert!(!is_header(shape, header.rsplit_once(',').expect("columns").0) && !is_header(Polygon, &header));
            let refused = parse(shape, &format!("0.5,0.25,0.7,0,{light},1")).expect_err("too many fields");
            let count = light.split(',').count() + 5;
            assert_eq!(refused, format!("{count} fields; a {shape} has {header}"));
        }
    }

    #[test]
    fn every_fault_of_a_line_is_reported() {
        let refused = |shape, light: &str| parse(shape, &format!("0.5,0.5,0,0,{light}")).expect_err(light);
        let cases = [
            (
                LightShape::Disk,
                "3,-1,0.5,2,0.5,0,0,0,x,0.1",
                "sides is «3»; a light has 1 or 2 lit sides; vy is «x»; a coordinate",
            ),
            (LightShape::Disk, "1,-1,0.5,2,0.5,0,0.1,1,0,0.2", "the half axes are parallel or zero"),
            (LightShape::Disk, "1,-1,0.5,2,0,0,0,1,0,0.2", "the half axes are parallel or zero"),
            (LightShape::Disk, "1,0.5,0,0,1,0,0,0,1,0", "the shaded point lies inside the light"),
            (
                LightShape::Sphere,
                "NaN,0.5,inf,-1",
                "x is «NaN»; a coordinate must be a finite number; z is «inf»; a coordinate must be a finite number; radius is «-1»; a radius must be above 0",
            ),
            (LightShape::Sphere, "0,0.5,1,0", "radius is «0»; a radius must be above 0"),
            (LightShape::Sphere, "0,0.5,1,1.2", "the shaded point lies inside the light"),
            (LightShape::Sphere, "0,0,0,1e-9", "the shaded point lies inside the light"),
            (LightShape::Tube, "-1,0,0.1,1,0,0.1,0.2", "the shaded point lies inside the light"),
            (LightShape::Tube, "-1,0,,1,0,0.1,0", "az is «»; a coordinate must be a finite number; radius is «0»"),
            (LightShape::Line, "1,0,1,1,0,1,0.1", "the length of the line is 0; the two ends must differ"),
            (LightShape::Line, "-1,0,-1,2,0,2,0.1", "the shaded point lies inside the light"),
            (LightShape::Line, "-1,0,1,2,0,2,0", "width is «0»; a width must be above 0"),
        ];
        for (shape, light, said) in cases {
            let refused = refused(shape, light);
            assert!(refused.starts_with(said), "{shape} {light}: {refused}");
        }
        let all = parse(LightShape::Sphere, "2,0,9,inf,0,0,1,no").expect_err("six faults");
        assert_eq!(all.matches(" is «").count(), 5, "{all}");
    }
}
