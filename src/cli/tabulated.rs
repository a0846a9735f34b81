//! Tabulated BRDFs on the command line: their files next to recipes and tables, and `tabulate`, which writes a BRDF
//! file.

use std::{
    cell::RefCell,
    num::NonZeroU64,
    path::{Path, PathBuf},
};

use clap::{
    Args,
    builder::{PossibleValuesParser, TypedValueParser},
};
use serde_json::{Value, json};

use super::{
    CommandFailure, Context, Exit, OutputFile, exit::bad_recipe, file_failure, shown, table_file::TABLE_FOLDERS, usage,
};
use ltcforge_client::Client;
use ltcforge_files::{
    container::TableFile,
    digest::Digest,
    recipe_document::{self, AnyRecipe, DEFAULT_ENTRY_LIMIT, Fault, RecipeError},
    strict::Strict,
    tabulated::{encode, kept_name, locate},
};
use ltcforge_fit::{BrdfKind, Recipe, Table, TabulatedAxes, TabulatedBrdf};

/// `tabulate`.
#[derive(Debug, Args)]
pub struct TabulateArgs {
    /// Scattering model
    #[arg(value_parser = formulas())]
    pub brdf: BrdfKind,
    /// Output file
    #[arg(short, long, value_name = "FILE")]
    pub out: PathBuf,
    /// Roughnesses, ascending [default: 1]
    #[arg(long, value_name = "ALPHA,...", value_delimiter = ',')]
    pub alpha: Vec<f64>,
    /// Ratios of roughnesses, ascending, for an anisotropic BRDF
    #[arg(long, value_name = "RATIO,...", value_delimiter = ',')]
    pub ratio: Vec<f64>,
    /// Polar nodes of the light; the view has those up to 85 degrees
    #[arg(long, value_name = "N", default_value_t = 48, value_parser = clap::value_parser!(u16).range(4..=1024))]
    pub theta: u16,
    /// Azimuth nodes of the view, over a quarter turn
    #[arg(long, value_name = "N", default_value_t = 9, requires = "ratio", value_parser = clap::value_parser!(u16).range(2..=256))]
    pub phi_o: u16,
    /// Nodes of the azimuth difference, per side
    #[arg(long, value_name = "N", default_value_t = 32, value_parser = clap::value_parser!(u16).range(4..=1024))]
    pub phi: u16,
}

/// A parser for the names of models that need no file.
fn formulas() -> impl TypedValueParser<Value = BrdfKind> {
    PossibleValuesParser::new(BrdfKind::formulas().map(BrdfKind::name))
        .try_map(|name| BrdfKind::from_name(&name).ok_or("unknown model"))
}

/// The folders to search for files that the recipe or table `name` needs: its own folder, and the table folders.
fn folders(name: &Path) -> Vec<PathBuf> {
    let own = name.parent().filter(|folder| !folder.as_os_str().is_empty()).map(Path::to_owned);
    let mut all: Vec<PathBuf> = own.into_iter().collect();
    all.extend(TABLE_FOLDERS.map(PathBuf::from));
    all
}

/// Parses the recipe in `document`, which was read from `name`. Also returns the bytes of its tabulated BRDF, if it has
/// one.
///
/// # Errors
/// All faults of the recipe and of the BRDF file.
pub(super) fn any_recipe(
    name: &Path,
    document: &[u8],
    entry_limit: Option<NonZeroU64>,
) -> Result<(AnyRecipe, Option<Vec<u8>>), CommandFailure> {
    let folders = folders(name);
    let kept = RefCell::new(None);
    let find = |text: &str| {
        let found = locate(&folders, text)?;
        *kept.borrow_mut() = Some(found.bytes);
        Ok(found.file)
    };
    let limit = entry_limit.map_or(DEFAULT_ENTRY_LIMIT, NonZeroU64::get);
    let recipe = recipe_document::parse_any(document, limit, &find).map_err(|error| bad_recipe(name, error))?;
    Ok((recipe, kept.into_inner()))
}

/// Like [`any_recipe`], for a command that takes only tables of linearly transformed cosines.
///
/// # Errors
/// Like [`any_recipe`].
pub(super) fn recipe(
    name: &Path,
    document: &[u8],
    entry_limit: Option<NonZeroU64>,
) -> Result<(Recipe, Option<Vec<u8>>), CommandFailure> {
    let (recipe, bytes) = any_recipe(name, document, entry_limit)?;
    Ok((recipe.only_ltc().map_err(|error| bad_recipe(name, error))?, bytes))
}

/// If the document names the file of a tabulated BRDF by its path, sends the file to the server and returns the
/// document with the file's digest. The server checks the rest of the document.
///
/// # Errors
/// All faults of the file, and the server's errors.
pub(super) fn uploaded(name: &Path, document: Vec<u8>, client: &Client) -> Result<Vec<u8>, CommandFailure> {
    let Ok(Strict(mut recipe)) = serde_json::from_slice(&document) else { return Ok(document) };
    let Some(field) = recipe.get_mut("tabulated") else { return Ok(document) };
    let Some(path) = field.as_str().filter(|text| text.parse::<Digest>().is_err()) else { return Ok(document) };
    let found = locate(&folders(name), path).map_err(|details| {
        let fault = |detail: String| Fault { pointer: "/tabulated".to_owned(), detail };
        bad_recipe(name, RecipeError::Faults(details.into_iter().map(fault).collect()))
    })?;
    client.store_brdf(&found.bytes)?;
    *field = Value::String(found.file.to_string());
    Ok(recipe.to_string().into_bytes())
}

/// Finds the file of a table's tabulated BRDF and attaches it. [`check_complete`] rejects a table that lacks its file.
pub(super) fn attach(file: &mut TableFile, path: &Path) {
    let folders = folders(path);
    // A file that cannot be read is an error only if the file is needed.
    let _ = file.find_brdf(&|name| Ok(locate(&folders, name)?.file));
}

/// Rejects a table whose scattering model cannot be evaluated.
///
/// # Errors
/// The file that is missing, and the folders that were searched.
pub(super) fn check_complete(table: &Table, path: &Path) -> Result<(), CommandFailure> {
    let Some(file) = table.model().file().filter(|_| !table.model().is_complete()) else { return Ok(()) };
    let (kept, folders) = (kept_name(file.digest()), folders(path));
    let faults = locate(&folders, &file.to_string()).err().unwrap_or_default().join("; ");
    let reason = format!(
        "measuring the table needs its tabulated BRDF: {faults}; put the BRDF file into one of these folders, under \
         the name {kept}"
    );
    Err(file_failure(path, &reason))
}

/// Writes a BRDF file with samples of a model that has formulas.
pub(super) fn run(args: &TabulateArgs, context: &mut Context<'_>) -> Result<Exit, CommandFailure> {
    let out = OutputFile::check(&args.out)?;
    let axes = TabulatedAxes::spread(args.alpha.clone(), args.theta, args.phi);
    let axes = match &*args.ratio {
        [] => axes,
        _ if args.brdf.is_isotropic() => {
            return Err(usage(format!("--ratio: brdf {} is isotropic: leave it out", args.brdf)));
        }
        ratio => axes.with_azimuths(ratio.to_vec(), args.phi_o),
    };
    let brdf = TabulatedBrdf::tabulate(args.brdf, axes).map_err(|faults| {
        usage(faults.iter().map(|fault| format!("{}: {fault}", args.brdf)).collect::<Vec<_>>().join("\n"))
    })?;
    let bytes = encode(&brdf).map_err(|error| usage(error.0.join("\n")))?;
    out.write(&bytes)?;
    let digest = Digest::of(&bytes);
    let most = brdf.albedos().iter().copied().fold(0.0, f64::max);
    let value = json!({
        "file": shown(&args.out), "digest": digest, "bytes": bytes.len(), "shape": brdf.axes().shape(), "albedo": most,
    });
    context.print(&value, &format!("{}\n{digest}", shown(&args.out)))
}
