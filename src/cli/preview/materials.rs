//! `preview --scene materials`: nine materials in truth, by a table and by model `normals`, drawn by the CPU.

use std::{ops::RangeInclusive, path::Path};

use serde_json::json;

use crate::{
    AnyTable, CommandFailure, Context, Exit, OutputFile, failed, fit::fit, preview::PreviewArgs, progress, shown,
    tabulated::recipe, usage,
};
use ltcforge_files::{container, digest::Digest};
use ltcforge_fit::{BrdfKind, PerAxis, Plan, Table};
use ltcforge_view::{
    plots::{MaterialChoices, MaterialError, NamedTable, material_spheres},
    preview::{Adapter, Scene, TexelFormat},
};

/// The recipe that is fitted where no table is named: the default, with a second lobe for plastic and the term of F82.
const RECIPE: &str = r#"{"fresnel": "two_lobes", "terms": "f82"}"#;

/// The parameters of a preview that the picture takes.
const TAKEN: [&str; 4] = ["rule", "cut", "size", "difference_scale"];

/// Pixels a side of a panel: fewer show nothing, more take minutes and show no more.
const SIZES: RangeInclusive<u32> = 64..=512;

/// Draws and writes the picture. Prints the errors to standard error, or as JSON to standard output.
pub(super) fn run(args: &PreviewArgs, context: &mut Context<'_>) -> Result<Exit, CommandFailure> {
    let choices = choices(args)?;
    let out = OutputFile::check(&args.out)?;
    let Shown { table, digest, range } = match &args.table {
        Some(name) => {
            let any = AnyTable::named(name, &args.folder)?;
            let any = if args.ggx_terms { any.with_ggx_terms()? } else { any };
            let range = *any.origin.range();
            Shown { table: any.table, digest: any.digest, range }
        }
        None => fitted(context)?,
    };
    if table.brdf() != BrdfKind::Ggx {
        let message =
            format!("scene materials is of brdf ggx, and the table is of brdf {}: name another, or none", table.brdf());
        return Err(usage(message));
    }
    let named = NamedTable { table: &table, digest: &digest.hex(), range: &range };
    let drawn = material_spheres(named, &choices).map_err(usage)?;
    out.write(&drawn.picture.png().map_err(failed)?)?;
    let value = json!({
        "file": shown(&args.out), "table": digest, "adapter": "cpu",
        "width": drawn.picture.width, "height": drawn.picture.height, "errors": drawn.errors, "outside": drawn.outside,
    });
    if context.json {
        return context.print(&value, "");
    }
    eprintln!("adapter: cpu");
    eprintln!("table: {digest}");
    for name in drawn.outside {
        eprintln!("{name} has a roughness outside the table; its nearest entry is shown");
    }
    for MaterialError { material, model, mean_absolute_error: apart, mean_radiance } in &drawn.errors {
        eprintln!("{model}, {material}: mean absolute error {apart:.5} of mean radiance {mean_radiance:.5}");
    }
    Ok(Exit::Ok)
}

/// A table, its digest and the ranges of its axes.
struct Shown {
    table: Table,
    digest: Digest,
    range: PerAxis<[f64; 2]>,
}

/// The table of [`RECIPE`], as `fit` would write it.
fn fitted(context: &Context<'_>) -> Result<Shown, CommandFailure> {
    let (recipe, _) = recipe(Path::new("scene materials"), RECIPE.as_bytes(), None)?;
    let bar = progress::bar(context.draws_progress, recipe.entries());
    let table = fit(&Plan::new(&recipe), &bar, &context.interrupt);
    bar.finish_and_clear();
    let table = table.ok_or_else(CommandFailure::interrupted)?;
    let file = container::encode(&recipe, &table).map_err(failed)?;
    Ok(Shown { table, digest: Digest::of(&file), range: recipe.range })
}

/// The choices for the picture, or every fault of them, a line each.
fn choices(args: &PreviewArgs) -> Result<MaterialChoices, CommandFailure> {
    let chosen = &args.scene.choices;
    let mut faults = Vec::new();
    let texture = args.light_texture.as_ref().map(|_| "light_texture");
    for name in chosen.names().filter(|name| !TAKEN.contains(name)).chain(texture) {
        let flags = TAKEN.map(flag).join(", ");
        faults.push(format!("{} is not of scene materials, which has its own: it takes {flags}", flag(name)));
    }
    if args.adapter == Adapter::Gpu {
        faults.push("--adapter is gpu; scene materials is drawn by the CPU: any or cpu".to_owned());
    }
    if args.precision != TexelFormat::F32 {
        faults.push("--precision is f16; scene materials reads a table as it is stored: leave it out".to_owned());
    }
    if args.ggx_terms && args.table.is_none() {
        faults.push("--ggx-terms is of a table: name one".to_owned());
    }
    let is_chosen = |name: &str| chosen.names().any(|chosen| chosen == name);
    let Scene { size, rule, cut, difference_scale, .. } = chosen.clone().into_scene();
    let usual = MaterialChoices::default();
    let choices = MaterialChoices {
        size: if is_chosen("size") { size } else { usual.size },
        difference_scale: if is_chosen("difference_scale") { difference_scale } else { usual.difference_scale },
        rule,
        cut,
    };
    if !SIZES.contains(&choices.size) {
        faults.push(format!("size is {size}, not within {} to {} for scene materials", SIZES.start(), SIZES.end()));
    }
    let bounded = Scene { difference_scale: choices.difference_scale, ..Scene::default() };
    faults.extend(bounded.faults().iter().map(ToString::to_string));
    if faults.is_empty() { Ok(choices) } else { Err(usage(faults.join("\n"))) }
}

/// A parameter's name as an option.
fn flag(name: &str) -> String {
    format!("--{}", name.replace('_', "-"))
}
