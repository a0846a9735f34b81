//! The models of light. Each model has a folder and a line in [`LightModel`].

use super::{
    AreaLight, LightError, albedo, gaussians, ltc,
    ltc::{FormulaLobe, TableUse, by_blend, by_table_as, covered_in, edge_by_table},
    normals,
    normals::NormalsRule,
    rules::{Formula, LitPoint, ModelOfLight, ReflectedLight, lit, surface_and_view},
};
use ltcforge_fit::{BrdfKind, BrdfModel, Configuration, LobeModel, Table, brdf::edge_of_parts, named_list};

named_list! {
    /// The method that computes the light reflected by a surface.
    pub enum LightModel: ModelOfLight {
        /// The closed form in the space of normals, without a table.
        Normals = "normals" => normals::NormalsModel,
        /// A table of LTCs.
        Ltc = "ltc" => ltc::LtcModel,
        /// An LTC by a formula, without a table.
        LtcFormula = "ltc-formula" => ltc::formula::FormulaModel,
        /// A spherical Gaussian, from a formula or from a table.
        Sg = "sg" => gaussians::SG,
        /// An anisotropic spherical Gaussian, from a formula or from a table.
        Asg = "asg" => gaussians::ASG,
    }
}

/// A model of light without a table, with its rule.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ClosedForm {
    model: LightModel,
    rule: NormalsRule,
    /// Whether an LTC and the light are cut at the surface.
    cut: bool,
}

/// A model of light with its table, if any.
#[derive(Debug, Clone, Copy)]
pub enum Lighting<'a> {
    /// A formula for GGX.
    ClosedForm(ClosedForm),
    /// A table of any scattering model, with its options.
    Table(&'a Table, TableUse),
}

impl LightModel {
    /// The model for tables of a lobe model.
    #[must_use]
    pub fn of_lobe(lobe: LobeModel) -> Self {
        Self::ALL.iter().copied().find(|model| model.lobe() == Some(lobe)).unwrap_or(Self::Ltc)
    }

    /// The lobe model of the model's tables; `None` for a model without tables.
    #[must_use]
    pub fn lobe(self) -> Option<LobeModel> {
        self.rules().lobe()
    }

    /// True if the model only works with a table.
    #[must_use]
    pub fn needs_table(self) -> bool {
        self.rules().formula().is_none()
    }

    /// The choices of option `--rule`, the default first; empty for a model without the option.
    #[must_use]
    pub fn rule_choices(self) -> &'static [NormalsRule] {
        self.rules().formula().map_or(&[], Formula::choices)
    }

    /// The model without a table; `None` if the model needs a table. The default replaces a missing rule, and any rule
    /// given for a model without choices.
    #[must_use]
    pub fn closed_form(self, rule: Option<NormalsRule>) -> Option<ClosedForm> {
        let usual = NormalsRule::ALL[0];
        let rule = if self.rule_choices().is_empty() { usual } else { rule.unwrap_or(usual) };
        (!self.needs_table()).then_some(ClosedForm { model: self, rule, cut: false })
    }

    /// The model without a table, for each of its rules; empty if it needs a table.
    pub fn closed_forms(self) -> impl Iterator<Item = ClosedForm> {
        let rules = if self.rule_choices().is_empty() { &NormalsRule::ALL[..1] } else { self.rule_choices() };
        rules.iter().filter_map(move |rule| self.closed_form(Some(*rule)))
    }

    /// True for models based on LTCs. They integrate every shape exactly and support `cut`.
    #[must_use]
    pub fn is_of_ltcs(self) -> bool {
        matches!(self, Self::Ltc | Self::LtcFormula)
    }

    /// True for models that support pictures on rectangle lights.
    #[must_use]
    pub fn has_pictures(self) -> bool {
        self.is_of_ltcs() || self == Self::Normals
    }

    /// The cost of a pixel of a preview with the formula, in samples of its reference. For a model without a formula it
    /// is the cost with a table.
    #[must_use]
    pub fn cost(self) -> u32 {
        self.rules().formula().map_or(self.table_cost(), Formula::cost)
    }

    /// The cost of a pixel of a preview with a table.
    #[must_use]
    pub fn table_cost(self) -> u32 {
        self.rules().table_cost()
    }

    /// The names of the models for which a condition holds, joined as in a sentence: `normals, sg and asg`.
    #[must_use]
    pub fn names_of(holds: impl Fn(Self) -> bool) -> String {
        let names: Vec<&str> = Self::ALL.iter().filter(|model| holds(**model)).map(|model| model.name()).collect();
        listed(&names)
    }
}

/// Joins names as in a sentence: `a, b and c`.
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

    /// The rule; the default for a model without choices.
    #[must_use]
    pub fn rule(self) -> NormalsRule {
        self.rule
    }

    /// The chosen rule; `None` for a model without choices.
    #[must_use]
    pub fn chosen_rule(self) -> Option<NormalsRule> {
        (!self.model.rule_choices().is_empty()).then_some(self.rule)
    }

    /// Sets whether lobe and light are clipped at the surface. No effect on models that are not LTCs.
    #[must_use]
    pub fn with_cut(self, cut: bool) -> Self {
        Self { cut, ..self }
    }

    /// The light that a surface reflects. Except for LTCs, shapes are replaced by the polygons of
    /// [`ShapedLight::outline`](super::ShapedLight::outline).
    ///
    /// # Errors
    /// [`LightError::Domain`] for a roughness outside [0, 1] or a view direction on or below the horizon, and the
    /// errors of the outline.
    pub fn reflected<'a>(
        self,
        at: &Configuration,
        light: impl Into<AreaLight<'a>>,
    ) -> Result<ReflectedLight, LightError> {
        self.reflected_by(at, light.into(), [1.0, 1.0])
    }

    /// The light that a material with Schlick's Fresnel factor reflects. `ltc-formula` shapes its lobe for this material.
    ///
    /// # Errors
    /// The errors of [`ClosedForm::reflected`].
    pub fn of_material<'a>(
        self,
        at: &Configuration,
        light: impl Into<AreaLight<'a>>,
        [f0, f90]: [f64; 2],
    ) -> Result<f64, LightError> {
        Ok(self.reflected_by(at, light.into(), [f0, f90])?.schlick(f0, f90))
    }

    fn reflected_by(
        self,
        at: &Configuration,
        light: AreaLight<'_>,
        fresnel: [f64; 2],
    ) -> Result<ReflectedLight, LightError> {
        let Some(formula) = self.model.rules().formula() else { return Ok(ReflectedLight::NONE) };
        if let Some(lobe) = self.lobe(at, fresnel)? {
            let covered = covered_in(lobe.space, light, self.cut);
            return Ok(ReflectedLight { energy: lobe.parts[0] * covered, fresnel: lobe.parts[1] * covered });
        }
        lit(at, light, |lit| formula.reflected(lit, self.rule))
    }

    /// The LTC for this reflectance at normal and at grazing incidence; `None` for a model that is not an LTC.
    pub(super) fn lobe(self, at: &Configuration, fresnel: [f64; 2]) -> Result<Option<FormulaLobe<f64>>, LightError> {
        let (alpha, wo) = surface_and_view(at)?;
        Ok(self.model.rules().formula().and_then(|formula| formula.lobe(alpha, wo.to_array(), fresnel)))
    }

    /// Whether lobe and light are clipped at the surface.
    pub(super) fn is_cut(self) -> bool {
        self.cut
    }

    /// The light weighted by F82's edge weight: see [`ReflectedLight::metal`].
    ///
    /// # Errors
    /// The errors of [`ClosedForm::reflected`].
    pub fn edge<'a>(self, at: &Configuration, light: impl Into<AreaLight<'a>>) -> Result<f64, LightError> {
        if self.model.is_of_ltcs() {
            let ReflectedLight { energy, fresnel } = self.reflected(at, light)?;
            return Ok(edge_of_parts([energy, fresnel]));
        }
        let formula = self.model.rules().formula();
        let of = |lit: &LitPoint<'_, f64>| [formula.map_or(0.0, |formula| formula.edge(lit, self.rule)), 0.0];
        lit(at, light.into(), of).map(|found| found.energy)
    }

    /// The reflected light in f32, for a Fresnel factor of one and weighted by Schlick's factor.
    #[must_use]
    pub fn reflected_f32(self, lit: &LitPoint<'_, f32>) -> [f32; 2] {
        self.model.rules().formula().map_or([0.0; 2], |formula| formula.reflected_f32(lit, self.rule))
    }
}

impl<'a> Lighting<'a> {
    /// A table with default options.
    #[must_use]
    pub fn by(table: &'a Table) -> Self {
        Self::Table(table, TableUse::default())
    }

    /// The same model with another table. A formula is unchanged.
    pub(super) fn with_table(self, table: &'a Table) -> Self {
        match self {
            Self::ClosedForm(_) => self,
            Self::Table(_, used) => Self::Table(table, used),
        }
    }
}

impl Lighting<'_> {
    /// The light that a surface reflects.
    ///
    /// # Errors
    /// The errors of [`ClosedForm::reflected`] and [`by_table_as`].
    pub fn reflected<'a>(
        self,
        at: &Configuration,
        light: impl Into<AreaLight<'a>>,
    ) -> Result<ReflectedLight, LightError> {
        match self {
            Self::ClosedForm(form) => form.reflected(at, light),
            Self::Table(table, used) => by_table_as(table, at, light, used),
        }
    }

    /// The light that a material with Schlick's Fresnel factor reflects. Its reflectance is `f0` at normal and `f90` at
    /// grazing incidence.
    ///
    /// # Errors
    /// The errors of [`Lighting::reflected`] and [`by_blend`].
    pub fn of_material<'a>(
        self,
        at: &Configuration,
        light: impl Into<AreaLight<'a>>,
        [f0, f90]: [f64; 2],
    ) -> Result<f64, LightError> {
        match self {
            Self::Table(table, used) if used.blend => by_blend(table, at, light, [f0, f90], used),
            Self::ClosedForm(form) => form.of_material(at, light, [f0, f90]),
            Self::Table(..) => Ok(self.reflected(at, light)?.schlick(f0, f90)),
        }
    }

    /// The part of uniform light that is reflected, for a Fresnel factor of one. For LTCs it is the amplitude. For the
    /// other models it is [`albedo`](super::albedo::albedo), because the amplitude of a Gaussian covers its whole plane.
    ///
    /// # Errors
    /// [`LightError::NoFacets`] for a table of a scattering model without facets, [`LightError::NoTerms`], and
    /// [`LightError::Domain`] as for [`Self::reflected`].
    pub fn albedo(self, at: &Configuration) -> Result<f64, LightError> {
        let ggx = albedo::of_ggx(at)?;
        let table = match self {
            Self::Table(table, _) => table,
            Self::ClosedForm(form) => return Ok(form.lobe(at, [1.0; 2])?.map_or(ggx, |lobe| lobe.parts[0])),
        };
        albedo::check(&table.brdf)?;
        if table.lobe.gaussian().is_some() {
            return Ok(ggx);
        }
        table.lookup(at).amplitude.ok_or(LightError::NoTerms)
    }

    /// The table; `None` for a formula.
    pub(super) fn table(&self) -> Option<&Table> {
        match self {
            Self::ClosedForm(_) => None,
            Self::Table(table, _) => Some(table),
        }
    }

    /// The light weighted by F82's edge weight: see [`ReflectedLight::metal`].
    ///
    /// # Errors
    /// The errors of [`Lighting::reflected`], and [`LightError::NoEdge`] for a table without the edge term.
    pub fn edge<'a>(self, at: &Configuration, light: impl Into<AreaLight<'a>>) -> Result<f64, LightError> {
        match self {
            Self::ClosedForm(form) => form.edge(at, light),
            Self::Table(table, used) => edge_by_table(table, at, light, used),
        }
    }

    /// Checks that the model is for a scattering model.
    ///
    /// # Errors
    /// [`LightError::OtherLights`] for a table of another scattering model, [`LightError::OtherBrdf`] for a formula
    /// with another scattering model than GGX.
    pub(super) fn check_brdf(self, brdf: &BrdfModel) -> Result<(), LightError> {
        match self {
            Self::Table(table, _) if !table.brdf.is_surface_of(brdf) => {
                Err(LightError::OtherLights { lights: brdf.kind(), table: table.brdf() })
            }
            Self::ClosedForm(_) if *brdf != BrdfKind::Ggx => Err(LightError::OtherBrdf(brdf.kind())),
            _ => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn models_are_listed_as_sentences_do() {
        assert_eq!(LightModel::names_of(|model| !model.needs_table()), "normals, ltc-formula, sg and asg");
        assert_eq!([listed(&[]), listed(&["a"]), listed(&["a", "b"])], ["", "a", "a and b"]);
        for lobe in LobeModel::ALL {
            assert_eq!(LightModel::of_lobe(*lobe).lobe(), Some(*lobe));
        }
    }
}
