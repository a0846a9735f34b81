//! `preview`: surfaces lit by a table, as a picture.

use std::{
    path::PathBuf,
    sync::{Arc, LazyLock},
};

use clap::{
    Arg, ArgMatches, Args, Command, Error, FromArgMatches,
    builder::{PossibleValuesParser, TypedValueParser},
};
use serde_json::json;

use super::{
    AnyTable, CommandFailure, Context, Exit, OutputFile, TableFolder, failed, light_picture::read_picture, named,
    shown, usage,
};
use ltcforge_light::{LightError, LightModel};
use ltcforge_view::preview::{
    Adapter, Choices, Material, PARAMETERS, PanelError, Parameter, ParameterForm, Preview, PreviewError, Rendered,
    ScenePicture, ShaderTable, TexelFormat, Value,
};

/// `preview`. Parameters that are not given come from the named scene.
#[derive(Debug, Args)]
pub struct PreviewArgs {
    /// Table: a file, or the first digits of a digest in --tables
    pub table: Option<PathBuf>,
    /// The folder of tables
    #[command(flatten)]
    pub folder: TableFolder,
    /// Output file
    #[arg(short, long, value_name = "FILE.png")]
    pub out: PathBuf,
    /// The scene and its parameters
    #[command(flatten)]
    pub scene: SceneChoices,
    /// Picture on the light (PNG, `OpenEXR`, Radiance HDR, JPEG)
    #[arg(long, value_name = "IMAGE", conflicts_with = "light_picture")]
    pub light_texture: Option<PathBuf>,
    /// Number format of the table on the GPU
    #[arg(long, value_parser = named(TexelFormat::ALL, TexelFormat::name), default_value = "f32")]
    pub precision: TexelFormat,
    /// Use amplitude and Fresnel term of GGX instead of the table's
    #[arg(long)]
    pub ggx_terms: bool,
    /// Renderer
    #[arg(long, value_parser = named(Adapter::ALL, Adapter::name), default_value = "any", env = "LTCFORGE_ADAPTER")]
    pub adapter: Adapter,
}

/// The parameters of a scene that the command line gives.
#[derive(Debug, Clone)]
pub struct SceneChoices(Choices);

/// The names of the parameters on the command line, in the order of [`PARAMETERS`].
static FLAGS: LazyLock<[String; PARAMETERS.len()]> =
    LazyLock::new(|| std::array::from_fn(|i| PARAMETERS[i].name.replace('_', "-")));

fn argument(parameter: &'static Parameter, flag: &'static str) -> Arg {
    let arg = Arg::new(parameter.name).long(flag).help(parameter.line()).value_name(parameter.value_name);
    let parse = |text: &str| parameter.parse(text);
    match parameter.form {
        ParameterForm::Name { names, .. } => {
            arg.value_parser(PossibleValuesParser::new(names()).try_map(move |name| parse(&name)))
        }
        // A list may begin with a negative number, which clap would take for a flag.
        _ if parameter.count() > 1 => arg.value_parser(parse).allow_hyphen_values(true),
        _ => arg.value_parser(parse).allow_negative_numbers(true),
    }
}

impl Args for SceneChoices {
    fn augment_args(command: Command) -> Command {
        command.args(PARAMETERS.iter().zip(FLAGS.iter()).map(|(parameter, flag)| argument(parameter, flag)))
    }

    fn augment_args_for_update(command: Command) -> Command {
        Self::augment_args(command)
    }
}

impl FromArgMatches for SceneChoices {
    fn from_arg_matches(matches: &ArgMatches) -> Result<Self, Error> {
        Ok(Self(Choices::of(|parameter| matches.get_one::<Value>(parameter.name).cloned())))
    }

    fn update_from_arg_matches(&mut self, matches: &ArgMatches) -> Result<(), Error> {
        *self = Self::from_arg_matches(matches)?;
        Ok(())
    }
}

/// Renders a picture and writes it. Prints the adapter, the materials outside the table, and the errors of comparison
/// modes to standard error, or as JSON to standard output.
pub(super) fn run(args: &PreviewArgs, context: &mut Context<'_>) -> Result<Exit, CommandFailure> {
    let out = OutputFile::check_png(&args.out)?;
    let mut scene = args.scene.0.clone().into_scene();
    if let Some(path) = &args.light_texture {
        scene.picture = ScenePicture::Image(Arc::new(read_picture(path)?));
    }
    let named = args.table.as_deref();
    let read = named.map(|name| AnyTable::named(name, &args.folder)?.with_terms(args.ggx_terms)).transpose()?;
    if read.is_none() && scene.needs_table() {
        return Err(usage(LightError::NeedsTable(LightModel::Ltc)));
    }
    let (table, digest) = read.map(|any| (any.table, any.digest)).unzip();
    if let Some(table) = table.as_ref().filter(|table| !table.layout().is_even(table.axes())) {
        let message =
            format!("preview cannot show tables with uneven nodes; layout {} has evenly spaced nodes", table.layout());
        return Err(usage(message));
    }
    let shader_table = Arc::new(match (&table, &digest) {
        (Some(table), Some(digest)) => ShaderTable::new(table, args.precision).labelled(&digest.hex()),
        _ => ShaderTable::none(),
    });
    let rendered = Preview::new(args.adapter).render(&shader_table, &scene, &|| false);
    let Rendered { picture, adapter, errors, out_of_range } = rendered.map_err(|error| failure(&error))?;
    out.write(&picture.png().map_err(failed)?)?;
    let errors_json: Vec<_> = errors
        .iter()
        .map(|error| {
            json!({
                "model": error.model, "alpha_x": error.alpha_x, "alpha_y": error.alpha_y,
                "mean_absolute_error": error.mean_absolute, "noise": error.noise, "mean_radiance": error.mean_radiance,
            })
        })
        .collect();
    let out_of_range_json: Vec<_> =
        out_of_range.iter().map(|m| json!({ "alpha_x": m.alpha_x, "alpha_y": m.alpha_y })).collect();
    let value = json!({
        "file": shown(&args.out), "table": digest, "adapter": adapter,
        "width": picture.width, "height": picture.height, "errors": errors_json,
        "outside": out_of_range_json,
    });
    if context.json {
        return context.print(&value, "");
    }
    eprintln!("adapter: {adapter}");
    for (Material { alpha_x, alpha_y, .. }, table) in out_of_range.iter().zip(table.iter().cycle()) {
        // The materials of a table may be in any order, so its first and last entries are not the ends of its ranges.
        let [least, most, least_ratio, most_ratio] = table.shader_axes().roughness;
        eprintln!(
            "alpha {alpha_x} {alpha_y} lies outside the table, which covers alpha {least} to {most} and ratio \
             {least_ratio} to {most_ratio}; its nearest entry is shown"
        );
    }
    for PanelError { model, alpha_x, alpha_y, mean_absolute: error, noise, mean_radiance: radiance } in &errors {
        eprintln!(
            "{model}, alpha {alpha_x} {alpha_y}: mean absolute error {error:.5} of mean radiance {radiance:.5}; noise of \
             the reference {noise:.5}, not part of the error"
        );
    }
    Ok(Exit::Ok)
}

fn failure(error: &PreviewError) -> CommandFailure {
    let exit = match error {
        PreviewError::Scene(..) | PreviewError::Table(_) | PreviewError::CpuOnly(_) => Exit::Usage,
        _ => Exit::Failed,
    };
    CommandFailure::new(exit, error.to_string())
}
