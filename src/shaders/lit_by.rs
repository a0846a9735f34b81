//! The kinds of shaders: a light model, and a layout for its tables.

use super::{AdditionError, Additions};
use ltcforge_fit::{Layout, named_list};
use ltcforge_light::{LightModel, NormalsRule};

/// The kind of a shader for other renderers: a model, and a layout if the model reads tables. Models `sg` and `asg`
/// share a text, whose functions take the model as an argument.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct LitBy {
    model: LightModel,
    layout: Option<Layout>,
    rule: Option<NormalsRule>,
    additions: Additions,
}

/// The model has no such shader.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum LitByError {
    /// The model needs a table.
    #[error("model {0} needs --layout, or --without-textures and a table")]
    NeedsLayout(LightModel),
    /// The model reads no table.
    #[error("model {0} reads no table: leave out --layout")]
    NoTable(LightModel),
    /// The model has no rules, or no shader for this rule.
    #[error("model {model} has no shader of rule {rule}{}", rules_of(*model))]
    NoRule {
        /// The model.
        model: LightModel,
        /// The rule.
        rule: NormalsRule,
    },
    /// The layout does not store the lobes of the model.
    #[error(
        "layout {layout} stores LTCs only: model {model} needs layout {layouts}",
        layouts = layouts_of(*model).join(" or ")
    )]
    NotStored {
        /// The model.
        model: LightModel,
        /// The layout.
        layout: Layout,
    },
}

/// The rules of a model's shaders, with a colon before them.
fn rules_of(model: LightModel) -> String {
    if model.rule_choices().is_empty() {
        return String::new();
    }
    format!(": its rules are {}", NormalsRule::SHADED.map(NormalsRule::name).join(", "))
}

/// The layouts that store a model's lobes.
fn layouts_of(model: LightModel) -> Vec<&'static str> {
    let stores = |layout: &&Layout| model.lobe().is_some_and(|lobe| layout.stores(lobe));
    Layout::ALL.iter().filter(stores).map(|layout| layout.name()).collect()
}

impl LitBy {
    /// The shader for a model and a layout. Without a layout, it is the shader for the model's formula.
    ///
    /// # Errors
    /// [`LitByError`] if the model has no such shader.
    pub fn new(model: LightModel, layout: Option<Layout>) -> Result<Self, LitByError> {
        match (model.lobe(), layout) {
            (_, None) if model.needs_table() => Err(LitByError::NeedsLayout(model)),
            (None, Some(_)) => Err(LitByError::NoTable(model)),
            (Some(lobe), Some(layout)) if !layout.stores(lobe) => Err(LitByError::NotStored { model, layout }),
            _ => {
                Ok(Self { model, layout, rule: model.rule_choices().first().copied(), additions: Additions::default() })
            }
        }
    }

    /// The shader with another rule. `None` keeps the default rule.
    ///
    /// # Errors
    /// [`LitByError::NoRule`].
    pub fn by_rule(self, rule: Option<NormalsRule>) -> Result<Self, LitByError> {
        match rule {
            None => Ok(self),
            Some(rule) if self.rule.is_some() && NormalsRule::SHADED.contains(&rule) => {
                Ok(Self { rule: Some(rule), ..self })
            }
            Some(rule) => Err(LitByError::NoRule { model: self.model, rule }),
        }
    }

    /// The shader with additions to its text.
    ///
    /// # Errors
    /// [`AdditionError`].
    pub fn with(self, additions: Additions) -> Result<Self, AdditionError> {
        additions.check(self.model)?;
        Ok(Self { additions, ..self })
    }

    /// The name: the model, its layout or rule, and its additions. Examples: `ltc reflected`, `normals fast`, `sg`,
    /// `ltc reflected, cut`.
    #[must_use]
    pub fn name(self) -> String {
        let kind = self.layout.map(Layout::name).or(self.rule.map(NormalsRule::name));
        let kind = kind.map_or(String::new(), |kind| format!(" {kind}"));
        let cut = if self.additions.cut { ", cut" } else { "" };
        let compensated = if self.additions.compensate { ", compensated" } else { "" };
        let textured = self.additions.textured.map_or(String::new(), |number| format!(", textured {number}"));
        format!("{}{kind}{cut}{compensated}{textured}", self.model)
    }

    /// The rule. `None` for a model without rules.
    #[must_use]
    pub fn rule(self) -> Option<NormalsRule> {
        self.rule
    }

    /// The additions to the shader text.
    #[must_use]
    pub fn additions(self) -> Additions {
        self.additions
    }

    /// Whether the shader text can look up a material by its number: for LTCs in layout `materials`.
    pub(super) fn reads_materials(self) -> bool {
        self.model == LightModel::Ltc && self.layout.is_some_and(Layout::is_of_materials)
    }

    /// The model.
    #[must_use]
    pub fn model(self) -> LightModel {
        self.model
    }

    /// The layout of its tables.
    #[must_use]
    pub fn layout(self) -> Option<Layout> {
        self.layout
    }
}

named_list! {
    /// The light shapes that the text for a table of LTCs supports.
    pub enum Lights {
        /// Polygons, disks, spheres, tubes and lines.
        All = "all",
        /// Only rectangles and polygons.
        Polygons = "polygons",
        /// Only rectangles, without the cheap horizon. The shortest text.
        Rectangles = "rectangles",
    }
}

/// How a shader text reads a table.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Reading {
    /// How it interpolates entries.
    pub filter: Filter,
    /// The textures that store the table.
    pub bound: Bound,
    /// Whether it reads the second lobe of a table of LTCs with two lobes.
    pub two_lobes: bool,
}

impl Reading {
    /// All ways to read one lobe, and two of the ways to read two lobes.
    pub const ALL: [Self; 6] = {
        use Bound::{Array, Volumes};
        use Filter::{Exact, Hardware};
        [
            Self { filter: Exact, bound: Volumes, two_lobes: false },
            Self { filter: Exact, bound: Array, two_lobes: false },
            Self { filter: Hardware, bound: Volumes, two_lobes: false },
            Self { filter: Hardware, bound: Array, two_lobes: false },
            Self { filter: Exact, bound: Volumes, two_lobes: true },
            Self { filter: Hardware, bound: Array, two_lobes: true },
        ]
    };
}

/// The textures that store a table.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Bound {
    /// Three 3D textures.
    #[default]
    Volumes,
    /// One 2D array. It needs one sampler in languages that have a sampler per texture.
    Array,
}

/// How the entries of a table are interpolated.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Filter {
    /// The shader interpolates: 16 fetches per texture, 32-bit weights, any texture format.
    #[default]
    Exact,
    /// The sampler interpolates along phi and theta, and along alpha in volumes: 2 fetches per texture, or 4 in an
    /// array. Many GPUs have 8-bit weights, whose steps are visible on sharp lobes. The textures must be filterable.
    Hardware,
}

impl From<Layout> for LitBy {
    fn from(layout: Layout) -> Self {
        Self { model: LightModel::Ltc, layout: Some(layout), rule: None, additions: Additions::default() }
    }
}
