//! Random interfaces and lights, which are the same in every run, and a quadrature over the area of a light. The
//! quadrature never integrates over half vectors.

use std::f64::consts::{PI, TAU};

use rand_core::{Rng, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;
use rayon::prelude::*;

use super::{
    Region, Transmitted,
    arc::{ArcKind, Extent},
    interface::Interface,
    outline::outline,
    transmitted,
};
use ltcforge_fit::{
    Sides,
    math::{Scalar, cross, dot, minus, plus, scaled, unit},
};

/// A rectangle seen through an interface.
#[derive(Debug, Clone, Copy)]
pub(super) struct Case {
    pub(super) alpha: [f64; 2],
    pub(super) eta: f64,
    pub(super) wo: [f64; 3],
    pub(super) vertices: [[f64; 3]; 4],
}

/// The distribution of random cases.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Set {
    /// One roughness from 0.05 to 1. The light is where a random normal refracts the view.
    Isotropic,
    /// Like [`Self::Isotropic`], with two roughnesses.
    Anisotropic,
    /// Roughness from .001 to .05.
    Sharp,
    /// Cut at the surface.
    Cut,
    /// Clipped where normals become perpendicular to the view or the light.
    Facing,
    /// Clipped where normals become parallel to the surface.
    Horizon,
    /// A light in any direction below.
    Anywhere,
    /// A light a hundred times larger than its distance.
    Huge,
}

/// The closed form in f64 and f32, with the numbers of [`Truth`]: the visible part first.
impl Case {
    pub(super) fn model(&self) -> Truth {
        let of = |x| x;
        self.evaluated::<f64>(of, of)
    }

    pub(super) fn model32(&self) -> Truth {
        self.evaluated::<f32>(|x| x as f32, f64::from)
    }

    fn evaluated<T: Scalar>(&self, of: impl Fn(f64) -> T, to: impl Fn(T) -> f64) -> Truth {
        let vertices = self.vertices.map(|v| v.map(&of));
        let (alpha, wo, eta) = (self.alpha.map(&of), self.wo.map(&of), of(self.eta));
        let interface = Interface::new(alpha, wo, eta);
        let visible = Region::new(&interface, &outline(&interface, &vertices, Sides::Two)).part(&interface);
        let Transmitted { energy, dielectric, schlick } = transmitted(alpha, wo, eta, &vertices, Sides::Two);
        [visible, energy, dielectric, schlick].map(to)
    }

    /// The kinds and extents of the outline's arcs.
    pub(super) fn kinds(&self) -> Vec<(ArcKind, Extent)> {
        let interface = Interface::new(self.alpha, self.wo, self.eta);
        outline(&interface, &self.vertices, Sides::Two).iter().map(|arc| (arc.kind, arc.extent)).collect()
    }

    fn has(&self, kinds: &[ArcKind]) -> bool {
        self.kinds().iter().any(|(kind, _)| kinds.contains(kind))
    }
}

/// Random numbers, the same in every run.
pub(super) struct Draw(Xoshiro256PlusPlus);

impl Draw {
    pub(super) fn new(seed: u64) -> Self {
        Self(Xoshiro256PlusPlus::seed_from_u64(seed))
    }

    pub(super) fn within(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * ((self.0.next_u64() >> 11) as f64 / (1_u64 << 53) as f64)
    }

    /// A number whose logarithm is uniform.
    pub(super) fn scale(&mut self, low: f64, high: f64) -> f64 {
        low * (high / low).powf(self.within(0.0, 1.0))
    }

    fn normal(&mut self) -> f64 {
        (-2.0 * self.within(1e-12, 1.0).ln()).sqrt() * self.within(0.0, TAU).cos()
    }

    fn vector(&mut self) -> [f64; 3] {
        [self.normal(), self.normal(), self.normal()]
    }

    pub(super) fn view(&mut self, steepest: f64) -> [f64; 3] {
        let (theta, phi) = (self.within(0.0, steepest), self.within(0.0, TAU));
        [theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos()]
    }

    /// A direction that a visible normal refracts to `wo` [Heitz 2018, Dupuy and Benyoub 2023]; `None` if the normal
    /// reflects totally or the direction is above the surface.
    pub(super) fn refracted(&mut self, [alpha_x, alpha_y]: [f64; 2], wo: [f64; 3], eta: f64) -> Option<[f64; 3]> {
        let view = unit([alpha_x * wo[0], alpha_y * wo[1], wo[2]]);
        let z = (1.0 - self.within(0.0, 1.0)) * (1.0 + view[2]) - view[2];
        let (sin, phi) = ((1.0 - z * z).max(0.0).sqrt(), self.within(0.0, TAU));
        let c = plus(view, [sin * phi.cos(), sin * phi.sin(), z]);
        let h = unit([alpha_x * c[0], alpha_y * c[1], c[2]]);
        let cos_o = dot(wo, h);
        let cosine2 = eta * eta - 1.0 + cos_o * cos_o;
        if cosine2 < 0.0 || cos_o < 0.0 {
            return None;
        }
        let wi = scaled(minus(scaled(h, cos_o - cosine2.sqrt()), wo), 1.0 / eta);
        (wi[2] < 0.0).then_some(wi)
    }

    /// A rectangle with these half axes around a direction, tilted at random.
    pub(super) fn rectangle(&mut self, around: [f64; 3], [width, height]: [f64; 2]) -> [[f64; 3]; 4] {
        let lean = scaled(self.vector(), 0.5);
        let normal = unit(minus(lean, around));
        let x = unit(cross(normal, self.vector()));
        let y = scaled(cross(normal, x), height);
        let x = scaled(x, width);
        [minus(minus(around, x), y), minus(plus(around, x), y), plus(plus(around, x), y), plus(minus(around, x), y)]
    }

    /// A random case of a set.
    pub(super) fn case(&mut self, set: Set, eta: f64) -> Case {
        loop {
            let (low, high) = if set == Set::Sharp { (0.001, 0.05) } else { (0.05, 1.0) };
            let a = if self.within(0.0, 1.0) < 0.5 { self.scale(low, high) } else { self.within(low, high) };
            let b = self.scale(low, high);
            let alpha = [a, if set == Set::Isotropic { a } else { b }];
            let wo = self.view(88_f64.to_radians());
            let Some(around) = self.refracted(alpha, wo, eta) else { continue };
            let [x, y, z] = self.vector();
            let around = if set == Set::Anywhere { unit([x, y, -z.abs()]) } else { around };
            let size = if set == Set::Huge { 50.0 } else { self.scale(0.05, 1.2) };
            let aspect = self.within(-1.0, 1.0).exp();
            let vertices = self.rectangle(around, [size * aspect, size / aspect]);
            let case = Case { alpha, eta, wo, vertices };
            let is_wanted = match set {
                Set::Cut => vertices.iter().any(|v| v[2] > 0.0),
                Set::Facing => case.has(&[ArcKind::Grazing, ArcKind::Critical]),
                Set::Horizon => case.has(&[ArcKind::Horizon]),
                _ => true,
            };
            // The quadrature fails for a light that almost touches the shaded point.
            let normal = unit(cross(minus(vertices[1], vertices[0]), minus(vertices[3], vertices[0])));
            if is_wanted && (set == Set::Huge || dot(normal, around).abs() > 0.05) {
                return case;
            }
        }
    }
}

/// The positive nodes and weights of Kronrod's rule of order 15 on [-1, 1]. Every other node belongs to Gauss's rule of
/// order 7 [Piessens et al. 1983].
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
/// Cells along each side of a light before the rule adapts. They ensure that narrow lobes are found.
const CELLS: u32 = 5;

/// The transmitted light: the visible part, without shadowing of the light; the energy; the energy weighted by `1 - F`;
/// the energy weighted by Schlick's approximation.
pub(super) type Truth = [f64; 4];

/// The light of a parallelogram, with an error of up to about ten times the tolerance.
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

/// The BTDF times the cosine of the light, without the factor `1 / eta^2` [Walter et al. 2007, equation 21].
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

/// The mean and the largest of some numbers.
pub(super) fn mean_and_max(numbers: impl Iterator<Item = f64>) -> [f64; 2] {
    let numbers: Vec<f64> = numbers.collect();
    let sum: f64 = numbers.iter().sum();
    [sum / numbers.len() as f64, numbers.into_iter().fold(0.0, f64::max)]
}

/// The mean and the largest difference from the quadrature, for the visible part, the energy, and the energy with both
/// Fresnel terms.
///
/// # Panics
/// If at least three quarters of the lights of a set are dark.
#[must_use]
pub fn errors(set: Set, eta: f64, count: usize, tolerance: f64) -> [[f64; 2]; 4] {
    let mut draw = Draw::new(77);
    let cases: Vec<Case> = (0..count).map(|_| draw.case(set, eta)).collect();
    let pairs: Vec<(Truth, Truth)> = cases.par_iter().map(|case| (truth(case, tolerance), case.model())).collect();
    assert!(pairs.iter().filter(|(truth, _)| truth[1] > 1e-3).count() > count / 4, "{set:?} is dark");
    std::array::from_fn(|i| mean_and_max(pairs.iter().map(|(truth, model)| (truth[i] - model[i]).abs())))
}

/// The mean and the largest of the differences between f32 and f64, for random lights whose longer half side is 0.002
/// to 50 times their distance.
#[must_use]
pub fn f32_errors(etas: [f64; 2], alphas: [f64; 2], count: usize) -> [f64; 2] {
    let mut draw = Draw::new(3);
    let mut cases = Vec::with_capacity(count);
    while cases.len() < count {
        let [low, high] = etas;
        let eta = draw.within(low, high);
        let alpha = [draw.scale(alphas[0], alphas[1]), draw.scale(alphas[0], alphas[1])];
        let wo = draw.view(1.569);
        let Some(around) = draw.refracted(alpha, wo, eta) else { continue };
        let size = draw.scale(0.002, 50.0);
        let aspect = draw.within(0.0, 1.0);
        cases.push(Case { alpha, eta, wo, vertices: draw.rectangle(around, [size, size * aspect]) });
    }
    let error = |case: &Case| {
        let pairs = case.model().into_iter().zip(case.model32());
        pairs.map(|(a, b)| if (a - b).is_finite() { (a - b).abs() } else { 9.0 }).fold(0.0, f64::max)
    };
    let errors: Vec<f64> = cases.par_iter().map(error).collect();
    mean_and_max(errors.into_iter())
}
