//! `shader`: the lookup and the area light, as source for a renderer.

use serde_json::json;

use super::{CommandFailure, Context, Exit, args::ShaderArgs, output::OutputFile, print, shown};
use crate::{
    light::LightModel,
    view::shaders::{Language, LitBy, port},
};

/// Writes the shader to the file, or to standard output. With `--json` one line
/// describes the file, or holds the shader's text.
pub(super) fn run(args: &ShaderArgs, json: bool, context: &mut Context<'_>) -> Result<Exit, CommandFailure> {
    let language = args.language.0;
    let lit_by = match (args.model, args.layout) {
        (LightModel::Ltc, Some(layout)) => LitBy::Table(layout),
        (LightModel::Normals, None) => LitBy::Normals,
        (LightModel::Ltc, None) => return Err(CommandFailure::new(Exit::Usage, "model ltc needs --layout")),
        (LightModel::Normals, Some(_)) => {
            return Err(CommandFailure::new(Exit::Usage, "model normals reads no table: leave out --layout"));
        }
    };
    if language == Language::Spirv && args.out.is_none() && (json || context.stdout_is_terminal) {
        return Err(CommandFailure::new(
            Exit::Usage,
            "SPIR-V is binary: name a file with -o, or redirect standard output",
        ));
    }
    let out = args.out.as_deref().map(OutputFile::check).transpose()?;
    let shader = port(language, lit_by).map_err(|error| CommandFailure::new(Exit::Failed, error.to_string()))?;
    if let (Some(out), Some(path)) = (&out, &args.out) {
        out.write(&shader)?;
        if json {
            let value = json!({
                "file": shown(path), "language": language.name(), "model": lit_by.model(), "layout": lit_by.layout(),
                "bytes": shader.len(),
            });
            print(context.stdout, true, &value, "")?;
        }
    } else if json {
        let source = String::from_utf8_lossy(&shader);
        let value = json!({
            "language": language.name(), "model": lit_by.model(), "layout": lit_by.layout(), "source": source,
        });
        print(context.stdout, true, &value, "")?;
    } else {
        context
            .stdout
            .write_all(&shader)
            .and_then(|()| context.stdout.flush())
            .map_err(|error| CommandFailure::stdout(&error))?;
    }
    Ok(Exit::Ok)
}
