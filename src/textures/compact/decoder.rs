//! Makes the textures of a compact form.

use super::coded::{CHANNELS, Coded, MOST_ENTRIES, MOST_POLYNOMIALS};

/// A texture in RGBA. Texels run along x, then y, then z.
#[derive(Debug, Clone, PartialEq)]
pub struct Texture {
    pub name: &'static str,
    pub width: usize,
    pub height: usize,
    pub depth: usize,
    pub texels: Vec<f32>,
}

const CEILING: f64 = 0.9999 * std::f64::consts::FRAC_PI_2;

/// The textures of a compact form: `ltc_matrix_a`, `ltc_matrix_b` and `ltc_terms` for layout `reflected`, `LTC_1` and
/// `LTC_2` for `ltc2017`.
///
/// # Errors
/// The bytes are not a compact form, or have another layout.
pub fn decode(bytes: &[u8]) -> Result<Vec<Texture>, &'static str> {
    let mut reader = Reader { bytes };
    if reader.take::<8>()? != *b"LTCcomp1" {
        return Err("not a compact table of version 1");
    }
    let (_brdf, _lobe, layout) = (reader.name()?, reader.name()?, reader.name()?);
    let is_reflected = match layout {
        b"reflected" => true,
        b"ltc2017" => false,
        _ => return Err("this decoder does not support the layout"),
    };
    let (mut nodes, mut counts, mut ranges) = ([0; 4], [0; 4], [[0.0; 2]; 4]);
    for axis in 0..4 {
        nodes[axis] = usize::from(u16::from_le_bytes(reader.take()?));
        counts[axis] = usize::from(reader.take::<1>()?[0]);
        ranges[axis] = [f64::from_le_bytes(reader.take()?), f64::from_le_bytes(reader.take()?)];
        if counts[axis] < 1 || counts[axis] > nodes[axis].min(MOST_POLYNOMIALS) {
            return Err("invalid number of nodes or polynomials");
        }
    }
    let entries = nodes.iter().try_fold(1_usize, |product, n| product.checked_mul(*n));
    let entries = entries.filter(|entries| *entries <= MOST_ENTRIES).ok_or("too many entries")?;
    if !is_reflected && nodes[1] * nodes[3] != 1 {
        return Err("an isotropic layout must have one ratio and one phi");
    }
    let [stored, corrected] = [u16::from_le_bytes(reader.take()?), u16::from_le_bytes(reader.take()?)];
    let correction_steps = f32::from_le_bytes(reader.take()?);
    let mut steps = [None; CHANNELS];
    for (channel, step) in steps.iter_mut().enumerate() {
        if stored >> channel & 1 == 1 {
            *step = Some(f32::from_le_bytes(reader.take()?));
        }
    }
    let corrected = std::array::from_fn(|channel| corrected >> channel & 1 == 1);
    let coded = Coded { nodes, counts, steps, corrected, correction_steps, bytes: reader.bytes };
    let (mut numbers, left) = coded.numbers().ok_or("the bytes end too early")?;
    if left > 0 {
        return Err("bytes follow the end");
    }

    let has_terms = stored >> 7 != 0;
    let [alpha, ratio, theta, phi] = nodes;
    let texture = |name, [width, height, depth]: [usize; 3]| Texture {
        name,
        width,
        height,
        depth,
        texels: vec![0.0; 4 * entries],
    };
    let put = |texture: &mut Texture, texel: usize, numbers: [f64; 4]| {
        texture.texels[4 * texel..4 * texel + 4].copy_from_slice(&numbers.map(|x| x as f32));
    };
    if is_reflected {
        let size = [phi, ratio * theta, alpha];
        let mut made = ["ltc_matrix_a", "ltc_matrix_b", "ltc_terms"].map(|name| texture(name, size));
        for (i, numbers) in numbers.iter().enumerate() {
            let (t, p) = (i / phi % theta, i % phi);
            let from_above = t == 0 && ranges[2][0] == 0.0;
            let in_x = from_above || p == 0 && ranges[3][0] == 0.0;
            let in_y = from_above || p + 1 == phi && ranges[3][1] == std::f64::consts::FRAC_PI_2;
            let [x, y, z] = beside_reflection(*numbers, in_x, in_y);
            let (amplitude, fresnel) = if has_terms { (numbers[7].max(0.0), numbers[8]) } else { (1.0, 0.0) };
            put(&mut made[0], i, [x[0], y[0], z[0], x[1]]);
            put(&mut made[1], i, [y[1], z[1], x[2], y[2]]);
            put(&mut made[2], i, [z[2], amplitude, fresnel, 0.0]);
        }
        return Ok(made.into());
    }
    let part = |i: usize, n: usize| i as f64 / n.saturating_sub(1).max(1) as f64;
    let mut made = ["LTC_1", "LTC_2"].map(|name| texture(name, [alpha, theta, 1]));
    for (i, numbers) in numbers.iter_mut().enumerate() {
        let (a, t) = (i / theta, i % theta);
        let (roughness, v) = (part(a, alpha), part(t, theta));
        let angle = 2.0 * v.atan2((2.0 - v * v).sqrt());
        let rough = (roughness * roughness).max(1e-4);
        numbers[5] *= rough / (rough + 0.002);
        let s = beside_reflection(*numbers, true, t == 0);
        let lobe = lobe(rough, angle.min(CEILING), s, [numbers[7].max(0.0), numbers[8]]);
        let ([x, y, z], terms) = (lobe.0, if has_terms { lobe.1 } else { [1.0, 0.0] });
        let texel = t * alpha + a;
        let middle = (x[0] * z[2] - x[2] * z[0]) / y[1];
        let [m00, m20, m02, m22] = [z[2], -x[2], -z[0], x[0]].map(|number| (number / middle).clamp(-6e4, 6e4));
        put(&mut made[0], texel, [m00.max(1e-30), m20, m02, m22.max(1e-30)]);
        put(&mut made[1], texel, [terms[0], terms[1], 0.0, clipped_form_factor(2.0 * roughness - 1.0, v)]);
    }
    Ok(made.into())
}

/// The form factor of a spherical cap above the horizon, divided by that of the whole cap straight ahead. `c` is the
/// cosine of the angle between the normal and the cap's middle; `length` is that of its vector form factor.
fn clipped_form_factor(c: f64, length: f64) -> f64 {
    if c.abs() >= length.sqrt() {
        return c.max(0.0);
    }
    let cos_sigma = (1.0 - length).max(0.0).sqrt();
    let met = (length - c * c).max(0.0).sqrt();
    let seen = met.atan2(-cos_sigma * c) * length * c - cos_sigma * met + met.atan2(cos_sigma);
    (seen / (std::f64::consts::PI * length)).max(0.0)
}

/// Takes bytes from the front.
struct Reader<'a> {
    bytes: &'a [u8],
}

impl<'a> Reader<'a> {
    fn take<const N: usize>(&mut self) -> Result<[u8; N], &'static str> {
        let taken = self.bytes.get(..N).ok_or("the bytes end too early")?;
        self.bytes = &self.bytes[N..];
        let mut copied = [0; N];
        copied.copy_from_slice(taken);
        Ok(copied)
    }

    fn name(&mut self) -> Result<&'a [u8], &'static str> {
        let length = usize::from(self.take::<1>()?[0]);
        let name = self.bytes.get(..length).ok_or("the bytes end too early")?;
        self.bytes = &self.bytes[length..];
        Ok(name)
    }
}

/// A matrix of three columns.
type Matrix = [[f64; 3]; 3];

fn times(a: &Matrix, b: &Matrix) -> Matrix {
    b.map(|c| std::array::from_fn(|i| a[0][i] * c[0] + a[1][i] * c[1] + a[2][i] * c[2]))
}

/// The matrix of layout reflected from an entry's numbers; zeros where a lobe is symmetric in a plane.
fn beside_reflection(numbers: [f64; CHANNELS], in_x: bool, in_y: bool) -> Matrix {
    let [p, mut l, q, mut across, mut along, mut row_x, mut row_y, ..] = numbers;
    if in_y {
        (l, across, row_x) = (0.0, 0.0, 0.0);
    }
    if in_x {
        (l, along, row_y) = (0.0, 0.0, 0.0);
    }
    let [across, along] = [across, along].map(|x| x.clamp(-1.0, 1.0));
    let (p, q) = (p.max(0.004), q.max(0.004));
    let (a, b, d) = (p * p, p * l, l * l + q * q);
    let square = across * across + along * along;
    let (x, y, z) = (2.0 * across / (1.0 + square), 2.0 * along / (1.0 + square), (1.0 - square) / (1.0 + square));
    let height = z.max(0.05);
    let (f, g) = ((row_x + x * a + y * b) / height, (row_y + x * b + y * d) / height);
    let k = 1.0 / (1.0 + z);
    let frame = [[1.0 - x * x * k, -x * y * k, -x], [-x * y * k, 1.0 - y * y * k, -y], [x, y, z]];
    let [x, y, z] = times(&frame, &[[a, b, f], [b, d, g], [0.0, 0.0, 1.0]]);
    // Rotate the first two columns so that their upper block is symmetric.
    let (cos, sin) = (x[0] + y[1], x[1] - y[0]);
    let length = (cos * cos + sin * sin).sqrt();
    if length.is_nan() || length <= 0.0 {
        return [x, y, z];
    }
    let (cos, sin) = (cos / length, sin / length);
    [std::array::from_fn(|i| x[i] * cos - y[i] * sin), std::array::from_fn(|i| x[i] * sin + y[i] * cos), z]
}

/// The lobe of an isotropic surface seen from phi 0, and its terms.
fn lobe(alpha: f64, theta: f64, s: Matrix, [amplitude, fresnel]: [f64; 2]) -> (Matrix, [f64; 2]) {
    let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let unit = |v: [f64; 3]| v.map(|element| element / dot(v, v).sqrt());
    let wo = [theta.sin(), 0.0, theta.cos()];
    let [x, y, z] = unit([alpha * wo[0], 0.0, wo[2]]);
    let wm = unit([alpha * x, alpha * y, z + 1.0]);
    let d = dot(wo, wm);
    let r: [f64; 3] = std::array::from_fn(|i| 2.0 * d * wm[i] - wo[i]);
    let column = |axis: usize| -> [f64; 3] {
        let tilt: [f64; 3] = std::array::from_fn(|i| f64::from(u8::from(i == axis)) - wm[axis] * wm[i]);
        let along = dot(wo, tilt);
        std::array::from_fn(|i| 2.0 * alpha * (along * wm[i] + d * tilt[i]))
    };
    let lambda = |w: [f64; 3]| {
        let slope2 = alpha * alpha * (w[0] * w[0] + w[1] * w[1]) / (w[2] * w[2]);
        0.5 * ((1.0 + slope2).sqrt() - 1.0)
    };
    let seen = 1.0 + lambda(wo);
    let g = if r[2] > 0.0 { seen / (seen + lambda(r)) } else { 0.0 };
    let amplitude = amplitude * g * g;
    let terms = [amplitude, amplitude * (fresnel + 1.0 - d).max(0.0).powi(5)];
    (times(&[column(0), column(1), r], &s), terms)
}
