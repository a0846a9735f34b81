//! Points: CSV lines of a material and a view direction.

use std::f64::consts::FRAC_PI_2;

use ltcforge_fit::Configuration;

/// How far above pi/2 a polar angle may be and still count as pi/2. The nearest f32 is 4.4e-8 above pi/2.
const THETA_ROUNDING: f64 = 1e-7;

/// The names of the columns, which are also the header line.
pub(super) const COLUMNS: [&str; 4] = ["alpha_x", "alpha_y", "theta", "phi"];

/// A point: the text of its fields, and their values.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Point<'a> {
    /// The fields without surrounding blanks, in the order of [`COLUMNS`].
    pub(super) written: [&'a str; 4],
    /// Their values.
    pub(super) configuration: Configuration,
}

/// Reads a line; `None` for an empty line.
///
/// # Errors
/// The invalid field, and its allowed values.
pub(super) fn parse(line: &str) -> Result<Option<Point<'_>>, String> {
    if line.trim().is_empty() {
        return Ok(None);
    }
    let fields: Vec<&str> = line.split(',').map(str::trim).collect();
    let written: [&str; 4] = fields
        .try_into()
        .map_err(|fields: Vec<&str>| format!("{} fields; a point has four: {}", fields.len(), COLUMNS.join(",")))?;
    let value = |column: usize, low: f64, high: f64, allowed: &str| match written[column].parse::<f64>() {
        Ok(value) if value.is_finite() && (low..=high).contains(&value) => Ok(value),
        _ => Err(format!("{} is «{}»; {allowed}", COLUMNS[column], written[column])),
    };
    let configuration = Configuration {
        alpha_x: value(0, 0.0, 1.0, "roughness must be between 0 and 1")?,
        alpha_y: value(1, 0.0, 1.0, "roughness must be between 0 and 1")?,
        theta: value(2, 0.0, FRAC_PI_2 + THETA_ROUNDING, "a polar angle must be between 0 and pi/2, in radians")?
            .min(FRAC_PI_2),
        phi: value(3, f64::MIN, f64::MAX, "an azimuth must be a finite number, in radians")?,
    };
    Ok(Some(Point { written, configuration }))
}

/// Turns the line of a view into the line of a point, by adding the material's roughnesses; `None` for an empty line.
///
/// # Errors
/// When the line has more or fewer fields than a view.
pub(super) fn of_view(line: &str, [alpha_x, alpha_y]: [f64; 2]) -> Result<Option<String>, String> {
    match line.split(',').count() {
        _ if line.trim().is_empty() => Ok(None),
        2 => Ok(Some(format!("{alpha_x},{alpha_y},{line}"))),
        fields => Err(format!("{fields} fields; the view of a material has two: {}", COLUMNS[2..].join(","))),
    }
}

/// Whether a line is the header of points or of views.
pub(super) fn is_header(line: &str) -> bool {
    let fields = || line.split(',').map(str::trim);
    fields().eq(COLUMNS) || fields().eq(COLUMNS[2..].iter().copied())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fields_are_kept_as_written() {
        let point = parse(" 0.10, 1 ,0.00,-7e1\r").expect("a point").expect("not empty");
        assert_eq!(point.written, ["0.10", "1", "0.00", "-7e1"]);
        let Configuration { alpha_x, alpha_y, theta, phi } = point.configuration;
        assert_eq!([alpha_x, alpha_y, theta, phi], [0.1, 1.0, 0.0, -70.0]);
        assert_eq!(parse("  \r"), Ok(None));
    }

    #[test]
    fn the_horizon_in_single_precision_is_the_horizon() {
        let line = format!("0,0,{},0", std::f32::consts::FRAC_PI_2);
        let point = parse(&line).expect("a point").expect("not empty");
        assert_eq!(point.configuration.theta, FRAC_PI_2);
        let double = parse("0,0,1.57079632679489656,0").expect("a point").expect("not empty");
        assert_eq!(double.configuration.theta, FRAC_PI_2);
    }

    #[test]
    fn a_wrong_field_is_named_with_its_allowed_values() {
        let cases = [
            ("1.5,0,0,0", "alpha_x is «1.5»; roughness"),
            ("0,-0.1,0,0", "alpha_y is «-0.1»; roughness"),
            ("0,0,1.6,0", "theta is «1.6»; a polar angle"),
            ("0,0,0,inf", "phi is «inf»; an azimuth"),
            ("0,0,0,x", "phi is «x»"),
            ("NaN,0,0,0", "alpha_x is «NaN»"),
            ("0,0,0", "3 fields"),
            ("0,0,0,0,0", "5 fields"),
        ];
        for (line, said) in cases {
            let refused = parse(line).expect_err(line);
            assert!(refused.contains(said), "{line}: {refused}");
        }
    }

    #[test]
    fn the_header_is_known_by_its_names() {
        assert!(is_header("alpha_x, alpha_y,theta,phi\r"));
        assert!(!is_header("alpha_x,alpha_y,theta"));
        assert!(!is_header("0,0,0,0"));
    }
}
