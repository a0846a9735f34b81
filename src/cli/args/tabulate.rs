//! `tabulate`: a scattering model as a file of numbers.

use std::path::PathBuf;

use clap::{
    Args,
    builder::{PossibleValuesParser, TypedValueParser as _},
};

use ltcforge_fit::BrdfKind;

/// `tabulate`.
#[derive(Debug, Args)]
pub struct TabulateArgs {
    /// The scattering model
    #[arg(value_parser = formulas())]
    pub brdf: BrdfKind,
    /// The file
    #[arg(short, long, value_name = "FILE")]
    pub out: PathBuf,
    /// Roughnesses, ascending; none for one surface, the roughest
    #[arg(long, value_name = "ALPHA,...", value_delimiter = ',')]
    pub alpha: Vec<f64>,
    /// Ratios of roughnesses, ascending, for a file of anisotropic surfaces; none for an isotropic one
    #[arg(long, value_name = "RATIO,...", value_delimiter = ',')]
    pub ratio: Vec<f64>,
    /// Nodes of the polar angle of the light, closer towards the horizon; the view has the same nodes up to 85 degrees
    #[arg(long, value_name = "N", default_value_t = 48, value_parser = clap::value_parser!(u16).range(4..=1024))]
    pub theta: u16,
    /// Nodes of the azimuth of the view, a quarter of a turn
    #[arg(long, value_name = "N", default_value_t = 9, requires = "ratio", value_parser = clap::value_parser!(u16).range(2..=256))]
    pub phi_o: u16,
    /// Nodes of the difference of azimuths on one side; with --ratio as many on the other, closer across from the view
    #[arg(long, value_name = "N", default_value_t = 32, value_parser = clap::value_parser!(u16).range(4..=1024))]
    pub phi: u16,
}

/// A model that needs no file, by its name.
fn formulas() -> impl clap::builder::TypedValueParser<Value = BrdfKind> {
    PossibleValuesParser::new(BrdfKind::formulas().map(BrdfKind::name))
        .try_map(|name| BrdfKind::from_name(&name).ok_or("no model"))
}
