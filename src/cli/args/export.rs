//! `export`: a table in the files of engines.

use std::path::PathBuf;

use clap::{
    ArgGroup, Args,
    builder::{PossibleValue, PossibleValuesParser, TypedValueParser},
};

use super::{TableChoice, Threads};
use ltcforge_fit::Precision;
use ltcforge_textures::{CompactContainer, Engine, TextureContainer};

/// `export`.
#[derive(Debug, Args)]
#[command(group(ArgGroup::new("what").args(["engine", "container"]).required(true)))]
pub struct ExportArgs {
    /// The table
    #[command(flatten)]
    pub table: TableChoice,
    /// The kind of files
    #[command(flatten)]
    pub choice: ExportChoice,
    /// The folder; it is made if it is missing
    #[arg(short, long, value_name = "DIR")]
    pub out: PathBuf,
    /// How many threads measure the table, whose files state how good it is
    #[command(flatten)]
    pub threads: Threads,
}

/// The kind of files to make from a table.
#[derive(Debug, Clone, PartialEq, Eq, Args)]
pub struct ExportChoice {
    /// Write the files of this engine, under its names
    #[arg(long = "for", value_name = "ENGINE", value_parser = engines(), requires = "out")]
    pub engine: Option<Engine>,
    /// Write textures of this layout, in a format of one's own choice
    #[arg(long, value_name = "NAME", requires = "container", conflicts_with = "engine")]
    pub layout: Option<String>,
    /// The files' format; those that begin with «compact» hold the table itself in a few kilobytes, in its own layout
    #[arg(long, value_name = "NAME", value_parser = containers(), requires = "out", conflicts_with = "engine")]
    pub container: Option<AnyContainer>,
    /// Bits of a number: 16 or 32 [default: float]
    #[arg(long, value_parser = precisions(), requires = "layout", conflicts_with = "engine")]
    pub precision: Option<Precision>,
}

fn engines() -> impl TypedValueParser<Value = Engine> {
    let names = PossibleValuesParser::new(Engine::ALL.iter().map(|engine| engine.name()));
    names.try_map(|name| Engine::from_name(&name).ok_or("is not an engine"))
}

/// A format of textures, or of the table itself.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[serde(untagged)]
pub enum AnyContainer {
    /// Textures.
    Textures(TextureContainer),
    /// The table in its compact form.
    Compact(CompactContainer),
}

impl AnyContainer {
    /// All of them.
    pub fn all() -> impl Iterator<Item = Self> {
        let textures = TextureContainer::ALL.iter().map(|container| Self::Textures(*container));
        textures.chain(CompactContainer::ALL.iter().map(|container| Self::Compact(*container)))
    }

    /// The name on the command line and in lock files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Textures(container) => container.name(),
            Self::Compact(container) => container.name(),
        }
    }
}

fn containers() -> impl TypedValueParser<Value = AnyContainer> {
    let names = PossibleValuesParser::new(AnyContainer::all().map(AnyContainer::name));
    names.try_map(|name| AnyContainer::all().find(|item| item.name() == name).ok_or("is not a format"))
}

/// Reads a precision by its name in graphics interfaces or in recipes.
fn precisions() -> impl TypedValueParser<Value = Precision> {
    let (half, float) = (PossibleValue::new("half").alias("f16"), PossibleValue::new("float").alias("f32"));
    PossibleValuesParser::new([float, half])
        .map(|name| if matches!(name.as_str(), "half" | "f16") { Precision::F16 } else { Precision::F32 })
}
