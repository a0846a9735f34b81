//! `preview`, `plot` and `shader`: pictures of tables, and the shaders that read them.

use std::{path::PathBuf, sync::LazyLock};

use clap::{
    Arg, ArgMatches, Args, Command, Error, FromArgMatches, ValueEnum,
    builder::{PossibleValuesParser, TypedValueParser},
};

use super::{TableChoice, TableFolder, Threads, named::named};
use ltcforge_fit::Layout;
use ltcforge_light::{LightModel, NormalsRule, textured::Readings};
use ltcforge_shaders::{Language, Lights, Prefix};
use ltcforge_view::{
    plots::{Azimuth, Ratio},
    preview::{Adapter, Choices, PARAMETERS, Parameter, ParameterForm, TexelFormat, Value},
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

/// `plot`.
#[derive(Debug, Args)]
pub struct PlotArgs {
    /// The table
    #[command(flatten)]
    pub table: TableChoice,
    /// The plot
    #[arg(value_enum)]
    pub name: PlotName,
    /// The picture
    #[arg(short, long, value_name = "FILE.png")]
    pub out: PathBuf,
    /// Smaller over larger roughness at which errors are shown, moved into the table's range [default: 0.25]
    #[arg(long, value_name = "X")]
    pub ratio: Option<Ratio>,
    /// Azimuth of the view direction at which errors are shown, radians, likewise [default: 0.7]
    #[arg(long, value_name = "ANGLE", allow_negative_numbers = true)]
    pub phi: Option<Azimuth>,
    /// How many threads measure
    #[command(flatten)]
    pub threads: Threads,
}

/// The plots.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum PlotName {
    /// Errors over theta and alpha at one ratio and phi
    Error,
    /// Every number of every entry
    Matrix,
}

/// `shader`.
#[derive(Debug, Args)]
#[expect(clippy::struct_excessive_bools, reason = "a flag each")]
pub struct ShaderArgs {
    /// Language to write
    #[arg(long, value_parser = named(Language::ALL, Language::name))]
    pub language: Language,
    /// The model of light
    #[arg(long, value_parser = named(LightModel::ALL, LightModel::name), default_value = "ltc")]
    pub model: LightModel,
    /// The rule of model normals, each a text of its own [default: balanced]
    #[arg(long, value_parser = named(&NormalsRule::SHADED, NormalsRule::name))]
    pub rule: Option<NormalsRule>,
    /// Functions to include in your own shader, or a program that calls them
    #[arg(long = "as", value_enum, default_value = "include")]
    pub form: ShaderForm,
    /// Let the sampler interpolate a table's entries, in a text to include: fewer fetches, less exact
    #[arg(long)]
    pub hardware_filter: bool,
    /// Read the table from one 2D array in place of three 3D textures, in a text to include: one sampler
    #[arg(long)]
    pub texture_array: bool,
    /// Read the second lobe too, in a text to include: of tables whose recipes have field `fresnel` of `two_lobes` or
    /// `blended_lobes`
    #[arg(long)]
    pub two_lobes: bool,
    /// Lights that a text of model ltc to include has functions for: all, or polygons alone, which is two fifths
    /// shorter [default: all]
    #[arg(long, value_parser = named(Lights::ALL, Lights::name))]
    pub lights: Option<Lights>,
    /// Functions to add to a text to include
    #[command(flatten)]
    pub additions: AdditionArgs,
    /// Beginning of all names in a text to include, in place of ltc, normals or gaussians, for two tables in one shader
    #[arg(long, value_name = "NAME")]
    pub prefix: Option<Prefix>,
    /// Number of the first binding, in a text to include that reads a table and binds it by number [default: 0]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(..=1000))]
    pub first_binding: Option<u16>,
    /// Group of the bindings in WGSL, set in Vulkan's GLSL, space in HLSL, in a text to include that reads a table
    /// [default: 0]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(..=31))]
    pub group: Option<u16>,
    /// Layout of the tables that the shader reads: of LTCs for model ltc, of Gaussians for sg and asg, which have
    /// closed forms without it; a table's recipe names it
    #[arg(long, value_parser = named(Layout::ALL, Layout::name))]
    pub layout: Option<Layout>,
    /// Put this table of isotropic surfaces into the code as polynomials: the shader reads no texture
    #[arg(long, value_name = "TABLE", conflicts_with_all = ["layout", "hardware_filter", "texture_array", "two_lobes", "first_binding", "group"])]
    pub without_textures: Option<PathBuf>,
    /// Read this table of LTCs alone, whose recipe gives nodes one by one: they stand in the text, which searches for
    /// them
    #[arg(long, value_name = "TABLE", conflicts_with_all = ["layout", "without_textures"])]
    pub nodes: Option<PathBuf>,
    /// The folder of tables
    #[command(flatten)]
    pub folder: TableFolder,
    /// How many threads measure that table, and its polynomials
    #[command(flatten)]
    pub threads: Threads,
    /// Write the text as a module of JavaScript, -o NAME.js or NAME.mjs, and its types beside it, NAME.d.ts or NAME.d.mts
    #[arg(long)]
    pub es_module: bool,
    /// The file [default: standard output]
    #[arg(short, long, value_name = "FILE")]
    pub out: Option<PathBuf>,
}

/// Options that add functions to a text to include.
#[derive(Debug, Clone, Copy, Args)]
pub struct AdditionArgs {
    /// Add functions, in a text of model ltc to include, by which nothing shines through from below the surface
    #[arg(long)]
    pub cut: bool,
    /// Add the factor, in a text to include, by which facets of metals lose no light to each other
    #[arg(long)]
    pub compensate: bool,
    /// Add rectangles with pictures, in a text of model normals or ltc to include, and read a picture so often for a light:
    /// 4, 1, 2 or 6
    #[arg(long, value_name = "READINGS", value_parser = named(Readings::ALL, Readings::name), conflicts_with = "without_textures")]
    pub textured: Option<Readings>,
}

/// The form of a shader.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum ShaderForm {
    /// Functions and their bindings
    Include,
    /// A compute shader that calls them
    Example,
    /// Functions that combine a coat and fuzz with what lies below them, for any model
    Layers,
    /// Functions that prefilter a picture on a light, pass by pass
    Prefilter,
}
