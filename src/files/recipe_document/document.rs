//! The fields of a recipe document: their defaults, their bounds, and the rules that connect them.

use std::ops::RangeInclusive;

use serde_json::Value;

use super::{
    axes::{AXES, DOMAIN, ISOTROPIC, ends_of, read_nodes, read_resolution},
    fault::Fault,
    fresnel::{check_second, read_fresnel},
    materials::{check_thetas, read_materials},
    preset::Preset,
    reader::{Faults, Object, echo, listed},
    terms::read_terms,
};
use crate::tabulated::FindBrdf;
use ltcforge_fit::{
    BrdfKind, BrdfModel, FITTER_VERSION, FitSettings, GivenNodes, Layout, LobeModel, Metric, PerAxis, Precision,
    Recipe, Shear, Simplex, Solver, Start, StoredTerms, TabulatedAxes,
};

/// Maximum number of entries of a table, unless the caller sets another limit.
pub const DEFAULT_ENTRY_LIMIT: u64 = 2_000_000;

const FIELDS: [&str; 15] = [
    "preset",
    "table",
    "fitter",
    "brdf",
    "tabulated",
    "fresnel",
    "lobe",
    "layout",
    "resolution",
    "range",
    "nodes",
    "materials",
    "fit",
    "terms",
    "precision",
];
const FIT_FIELDS: [&str; 8] = ["metric", "solver", "samples", "directions", "steps", "seed", "shear", "start"];

/// Bounds of the number of samples. Fewer samples do not determine a lobe's width. The metric's histograms cannot count
/// more samples.
pub(super) const SAMPLES: [u32; 2] = [32, 65_536];
/// Bounds of the number of directions: seven free numbers need several directions.
pub(super) const DIRECTIONS: [u32; 2] = [4, 1024];
/// Bounds of the number of steps.
pub(super) const STEPS: [u32; 2] = [1, 100_000];
/// The largest seed: whole numbers up to here are exact in every JSON reader.
pub(super) const MOST_SEED: u64 = (1 << 53) - 1;

/// Tolerance of a range that a document repeats in decimals and a file stores in f32.
const FILE_TOLERANCE: f64 = 1e-6;

/// Reads a document into a complete recipe.
pub(super) fn read(
    document: &Value,
    entry_limit: u64,
    fitters: RangeInclusive<u32>,
    find: &FindBrdf<'_>,
) -> Result<Recipe, Vec<Fault>> {
    let mut faults = Faults::default();
    let root = Object::root(document, &FIELDS, &mut faults);
    let presets = Preset::ALL.map(|preset| (preset.name(), preset));
    let preset = root.choice("preset", &presets, Preset::Standard, &mut faults);
    let model = read_brdf(&root, find, &mut faults);
    let fresnel = read_fresnel(&root, model.kind(), &mut faults);
    let model = model.with_fresnel(fresnel);
    let brdf = model.kind();
    let lobe = root.choice("lobe", &named(LobeModel::ALL, LobeModel::name), LobeModel::ALL[0], &mut faults);
    let layout = read_layout(&root, &model, lobe, &mut faults);
    let precision = root.choice("precision", &named(Precision::ALL, Precision::name), Precision::ALL[0], &mut faults);
    let terms = read_terms(&root, brdf, lobe, &mut faults);
    let fitter = read_fitter(&root, fitters, &mut faults);
    let fit = read_fit(&root, preset, &mut faults);
    check_lobe(&root, lobe, &fit, terms, &mut faults);
    check_second(&root, model.fresnel(), lobe, terms.any(), &mut faults);
    let mut given = read_nodes(&root, layout, &mut faults);
    let materials = read_materials(&root, layout, brdf, &mut faults);
    if !materials.is_empty() {
        given = given.with_materials(&materials);
    }
    let range = read_range(&root, &model, layout, &given, &mut faults);
    check_ratio(&model, &range, &fit, &mut faults);
    check_azimuth(&model, &range, &mut faults);
    let resolution = read_resolution(&root, layout, &range, &given, &mut faults);
    let recipe = Recipe { fitter, brdf: model, lobe, layout, resolution, range, fit, terms, precision, given };
    check_entries(&recipe, entry_limit, &mut faults);
    check_nodes(&recipe, &mut faults);
    check_thetas(&recipe, &mut faults);
    if faults.0.is_empty() { Ok(recipe) } else { Err(faults.0) }
}

/// The items of a list with their names.
pub(super) fn named<T: Copy>(items: &[T], name: fn(T) -> &'static str) -> Vec<(&'static str, T)> {
    items.iter().map(|item| (name(*item), *item)).collect()
}

/// Reads the version of the fitter, which a recipe may name. The recipe of a stored table may name an older fitter.
pub(super) fn read_fitter(root: &Object, allowed: RangeInclusive<u32>, faults: &mut Faults) -> u32 {
    let Some(value) = root.get("fitter") else { return FITTER_VERSION };
    let version = value.as_u64().and_then(|version| u32::try_from(version).ok());
    version.filter(|version| allowed.contains(version)).unwrap_or_else(|| {
        let detail = format!("{} is not this fitter's version, {FITTER_VERSION}", echo(value));
        faults.note(root.pointer("fitter"), detail);
        FITTER_VERSION
    })
}

fn read_fit(root: &Object, preset: Preset, faults: &mut Faults) -> FitSettings {
    let object = root.object("fit", &FIT_FIELDS, faults);
    let default = preset.fit();
    let metric = object.choice("metric", &named(Metric::ALL, Metric::name), default.metric, faults);
    let solver = object.choice("solver", &named(Solver::ALL, Solver::name), default.solver, faults);
    FitSettings {
        metric,
        solver,
        samples: object.integer32("samples", SAMPLES[0], SAMPLES[1], default.samples, faults),
        directions: object.integer32("directions", DIRECTIONS[0], DIRECTIONS[1], default.directions, faults),
        steps: object.integer32("steps", STEPS[0], STEPS[1], default.steps, faults),
        seed: object.integer("seed", 0, MOST_SEED, default.seed, faults),
        simplex: read_simplex(&object, solver, faults),
    }
}

/// Reads shear and start, which only a solver with a simplex has.
fn read_simplex(object: &Object, solver: Solver, faults: &mut Faults) -> Option<Simplex> {
    if solver.has_simplex() {
        return Some(Simplex {
            shear: object.choice("shear", &named(Shear::ALL, Shear::name), Shear::ALL[0], faults),
            start: object.choice("start", &named(Start::ALL, Start::name), Start::ALL[0], faults),
        });
    }
    for field in ["shear", "start"].into_iter().filter(|field| object.get(field).is_some()) {
        let others = listed(Solver::ALL, Solver::has_simplex);
        let detail = format!("solver \"{solver}\" has no {field}; leave it out, or set /fit/solver to {others}");
        faults.note(object.pointer(field), detail);
    }
    None
}

/// Rejects anisotropic surfaces for solvers of lobes that are symmetric in the plane of incidence.
fn check_ratio(model: &BrdfModel, range: &PerAxis<[f64; 2]>, fit: &FitSettings, faults: &mut Faults) {
    let solver = fit.solver;
    let others = || listed(Solver::ALL, |other| !other.is_isotropic());
    if solver.is_isotropic() && model.has_azimuths() {
        let detail = format!(
            "solver \"{solver}\" fits isotropic surfaces only, but the file of the tabulated BRDF has azimuths of the view, \
             phi_o: choose {}",
            others()
        );
        faults.note("/fit/solver", detail);
    } else if solver.is_isotropic() && range.ratio != ISOTROPIC.ratio {
        let [low, high] = range.ratio;
        let others = others();
        let detail = format!(
            "[{low}, {high}] has anisotropic surfaces, but solver \"{solver}\" fits isotropic surfaces only: set the range \
             to [1, 1], or /fit/solver to {others}"
        );
        faults.note("/range/ratio", detail);
    }
}

/// Rejects a single ratio 1 with a single azimuth for a BRDF with azimuths: such tables are read as isotropic, and
/// their lobes rotate with the view.
fn check_azimuth(model: &BrdfModel, range: &PerAxis<[f64; 2]>, faults: &mut Faults) {
    if model.has_azimuths() && range.ratio == ISOTROPIC.ratio && range.phi[0] == range.phi[1] {
        let detail = format!(
            "a table with ratio 1 and the single value {} is read as isotropic, but the file of the tabulated BRDF has \
             azimuths of the view, phi_o: give phi a range",
            range.phi[0]
        );
        faults.note("/range/phi", detail);
    }
}

/// Reads the scattering model. A tabulated model names its file; other models must not.
fn read_brdf(root: &Object, find: &FindBrdf<'_>, faults: &mut Faults) -> BrdfModel {
    let kind = root.choice("brdf", &named(BrdfKind::ALL, BrdfKind::name), BrdfKind::ALL[0], faults);
    let mut note = |detail: String| faults.note(root.pointer("tabulated"), detail);
    match (kind.needs_file(), root.get("tabulated")) {
        (false, None) => {}
        (false, Some(_)) => {
            let other = BrdfKind::Tabulated;
            note(format!("brdf \"{kind}\" needs no file: choose brdf \"{other}\", or leave this field out"));
        }
        (true, None) => note(format!("missing: brdf \"{kind}\" needs its file, a path or sha256:<64 hex digits>")),
        (true, Some(Value::String(name))) => match find(name) {
            Ok(file) => return BrdfModel::tabulated(file),
            Err(details) => details.into_iter().for_each(note),
        },
        (true, Some(other)) => note(format!("{} is neither a path nor a digest sha256:<64 hex digits>", echo(other))),
    }
    kind.into()
}

/// Reads the layout. The default is the first layout that supports the lobes of the scattering model.
fn read_layout(root: &Object, brdf: &BrdfModel, lobe: LobeModel, faults: &mut Faults) -> Layout {
    let takes = |layout: &Layout| layout.takes(brdf) && layout.stores(lobe);
    let default = Layout::ALL.iter().copied().find(takes).unwrap_or(Layout::ALL[0]);
    let layout = root.choice("layout", &named(Layout::ALL, Layout::name), default, faults);
    if takes(&layout) {
        return layout;
    }
    let others = listed(Layout::ALL, |layout| takes(&layout));
    let detail = if layout.takes(brdf) {
        format!("layout \"{layout}\" stores LTCs, not lobe \"{lobe}\"; layouts for this lobe: {others}")
    } else if layout.only_ranges().is_some() {
        format!(
            "layout \"{layout}\" is for isotropic surfaces, but the file of the tabulated BRDF has azimuths of the view, phi_o; \
             layouts for this file: {others}"
        )
    } else {
        format!(
            "layout \"{layout}\" stores lobes relative to the reflection, but lobes of brdf \"{brdf}\" do not follow it; layouts \
             for these lobes: {others}"
        )
    };
    faults.note(root.pointer("layout"), detail);
    default
}

/// Checks the requirements of a lobe model other than the default.
fn check_lobe(root: &Object, lobe: LobeModel, fit: &FitSettings, terms: StoredTerms, faults: &mut Faults) {
    let FitSettings { solver, metric, .. } = *fit;
    if lobe.gaussian().is_some() && !metric.compares_images() {
        let others = listed(Metric::ALL, Metric::compares_images);
        let detail = format!("metric \"{metric}\" compares LTCs, not lobe \"{lobe}\"; metrics for this lobe: {others}");
        faults.note("/fit/metric", detail);
    }
    if !solver.finds(lobe) {
        let others = listed(Solver::ALL, |solver| solver.finds(lobe));
        let detail = format!("solver \"{solver}\" finds LTCs, not lobe \"{lobe}\"; solvers for this lobe: {others}");
        faults.note("/fit/solver", detail);
    }
    if !terms.any() && lobe.gaussian().is_some() {
        let detail = format!("lobe \"{lobe}\" needs its amplitude: leave this field out, or choose true");
        faults.note(root.pointer("terms"), detail);
    }
}

/// Reads the ranges. For a layout with a fixed domain, and for the ratio of isotropic surfaces, a document may only
/// repeat them. Ranges of a tabulated BRDF must be within those of its file.
fn read_range(
    root: &Object,
    model: &BrdfModel,
    layout: Layout,
    given: &GivenNodes,
    faults: &mut Faults,
) -> PerAxis<[f64; 2]> {
    let brdf = model.kind();
    let object = root.object("range", &AXES, faults);
    let only = layout.only_ranges();
    let axes = model.file().and_then(|file| file.data()).map(|data| data.axes());
    let of_file = |nodes: fn(&TabulatedAxes) -> &Vec<f64>| {
        axes.and_then(|axes| nodes(axes).first().zip(nodes(axes).last())).map(|(low, high)| [*low, *high])
    };
    let [alphas, ratios, thetas] =
        [of_file(|axes| &axes.alpha), of_file(|axes| &axes.ratio), of_file(|axes| &axes.theta_o)];
    let of_model = if model.is_isotropic() { ISOTROPIC } else { DOMAIN };
    let default = only.unwrap_or(match axes {
        // A surface without roughness has one entry, with alpha 1 and ratio 1.
        Some(_) => PerAxis {
            alpha: alphas.unwrap_or([1.0; 2]),
            ratio: ratios.unwrap_or(ISOTROPIC.ratio),
            theta: thetas.unwrap_or(DOMAIN.theta),
            ..of_model
        },
        None => of_model,
    });
    let mut axis = |name, domain, default: [f64; 2]| {
        let ends = ends_of(given, name);
        let range = object.range(name, domain, ends.unwrap_or(default), faults);
        if let Some([first, last]) = ends.filter(|ends| *ends != range) {
            let listed = layout.is_of_materials() && (name == "alpha" || name == "ratio");
            let field = if listed { "/materials".to_owned() } else { format!("/nodes/{name}") };
            let detail = format!("the nodes in {field} range from {first} to {last}: leave this field out");
            faults.note(object.pointer(name), detail);
            return [first, last];
        }
        if only.is_some() && range != default {
            let [low, high] = default;
            let detail = format!("layout \"{layout}\" has the fixed range [{low}, {high}], which its readers expect");
            faults.note(object.pointer(name), detail);
            return default;
        }
        if name == "ratio" && model.is_isotropic() && range != ISOTROPIC.ratio {
            let detail = format!("brdf \"{brdf}\" is isotropic: the range must be [1, 1]");
            faults.note(object.pointer(name), detail);
            return default;
        }
        let (axis, of_file) = match name {
            "alpha" => (name, alphas),
            "ratio" => (name, ratios),
            "theta" => ("theta_o", thetas),
            _ => (name, None),
        };
        if let Some([low, high]) = of_file
            && (range[0] < low - FILE_TOLERANCE || range[1] > high + FILE_TOLERANCE)
        {
            let file = format!("the file of the tabulated BRDF has {axis} [{low}, {high}]");
            let given = format!("[{}, {}]", range[0], range[1]);
            if only.is_some() {
                let detail = format!("layout \"{layout}\" has the fixed range {given} of {name}, but {file}");
                faults.note(root.pointer("layout"), detail);
            } else {
                faults.note(object.pointer(name), format!("{given} exceeds the data: {file}"));
            }
            return default;
        }
        range
    };
    PerAxis {
        alpha: axis("alpha", DOMAIN.alpha, default.alpha),
        ratio: axis("ratio", DOMAIN.ratio, default.ratio),
        theta: axis("theta", DOMAIN.theta, default.theta),
        phi: axis("phi", DOMAIN.phi, default.phi),
    }
}

fn check_entries(recipe: &Recipe, entry_limit: u64, faults: &mut Faults) {
    if recipe.entries() > entry_limit {
        let n = recipe.resolution.named().map(|(_, n)| n.to_string()).join(" x ");
        let detail =
            format!("{n} makes {} entries; at most {entry_limit} are allowed (`--entry-limit`)", recipe.entries());
        faults.note("/resolution", detail);
    }
}

/// Rejects nodes that coincide. Floors move the nodes at the end of a range closer together.
fn check_nodes(recipe: &Recipe, faults: &mut Faults) {
    let axes = recipe.nodes();
    let ranges = recipe.range.named();
    for ((name, nodes), (_, range)) in axes.named().into_iter().zip(ranges) {
        // Materials may be in any order.
        let is_listed = recipe.layout.is_of_materials() && (name == "alpha" || name == "ratio");
        if !is_listed && nodes.windows(2).any(|pair| pair[0] >= pair[1]) {
            let detail = format!(
                "[{}, {}] is too narrow for {} nodes: alpha and ratio are fitted from 1e-4 up, theta up to 0.9999 pi/2",
                range[0],
                range[1],
                nodes.len()
            );
            faults.note(format!("/range/{name}"), detail);
        }
    }
}
