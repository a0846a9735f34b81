//! `preview`: surfaces lit by a table, as a picture.

mod materials;

use std::sync::Arc;

use serde_json::json;

use super::{
    CommandFailure, Context, Exit,
    args::PreviewArgs,
    exit::{failed, usage},
    input::AnyTable,
    light_picture::read_picture,
    output::OutputFile,
    shown,
};
use ltcforge_light::{LightError, LightModel};
use ltcforge_view::preview::{Material, Preview, PreviewError, Rendered, ScenePicture, ShaderTable};

/// Renders a picture and writes it. Prints the adapter, materials outside the table, and the errors of modes that
/// compare to standard error, or as JSON to standard output.
pub(super) fn run(args: &PreviewArgs, context: &mut Context<'_>) -> Result<Exit, CommandFailure> {
    if args.scene.is_materials {
        return materials::run(args, context);
    }
    let out = OutputFile::check(&args.out)?;
    let mut scene = args.scene.choices.clone().into_scene();
    if let Some(path) = &args.light_texture {
        scene.picture = ScenePicture::Image(Arc::new(read_picture(path)?));
    }
    let read = args.table.as_deref().map(|name| AnyTable::named(name, &args.folder)).transpose()?;
    if read.is_none() && scene.needs_table() {
        return Err(usage(LightError::NeedsTable(LightModel::Ltc)));
    }
    let digest = read.as_ref().map(|any| any.digest);
    let table = read.map(|any| if args.ggx_terms { any.with_ggx_terms() } else { Ok(any) }).transpose()?;
    let table = table.map(|any| any.table);
    if let Some(table) = table.as_ref().filter(|table| !table.layout().is_even(table.axes())) {
        let message = format!(
            "the preview's shader searches for no nodes, and those of the table's recipe are not evenly spaced as layout {} has them",
            table.layout()
        );
        return Err(usage(message));
    }
    let shader_table = match (&table, &digest) {
        (Some(table), Some(digest)) => ShaderTable::new(table, args.precision).labelled(&digest.hex()),
        _ => ShaderTable::none(),
    };
    let shader_table = Arc::new(shader_table);
    let rendered =
        Preview::new(args.adapter).render(&shader_table, &scene, &|| false).map_err(|error| failure(&error))?;
    let png = rendered.picture.png().map_err(failed)?;
    out.write(&png)?;
    let Rendered { picture, adapter, errors, out_of_range } = rendered;
    let errors_json: Vec<_> = errors
        .iter()
        .map(|error| {
            json!({
                "model": error.model, "alpha_x": error.alpha_x, "alpha_y": error.alpha_y,
                "mean_absolute_error": error.mean_absolute, "mean_radiance": error.mean_radiance,
            })
        })
        .collect();
    let out_of_range_json: Vec<_> =
        out_of_range.iter().map(|m| json!({ "alpha_x": m.alpha_x, "alpha_y": m.alpha_y })).collect();
    let value = json!({
        "file": shown(&args.out), "table": digest, "adapter": adapter,
        "width": picture.width, "height": picture.height, "errors": errors_json,
        "outside": out_of_range_json,
    });
    if context.json {
        return context.print(&value, "");
    }
    eprintln!("adapter: {adapter}");
    for (Material { alpha_x, alpha_y, .. }, table) in out_of_range.iter().zip(table.iter().cycle()) {
        // Materials are in any order.
        let [least, most, least_ratio, most_ratio] = table.shader_axes().roughness;
        eprintln!(
            "alpha {alpha_x} {alpha_y} lies outside the table, which covers alpha {least} to {most} and ratio \
             {least_ratio} to {most_ratio}; its nearest entry is shown"
        );
    }
    for error in &errors {
        let (alpha_x, alpha_y) = (error.alpha_x, error.alpha_y);
        let (apart, radiance) = (error.mean_absolute, error.mean_radiance);
        let model = error.model;
        eprintln!("{model}, alpha {alpha_x} {alpha_y}: mean absolute error {apart:.5} of mean radiance {radiance:.5}");
    }
    Ok(Exit::Ok)
}

fn failure(error: &PreviewError) -> CommandFailure {
    let exit = match error {
        PreviewError::Scene(..) | PreviewError::Table(_) | PreviewError::CpuOnly(_) => Exit::Usage,
        PreviewError::NoBrdfFile(_) | PreviewError::NoAdapter(_) | PreviewError::Gpu(_) | PreviewError::Stopped => {
            Exit::Failed
        }
    };
    CommandFailure::new(exit, error.to_string())
}
