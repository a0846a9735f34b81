//! The models of light: one folder each, and a line in [`LightModel`].

use std::f64::consts::FRAC_PI_2;

use glam::DVec3;

use super::{AreaLight, LightError, gaussians, ltc, normals, normals::WeightRule};
use ltcforge_fit::{
    BrdfKind, Configuration, LEAST_ALPHA, LobeModel, Sides, Table,
    math::{Triple, direction},
    named_list,
};

named_list! {
    /// How the light that a surface reflects is found.
    pub enum LightModel: ModelOfLight {
        /// The closed form in the space of normals, without a table.
        Normals = "normals" => normals::Rules,
        /// A table of LTCs.
        Ltc = "ltc" => ltc::Rules,
        /// A spherical Gaussian, without a table or by one.
        Sg = "sg" => gaussians::SG,
        /// An anisotropic spherical Gaussian, without a table or by one.
        Asg = "asg" => gaussians::ASG,
    }
}

/// What a model of light is: a formula, a table of lobes, or either.
pub(crate) trait ModelOfLight: Sync {
    /// The light of GGX without a table; `None` for a model that has tables alone.
    fn formula(&self) -> Option<&dyn Formula>;

    /// The light by a table; `None` for a model that reads none.
    fn table(&self) -> Option<TableLight>;
}

/// The light of GGX in closed form.
pub(crate) trait Formula: Sync {
    /// The rules among which option `--weight` chooses, the default first; empty for a formula without the option.
    fn weights(&self) -> &'static [WeightRule] {
        &[]
    }

    /// The cost of a pixel, in samples of the preview's reference.
    fn cost(&self) -> u32;

    /// What is reflected of a polygon of radiance one: for a Fresnel factor of one, and its part weighed by Schlick's
    /// `(1 - wo . h)^5`.
    fn reflected(&self, lit: &LitPoint<'_, f64>, rule: WeightRule) -> [f64; 2];

    /// The same in the numbers of a shader.
    fn reflected_f32(&self, lit: &LitPoint<'_, f32>, rule: WeightRule) -> [f32; 2];
}

/// The light by a table.
#[derive(Debug, Clone, Copy)]
pub(crate) struct TableLight {
    /// What stands for a lobe in its tables.
    pub(crate) lobe: LobeModel,
    /// The cost of a pixel, in samples of the preview's reference.
    pub(crate) cost: u32,
}

/// A surface, a view of it, and the vertices of a light around the shaded point, in its tangent frame.
#[derive(Debug, Clone, Copy)]
pub struct LitPoint<'a, T> {
    /// Roughness along x and y.
    pub alpha: [T; 2],
    /// The direction of the viewer, of length one.
    pub wo: Triple<T>,
    /// Of a convex polygon.
    pub vertices: &'a [Triple<T>],
    /// From where it is lit.
    pub sides: Sides,
}

/// A model of light without a table, and its rule of the weight.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ClosedForm {
    model: LightModel,
    rule: WeightRule,
}

/// A model of light and what it reads.
#[derive(Debug, Clone, Copy)]
pub enum Lighting<'a> {
    /// A formula, of GGX.
    ClosedForm(ClosedForm),
    /// A table, of any scattering model.
    Table(&'a Table),
}

impl LightModel {
    /// The model that lights by tables of a lobe.
    #[must_use]
    pub fn of_lobe(lobe: LobeModel) -> Self {
        Self::ALL.iter().copied().find(|model| model.lobe() == Some(lobe)).unwrap_or(Self::Ltc)
    }

    /// What stands for a lobe in the model's tables; `None` for a model that reads none.
    #[must_use]
    pub fn lobe(self) -> Option<LobeModel> {
        self.rules().table().map(|table| table.lobe)
    }

    /// Whether there is no light by it without a table.
    #[must_use]
    pub fn needs_table(self) -> bool {
        self.rules().formula().is_none()
    }

    /// The rules among which option `--weight` chooses, the default first; empty for a model without the option.
    #[must_use]
    pub fn weights(self) -> &'static [WeightRule] {
        self.rules().formula().map_or(&[], Formula::weights)
    }

    /// The model without a table; `None` where it needs one. The rule is the default where none is chosen, and where the
    /// model has no choice.
    #[must_use]
    pub fn closed_form(self, rule: Option<WeightRule>) -> Option<ClosedForm> {
        let usual = WeightRule::ALL[0];
        let rule = if self.weights().is_empty() { usual } else { rule.unwrap_or(usual) };
        (!self.needs_table()).then_some(ClosedForm { model: self, rule })
    }

    /// The model without a table, under each of its rules; none where it needs one.
    pub fn closed_forms(self) -> impl Iterator<Item = ClosedForm> {
        let rules = if self.weights().is_empty() { &WeightRule::ALL[..1] } else { self.weights() };
        rules.iter().filter_map(move |rule| self.closed_form(Some(*rule)))
    }

    /// The cost of a pixel of a preview by a formula, in samples of its reference; by a table where the model needs one.
    #[must_use]
    pub fn cost(self) -> u32 {
        self.rules().formula().map_or_else(|| self.table_cost(), Formula::cost)
    }

    /// The same by a table.
    #[must_use]
    pub fn table_cost(self) -> u32 {
        self.rules().table().map_or(0, |table| table.cost)
    }

    /// The names of the models that have a formula, as a sentence lists them: `normals, sg and asg`.
    #[must_use]
    pub fn names_without_table() -> String {
        Self::names_of(|model| !model.needs_table())
    }

    /// The names of the models that have a choice among rules of the weight, as a sentence lists them.
    #[must_use]
    pub fn names_with_weights() -> String {
        Self::names_of(|model| !model.weights().is_empty())
    }

    /// The names of the models for which something holds, as a sentence lists them.
    #[must_use]
    pub fn names_of(is_told: impl Fn(Self) -> bool) -> String {
        let names: Vec<&str> = Self::ALL.iter().filter(|model| is_told(**model)).map(|model| model.name()).collect();
        listed(&names)
    }
}

/// Names as a sentence lists them: `a, b and c`.
fn listed(names: &[&str]) -> String {
    match names {
        [first @ .., last] if !first.is_empty() => format!("{} and {last}", first.join(", ")),
        _ => names.concat(),
    }
}

impl ClosedForm {
    /// The model.
    #[must_use]
    pub fn model(self) -> LightModel {
        self.model
    }

    /// The rule of the weight; the default where the model has no choice.
    #[must_use]
    pub fn rule(self) -> WeightRule {
        self.rule
    }

    /// The rule of the weight; `None` where the model has no choice.
    #[must_use]
    pub fn weight(self) -> Option<WeightRule> {
        (!self.model.weights().is_empty()).then_some(self.rule)
    }

    /// What a surface reflects of a light. Shapes are lit as the polygons that
    /// [`ShapedLight::outline`](super::ShapedLight::outline) tells.
    ///
    /// # Errors
    /// [`LightError::Domain`] for a roughness outside [0, 1] or a view direction on or below the horizon, and those of the outline.
    pub fn reflected<'a>(self, at: &Configuration, light: impl Into<AreaLight<'a>>) -> Result<Reflected, LightError> {
        let formula = self.model.rules().formula();
        lit(at, light.into(), |lit| formula.map_or([0.0; 2], |formula| formula.reflected(lit, self.rule)))
    }

    /// The same in the numbers of a shader: for a Fresnel factor of one, and its part weighed by Schlick's factor.
    #[must_use]
    pub fn reflected_f32(self, lit: &LitPoint<'_, f32>) -> [f32; 2] {
        self.model.rules().formula().map_or([0.0; 2], |formula| formula.reflected_f32(lit, self.rule))
    }
}

impl Lighting<'_> {
    /// What a surface reflects of a light.
    ///
    /// # Errors
    /// Those of [`ClosedForm::reflected`] and [`by_table`](super::by_table).
    pub fn reflected<'a>(self, at: &Configuration, light: impl Into<AreaLight<'a>>) -> Result<Reflected, LightError> {
        match self {
            Self::ClosedForm(form) => form.reflected(at, light),
            Self::Table(table) => super::by_table(table, at, light),
        }
    }

    /// Whether it is light of a scattering model.
    ///
    /// # Errors
    /// [`LightError::OtherLights`] for a table of another, [`LightError::OtherBrdf`] for a formula where it is not GGX.
    pub(super) fn check_brdf(self, brdf: &ltcforge_fit::BrdfModel) -> Result<(), LightError> {
        match self {
            Self::Table(table) if table.brdf != *brdf => {
                Err(LightError::OtherLights { lights: brdf.kind(), table: table.brdf() })
            }
            Self::ClosedForm(_) if *brdf != BrdfKind::Ggx => Err(LightError::OtherBrdf(brdf.kind())),
            _ => Ok(()),
        }
    }
}

/// What GGX reflects of a light of radiance one towards the viewer.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reflected {
    /// For a Fresnel factor of one: in [0, 1].
    pub energy: f64,
    /// The same weighed by Schlick's `(1 - wo . h)^5`: in [0, 1].
    pub fresnel: f64,
}

impl Reflected {
    /// Nothing.
    pub const NONE: Self = Self { energy: 0.0, fresnel: 0.0 };

    /// What is reflected by Schlick's Fresnel factor, `f0` face on and `f90` at grazing incidence:
    /// `f0 (energy - fresnel) + f90 fresnel`.
    #[must_use]
    pub fn schlick(&self, f0: f64, f90: f64) -> f64 {
        f0 * (self.energy - self.fresnel) + f90 * self.fresnel
    }
}

/// A surface's roughnesses along x and y, raised to [`LEAST_ALPHA`], and the direction from which it is seen.
pub(super) fn surface_and_view(at: &Configuration) -> Result<([f64; 2], DVec3), LightError> {
    for (what, value) in [("alpha_x", at.alpha_x), ("alpha_y", at.alpha_y)] {
        if !(0.0..=1.0).contains(&value) {
            return Err(LightError::Domain { what, value, allowed: "roughness is a number from 0 to 1" });
        }
    }
    if !(0.0..FRAC_PI_2).contains(&at.theta) {
        let allowed = "a polar angle is a number from 0 to below pi/2";
        return Err(LightError::Domain { what: "theta", value: at.theta, allowed });
    }
    if !at.phi.is_finite() {
        return Err(LightError::Domain { what: "phi", value: at.phi, allowed: "an azimuth is a finite number" });
    }
    Ok(([at.alpha_x.max(LEAST_ALPHA), at.alpha_y.max(LEAST_ALPHA)], direction(at.theta, at.phi)))
}

/// What `of` says of a surface, a view and a light that are checked.
pub(super) fn lit(
    at: &Configuration,
    light: AreaLight<'_>,
    of: impl FnOnce(&LitPoint<'_, f64>) -> [f64; 2],
) -> Result<Reflected, LightError> {
    let (alpha, wo) = surface_and_view(at)?;
    let (vertices, sides) = light.polygon()?;
    let [energy, fresnel] = of(&LitPoint { alpha, wo: wo.to_array(), vertices: &vertices, sides });
    Ok(Reflected { energy, fresnel })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn schlicks_factor_goes_from_f0_to_f90() {
        let parts = Reflected { energy: 0.5, fresnel: 0.125 };
        assert_eq!(parts.schlick(1.0, 1.0), 0.5);
        assert_eq!(parts.schlick(0.0, 1.0), 0.125);
        assert_eq!(parts.schlick(1.0, 0.0), 0.375);
    }

    #[test]
    fn models_are_listed_as_sentences_do() {
        assert_eq!(LightModel::names_without_table(), "normals, sg and asg");
        assert_eq!([listed(&[]), listed(&["a"]), listed(&["a", "b"])], ["", "a", "a and b"]);
        for lobe in LobeModel::ALL {
            assert_eq!(LightModel::of_lobe(*lobe).lobe(), Some(*lobe));
        }
    }

    #[test]
    fn what_has_no_reflection_is_refused() {
        let good = Configuration { alpha_x: 0.3, alpha_y: 0.3, theta: 0.8, phi: 0.0 };
        assert!(surface_and_view(&good).is_ok());
        let (alpha, _) = surface_and_view(&Configuration { alpha_x: 0.0, ..good }).expect("a mirror");
        assert_eq!(alpha, [LEAST_ALPHA, 0.3]);
        let wrong = [
            ("alpha_x", Configuration { alpha_x: 1.5, ..good }),
            ("alpha_y", Configuration { alpha_y: f64::NAN, ..good }),
            ("theta", Configuration { theta: FRAC_PI_2, ..good }),
            ("theta", Configuration { theta: f64::NAN, ..good }),
            ("phi", Configuration { phi: f64::INFINITY, ..good }),
        ];
        for (name, at) in wrong {
            let refused = surface_and_view(&at);
            assert!(matches!(refused, Err(LightError::Domain { what, .. }) if what == name), "{at:?}: {refused:?}");
        }
    }
}
