//! Lamps: CSV lines of a surface, a view direction and a polygon light.

use std::f64::consts::FRAC_PI_2;

use glam::DVec3;

use crate::{
    fit::{Configuration, MAX_VERTICES, Sides},
    light::{LightError, PolygonLight},
};

/// The names of the columns before the vertices.
const COLUMNS: [&str; 5] = ["alpha_x", "alpha_y", "theta", "phi", "sides"];
const LEAST_VERTICES: usize = 3;

/// What a line describes.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Lamp {
    pub(super) at: Configuration,
    pub(super) light: PolygonLight,
}

/// The name of a column: `x0`, `y0`, `z0`, `x1` ... after the first five.
fn column(index: usize) -> String {
    let Some(number) = index.checked_sub(COLUMNS.len()) else { return COLUMNS[index].to_owned() };
    format!("{}{}", ["x", "y", "z"][number % 3], number / 3)
}

/// Reads a line; `None` for an empty one.
///
/// # Errors
/// The field that is wrong, and what is allowed.
pub(super) fn parse(line: &str) -> Result<Option<Lamp>, String> {
    if line.trim().is_empty() {
        return Ok(None);
    }
    let fields: Vec<&str> = line.split(',').map(str::trim).collect();
    let coordinates = fields.len().saturating_sub(COLUMNS.len());
    if !coordinates.is_multiple_of(3) || !(LEAST_VERTICES..=MAX_VERTICES).contains(&(coordinates / 3)) {
        return Err(format!(
            "{} fields; a light has {} and then x,y,z of {LEAST_VERTICES} to {MAX_VERTICES} vertices",
            fields.len(),
            COLUMNS.join(",")
        ));
    }
    let refuse = |index: usize, allowed: &str| format!("{} is «{}»; {allowed}", column(index), fields[index]);
    let value = |index: usize, is_allowed: &dyn Fn(f64) -> bool, allowed: &str| match fields[index].parse::<f64>() {
        Ok(value) if value.is_finite() && is_allowed(value) => Ok(value),
        _ => Err(refuse(index, allowed)),
    };
    let roughness = |index: usize| value(index, &|x| x > 0.0 && x <= 1.0, "roughness is a number above 0, up to 1");
    let at = Configuration {
        alpha_x: roughness(0)?,
        alpha_y: roughness(1)?,
        theta: value(
            2,
            &|x| (0.0..FRAC_PI_2).contains(&x),
            "a polar angle is a number from 0 to below pi/2, in radians",
        )?,
        phi: value(3, &|_| true, "an azimuth is a finite number, in radians")?,
    };
    let sides = match fields[4] {
        "1" => Sides::One,
        "2" => Sides::Two,
        _ => return Err(refuse(4, "a light has 1 or 2 lit sides")),
    };
    let coordinate = |index: usize| value(index, &|_| true, "a coordinate is a finite number");
    let vertex = |first: usize| Ok(DVec3::new(coordinate(first)?, coordinate(first + 1)?, coordinate(first + 2)?));
    let vertices: Result<Vec<DVec3>, String> = (COLUMNS.len()..fields.len()).step_by(3).map(vertex).collect();
    let light = PolygonLight::new(vertices?, sides).map_err(|error: LightError| error.to_string())?;
    Ok(Some(Lamp { at, light }))
}

/// Whether a line is a header, for lights of any number of vertices.
pub(super) fn is_header(line: &str) -> bool {
    let fields: Vec<&str> = line.split(',').map(str::trim).collect();
    fields.len() > COLUMNS.len() && fields.iter().enumerate().all(|(index, name)| column(index) == *name)
}

#[cfg(test)]
mod tests {
    use super::*;

    const SQUARE: &str = "0.5,0.25,0.7,-7e1,1,-1,-1,2,1,-1,2,1,1,2,-1,1,2";

    #[test]
    fn a_line_is_a_surface_a_view_and_a_light() {
        let lamp = parse(&format!(" {} \r", SQUARE.replace(',', " , "))).expect("a lamp").expect("not empty");
        assert_eq!(lamp.at, Configuration { alpha_x: 0.5, alpha_y: 0.25, theta: 0.7, phi: -70.0 });
        assert_eq!((lamp.light.vertices().len(), lamp.light.sides()), (4, Sides::One));
        assert_eq!(parse("  \r"), Ok(None));
        let eight: String = [(4, 1), (3, 3), (1, 4), (-1, 4), (-3, 3), (-4, 1), (-4, -1), (0, -4)]
            .map(|(x, y)| format!(",{x},{y},2"))
            .concat();
        let lamp = parse(&format!("1,1,0,0,2{eight}")).expect("a lamp").expect("not empty");
        assert_eq!((lamp.light.vertices().len(), lamp.light.sides()), (8, Sides::Two));
        assert!(parse(&format!("1,1,0,0,2{eight},2,-3,2")).expect_err("nine vertices").contains("32 fields"));
    }

    #[test]
    fn a_wrong_field_is_named_with_what_is_allowed() {
        let with = |index: usize, field: &str| {
            let mut fields: Vec<&str> = SQUARE.split(',').collect();
            fields[index] = field;
            fields.join(",")
        };
        let cases = [
            (with(0, "1.5"), "alpha_x is «1.5»; roughness is a number above 0"),
            (with(1, "0"), "alpha_y is «0»; roughness"),
            (with(2, "1.5707963267948966"), "theta is «1.5707963267948966»; a polar angle is a number from 0 to below"),
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
            let refused = parse(&line).expect_err(&line);
            assert!(refused.contains(said), "{line}: {refused}");
        }
    }

    #[test]
    fn the_header_is_known_by_its_names() {
        assert!(is_header("alpha_x, alpha_y,theta,phi,sides,x0,y0,z0,x1,y1,z1,x2,y2,z2\r"));
        assert!(is_header("alpha_x,alpha_y,theta,phi,sides,x0"));
        assert!(!is_header("alpha_x,alpha_y,theta,phi"));
        assert!(!is_header(SQUARE));
    }
}
