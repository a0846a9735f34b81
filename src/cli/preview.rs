//! `preview`: what a table does, as a picture.

use std::{fs, sync::Arc};

use serde_json::json;

use super::{Context, Exit, Failure, args::PreviewArgs, file_failure, input, print, verify};
use crate::{
    export::TableFile,
    preview::{Material, Preview, PreviewError, Rendered, Scene, ShaderTable},
};

/// Renders a picture and writes it. The adapter, and the errors of modes that compare, go to standard error, or as
/// JSON to standard output.
pub(super) fn run(args: &PreviewArgs, json: bool, context: &mut Context<'_>) -> Result<Exit, Failure> {
    let path = input::table_path(&args.table, &args.tables)?;
    let (digest, TableFile { table, .. }) = verify::read(&path, None)?;
    let table = Arc::new(ShaderTable::new(&table, args.precision.0));
    let rendered =
        Preview::new(args.adapter.0).render(&table, &scene(args), &|| false).map_err(|error| failure(&error))?;
    let png = rendered.picture.png().map_err(|error| failure(&error))?;
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

/// The named scene with what the command line changes.
fn scene(args: &PreviewArgs) -> Scene {
    fn set<T>(place: &mut T, value: Option<T>) {
        if let Some(value) = value {
            *place = value;
        }
    }
    let mut scene = args.scene.0.scene();
    scene.mode = args.mode.0;
    set(&mut scene.size, args.size);
    set(&mut scene.spp, args.spp);
    if args.alpha_x.is_some() || args.alpha_y.is_some() {
        let mut material = scene.materials.first().copied().unwrap_or_else(Material::default);
        set(&mut material.alpha_x, args.alpha_x);
        set(&mut material.alpha_y, args.alpha_y);
        scene.materials = vec![material];
    }
    for material in &mut scene.materials {
        set(&mut material.rotation, args.rotation);
    }
    set(&mut scene.f0, args.f0);
    set(&mut scene.light.kind, args.light.map(|name| name.0));
    set(&mut scene.light.centre, args.light_centre);
    set(&mut scene.light.half_size, args.light_half_size);
    set(&mut scene.light.rotation, args.light_rotation);
    set(&mut scene.light.intensity, args.light_intensity);
    set(&mut scene.light.two_sided, args.light_two_sided);
    set(&mut scene.camera.distance, args.camera_distance);
    set(&mut scene.camera.azimuth, args.camera_azimuth);
    set(&mut scene.camera.elevation, args.camera_elevation);
    set(&mut scene.camera.field_of_view, args.field_of_view);
    set(&mut scene.lobe.theta, args.theta);
    set(&mut scene.lobe.phi, args.phi);
    set(&mut scene.exposure, args.exposure);
    set(&mut scene.difference_scale, args.difference_scale);
    scene
}
