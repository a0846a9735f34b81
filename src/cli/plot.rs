//! `plot`: a table as a picture.

use serde_json::json;

use super::{
    CommandFailure, Context, Exit,
    args::{PlotArgs, PlotName},
    exit::{failed, usage},
    input::AnyTable,
    output::OutputFile,
    shown, tabulated,
};
use ltcforge_view::plots::{ErrorSlice, Plot};

/// Draws and writes the picture.
pub(super) fn run(args: &PlotArgs, context: &mut Context<'_>) -> Result<Exit, CommandFailure> {
    if args.name != PlotName::Error && (args.ratio.is_some() || args.phi.is_some()) {
        return Err(usage("--ratio and --phi belong to error, which shows a slice; matrix shows all of them"));
    }
    let out = OutputFile::check(&args.out)?;
    let AnyTable { table, digest, path, .. } = AnyTable::read(&args.table)?;
    let plot = match args.name {
        PlotName::Error => {
            tabulated::check_complete(&table, &path)?;
            Plot::Error(ErrorSlice::new(args.ratio, args.phi))
        }
        PlotName::Matrix => Plot::Matrix,
    };
    let picture = args.threads.pool()?.install(|| plot.draw(&table, &digest.hex()));
    out.write(&picture.png().map_err(failed)?)?;
    let value = json!({
        "file": shown(&args.out), "table": digest, "width": picture.width, "height": picture.height,
    });
    context.print(&value, &shown(&args.out))
}
