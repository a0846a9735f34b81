//! Models of light and their rules, by the names that they have everywhere.

use clap::builder::{PossibleValuesParser, TypedValueParser as _};

use ltcforge_light::{LightModel, LightShape, WeightRule};
use ltcforge_view::plots::IsotropicFigure;

/// A model of light by its name.
pub(super) fn models() -> impl clap::builder::TypedValueParser<Value = LightModel> {
    PossibleValuesParser::new(LightModel::ALL.iter().map(|model| model.name()))
        .try_map(|name| LightModel::from_name(&name).ok_or("no model"))
}

/// A shape of lights by its name.
pub(super) fn light_shapes() -> impl clap::builder::TypedValueParser<Value = LightShape> {
    PossibleValuesParser::new(LightShape::ALL.iter().map(|shape| shape.name()))
        .try_map(|name| LightShape::from_name(&name).ok_or("no shape"))
}

/// A picture of isotropic fits by its name.
pub(super) fn isotropic_figures() -> impl clap::builder::TypedValueParser<Value = IsotropicFigure> {
    PossibleValuesParser::new(IsotropicFigure::ALL.iter().map(|figure| figure.name()))
        .try_map(|name| IsotropicFigure::from_name(&name).ok_or("no figure"))
}

/// A rule of the weight by its name.
pub(super) fn weights() -> impl clap::builder::TypedValueParser<Value = WeightRule> {
    PossibleValuesParser::new(WeightRule::ALL.iter().map(|rule| rule.name()))
        .try_map(|name| WeightRule::from_name(&name).ok_or("no rule"))
}
