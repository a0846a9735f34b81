//! `plot`: a table as a picture.

use std::fs;

use serde_json::json;

use super::{
    Context, Exit, Failure,
    args::{PlotArgs, PlotName},
    file_failure,
    input::AnyTable,
    print,
};
use crate::view::plots::{Plot, Slice};

/// Draws a table and writes the picture.
pub(super) fn run(args: &PlotArgs, json: bool, context: &mut Context<'_>) -> Result<Exit, Failure> {
    let plot = match args.name {
        PlotName::Error => Plot::Error(Slice::new(args.ratio, args.phi)),
        PlotName::Matrix if args.ratio.is_some() || args.phi.is_some() => {
            return Err(Failure::new(Exit::Usage, "--ratio and --phi belong to the errors; matrix shows all of them"));
        }
        PlotName::Matrix => Plot::Matrix,
    };
    let read = AnyTable::read(&args.table)?;
    let picture = args.threads.pool()?.install(|| plot.draw(&read.table));
    let png = picture.png().map_err(|error| Failure::new(Exit::Failed, error.to_string()))?;
    fs::write(&args.out, png).map_err(|error| file_failure(&args.out, &error))?;
    let value = json!({ "file": args.out, "table": read.digest, "width": picture.width, "height": picture.height });
    print(context.stdout, json, &value, &args.out.display().to_string())?;
    Ok(Exit::Ok)
}
