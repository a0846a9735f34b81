//! `figures`: the figures of the paper, drawn anew.

use serde_json::json;

use super::{
    CommandFailure, Context, Exit, args::FiguresArgs, file_failure, output::check_output_folder, print, shown,
};
use crate::{
    files::replace::replace_file,
    view::{figures::Figure, preview::Preview},
};

/// Draws each figure and writes it as soon as it is done.
pub(super) fn run(args: &FiguresArgs, json: bool, context: &mut Context<'_>) -> Result<Exit, CommandFailure> {
    check_output_folder(&args.out)?;
    let pool = args.threads.pool()?;
    let failed = |error: &dyn std::fmt::Display| CommandFailure::new(Exit::Failed, error.to_string());
    let mut preview = Preview::new(args.adapter.0);
    for figure in Figure::ALL.into_iter().filter(|figure| args.names.is_empty() || args.names.contains(figure)) {
        let picture = pool.install(|| figure.draw(&mut preview)).map_err(|error| failed(&error))?;
        let png = picture.png().map_err(|error| failed(&error))?;
        let path = args.out.join(format!("{}.png", figure.name()));
        replace_file(&path, &png).map_err(|error| file_failure(&path, &error))?;
        let value = json!({
            "figure": figure.name(), "file": shown(&path), "width": picture.width, "height": picture.height,
        });
        print(context.stdout, json, &value, &shown(&path))?;
    }
    Ok(Exit::Ok)
}
