//! Programs that find the constants of the sources anew, print rows of the documents and draw their figures: see studies/README.md.

use std::{
    env,
    error::Error,
    fs,
    path::{Path, PathBuf},
    process::{Command, ExitCode},
};

use clap::{Parser, Subcommand};
use ltcforge::{
    LightModel, Preset,
    light::NormalsRule,
    view::preview::{Adapter, Preview},
};
use ltcforge_driver::FAMILY_VARIABLE;
use ltcforge_studies::{
    albedo, arcs, below, best, costs, expected,
    figures::Figure,
    glass, gpu_costs, gpu_times, l3, light_errors, materials, minimax, models,
    networks::{self, Asked, Numbers},
    prefilter, tabulated, textured,
};

#[derive(Parser)]
#[command(about = "Finds constants of the sources anew, prints rows of the documents and draws their figures")]
struct Arguments {
    #[command(subcommand)]
    study: Study,
}

#[derive(Subcommand)]
enum Study {
    /// The numbers of a rule of model `normals`: src/light/normals/numbers.rs and `shaders/normals_RULE.wgsl`
    Networks {
        /// The rule: fast, balanced or fine
        #[arg(value_parser = rule)]
        rule: NormalsRule,
        /// Lights of the search, and as many that it does not see
        #[arg(long, default_value_t = 240_000)]
        lights: usize,
        /// How often each light is seen
        #[arg(long, default_value_t = 150)]
        rounds: usize,
        /// How many networks are tried
        #[arg(long, default_value_t = 4)]
        starts: u64,
        /// Seed of the lights
        #[arg(long, default_value_t = 1)]
        seed: u64,
        /// Print the numbers that stand, and search for none
        #[arg(long)]
        standing: bool,
    },
    /// How far the arcs of an edge lie outside of its chord: `BULGE` of `src/light/normals/arcs.rs`
    Arcs {
        /// Lights of each kind of the search, and as many that it does not see
        #[arg(long, default_value_t = 1500)]
        lights: usize,
        /// Seed of the lights
        #[arg(long, default_value_t = 1)]
        seed: u64,
    },
    /// The expected errors of tables: numbers of src/fit/expectation.rs and of the layouts
    Expected,
    /// The seconds of fits: constants of src/fit/cost.rs, metrics and solvers
    Costs,
    /// The tables of docs/normals.md and docs/light.md: model `normals` over random lights
    Models,
    /// How far a table's light is off, or that of closed forms: docs/accuracy.md, gaussians.md and recipe.md
    Errors {
        /// A table's file, as `ltcforge fit` writes it
        table: Option<PathBuf>,
        /// The model whose closed forms are measured by the same lights
        #[arg(long, value_parser = model, default_value = "ltc")]
        model: LightModel,
        /// Random lights
        #[arg(long, default_value_t = 2000)]
        lights: usize,
    },
    /// How far the light of engines is off: rows of docs/tradeoff.md and README.md
    Engines,
    /// The table of README.md: tables beside the best LTCs
    Best {
        /// A table as KT et al. published theirs, .npy
        #[arg(long)]
        published: Option<PathBuf>,
        /// The table of docs/layouts.md: isotropic tables of engines
        #[arg(long)]
        isotropic: bool,
        /// The textures that engines ship, .dds: matrices and terms
        #[arg(long, num_args = 2, requires = "isotropic")]
        shipped: Option<Vec<PathBuf>>,
    },
    /// The table of studies/isotropic.md: isotropic tables by the L3 distance
    L3 {
        /// The textures that engines ship, .dds: matrices and terms
        #[arg(long, num_args = 2)]
        shipped: Option<Vec<PathBuf>>,
    },
    /// What GGX loses by shadowing: `LOSS` of `src/light/albedo.rs` and the numbers of `shaders/ltc_albedo.wgsl`
    Albedo,
    /// The tables of docs/extremes.md and docs/lights.md: light from below the surface, and a cut there
    Below,
    /// The polynomials of the shaders: `ltc_light.wgsl`, `ltc_quadrant.wgsl` and `normals_arcs*.wgsl`
    Polynomials,
    /// The parts of the levels of a picture on a light: `OWN_PARTS` of `src/light/textured/pyramid.rs`, and the table of
    /// docs/textured.md
    Prefilter,
    /// What the texts cost a GPU: `src/shaders/gpu_cost.rs`. Needs Mesa's RADV, no GPU
    GpuCosts {
        /// The GPU that is taken for there
        #[arg(long, default_value = "navi21")]
        family: String,
    },
    /// What the texts take on the GPU that is there
    GpuTimes,
    /// The tables of docs/textured.md: lights with a picture
    Textured {
        /// Lights of a row
        #[arg(long, default_value_t = 900)]
        lights: usize,
        /// Draw the scenes of docs/textured.md into this file in place of the table
        #[arg(long, value_name = "FILE.png")]
        scenes: Option<PathBuf>,
        /// Print the table of lights with a profile in place of that of pictures
        #[arg(long, conflicts_with = "scenes")]
        profiles: bool,
    },
    /// The tables of docs/refraction.md: light through rough interfaces
    Glass,
    /// The table of docs/tabulated.md: what it costs to have a BRDF as numbers
    Tabulated,
    /// Nine materials in truth, by a table and by model `normals`: docs/materials.png, and the errors
    Materials {
        /// The picture
        #[arg(short, long, value_name = "FILE.png", default_value = "docs/materials.png")]
        out: PathBuf,
    },
    /// Draw the figures of studies/figures.md, isotropic.md, gaussians.md and docs/refraction.md
    Figures {
        /// Only this one, once or several times [default: all]
        #[arg(value_name = "NAME", value_parser = figure)]
        names: Vec<Figure>,
        /// The renderer of the spheres: any, gpu or cpu
        #[arg(long, value_parser = adapter, default_value = "any", env = "LTCFORGE_ADAPTER")]
        adapter: Adapter,
        /// Folder that the figures go to
        #[arg(short, long, value_name = "DIR", default_value = "studies/figures")]
        out: PathBuf,
    },
}

fn figure(name: &str) -> Result<Figure, String> {
    Figure::from_name(name).ok_or_else(|| format!("a figure is {}", names(Figure::ALL)))
}

fn adapter(name: &str) -> Result<Adapter, String> {
    Adapter::from_name(name).ok_or_else(|| format!("a renderer is {}", names(Adapter::ALL)))
}

fn model(name: &str) -> Result<LightModel, String> {
    LightModel::from_name(name).ok_or_else(|| format!("a model is {}", names(LightModel::ALL)))
}

fn names<T: ToString>(all: &[T]) -> String {
    all.iter().map(T::to_string).collect::<Vec<_>>().join(", ")
}

fn rule(name: &str) -> Result<NormalsRule, String> {
    let rule = NormalsRule::SHADED.into_iter().find(|rule| rule.name() == name);
    rule.ok_or_else(|| format!("a rule with numbers is {}", names(&NormalsRule::SHADED)))
}

fn main() -> ExitCode {
    match run(Arguments::parse().study) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("{error}");
            ExitCode::FAILURE
        }
    }
}

fn run(study: Study) -> Result<(), Box<dyn Error>> {
    match study {
        Study::Expected => expected::tell(|line| println!("{line}"))?,
        Study::Costs => print!("{}", costs::text(&costs::Efforts::WHOLE)?),
        Study::Models => print!("{}", models::tables(1.0)?),
        Study::Errors { table, model, lights } => print!("{}", light_errors::rows(table.as_deref(), model, lights)?),
        Study::Engines => print!("{}", light_errors::engines(Preset::Paper)?),
        Study::Albedo => print!("{}", albedo::told(albedo::PLACES)),
        Study::Prefilter => print!("{}", prefilter::told(prefilter::POINTS)),
        Study::Below => print!("{}", below::tables(1.0)?),
        Study::Best { isotropic: true, shipped, .. } => print!("{}", best::isotropic(pair(shipped.as_deref()))?),
        Study::Best { published, .. } => print!("{}", best::presets(published.as_deref())?),
        Study::L3 { shipped } => print!("{}", l3::tables(pair(shipped.as_deref()))?),
        Study::Tabulated => print!("{}", tabulated::find(Preset::Paper, 1.0)?.text()),
        Study::Textured { scenes: Some(path), .. } => textured::scenes::write(&path)?,
        Study::Textured { lights, profiles: true, .. } => print!("{}", textured::profiles(lights)),
        Study::Textured { lights, .. } => print!("{}", textured::tables(lights)?),
        Study::Glass => print!("{}\n{}", glass::errors(), glass::differences()),
        Study::Arcs { lights, seed } => {
            let arcs::Found { bulge: [least, more], seen, held_out } = arcs::find(lights, seed);
            println!("found: {least:.1} + {more:.1} |l|^2");
            println!("mean error of V     standing     found");
            for (name, [standing, found]) in [("seen", seen), ("held out", held_out)] {
                println!("{name:16}  {standing:.3e}  {found:.3e}");
            }
        }
        Study::GpuCosts { family } => {
            // RADV reads the variable when it is loaded, so it is set for a process of its own.
            if env::var_os(FAMILY_VARIABLE).is_none() {
                let mut again = Command::new(env::current_exe()?);
                let status = again.args(env::args_os().skip(1)).env(FAMILY_VARIABLE, family).status()?;
                return if status.success() { Ok(()) } else { Err("no figures".into()) };
            }
            print!("{}", gpu_costs::told()?);
        }
        Study::GpuTimes => print!("{}", gpu_times::told(&gpu_times::Effort::WHOLE)?),
        Study::Polynomials => {
            for (name, numbers, error) in minimax::told() {
                println!("{name}: {}; error {error:.1e}", numbers.join(" "));
            }
        }
        Study::Materials { out } => {
            let (png, errors) = materials::drawn()?;
            fs::write(out, png)?;
            print!("{errors}");
        }
        Study::Figures { names, adapter, out } => {
            let mut preview = Preview::new(adapter);
            for figure in Figure::ALL.iter().filter(|figure| names.is_empty() || names.contains(figure)) {
                println!("{}", figure.write(&mut preview, &out)?.display());
            }
        }
        Study::Networks { rule, standing: true, .. } => print_numbers(rule, &Numbers::from(rule.network())),
        Study::Networks { rule, lights, rounds, starts, seed, .. } => {
            let found = networks::find(&Asked { rule, lights, rounds, starts, seed });
            println!("mean error of energy and Schlick's part   standing  found");
            for (name, [standing, found]) in [("seen", found.seen), ("held out", found.held_out)] {
                println!("{name:40}  {standing:.6}  {found:.6}");
            }
            let standing = Numbers::from(rule.network());
            let candidates = [("standing", &standing), ("found", &found.numbers)];
            println!("\n{}", networks::by_kind(rule, seed + 1, lights.min(60_000), &candidates));
            print_numbers(rule, &found.numbers);
        }
    }
    Ok(())
}

fn pair(paths: Option<&[PathBuf]>) -> Option<[&Path; 2]> {
    match paths? {
        [matrices, terms] => Some([matrices, terms]),
        _ => None,
    }
}

fn print_numbers(rule: NormalsRule, numbers: &Numbers) {
    println!("{}\n{}", numbers.as_rust(rule), numbers.as_wgsl(rule));
}
