//! Random surfaces and lights, the same in every run, a quadrature over a light's area, and where a function jumps.

use std::f64::consts::TAU;

use glam::DVec3;
use rand_core::{Rng, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

use crate::PolygonLight;
use ltcforge_fit::{
    BrdfModel, Configuration, Layout, LobeModel, PerAxis, Sides, Table,
    brdf::{Brdf, Ggx},
    math::direction,
};

/// A surface, a view of it, and the vertices of a light.
#[derive(Debug, Clone)]
pub struct Lit {
    /// The surface, and from where it is seen.
    pub at: Configuration,
    /// The corners of the light.
    pub vertices: Vec<DVec3>,
}

impl Lit {
    /// The light.
    ///
    /// # Panics
    /// For corners that are not those of a convex polygon.
    #[must_use]
    pub fn light(&self, sides: Sides) -> PolygonLight {
        PolygonLight::new(self.vertices.clone(), sides).expect("convex")
    }

    /// GGX roughness along x and y.
    #[must_use]
    pub fn alpha(&self) -> [f64; 2] {
        [self.at.alpha_x, self.at.alpha_y]
    }

    /// The view direction.
    #[must_use]
    pub fn wo(&self) -> DVec3 {
        direction(self.at.theta, self.at.phi)
    }

    /// The same scene told in other ways: as it is and mirrored by x, by y, by both and by the diagonal, each from
    /// every corner of the light on, in both orders.
    pub fn tellings(&self) -> impl Iterator<Item = Self> + '_ {
        let mirrored = MIRRORS.iter().map(|(phi, is_swapped, mirror)| {
            let Configuration { alpha_x, alpha_y, theta, phi: own } = self.at;
            let [alpha_x, alpha_y] = if *is_swapped { [alpha_y, alpha_x] } else { [alpha_x, alpha_y] };
            let at = Configuration { alpha_x, alpha_y, theta, phi: phi(own) };
            Self { at, vertices: self.vertices.iter().map(|v| mirror(*v)).collect() }
        });
        mirrored.flat_map(|lit| {
            let orders = (0..lit.vertices.len()).flat_map(|from| [(from, false), (from, true)]);
            let told: Vec<Self> = orders
                .map(|(from, is_reversed)| {
                    let mut vertices = lit.vertices.clone();
                    vertices.rotate_left(from);
                    if is_reversed {
                        vertices.reverse();
                    }
                    Self { vertices, ..lit }
                })
                .collect();
            told
        })
    }
}

/// What a mirror does to an azimuth, whether it swaps x and y, and what it does to a vector.
type Mirror = (fn(f64) -> f64, bool, fn(DVec3) -> DVec3);

/// No mirror, those of the tangent frame's axes, and that of its diagonal.
const MIRRORS: [Mirror; 5] = [
    (|phi| phi, false, |v| v),
    (|phi| 0.5 * TAU - phi, false, |v| DVec3::new(-v.x, v.y, v.z)),
    (|phi| -phi, false, |v| DVec3::new(v.x, -v.y, v.z)),
    (|phi| 0.5 * TAU + phi, false, |v| DVec3::new(-v.x, -v.y, v.z)),
    (|phi| 0.25 * TAU - phi, true, |v| DVec3::new(v.y, v.x, v.z)),
];

/// A table with the clamped cosine in place of every lobe of a model.
#[must_use]
pub fn cosine(brdf: BrdfModel) -> Table {
    Table {
        brdf,
        lobe: LobeModel::Ltc,
        layout: Layout::Kt2022,
        axes: PerAxis { alpha: vec![1.0], ratio: vec![1.0], theta: vec![0.0], phi: vec![0.0] },
        matrix: vec![[1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]],
        terms: None,
        second: None,
        node_error: vec![0.0],
    }
}

/// Which roughnesses are drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Roughness {
    /// alpha 0.01 to 1, ratio 0 to 1.
    All,
    /// alpha 0.1 to 0.6, ratio 0.03 to 0.23.
    Anisotropic,
    /// alpha and ratio over decades, from 1e-4 and 1e-2.
    Extreme,
}

/// Draws surfaces and lights.
#[derive(Debug)]
pub struct Draw(Xoshiro256PlusPlus);

impl Draw {
    /// The same draws in every run.
    #[must_use]
    pub fn new(seed: u64) -> Self {
        Self(Xoshiro256PlusPlus::seed_from_u64(seed))
    }

    /// A number between two.
    pub fn within(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * ((self.0.next_u64() >> 11) as f64 / (1_u64 << 53) as f64)
    }

    fn normal(&mut self) -> f64 {
        (-2.0 * (1.0 - self.within(0.0, 1.0)).ln()).sqrt() * self.within(0.0, TAU).cos()
    }

    /// A vector of independent normal components.
    pub fn vector(&mut self) -> DVec3 {
        DVec3::new(self.normal(), self.normal(), self.normal())
    }

    /// A random surface seen from above 88 degrees.
    pub fn configuration(&mut self, roughness: Roughness) -> Configuration {
        let [alpha, ratio] = match roughness {
            Roughness::All => [self.within(0.0, 1.0).powi(2).max(0.01), self.within(0.0, 1.0)],
            Roughness::Anisotropic => [self.within(0.1, 0.6), self.within(0.03, 0.23)],
            Roughness::Extreme => [10_f64.powf(self.within(-4.0, 0.0)), 10_f64.powf(self.within(-2.0, 0.0))],
        };
        let least = if roughness == Roughness::Extreme { 1e-5 } else { 0.005 };
        let (long, short) = (alpha, (alpha * ratio).max(least));
        let is_along_x = self.within(0.0, 1.0) < 0.5;
        let [alpha_x, alpha_y] = if is_along_x { [long, short] } else { [short, long] };
        let most = if roughness == Roughness::Extreme { 89.9 } else { 88.0_f64 };
        Configuration { alpha_x, alpha_y, theta: self.within(0.0, most.to_radians()), phi: self.within(0.0, TAU) }
    }

    /// A rectangle, half as wide as 0.05 to 1.2 times up to e, at distance one around a direction that the lobe
    /// reflects.
    pub fn lit(&mut self, roughness: Roughness) -> Lit {
        self.lit_by(roughness, [0.05, 1.2])
    }

    /// The same for another range of half widths.
    pub fn lit_by(&mut self, roughness: Roughness, [least, most]: [f64; 2]) -> Lit {
        loop {
            let at = self.configuration(roughness);
            let wo = direction(at.theta, at.phi);
            let ggx = Ggx { alpha_x: at.alpha_x, alpha_y: at.alpha_y };
            let centre = ggx.sample(wo, [self.within(0.0, 1.0), self.within(0.0, 1.0)]).wi;
            if centre.z < 0.0 {
                continue;
            }
            let size = self.within(least.ln(), most.ln()).exp();
            let aspect = self.within(-1.0, 1.0).exp();
            let normal = (-centre + 0.5 * self.vector()).normalize();
            let x = normal.cross(self.vector()).normalize();
            let y = normal.cross(x);
            let (x, y) = (x * size * aspect, y * size / aspect);
            return Lit { at, vertices: vec![centre - x - y, centre + x - y, centre + x + y, centre - x + y] };
        }
    }

    /// An upright rectangle across from the viewer. The middle of its lower edge is `foot` times its height above the
    /// surface, one end of that edge `tilt` times as much higher and the other lower.
    pub fn wall(&mut self, roughness: Roughness, foot: f64, tilt: f64) -> Lit {
        let at = self.configuration(roughness);
        let towards = at.phi + TAU * self.within(0.4, 0.6);
        let middle = DVec3::new(towards.cos(), towards.sin(), 0.0) * self.within(0.3, 2.0);
        let x = DVec3::new(-towards.sin(), towards.cos(), 0.0) * self.within(0.1, 1.2);
        let top = DVec3::Z * self.within(0.1, 2.0);
        let (low, x) = (middle + top * foot, x + top * tilt);
        Lit { at, vertices: vec![low - x, low + x, low + x + top, low - x + top] }
    }

    /// Several rectangles.
    #[must_use]
    pub fn many(seed: u64, count: usize, roughness: Roughness) -> Vec<Lit> {
        let mut draw = Self::new(seed);
        (0..count).map(|_| draw.lit(roughness)).collect()
    }
}

/// A hundredth of a path is halved so often that lobes of roughness 1e-5 change over it by 1e-8.
const HALVINGS: u32 = 36;

/// The largest change of a function over an interval in [0, 1] that is as good as a point: halves of the three of a
/// hundred intervals over which it changes most, each time the half over which it changes more.
#[must_use]
pub fn jump(of: impl Fn(f64) -> f64) -> f64 {
    let mut steps: Vec<[f64; 2]> = (0..100).map(|i| [i, i + 1].map(|i| f64::from(i) / 100.0)).collect();
    let change = |[from, to]: [f64; 2]| (of(to) - of(from)).abs();
    steps.sort_by_cached_key(|step| std::cmp::Reverse((change(*step) * 1e12) as u64));
    let narrowed = steps.into_iter().take(3).map(|mut step| {
        for _ in 0..HALVINGS {
            let middle = 0.5 * (step[0] + step[1]);
            let halves = [[step[0], middle], [middle, step[1]]];
            step = if change(halves[0]) > change(halves[1]) { halves[0] } else { halves[1] };
        }
        change(step)
    });
    narrowed.fold(0.0, f64::max)
}

/// The light of a parallelogram of radiance one that GGX reflects, by [`over_area_of`].
#[cfg(test)]
pub(super) fn over_area(lit: &Lit, n: u32) -> [f64; 2] {
    over_area_of(&Ggx { alpha_x: lit.at.alpha_x, alpha_y: lit.at.alpha_y }, lit, n)
}

/// The reflected light of a parallelogram of radiance one, by the midpoint rule on its area with `n` by `n` cells and
/// the BRDF itself: for a Fresnel factor of one, and weighed by Schlick's fifth power.
#[cfg(test)]
pub(super) fn over_area_of(brdf: &dyn Brdf, lit: &Lit, n: u32) -> [f64; 2] {
    let wo = lit.wo();
    let [corner, next, _, last] = lit.vertices[..] else { panic!("four vertices") };
    let (x, y) = (next - corner, last - corner);
    let area = x.cross(y);
    let mut sum = [0.0; 2];
    for i in 0..n {
        for j in 0..n {
            let at = |k: u32| (f64::from(k) + 0.5) / f64::from(n);
            let place = corner + x * at(i) + y * at(j);
            let distance2 = place.length_squared();
            let wi = place / distance2.sqrt();
            let solid_angle = wi.dot(area).abs() / distance2 / f64::from(n * n);
            let energy = brdf.eval_cos(wo, wi) * solid_angle;
            let cosine = wo.dot((wo + wi).normalize()).min(1.0);
            sum = [sum[0] + energy, sum[1] + energy * (1.0 - cosine).powi(5)];
        }
    }
    sum
}
