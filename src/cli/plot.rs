//! `plot`: a table, or a model's light, as a picture.

use serde_json::json;

use super::{
    CommandFailure, Context, Exit,
    args::{PlotArgs, PlotName},
    input::AnyTable,
    output::OutputFile,
    print, shown, tabulated,
};
use ltcforge_fit::BrdfKind;
use ltcforge_light::NormalsRule;
use ltcforge_view::{
    picture::Picture,
    plots::{ErrorSlice, GlassError, IsotropicFigure, NamedTable, Plot, frosted_glass, gaussian_plots, light_errors},
};

/// Random lights in each cell of the map of light errors, and for each point of a curve.
const LIGHTS: u32 = 24;
const CURVE_LIGHTS: u32 = 150;
/// Pixels a side of each panel of glass, and visible normals a pixel of its reference.
const GLASS_SIDE: u32 = 192;
const GLASS_SAMPLES: u32 = 610;

/// Draws and writes the picture.
pub(super) fn run(args: &PlotArgs, json: bool, context: &mut Context<'_>) -> Result<Exit, CommandFailure> {
    check_options(args)?;
    let out = OutputFile::check(&args.out)?;
    let read = args.table.as_deref().map(|name| AnyTable::named(name, &args.folder)).transpose()?;
    let pool = args.threads.pool()?;
    let Drawn { picture, surfaces } = pool.install(|| draw(args, read.as_ref()))?;
    let png = picture.png().map_err(|error| CommandFailure::new(Exit::Failed, error.to_string()))?;
    out.write(&png)?;
    for GlassError { alpha_x, alpha_y, mean_radiance, mean_absolute_error } in &surfaces {
        eprintln!("alpha {alpha_x} {alpha_y}: mean absolute error {mean_absolute_error:.5} of {mean_radiance:.5}");
    }
    let mut value = json!({
        "file": shown(&args.out), "table": read.map(|any| any.digest), "width": picture.width, "height": picture.height,
    });
    if args.name == PlotName::Glass {
        value["errors"] = json!(surfaces);
    }
    print(context.stdout, json, &value, &shown(&args.out))?;
    Ok(Exit::Ok)
}

/// A picture, and the figures of plot glass.
struct Drawn {
    picture: Picture,
    surfaces: Vec<GlassError>,
}

/// Domain: a table, if the plot needs one.
fn draw(args: &PlotArgs, read: Option<&AnyTable>) -> Result<Drawn, CommandFailure> {
    let digest = read.map(|any| any.digest.hex()).unwrap_or_default();
    let of_table = |plot: Plot| {
        let missing = || CommandFailure::new(Exit::Usage, "this picture is of a table: name one");
        Ok::<_, CommandFailure>(plot.draw(&read.ok_or_else(missing)?.table, &digest))
    };
    let picture = match args.name {
        PlotName::Error => {
            if let Some(any) = read {
                tabulated::check_complete(&any.table, &any.path)?;
            }
            of_table(Plot::Error(ErrorSlice::new(args.ratio, args.phi)))?
        }
        PlotName::Matrix => of_table(Plot::Matrix)?,
        PlotName::Light => {
            if let Some(any) = read {
                tabulated::check_complete(&any.table, &any.path)?;
                if args.rule.is_some() && any.table.brdf != BrdfKind::Ggx {
                    let message = format!(
                        "{}: --rule is of model normals, which is of brdf ggx and not drawn beside brdf {}: leave it out",
                        any.path.display(),
                        any.table.brdf()
                    );
                    return Err(CommandFailure::new(Exit::Usage, message));
                }
            }
            let named =
                read.map(|AnyTable { table, origin, .. }| NamedTable { table, digest: &digest, range: origin.range() });
            light_errors(named, args.rule.unwrap_or(NormalsRule::ALL[0]), args.lights.unwrap_or(LIGHTS) as usize)
                .map_err(|error| CommandFailure::new(Exit::Failed, error.to_string()))?
        }
        PlotName::Gaussians => gaussian_plots(args.lights.unwrap_or(CURVE_LIGHTS) as usize)
            .map_err(|error| CommandFailure::new(Exit::Failed, error.to_string()))?,
        PlotName::Isotropic => args.figure.unwrap_or(IsotropicFigure::ALL[0]).draw(),
        PlotName::Glass => {
            let drawn = frosted_glass(GLASS_SIDE, args.spp.unwrap_or(GLASS_SAMPLES) as usize);
            return Ok(Drawn { picture: drawn.picture, surfaces: drawn.surfaces });
        }
    };
    Ok(Drawn { picture, surfaces: Vec::new() })
}

/// Refuses options that a picture does not depend on.
fn check_options(args: &PlotArgs) -> Result<(), CommandFailure> {
    let refused = |what: &str| Err(CommandFailure::new(Exit::Usage, what));
    let slices = args.ratio.is_some() || args.phi.is_some();
    if slices && args.name != PlotName::Error {
        return refused("--ratio and --phi belong to error, which shows a slice; the other pictures show all of them");
    }
    match (args.name, &args.table) {
        (PlotName::Glass, Some(_)) => refused("glass shows no table; leave it out"),
        (PlotName::Gaussians, Some(_)) => refused("gaussians shows no table; leave it out"),
        (PlotName::Isotropic, Some(_)) => refused("isotropic shows no table; leave it out"),
        (PlotName::Error | PlotName::Matrix, None) => refused("this picture is of a table: name one before it"),
        _ if args.rule.is_some() && args.name != PlotName::Light => {
            refused("--rule belongs to light, the errors of models")
        }
        _ if args.lights.is_some() && !matches!(args.name, PlotName::Light | PlotName::Gaussians) => {
            refused("--lights belongs to light and gaussians, the errors of models")
        }
        _ if args.figure.is_some() && args.name != PlotName::Isotropic => refused("--figure belongs to isotropic"),
        _ if args.spp.is_some() && args.name != PlotName::Glass => refused("--spp belongs to glass, which is sampled"),
        _ => Ok(()),
    }
}
