//! Photometric profiles: IES LM-63 files, as a picture over the tangents of angles.
//!
//! Invariant: hostile bytes give an error within bounded time and memory, never a panic.

use ltcforge_fit::math::atan2;
use ltcforge_light::textured::{LightImage, PROFILE_TANGENT};

/// The width and height of the picture in texels.
const SIDE: usize = 512;
/// The name of the format.
pub const PROFILE_FORMAT: &str = "IES LM-63";
/// The largest number of angles per axis, and of candelas per file.
const MOST_ANGLES: usize = 3600;
const MOST_CANDELAS: usize = 1 << 20;
/// The largest file size in bytes. It leaves room for all allowed numbers.
const MOST_BYTES: usize = 1 << 24;
/// The number of values between the TILT line and the angles.
const HEADER: usize = 13;

/// The file is not a valid profile. Lists all errors of its header, or all errors of its angles and candelas.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("not a readable IES LM-63 file: {}", .0.join("; "))]
pub struct ProfileError(Vec<String>);

/// The candelas of a lamp by direction, for type C: by the angle from the axis and the angle around it.
#[derive(Debug, Clone, PartialEq)]
pub struct Profile {
    /// Angles from the axis, in degrees.
    vertical: Vec<f64>,
    /// Angles around the axis in degrees. They run from 0 to 0 for rotational symmetry, to 90 for four equal quadrants,
    /// to 180 or from 90 to 270 for two equal halves, and otherwise to 360.
    horizontal: Vec<f64>,
    /// The candelas for each horizontal angle and, within it, each vertical angle.
    candelas: Vec<f64>,
}

/// The byte-order mark of UTF-8, which some programs write first.
const MARK: &[u8] = b"\xef\xbb\xbf";

/// Whether the bytes start like an IES file of LM-63-1991 or later.
pub(super) fn is_profile(bytes: &[u8]) -> bool {
    let text = bytes.strip_prefix(MARK).unwrap_or(bytes);
    [b"IESNA".as_slice(), b"IES:"].iter().any(|magic| text.starts_with(magic))
}

impl Profile {
    /// Reads an IES LM-63 file with type C photometry and without tilt.
    ///
    /// # Errors
    /// [`ProfileError`]: an invalid TILT line or number, or else all errors of the header, or else all errors of the
    /// angles and candelas.
    pub fn parse(bytes: &[u8]) -> Result<Self, ProfileError> {
        let one = |fault: String| ProfileError(vec![fault]);
        if bytes.len() > MOST_BYTES {
            return Err(one(format!("{} bytes; at most {MOST_BYTES} are read", bytes.len())));
        }
        let text = String::from_utf8_lossy(bytes.strip_prefix(MARK).unwrap_or(bytes));
        let mut lines = text.split(['\r', '\n']);
        let tilt = lines.find_map(|line| {
            let (name, tilt) = line.split_once('=')?;
            name.trim().eq_ignore_ascii_case("TILT").then_some(tilt.trim())
        });
        let tilt = tilt.ok_or_else(|| one("the line TILT= is missing".to_owned()))?;
        if !tilt.eq_ignore_ascii_case("NONE") {
            let tilt: String = tilt.chars().take(40).collect();
            return Err(one(format!("TILT is «{tilt}»; only NONE is supported")));
        }
        let words = lines.flat_map(|line| line.split(|c: char| c.is_whitespace() || c == ','));
        let words = words.filter(|word| !word.is_empty());
        let mut numbers = Vec::new();
        for word in words.take(HEADER + 2 * MOST_ANGLES + MOST_CANDELAS + 1) {
            let number = word.parse::<f64>().ok().filter(|number| number.is_finite());
            let shown = || word.chars().take(40).collect::<String>();
            numbers.push(number.ok_or_else(|| one(format!("number {} is «{}»", numbers.len() + 1, shown())))?);
        }
        if numbers.len() < HEADER {
            return Err(one(format!("{} numbers follow TILT; the header needs {HEADER}", numbers.len())));
        }
        let mut faults = Vec::new();
        let mut count = |name: &str, number: f64| {
            let is_count = number.fract() == 0.0 && (1.0..=MOST_ANGLES as f64).contains(&number);
            if !is_count {
                faults.push(format!("there are {number} {name} angles; 1 to {MOST_ANGLES} are allowed"));
            }
            if is_count { number as usize } else { 0 }
        };
        let [rows, columns] = [count("vertical", numbers[3]), count("horizontal", numbers[4])];
        if numbers[5] != 1.0 {
            faults.push(format!("the photometric type is {}; only 1 (type C) is supported", numbers[5]));
        }
        // LM-63-1995 and later reserve the ballast-lamp photometric factor for future use.
        let of_lamp = if text.starts_with("IESNA91") { numbers[11] } else { 1.0 };
        let factor = numbers[2] * numbers[10] * of_lamp;
        if factor <= 0.0 {
            faults.push(format!(
                "the multiplier {} times the ballast factor {} times the ballast-lamp factor {of_lamp} must be above zero",
                numbers[2], numbers[10]
            ));
        }
        let wanted = HEADER + rows + columns + rows * columns;
        if rows * columns > MOST_CANDELAS {
            faults.push(format!("there are {rows} x {columns} candelas; {MOST_CANDELAS} are allowed"));
        } else if rows * columns > 0 && numbers.len() != wanted {
            faults.push(format!("{} numbers follow TILT; the angles need {wanted}", numbers.len()));
        }
        if !faults.is_empty() {
            return Err(ProfileError(faults));
        }
        let (vertical, rest) = numbers[HEADER..].split_at(rows);
        let (horizontal, candelas) = rest.split_at(columns);
        for (name, angles, allowed, words) in [
            ("vertical", vertical, [[0.0, 90.0], [0.0, 180.0]].as_slice(), "0 to 90, 0 to 180"),
            (
                "horizontal",
                horizontal,
                &[[0.0, 0.0], [0.0, 90.0], [0.0, 180.0], [0.0, 360.0], [90.0, 270.0]],
                "0 to 0, 0 to 90, 0 to 180, 0 to 360, 90 to 270",
            ),
        ] {
            let ends = [angles[0], angles[angles.len() - 1]];
            if !allowed.contains(&ends) {
                faults.push(format!("{name} angles run from {} to {}; allowed: {words}", ends[0], ends[1]));
            }
            if !angles.is_sorted_by(|a, b| a < b) {
                faults.push(format!("{name} angles must ascend"));
            }
        }
        if let Some(i) = candelas.iter().position(|value| *value < 0.0) {
            faults.push(format!("candela {} is {}; candelas must not be negative", i + 1, candelas[i]));
        }
        // The picture has the directions in front of the lamp.
        let is_in_front = |row: usize| row == 0 || vertical[row - 1] < 90.0;
        if !candelas.iter().enumerate().any(|(i, value)| *value != 0.0 && is_in_front(i % rows)) {
            faults.push("all candelas at less than 90 degrees from the axis are zero".to_owned());
        }
        if !faults.is_empty() {
            return Err(ProfileError(faults));
        }
        Ok(Self {
            vertical: vertical.to_vec(),
            horizontal: horizontal.to_vec(),
            candelas: candelas.iter().map(|value| value * factor).collect(),
        })
    }

    /// The number of angles around the axis, and the number of angles from it.
    #[must_use]
    pub fn angles(&self) -> [usize; 2] {
        [self.horizontal.len(), self.vertical.len()]
    }

    /// The candelas for a direction `(x, y, 1)`, interpolated linearly between angles. The angle around the axis runs
    /// from x to y.
    #[must_use]
    pub fn candelas(&self, [x, y]: [f64; 2]) -> f64 {
        let theta = atan2((x * x + y * y).sqrt(), 1.0).to_degrees();
        let last = self.horizontal[self.horizontal.len() - 1];
        let turned = (atan2(y, x).to_degrees() + 360.0) % 360.0;
        let phi = match last {
            360.0 => turned,
            180.0 => turned.min(360.0 - turned),
            // The mirror is the plane of 90 and 270 degrees.
            270.0 if !(90.0..=270.0).contains(&turned) => (540.0 - turned) % 360.0,
            270.0 => turned,
            90.0 => (turned % 180.0).min(180.0 - turned % 180.0),
            _ => 0.0,
        };
        let ((i, s), (j, t)) = (between(&self.horizontal, phi), between(&self.vertical, theta));
        let rows = self.vertical.len();
        let row = |i: usize| {
            let at = |j: usize| self.candelas[i.min(self.horizontal.len() - 1) * rows + j.min(rows - 1)];
            at(j) + (at(j + 1) - at(j)) * t
        };
        row(i) + (row(i + 1) - row(i)) * s
    }

    /// The picture over tangents. A texel is the candelas divided by the cosine of the angle to the axis: the radiance
    /// of a light with area one. The tangents, x along u and y along v, run from -4 to 4.
    ///
    /// # Panics
    /// Never: candelas are finite and not negative.
    #[must_use]
    pub fn image(&self) -> LightImage {
        let tangent = |i: usize| ((i as f64 + 0.5) / SIDE as f64 * 2.0 - 1.0) * PROFILE_TANGENT;
        let texel = |i: usize| {
            let [x, y] = [i % SIDE, i / SIDE].map(tangent);
            let radiance = self.candelas([x, y]) * (x * x + y * y + 1.0).sqrt();
            [radiance.min(f64::from(f32::MAX)) as f32; 3]
        };
        LightImage::new(SIDE, SIDE, (0..SIDE * SIDE).map(texel).collect()).expect("finite texels")
    }
}

/// The last node at or below a value, and the position between it and the next node, from 0 to 1.
fn between(nodes: &[f64], x: f64) -> (usize, f64) {
    let i = nodes.partition_point(|node| *node <= x).saturating_sub(1);
    nodes.get(i + 1).map_or((i, 0.0), |next| (i, (x - nodes[i]) / (next - nodes[i])))
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn hostile_files_are_errors_or_have_candelas(text in "[0-9 .,e-]{0,80}", counts in prop::array::uniform2(0..4_usize)) {
            let header = format!("1 -1 1 {} {} 1 2 0 0 0", counts[0], counts[1]);
            for text in [file(&header, &text, "0 0"), file(&header, "0 90", &text)] {
                if let Ok(profile) = Profile::parse(text.as_bytes()) {
                    prop_assert!(profile.candelas([0.3, -2.0]) >= 0.0);
                }
            }
        }
    }

    fn file(header: &str, angles: &str, candelas: &str) -> String {
        format!("IESNA:LM-63-2002\n[TEST] none\nTILT=NONE\n{header}\n1 1 100\n{angles}\n{candelas}\n")
    }

    #[test]
    fn candelas_are_linear_between_angles_and_mirrored() {
        // A quadrant: 0, 45 and 90 degrees from the axis, and 0 and 90 degrees around it. The factors are 2 and 0.5.
        let text =
            file("1 -1 2 3 2 1 2 0 0 0", "0 45 90, 0 90", "100 60 0\n100 20 0").replace("\n1 1 100", "\n0.5 1 100");
        let profile = Profile::parse(text.as_bytes()).expect("a profile");
        assert_eq!(profile.angles(), [2, 3]);
        let near = |g: [f64; 2], wanted: f64| {
            let found = profile.candelas(g);
            assert!((found - wanted).abs() < 1e-9, "{g:?}: {found} {wanted}");
        };
        near([0.0, 0.0], 100.0);
        for sign in [1.0, -1.0] {
            near([sign, 0.0], 60.0);
            near([0.0, sign], 20.0);
            near([0.5_f64.sqrt(), sign * 0.5_f64.sqrt()], 40.0);
            near([22.5_f64.to_radians().tan() * sign, 0.0], 80.0);
        }
        // The picture divides the value by the cosine. The texel is near a tangent of one.
        let image = profile.image();
        let texel = image.row(256)[256 + 64];
        assert!((f64::from(texel[0]) / (60.0 * 2.0_f64.sqrt()) - 1.0).abs() < 0.01, "{texel:?}");
    }

    #[test]
    fn the_same_profile_in_other_ways_of_writing() {
        let text = file("1 -1 1 3 1 1 2 0 0 0", "0 45 90, 0", "100 60 0");
        let wanted = Profile::parse(text.as_bytes());
        assert!(wanted.is_ok());
        for other in [
            format!("\u{feff}{text}"),
            text.replace("TILT=NONE", "Tilt=none"),
            text.replace("TILT=NONE", " tilt = None "),
            text.replace('\n', "\r"),
            text.replace('\n', "\r\n"),
            text.replace("[TEST] none", "[TEST] TILT=INCLUDE"),
        ] {
            assert!(is_profile(other.as_bytes()), "{other:?}");
            assert_eq!(Profile::parse(other.as_bytes()), wanted, "{other:?}");
        }
        // The files of 1991 have another factor, which later files reserve.
        let other = text.replace("\n1 1 100", "\n1 0.5 100");
        assert_eq!(Profile::parse(other.as_bytes()), wanted);
        let other = other.replace("IESNA:LM-63-2002", "IESNA91");
        let half = Profile::parse(other.as_bytes()).expect("a profile");
        assert_eq!(half.candelas([0.0, 0.0]), 50.0);
    }

    #[test]
    fn halves_are_mirrored_in_their_plane() {
        let text = file("1 -1 1 2 3 1 2 0 0 0", "0 90, 90 180 270", "90 90 180 180 30 30");
        let profile = Profile::parse(text.as_bytes()).expect("a profile");
        for (g, wanted) in [
            ([0.0, 1.0], 90.0),
            ([-1.0, 0.0], 180.0),
            ([0.0, -1.0], 30.0),
            ([1.0, 0.0], 180.0),
            ([1.0, 1.0], 135.0),
            ([-1.0, 1.0], 135.0),
            ([1.0, -1.0], 105.0),
            ([-1.0, -1.0], 105.0),
        ] {
            let found = profile.candelas(g);
            assert!((found - wanted).abs() < 1e-9, "{g:?}: {found} {wanted}");
        }
    }

    #[test]
    fn a_profile_without_light_in_front_is_refused() {
        for candelas in ["0 0 0 0", "0 0 0 7"] {
            let text = file("1 -1 1 4 1 1 2 0 0 0", "0 45 90 180, 0", candelas);
            let said = Profile::parse(text.as_bytes()).expect_err("no light").to_string();
            assert!(said.ends_with("all candelas at less than 90 degrees from the axis are zero"), "{said}");
        }
        assert!(Profile::parse(file("1 -1 1 4 1 1 2 0 0 0", "0 45 90 180, 0", "0 0 1 0").as_bytes()).is_ok());
    }

    #[test]
    fn all_faults_of_a_file_are_reported() {
        let said = |text: &str| Profile::parse(text.as_bytes()).expect_err("not a profile").to_string();
        assert!(said("IESNA91\n").ends_with("the line TILT= is missing"));
        assert!(said("IESNA91\nTILT=INCLUDE\n1").ends_with("TILT is «INCLUDE»; only NONE is supported"));
        assert!(said("IESNA91\nTILT=NONE\n1 1 x").ends_with("number 3 is «x»"));
        assert!(said("IESNA91\nTILT=NONE\n1 1 nan").ends_with("number 3 is «nan»"));
        assert!(said("IESNA91\nTILT=NONE\n1 1").ends_with("2 numbers follow TILT; the header needs 13"));
        let header = said(&file("1 -1 0 2 0.5 3 2 0 0 0", "0 90 0", "1 1"));
        for part in [
            "there are 0.5 horizontal angles; 1 to 3600 are allowed",
            "the photometric type is 3; only 1 (type C) is supported",
            "the multiplier 0 times the ballast factor 1 times the ballast-lamp factor 1 must be above zero",
        ] {
            assert!(header.contains(part), "{header}");
        }
        let counts = said(&file("1 -1 1 2 1 1 2 0 0 0", "0 90 0", "1"));
        assert!(counts.ends_with("17 numbers follow TILT; the angles need 18"), "{counts}");
        let angles = said(&file("1 -1 1 3 2 1 2 0 0 0", "0 95 90 10 90", "1 2 -3 4 5 6"));
        for part in ["vertical angles must ascend", "horizontal angles run from 10 to 90", "candela 3 is -3"] {
            assert!(angles.contains(part), "{angles}");
        }
        let many = said(&file("1 -1 1 3600 3600 1 2 0 0 0", "0", "1"));
        assert!(many.contains("3600 x 3600 candelas; 1048576 are allowed"), "{many}");
    }
}
