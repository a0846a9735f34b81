//! The models of light: one folder each, and a line in [`LightModel`].

use super::{
    AreaLight, LightError, albedo, gaussians, ltc,
    ltc::{TableUse, by_blend, by_table_as, edge_by_table},
    normals,
    normals::NormalsRule,
    rules::{Formula, LitPoint, ModelOfLight, ReflectedLight, lit},
};
use ltcforge_fit::{BrdfKind, BrdfModel, Configuration, LobeModel, Table, named_list};

named_list! {
    /// How the light that a surface reflects is found.
    pub enum LightModel: ModelOfLight {
        /// The closed form in the space of normals, without a table.
        Normals = "normals" => normals::NormalsModel,
        /// A table of LTCs.
        Ltc = "ltc" => ltc::LtcModel,
        /// A spherical Gaussian, without a table or by one.
        Sg = "sg" => gaussians::SG,
        /// An anisotropic spherical Gaussian, without a table or by one.
        Asg = "asg" => gaussians::ASG,
    }
}

/// A model of light without a table, and its rule.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ClosedForm {
    model: LightModel,
    rule: NormalsRule,
}

/// A model of light, and the table that it reads.
#[derive(Debug, Clone, Copy)]
pub enum Lighting<'a> {
    /// A formula, of GGX.
    ClosedForm(ClosedForm),
    /// A table, of any scattering model, and how it is used.
    Table(&'a Table, TableUse),
}

impl LightModel {
    /// The model that lights by tables of a lobe.
    #[must_use]
    pub fn of_lobe(lobe: LobeModel) -> Self {
        Self::ALL.iter().copied().find(|model| model.lobe() == Some(lobe)).unwrap_or(Self::Ltc)
    }

    /// The lobe model of the model's tables; `None` for a model without a table.
    #[must_use]
    pub fn lobe(self) -> Option<LobeModel> {
        self.rules().lobe()
    }

    /// Whether there is no light by it without a table.
    #[must_use]
    pub fn needs_table(self) -> bool {
        self.rules().formula().is_none()
    }

    /// The rules among which option `--rule` chooses, the default first; empty for a model without the option.
    #[must_use]
    pub fn rule_choices(self) -> &'static [NormalsRule] {
        self.rules().formula().map_or(&[], Formula::choices)
    }

    /// The model without a table; `None` where it needs one. The rule is the default where none is chosen, and where
    /// the model has no choice.
    #[must_use]
    pub fn closed_form(self, rule: Option<NormalsRule>) -> Option<ClosedForm> {
        let usual = NormalsRule::ALL[0];
        let rule = if self.rule_choices().is_empty() { usual } else { rule.unwrap_or(usual) };
        (!self.needs_table()).then_some(ClosedForm { model: self, rule })
    }

    /// The model without a table, under each of its rules; none where it needs one.
    pub fn closed_forms(self) -> impl Iterator<Item = ClosedForm> {
        let rules = if self.rule_choices().is_empty() { &NormalsRule::ALL[..1] } else { self.rule_choices() };
        rules.iter().filter_map(move |rule| self.closed_form(Some(*rule)))
    }

    /// The cost of a pixel of a preview by a formula, in samples of its reference; by a table where the model needs
    /// one.
    #[must_use]
    pub fn cost(self) -> u32 {
        self.rules().formula().map_or(self.table_cost(), Formula::cost)
    }

    /// The same by a table.
    #[must_use]
    pub fn table_cost(self) -> u32 {
        self.rules().table_cost()
    }

    /// The names of the models for which something holds, as a sentence lists them: `normals, sg and asg`.
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

    /// The rule; the default where the model has no choice.
    #[must_use]
    pub fn rule(self) -> NormalsRule {
        self.rule
    }

    /// The rule that was chosen; `None` where the model has no choice.
    #[must_use]
    pub fn chosen_rule(self) -> Option<NormalsRule> {
        (!self.model.rule_choices().is_empty()).then_some(self.rule)
    }

    /// The light that a surface reflects. Shapes are lit as the polygons that
    /// [`ShapedLight::outline`](super::ShapedLight::outline) tells.
    ///
    /// # Errors
    /// [`LightError::Domain`] for a roughness outside [0, 1] or a view direction on or below the horizon, and those of
    /// the outline.
    pub fn reflected<'a>(
        self,
        at: &Configuration,
        light: impl Into<AreaLight<'a>>,
    ) -> Result<ReflectedLight, LightError> {
        let formula = self.model.rules().formula();
        lit(at, light.into(), |lit| formula.map_or([0.0; 2], |formula| formula.reflected(lit, self.rule)))
    }

    /// The same light weighed by F82's edge: see [`ReflectedLight::metal`].
    ///
    /// # Errors
    /// As [`ClosedForm::reflected`].
    pub fn edge<'a>(self, at: &Configuration, light: impl Into<AreaLight<'a>>) -> Result<f64, LightError> {
        let formula = self.model.rules().formula();
        let of = |lit: &LitPoint<'_, f64>| [formula.map_or(0.0, |formula| formula.edge(lit, self.rule)), 0.0];
        lit(at, light.into(), of).map(|found| found.energy)
    }

    /// The same in the numbers of a shader: for a Fresnel factor of one, and its part weighed by Schlick's factor.
    #[must_use]
    pub fn reflected_f32(self, lit: &LitPoint<'_, f32>) -> [f32; 2] {
        self.model.rules().formula().map_or([0.0; 2], |formula| formula.reflected_f32(lit, self.rule))
    }
}

impl<'a> Lighting<'a> {
    /// A table as it is used where nothing is chosen.
    #[must_use]
    pub fn by(table: &'a Table) -> Self {
        Self::Table(table, TableUse::default())
    }

    /// The same by another table; a formula has none.
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
    /// Those of [`ClosedForm::reflected`] and [`by_table_as`].
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

    /// What a material reflects by Schlick's Fresnel factor, `f0` face on and `f90` at grazing incidence.
    ///
    /// # Errors
    /// Those of [`Lighting::reflected`] and [`by_blend`].
    pub fn of_material<'a>(
        self,
        at: &Configuration,
        light: impl Into<AreaLight<'a>>,
        [f0, f90]: [f64; 2],
    ) -> Result<f64, LightError> {
        match self {
            Self::Table(table, used) if used.blend => by_blend(table, at, light, [f0, f90], used),
            _ => Ok(self.reflected(at, light)?.schlick(f0, f90)),
        }
    }

    /// What is reflected of light from everywhere, for a Fresnel factor of one: a table's amplitude, and
    /// [`albedo`](super::albedo::albedo) of formulas and of tables of Gaussians, whose amplitude is of their whole plane.
    ///
    /// # Errors
    /// [`LightError::NoFacets`] for a table of a scattering model other than of facets, [`LightError::NoTerms`],
    /// [`LightError::Domain`] as [`Self::reflected`].
    pub fn albedo(self, at: &Configuration) -> Result<f64, LightError> {
        let ggx = albedo::of_ggx(at)?;
        let Some(table) = self.table() else { return Ok(ggx) };
        albedo::check(&table.brdf)?;
        if table.lobe.gaussian().is_some() {
            return Ok(ggx);
        }
        table.lookup(at).amplitude.ok_or(LightError::NoTerms)
    }

    /// The table; `None` of a formula.
    pub(super) fn table(&self) -> Option<&Table> {
        match self {
            Self::ClosedForm(_) => None,
            Self::Table(table, _) => Some(table),
        }
    }

    /// The same light weighed by F82's edge: see [`ReflectedLight::metal`].
    ///
    /// # Errors
    /// As [`Lighting::reflected`], and [`LightError::NoEdge`] for a table without that term.
    pub fn edge<'a>(self, at: &Configuration, light: impl Into<AreaLight<'a>>) -> Result<f64, LightError> {
        match self {
            Self::ClosedForm(form) => form.edge(at, light),
            Self::Table(table, used) => edge_by_table(table, at, light, used),
        }
    }

    /// Whether it is light of a scattering model.
    ///
    /// # Errors
    /// [`LightError::OtherLights`] for a table of another, [`LightError::OtherBrdf`] for a formula where it is not GGX.
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
        assert_eq!(LightModel::names_of(|model| !model.needs_table()), "normals, sg and asg");
        assert_eq!([listed(&[]), listed(&["a"]), listed(&["a", "b"])], ["", "a", "a and b"]);
        for lobe in LobeModel::ALL {
            assert_eq!(LightModel::of_lobe(*lobe).lobe(), Some(*lobe));
        }
    }
}
