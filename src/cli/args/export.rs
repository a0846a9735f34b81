//! `export`: a table in the files of engines.

use std::path::PathBuf;

use clap::{
    ArgGroup, Args,
    builder::{PossibleValue, PossibleValuesParser, TypedValueParser},
};

use super::{TableChoice, Threads};
use crate::{
    files::textures::{Engine, TextureContainer},
    fit::Precision,
};

/// `export`.
#[derive(Debug, Args)]
#[command(group(ArgGroup::new("what").args(["engine", "layout"]).required(true)))]
pub struct ExportArgs {
    /// The table
    #[command(flatten)]
    pub table: TableChoice,
    /// Which files
    #[command(flatten)]
    pub choice: ExportChoice,
    /// The folder; it is made where it is missing
    #[arg(short, long, value_name = "DIR")]
    pub out: PathBuf,
    /// How many threads measure the table, whose files state how good it is
    #[command(flatten)]
    pub threads: Threads,
}

/// Which files to make of a table.
#[derive(Debug, Clone, PartialEq, Eq, Args)]
pub struct ExportChoice {
    /// Write the files of this engine, under its names
    #[arg(long = "for", value_name = "ENGINE", value_parser = engines(), requires = "out")]
    pub engine: Option<Engine>,
    /// Write textures of this layout, in a format of one's own choice
    #[arg(long, value_name = "NAME", requires = "container", requires = "out", conflicts_with = "engine")]
    pub layout: Option<String>,
    /// The files' format
    #[arg(long, value_name = "NAME", value_parser = containers(), requires = "layout")]
    pub container: Option<TextureContainer>,
    /// Bits of a number: 16 or 32 [default: float]
    #[arg(long, value_parser = precisions(), requires = "layout")]
    pub precision: Option<Precision>,
}

fn engines() -> impl TypedValueParser<Value = Engine> {
    let names = PossibleValuesParser::new(Engine::ALL.iter().map(|engine| engine.name()));
    names.try_map(|name| Engine::from_name(&name).ok_or("is no engine"))
}

fn containers() -> impl TypedValueParser<Value = TextureContainer> {
    let names = PossibleValuesParser::new(TextureContainer::ALL.iter().map(|container| container.name()));
    names.try_map(|name| TextureContainer::from_name(&name).ok_or("is no format"))
}

/// By the names that graphics interfaces have, or as in recipes.
fn precisions() -> impl TypedValueParser<Value = Precision> {
    let (half, float) = (PossibleValue::new("half").alias("f16"), PossibleValue::new("float").alias("f32"));
    PossibleValuesParser::new([float, half])
        .map(|name| if matches!(name.as_str(), "half" | "f16") { Precision::F16 } else { Precision::F32 })
}
