//! Twin of `ltc_table.wgsl`.

use std::f32::consts::FRAC_PI_2;

use glam::{Mat3, Vec3};

use crate::preview::ShaderTable;
use ltcforge_fit::{
    ShaderNumbers,
    math::{atan2_upper, sin_cos_turns},
};

/// The floor of both roughnesses, in the numbers of a shader.
pub(super) const LEAST_ALPHA: f32 = ltcforge_fit::LEAST_ALPHA as f32;

struct Fold {
    alpha: f32,
    ratio: f32,
    theta: f32,
    phi: f32,
    mirror: Vec3,
    swap: bool,
}

impl Fold {
    fn of(alpha_x: f32, alpha_y: f32, wo: Vec3) -> Self {
        let (x, y) = (alpha_x.max(LEAST_ALPHA), alpha_y.max(LEAST_ALPHA));
        let swap = y > x;
        let alpha = x.max(y);
        let flat = (wo.x.abs(), wo.y.abs());
        let (phi_y, phi_x) = if swap { flat } else { (flat.1, flat.0) };
        let mirrored = |x: f32| if x < 0.0 { -1.0 } else { 1.0 };
        Self {
            alpha,
            ratio: x.min(y) / alpha,
            theta: atan2_upper((flat.0 * flat.0 + flat.1 * flat.1).sqrt(), wo.z).min(FRAC_PI_2),
            phi: atan2_upper(phi_y, phi_x),
            mirror: Vec3::new(mirrored(wo.x), mirrored(wo.y), 1.0),
            swap,
        }
    }

    fn unfold(&self, folded: Mat3) -> Mat3 {
        let m = if self.swap {
            let yxz = |v: Vec3| Vec3::new(v.y, v.x, v.z);
            Mat3::from_cols(yxz(folded.y_axis), yxz(folded.x_axis), yxz(folded.z_axis))
        } else {
            folded
        };
        let mirror = self.mirror;
        Mat3::from_cols(m.x_axis * mirror * mirror.x, m.y_axis * mirror * mirror.y, m.z_axis * mirror)
    }
}

fn between(nodes: &[f32], x: f32, even: impl Fn(f32) -> f32) -> (usize, f32) {
    let upper = nodes.partition_point(|node| *node <= x);
    if upper == 0 || upper == nodes.len() {
        return (upper.max(1) - 1, 0.0);
    }
    let below = even(nodes[upper - 1]);
    (upper - 1, (even(x) - below) / (even(nodes[upper]) - below))
}

fn turned(m: Mat3, angle: f32) -> Mat3 {
    let (sin, cos) = sin_cos_turns(angle * 0.159_154_94);
    let r = Mat3::from_cols(Vec3::new(cos, sin, 0.0), Vec3::new(-sin, cos, 0.0), Vec3::Z);
    r * m * r.transpose()
}

/// `x`, or the nearest end of an axis.
fn nearest(nodes: &[f32], x: f32) -> f32 {
    x.clamp(nodes[0], nodes[nodes.len() - 1])
}

pub(super) fn lookup(table: &ShaderTable, alpha_x: f32, alpha_y: f32, wo: Vec3) -> ShaderNumbers {
    let fold = Fold::of(alpha_x, alpha_y, wo);
    let nodes = &table.nodes;
    let counts = nodes.lengths();
    let layout = table.layout;
    let place = |axis: usize, nodes: &[f32], x: f32| between(nodes, x, |x| layout.even_in_shader(axis, x));
    let places = [
        place(0, &nodes.alpha, fold.alpha),
        place(1, &nodes.ratio, fold.ratio),
        place(2, &nodes.theta, fold.theta),
        place(3, &nodes.phi, fold.phi),
    ];
    let lasts = [counts.alpha - 1, counts.ratio - 1, counts.theta - 1, counts.phi - 1];
    let mut sum = [[0.0_f32; 4]; 3];
    for corner in 0..16_usize {
        let step = |axis: usize| (corner >> (3 - axis)) & 1;
        let weight = |axis: usize| if step(axis) == 1 { places[axis].1 } else { 1.0 - places[axis].1 };
        let entry = |axis: usize| (places[axis].0 + step(axis)).min(lasts[axis]);
        let weight = weight(0) * weight(1) * weight(2) * weight(3);
        let index = ((entry(0) * counts.ratio + entry(1)) * counts.theta + entry(2)) * counts.phi + entry(3);
        for (sum, texels) in sum.iter_mut().zip(&table.texels) {
            for (sum, number) in sum.iter_mut().zip(texels[index]) {
                *sum += weight * number;
            }
        }
    }
    let [a, b, terms] = sum;
    let m = Mat3::from_cols(Vec3::new(a[0], a[3], b[2]), Vec3::new(a[1], b[0], b[3]), Vec3::new(a[2], b[1], terms[0]));
    // Outside the table's ranges all of it answers as at their nearest end.
    let (near_theta, near_phi) = (nearest(&nodes.theta, fold.theta), nearest(&nodes.phi, fold.phi));
    let view = if near_theta.to_bits() == fold.theta.to_bits() && near_phi.to_bits() == fold.phi.to_bits() {
        let (x, y) = (wo.x.abs(), wo.y.abs());
        if fold.swap { Vec3::new(y, x, wo.z) } else { Vec3::new(x, y, wo.z) }
    } else {
        let (polar, azimuth) = (sin_cos_turns(near_theta * 0.159_154_94), sin_cos_turns(near_phi * 0.159_154_94));
        Vec3::new(polar.0 * azimuth.1, polar.0 * azimuth.0, polar.1)
    };
    let stored = ShaderNumbers { matrix: m, amplitude: terms[1], fresnel: terms[2] };
    let (alpha, ratio) = (nearest(&nodes.alpha, fold.alpha), nearest(&nodes.ratio, fold.ratio));
    let lobe = layout.restore_in_shader(&stored, alpha, ratio, view);
    let m = if table.turns_with_view { turned(lobe.matrix, fold.phi - nodes.phi[0]) } else { lobe.matrix };
    ShaderNumbers { matrix: fold.unfold(m), ..lobe }
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

    /// How far f32 numbers may be from f64 ones: matrices hold numbers of order one.
    const F32: f64 = 1e-5;

    fn check(table: &Table, alpha_x: f64, alpha_y: f64, theta: f64, phi: f64) -> Result<(), TestCaseError> {
        let wanted = table.lookup(&Configuration { alpha_x, alpha_y, theta, phi });
        let wo = direction(theta, phi).as_vec3();
        let found = lookup(&ShaderTable::new(table, TexelFormat::F32), alpha_x as f32, alpha_y as f32, wo);
        let m = DMat3::from_cols_array(&wanted.matrix).transpose();
        prop_assert!(found.matrix.as_dmat3().abs_diff_eq(m, F32), "{} {}", found.matrix, m);
        let terms = [(found.amplitude, wanted.amplitude), (found.fresnel, wanted.fresnel)];
        for (found, wanted) in terms {
            prop_assert!((f64::from(found) - wanted.expect("terms")).abs() < F32, "{} {:?}", found, wanted);
        }
        Ok(())
    }

    proptest! {
        /// A shader fetches the numbers that `ltcforge lookup` prints, outside a table's ranges too.
        #[test]
        fn it_is_the_lookup_of_the_table(
            alpha_x in 1e-3..1.0, alpha_y in 1e-3..1.0, theta in 0.0..1.57, phi in -3.0..3.0,
        ) {
            check(&planted(), alpha_x, alpha_y, theta, phi)?;
            check(&reflected(), alpha_x, alpha_y, theta, phi)?;
            check(&isotropic(), alpha_x, alpha_y, theta, phi)?;
        }
    }
}
