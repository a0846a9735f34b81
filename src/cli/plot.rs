//! `plot`: a table as a picture.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use serde_json::json;

use super::{
    AnyTable, CommandFailure, Context, Exit, OutputFile, TableChoice, Threads, failed, shown, tabulated, usage,
};
use ltcforge_files::{container::LutFile, digest::Digest};
use ltcforge_view::{
    picture::Picture,
    plots::{Azimuth, ErrorSlice, Plot, Ratio, draw_lut},
};

/// `plot`.
#[derive(Debug, Args)]
pub struct PlotArgs {
    /// The table
    #[command(flatten)]
    pub table: TableChoice,
    /// Plot
    #[arg(value_enum)]
    pub name: PlotName,
    /// Output file
    #[arg(short, long, value_name = "FILE.png")]
    pub out: PathBuf,
    /// Ratio of roughnesses to show errors at [default: 0.25]
    #[arg(long, value_name = "X")]
    pub ratio: Option<Ratio>,
    /// Azimuth of the view to show errors at, in radians [default: 0.7]
    #[arg(long, value_name = "ANGLE", allow_negative_numbers = true)]
    pub phi: Option<Azimuth>,
    /// Threads.
    #[command(flatten)]
    pub threads: Threads,
}

/// The plots.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum PlotName {
    /// Errors over theta and alpha, or a lookup table and its errors
    Error,
    /// Every number of every entry
    Matrix,
}

/// Draws and writes the picture.
pub(super) fn run(args: &PlotArgs, context: &mut Context<'_>) -> Result<Exit, CommandFailure> {
    if args.name != PlotName::Error && (args.ratio.is_some() || args.phi.is_some()) {
        return Err(usage("--ratio and --phi are only for plot error; plot matrix shows every entry"));
    }
    let out = OutputFile::check_png(&args.out)?;
    if let Some((_, digest, LutFile { recipe, lut })) = super::lut::read(&args.table)? {
        if args.name != PlotName::Error || args.ratio.is_some() || args.phi.is_some() {
            return Err(usage("a lookup table has only plot error, without --ratio and --phi"));
        }
        let picture = args.threads.pool()?.install(|| draw_lut(&recipe, &lut, &digest.hex()));
        return written(args, &out, digest, &picture, context);
    }
    let AnyTable { table, digest, path, .. } = AnyTable::read(&args.table)?;
    let plot = match args.name {
        PlotName::Error => {
            tabulated::check_complete(&table, &path)?;
            Plot::Error(ErrorSlice::new(args.ratio, args.phi))
        }
        PlotName::Matrix => Plot::Matrix,
    };
    let picture = args.threads.pool()?.install(|| plot.draw(&table, &digest.hex()));
    written(args, &out, digest, &picture, context)
}

fn written(
    args: &PlotArgs,
    out: &OutputFile,
    digest: Digest,
    picture: &Picture,
    context: &mut Context<'_>,
) -> Result<Exit, CommandFailure> {
    out.write(&picture.png().map_err(failed)?)?;
    let value = json!({
        "file": shown(&args.out), "table": digest, "width": picture.width, "height": picture.height,
    });
    context.print(&value, &shown(&args.out))
}
