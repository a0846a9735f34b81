//! `shader`: the lookup and the area light, as source for a renderer.

use std::path::{Path, PathBuf};

use serde_json::json;

use super::{
    CommandFailure, Context, Exit,
    args::{AdditionArgs, ShaderArgs, ShaderForm},
    input::{AnyTable, Origin},
    output::OutputFile,
    print, shown,
};
use ltcforge_fit::{FUNCTION_SIDE, FunctionError, IsotropicFunction, Table, report};
use ltcforge_light::LightModel;
use ltcforge_shaders::{
    Additions, Bound, DECLARATIONS, Filter, GivenAxes, Language, Lights, LitBy, Namespace, Reading, es_module,
};
use ltcforge_textures::About;
use ltcforge_translate::{
    PortError, include, include_function, include_given, include_layers, include_prefilter, port,
};

/// Configurations at which a table and its polynomials are measured: so many that a single one hardly matters.
const COMPARED_AT: usize = 512;

/// Writes the shader to the file, or to standard output. With `--json` one line
/// describes the file, or holds the shader's text.
pub(super) fn run(args: &ShaderArgs, json: bool, context: &mut Context<'_>) -> Result<Exit, CommandFailure> {
    let language = args.language;
    if let Some(table) = &args.without_textures {
        return without_textures(args, language, table, json, context);
    }
    match args.form {
        ShaderForm::Layers => return of_no_model(args, include_layers, "layers", json, context),
        ShaderForm::Prefilter => return of_no_model(args, include_prefilter, "prefilter", json, context),
        ShaderForm::Include | ShaderForm::Example => {}
    }
    if let Some(table) = &args.nodes {
        return given(args, language, table, json, context);
    }
    let lit_by = LitBy::new(args.model, args.layout)
        .and_then(|lit_by| lit_by.by_rule(args.rule))
        .map_err(|error| CommandFailure::new(Exit::Usage, error.to_string()))?
        .with(additions(args))
        .map_err(|error| CommandFailure::new(Exit::Usage, error.to_string()))?;
    check_form(args, language, args.layout.is_some())?;
    let types = types_file(args)?;
    if language == Language::Spirv && args.out.is_none() && (json || context.stdout_is_terminal) {
        return Err(CommandFailure::new(
            Exit::Usage,
            "SPIR-V is binary: name a file with -o, or redirect standard output",
        ));
    }
    let out = Outputs::check(args, types)?;
    let shader = if args.form == ShaderForm::Example {
        port(language, lit_by)
    } else {
        let lights = args.lights.unwrap_or(Lights::ALL[0]);
        include(language, lit_by, reading(args), lights, &namespace(args)).map(String::into_bytes)
    }
    .map_err(|error| CommandFailure::new(Exit::Failed, error.to_string()))?;
    let value = json!({
        "language": language.name(), "model": lit_by.model(), "rule": lit_by.rule(), "layout": lit_by.layout()
    });
    hand_out(args, &out, &shader, value, json, context)
}

/// The text that searches for the nodes of a table.
fn given(
    args: &ShaderArgs,
    language: Language,
    table: &Path,
    json: bool,
    context: &mut Context<'_>,
) -> Result<Exit, CommandFailure> {
    let usage = |what: String| CommandFailure::new(Exit::Usage, what);
    if args.form != ShaderForm::Include || args.model != LightModel::Ltc {
        return Err(usage("--nodes is for a text of model ltc to include".to_owned()));
    }
    check_form(args, language, true)?;
    let out = Outputs::check(args, types_file(args)?)?;
    let AnyTable { path, digest, table, origin } = AnyTable::named(table, &args.folder)?;
    if let Some(gaussian) = table.lobe().gaussian() {
        return Err(usage(format!("{}: --nodes is for tables of LTCs, not of lobe {gaussian}", path.display())));
    }
    let given = GivenAxes::of(&table).ok_or_else(|| {
        let layout = table.layout();
        usage(format!("{}: its nodes are those of layout {layout}: say --layout {layout}", path.display()))
    })?;
    let lit_by = LitBy::from(given.layout()).with(additions(args)).map_err(|error| usage(error.to_string()))?;
    let recipe = if let Origin::Recipe(recipe) = &origin { Some(recipe) } else { None };
    let about = About::of_table(digest, recipe, None);
    let lights = args.lights.unwrap_or(Lights::ALL[0]);
    let shader = include_given(language, lit_by, &given, about.lines(), reading(args), lights, &namespace(args))
        .map_err(|error| CommandFailure::new(Exit::Failed, error.to_string()))?;
    let value = json!({
        "language": language.name(), "model": LightModel::Ltc, "layout": given.layout(), "table": digest,
    });
    hand_out(args, &out, shader.as_bytes(), value, json, context)
}

/// How the text reads a table.
fn reading(args: &ShaderArgs) -> Reading {
    let filter = if args.hardware_filter { Filter::Hardware } else { Filter::Exact };
    let bound = if args.texture_array { Bound::Array } else { Bound::Volumes };
    Reading { filter, bound, two_lobes: args.two_lobes }
}

/// The names and bindings of a text in the shader that includes it.
fn namespace(args: &ShaderArgs) -> Namespace {
    Namespace {
        prefix: args.prefix.clone(),
        first_binding: args.first_binding.unwrap_or(0),
        group: args.group.unwrap_or(0),
    }
}

/// The functions that the options add to the text.
fn additions(args: &ShaderArgs) -> Additions {
    let AdditionArgs { cut, compensate, textured } = args.additions;
    Additions { cut, compensate, textured }
}

/// The light of a table by polynomials, as a text to include. A comment in it states their error and the table's.
fn without_textures(
    args: &ShaderArgs,
    language: Language,
    table: &Path,
    json: bool,
    context: &mut Context<'_>,
) -> Result<Exit, CommandFailure> {
    let usage = |what: &str| CommandFailure::new(Exit::Usage, what.to_owned());
    if args.form != ShaderForm::Include || language == Language::Spirv {
        return Err(usage("--without-textures gives functions to include: choose another language, and no example"));
    }
    if args.model != LightModel::Ltc {
        return Err(usage("--without-textures is for model ltc"));
    }
    let out = Outputs::check(args, types_file(args)?)?;
    let AnyTable { path, digest, table, origin } = AnyTable::named(table, &args.folder)?;
    let refused = |error: FunctionError| CommandFailure::new(Exit::Usage, format!("{}: {error}", path.display()));
    let function = IsotropicFunction::of(&table).map_err(refused)?;
    let (recipe, range) = match &origin {
        Origin::Recipe(recipe) => (Some(recipe), recipe.range),
        Origin::Range(range) => (None, *range),
    };
    let measured = |table: &Table| report(table, &range, COMPARED_AT);
    let [of_table, of_function] =
        args.threads.pool()?.install(|| [measured(&table), measured(&function.table(&table))]);
    let [table_width, width] = [&of_table, &of_function].map(|report| report.between.width.mean);
    let about = About::of_table(digest, recipe, None);
    let about = about.and([format!(
        "mean error of the polynomials: {width:.4} of the lobe's width; of the table: {table_width:.4}"
    )]);
    let shader = include_function(
        language,
        &function,
        about.lines(),
        args.lights.unwrap_or(Lights::ALL[0]),
        additions(args),
        &namespace(args),
    )
    .map_err(|error| CommandFailure::new(Exit::Failed, error.to_string()))?
    .into_bytes();
    let value = json!({
        "language": language.name(), "model": LightModel::Ltc, "table": digest,
        "coefficients": 6 * FUNCTION_SIDE * FUNCTION_SIDE, "error": width, "table_error": table_width,
    });
    hand_out(args, &out, &shader, value, json, context)
}

/// The file of the types of a module of JavaScript; `None` where no module is asked for.
fn types_file(args: &ShaderArgs) -> Result<Option<PathBuf>, CommandFailure> {
    if !args.es_module {
        return Ok(None);
    }
    let refused = |what: &str| Err(CommandFailure::new(Exit::Usage, what.to_owned()));
    if args.language == Language::Spirv {
        return refused("--es-module is for text, and SPIR-V is binary: choose another language");
    }
    let extension = args.out.as_deref().and_then(Path::extension).and_then(|extension| extension.to_str());
    match (&args.out, extension) {
        (Some(out), Some("js")) => Ok(Some(out.with_extension("d.ts"))),
        (Some(out), Some("mjs")) => Ok(Some(out.with_extension("d.mts"))),
        _ => refused("--es-module needs -o NAME.js or -o NAME.mjs: the types are written beside it"),
    }
}

/// The files to write.
struct Outputs {
    /// None for standard output.
    text: Option<OutputFile>,
    /// The types of a module of JavaScript, and how the user sees their path.
    types: Option<(OutputFile, PathBuf)>,
}

impl Outputs {
    /// Checks that they can be written.
    fn check(args: &ShaderArgs, types: Option<PathBuf>) -> Result<Self, CommandFailure> {
        let text = args.out.as_deref().map(OutputFile::check).transpose()?;
        let types = types.map(|path| Ok::<_, CommandFailure>((OutputFile::check(&path)?, path))).transpose()?;
        Ok(Self { text, types })
    }
}

/// Writes the shader to the file or to standard output. With `--json`, `value` describes it, with the file or the text.
fn hand_out(
    args: &ShaderArgs,
    out: &Outputs,
    shader: &[u8],
    mut value: serde_json::Value,
    json: bool,
    context: &mut Context<'_>,
) -> Result<Exit, CommandFailure> {
    if let (Some(file), Some(path)) = (&out.text, &args.out) {
        let module = out.types.as_ref().map(|_| es_module(&String::from_utf8_lossy(shader), args.language));
        let written = module.as_ref().map_or(shader, String::as_bytes);
        file.write(written)?;
        if let Some((types, path)) = &out.types {
            types.write(DECLARATIONS.as_bytes())?;
            value["declarations"] = json!(shown(path));
        }
        if json {
            (value["file"], value["bytes"]) = (json!(shown(path)), json!(written.len()));
            print(context.stdout, true, &value, "")?;
        }
    } else if json {
        value["source"] = json!(String::from_utf8_lossy(shader));
        print(context.stdout, true, &value, "")?;
    } else {
        context
            .stdout
            .write_all(shader)
            .and_then(|()| context.stdout.flush())
            .map_err(|error| CommandFailure::stdout(&error))?;
    }
    Ok(Exit::Ok)
}

/// A text that is of no model of light. Refuses what is of models, all at once.
fn of_no_model(
    args: &ShaderArgs,
    text: fn(Language) -> Result<String, PortError>,
    name: &str,
    json: bool,
    context: &mut Context<'_>,
) -> Result<Exit, CommandFailure> {
    let given = [
        ("--model", args.model != LightModel::Ltc),
        ("--rule", args.rule.is_some()),
        ("--layout", args.layout.is_some()),
        ("--nodes", args.nodes.is_some()),
        ("--lights", args.lights.is_some()),
        ("--cut", args.additions.cut),
        ("--compensate", args.additions.compensate),
        ("--textured", args.additions.textured.is_some()),
        ("--two-lobes", args.two_lobes),
        ("--hardware-filter", args.hardware_filter),
        ("--texture-array", args.texture_array),
        ("--prefix", args.prefix.is_some()),
        ("--first-binding", args.first_binding.is_some()),
        ("--group", args.group.is_some()),
    ];
    let given: Vec<&str> = given.into_iter().filter(|(_, is_given)| *is_given).map(|(name, _)| name).collect();
    if !given.is_empty() {
        let message =
            format!("--as {name} is of no model of light and is bound as it says: leave out {}", given.join(", "));
        return Err(CommandFailure::new(Exit::Usage, message));
    }
    let out = Outputs::check(args, types_file(args)?)?;
    let text = text(args.language).map_err(|error| CommandFailure::new(Exit::Usage, error.to_string()))?;
    hand_out(args, &out, text.as_bytes(), json!({ "language": args.language.name() }), json, context)
}

/// Refuses options that a language or a model does not have.
fn check_form(args: &ShaderArgs, language: Language, has_table: bool) -> Result<(), CommandFailure> {
    let refused = |what: String| Err(CommandFailure::new(Exit::Usage, what));
    let name = language.name();
    let binds = has_table || args.additions.textured.is_some();
    let is_numbered = matches!(language, Language::Wgsl | Language::Glsl | Language::Hlsl);
    let is_placed = args.first_binding.is_some() || args.group.is_some();
    match args.form {
        ShaderForm::Example if args.prefix.is_some() || is_placed => {
            refused("--prefix, --first-binding and --group are for a text to include".to_owned())
        }
        _ if is_placed && (!binds || !is_numbered) => {
            let what = if is_numbered { format!("model {}", args.model) } else { name.to_owned() };
            refused(format!("{what} binds nothing by number: leave out --first-binding and --group"))
        }
        ShaderForm::Example if args.texture_array => refused("--texture-array is for a text to include".to_owned()),
        ShaderForm::Example if args.two_lobes => refused("--two-lobes is for a text to include".to_owned()),
        _ if args.two_lobes && (!has_table || args.model != LightModel::Ltc) => {
            refused(format!("--two-lobes is for tables of LTCs: model {} has no second lobe to read", args.model))
        }
        ShaderForm::Example if args.additions.cut => refused("--cut is for a text to include".to_owned()),
        ShaderForm::Example if args.additions.compensate => refused("--compensate is for a text to include".to_owned()),
        ShaderForm::Example if args.additions.textured.is_some() => {
            refused("--textured is for a text to include".to_owned())
        }
        ShaderForm::Example if args.lights.is_some() => refused("--lights is for a text to include".to_owned()),
        _ if args.lights.is_some() && args.model != LightModel::Ltc => refused(format!(
            "--lights is of model ltc: model {} has no spheres, tubes and lines to leave out",
            args.model
        )),
        _ if args.texture_array && !has_table => {
            refused(format!("--texture-array is for tables: model {} reads none", args.model))
        }
        _ if args.es_module && !language.has_includes() => {
            refused(format!("--es-module is for texts, and {name} is binary: leave it out"))
        }
        ShaderForm::Include if !language.has_includes() => {
            refused(format!("{name} has no text to include: add --as example"))
        }
        ShaderForm::Example if !language.has_programs() => {
            refused(format!("{name} has no compute shaders, and the example is one: leave out --as example"))
        }
        _ if !args.hardware_filter => Ok(()),
        ShaderForm::Example => refused("--hardware-filter is for a text to include".to_owned()),
        ShaderForm::Include if !has_table => {
            refused(format!("--hardware-filter is for tables: model {} reads none", args.model))
        }
        ShaderForm::Include if language == Language::Wgsl => {
            refused("in WGSL the constant ltc_hardware_filter chooses: leave out --hardware-filter".to_owned())
        }
        ShaderForm::Include | ShaderForm::Layers | ShaderForm::Prefilter => Ok(()),
    }
}
