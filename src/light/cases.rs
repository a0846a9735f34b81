//! Random surfaces and lights for tests and studies, a quadrature over a light's area, and a search for jumps of a
//! function. The random numbers are the same in every run.

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
    /// The surface and the view.
    pub at: Configuration,
    /// The corners of the light.
    pub vertices: Vec<DVec3>,
}

impl Lit {
    /// The light.
    ///
    /// # Panics
    /// If the corners do not form a convex polygon.
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

    /// Equivalent descriptions of the scene: unchanged, and mirrored in x, in y, in both and in the diagonal, each with
    /// vertices that start at every corner, in both orders.
    pub fn variants(&self) -> impl Iterator<Item = Self> + '_ {
        let mirrored = MIRRORS.iter().map(|(phi, is_swapped, mirror)| {
            let Configuration { alpha_x, alpha_y, theta, phi: own } = self.at;
            let [alpha_x, alpha_y] = if *is_swapped { [alpha_y, alpha_x] } else { [alpha_x, alpha_y] };
            let at = Configuration { alpha_x, alpha_y, theta, phi: phi(own) };
            Self { at, vertices: self.vertices.iter().map(|v| mirror(*v)).collect() }
        });
        mirrored.flat_map(|lit| {
            let orders = (0..lit.vertices.len()).flat_map(|from| [(from, false), (from, true)]);
            let reordered: Vec<Self> = orders
                .map(|(from, is_reversed)| {
                    let mut vertices = lit.vertices.clone();
                    vertices.rotate_left(from);
                    if is_reversed {
                        vertices.reverse();
                    }
                    Self { vertices, ..lit }
                })
                .collect();
            reordered
        })
    }
}

/// The map of azimuths, whether x and y are swapped, and the map of vectors.
type Mirror = (fn(f64) -> f64, bool, fn(DVec3) -> DVec3);

/// The identity, the mirrors of the tangent frame's axes, and the mirror of its diagonal.
const MIRRORS: [Mirror; 5] = [
    (|phi| phi, false, |v| v),
    (|phi| 0.5 * TAU - phi, false, |v| DVec3::new(-v.x, v.y, v.z)),
    (|phi| -phi, false, |v| DVec3::new(v.x, -v.y, v.z)),
    (|phi| 0.5 * TAU + phi, false, |v| DVec3::new(-v.x, -v.y, v.z)),
    (|phi| 0.25 * TAU - phi, true, |v| DVec3::new(v.y, v.x, v.z)),
];

/// A table whose lobes are all the clamped cosine.
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

/// The distribution of random roughnesses.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Roughness {
    /// alpha 0.01 to 1, ratio 0 to 1.
    All,
    /// alpha 0.1 to 0.6, ratio 0.03 to 0.23.
    Anisotropic,
    /// alpha 1e-4 to 1, ratio 1e-2 to 1; their logarithms are uniform.
    Extreme,
}

/// Draws surfaces and lights.
#[derive(Debug)]
pub struct Draw(Xoshiro256PlusPlus);

impl Draw {
    /// A generator that draws the same numbers in every run.
    #[must_use]
    pub fn new(seed: u64) -> Self {
        Self(Xoshiro256PlusPlus::seed_from_u64(seed))
    }

    /// A number between `low` and `high`.
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

    /// A random surface and view. The view is at most 88 degrees from the normal, or 89.9 for [`Roughness::Extreme`].
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

    /// A rectangle at distance one, around a direction that the lobe reflects. Its size is 0.05 to 1.2. One half width
    /// is the size times a factor from 1/e to e, and the other is the size divided by this factor.
    pub fn lit(&mut self, roughness: Roughness) -> Lit {
        self.lit_by(roughness, [0.05, 1.2])
    }

    /// Like [`Draw::lit`], with another range of sizes.
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

    /// An upright rectangle opposite to the viewer. The centre of its lower edge is at a height of `foot` times the
    /// rectangle's height. The ends of this edge are `tilt` times this height above and below its centre.
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

/// The number of halvings of a hundredth of a path. Over the last interval, lobes of roughness 1e-5 change by 1e-8.
const HALVINGS: u32 = 36;

/// The largest change of a function over a tiny interval in [0, 1]. The search starts with the three of a hundred
/// intervals over which the function changes most. It halves each interval repeatedly and keeps the half with the
/// larger change.
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

/// The light of a parallelogram of radiance one reflected by GGX, computed by [`over_area_of`].
#[cfg(test)]
pub(super) fn over_area(lit: &Lit, n: u32) -> [f64; 2] {
    over_area_of(&Ggx { alpha_x: lit.at.alpha_x, alpha_y: lit.at.alpha_y }, lit, n)
}

/// The reflected light of a parallelogram of radiance one, for a Fresnel factor of one and weighted by Schlick's fifth
/// power. It evaluates the BRDF with the midpoint rule on `n` by `n` cells of the area.
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
