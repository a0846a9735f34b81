//! `preview`: what a table does, as a picture.

use std::{fs, sync::Arc};

use serde_json::json;

use super::{Context, Exit, Failure, args::PreviewArgs, file_failure, input::AnyTable, print};
use crate::{
    fit::ggx_terms,
    view::preview::{Preview, PreviewError, Rendered, ShaderTable},
};

/// Renders a picture and writes it. The adapter, and the errors of modes that compare, go to standard error, or as
/// JSON to standard output.
pub(super) fn run(args: &PreviewArgs, json: bool, context: &mut Context<'_>) -> Result<Exit, Failure> {
    let AnyTable { digest, mut table, .. } = AnyTable::read(&args.table)?;
    if args.ggx_terms {
        table.terms = Some(ggx_terms(table.layout, &table.axes));
    }
    let table = Arc::new(ShaderTable::new(&table, args.precision.0));
    let scene = args.scene.0.clone().into_scene();
    let rendered = Preview::new(args.adapter.0).render(&table, &scene, &|| false).map_err(|error| failure(&error))?;
    let png = rendered.picture.png().map_err(|error| Failure::new(Exit::Failed, error.to_string()))?;
    fs::write(&args.out, png).map_err(|error| file_failure(&args.out, &error))?;
    let Rendered { picture, adapter, errors } = rendered;
    let errors_json: Vec<_> = errors
        .iter()
        .map(|error| {
            json!({
                "alpha_x": error.alpha_x, "alpha_y": error.alpha_y,
                "mean_absolute_error": error.mean_absolute, "mean_radiance": error.mean_radiance,
            })
        })
        .collect();
    let value = json!({
        "file": args.out, "table": digest, "adapter": adapter,
        "width": picture.width, "height": picture.height, "errors": errors_json,
    });
    if json {
        return print(context.stdout, true, &value, "").map(|()| Exit::Ok);
    }
    eprintln!("adapter: {adapter}");
    for error in &errors {
        let (alpha_x, alpha_y) = (error.alpha_x, error.alpha_y);
        let (apart, radiance) = (error.mean_absolute, error.mean_radiance);
        eprintln!("alpha {alpha_x} {alpha_y}: mean absolute error {apart:.5} of mean radiance {radiance:.5}");
    }
    Ok(Exit::Ok)
}

fn failure(error: &PreviewError) -> Failure {
    let exit = if matches!(error, PreviewError::Scene(_)) { Exit::Usage } else { Exit::Failed };
    Failure::new(exit, error.to_string())
}
