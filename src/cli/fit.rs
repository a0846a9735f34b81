//! `fit`: a table without a server.

use std::{num::NonZeroU64, ops::ControlFlow};

use indicatif::ProgressBar;
use serde_json::json;

use super::{Context, Exit, Failure, Interrupt, args::FitArgs, file_failure, input, print, progress};
use crate::{
    client::replace_file,
    files::manifest::manifest_json,
    files::{
        digest::Digest,
        export::{self, TableFileError},
        recipe::{self, DEFAULT_ENTRY_LIMIT, RecipeError},
    },
    fit::{Plan, Table, fit_plan},
};

/// Fits a recipe and writes the table and its manifest.
pub(super) fn run(args: &FitArgs, json: bool, context: &mut Context<'_>) -> Result<Exit, Failure> {
    let document = input::recipe_document(&args.recipe)?;
    let entry_limit = args.entry_limit.map_or(DEFAULT_ENTRY_LIMIT, NonZeroU64::get);
    let recipe = recipe::parse(&document, entry_limit).map_err(|error| bad_recipe(&args.recipe, error))?;
    let pool = args.threads.pool()?;

    let plan = Plan::new(&recipe);
    let bar = progress::bar(context.draws_progress, recipe.entries());
    let fitted = pool.install(|| fit(&plan, &bar, &context.interrupt));
    bar.finish_and_clear();
    let failed = |error: TableFileError| Failure::new(Exit::Failed, error.to_string());
    let file = export::encode(&recipe, &fitted.ok_or_else(Failure::interrupted)?).map_err(failed)?;
    let digest = Digest::of(&file);
    let manifest = pool.install(|| manifest_json(&file)).map_err(failed)?;

    // The table comes last: who finds it finds its manifest.
    let manifest_path = args.out.join(format!("{}.manifest.json", digest.hex()));
    replace_file(&manifest_path, manifest.as_bytes()).map_err(|error| file_failure(&manifest_path, &error))?;
    let table_path = args.out.join(format!("{}.safetensors", digest.hex()));
    replace_file(&table_path, &file).map_err(|error| file_failure(&table_path, &error))?;

    let value = json!({ "table": digest, "file": table_path, "manifest": manifest_path, "bytes": file.len() });
    print(context.stdout, json, &value, &format!("{}\n{digest}", table_path.display()))?;
    Ok(Exit::Ok)
}

/// The table of a plan, or `None` when the user stops the fit.
pub(super) fn fit(plan: &Plan, bar: &ProgressBar, interrupt: &Interrupt) -> Option<Table> {
    fit_plan(plan, &|done| {
        // Threads overtake each other on the way here; the bar never goes back.
        bar.update(|bar| bar.set_pos(bar.pos().max(done)));
        if interrupt.is_set() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    })
}

/// Every fault on its line.
pub(super) fn bad_recipe(name: &str, error: RecipeError) -> Failure {
    let message = match error {
        RecipeError::Json(detail) => format!("{name}: not JSON: {detail}"),
        RecipeError::Faults(faults) => {
            let lines: Vec<String> =
                faults.iter().map(|fault| format!("{name}: {}: {}", fault.pointer, fault.detail)).collect();
            lines.join("\n")
        }
    };
    Failure::new(Exit::Usage, message)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::files::recipe::Fault;

    #[test]
    fn all_faults_of_a_recipe_are_told() {
        let fault = |pointer: &str| Fault { pointer: pointer.into(), detail: "bad".into() };
        let refused = bad_recipe("r.json", RecipeError::Faults(vec![fault("/a"), fault("/b")]));
        assert_eq!(refused.message, "r.json: /a: bad\nr.json: /b: bad");
        assert_eq!(refused.exit, Exit::Usage);
    }
}
