//! The same light by adaptive quadrature over its area: no half vector is ever a variable of integration.

use std::f64::consts::PI;

use super::cases::Case;
use ltcforge_fit::math::{cross, dot, minus, plus, scaled, unit};

/// The positive nodes of Kronrod's rule of order 15 on [-1, 1] with their weights; every other node is Gauss's of order
/// 7 [Piessens et al. 1983].
#[allow(clippy::excessive_precision, reason = "as published")]
const KRONROD: [(f64, f64); 8] = [
    (0.0, 0.209_482_141_084_727_83),
    (0.207_784_955_007_898_47, 0.204_432_940_075_298_89),
    (0.405_845_151_377_397_17, 0.190_350_578_064_785_41),
    (0.586_087_235_467_691_13, 0.169_004_726_639_267_9),
    (0.741_531_185_599_394_44, 0.140_653_259_715_525_92),
    (0.864_864_423_359_769_07, 0.104_790_010_322_250_18),
    (0.949_107_912_342_758_52, 0.063_092_092_629_978_55),
    (0.991_455_371_120_812_6, 0.022_935_322_010_529_22),
];
#[allow(clippy::excessive_precision, reason = "as published")]
const GAUSS: [f64; 4] =
    [0.417_959_183_673_469_4, 0.381_830_050_505_118_94, 0.279_705_391_489_276_7, 0.129_484_966_168_869_7];
/// Cells along each side of a light before the rule adapts, so that no narrow lobe is missed.
const CELLS: u32 = 5;

/// The transmitted light: the visible part, without shadowing of the light; the energy; weighed by `1 - F`; by
/// Schlick's.
pub(super) type Truth = [f64; 4];

/// The light of a parallelogram, to about ten times a tolerance.
pub(super) fn truth(case: &Case, tolerance: f64) -> Truth {
    let [v0, v1, v2, v3] = case.vertices;
    let middle = scaled(plus(v0, v2), 0.5);
    let [x_axis, y_axis] = [minus(v1, v0), minus(v3, v0)].map(|v| scaled(v, 0.5));
    let normal = cross(x_axis, y_axis);
    let at = |x: f64, y: f64| {
        let p = plus(middle, plus(scaled(x_axis, x), scaled(y_axis, y)));
        let distance2 = dot(p, p);
        let solid_angle = dot(normal, p).abs() / (distance2 * distance2.sqrt());
        transmittance(case, unit(p)).map(|f| f * solid_angle)
    };
    let row = |y: f64| cells(&|x| at(x, y), tolerance * 0.1, 14);
    cells(&row, tolerance, 10)
}

/// The BTDF times the cosine below, without `1 / eta^2` [Walter et al. 2007, equation 21].
fn transmittance(case: &Case, wi: [f64; 3]) -> Truth {
    let Case { alpha: [alpha_x, alpha_y], eta, wo, .. } = *case;
    if wi[2] >= 0.0 {
        return [0.0; 4];
    }
    let h = unit(plus(wo, scaled(wi, eta)));
    let h = if h[2] < 0.0 { scaled(h, -1.0) } else { h };
    let (cos_o, cos_i) = (dot(wo, h), -dot(wi, h));
    if cos_o <= 0.0 || cos_i <= 0.0 {
        return [0.0; 4];
    }
    let (x, y) = (h[0] / alpha_x, h[1] / alpha_y);
    let d = 1.0 / (PI * alpha_x * alpha_y * (x * x + y * y + h[2] * h[2]).powi(2));
    let smith_lambda = |w: [f64; 3]| {
        let tan2 = ((alpha_x * w[0]).powi(2) + (alpha_y * w[1]).powi(2)) / (w[2] * w[2]);
        0.5 * ((1.0 + tan2).sqrt() - 1.0)
    };
    let (lambda_o, lambda_i) = (smith_lambda(wo), smith_lambda(wi));
    let unshadowed = d * cos_o * cos_i * eta * eta / (wo[2] * (cos_o - eta * cos_i).powi(2));
    let across = (cos_o - eta * cos_i) / (cos_o + eta * cos_i);
    let along = (cos_i - eta * cos_o) / (cos_i + eta * cos_o);
    let fresnel = 0.5 * (across * across + along * along);
    let head_on = ((eta - 1.0) / (eta + 1.0)).powi(2);
    let schlick = head_on + (1.0 - head_on) * (1.0 - cos_o.min(cos_i)).powi(5);
    let energy = unshadowed / (1.0 + lambda_o + lambda_i);
    [unshadowed / (1.0 + lambda_o), energy, energy * (1.0 - fresnel), energy * (1.0 - schlick)]
}

/// The integral over [-1, 1], from cells of equal width.
fn cells(f: &dyn Fn(f64) -> Truth, tolerance: f64, depth: u32) -> Truth {
    let edge = |i: u32| -1.0 + 2.0 * f64::from(i) / f64::from(CELLS);
    let cell = |i: u32| adaptive(f, edge(i), edge(i + 1), tolerance, depth);
    (0..CELLS).fold([0.0; 4], |sum, i| added(sum, cell(i)))
}

fn adaptive(f: &dyn Fn(f64) -> Truth, low: f64, high: f64, tolerance: f64, depth: u32) -> Truth {
    let (middle, half) = (0.5 * (low + high), 0.5 * (high - low));
    let (mut fine, mut coarse) = ([0.0; 4], [0.0; 4]);
    for (i, (x, weight)) in KRONROD.iter().enumerate() {
        let signs: &[f64] = if i == 0 { &[0.0] } else { &[1.0, -1.0] };
        for sign in signs {
            let value = f(middle + sign * half * x);
            fine = added(fine, value.map(|v| weight * half * v));
            if i % 2 == 0 {
                coarse = added(coarse, value.map(|v| GAUSS[i / 2] * half * v));
            }
        }
    }
    let error = fine.iter().zip(coarse).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    if error < tolerance || depth == 0 {
        return fine;
    }
    let part = |low, high| adaptive(f, low, high, tolerance * 0.6, depth - 1);
    added(part(low, middle), part(middle, high))
}

fn added(a: Truth, b: Truth) -> Truth {
    std::array::from_fn(|i| a[i] + b[i])
}
