//! `shader`: the lookup and the area light, as source for a renderer.

use serde_json::json;

use super::{
    CommandFailure, Context, Exit,
    args::{ShaderArgs, ShaderForm},
    output::OutputFile,
    print, shown,
};
use crate::{
    light::LightModel,
    view::shaders::{Filter, Language, LitBy, include, port},
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
    check_form(args, language)?;
    if language == Language::Spirv && args.out.is_none() && (json || context.stdout_is_terminal) {
        return Err(CommandFailure::new(
            Exit::Usage,
            "SPIR-V is binary: name a file with -o, or redirect standard output",
        ));
    }
    let out = args.out.as_deref().map(OutputFile::check).transpose()?;
    let shader = match args.form {
        ShaderForm::Include => {
            let filter = if args.hardware_filter { Filter::Hardware } else { Filter::Exact };
            include(language, lit_by, filter).map(String::into_bytes)
        }
        ShaderForm::Example => port(language, lit_by),
    }
    .map_err(|error| CommandFailure::new(Exit::Failed, error.to_string()))?;
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

/// Refuses what a language or a model does not have.
fn check_form(args: &ShaderArgs, language: Language) -> Result<(), CommandFailure> {
    let refused = |what: String| Err(CommandFailure::new(Exit::Usage, what));
    let name = language.name();
    match args.form {
        ShaderForm::Include if !language.has_includes() => {
            refused(format!("{name} has no text to include: add --as example"))
        }
        ShaderForm::Example if !language.has_programs() => {
            refused(format!("{name} has no compute shaders, and the example is one: leave out --as example"))
        }
        _ if !args.hardware_filter => Ok(()),
        ShaderForm::Example => refused("--hardware-filter is for a text to include".to_owned()),
        ShaderForm::Include if args.model == LightModel::Normals => {
            refused("--hardware-filter is for tables: model normals reads none".to_owned())
        }
        ShaderForm::Include if language == Language::Wgsl => {
            refused("in WGSL the constant ltc_hardware_filter chooses: leave out --hardware-filter".to_owned())
        }
        ShaderForm::Include => Ok(()),
    }
}
