//! Occluders: CSV lines of spheres, boxes and triangles.

use std::path::Path;

use glam::DVec3;

use super::{CommandFailure, CsvLines, LineFailure};
use ltcforge_light::shadow::Occluder;

/// The columns of each shape after its name.
const SHAPES: [(&str, &str, usize); 3] =
    [("sphere", "x,y,z,radius", 4), ("box", "x0,y0,z0,x1,y1,z1", 6), ("triangle", "x0,y0,z0,x1,y1,z1,x2,y2,z2", 9)];

/// Reads the occluders of a file.
///
/// # Errors
/// The first invalid line, with its number.
pub(super) fn read(path: &Path) -> Result<Vec<Occluder>, CommandFailure> {
    let mut occluders = Vec::new();
    CsvLines::open(path, "occluders")?.each(
        |line| line.trim_start().starts_with("shape,"),
        |line| {
            if !line.trim().is_empty() {
                occluders.push(parse(line).map_err(LineFailure::Line)?);
            }
            Ok(())
        },
    )?;
    Ok(occluders)
}

fn parse(line: &str) -> Result<Occluder, String> {
    let mut fields = line.split(',').map(str::trim);
    let shape = fields.next().unwrap_or_default();
    let Some((_, columns, count)) = SHAPES.iter().find(|(name, ..)| *name == shape) else {
        return Err(format!("shape is «{shape}»; an occluder is a sphere, a box or a triangle"));
    };
    let texts: Vec<&str> = fields.collect();
    if texts.len() != *count {
        return Err(format!("{} fields; a {shape} has shape,{columns}", texts.len() + 1));
    }
    let mut numbers = Vec::with_capacity(texts.len());
    for (text, name) in texts.iter().zip(columns.split(',')) {
        match text.parse::<f64>() {
            Ok(number) if number.is_finite() => numbers.push(number),
            _ => return Err(format!("{name} is «{text}»; it must be a finite number")),
        }
    }
    let point = |first: usize| DVec3::new(numbers[first], numbers[first + 1], numbers[first + 2]);
    let occluder = match shape {
        "sphere" => Occluder::Sphere { centre: point(0), radius: numbers[3] },
        "box" => Occluder::Box { low: point(0), high: point(3) },
        _ => Occluder::Triangle([point(0), point(3), point(6)]),
    };
    occluder.check().map_err(|error| error.to_string())?;
    Ok(occluder)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_wrong_line_is_named_with_what_is_allowed() {
        assert_eq!(parse(" sphere, 0,0,2, 0.5"), Ok(Occluder::Sphere { centre: DVec3::Z * 2.0, radius: 0.5 }));
        assert_eq!(parse("box,1,1,1,2,2,2"), Ok(Occluder::Box { low: DVec3::ONE, high: DVec3::splat(2.0) }));
        assert!(matches!(parse("triangle,0,0,1,1,0,1,0,1,1"), Ok(Occluder::Triangle(_))));
        for (line, said) in [
            ("cone,1,2,3", "shape is «cone»"),
            ("sphere,0,0,1", "4 fields; a sphere has shape,x,y,z,radius"),
            ("sphere,0,0,1,x", "radius is «x»"),
            ("sphere,0,0,1,-1", "radius must be above 0"),
            ("sphere,0,0,1,2", "contains the shaded point"),
            ("box,-1,-1,-1,1,1,1", "contains the shaded point"),
            ("box,1,1,1,1,2,2", "each upper coordinate"),
            ("triangle,0,0,1,1,0,1,2,0,1", "must not be collinear"),
        ] {
            let refused = parse(line).expect_err(line);
            assert!(refused.contains(said), "{line}: {refused}");
        }
    }
}
