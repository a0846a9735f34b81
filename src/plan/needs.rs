//! The lobes of a scene that one table, with one scattering model, covers.

use std::f64::consts::FRAC_PI_2;

use glam::DVec3;

use crate::{
    histogram::{LEAST_METAL, Spot, pick, span},
    scene::{LobeKind, Place, Scene, SceneLobe},
};
use ltcforge_fit::{BrdfKind, Configuration, MOST_MATERIALS, PerAxis, WeightedF0, math::recurrence4};

/// The start of the sequence of configurations.
const SHIFT: [f64; 4] = [0.5, 0.236_067_977_499_79, 0.732_050_807_568_877, 0.645_751_311_064_59];
/// The smallest reflectance that a lobe can be fitted for.
const LEAST_F0: f64 = 1e-3;
/// Ranges of angles and reflectances are rounded to multiples of `1 / ROUNDED_TO`.
const ROUNDED_TO: f64 = 1000.0;

/// The lobes of a scene that one table covers.
#[derive(Debug, Clone)]
pub struct Needs<'a> {
    pub(crate) scene: &'a Scene,
    /// The lobes, each with the index of its material.
    pub(crate) lobes: Vec<(usize, &'a SceneLobe)>,
    /// The scattering model.
    pub(crate) brdf: BrdfKind,
    /// The ranges of all lobes.
    pub(crate) range: PerAxis<[f64; 2]>,
}

impl Place {
    /// Reflectance at normal incidence divided by the reflectance at grazing incidence.
    pub(crate) fn f0(&self) -> f64 {
        rounded_f0(self.fresnel[0] / self.fresnel[1])
    }
}

impl<'a> Needs<'a> {
    /// The lobes of GGX, or of sheen if `sheen` is true. `None` if the scene has no such lobe.
    #[must_use]
    pub fn of(scene: &'a Scene, sheen: bool) -> Option<Self> {
        let lobes: Vec<_> = scene.lobes().filter(|(_, lobe)| (lobe.kind == LobeKind::Sheen) == sheen).collect();
        if lobes.is_empty() {
            return None;
        }
        let brdf = if sheen { BrdfKind::CharlieNeubelt } else { BrdfKind::Ggx };
        Some(Self { scene, range: range(&lobes), lobes, brdf })
    }

    /// Whether all lobes are isotropic.
    pub(crate) fn is_isotropic(&self) -> bool {
        self.range.ratio == [1.0, 1.0]
    }

    /// The roughnesses of all lobes, each with its lobe.
    pub(crate) fn spots(&self) -> impl Iterator<Item = (&'a Spot, &'a SceneLobe)> {
        self.lobes.iter().flat_map(|(_, lobe)| lobe.spots.iter().map(move |spot| (spot, *lobe)))
    }

    /// The distinct pairs of alpha and ratio, in the order of the lobes. Empty if there are too many for a table of
    /// materials.
    pub(crate) fn pairs(&self) -> Vec<[f64; 2]> {
        let mut pairs = Vec::new();
        for pair in self.spots().map(|(spot, _)| spot.pair()) {
            if !pairs.contains(&pair) {
                pairs.push(pair);
            }
            if pairs.len() > MOST_MATERIALS {
                return Vec::new();
            }
        }
        pairs
    }

    /// The mean reflectances of dielectrics and of metal, if the scene has them, each with its weight.
    pub(crate) fn reflectances(&self) -> Vec<WeightedF0> {
        let (mut metal, mut rest) = ([0.0; 2], [0.0; 2]);
        for [f0, weight] in self.lobes.iter().flat_map(|(_, lobe)| &lobe.f0).filter(|_| self.brdf.has_fresnel()) {
            let sum = if *f0 < LEAST_METAL { &mut rest } else { &mut metal };
            *sum = [sum[0] + weight * f0, sum[1] + weight];
        }
        let most = f64::max(metal[1], rest[1]);
        let part = |[sum, weight]: [f64; 2]| {
            let weight_of_most = (weight / most * ROUNDED_TO).round() / ROUNDED_TO;
            (weight_of_most > 0.0).then(|| WeightedF0 { f0: rounded_f0(sum / weight), weight: weight_of_most })
        };
        [rest, metal].into_iter().filter_map(part).collect()
    }

    /// The parts of the surface that have the lobes.
    pub(crate) fn shares(&self) -> Vec<f64> {
        let weights = self.lobes.iter().map(|(_, lobe)| lobe.weight());
        let total: f64 = weights.clone().sum();
        weights.map(|weight| weight / total).collect()
    }

    /// Draws configurations by the weights of roughnesses, views and metal in the scene. Half of them are spread evenly
    /// over the lobes.
    pub(crate) fn draw(&self, count: usize) -> Vec<Place> {
        let shares = self.shares();
        let drawn_at: Vec<f64> = shares.iter().map(|share| 0.5 * (share + 1.0 / shares.len() as f64)).collect();
        let drawn = |i: usize| {
            let [u, v, w, metal] = recurrence4(i, SHIFT);
            let (index, u) = pick(&drawn_at, u);
            let (material, lobe) = self.lobes[index];
            let weights: Vec<f64> = lobe.spots.iter().map(|spot| spot.weight).collect();
            let spot = lobe.spots[pick(&weights, u).0];
            let [theta, phi] = lobe.views.draw(v, w);
            // An isotropic lobe has no direction along the surface, so its azimuth is drawn uniformly.
            let phi = if lobe.is_isotropic() { w * FRAC_PI_2 } else { phi };
            let at = Configuration { alpha_x: spot.alpha, alpha_y: spot.alpha * spot.ratio, theta, phi };
            let parts: Vec<f64> = lobe.formula.iter().map(|[_, f90, area]| f90 * area).collect();
            let has_f0 = self.brdf.has_fresnel() && !parts.is_empty();
            let [f0, f90, _] = if has_f0 { lobe.formula[pick(&parts, metal).0] } else { [1.0; 3] };
            // A list of materials has no positions: lights are relative to each place.
            let lights = self.scene.lights.iter().enumerate();
            let lights = lights.flat_map(|(index, light)| light.seen_from(index, DVec3::ZERO, DVec3::AXES));
            let weight = shares[index] / drawn_at[index] / count as f64;
            Place { of: (material, lobe.kind), weight, at, fresnel: [f0 / f90, 1.0], lights: lights.collect() }
        };
        (0..count).map(drawn).collect()
    }

    /// The places that the scene's lights reach.
    pub(crate) fn lit(&self) -> Vec<Place> {
        // Materials alternate, so that the first places are from all of them.
        let mut order: Vec<usize> = (0..self.scene.places.len()).collect();
        order.sort_by_key(|index| (*index as u32).reverse_bits());
        let places = order.into_iter().map(|index| &self.scene.places[index]);
        let is_own = |place: &&Place| self.lobes.iter().any(|(material, lobe)| (*material, lobe.kind) == place.of);
        places.filter(is_own).cloned().collect()
    }
}

/// Rounds a reflectance to one that a lobe can be fitted for.
fn rounded_f0(f0: f64) -> f64 {
    ((f0 * ROUNDED_TO).round() / ROUNDED_TO).clamp(LEAST_F0, 1.0)
}

/// The ranges of some lobes, with angles rounded outwards.
fn range(lobes: &[(usize, &SceneLobe)]) -> PerAxis<[f64; 2]> {
    let pairs = || lobes.iter().flat_map(|(_, lobe)| &lobe.spots).map(Spot::pair);
    let [alpha, ratio] = [0, 1].map(|axis| span(pairs().map(|pair| pair[axis])));
    let outwards = |[low, high]: [f64; 2]| {
        [(low * ROUNDED_TO).floor() / ROUNDED_TO, ((high * ROUNDED_TO).ceil() / ROUNDED_TO).min(FRAC_PI_2)]
    };
    let theta = outwards(span(lobes.iter().flat_map(|(_, lobe)| lobe.views.theta)));
    let phi = if ratio == [1.0, 1.0] {
        [0.0, 0.0]
    } else if lobes.iter().any(|(_, lobe)| lobe.is_isotropic()) {
        [0.0, FRAC_PI_2]
    } else {
        outwards(span(lobes.iter().flat_map(|(_, lobe)| lobe.views.phi)))
    };
    PerAxis { alpha, ratio, theta, phi }
}
