//! `figures`: draws the figures of the paper and of the notes again.

use serde_json::json;

use super::{
    CommandFailure, Context, Exit, args::FiguresArgs, file_failure, output::check_output_folder, print, shown,
};
use ltcforge_files::replace::replace_file;
use ltcforge_view::{
    figures::{Drawn, Figure},
    preview::Preview,
};

/// Draws each figure and writes it as soon as it is done.
pub(super) fn run(args: &FiguresArgs, json: bool, context: &mut Context<'_>) -> Result<Exit, CommandFailure> {
    check_output_folder(&args.out)?;
    let pool = args.threads.pool()?;
    let failed = |error: &dyn std::fmt::Display| CommandFailure::new(Exit::Failed, error.to_string());
    let mut preview = Preview::new(args.adapter.0);
    let asked = Figure::ALL.iter().filter(|figure| args.names.is_empty() || args.names.contains(figure));
    for figure in asked {
        let drawn = pool.install(|| figure.draw(&mut preview)).map_err(|error| failed(&error))?;
        let path = args.out.join(format!("{figure}.{}", drawn.extension()));
        let mut value = json!({ "figure": figure.name(), "file": shown(&path) });
        let bytes = match drawn {
            Drawn::Picture(picture) => {
                value["width"] = picture.width.into();
                value["height"] = picture.height.into();
                picture.png().map_err(|error| failed(&error))?
            }
            Drawn::Table(text) => text.into_bytes(),
        };
        replace_file(&path, &bytes).map_err(|error| file_failure(&path, &error))?;
        print(context.stdout, json, &value, &shown(&path))?;
    }
    Ok(Exit::Ok)
}
