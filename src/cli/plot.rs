//! `plot`: a table as a picture.

use std::fs;

use serde_json::json;

use super::{
    CommandFailure, Context, Exit,
    args::{PlotArgs, PlotName},
    file_failure,
    input::AnyTable,
    print,
};
use crate::view::plots::{ErrorSlice, Plot};

/// Draws a table and writes the picture.
pub(super) fn run(args: &PlotArgs, json: bool, context: &mut Context<'_>) -> Result<Exit, CommandFailure> {
    let plot = match args.name {
        PlotName::Error => Plot::Error(ErrorSlice::new(args.ratio, args.phi)),
        PlotName::Matrix if args.ratio.is_some() || args.phi.is_some() => {
            return Err(CommandFailure::new(
                Exit::Usage,
                "--ratio and --phi belong to the errors; matrix shows all of them",
            ));
        }
        PlotName::Matrix => Plot::Matrix,
    };
    let read = AnyTable::read(&args.table)?;
    let picture = args.threads.pool()?.install(|| plot.draw(&read.table, &read.digest.hex()));
    let png = picture.png().map_err(|error| CommandFailure::new(Exit::Failed, error.to_string()))?;
    fs::write(&args.out, png).map_err(|error| file_failure(&args.out, &error))?;
    let value = json!({ "file": args.out, "table": read.digest, "width": picture.width, "height": picture.height });
    print(context.stdout, json, &value, &args.out.display().to_string())?;
    Ok(Exit::Ok)
}
