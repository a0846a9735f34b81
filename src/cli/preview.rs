//! `preview`: surfaces lit by a table, as a picture.

mod materials;

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
    Adapter, Choices, Material, PARAMETERS, Parameter, ParameterForm, Preview, PreviewError, Rendered, ScenePicture,
    ShaderTable, TexelFormat, Value,
};

/// `preview`. A parameter that is not given is that of the named scene.
#[derive(Debug, Args)]
pub struct PreviewArgs {
    /// A table's file, or a digest as `fit` prints it (its first digits suffice) of a table in the folder of
    /// `--tables`; not needed for a picture that shows none
    pub table: Option<PathBuf>,
    /// The folder of tables
    #[command(flatten)]
    pub folder: TableFolder,
    /// The picture
    #[arg(short, long, value_name = "FILE.png")]
    pub out: PathBuf,
    /// The scene and its parameters
    #[command(flatten)]
    pub scene: SceneChoices,
    /// A picture on the light, in place of one with a name: PNG, `OpenEXR`, Radiance HDR or JPEG
    #[arg(long, value_name = "IMAGE", conflicts_with = "light_picture")]
    pub light_texture: Option<PathBuf>,
    /// Width of the table's numbers on the GPU
    #[arg(long, value_parser = named(TexelFormat::ALL, TexelFormat::name), default_value = "f32")]
    pub precision: TexelFormat,
    /// Take amplitude and Fresnel term of GGX itself at the table's nodes, in place of the table's own; a table without
    /// any reflects all light
    #[arg(long)]
    pub ggx_terms: bool,
    /// The renderer
    #[arg(long, value_parser = named(Adapter::ALL, Adapter::name), default_value = "any", env = "LTCFORGE_ADAPTER")]
    pub adapter: Adapter,
}

/// The scene of nine materials: on the command line beside the preview's named scenes, which one renderer shades.
const MATERIALS: &str = "materials";

/// The choices of a scene on the command line: an argument for each of the preview's parameters.
#[derive(Debug, Clone)]
pub struct SceneChoices {
    /// The parameters that are given; the scene among them if it is a named one.
    pub choices: Choices,
    /// Whether the scene is the one of nine materials.
    pub is_materials: bool,
}

/// The value of `--scene`.
#[derive(Debug, Clone)]
enum SceneName {
    Named(Value),
    Materials,
}

/// The parameter that names a scene.
const SCENE: &str = "scene";

/// Their names on the command line, in their order.
static FLAGS: LazyLock<[String; PARAMETERS.len()]> =
    LazyLock::new(|| std::array::from_fn(|i| PARAMETERS[i].name.replace('_', "-")));

fn argument(parameter: &'static Parameter, flag: &'static str) -> Arg {
    let arg = Arg::new(parameter.name).long(flag).help(parameter.line()).value_name(parameter.value_name);
    let parse = |text: &str| parameter.parse(text);
    match parameter.form {
        ParameterForm::Name { names, .. } if parameter.name == SCENE => {
            let names = names().into_iter().chain([MATERIALS]);
            let read = move |name: String| match name.as_str() {
                MATERIALS => Ok(SceneName::Materials),
                name => parse(name).map(SceneName::Named),
            };
            arg.value_parser(PossibleValuesParser::new(names).try_map(read))
        }
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
        let scene = matches.get_one::<SceneName>(SCENE);
        let choices = Choices::of(|parameter| match scene {
            _ if parameter.name != SCENE => matches.get_one::<Value>(parameter.name).cloned(),
            Some(SceneName::Named(value)) => Some(value.clone()),
            Some(SceneName::Materials) | None => None,
        });
        Ok(Self { choices, is_materials: matches!(scene, Some(SceneName::Materials)) })
    }

    fn update_from_arg_matches(&mut self, matches: &ArgMatches) -> Result<(), Error> {
        *self = Self::from_arg_matches(matches)?;
        Ok(())
    }
}

/// Renders a picture and writes it. Prints the adapter, materials outside the table, and the errors of modes that
/// compare to standard error, or as JSON to standard output.
pub(super) fn run(args: &PreviewArgs, context: &mut Context<'_>) -> Result<Exit, CommandFailure> {
    if args.scene.is_materials {
        return materials::run(args, context);
    }
    let out = OutputFile::check(&args.out)?;
    let mut scene = args.scene.choices.clone().into_scene();
    if let Some(path) = &args.light_texture {
        scene.picture = ScenePicture::Image(Arc::new(read_picture(path)?));
    }
    let read = args.table.as_deref().map(|name| AnyTable::named(name, &args.folder)).transpose()?;
    if read.is_none() && scene.needs_table() {
        return Err(usage(LightError::NeedsTable(LightModel::Ltc)));
    }
    let digest = read.as_ref().map(|any| any.digest);
    let table = read.map(|any| if args.ggx_terms { any.with_ggx_terms() } else { Ok(any) }).transpose()?;
    let table = table.map(|any| any.table);
    if let Some(table) = table.as_ref().filter(|table| !table.layout().is_even(table.axes())) {
        let message = format!(
            "the preview's shader searches for no nodes, and those of the table's recipe are not evenly spaced as layout {} has them",
            table.layout()
        );
        return Err(usage(message));
    }
    let shader_table = match (&table, &digest) {
        (Some(table), Some(digest)) => ShaderTable::new(table, args.precision).labelled(&digest.hex()),
        _ => ShaderTable::none(),
    };
    let shader_table = Arc::new(shader_table);
    let rendered =
        Preview::new(args.adapter).render(&shader_table, &scene, &|| false).map_err(|error| failure(&error))?;
    let png = rendered.picture.png().map_err(failed)?;
    out.write(&png)?;
    let Rendered { picture, adapter, errors, out_of_range } = rendered;
    let errors_json: Vec<_> = errors
        .iter()
        .map(|error| {
            json!({
                "model": error.model, "alpha_x": error.alpha_x, "alpha_y": error.alpha_y,
                "mean_absolute_error": error.mean_absolute, "mean_radiance": error.mean_radiance,
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
        // Materials are in any order.
        let [least, most, least_ratio, most_ratio] = table.shader_axes().roughness;
        eprintln!(
            "alpha {alpha_x} {alpha_y} lies outside the table, which covers alpha {least} to {most} and ratio \
             {least_ratio} to {most_ratio}; its nearest entry is shown"
        );
    }
    for error in &errors {
        let (alpha_x, alpha_y) = (error.alpha_x, error.alpha_y);
        let (apart, radiance) = (error.mean_absolute, error.mean_radiance);
        let model = error.model;
        eprintln!("{model}, alpha {alpha_x} {alpha_y}: mean absolute error {apart:.5} of mean radiance {radiance:.5}");
    }
    Ok(Exit::Ok)
}

fn failure(error: &PreviewError) -> CommandFailure {
    let exit = match error {
        PreviewError::Scene(..) | PreviewError::Table(_) | PreviewError::CpuOnly(_) => Exit::Usage,
        PreviewError::NoBrdfFile(_) | PreviewError::NoAdapter(_) | PreviewError::Gpu(_) | PreviewError::Stopped => {
            Exit::Failed
        }
    };
    CommandFailure::new(exit, error.to_string())
}
