//! The anisotropy parameters of material descriptions, and the roughnesses along and across a tangent that follow from
//! them. Each description has a function and a list of parameters.
//!
//! Roughnesses are GGX alphas. Models of light and tables allow at most 1, but some descriptions exceed it. The
//! functions return the published values, and [`AnisotropicRoughness::within_bounds`] limits them.

use std::fmt;

use glam::DVec3;

use ltcforge_fit::{Configuration, math::sin_cos, named_list};

named_list! {
    /// A description of materials.
    pub enum MaterialModel {
        /// glTF 2.0 with extension `KHR_materials_anisotropy`.
        Gltf = "gltf",
        /// OpenPBR surface.
        OpenPbr = "openpbr",
        /// MaterialX, node `roughness_anisotropy` of its library of physically based shading.
        MaterialX = "materialx",
        /// Disney's principled BRDF [Burley 2012].
        Disney = "disney",
        /// Shader Lit of Unity's HDRP.
        Hdrp = "hdrp",
    }
}

/// A parameter of a description, with its original name.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MaterialParameter {
    /// The name of the parameter.
    pub name: &'static str,
    /// The smallest and largest value; infinite if the description has no limit.
    pub range: [f64; 2],
    /// The value if a material leaves the parameter out.
    pub default: f64,
}

const fn parameter(name: &'static str, range: [f64; 2], default: f64) -> MaterialParameter {
    MaterialParameter { name, range, default }
}

const UNIT: [f64; 2] = [0.0, 1.0];
const ANY: [f64; 2] = [f64::NEG_INFINITY, f64::INFINITY];

const GLTF: [MaterialParameter; 3] = [
    parameter("roughnessFactor", UNIT, 1.0),
    parameter("anisotropyStrength", UNIT, 0.0),
    parameter("anisotropyRotation", ANY, 0.0),
];
const OPENPBR: [MaterialParameter; 2] =
    [parameter("specular_roughness", UNIT, 0.3), parameter("specular_roughness_anisotropy", UNIT, 0.0)];
const MATERIALX: [MaterialParameter; 2] = [parameter("roughness", UNIT, 0.0), parameter("anisotropy", UNIT, 0.0)];
const DISNEY: [MaterialParameter; 2] = [parameter("roughness", UNIT, 0.5), parameter("anisotropic", UNIT, 0.0)];
const HDRP: [MaterialParameter; 2] = [parameter("_Smoothness", UNIT, 0.5), parameter("_Anisotropy", [-1.0, 1.0], 0.0)];

/// GGX roughnesses along and across a tangent. The tangent has an angle about the normal, in radians counter-clockwise
/// from the surface's own tangent.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AnisotropicRoughness {
    /// Roughness along the turned tangent.
    pub alpha_x: f64,
    /// Roughness across the turned tangent.
    pub alpha_y: f64,
    /// Angle of the turned tangent.
    pub rotation: f64,
}

/// The roughnesses of glTF (`KHR_materials_anisotropy`): `alpha_x = mix(r^2, 1, s^2)`, `alpha_y = r^2` for a roughness
/// `r` and a strength `s`, both in [0, 1], and a rotation in radians.
#[must_use]
pub fn gltf(roughness_factor: f64, anisotropy_strength: f64, anisotropy_rotation: f64) -> AnisotropicRoughness {
    let (alpha_y, share) = (roughness_factor * roughness_factor, anisotropy_strength * anisotropy_strength);
    AnisotropicRoughness { alpha_x: alpha_y * (1.0 - share) + share, alpha_y, rotation: anisotropy_rotation }
}

/// The roughnesses of OpenPBR: `alpha_x = r^2 sqrt(2 / (1 + (1 - a)^2))`, `alpha_y = (1 - a) alpha_x` for a roughness
/// `r` and an anisotropy `a`, both in [0, 1]. Then `alpha_x^2 + alpha_y^2 = 2 r^4`, and `alpha_x` is at most the square
/// root of two [OpenPBR 1.1, microfacet model]. The parameters of the coat have the same meaning.
#[must_use]
pub fn openpbr(specular_roughness: f64, specular_roughness_anisotropy: f64) -> AnisotropicRoughness {
    let across = 1.0 - specular_roughness_anisotropy;
    let alpha_x = specular_roughness * specular_roughness * (2.0 / (1.0 + across * across)).sqrt();
    AnisotropicRoughness { alpha_x, alpha_y: across * alpha_x, rotation: 0.0 }
}

/// The roughnesses of MaterialX: `alpha_x = min(r^2 / s, 1)`, `alpha_y = r^2 s` with `s = sqrt(1 - min(a, 0.98))` for a
/// roughness `r` and an anisotropy `a`, both in [0, 1] [node `roughness_anisotropy`, 1.39].
#[must_use]
pub fn materialx(roughness: f64, anisotropy: f64) -> AnisotropicRoughness {
    const MOST_ANISOTROPY: f64 = 0.98;
    let (alpha, aspect) = (roughness * roughness, (1.0 - anisotropy.min(MOST_ANISOTROPY)).sqrt());
    AnisotropicRoughness { alpha_x: (alpha / aspect).min(1.0), alpha_y: alpha * aspect, rotation: 0.0 }
}

/// The roughnesses of Disney: `alpha_x = max(0.001, r^2 / s)`, `alpha_y = max(0.001, r^2 s)` with `s = sqrt(1 - 0.9 a)`
/// for a roughness `r` and an anisotropy `a`, both in [0, 1]. `alpha_x` is at most 3.2 [Burley 2012, and `disney.brdf`
/// of BRDF Explorer].
#[must_use]
pub fn disney(roughness: f64, anisotropic: f64) -> AnisotropicRoughness {
    const LEAST: f64 = 0.001;
    let (alpha, aspect) = (roughness * roughness, (1.0 - 0.9 * anisotropic).sqrt());
    AnisotropicRoughness { alpha_x: (alpha / aspect).max(LEAST), alpha_y: (alpha * aspect).max(LEAST), rotation: 0.0 }
}

/// The roughnesses of HDRP: `alpha_x = (1 + a) r^2`, `alpha_y = (1 - a) r^2` with `r = 1 - smoothness` for a smoothness
/// in [0, 1] and an anisotropy `a` in [-1, 1]. Both are at most 2 [Kulla and Conty 2017; `CommonMaterial.hlsl`].
#[must_use]
pub fn hdrp(smoothness: f64, anisotropy: f64) -> AnisotropicRoughness {
    let alpha = (1.0 - smoothness) * (1.0 - smoothness);
    AnisotropicRoughness { alpha_x: alpha * (1.0 + anisotropy), alpha_y: alpha * (1.0 - anisotropy), rotation: 0.0 }
}

impl MaterialModel {
    /// The parameters for roughness and anisotropy.
    #[must_use]
    pub fn parameters(self) -> &'static [MaterialParameter] {
        match self {
            Self::Gltf => &GLTF,
            Self::OpenPbr => &OPENPBR,
            Self::MaterialX => &MATERIALX,
            Self::Disney => &DISNEY,
            Self::Hdrp => &HDRP,
        }
    }

    /// The roughnesses of a material, from one number for each of [`MaterialModel::parameters`], in their order and
    /// ranges.
    fn roughness(self, numbers: &[f64]) -> AnisotropicRoughness {
        let at = |index: usize| numbers.get(index).copied().unwrap_or_default();
        match self {
            Self::Gltf => gltf(at(0), at(1), at(2)),
            Self::OpenPbr => openpbr(at(0), at(1)),
            Self::MaterialX => materialx(at(0), at(1)),
            Self::Disney => disney(at(0), at(1)),
            Self::Hdrp => hdrp(at(0), at(1)),
        }
    }

    fn parameter_names(self) -> String {
        let names: Vec<&str> = self.parameters().iter().map(|parameter| parameter.name).collect();
        names.join(", ")
    }
}

impl AnisotropicRoughness {
    /// Parses a material such as `openpbr:specular_roughness=0.3,specular_roughness_anisotropy=0.5`: the name of a
    /// description, then its parameters. Missing parameters have their default.
    ///
    /// # Errors
    /// All faults of the text.
    pub fn parse(text: &str) -> Result<Self, MaterialFaults> {
        let (name, list) = text.split_once(':').unwrap_or((text, ""));
        let Some(model) = MaterialModel::from_name(name.trim()) else {
            let names: Vec<&str> = MaterialModel::ALL.iter().map(|model| model.name()).collect();
            let fault = format!("«{}» is not one of {}", name.trim(), names.join(", "));
            return Err(MaterialFaults(vec![fault]));
        };
        let parameters = model.parameters();
        let mut numbers: Vec<Option<f64>> = vec![None; parameters.len()];
        let mut faults = Vec::new();
        for part in list.split(',').map(str::trim).filter(|part| !part.is_empty()) {
            let (name, value) = part.split_once('=').map_or((part, ""), |(name, value)| (name.trim(), value.trim()));
            let Some(index) = parameters.iter().position(|parameter| parameter.name == name) else {
                faults.push(format!("{model} has no «{name}»; it has {}", model.parameter_names()));
                continue;
            };
            let [low, high] = parameters[index].range;
            match value.parse::<f64>() {
                _ if numbers[index].is_some() => faults.push(format!("{name} is given more than once")),
                Ok(number) if number.is_finite() && (low..=high).contains(&number) => numbers[index] = Some(number),
                _ if low.is_finite() => {
                    faults.push(format!("{name} is «{value}»; it must be from {low} to {high}"));
                }
                _ => faults.push(format!("{name} is «{value}»; it must be finite")),
            }
        }
        if !faults.is_empty() {
            return Err(MaterialFaults(faults));
        }
        let numbers = numbers.iter().zip(parameters).map(|(number, parameter)| number.unwrap_or(parameter.default));
        Ok(model.roughness(&numbers.collect::<Vec<f64>>()))
    }

    /// The same material with both roughnesses limited to 1.
    #[must_use]
    pub fn within_bounds(self) -> Self {
        Self { alpha_x: self.alpha_x.min(1.0), alpha_y: self.alpha_y.min(1.0), ..self }
    }

    /// The configuration for a view direction in the surface's own frame. The configuration is in the frame of the
    /// turned tangent. [`AnisotropicRoughness::turned`] converts lights to this frame.
    #[must_use]
    pub fn seen_from(&self, theta: f64, phi: f64) -> Configuration {
        Configuration { alpha_x: self.alpha_x, alpha_y: self.alpha_y, theta, phi: phi - self.rotation }
    }

    /// Converts a vector from the surface's own frame to the frame of the turned tangent.
    #[must_use]
    pub fn turned(&self, vector: DVec3) -> DVec3 {
        let (sin, cos) = sin_cos(self.rotation);
        DVec3::new(cos * vector.x + sin * vector.y, cos * vector.y - sin * vector.x, vector.z)
    }
}

/// All faults of a material's text.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub struct MaterialFaults(pub Vec<String>);

impl fmt::Display for MaterialFaults {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0.join("; "))
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::FRAC_PI_2;

    use super::*;

    #[track_caller]
    fn assert_near(found: AnisotropicRoughness, [alpha_x, alpha_y, rotation]: [f64; 3]) {
        let AnisotropicRoughness { alpha_x: x, alpha_y: y, rotation: turn } = found;
        let is_near = [(x, alpha_x), (y, alpha_y), (turn, rotation)].iter().all(|(a, b)| (a - b).abs() < 1e-12);
        assert!(is_near, "{found:?}, not {alpha_x} {alpha_y} {rotation}");
    }

    /// Compares each formula with values computed by hand.
    #[test]
    fn formulas_are_the_published_ones() {
        assert_near(gltf(0.5, 0.6, 1.57), [0.52, 0.25, 1.57]);
        assert_near(gltf(0.5, 0.0, 0.0), [0.25, 0.25, 0.0]);
        assert_near(gltf(0.0, 1.0, 0.0), [1.0, 0.0, 0.0]);
        assert_near(openpbr(0.5, 0.5), [0.1_f64.sqrt(), 0.025_f64.sqrt(), 0.0]);
        assert_near(openpbr(1.0, 1.0), [2.0_f64.sqrt(), 0.0, 0.0]);
        assert_near(materialx(0.5, 0.75), [0.5, 0.125, 0.0]);
        assert_near(materialx(0.9, 0.75), [1.0, 0.405, 0.0]);
        assert_near(materialx(0.1, 1.0), [0.005_f64.sqrt(), 2e-6_f64.sqrt(), 0.0]);
        assert_near(disney(0.5, 1.0), [0.625_f64.sqrt(), 0.00625_f64.sqrt(), 0.0]);
        assert_near(disney(0.01, 0.0), [0.001, 0.001, 0.0]);
        assert_near(hdrp(0.5, 0.5), [0.375, 0.125, 0.0]);
        assert_near(hdrp(0.5, -1.0), [0.0, 0.5, 0.0]);
    }

    /// The invariants of the descriptions hold over their whole domain.
    #[test]
    fn invariants_hold() {
        for [r, a] in (0..=10).flat_map(|i| (0..=10).map(move |j| [i, j].map(|n| 0.1 * f64::from(n)))) {
            let found = openpbr(r, a);
            assert!(
                (found.alpha_x * found.alpha_x + found.alpha_y * found.alpha_y - 2.0 * (r * r) * (r * r)).abs() < 1e-12
            );
            let products = [materialx(r, a), disney(r, a)].map(|found| found.alpha_x * found.alpha_y);
            let caps = [r * r <= (1.0 - a).max(0.02).sqrt(), r * r * (1.0 - 0.9 * a).sqrt() > 0.001];
            for (product, is_uncapped) in products.into_iter().zip(caps) {
                assert_eq!(is_uncapped, (product - (r * r) * (r * r)).abs() < 1e-12, "{r} {a}: {product}");
            }
            assert_near(hdrp(1.0 - r, 1.0 - a), [2.0 * r * r * (1.0 - 0.5 * a), r * r * a, 0.0]);
        }
    }

    #[test]
    fn a_text_names_the_parameters_of_its_description() {
        let read = |text: &str| AnisotropicRoughness::parse(text).expect(text);
        assert_eq!(read("openpbr:specular_roughness=0.4, specular_roughness_anisotropy = 0.5"), openpbr(0.4, 0.5));
        assert_eq!(read("gltf:anisotropyRotation=-9,roughnessFactor=0.2"), gltf(0.2, 0.0, -9.0));
        assert_eq!(read("hdrp:_Anisotropy=-0.5"), hdrp(0.5, -0.5));
        let defaults = [gltf(1.0, 0.0, 0.0), openpbr(0.3, 0.0), materialx(0.0, 0.0), disney(0.5, 0.0), hdrp(0.5, 0.0)];
        for (model, default) in MaterialModel::ALL.iter().zip(defaults) {
            assert_eq!(read(model.name()), default);
            let given = |pick: fn(&MaterialParameter) -> f64| {
                let numbers =
                    model.parameters().iter().map(|parameter| format!("{}={}", parameter.name, pick(parameter)));
                AnisotropicRoughness::parse(&format!("{model}:{}", numbers.collect::<Vec<_>>().join(",")))
            };
            assert_eq!(given(|parameter| parameter.default), Ok(default));
            assert!(given(|parameter| parameter.range[1].min(1.0)).is_ok(), "{model}");
            let bounded = model.parameters().iter().filter(|parameter| parameter.range[0].is_finite()).count();
            let below = given(|parameter| (parameter.range[0] - 0.5).max(-9.0)).expect_err("below").0.len();
            assert_eq!(below, bounded, "{model}");
        }
    }

    #[test]
    fn every_fault_of_a_text_is_reported() {
        let refused = |text: &str| AnisotropicRoughness::parse(text).expect_err(text).to_string();
        assert_eq!(refused("pbr:roughness=1"), "«pbr» is not one of gltf, openpbr, materialx, disney, hdrp");
        assert_eq!(
            refused("openpbr:roughness=0.5,specular_roughness=1.5,specular_roughness_anisotropy"),
            "openpbr has no «roughness»; it has specular_roughness, specular_roughness_anisotropy; specular_roughness is \
             «1.5»; it must be from 0 to 1; specular_roughness_anisotropy is «»; it must be from 0 to 1"
        );
        let message = "anisotropyRotation is «inf»; it must be finite; roughnessFactor is given more than once";
        assert_eq!(refused("gltf:anisotropyRotation=inf,roughnessFactor=1,roughnessFactor=nan"), message);
    }

    #[test]
    fn a_turned_tangent_sees_what_turns_with_it() {
        let material = gltf(0.3, 0.5, FRAC_PI_2);
        assert_eq!(material.turned(DVec3::new(1.0, 2.0, 3.0)), DVec3::new(2.0, -1.0, 3.0));
        let configuration = material.seen_from(0.7, FRAC_PI_2);
        assert_eq!((configuration.phi, configuration.theta, configuration.alpha_y), (0.0, 0.7, material.alpha_y));
        assert_eq!(disney(1.0, 1.0).within_bounds().alpha_x, 1.0);
    }
}
