//! Programs that find constants of the sources, print tables of the docs and draw their figures. See studies/README.md.

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
    formula, glass, gpu_costs, gpu_times, l3, light_errors, materials, minimax, models,
    networks::{self, Numbers, Options},
    paths, prefilter, tabulated, textured,
};

#[derive(Parser)]
#[command(about = "Find constants of the sources, print tables of the docs and draw their figures")]
struct Arguments {
    #[command(subcommand)]
    study: Study,
}

#[derive(Subcommand)]
enum Study {
    /// Find the network of a rule: src/light/normals/numbers.rs
    Networks {
        /// The rule: fast, balanced or fine
        #[arg(value_parser = rule)]
        rule: NormalsRule,
        /// Lights in the search. As many are held out
        #[arg(long, default_value_t = 96_000)]
        lights: usize,
        /// Rounds over all lights
        #[arg(long, default_value_t = 100)]
        rounds: usize,
        /// Number of networks to try
        #[arg(long, default_value_t = 4)]
        starts: u64,
        /// Seed of the lights
        #[arg(long, default_value_t = 1)]
        seed: u64,
        /// Start from the current numbers, with a shorter step
        #[arg(long)]
        refine: bool,
        /// Print the current numbers without a search
        #[arg(long)]
        current: bool,
    },
    /// Print the faults of model `normals` along paths
    Paths {
        /// Seed of the paths
        #[arg(long, default_value_t = 1)]
        seed: u64,
        /// Factor on the number of paths
        #[arg(long, default_value_t = 1.0)]
        scale: f64,
    },
    /// Find `BULGE` of src/light/normals/arcs.rs: arcs that replace edges
    Arcs {
        /// Lights per kind in the search. As many are held out
        #[arg(long, default_value_t = 1500)]
        lights: usize,
        /// Seed of the lights
        #[arg(long, default_value_t = 1)]
        seed: u64,
    },
    /// Find the coefficients of model `ltc-formula`: src/light/ltc/formula
    Formula {
        /// Lights per kind in the search. As many are held out
        #[arg(long, default_value_t = 2000)]
        lights: usize,
        /// Steps of the search
        #[arg(long, default_value_t = 30)]
        steps: usize,
        /// Seed of the lights
        #[arg(long, default_value_t = 1)]
        seed: u64,
        /// Print the errors of the current numbers without a search
        #[arg(long)]
        current: bool,
    },
    /// Find the constants that predict errors: src/fit/expectation.rs
    Expected,
    /// Find the constants that predict fit times: src/fit/cost.rs
    Costs,
    /// Print errors of model `normals`: docs/normals.md, docs/lights.md
    Models,
    /// Print errors of tables or closed forms: docs/accuracy.md
    Errors {
        /// A table file from `ltcforge fit`
        table: Option<PathBuf>,
        /// The model whose closed forms are measured
        #[arg(long, value_parser = model, default_value = "ltc")]
        model: LightModel,
        /// Number of random lights
        #[arg(long, default_value_t = 2000)]
        lights: usize,
    },
    /// Print errors of the methods of engines: docs/tradeoff.md
    Engines,
    /// Print tables compared with the best LTCs: README.md
    Best {
        /// A table in the published form of KT et al., .npy
        #[arg(long)]
        published: Option<PathBuf>,
        /// Print isotropic tables of engines instead: docs/layouts.md
        #[arg(long)]
        isotropic: bool,
        /// The textures that engines ship, .dds: matrices and terms
        #[arg(long, num_args = 2, requires = "isotropic")]
        shipped: Option<Vec<PathBuf>>,
    },
    /// Print L3 distances of isotropic tables: studies/isotropic.md
    L3 {
        /// The textures that engines ship, .dds: matrices and terms
        #[arg(long, num_args = 2)]
        shipped: Option<Vec<PathBuf>>,
    },
    /// Find `LOSS` of src/light/albedo.rs: light that GGX loses
    Albedo,
    /// Print light from below the surface: docs/accuracy.md, lights.md
    Below,
    /// Find the polynomials of the shaders
    Polynomials,
    /// Find `OWN_PARTS` of src/light/textured/pyramid.rs
    Prefilter,
    /// Print GPU costs of shaders. Needs Mesa's RADV, but no GPU
    GpuCosts {
        /// The GPU to compile for
        #[arg(long, default_value = "navi21")]
        family: String,
    },
    /// Print the times of shaders on the GPU of this machine
    GpuTimes,
    /// Print errors of lights with a picture: docs/textured.md
    Textured {
        /// Lights per row
        #[arg(long, default_value_t = 900)]
        lights: usize,
        /// Draw the scenes of docs/textured.md into this file instead
        #[arg(long, value_name = "FILE.png")]
        scenes: Option<PathBuf>,
        /// Print errors of lights with a profile instead
        #[arg(long, conflicts_with = "scenes")]
        profiles: bool,
    },
    /// Print errors of light through rough glass: docs/refraction.md
    Glass,
    /// Print errors of a BRDF given as numbers: docs/materials.md
    Tabulated,
    /// Draw nine materials and print their errors: docs/materials.png
    Materials {
        /// The picture
        #[arg(short, long, value_name = "FILE.png", default_value = "docs/materials.png")]
        out: PathBuf,
    },
    /// Draw the figures of the studies and of docs/refraction.md
    Figures {
        /// Names of figures [default: all]
        #[arg(value_name = "NAME", value_parser = figure)]
        names: Vec<Figure>,
        /// Renderer of the spheres: any, gpu or cpu
        #[arg(long, value_parser = adapter, default_value = "any", env = "LTCFORGE_ADAPTER")]
        adapter: Adapter,
        /// Folder of the figures
        #[arg(short, long, value_name = "DIR", default_value = "studies/figures")]
        out: PathBuf,
    },
}

fn figure(name: &str) -> Result<Figure, String> {
    Figure::from_name(name).ok_or_else(|| format!("the figures are {}", names(Figure::ALL)))
}

fn adapter(name: &str) -> Result<Adapter, String> {
    Adapter::from_name(name).ok_or_else(|| format!("the renderers are {}", names(Adapter::ALL)))
}

fn model(name: &str) -> Result<LightModel, String> {
    LightModel::from_name(name).ok_or_else(|| format!("the models are {}", names(LightModel::ALL)))
}

fn names<T: ToString>(all: &[T]) -> String {
    all.iter().map(T::to_string).collect::<Vec<_>>().join(", ")
}

fn rule(name: &str) -> Result<NormalsRule, String> {
    let rule = NormalsRule::SHADED.into_iter().find(|rule| rule.name() == name);
    rule.ok_or_else(|| format!("the rules with numbers are {}", names(&NormalsRule::SHADED)))
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
        Study::Expected => expected::lines(|line| println!("{line}"))?,
        Study::Costs => print!("{}", costs::text(&costs::Efforts::WHOLE)?),
        Study::Models => print!("{}", models::tables(1.0)?),
        Study::Errors { table, model, lights } => print!("{}", light_errors::rows(table.as_deref(), model, lights)?),
        Study::Engines => print!("{}", light_errors::engines(Preset::Paper)?),
        Study::Albedo => print!("{}", albedo::text(albedo::PLACES)),
        Study::Prefilter => print!("{}", prefilter::text(prefilter::POINTS)),
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
            let arcs::Found { bulge: [least, more], training, held_out } = arcs::find(lights, seed);
            println!("found: {least:.1} + {more:.1} |l|^2");
            println!("mean error of V     current      found");
            for (name, [current, found]) in [("training", training), ("held out", held_out)] {
                println!("{name:16}  {current:.3e}  {found:.3e}");
            }
        }
        Study::Paths { seed, scale } => print!("{}", paths::table(seed, scale)),
        Study::Formula { current: true, .. } => {
            print!("{}", formula::by_kind(1, 4000, &[("current", &formula::COEFFICIENTS)]));
        }
        Study::Formula { lights, steps, seed, .. } => {
            let found = formula::find(&formula::Options { lights, steps, seed });
            println!("objective        current      found");
            for (name, [current, found]) in [("training", found.training), ("held out", found.held_out)] {
                println!("{name:16}  {current:.6}  {found:.6}");
            }
            let candidates = [("current", &formula::COEFFICIENTS), ("found", &found.numbers)];
            println!("\n{}", formula::by_kind(1, 4000, &candidates));
            println!("{}\n{}", formula::as_rust(&found.numbers), formula::as_wgsl(&found.numbers));
        }
        Study::GpuCosts { family } => {
            // RADV reads the variable when it is loaded. Therefore the program restarts itself with the variable set.
            if env::var_os(FAMILY_VARIABLE).is_none() {
                let mut again = Command::new(env::current_exe()?);
                let status = again.args(env::args_os().skip(1)).env(FAMILY_VARIABLE, family).status()?;
                return if status.success() { Ok(()) } else { Err("no figures".into()) };
            }
            print!("{}", gpu_costs::text()?);
        }
        Study::GpuTimes => print!("{}", gpu_times::text(&gpu_times::Effort::WHOLE)?),
        Study::Polynomials => {
            for (name, numbers, error) in minimax::rows() {
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
        Study::Networks { rule, current: true, .. } => print_numbers(rule, &Numbers::from(rule.network())),
        Study::Networks { rule, lights, rounds, starts, seed, refine, .. } => {
            let found = networks::find(&Options { rule, lights, rounds, starts, seed, refine });
            println!("mean error of energy and Schlick's part   current   found");
            for (name, [current, found]) in [("training", found.training), ("held out", found.held_out)] {
                println!("{name:40}  {current:.6}  {found:.6}");
            }
            let current = Numbers::from(rule.network());
            let candidates = [("current", &current), ("found", &found.numbers)];
            println!("\n{}", networks::by_kind(rule, seed + 1, lights.min(60_000), &candidates));
            let faults = |(name, numbers): (&str, &Numbers)| {
                paths::row(name, paths::measure(seed + 1, 1.0, |lit| numbers.reflected(rule, lit)))
            };
            println!("{}{}", paths::HEAD, candidates.map(faults).concat());
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
