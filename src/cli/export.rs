//! `export`: a table in the files of an engine, as textures in a chosen format, or in its compact form.

use std::{fmt::Write as _, path::PathBuf};

use clap::{
    ArgGroup, Args,
    builder::{PossibleValue, PossibleValuesParser, TypedValueParser},
};
use serde_json::json;

use super::{
    AnyTable, CommandFailure, Context, Exit, TableChoice, Threads, check_output_folder, listed, named, tabulated,
    usage, write_in,
};
use ltcforge_files::{
    compact::{self, Encoded},
    digest::Digest,
    manifest::{MeanError, table_report},
};
use ltcforge_fit::{Precision, Recipe, Spread, Table};
use ltcforge_textures::{
    About, Bundle, CompactContainer, Displacement, Engine, Export, RoundingError, TextureContainer, TextureFile,
    TextureLayout,
};

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
    #[arg(long = "for", value_name = "ENGINE", value_parser = named(Engine::ALL, Engine::name), requires = "out")]
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

/// Writes the files, and prints what to do with them.
pub(super) fn run(args: &ExportArgs, context: &mut Context<'_>) -> Result<Exit, CommandFailure> {
    check_output_folder(&args.out)?;
    let AnyTable { path, digest, table, origin } = AnyTable::read(&args.table)?;
    let recipe = origin.recipe();
    if let ExportChoice { engine: None, layout: None, container: Some(AnyContainer::Textures(container)), .. } =
        args.choice
    {
        return Err(usage(no_layout(container, Some(&table))));
    }
    let export = export_of(&args.choice)?;
    // Faults are reported before the table is measured.
    let layout = export.layout(&table).map_err(usage)?;
    let pool = args.threads.pool()?;
    tabulated::check_complete(&table, &path)?;
    let error = pool.install(|| measured(&table, recipe));
    let (Bundle { files, steps }, compared) = match export {
        Export::Compact(container) => {
            let about = About::of_table(digest, recipe, error);
            pool.install(|| compact_bundle(container, &table, &about))?
        }
        Export::Engine(_) | Export::Textures { .. } => (bundle(export, &table, digest, recipe, error)?, vec![]),
    };
    let mut list = Vec::new();
    for file in &files {
        let path = write_in(&args.out, &file.path, &file.bytes)?;
        let mut value = listed(&path, &file.bytes);
        value["rounding"] = json!(file.rounding);
        list.push(value);
    }
    let value = json!({
        "table": digest, "for": args.choice.engine, "layout": layout, "container": args.choice.container, "files": list,
        "steps": steps, "compared": compared.first(), "compared_second": compared.get(1),
    });
    context.print(&value, text(args, &files, &compared, &steps).trim_end())
}

/// The export that a command line requests.
///
/// # Errors
/// When the layout is unknown or missing, or a compact form is requested in another layout or precision than the
/// table's own.
pub(super) fn export_of(choice: &ExportChoice) -> Result<Export, CommandFailure> {
    let ExportChoice { engine, layout, container, precision } = choice;
    match (*engine, layout, *container) {
        (Some(engine), _, _) => Ok(Export::Engine(engine)),
        (None, Some(layout), Some(AnyContainer::Textures(container))) => match TextureLayout::named(layout) {
            Ok(layout) => Ok(Export::Textures { layout, container, precision: precision.unwrap_or(Precision::F32) }),
            Err(error) => Err(usage(error)),
        },
        (None, None, Some(AnyContainer::Compact(container))) if precision.is_none() => Ok(Export::Compact(container)),
        (None, _, Some(AnyContainer::Compact(container))) => Err(usage(format!(
            "container {} holds a table in its own layout, rounded in its own way: leave out layout and precision",
            container.name()
        ))),
        (None, None, Some(AnyContainer::Textures(container))) => Err(usage(no_layout(container, None))),
        (None, _, None) => Err(usage("name an engine, or a container")),
    }
}

/// The errors of a table and its compact form between nodes, as parts of a lobe's width.
#[derive(Debug, serde::Serialize)]
struct Compared {
    table: Spread,
    decoded: Spread,
}

/// The message that a container needs a layout, with the layouts that the table has, or all.
fn no_layout(container: TextureContainer, table: Option<&Table>) -> String {
    let has = |layout: TextureLayout, table: &Table| {
        Export::Textures { layout, container, precision: Precision::F32 }.layout(table).is_ok()
    };
    let layouts = TextureLayout::ALL.iter().filter(|layout| table.is_none_or(|table| has(**layout, table)));
    let layouts = layouts.map(|layout| layout.name()).collect::<Vec<_>>().join(", ");
    let which = if table.is_some() { "this table has" } else { "there are" };
    format!("container {} holds textures: name their layout by --layout; {which} {layouts}", container.name())
}

/// The files of the compact forms of a table's lobes, and their errors. Measures on the current rayon pool.
fn compact_bundle(
    container: CompactContainer,
    table: &Table,
    about: &About,
) -> Result<(Bundle, Vec<Compared>), CommandFailure> {
    let lobes = compact::encode_lobes(table).map_err(usage)?;
    let compared = lobes.iter().map(|Encoded { table, decoded, .. }| Compared { table: *table, decoded: *decoded });
    let compared = compared.collect();
    let forms = lobes.into_iter().map(|encoded| encoded.bytes).collect();
    Ok((Export::compact_bundle(container, forms, about).map_err(usage)?, compared))
}

/// The table's mean error between nodes, which its files state, if its recipe is known. Measures on the current rayon
/// pool. Domain: a table whose model is complete.
pub(super) fn measured(table: &Table, recipe: Option<&Recipe>) -> Option<MeanError> {
    recipe.map(|recipe| MeanError::of(&table_report(table, recipe)))
}

/// The files of an export, and the steps to use them. They depend on the arguments and this program alone.
///
/// # Errors
/// When the table has no such files.
pub(super) fn bundle(
    export: Export,
    table: &Table,
    digest: Digest,
    recipe: Option<&Recipe>,
    error: Option<MeanError>,
) -> Result<Bundle, CommandFailure> {
    let made = export.bundle(table, About::of_table(digest, recipe, error));
    made.map_err(usage)
}

/// A text that lists the files, the changes by rounding, and the steps to use them.
fn text(args: &ExportArgs, files: &[TextureFile], compared: &[Compared], steps: &[String]) -> String {
    let mut out = String::new();
    for file in files {
        // Writing to a String cannot fail.
        let _ = writeln!(out, "{}  {} bytes", args.out.join(&file.path).display(), file.bytes.len());
    }
    let all = files.iter().fold(RoundingError::default(), |all, file| all.and(file.rounding));
    if all != RoundingError::default() {
        let RoundingError { relative, absolute_of_small, clamped, raised, displacement } = all;
        let _ = writeln!(
            out,
            "rounded to 16 bits: relative error at most {relative:.1e}, of numbers below 6.1e-5 {absolute_of_small:.1e}"
        );
        if let Some(Displacement { mean, max }) = displacement {
            let _ = writeln!(out, "which moves a lobe by {mean:.4} of its width in the mean, by {max:.4} at most");
        }
        if let Some(beyond) = beyond(clamped, raised) {
            let _ = writeln!(out, "{beyond}");
        }
    }
    for Compared { table, decoded } in compared {
        let _ = writeln!(
            out,
            "error between nodes as it is decoded: mean {:.5}, p95 {:.5} of the lobe's width; of the table: mean {:.5}, p95 {:.5}",
            decoded.mean, decoded.p95, table.mean, table.p95
        );
    }
    for step in steps {
        let _ = writeln!(out, "{step}");
    }
    out
}

/// A line about numbers that are too large or too small for 16 bits; `None` if all fit.
fn beyond(clamped: u64, raised: u64) -> Option<String> {
    let told = [(clamped, "65504"), (raised, "6.0e-8 in place of 0")].map(|(count, became)| match count {
        0 => None,
        1 => Some(format!("1 number became {became}")),
        _ => Some(format!("{count} numbers became {became}")),
    });
    let told: Vec<String> = told.into_iter().flatten().collect();
    (!told.is_empty()).then(|| format!("beyond the range of 16 bits: {}", told.join(", ")))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_numbers_that_there_are_are_told() {
        assert_eq!(beyond(0, 0), None);
        let told = |clamped, raised| beyond(clamped, raised).expect("some");
        assert_eq!(told(0, 70), "beyond the range of 16 bits: 70 numbers became 6.0e-8 in place of 0");
        assert_eq!(told(1, 0), "beyond the range of 16 bits: 1 number became 65504");
        assert!(told(2, 3).contains("2 numbers became 65504, 3 numbers became 6.0e-8"));
    }
}
