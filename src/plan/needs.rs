//! What a table of one scattering model has to serve in a scene.

use std::f64::consts::FRAC_PI_2;

use crate::{
    histogram::pick,
    scene::{LobeKind, Scene, SceneLobe},
};
use ltcforge_fit::{
    ALPHA_FLOOR, BrdfKind, Configuration, MOST_MATERIALS, PerAxis, RATIO_FLOOR, WeightedF0, math::recurrence4,
};

/// Where the sequence of configurations begins.
const SHIFT: [f64; 4] = [0.5, 0.236_067_977_499_79, 0.732_050_807_568_877, 0.645_751_311_064_59];
/// Least reflectance that a lobe can be fitted for.
const LEAST_F0: f64 = 1e-3;
/// What reflects less, seen from above, is no metal: the reflectance of diamond.
const LEAST_METAL: f64 = 0.17;
/// Parts of a roughness to which ranges are written, so that squares have no digits of rounding.
const DECIMALS: f64 = 1e12;
/// Digits to which ranges of angles and reflectances are written.
const ROUNDED_TO: f64 = 1000.0;

/// The lobes of a scene that one table serves.
#[derive(Debug, Clone)]
pub struct Needs<'a> {
    /// The lobes, and the number of each one's material.
    lobes: Vec<(usize, &'a SceneLobe)>,
    /// The scattering model.
    brdf: BrdfKind,
    /// The ranges that hold all of it.
    range: PerAxis<[f64; 2]>,
}

impl<'a> Needs<'a> {
    /// The lobes of GGX, or of sheen; `None` where a scene has none.
    #[must_use]
    pub fn of(scene: &'a Scene, sheen: bool) -> Option<Self> {
        let all = scene.materials.iter().enumerate();
        let lobes = all.flat_map(|(index, material)| material.lobes.iter().map(move |lobe| (index, lobe)));
        let lobes: Vec<_> = lobes.filter(|(_, lobe)| (lobe.kind == LobeKind::Sheen) == sheen).collect();
        if lobes.is_empty() {
            return None;
        }
        let brdf = if sheen { BrdfKind::CharlieNeubelt } else { BrdfKind::Ggx };
        let range = range(&lobes);
        Some(Self { lobes, brdf, range })
    }

    /// The lobes, and the number of each one's material.
    #[must_use]
    pub fn lobes(&self) -> &[(usize, &'a SceneLobe)] {
        &self.lobes
    }

    /// The scattering model.
    #[must_use]
    pub fn brdf(&self) -> BrdfKind {
        self.brdf
    }

    /// The mean reflectance of dielectrics, and that of metal, each with its surface; those that the scene has.
    pub(crate) fn reflectances(&self) -> Vec<WeightedF0> {
        if self.brdf.has_fresnel() { reflectances(&self.lobes) } else { Vec::new() }
    }

    /// The ranges that hold all of it.
    #[must_use]
    pub fn range(&self) -> PerAxis<[f64; 2]> {
        self.range
    }

    /// Whether all lobes are round.
    #[must_use]
    pub fn is_isotropic(&self) -> bool {
        self.range.ratio == [1.0, 1.0]
    }

    fn spots(&self) -> impl Iterator<Item = (&'a crate::Spot, &'a SceneLobe)> {
        self.lobes.iter().flat_map(|(_, lobe)| lobe.spots.iter().map(move |spot| (spot, *lobe)))
    }

    /// The different values of alpha and of ratio, ascending.
    #[must_use]
    pub fn values(&self) -> [Vec<f64>; 2] {
        let of = |value: fn(&crate::Spot) -> f64, floor: f64| {
            let mut values: Vec<f64> = self.spots().map(|(spot, _)| decimal(value(spot).max(floor))).collect();
            values.sort_by(f64::total_cmp);
            values.dedup();
            values
        };
        [of(|spot| spot.alpha, ALPHA_FLOOR), of(|spot| spot.ratio, RATIO_FLOOR)]
    }

    /// The values of alpha, and of ratio, with their weights.
    pub(crate) fn weighed(&self) -> [Vec<(f64, f64)>; 2] {
        let of = |value: fn(&crate::Spot) -> f64| self.spots().map(|(spot, _)| (value(spot), spot.weight)).collect();
        [of(|spot| spot.alpha), of(|spot| spot.ratio)]
    }

    /// The different pairs of alpha and ratio, in the order of the lobes; none where they are more than a table of materials has.
    #[must_use]
    pub fn pairs(&self) -> Vec<[f64; 2]> {
        let mut pairs = Vec::new();
        for (spot, _) in self.spots() {
            let pair = pair(spot);
            if !pairs.contains(&pair) {
                if pairs.len() == MOST_MATERIALS {
                    return Vec::new();
                }
                pairs.push(pair);
            }
        }
        pairs
    }

    /// Configurations as often as the scene has them: by surface, by the views of it, and by what of it is metal.
    #[must_use]
    pub fn draw(&self, count: usize) -> Vec<Place> {
        let (spots, weights): (Vec<_>, Vec<f64>) = self.spots().map(|at| (at, at.0.weight)).unzip();
        let drawn = |i: usize| {
            let [u, v, w, metal] = recurrence4(i, SHIFT);
            let (spot, lobe) = spots[pick(&weights, u).0];
            let [theta, phi] = lobe.views.draw(v, w);
            // A round lobe has no direction along the surface.
            let phi = if lobe.is_isotropic() { w * FRAC_PI_2 } else { phi };
            let at = Configuration { alpha_x: spot.alpha, alpha_y: spot.alpha * spot.ratio, theta, phi };
            Place { at, f0: self.f0(lobe, metal) }
        };
        (0..count).map(drawn).collect()
    }

    /// The reflectance of a part of a lobe's surface, `part` in [0, 1).
    fn f0(&self, lobe: &SceneLobe, part: f64) -> f64 {
        let parts: Vec<f64> = lobe.f0.iter().map(|[_, weight]| *weight).collect();
        if parts.is_empty() || !self.brdf.has_fresnel() {
            return 1.0;
        }
        rounded_f0(lobe.f0[pick(&parts, part).0][0])
    }
}

/// A configuration of a scene, and the reflectance of what is there.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Place {
    /// Roughnesses and view.
    pub at: Configuration,
    /// Reflectance seen from above, of F90 = 1.
    pub f0: f64,
}

/// A reflectance to which a lobe can be fitted, without digits of rounding.
fn rounded_f0(f0: f64) -> f64 {
    ((f0 * ROUNDED_TO).round() / ROUNDED_TO).clamp(LEAST_F0, 1.0)
}

/// The mean reflectance of dielectrics, and that of metal, each by its surface.
fn reflectances(lobes: &[(usize, &SceneLobe)]) -> Vec<WeightedF0> {
    let all = lobes.iter().flat_map(|(_, lobe)| &lobe.f0);
    let (mut metal, mut rest) = ([0.0; 2], [0.0; 2]);
    for [f0, weight] in all {
        let sum = if *f0 < LEAST_METAL { &mut rest } else { &mut metal };
        *sum = [sum[0] + weight * f0, sum[1] + weight];
    }
    let most = f64::max(metal[1], rest[1]);
    let part = |[sum, weight]: [f64; 2]| {
        let counts = (weight / most * ROUNDED_TO).round() / ROUNDED_TO;
        (counts > 0.0).then(|| WeightedF0 { f0: rounded_f0(sum / weight), weight: counts })
    };
    [rest, metal].into_iter().filter_map(part).collect()
}

/// Alpha and ratio of a spot as recipes have them.
pub(crate) fn pair(spot: &crate::Spot) -> [f64; 2] {
    [spot.alpha.max(ALPHA_FLOOR), spot.ratio.max(RATIO_FLOOR)].map(decimal)
}

/// A number without digits of rounding.
pub(crate) fn decimal(x: f64) -> f64 {
    (x * DECIMALS).round() / DECIMALS
}

/// The ranges of some lobes, angles rounded outwards.
fn range(lobes: &[(usize, &SceneLobe)]) -> PerAxis<[f64; 2]> {
    let around = |values: &mut dyn Iterator<Item = f64>| {
        values.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| [low.min(x), high.max(x)])
    };
    let spots = || lobes.iter().flat_map(|(_, lobe)| &lobe.spots);
    let outwards = |[low, high]: [f64; 2]| {
        [(low * ROUNDED_TO).floor() / ROUNDED_TO, ((high * ROUNDED_TO).ceil() / ROUNDED_TO).min(FRAC_PI_2)]
    };
    let alpha = around(&mut spots().map(|spot| spot.alpha.max(ALPHA_FLOOR))).map(decimal);
    let ratio = around(&mut spots().map(|spot| spot.ratio.max(RATIO_FLOOR))).map(decimal);
    let theta = outwards(around(&mut lobes.iter().flat_map(|(_, lobe)| lobe.views.theta())));
    let phi = if ratio == [1.0, 1.0] {
        [0.0, 0.0]
    } else if lobes.iter().any(|(_, lobe)| lobe.is_isotropic()) {
        [0.0, FRAC_PI_2]
    } else {
        outwards(around(&mut lobes.iter().flat_map(|(_, lobe)| lobe.views.phi())))
    };
    PerAxis { alpha, ratio, theta, phi }
}
