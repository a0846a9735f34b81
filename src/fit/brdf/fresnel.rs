//! The Fresnel factor of the lobe to which a table is fitted.

use std::fmt;

use glam::DVec3;
use serde::{Serialize, Serializer};

use super::{Bends, Brdf, BrdfSample, LobeTerms, cos_theta_d};
use crate::math::{Lattice, SquarePoint};

/// The number of samples of a lobe that give the reflected light of each material. More samples would hardly change the
/// weights.
const SAMPLES: usize = 256;

/// Materials with less than this fraction of the greatest weight are left out.
const LEAST_SHARE: f64 = 1e-6;

/// A material: its reflectance at normal incidence and its weight.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct WeightedF0 {
    /// Reflectance at normal incidence, in [0, 1].
    pub f0: f64,
    /// Weight, finite and not negative.
    pub weight: f64,
}

/// The materials that a table is fitted for.
///
/// A renderer scales one lobe by `F0 (amplitude - fresnel) + F90 fresnel` for every material. Schlick's factor favours
/// light near the horizon, so the lobe of plastic is closer to the horizon than the lobe of metal. This type selects
/// the fitted lobe. Amplitude and Fresnel term are the same for all variants.
#[derive(Debug, Clone, PartialEq, Default)]
pub enum LobeFresnel {
    /// A Fresnel factor of one: a perfect mirror.
    #[default]
    One,
    /// One lobe between the lobes of several materials, each with F90 = 1. It minimises the error of their reflected
    /// light; see [`LobeFresnel::mix`].
    Mix(Vec<WeightedF0>),
    /// Two lobes per entry, for materials of any F0. The first is for a Fresnel factor of one, the second for Schlick's
    /// fifth power.
    Two(SecondLobe),
}

/// How renderers use the two lobes of an entry. This determines the target of the second lobe.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SecondLobe {
    /// Two integrals, `F0 amplitude LTC(M) + (F90 - F0) fresnel LTC(M_2)`. The second lobe is the lobe of Schlick's
    /// fifth power.
    Integrated,
    /// One integral of the blended lobe; see [`blended`](crate::blended). The second lobe is chosen such that the blend
    /// for a dielectric is the best lobe for this dielectric.
    Blended,
}

impl SecondLobe {
    /// All variants.
    pub const ALL: [Self; 2] = [Self::Integrated, Self::Blended];

    /// The name in recipes.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Integrated => "two_lobes",
            Self::Blended => "blended_lobes",
        }
    }

    /// The F0 of the material to which the second lobe is fitted, with F90 = 1.
    ///
    /// The light of Schlick's fifth power alone cannot be fitted, because it is almost zero on a smooth surface seen
    /// from above. A small F0 adds a little of the whole lobe. If the second lobe is fitted at 0.02, the blend for F0 =
    /// 0.04 has an error of 2.5 % of the light (default table). A lobe fitted to 0.04 alone has an error of 2.2 %. With
    /// a second lobe fitted at 0.01 or 0.06, the blend is worse.
    #[must_use]
    pub fn fitted_f0(self) -> f64 {
        match self {
            Self::Integrated => 1e-3,
            Self::Blended => 0.02,
        }
    }
}

impl LobeFresnel {
    /// The canonical form of a mix: sorted by F0, each F0 once, greatest weight 1. Materials with less than a millionth
    /// of the greatest weight are left out. A mix of F0 = 1 alone becomes [`LobeFresnel::One`]. `None` if no material
    /// remains. Domain: finite numbers, not negative.
    #[must_use]
    pub fn mix(mut parts: Vec<WeightedF0>) -> Option<Self> {
        parts.sort_by(|a, b| a.f0.total_cmp(&b.f0));
        let mut once: Vec<WeightedF0> = Vec::new();
        for part in parts {
            match once.last_mut().filter(|last| last.f0 == part.f0) {
                Some(last) => last.weight += part.weight,
                None => once.push(part),
            }
        }
        let most = once.iter().fold(0.0_f64, |most, part| most.max(part.weight));
        once.retain(|part| part.weight > 0.0 && part.weight >= LEAST_SHARE * most);
        for part in &mut once {
            part.weight /= most;
        }
        match once[..] {
            [] => None,
            [WeightedF0 { f0: 1.0, .. }] => Some(Self::One),
            _ => Some(Self::Mix(once)),
        }
    }

    /// True if the Fresnel factor is one and there is no second lobe.
    #[must_use]
    pub fn is_one(&self) -> bool {
        *self == Self::One
    }

    /// How renderers use the second lobe, if there are two lobes.
    #[must_use]
    pub fn second(&self) -> Option<SecondLobe> {
        match self {
            Self::Two(second) => Some(*second),
            Self::One | Self::Mix(_) => None,
        }
    }

    /// The F0 whose lobe represents all materials in one view. `terms` are the terms of the view for a Fresnel factor
    /// of one.
    ///
    /// Material i reflects `E_i = f0_i (amplitude - fresnel) + fresnel`. If the fitted lobe is at a relative distance
    /// `x_i` from the lobe of material i, the error is `E_i x_i`. The mean of the lobes with weights `w_i E_i^2`
    /// minimises the sum of `w_i (E_i x_i)^2`. A lobe with the factor `f0_i + (1 - f0_i) s`, where `s` is Schlick's
    /// fifth power, already contains one `E_i`. The mean of several factors has the same form, up to scale:
    ///
    /// ```text
    /// f0 = sum(w_i E_i f0_i) / sum(w_i E_i)
    /// ```
    ///
    /// In \[0, 1\].
    #[must_use]
    pub fn f0(&self, terms: &LobeTerms) -> f64 {
        let Self::Mix(parts) = self else { return 1.0 };
        let reflected = |f0: f64| f0 * (terms.amplitude - terms.fresnel) + terms.fresnel;
        let [level, all] = parts.iter().fold([0.0; 2], |[level, all], WeightedF0 { f0, weight }| {
            let counts = weight * reflected(*f0);
            [level + counts * f0, all + counts]
        });
        // No material of the mix reflects light in this view.
        if all > 0.0 { level / all } else { 1.0 }
    }

    /// The surface of the second lobe; `None` if entries have one lobe.
    pub(super) fn second_applied(&self, surface: Box<dyn Brdf>) -> Option<Box<dyn Brdf>> {
        let f0 = self.second()?.fitted_f0();
        Some(Box::new(Schlick { surface, f0 }))
    }

    /// The surface whose lobe for `wo` is fitted. If there are two lobes, it is the surface of the first lobe.
    pub(super) fn applied(&self, surface: Box<dyn Brdf>, wo: DVec3) -> Box<dyn Brdf> {
        if !matches!(self, Self::Mix(_)) {
            return surface;
        }
        let points: Vec<SquarePoint> = Lattice::new(SAMPLES, [0.0; 2]).points().map(SquarePoint::new).collect();
        let f0 = self.f0(&surface.terms(wo, &points));
        Box::new(Schlick { surface, f0 })
    }
}

impl fmt::Display for LobeFresnel {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let parts = match self {
            Self::One => return f.write_str("a Fresnel factor of one"),
            Self::Two(SecondLobe::Integrated) => return f.write_str("two lobes, each integrated separately"),
            Self::Two(SecondLobe::Blended) => return f.write_str("two lobes, blended into one integral"),
            Self::Mix(parts) => parts,
        };
        let materials: Vec<String> =
            parts.iter().map(|part| format!("f0 {} with weight {}", part.f0, part.weight)).collect();
        f.write_str(&materials.join(", "))
    }
}

impl Serialize for LobeFresnel {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::One => serializer.serialize_str("one"),
            Self::Mix(parts) => parts.serialize(serializer),
            Self::Two(second) => serializer.serialize_str(second.name()),
        }
    }
}

/// A surface with Schlick's Fresnel factor for an F0, with F90 = 1. Its terms are still the terms for a factor of one,
/// because tables store these terms.
struct Schlick {
    surface: Box<dyn Brdf>,
    f0: f64,
}

impl Schlick {
    fn factor(&self, cos_theta_d: f64) -> f64 {
        let grazing = (1.0 - cos_theta_d).clamp(0.0, 1.0);
        let grazing2 = grazing * grazing;
        self.f0 + (1.0 - self.f0) * (grazing2 * grazing2 * grazing)
    }

    fn scaled(&self, sample: BrdfSample) -> BrdfSample {
        BrdfSample { weight: sample.weight * self.factor(sample.cos_theta_d), ..sample }
    }
}

impl Brdf for Schlick {
    fn eval_cos(&self, wo: DVec3, wi: DVec3) -> f64 {
        self.surface.eval_cos(wo, wi) * self.factor(cos_theta_d(wo, wi))
    }

    fn bends(&self, wo: DVec3) -> Bends {
        self.surface.bends(wo)
    }

    fn sample(&self, wo: DVec3, u: [f64; 2]) -> BrdfSample {
        self.scaled(self.surface.sample(wo, u))
    }

    fn sample_all(&self, wo: DVec3, points: &[SquarePoint], drawn: &mut Vec<BrdfSample>) {
        let first = drawn.len();
        self.surface.sample_all(wo, points, drawn);
        for sample in &mut drawn[first..] {
            *sample = self.scaled(*sample);
        }
    }

    fn terms(&self, wo: DVec3, points: &[SquarePoint]) -> LobeTerms {
        self.surface.terms(wo, points)
    }

    fn pdf(&self, wo: DVec3, wi: DVec3) -> f64 {
        self.surface.pdf(wo, wi)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        BrdfKind, BrdfModel,
        math::{Lattice, direction},
    };

    fn mix(parts: &[(f64, f64)]) -> LobeFresnel {
        let parts = parts.iter().map(|(f0, weight)| WeightedF0 { f0: *f0, weight: *weight });
        LobeFresnel::mix(parts.collect()).expect("a material")
    }

    #[test]
    fn equal_mixes_have_one_form() {
        let first = mix(&[(1.0, 2.0), (0.04, 1.0)]);
        assert_eq!(first, mix(&[(0.04, 3.0), (0.5, 0.0), (1.0, 4.0), (1.0, 2.0)]));
        assert_eq!(mix(&[(1.0, 0.25)]), LobeFresnel::One);
        assert_eq!(mix(&[(1.0, 1e9), (0.04, 5e-324), (0.5, 900.0)]), LobeFresnel::One);
        assert_eq!(LobeFresnel::mix(vec![WeightedF0 { f0: 0.3, weight: 0.0 }]), None);
    }

    #[test]
    fn the_f0_of_a_mix_is_weighted_by_reflected_light() {
        let terms = LobeTerms { amplitude: 0.9, fresnel: 0.1 };
        for f0 in [0.0, 0.04, 0.5, 1.0] {
            assert!((mix(&[(f0, 3.0)]).f0(&terms) - f0).abs() < 1e-15);
        }
        assert_eq!(LobeFresnel::One.f0(&terms), 1.0);
        // Plastic reflects 0.04 * 0.8 + 0.1.
        let wanted = (0.9 + 0.132 * 0.04) / (0.9 + 0.132);
        assert!((mix(&[(1.0, 1.0), (0.04, 1.0)]).f0(&terms) - wanted).abs() < 1e-15);
        assert!((mix(&[(1.0, 2.0), (0.04, 2.0), (0.7, 0.0)]).f0(&terms) - wanted).abs() < 1e-15);
    }

    /// The mean of the samples is the reflected light of the material, as computed from the terms for a factor of one.
    #[test]
    fn light_is_scaled_by_schlick_s_factor_and_terms_are_not() {
        let plain = BrdfModel::from(BrdfKind::Ggx);
        let model = plain.clone().with_fresnel(mix(&[(0.04, 1.0)]));
        let points: Vec<SquarePoint> = Lattice::new(4096, [0.3, 0.1]).points().map(SquarePoint::new).collect();
        for (roughness, theta) in [([0.5, 0.2], 0.3), ([0.3, 0.3], 1.4)] {
            let wo = direction(theta, 0.7);
            let surface = model.lobe_surface(roughness, wo);
            let LobeTerms { amplitude, fresnel } = surface.terms(wo, &points);
            assert_eq!(plain.surface(roughness).terms(wo, &points), LobeTerms { amplitude, fresnel });
            let mut drawn = Vec::new();
            surface.sample_all(wo, &points, &mut drawn);
            let mean = drawn.iter().map(|sample| sample.weight).sum::<f64>() / drawn.len() as f64;
            let wanted = 0.04 * (amplitude - fresnel) + fresnel;
            assert!((mean - wanted).abs() < 1e-7, "{mean} {wanted}");
            for (sample, point) in drawn.iter().zip(&points).take(50).filter(|(sample, _)| sample.weight > 0.0) {
                assert_eq!(surface.sample(wo, point.u).weight, sample.weight);
                let by_value = surface.eval_cos(wo, sample.wi) / surface.pdf(wo, sample.wi);
                assert!((by_value / sample.weight - 1.0).abs() < 1e-6, "{by_value} {}", sample.weight);
            }
        }
    }
}
