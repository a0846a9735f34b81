//! `export`: a table in the files of engines, or as textures in a format of one's own choice.

use std::fmt::Write as _;

use serde_json::json;

use super::{
    CommandFailure, Context, Exit,
    args::{AnyContainer, ExportArgs, ExportChoice},
    file_failure,
    input::{AnyTable, Origin},
    output::check_output_folder,
    print, shown,
};
use crate::{
    files::{
        compact,
        digest::Digest,
        manifest::table_report,
        replace::replace_file,
        textures::{
            About, Bundle, CompactContainer, Engine, RoundingError, TextureFile, TextureFileError, TextureLayout,
            sampling_of,
        },
    },
    fit::{Precision, Recipe, Table, report},
};

/// What files that hold all textures are called.
const STEM: &str = "ltc";

/// Writes the files, and says what to do with them.
pub(super) fn run(args: &ExportArgs, json: bool, context: &mut Context<'_>) -> Result<Exit, CommandFailure> {
    check_output_folder(&args.out)?;
    let AnyTable { digest, table, origin, .. } = AnyTable::read(&args.table)?;
    let recipe = match &origin {
        Origin::Recipe(recipe) => Some(recipe),
        Origin::Range(_) => None,
    };
    let layout = layout_of(&args.choice, &table);
    let Bundle { files, steps } = args.threads.pool()?.install(|| bundle(&args.choice, &table, digest, recipe))?;
    for file in &files {
        let path = args.out.join(&file.path);
        replace_file(&path, &file.bytes).map_err(|error| file_failure(&path, &error))?;
    }
    let list: Vec<_> = files
        .iter()
        .map(|file| {
            json!({
                "file": shown(&args.out.join(&file.path)), "bytes": file.bytes.len(),
                "sha256": Digest::of(&file.bytes).hex(), "rounding": file.rounding,
            })
        })
        .collect();
    let value = json!({
        "table": digest, "for": args.choice.engine, "layout": layout, "container": args.choice.container, "files": list,
        "steps": steps,
    });
    print(context.stdout, json, &value, text(args, &files, &steps).trim_end())?;
    Ok(Exit::Ok)
}

/// The layout of the textures that are asked for.
fn layout_of<'a>(choice: &'a ExportChoice, table: &Table) -> &'a str {
    let engines = || choice.engine.and_then(Engine::layout);
    choice.layout.as_deref().or_else(engines).unwrap_or_else(|| table.layout.name())
}

/// The files that are asked for, and what to do with them. They follow from the table and this program alone. Measures the
/// table on the current rayon pool, where its recipe is known: files state how good it is.
///
/// # Errors
/// When the table has no such files.
pub(super) fn bundle(
    choice: &ExportChoice,
    table: &Table,
    digest: Digest,
    recipe: Option<&Recipe>,
) -> Result<Bundle, CommandFailure> {
    let layout = layout_of(choice, table);
    let report = recipe.map(|recipe| table_report(table, recipe));
    let about = About::of_table(digest, recipe, report.as_ref());
    if let (None, Some(AnyContainer::Compact(container))) = (choice.engine, choice.container) {
        return compact(choice, container, table, &about, recipe);
    }
    let layout = TextureLayout::named(layout).map_err(|error| refused(&error))?;
    let textures = layout.textures(table).map_err(|error| refused(&error))?;
    let about = about.and(sampling_of(table, layout));
    let made = match (choice.engine, choice.container) {
        (Some(engine), _) => engine.bundle(&textures, &table.axes, &about),
        (None, Some(AnyContainer::Textures(container))) => {
            let precision = choice.precision.unwrap_or(Precision::F32);
            container.files(STEM, &textures, precision, &about).map(|files| Bundle { files, steps: vec![] })
        }
        (None, _) => Err(TextureFileError::Empty),
    };
    made.map_err(|error| refused(&error))
}

/// Places at which a table and its compact form are measured, so many that a single one hardly counts.
const COMPARED_AT: usize = 512;

/// The table's compact form, and by how much it is worse where the table's own report is known.
fn compact(
    choice: &ExportChoice,
    container: CompactContainer,
    table: &Table,
    about: &About,
    recipe: Option<&Recipe>,
) -> Result<Bundle, CommandFailure> {
    let usage = |message: String| CommandFailure::new(Exit::Usage, message);
    if layout_of(choice, table) != table.layout().name() {
        let [asked, own] = [layout_of(choice, table).to_owned(), table.layout().to_string()];
        return Err(usage(format!(
            "layout is «{asked}»; the table has {own}, and its compact form has that of the table"
        )));
    }
    if choice.precision.is_some() {
        return Err(usage(format!("precision is for textures: container {} has its own", container.name())));
    }
    let rebuilt = compact::encode(table).and_then(|bytes| compact::decode(&bytes)).map_err(|error| refused(&error))?;
    let error = recipe.map(|recipe| {
        let [of_table, of_form] =
            [table, &rebuilt].map(|table| report(table, &recipe.range, COMPARED_AT).between.width.mean);
        format!(
            "mean error between nodes as it is decoded: {of_form:.5} of the lobe's width; of the table: {of_table:.5}"
        )
    });
    let files = container.files(STEM, table, &about.clone().and(&error)).map_err(|error| refused(&error))?;
    let steps = error.into_iter().chain(container.steps(STEM)).collect();
    Ok(Bundle { files, steps })
}

fn refused(error: &dyn std::error::Error) -> CommandFailure {
    CommandFailure::new(Exit::Usage, error.to_string())
}

/// The files, what rounding changed, and what to do.
fn text(args: &ExportArgs, files: &[TextureFile], steps: &[String]) -> String {
    let mut out = String::new();
    for file in files {
        // Writing to a String cannot fail.
        let _ = writeln!(out, "{}  {} bytes", args.out.join(&file.path).display(), file.bytes.len());
    }
    let all = files.iter().fold(RoundingError::default(), |all, file| all.and(file.rounding));
    if all != RoundingError::default() {
        let RoundingError { relative, absolute_of_small, clamped, raised } = all;
        let _ = writeln!(
            out,
            "rounded to 16 bits: relative error at most {relative:.1e}, of numbers below 6.1e-5 {absolute_of_small:.1e}"
        );
        if clamped + raised > 0 {
            let _ = writeln!(
                out,
                "beyond the range of 16 bits: {clamped} became 65504, {raised} became 6.0e-8 in place of 0"
            );
        }
    }
    for step in steps {
        let _ = writeln!(out, "{step}");
    }
    out
}
