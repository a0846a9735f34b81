//! From the numbers in a file to linear numbers with the primaries of BT.709.
//!
//! Invariant: hostile profiles and primaries give an error, never a panic.

use std::{fmt, sync::Arc};

use glam::{DMat3, DVec3};
use ltcforge_fit::{math::pow, named_list};

named_list! {
    /// The relation between the numbers of an image file and light.
    pub enum TransferFunction {
        /// Numbers are proportional to light.
        Linear = "linear",
        /// Numbers follow the sRGB curve.
        Srgb = "srgb",
    }
}

/// The curve that decodes the numbers of an image.
#[derive(Debug, Clone, PartialEq)]
pub enum Curve {
    /// Numbers are used unchanged.
    Linear,
    /// The sRGB curve [IEC 61966-2-1].
    Srgb,
    /// A power, from the file's gamma.
    Power(f64),
    /// The curves of an ICC profile for red, green and blue, at 65,536 numbers from 0 to 1.
    Profile(Arc<[Vec<f32>; 3]>),
}

impl From<TransferFunction> for Curve {
    fn from(transfer: TransferFunction) -> Self {
        match transfer {
            TransferFunction::Linear => Self::Linear,
            TransferFunction::Srgb => Self::Srgb,
        }
    }
}

impl fmt::Display for Curve {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Linear => f.write_str("linear"),
            Self::Srgb => f.write_str("srgb"),
            Self::Power(power) => write!(f, "power {power:.3}"),
            Self::Profile(_) => f.write_str("icc"),
        }
    }
}

impl Curve {
    /// The linear number of a channel. Above 1, sRGB continues with the same formula. Domain: numbers of at least zero
    /// for `Power`, and 0 to 1 for `Profile`.
    pub(super) fn linear(&self, channel: usize, x: f64) -> f64 {
        match self {
            Self::Linear => x,
            Self::Srgb if x <= 0.040_45 => x / 12.92,
            Self::Srgb => pow((x + 0.055) / 1.055, 2.4),
            Self::Power(power) => pow(x, *power),
            Self::Profile(curves) => f64::from(curves[channel][(x * LARGEST).round() as usize]),
        }
    }

    /// The linear numbers of each channel for all integers up to `largest`, which becomes 1.
    pub(super) fn tables(&self, largest: u16) -> [Vec<f32>; 3] {
        let at = |channel, x| self.linear(channel, f64::from(x) / f64::from(largest)) as f32;
        [0, 1, 2].map(|channel| (0..=largest).map(|x| at(channel, x)).collect())
    }
}

/// The primaries of an image's numbers.
#[derive(Debug, Clone, PartialEq)]
pub struct Primaries {
    name: String,
    /// The matrix from linear numbers to BT.709. `None` if they are the same.
    to_bt709: Option<DMat3>,
}

/// The x and y of red, green, blue and white [CIE 1931].
pub(super) type Chromaticities = [[f64; 2]; 4];

const D65: [f64; 2] = [0.3127, 0.3290];
/// The code points of primaries, with their names [ITU-T H.273, table 2].
const CODES: [(u8, &str, Chromaticities); 7] = [
    (1, "BT.709", [[0.64, 0.33], [0.3, 0.6], [0.15, 0.06], D65]),
    (5, "BT.601 625", [[0.64, 0.33], [0.29, 0.6], [0.15, 0.06], D65]),
    (6, "BT.601 525", [[0.63, 0.34], [0.31, 0.595], [0.155, 0.07], D65]),
    (7, "SMPTE 240M", [[0.63, 0.34], [0.31, 0.595], [0.155, 0.07], D65]),
    (9, "BT.2020", [[0.708, 0.292], [0.17, 0.797], [0.131, 0.046], D65]),
    (11, "DCI-P3", [[0.68, 0.32], [0.265, 0.69], [0.15, 0.06], [0.314, 0.351]]),
    (12, "Display P3", [[0.68, 0.32], [0.265, 0.69], [0.15, 0.06], D65]),
];

/// The white of ICC profiles [ICC.1:2022, section 7.2.16].
const D50: DVec3 = DVec3::new(0.9642, 1.0, 0.8249);

/// From XYZ to the responses of cones [Lam 1985].
const BRADFORD: DMat3 = DMat3::from_cols_array(&[
    0.8951, -0.7502, 0.0389, // X
    0.2664, 1.7135, -0.0685, // Y
    -0.1614, 0.0367, 1.0296, // Z
]);

/// Smaller differences are ignored: of a matrix from the unit matrix, and of a curve from sRGB or a line. Profiles for
/// sRGB differ by 3e-4 from the standard; a power of 2.2 differs by 9e-3.
const SAME: f64 = 2e-3;

/// The largest number of a curve of 65,536 numbers.
const LARGEST: f64 = 65_535.0;

impl fmt::Display for Primaries {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.name)
    }
}

impl Primaries {
    /// The primaries of BT.709 and sRGB.
    pub(super) fn bt709() -> Self {
        Self { name: CODES[0].1.to_owned(), to_bt709: None }
    }

    /// The primaries with these chromaticities.
    pub(super) fn new(xy: Chromaticities) -> Result<Self, String> {
        let near = |known: &Chromaticities| (0..8).all(|i| (known[i / 2][i % 2] - xy[i / 2][i % 2]).abs() < 1e-3);
        let known = CODES.iter().find(|(.., known)| near(known));
        let name = known.map_or_else(|| format!("with xy {xy:.4?}"), |(_, name, _)| (*name).to_owned());
        match xyz_of(xy) {
            Some((xyz, white)) => Self::of_matrix(name, xyz, white),
            None => Err(format!("primaries {name} do not enclose the white point")),
        }
    }

    /// The primaries of a code point.
    pub(super) fn of_code(code: u8) -> Result<Self, String> {
        let known = CODES.iter().find(|(known, ..)| *known == code);
        known.map_or_else(
            || Err(format!("its cICP chunk names primaries {code}; {:?} are supported", CODES.map(|(code, ..)| code))),
            |(.., xy)| Self::new(*xy),
        )
    }

    /// The primaries with this matrix to XYZ, where (1, 1, 1) is `white`.
    fn of_matrix(name: String, xyz: DMat3, white: DVec3) -> Result<Self, String> {
        let (bt709, d65) = xyz_of(CODES[0].2).ok_or("BT.709 has no matrix")?;
        let adapted = BRADFORD.inverse() * DMat3::from_diagonal((BRADFORD * d65) / (BRADFORD * white)) * BRADFORD;
        let to_bt709 = bt709.inverse() * adapted * xyz;
        if !to_bt709.is_finite() {
            return Err(format!("primaries {name} have no matrix"));
        }
        let is_same = to_bt709.abs_diff_eq(DMat3::IDENTITY, SAME);
        Ok(if is_same { Self::bt709() } else { Self { name, to_bt709: Some(to_bt709) } })
    }

    /// Converts linear texels to BT.709. Negative components of colours outside BT.709 become 0. Invalid texels stay.
    pub(super) fn convert(&self, texels: &mut [[f32; 3]]) {
        let Some(to_bt709) = self.to_bt709 else { return };
        for texel in texels.iter_mut().filter(|texel| texel.iter().all(|x| x.is_finite() && *x >= 0.0)) {
            let converted = to_bt709 * DVec3::from(texel.map(f64::from));
            *texel = converted.max(DVec3::ZERO).to_array().map(|x| x as f32);
        }
    }
}

/// The matrix to XYZ, and the XYZ of white with Y = 1. `None` if white is not a mixture of the primaries.
fn xyz_of(xy: Chromaticities) -> Option<(DMat3, DVec3)> {
    let [red, green, blue, white] = xy.map(|[x, y]| DVec3::new(x, y, 1.0 - x - y));
    let (primaries, white) = (DMat3::from_cols(red, green, blue), white / white.y);
    let scales = primaries.inverse() * white;
    (scales.is_finite() && scales.min_element() > 0.0).then(|| (primaries * DMat3::from_diagonal(scales), white))
}

/// The curves and the primaries of an ICC profile: curves and a matrix to XYZ, or the curve of grey [ICC.1:2022,
/// sections 8.3 and 8.4].
pub(super) fn profile(icc: &[u8]) -> Result<(Curve, Primaries), String> {
    let [space, connection] = [16, 20].map(|at| icc.get(at..at + 4).unwrap_or_default());
    let is_grey = space == b"GRAY";
    let curve = |name| samples(tag(icc, name)?);
    let column = |name| {
        let xyz = tag(icc, name)?;
        Some(DVec3::new(fixed(xyz, 8)?, fixed(xyz, 12)?, fixed(xyz, 16)?))
    };
    let read = || {
        let names = if is_grey { [b"kTRC"; 3] } else { [b"rTRC", b"gTRC", b"bTRC"] };
        let curves = Curve::Profile(Arc::new([curve(names[0])?, curve(names[1])?, curve(names[2])?]));
        let columns = || Some(DMat3::from_cols(column(b"rXYZ")?, column(b"gXYZ")?, column(b"bXYZ")?));
        Some((curves, if is_grey { None } else { Some(columns()?) }))
    };
    // Lookup tables have priority over a matrix.
    let is_simple = (is_grey || space == b"RGB ") && connection == b"XYZ " && tag(icc, b"A2B0").is_none();
    let (curve, matrix) = is_simple.then(read).flatten().ok_or_else(|| {
        let [space, connection] = [space, connection].map(<[u8]>::escape_ascii);
        let command = "magick IN -profile sRGB.icc OUT";
        format!(
            "the ICC profile is not supported («{space}» to «{connection}»; only a matrix with curves is); convert the \
             image to sRGB: {command}"
        )
    })?;
    let is_near = |other: &Curve| {
        let [a, b] = [&curve, other].map(|curve| curve.tables(255).concat());
        a.iter().zip(b).all(|(a, b)| f64::from((a - b).abs()) < SAME)
    };
    let near = [Curve::Srgb, Curve::Linear].into_iter().find(is_near);
    let primaries = matrix.map(|matrix| Primaries::of_matrix("of an ICC profile".to_owned(), matrix, D50));
    Ok((near.unwrap_or(curve), primaries.unwrap_or_else(|| Ok(Primaries::bt709()))?))
}

fn big_endian<const N: usize>(bytes: &[u8], at: usize) -> Option<[u8; N]> {
    bytes.get(at..)?.first_chunk().copied()
}

/// A number with 16 bits after the point.
fn fixed(bytes: &[u8], at: usize) -> Option<f64> {
    big_endian(bytes, at).map(|number| f64::from(i32::from_be_bytes(number)) / 65_536.0)
}

/// The data of a tag: a name, a position and a length are listed after the header.
fn tag<'a>(icc: &'a [u8], name: &[u8]) -> Option<&'a [u8]> {
    let count = u32::from_be_bytes(big_endian(icc, 128)?) as usize;
    let entry = icc.get(132..)?.as_chunks::<12>().0.iter().take(count).find(|entry| entry.starts_with(name))?;
    let [at, length] = [4, 8].map(|at| big_endian(entry, at).map_or(0, u32::from_be_bytes) as usize);
    icc.get(at..at.checked_add(length)?)
}

/// A curve at 65,536 numbers from 0 to 1. Its tag has samples, a power, or the parameters of a formula
/// [ICC.1:2022, sections 10.6 and 10.18].
fn samples(tag: &[u8]) -> Option<Vec<f32>> {
    let sampled = |curve: &dyn Fn(f64) -> f64| {
        let samples: Vec<f32> = (0..=u16::MAX).map(|i| curve(f64::from(i) / LARGEST).max(0.0) as f32).collect();
        samples.iter().all(|y| y.is_finite()).then_some(samples)
    };
    if tag.starts_with(b"curv") {
        let count = u32::from_be_bytes(big_endian(tag, 8)?) as usize;
        let numbers = tag.get(12..)?.as_chunks::<2>().0.get(..count)?;
        let at = |i: usize| f64::from(u16::from_be_bytes(numbers[i.min(count - 1)]));
        return match count {
            0 => sampled(&|x| x),
            1 => sampled(&|x| pow(x, at(0) / 256.0)),
            _ => sampled(&|x| {
                let x = x * (count - 1) as f64;
                let i = x as usize;
                (at(i) + (at(i + 1) - at(i)) * (x - i as f64)) / LARGEST
            }),
        };
    }
    let count = match tag.get(..10)? {
        [b'p', b'a', b'r', b'a', .., 0, kind] => *[1, 3, 4, 5, 7].get(usize::from(*kind))?,
        _ => return None,
    };
    let mut numbers = [0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0];
    for (i, number) in numbers[..count].iter_mut().enumerate() {
        *number = fixed(tag, 12 + 4 * i)?;
    }
    if matches!(count, 3 | 4) {
        // Formulas 1 and 2 have a limit of -b / a, and the same constant on both sides.
        let [_, a, b, constant, ..] = numbers;
        numbers = [numbers[0], a, b, 0.0, -b / a, constant, constant];
    }
    let [power, a, b, c, d, e, f] = numbers;
    sampled(&|x| if x >= d { pow((a * x + b).max(0.0), power) + e } else { c * x + f })
}
