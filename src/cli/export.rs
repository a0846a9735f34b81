//! `export`: writes a table as files for an engine, as textures in a chosen format, or in its compact form.

use std::{fmt::Write as _, path::PathBuf};

use clap::{
    ArgGroup, Args,
    builder::{PossibleValue, PossibleValuesParser, TypedValueParser},
};
use serde_json::json;

use super::{
    AnyTable, CommandFailure, Context, Exit, TableChoice, Threads, check_output_folder, listed, lut, tabulated, usage,
    write_in,
};
use ltcforge_files::{
    compact::{self, Encoded},
    digest::Digest,
    manifest::{MeanError, table_report},
};
use ltcforge_fit::{Precision, Recipe, Spread, Table};
use ltcforge_textures::{
    About, Bundle, CompactContainer, Displacement, Engine, Export, LutEngine, LutExport, PNG, RoundingError,
    TextureContainer, TextureFile, TextureLayout, UnknownExport, layout_names,
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
    /// Output folder, created if missing
    #[arg(short, long, value_name = "DIR")]
    pub out: PathBuf,
    /// Threads.
    #[command(flatten)]
    pub threads: Threads,
}

/// The kind of files to make from a table.
#[derive(Debug, Clone, PartialEq, Eq, Args)]
pub struct ExportChoice {
    /// Engine to write files for
    #[arg(long = "for", value_name = "ENGINE", value_parser = engines(), requires = "out")]
    pub engine: Option<String>,
    /// Texture layout, with --container; not for lookup tables
    #[arg(long, value_name = "NAME", requires = "container", conflicts_with = "engine")]
    pub layout: Option<String>,
    /// File format; `png` is for lookup tables, `compact` for LTC tables
    #[arg(long, value_name = "NAME", value_parser = containers(), requires = "out", conflicts_with = "engine")]
    pub container: Option<String>,
    /// Number format of textures, or half with --for wgpu [default: float]
    #[arg(long, value_parser = precisions())]
    pub precision: Option<Precision>,
}

impl ExportChoice {
    /// The choice with `--for wgpu --precision half` as one engine.
    ///
    /// # Errors
    /// When `--precision` is given with another engine.
    pub(super) fn checked(&self) -> Result<Self, CommandFailure> {
        let engine = match (self.engine.as_deref(), self.precision) {
            (None, _) | (_, None) => return Ok(self.clone()),
            (Some(engine), Some(Precision::F16)) if engine == Engine::Wgpu.name() => Engine::WgpuHalf.name().to_owned(),
            (Some(other), _) => {
                return Err(usage(format!("--for {other} has its own precision: leave out --precision")));
            }
        };
        Ok(Self { engine: Some(engine), precision: None, ..self.clone() })
    }
}

/// The names of engines, of either kind of table.
fn engines() -> PossibleValuesParser {
    let engines = Engine::ALL.iter().map(|engine| engine.name());
    let others = LutEngine::ALL.iter().map(|engine| engine.name()).filter(|name| Engine::from_name(name).is_none());
    PossibleValuesParser::new(engines.chain(others))
}

/// The names of texture formats and compact forms.
fn containers() -> PossibleValuesParser {
    let textures = TextureContainer::ALL.iter().map(|container| container.name()).chain([PNG]);
    PossibleValuesParser::new(textures.chain(CompactContainer::ALL.iter().map(|container| container.name())))
}

/// Parses a precision: `half` or `float` as in graphics APIs, or `f16` or `f32` as in recipes.
fn precisions() -> impl TypedValueParser<Value = Precision> {
    let (half, float) = (PossibleValue::new("half").alias("f16"), PossibleValue::new("float").alias("f32"));
    PossibleValuesParser::new([float, half])
        .map(|name| if matches!(name.as_str(), "half" | "f16") { Precision::F16 } else { Precision::F32 })
}

/// Writes the files, and prints the steps to use them.
pub(super) fn run(args: &ExportArgs, context: &mut Context<'_>) -> Result<Exit, CommandFailure> {
    check_output_folder(&args.out)?;
    let pool = args.threads.pool()?;
    if let Some((_, digest, file)) = lut::read(&args.table)? {
        let export = lut_export(&args.choice)?;
        let bundle = pool.install(|| export.bundle(&file, digest)).map_err(usage)?;
        return write(args, digest, None, &bundle, &[], context);
    }
    let AnyTable { path, digest, table, origin } = AnyTable::read(&args.table)?;
    let recipe = origin.recipe();
    let export = export_of(&args.choice)?;
    // Errors in the options are reported before the table is measured.
    let layout = export.layout(&table).map_err(usage)?;
    tabulated::check_complete(&table, &path)?;
    let error = pool.install(|| measured(&table, recipe));
    let about = About::of_table(digest, recipe, error);
    let (bundle, compared) = match export {
        Export::Compact(container) => pool.install(|| compact_bundle(container, &table, &about))?,
        _ => (export.bundle(&table, about).map_err(usage)?, vec![]),
    };
    write(args, digest, Some(layout), &bundle, &compared, context)
}

/// Writes the files of an export. `layout` is `None` for a lookup table.
fn write(
    args: &ExportArgs,
    digest: Digest,
    layout: Option<&str>,
    Bundle { files, steps }: &Bundle,
    compared: &[Compared],
    context: &mut Context<'_>,
) -> Result<Exit, CommandFailure> {
    let mut list = Vec::new();
    for file in files {
        let path = write_in(&args.out, &file.path, &file.bytes)?;
        let mut value = listed(&path, &file.bytes);
        value["rounding"] = json!(file.rounding);
        list.push(value);
    }
    let value = json!({
        "table": digest, "for": args.choice.engine, "layout": layout, "container": args.choice.container, "files": list,
        "steps": steps, "compared": compared.first(), "compared_second": compared.get(1),
    });
    let mut text = text(args, files, compared, steps);
    let lut_engine = args.choice.engine.as_deref().and_then(LutEngine::from_name);
    if let Some(engine) = lut_engine.filter(|_| layout.is_some()) {
        let _ = writeln!(text, "DFG table: ltcforge fit dfg -o tables; ltcforge export DIGEST --for {engine} -o DIR");
    }
    context.print(&value, text.trim_end())
}

/// The export of a lookup table that the options choose.
fn lut_export(choice: &ExportChoice) -> Result<LutExport, CommandFailure> {
    let ExportChoice { engine, layout, container, precision } = choice.checked()?;
    let precision = precision.map(|precision| precision.name().to_owned());
    let parts: Vec<String> = [engine, layout, container, precision].into_iter().flatten().collect();
    parts.join(".").parse().map_err(usage)
}

/// The export that the options choose.
///
/// # Errors
/// When the layout is unknown or missing, or `--layout` or `--precision` is given for a compact form.
pub(super) fn export_of(choice: &ExportChoice) -> Result<Export, CommandFailure> {
    let ExportChoice { engine, layout, container, precision } = &choice.checked()?;
    let container = match (engine, container) {
        (Some(engine), _) => return engine.parse().map_err(|error: UnknownExport| usage(error)),
        (None, None) => return Err(usage("use --for ENGINE or --container NAME")),
        (None, Some(container)) => container,
    };
    let export = match (layout, TextureContainer::from_name(container)) {
        (Some(layout), Some(container)) => {
            let layout = TextureLayout::named(layout).map_err(usage)?;
            return Ok(Export::Textures { layout, container, precision: precision.unwrap_or(Precision::F32) });
        }
        (None, None) if precision.is_some() => Err("--precision needs --layout or --for wgpu".to_owned()),
        (None, None) => container.parse().map_err(|error: UnknownExport| error.to_string()),
        (Some(_), None) => {
            Err(format!("--container {container} keeps the table's own layout: leave out --layout and --precision"))
        }
        (None, Some(_)) => Err(format!("--container {container} needs --layout: {}", layout_names().join(", "))),
    };
    export.map_err(usage)
}

/// The errors between nodes of a table and of its compact form, in lobe widths.
#[derive(Debug, serde::Serialize)]
struct Compared {
    table: Spread,
    decoded: Spread,
}

/// The compact forms of a table's lobes as files, and their errors. Measures on the current rayon pool.
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

/// The table's mean error between nodes, which exported files state; `None` without a recipe. Measures on the current
/// rayon pool. Domain: a table whose scattering model is complete.
pub(super) fn measured(table: &Table, recipe: Option<&Recipe>) -> Option<MeanError> {
    recipe.map(|recipe| MeanError::of(&table_report(table, recipe)))
}

/// The text output: the files, the rounding errors, and the steps to use the files.
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
            "rounded to 16 bits: error at most {relative:.1e} relative, {absolute_of_small:.1e} absolute below 6.1e-5"
        );
        if let Some(Displacement { mean, max }) = displacement {
            let _ = writeln!(out, "rounding moves a lobe by {mean:.4} of its width on average, at most {max:.4}");
        }
        if clamped + raised > 0 {
            let _ = writeln!(
                out,
                "numbers outside the 16-bit range: {clamped} became 65504, {raised} became 6.0e-8 instead of 0"
            );
        }
    }
    for Compared { table, decoded } in compared {
        let _ = writeln!(
            out,
            "error between nodes, in widths of the lobe: decoded mean {:.5}, p95 {:.5}; table mean {:.5}, p95 {:.5}",
            decoded.mean, decoded.p95, table.mean, table.p95
        );
    }
    for step in steps {
        let _ = writeln!(out, "{step}");
    }
    out
}
