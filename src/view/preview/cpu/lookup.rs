//! Twin of `ltc_table.wgsl` and `ltc_lookup.wgsl`.

use glam::{Mat3, Vec2, Vec3};

use crate::preview::ShaderTable;
use ltcforge_fit::{ShaderAxes, ShaderNumbers};

/// The least value of both roughnesses, as an f32 number.
pub(super) const LEAST_ALPHA: f32 = ltcforge_fit::LEAST_ALPHA as f32;

struct Fold {
    alpha: f32,
    ratio: f32,
    wo: Vec3,
    x: Vec2,
    y: Vec2,
}

impl Fold {
    fn of(axes: &ShaderAxes, alpha_x: f32, alpha_y: f32, wo: Vec3) -> Self {
        let (x, y) = (alpha_x.max(LEAST_ALPHA), alpha_y.max(LEAST_ALPHA));
        let swap = y > x;
        let larger = x.max(y);
        let [least, most, least_ratio, most_ratio] = axes.roughness;
        let mirrored = |x: f32| if x < 0.0 { -1.0 } else { 1.0 };
        let mirror = [Vec2::X * mirrored(wo.x), Vec2::Y * mirrored(wo.y)];
        let [frame_x, frame_y] = if swap { [mirror[1], mirror[0]] } else { mirror };
        let upright = wo.truncate().abs();
        let flat = (if swap { Vec2::new(upright.y, upright.x) } else { upright }) + Vec2::new(1e-18, 0.0);
        let ahead = flat / flat.dot(flat).sqrt();
        let [first_x, first_y, last_x, last_y] = axes.azimuths;
        let (first, last) = (Vec2::new(first_x, first_y), Vec2::new(last_x, last_y));
        let mut towards = ahead;
        if first.x * ahead.y < first.y * ahead.x {
            towards = first;
        }
        if last.x * ahead.y > last.y * ahead.x {
            towards = last;
        }
        let height = wo.z.max(axes.cosines[0]).min(axes.cosines[1]);
        let is_within = height.to_bits() == wo.z.to_bits();
        let size = if is_within { flat.dot(ahead) } else { (1.0 - height * height).sqrt() };
        let fold = Self {
            alpha: larger.max(least).min(most),
            ratio: (x.min(y) / larger).max(least_ratio).min(most_ratio),
            wo: (towards * size).extend(height),
            x: frame_x,
            y: frame_y,
        };
        if axes.reading[1] == 0 {
            return fold;
        }
        let turn = Vec2::new(first.dot(ahead), first.perp_dot(ahead));
        Self { x: turn.x * fold.x + turn.y * fold.y, y: turn.x * fold.y - turn.y * fold.x, ..fold }
    }

    fn unfold(&self, folded: Mat3) -> Mat3 {
        let f = Mat3::from_cols(self.x.extend(0.0), self.y.extend(0.0), Vec3::Z);
        f * folded * f.transpose()
    }
}

pub(super) fn lookup(table: &ShaderTable, alpha_x: f32, alpha_y: f32, wo: Vec3) -> ShaderNumbers {
    lobe_at(table, alpha_x, alpha_y, wo, 0)
}

/// Both lobes of a table: all numbers of the first lobe, and the matrix of the second.
pub(super) fn lookup_both(table: &ShaderTable, alpha_x: f32, alpha_y: f32, wo: Vec3) -> (ShaderNumbers, Mat3) {
    let second = lobe_at(table, alpha_x, alpha_y, wo, table.axes.reading[2] as usize);
    (lookup(table, alpha_x, alpha_y, wo), second.matrix)
}

/// Twin of `ltc_blend`.
pub(super) fn blend(first: &ShaderNumbers, second: Mat3, f0: f32, f90: f32) -> Mat3 {
    let weighed = (f90 - f0).max(0.0) * first.fresnel;
    let w = weighed / (f0 * first.amplitude + weighed).max(1e-30);
    first.matrix * (1.0 - w) + second * w
}

/// The index of the nearest material in `(sqrt(alpha), ratio)`. Twin of the loop of `ltc_place_materials`.
fn nearest_material(table: &ShaderTable, fold: &Fold) -> usize {
    let [materials, _, theta, phi] = table.axes.nodes.map(|n| n as usize);
    let beside = |material: usize, row: usize| table.texels[2][(material * theta + row) * phi][3];
    let away = |material: usize| {
        let (alpha, ratio) = (beside(material, 0), beside(material, 1));
        Vec2::new(alpha.sqrt() - fold.alpha.sqrt(), ratio - fold.ratio).length_squared()
    };
    let nearer = |best: (usize, f32), next: (usize, f32)| if next.1 < best.1 { next } else { best };
    (0..materials).map(|material| (material, away(material))).fold((0, 1e30), nearer).0
}

/// The lobe whose texels start at `layer`.
fn lobe_at(table: &ShaderTable, alpha_x: f32, alpha_y: f32, wo: Vec3, layer: usize) -> ShaderNumbers {
    let (axes, layout) = (&table.axes, table.layout);
    let fold = Fold::of(axes, alpha_x, alpha_y, wo);
    let alpha = if layout.is_of_materials() { nearest_material(table, &fold) as f32 } else { fold.alpha };
    let place = layout.place_in_shader(axes, alpha, fold.ratio, fold.wo);
    let counts = axes.nodes.map(|n| n as usize);
    let mut sum = [[0.0_f32; 4]; 3];
    for corner in 0..16_usize {
        let step = |axis: usize| (corner >> (3 - axis)) & 1;
        let weight = |axis: usize| if step(axis) == 1 { place.weight[axis] } else { 1.0 - place.weight[axis] };
        let entry = |axis: usize| (place.lower[axis] as usize + step(axis)).min(counts[axis] - 1);
        let weight = weight(0) * weight(1) * weight(2) * weight(3);
        let index = (((entry(0) + layer) * counts[1] + entry(1)) * counts[2] + entry(2)) * counts[3] + entry(3);
        for (sum, texels) in sum.iter_mut().zip(&table.texels) {
            for (sum, number) in sum.iter_mut().zip(texels[index]) {
                *sum += weight * number;
            }
        }
    }
    let [a, b, terms] = sum;
    let m = Mat3::from_cols(Vec3::new(a[0], a[3], b[2]), Vec3::new(a[1], b[0], b[3]), Vec3::new(a[2], b[1], terms[0]));
    let stored = ShaderNumbers { matrix: m, amplitude: terms[1], fresnel: terms[2] };
    let lobe = layout.restore_in_shader(&stored, fold.alpha, fold.ratio, fold.wo);
    ShaderNumbers { matrix: fold.unfold(lobe.matrix), ..lobe }
}

#[cfg(test)]
mod tests {
    use glam::DMat3;
    use proptest::prelude::*;

    use super::*;
    use crate::preview::{
        TexelFormat,
        tests::{isotropic, planted, reflected},
    };
    use ltcforge_fit::{Configuration, Table, math::direction};

    /// The tolerance for f32 against f64. Matrix elements are of order one.
    const F32: f64 = 1e-5;

    fn check(table: &Table, alpha_x: f64, alpha_y: f64, theta: f64, phi: f64) -> Result<(), TestCaseError> {
        let expected = table.lookup(&Configuration { alpha_x, alpha_y, theta, phi });
        let wo = direction(theta, phi).as_vec3();
        let found = lookup(&ShaderTable::new(table, TexelFormat::F32), alpha_x as f32, alpha_y as f32, wo);
        let m = DMat3::from_cols_array(&expected.matrix).transpose();
        prop_assert!(found.matrix.as_dmat3().abs_diff_eq(m, F32), "{} {}", found.matrix, m);
        let terms = [(found.amplitude, expected.amplitude), (found.fresnel, expected.fresnel)];
        for (found, expected) in terms {
            prop_assert!((f64::from(found) - expected.expect("terms")).abs() < F32, "{} {:?}", found, expected);
        }
        Ok(())
    }

    proptest! {
        /// A shader fetches the numbers that `ltcforge lookup` prints, even outside the table's ranges.
        #[test]
        fn it_equals_the_lookup_of_the_table(
            alpha_x in 1e-3..1.0, alpha_y in 1e-3..1.0, theta in 0.0..1.57, phi in -3.0..3.0,
        ) {
            check(&planted(), alpha_x, alpha_y, theta, phi)?;
            check(&reflected(), alpha_x, alpha_y, theta, phi)?;
            check(&isotropic(), alpha_x, alpha_y, theta, phi)?;
        }
    }
}
