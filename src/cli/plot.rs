//! `plot`: a table as a picture.

use serde_json::json;

use super::{
    CommandFailure, Context, Exit,
    args::{PlotArgs, PlotName},
    input::AnyTable,
    output::OutputFile,
    print, shown,
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
    let out = OutputFile::check(&args.out)?;
    let read = AnyTable::read(&args.table)?;
    let picture = args.threads.pool()?.install(|| plot.draw(&read.table, &read.digest.hex()));
    let png = picture.png().map_err(|error| CommandFailure::new(Exit::Failed, error.to_string()))?;
    out.write(&png)?;
    let value =
        json!({ "file": shown(&args.out), "table": read.digest, "width": picture.width, "height": picture.height });
    print(context.stdout, json, &value, &shown(&args.out))?;
    Ok(Exit::Ok)
}
