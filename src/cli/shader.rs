//! `shader`: the lookup and the area light, as source for a renderer.

use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use serde_json::{Value, json};

use super::{AnyTable, CommandFailure, Context, Exit, OutputFile, TableFolder, Threads, failed, named, shown, usage};
use ltcforge_fit::{FUNCTION_SIDE, IsotropicFunction, Layout, Table, report};
use ltcforge_light::{LightModel, NormalsRule, textured::Readings};
use ltcforge_shaders::{
    Additions, Bound, DECLARATIONS, Filter, GivenAxes, Language, Lights, LitBy, Namespace, Prefix, Reading, es_module,
};
use ltcforge_textures::About;
use ltcforge_translate::{
    include, include_function, include_given, include_layers, include_prefilter, include_samplers, port,
};

/// `shader`.
#[derive(Debug, Args)]
#[expect(clippy::struct_excessive_bools, reason = "a flag each")]
pub struct ShaderArgs {
    /// Shading language
    #[arg(long, value_parser = named(Language::ALL, Language::name))]
    pub language: Language,
    /// Model of light
    #[arg(long, value_parser = named(LightModel::ALL, LightModel::name), default_value = "ltc")]
    pub model: LightModel,
    /// Rule of model normals [default: balanced]
    #[arg(long, value_parser = named(&NormalsRule::SHADED, NormalsRule::name))]
    pub rule: Option<NormalsRule>,
    /// Form of the code
    #[arg(long = "as", value_enum, default_value = "include")]
    pub form: ShaderForm,
    /// Let the sampler interpolate: fewer fetches, less exact
    #[arg(long)]
    pub hardware_filter: bool,
    /// Read the table from one 2D array instead of three 3D textures
    #[arg(long)]
    pub texture_array: bool,
    /// Read the second lobe of a `two_lobes` or `blended_lobes` table
    #[arg(long)]
    pub two_lobes: bool,
    /// Lights to include functions for, in models ltc and ltc-formula [default: all]
    #[arg(long, value_parser = named(Lights::ALL, Lights::name))]
    pub lights: Option<Lights>,
    /// Functions to add.
    #[command(flatten)]
    pub additions: AdditionArgs,
    /// Prefix of all names instead of ltc, normals or gaussians
    #[arg(long, value_name = "NAME")]
    pub prefix: Option<Prefix>,
    /// Number of the first binding [default: 0]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(..=1000))]
    pub first_binding: Option<u16>,
    /// Group (WGSL), set (GLSL) or space (HLSL) of the bindings [default: 0]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(..=31))]
    pub group: Option<u16>,
    /// Layout of the tables to read, as in the table's recipe
    #[arg(long, value_parser = named(Layout::ALL, Layout::name))]
    pub layout: Option<Layout>,
    /// Isotropic table to embed as polynomials instead of textures
    #[arg(long, value_name = "TABLE", conflicts_with_all = ["layout", "hardware_filter", "texture_array", "two_lobes", "first_binding", "group"])]
    pub without_textures: Option<PathBuf>,
    /// Table with uneven nodes to read; the code contains the nodes
    #[arg(long, value_name = "TABLE", conflicts_with_all = ["layout", "without_textures"])]
    pub nodes: Option<PathBuf>,
    /// The folder of tables
    #[command(flatten)]
    pub folder: TableFolder,
    /// Threads.
    #[command(flatten)]
    pub threads: Threads,
    /// Write a JavaScript module (-o NAME.js or .mjs) and its types
    #[arg(long)]
    pub es_module: bool,
    /// Output file [default: standard output]
    #[arg(short, long, value_name = "FILE")]
    pub out: Option<PathBuf>,
}

/// Options that add functions to a text to include.
#[derive(Debug, Clone, Copy, Args)]
pub struct AdditionArgs {
    /// Add functions that cut lights at the surface (ltc, ltc-formula)
    #[arg(long)]
    pub cut: bool,
    /// Add the factor that replaces light lost between facets (metals)
    #[arg(long)]
    pub compensate: bool,
    /// Add textured rectangles, with this many texture reads per light
    #[arg(long, value_name = "READINGS", value_parser = named(Readings::ALL, Readings::name), conflicts_with = "without_textures")]
    pub textured: Option<Readings>,
}

/// The form of a shader.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum ShaderForm {
    /// Functions and bindings to include in your shader
    Include,
    /// Compute shader that calls them
    Example,
    /// Functions that layer coat and fuzz over a base, for any model
    Layers,
    /// Functions that prefilter a picture on a light, pass by pass
    Prefilter,
    /// Functions that draw directions to lights, for shadows
    Samplers,
}

/// Configurations at which a table and its polynomials are measured: enough that a single one hardly changes the mean.
const COMPARED_AT: usize = 512;

/// Writes the shader to the file, or to standard output. With `--json`, prints one line that describes the file or
/// contains the shader's text.
pub(super) fn run(args: &ShaderArgs, context: &mut Context<'_>) -> Result<Exit, CommandFailure> {
    if let Some(why) = refusal(args) {
        return Err(usage(why));
    }
    let is_text = args.language != Language::Spirv;
    if !is_text && args.out.is_none() && (context.json || context.stdout_is_terminal) {
        return Err(usage("SPIR-V is binary: name a file with -o, or redirect standard output"));
    }
    // An unsupported model is reported before a file that cannot be written.
    let lit_by = match (args.form, &args.nodes, &args.without_textures) {
        (ShaderForm::Include | ShaderForm::Example, None, None) => Some(lit_by(args)?),
        _ => None,
    };
    let types = types_file(args)?;
    let out = args.out.as_deref().map(OutputFile::check).transpose()?;
    let types = types.map(|path| Ok::<_, CommandFailure>((OutputFile::check(&path)?, path))).transpose()?;
    let (shader, mut value) = made(args, lit_by)?;
    if let (Some(file), Some(path)) = (out, &args.out) {
        let module = types.as_ref().map(|_| es_module(&String::from_utf8_lossy(&shader), args.language));
        let written = module.as_ref().map_or(&*shader, String::as_bytes);
        file.write(written)?;
        if let Some((types, path)) = types {
            types.write(DECLARATIONS.as_bytes())?;
            value["declarations"] = json!(shown(&path));
        }
        (value["file"], value["bytes"]) = (json!(shown(path)), json!(written.len()));
        return if context.json { context.print(&value, "") } else { Ok(Exit::Ok) };
    }
    if context.json {
        value["source"] = json!(String::from_utf8_lossy(&shader));
        return context.print(&value, "");
    }
    let written = context.stdout.write_all(&shader).and_then(|()| context.stdout.flush());
    written.map(|()| Exit::Ok).map_err(|error| CommandFailure::stdout(&error))
}

/// The light model of a shader that does not depend on a specific table.
fn lit_by(args: &ShaderArgs) -> Result<LitBy, CommandFailure> {
    LitBy::new(args.model, args.layout)
        .and_then(|lit_by| lit_by.by_rule(args.rule))
        .map_err(usage)?
        .with(additions(args))
        .map_err(usage)
}

/// The shader, and its JSON description.
fn made(args: &ShaderArgs, lit_by: Option<LitBy>) -> Result<(Vec<u8>, Value), CommandFailure> {
    let language = args.language;
    let text = match (args.form, lit_by) {
        (ShaderForm::Layers, _) => include_layers(language).map_err(usage)?,
        (ShaderForm::Prefilter, _) => include_prefilter(language).map_err(usage)?,
        (ShaderForm::Samplers, _) => include_samplers(language).map_err(usage)?,
        (form, Some(lit_by)) => {
            let value = json!({
                "language": language.name(), "model": lit_by.model(), "rule": lit_by.rule(), "layout": lit_by.layout()
            });
            let shader = if form == ShaderForm::Example {
                port(language, lit_by)
            } else {
                include(language, lit_by, reading(args), lights(args), &namespace(args)).map(String::into_bytes)
            };
            return Ok((shader.map_err(failed)?, value));
        }
        (_, None) => return of_table(args),
    };
    Ok((text.into_bytes(), json!({ "language": language.name() })))
}

/// The shader for one table: with its nodes, or as polynomials. A shader with polynomials has a comment that states
/// their error and the error of the table.
fn of_table(args: &ShaderArgs) -> Result<(Vec<u8>, Value), CommandFailure> {
    let language = args.language;
    let name = args.nodes.as_ref().or(args.without_textures.as_ref()).map_or(Path::new(""), PathBuf::as_path);
    let AnyTable { path, digest, table, origin } = AnyTable::named(name, &args.folder)?;
    let refused = |why: String| usage(format!("{}: {why}", path.display()));
    let about = About::of_table(digest, origin.recipe(), None);
    let mut value = json!({ "language": language.name(), "model": LightModel::Ltc, "table": digest });
    let text = if args.nodes.is_some() {
        if let Some(gaussian) = table.lobe().gaussian() {
            return Err(refused(format!("--nodes needs a table of LTCs; this table has lobe {gaussian}")));
        }
        let layout = table.layout();
        let given = GivenAxes::of(&table).ok_or_else(|| {
            refused(format!("the table has the nodes of layout {layout}: use --layout {layout} instead of --nodes"))
        })?;
        value["layout"] = json!(given.layout());
        let lit_by = LitBy::from(given.layout()).with(additions(args)).map_err(usage)?;
        include_given(language, lit_by, &given, about.lines(), reading(args), lights(args), &namespace(args))
    } else {
        let function = IsotropicFunction::of(&table).map_err(|error| refused(error.to_string()))?;
        let measured = |table: &Table| report(table, origin.range(), COMPARED_AT).between.width.mean;
        let measure = || [measured(&table), measured(&function.table(&table))];
        let [table_width, width] = args.threads.pool()?.install(measure);
        value["coefficients"] = json!(6 * FUNCTION_SIDE * FUNCTION_SIDE);
        (value["error"], value["table_error"]) = (json!(width), json!(table_width));
        let about =
            about.and([format!("mean error in widths of the lobe: polynomials {width:.4}, table {table_width:.4}")]);
        include_function(language, &function, about.lines(), lights(args), additions(args), &namespace(args))
    };
    Ok((text.map_err(failed)?.into_bytes(), value))
}

/// How the shader reads a table.
fn reading(args: &ShaderArgs) -> Reading {
    let filter = if args.hardware_filter { Filter::Hardware } else { Filter::Exact };
    let bound = if args.texture_array { Bound::Array } else { Bound::Volumes };
    Reading { filter, bound, two_lobes: args.two_lobes }
}

/// The lights that the shader has functions for.
fn lights(args: &ShaderArgs) -> Lights {
    args.lights.unwrap_or(Lights::ALL[0])
}

/// The names and bindings of the code in the shader that includes it.
fn namespace(args: &ShaderArgs) -> Namespace {
    Namespace {
        prefix: args.prefix.clone(),
        first_binding: args.first_binding.unwrap_or(0),
        group: args.group.unwrap_or(0),
    }
}

/// The functions that the options add to the shader.
fn additions(args: &ShaderArgs) -> Additions {
    let AdditionArgs { cut, compensate, textured } = args.additions;
    Additions { cut, compensate, textured }
}

/// The path of the type declarations of a JavaScript module; `None` without `--es-module`.
fn types_file(args: &ShaderArgs) -> Result<Option<PathBuf>, CommandFailure> {
    let Some(out) = args.out.as_deref().filter(|_| args.es_module) else {
        return if args.es_module { Err(usage(NO_MODULE)) } else { Ok(None) };
    };
    match out.extension().and_then(|extension| extension.to_str()) {
        Some("js") => Ok(Some(out.with_extension("d.ts"))),
        Some("mjs") => Ok(Some(out.with_extension("d.mts"))),
        _ => Err(usage(NO_MODULE)),
    }
}

const NO_MODULE: &str = "--es-module needs -o NAME.js or -o NAME.mjs";

/// Why the form, the language or the model does not support one of the given options.
fn refusal(args: &ShaderArgs) -> Option<String> {
    let AdditionArgs { cut, compensate, textured } = args.additions;
    let (language, model, form) = (args.language, args.model, args.form);
    // The second flag is true for options that need `--as include`.
    let options = [
        ("--model", model != LightModel::Ltc, false),
        ("--rule", args.rule.is_some(), false),
        ("--layout", args.layout.is_some(), false),
        ("--nodes", args.nodes.is_some(), true),
        ("--without-textures", args.without_textures.is_some(), true),
        ("--lights", args.lights.is_some(), true),
        ("--cut", cut, true),
        ("--compensate", compensate, true),
        ("--textured", textured.is_some(), true),
        ("--two-lobes", args.two_lobes, true),
        ("--hardware-filter", args.hardware_filter, true),
        ("--texture-array", args.texture_array, true),
        ("--prefix", args.prefix.is_some(), true),
        ("--first-binding", args.first_binding.is_some(), true),
        ("--group", args.group.is_some(), true),
    ];
    let mut given = options.iter().filter(|(_, is_given, _)| *is_given);
    match form {
        ShaderForm::Layers | ShaderForm::Prefilter | ShaderForm::Samplers => {
            let given: Vec<&str> = given.map(|(name, ..)| *name).collect();
            return (!given.is_empty())
                .then(|| format!("this form does not depend on a model: leave out {}", given.join(", ")));
        }
        ShaderForm::Example => {
            if let Some((name, ..)) = given.find(|(.., is_for_includes)| *is_for_includes) {
                return Some(format!("{name} needs --as include"));
            }
        }
        ShaderForm::Include => {}
    }
    let is_ltc = model == LightModel::Ltc;
    let has_table = args.layout.is_some() || args.nodes.is_some();
    let is_placed = args.first_binding.is_some() || args.group.is_some();
    let is_numbered = matches!(language, Language::Wgsl | Language::Glsl | Language::Hlsl);
    let name = language.name();
    let faults = [
        (!is_ltc && (args.nodes.is_some() || args.without_textures.is_some()))
            .then(|| "--nodes and --without-textures need --model ltc".to_owned()),
        (is_placed && !is_numbered)
            .then(|| format!("{name} has no numbered bindings: leave out --first-binding and --group")),
        (is_placed && !has_table && textured.is_none())
            .then(|| format!("model {model} binds no textures: leave out --first-binding and --group")),
        (args.two_lobes && !(has_table && is_ltc))
            .then(|| "--two-lobes needs a table of LTCs: add --layout, or leave it out".to_owned()),
        (args.lights.is_some() && !model.is_of_ltcs())
            .then(|| format!("--lights is only for models ltc and ltc-formula, not for {model}: leave it out")),
        ((args.texture_array || args.hardware_filter) && !has_table)
            .then(|| "--texture-array and --hardware-filter need a table: add --layout, or leave them out".to_owned()),
        (args.hardware_filter && language == Language::Wgsl)
            .then(|| "in WGSL, set the constant ltc_hardware_filter instead of --hardware-filter".to_owned()),
        (args.es_module && !language.has_includes())
            .then(|| format!("--es-module needs a text language; {name} is binary")),
        (form == ShaderForm::Include && !language.has_includes())
            .then(|| format!("{name} has no include: add --as example")),
        (form == ShaderForm::Example && !language.has_programs())
            .then(|| format!("{name} has no compute shaders: leave out --as example")),
    ];
    faults.into_iter().flatten().next()
}
