//! `preview`: what a table does, as a picture.

use std::{fs, sync::Arc};

use serde_json::json;

use super::{Context, Exit, Failure, args::PreviewArgs, file_failure, input::AnyTable, print};
use crate::{
    fit::ggx_terms,
    view::preview::{Choices, Preview, PreviewError, Rendered, ShaderTable},
};

/// Renders a picture and writes it. The adapter, and the errors of modes that compare, go to standard error, or as
/// JSON to standard output.
pub(super) fn run(args: &PreviewArgs, json: bool, context: &mut Context<'_>) -> Result<Exit, Failure> {
    let AnyTable { digest, mut table, .. } = AnyTable::read(&args.table)?;
    if args.ggx_terms {
        table.terms = Some(ggx_terms(table.layout, &table.axes));
    }
    let table = Arc::new(ShaderTable::new(&table, args.precision.0));
    let rendered = Preview::new(args.adapter.0)
        .render(&table, &choices(args).into_scene(), &|| false)
        .map_err(|error| failure(&error))?;
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

/// What the command line chooses.
fn choices(args: &PreviewArgs) -> Choices {
    Choices {
        scene: Some(args.scene.0),
        mode: Some(args.mode.0),
        size: args.size,
        spp: args.spp,
        alpha_x: args.alpha_x,
        alpha_y: args.alpha_y,
        rotation: args.rotation,
        f0: args.f0,
        light: args.light.map(|name| name.0),
        light_centre: args.light_centre,
        light_half_size: args.light_half_size,
        light_rotation: args.light_rotation,
        light_intensity: args.light_intensity,
        light_two_sided: args.light_two_sided,
        camera_distance: args.camera_distance,
        camera_azimuth: args.camera_azimuth,
        camera_elevation: args.camera_elevation,
        camera_target: args.camera_target,
        field_of_view: args.field_of_view,
        theta: args.theta,
        phi: args.phi,
        exposure: args.exposure,
        difference_scale: args.difference_scale,
    }
}
