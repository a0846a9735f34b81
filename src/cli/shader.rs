//! `shader`: the lookup and the area light, as source for a renderer.

use serde_json::json;

use super::{CommandFailure, Context, Exit, args::ShaderArgs, output::OutputFile, print, shown};
use crate::view::shaders::{Language, port};

/// Writes the shader to the file, or to standard output. With `--json` one line
/// describes the file, or holds the shader's text.
pub(super) fn run(args: &ShaderArgs, json: bool, context: &mut Context<'_>) -> Result<Exit, CommandFailure> {
    let (language, layout) = (args.language.0, args.layout);
    if language == Language::Spirv && args.out.is_none() && (json || context.stdout_is_terminal) {
        return Err(CommandFailure::new(
            Exit::Usage,
            "SPIR-V is binary: name a file with -o, or redirect standard output",
        ));
    }
    let out = args.out.as_deref().map(OutputFile::check).transpose()?;
    let shader = port(language, layout).map_err(|error| CommandFailure::new(Exit::Failed, error.to_string()))?;
    if let (Some(out), Some(path)) = (&out, &args.out) {
        out.write(&shader)?;
        if json {
            let value =
                json!({ "file": shown(path), "language": language.name(), "layout": layout, "bytes": shader.len() });
            print(context.stdout, true, &value, "")?;
        }
    } else if json {
        let source = String::from_utf8_lossy(&shader);
        let value = json!({ "language": language.name(), "layout": layout, "source": source });
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
