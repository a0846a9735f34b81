//! Measures costs of shaders on a GPU: the numbers of `src/shaders/gpu_cost.rs`, as counted by the compiler of a
//! driver.
//!
//! Each shader is compiled with `surface.wgsl` for one rectangle that emits to one side. This includes the transform of
//! its corners into the tangent frame. Index checks are off, as in engines. The methods of engines are written here as
//! they were published.

use std::fmt::Write as _;

use ltcforge::{
    fit::Layout,
    light::{LightModel, NormalsRule, engines::EngineWay, textured::Readings},
    shaders::{Additions, Lights, LitBy, Reading, functions, joined, samplers},
};
use ltcforge_driver::{Driver, DriverError, Figures, Resource};
use naga::{
    AddressSpace, ImageClass, ShaderStage, TypeInner,
    back::{pipeline_constants::process_overrides, spv},
    proc::{BoundsCheckPolicies, BoundsCheckPolicy},
    valid::{Capabilities, ValidationFlags, Validator},
};

const SURFACE: &str = include_str!("surface.wgsl");
const ISOTROPIC: &str = include_str!("ltc_isotropic.wgsl");

/// A shader, with a function `lit` that calls it for one rectangle.
pub(crate) struct Program {
    pub(crate) name: String,
    pub(crate) wgsl: String,
    /// The layout of the shader's table, and whether the table has two lobes per entry.
    pub(crate) table: Option<(Layout, bool)>,
}

/// The reason that a shader was not measured.
#[derive(Debug, thiserror::Error)]
pub enum CostError {
    /// There is no driver, or the driver rejects a shader.
    #[error(transparent)]
    Driver(#[from] DriverError),
    /// The shader is not valid WGSL.
    #[error("{name}: {reason}")]
    Text {
        /// The shader.
        name: String,
        /// The message of naga.
        reason: String,
    },
}

/// The costs as lines for `COSTS` of `src/shaders/gpu_cost.rs`, below a comment with the device's name.
///
/// # Errors
/// [`CostError`]
pub fn text() -> Result<String, CostError> {
    let driver = Driver::open()?;
    let mut out = format!("// {}\n", driver.name());
    for program in programs() {
        let Figures { registers, spilled, instructions, inverse_throughput } = figures(&driver, &program)?;
        let name = program.name;
        // Writing to a String cannot fail.
        let _ = writeln!(out, "    (\"{name}\", [{registers}, {instructions}, {inverse_throughput}]),");
        if spilled > 0 {
            let _ = writeln!(out, "    // of these registers {spilled} are kept in memory");
        }
    }
    Ok(out)
}

pub(crate) fn programs() -> Vec<Program> {
    let tables = [LightModel::Ltc, LightModel::Sg, LightModel::Asg];
    let by_table = tables.iter().flat_map(|model| Layout::ALL.iter().map(|layout| LitBy::new(*model, Some(*layout))));
    let by_formula = [LightModel::LtcFormula, LightModel::Sg, LightModel::Asg].map(|model| LitBy::new(model, None));
    let normals = NormalsRule::SHADED
        .map(|rule| LitBy::new(LightModel::Normals, None).and_then(|lit_by| lit_by.by_rule(Some(rule))));
    let texts = by_table.chain(by_formula).chain(normals).filter_map(Result::ok).map(of_text);
    let two =
        [Layout::Reflected, Layout::Ltc2017].into_iter().flat_map(|layout| TWO_LOBES.map(|way| of_two(layout, way)));
    let ways = EngineWay::ALL.iter().map(|way| of_way(*way));
    texts
        .chain(two)
        .chain(of_plastic())
        .chain(by_choice())
        .chain(shapes())
        .chain(compensated())
        .chain(layered())
        .chain(textured())
        .chain(sampled())
        .chain(ways)
        .collect()
}

/// The formula's shader with the terms for plastics.
fn of_plastic() -> Option<Program> {
    let Program { name, wgsl, table } = of_text(LitBy::new(LightModel::LtcFormula, None).ok()?);
    let wgsl = wgsl.replacen("local.wo, 1.0, 1.0)", "local.wo, 0.04, 1.0)", 1);
    Some(Program { name: format!("{name}, plastic"), wgsl, table })
}

/// Shaders for tables with their options: the cut at the surface, the cheap horizon, and both.
fn by_choice() -> impl Iterator<Item = Program> {
    let layouts = [Layout::Reflected, Layout::Ltc2017];
    let choices = [(true, false), (false, true), (true, true)];
    layouts.into_iter().flat_map(move |layout| choices.map(|choice| (layout, choice))).filter_map(
        |(layout, (cut, is_cheap))| {
            let text = of_text(LitBy::from(layout).with(Additions { cut, compensate: false, textured: None }).ok()?);
            Some(if is_cheap { with_cheap_horizon(text) } else { text })
        },
    )
}

/// Light shapes other than polygons, with and without the cut at the surface.
fn shapes() -> impl Iterator<Item = Program> {
    let calls = [
        ("disk", "c[0], 0.5 * (c[1] - c[0]), 0.5 * (c[0] - c[3]), false"),
        ("sphere", "c[0], length(c[1] - c[0])"),
        ("tube", "c[0], c[1], length(c[3] - c[0])"),
        ("line", "c[0], c[1], length(c[3] - c[0])"),
    ];
    let layouts = [Layout::Reflected, Layout::Ltc2017];
    let choices = layouts.into_iter().flat_map(|layout| [false, true].map(|cut| (layout, cut)));
    choices.flat_map(move |choice| calls.map(|call| (choice, call))).filter_map(
        |((layout, cut), (shape, arguments))| {
            let lit_by = LitBy::from(layout).with(Additions { cut, ..Additions::default() }).ok()?;
            let function = if cut { format!("ltc_cut_{shape}") } else { format!("ltc_{shape}") };
            let lit = format!(
                "fn lit(alpha: vec2<f32>, local: Local) -> vec4<f32> {{
    let lobe = ltc_lookup(alpha.x, alpha.y, local.wo);
    let c = local.corners;
    return vec4({function}(ltc_inverse(lobe.m), {arguments}), lobe.amplitude, lobe.fresnel, 0.0);
}}\n"
            );
            let text = functions(lit_by, Reading::default(), Lights::All);
            Some(program(format!("{}, {function}", LitBy::from(layout).name()), &[&text, &lit], Some((layout, false))))
        },
    )
}

/// Shaders with the compensation factor for metals.
fn compensated() -> impl Iterator<Item = Program> {
    let models = [LightModel::LtcFormula, LightModel::Normals, LightModel::Asg].map(|model| (model, None));
    let models = [(LightModel::Ltc, Some(Layout::Reflected))].into_iter().chain(models);
    let additions = Additions { cut: false, compensate: true, textured: None };
    models.filter_map(move |(model, layout)| Some(of_text(LitBy::new(model, layout).ok()?.with(additions).ok()?)))
}

/// A metal by F82 under a coat and fuzz: two lookups and three integrals.
fn layered() -> impl Iterator<Item = Program> {
    let calls = "
    let base = ltc_lookup(alpha.x, alpha.y, local.wo);
    let coat = ltc_lookup(0.1 * alpha.y, 0.1 * alpha.y, local.wo);
    let fuzz = layers_fuzz(alpha.y, local.wo);
    let base_covered = ltc_rectangle(ltc_inverse(base.m), local.corners, false);
    let metal = layers_metal(vec2(base.amplitude, base.fresnel) * base_covered, vec3(0.9, 0.8, 0.7), vec3(0.8, 0.9, 1.0));
    let albedo = layers_albedo(coat.amplitude, coat.fresnel, 0.04);
    let shine = vec3(albedo * ltc_rectangle(ltc_inverse(coat.m), local.corners, false));
    let coated = layers_coated(metal, shine, albedo, 0.8, vec3(0.9));
    let fibres = vec3(fuzz.albedo * ltc_rectangle(LtcInverse(fuzz.inverse, 1.0), local.corners, false));
    return vec4(layers_fuzzed(coated, fibres, fuzz.albedo, alpha.x), 0.0);
";
    let layers = joined(&["layers"]);
    [Layout::Reflected, Layout::Ltc2017].into_iter().map(move |layout| {
        let lit_by = LitBy::from(layout);
        let text = functions(lit_by, Reading::default(), Lights::Polygons);
        let lit = format!("fn lit(alpha: vec2<f32>, local: Local) -> vec4<f32> {{{calls}}}\n");
        program(format!("{}, layers", lit_by.name()), &[&text, &layers, &lit], Some((layout, false)))
    })
}

/// Shaders for pictures on lights.
fn textured() -> impl Iterator<Item = Program> {
    let normals = NormalsRule::SHADED
        .into_iter()
        .filter_map(|rule| LitBy::new(LightModel::Normals, None).ok()?.by_rule(Some(rule)).ok());
    let first = normals.clone().take(1).flat_map(|lit_by| Readings::ALL.iter().map(move |number| (lit_by, *number)));
    let others = normals.skip(1).chain([LitBy::from(Layout::Reflected)]).map(|lit_by| (lit_by, Readings::Four));
    first.chain(others).filter_map(|(lit_by, number)| {
        Some(of_text(lit_by.with(Additions { textured: Some(number), ..Additions::default() }).ok()?))
    })
}

/// Samplers of a rectangle: the set-up alone, with one and with two draws, and with a density.
fn sampled() -> impl Iterator<Item = Program> {
    let first = "let drawn = sampler_draw(rectangle, local.wo.xy);\n    return vec4(drawn.wi, drawn.pdf);";
    let second = "let drawn = sampler_draw(rectangle, local.wo.xy);\n    let again = sampler_draw(rectangle, local.wo.yx);\n    \
                  return vec4(drawn.wi + again.wi, drawn.pdf + again.pdf);";
    let density = "return vec4(sampler_pdf(rectangle, local.wo));";
    let normals = "sampler_normals(alpha.x, alpha.y, local.wo, local.corners, false)";
    let set_up = "return vec4(rectangle.scale * rectangle.map.back[0] + rectangle.map.back[1] + rectangle.map.back[2]
        + rectangle.g + rectangle.h + rectangle.d + rectangle.e + rectangle.f + rectangle.halves, rectangle.total);";
    let calls = [
        ("sampler of normals", normals, set_up),
        ("sampler of normals, a draw", normals, first),
        ("sampler of normals, two draws", normals, second),
        ("sampler of normals, a density", normals, density),
        (
            "sampler about a mean normal",
            "sampler_normals_about(alpha.x, alpha.y, local.wo, light.corners[2].xyw, local.corners, false)",
            set_up,
        ),
        // The compiler cannot know this matrix.
        (
            "sampler of a matrix, a draw",
            "sampler_ltc(mat3x3(light.corners[0].xyw, light.corners[1].xyw, light.corners[2].xyw), local.corners, false)",
            first,
        ),
    ];
    calls.into_iter().map(|(name, from, of)| {
        let lit = format!(
            "fn lit(alpha: vec2<f32>, local: Local) -> vec4<f32> {{\n    let rectangle = {from};\n    {of}\n}}\n"
        );
        program(name.to_owned(), &[&samplers(), &lit], None)
    })
}

fn with_cheap_horizon(Program { name, wgsl, table }: Program) -> Program {
    let [exact, cheap] = [false, true].map(|is_cheap| format!("const LTC_CHEAP_HORIZON: bool = {is_cheap};"));
    Program { name: format!("{name}, cheap horizon"), wgsl: wgsl.replacen(&exact, &cheap, 1), table }
}

fn of_text(lit_by: LitBy) -> Program {
    let calls = match lit_by.model() {
        LightModel::Ltc => {
            let rectangle = if lit_by.additions().cut { "ltc_cut_rectangle" } else { "ltc_rectangle" };
            // The compiler cannot know this number.
            let lookup = match lit_by.layout() {
                Some(Layout::Materials) => "ltc_lookup_material(u32(alpha.x * 8.0), local.wo)",
                _ => "ltc_lookup(alpha.x, alpha.y, local.wo)",
            };
            format!(
                "let lobe = {lookup};
    return vec4({rectangle}(ltc_inverse(lobe.m), local.corners, false), lobe.amplitude, lobe.fresnel, 0.0);"
            )
        }
        LightModel::LtcFormula => "let lobe = ltc_formula(alpha.x, alpha.y, local.wo, 1.0, 1.0);
    let covered = ltc_rectangle(lobe.inverse, local.corners, false);
    return vec4(covered, lobe.amplitude, lobe.fresnel, 0.0);"
            .to_owned(),
        LightModel::Normals => "let view = normals_view(alpha.x, alpha.y, local.wo);
    return vec4(normals_rectangle(view, local.corners, false), 0.0, 0.0);"
            .to_owned(),
        model @ (LightModel::Sg | LightModel::Asg) => {
            let kind = if model == LightModel::Sg { "GAUSSIANS_SG" } else { "GAUSSIANS_ASG" };
            let view = if lit_by.layout().is_some() { "gaussians_lookup" } else { "gaussians_view" };
            format!(
                "let view = {view}({kind}, alpha.x, alpha.y, local.wo);
    return vec4(gaussians_rectangle(view, local.corners, false), 0.0, 0.0);"
            )
        }
    };
    let calls = if lit_by.additions().textured.is_some() { textured_calls(lit_by.model()).to_owned() } else { calls };
    let factor = match lit_by.model() {
        LightModel::Ltc => "ltc_compensation(lobe, vec3(0.9, 0.8, 0.7))",
        LightModel::LtcFormula => "ltc_formula_compensation(lobe, vec3(0.9, 0.8, 0.7))",
        LightModel::Normals => "normals_compensation(view, vec3(0.9, 0.8, 0.7))",
        LightModel::Sg | LightModel::Asg => "gaussians_compensation(alpha.x, alpha.y, local.wo, vec3(0.9, 0.8, 0.7))",
    };
    let calls = if lit_by.additions().compensate {
        calls.replace("return vec4(", &format!("return vec4({factor}, 1.0) * vec4("))
    } else {
        calls
    };
    let text = functions(lit_by, Reading::default(), Lights::Polygons);
    let lit = format!("fn lit(alpha: vec2<f32>, local: Local) -> vec4<f32> {{\n    {calls}\n}}\n");
    program(lit_by.name(), &[&text, &lit], lit_by.layout().map(|layout| (layout, false)))
}

/// One rectangle with a picture. The compiler cannot know the layer.
fn textured_calls(model: LightModel) -> &'static str {
    match model {
        LightModel::Ltc => {
            "let lobe = ltc_lookup(alpha.x, alpha.y, local.wo);
    let textured = ltc_textured_rectangle(ltc_inverse(lobe.m), local.corners, false, u32(alpha.x * 8.0), 8.0);
    return vec4(textured.colour * textured.covered * lobe.amplitude, lobe.fresnel);"
        }
        _ => {
            "let view = normals_view(alpha.x, alpha.y, local.wo);
    let textured = normals_textured_rectangle(view, local.corners, false, u32(alpha.x * 8.0), 8.0);
    return vec4(textured.colour * textured.parts.x, textured.parts.y);"
        }
    }
}

/// The ways to use two lobes, and the code that returns the reflected light. Alpha replaces F0, so the compiler cannot
/// know F0.
const TWO_LOBES: [(&str, &str); 2] = [
    (
        "two integrals",
        "let first = ltc_rectangle(ltc_inverse(lobes.first.m), local.corners, false);
    let second = ltc_rectangle(ltc_inverse(lobes.second), local.corners, false);
    return vec4(first, second, lobes.first.amplitude, lobes.first.fresnel);",
    ),
    (
        "blended",
        "let covered = ltc_rectangle(ltc_inverse(ltc_blend(lobes, alpha.y, 1.0)), local.corners, false);
    return vec4(covered, lobes.first.amplitude, lobes.first.fresnel, 0.0);",
    ),
];

fn of_two(layout: Layout, (way, calls): (&str, &str)) -> Program {
    let lit_by = LitBy::from(layout);
    let text = functions(lit_by, Reading { two_lobes: true, ..Reading::default() }, Lights::Polygons);
    let lit = format!(
        "fn lit(alpha: vec2<f32>, local: Local) -> vec4<f32> {{
    let lobes = ltc_lookup_both(alpha.x, alpha.y, local.wo);\n    {calls}\n}}\n"
    );
    program(format!("{}, {way}", lit_by.name()), &[&text, &lit], Some((layout, true)))
}

fn of_way(way: EngineWay) -> Program {
    let texts: &[&str] = match way {
        EngineWay::Clipless => &[ISOTROPIC, include_str!("clipless.wgsl")],
        EngineWay::Stretched => &[ISOTROPIC, include_str!("stretched.wgsl")],
        EngineWay::Anisotropic => &[include_str!("anisotropic.wgsl")],
        EngineWay::RepresentativePoint => &[include_str!("representative_point.wgsl")],
    };
    program(way.name().to_owned(), texts, None)
}

fn program(name: String, texts: &[&str], table: Option<(Layout, bool)>) -> Program {
    Program { name, wgsl: format!("{SURFACE}\n{}", texts.concat()), table }
}

fn figures(driver: &Driver, Program { name, wgsl, .. }: &Program) -> Result<Figures, CostError> {
    let refused = |reason: String| CostError::Text { name: name.clone(), reason };
    let main = "
@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    let surface = surfaces[id.x];
    reflected[id.x] = lit(surface.alpha, local_view(surface));
}
";
    let wgsl = &format!("{wgsl}{main}");
    let module = naga::front::wgsl::parse_str(wgsl).map_err(|error| refused(error.emit_to_string(wgsl)))?;
    let mut validator = Validator::new(ValidationFlags::all(), Capabilities::empty());
    let info = validator.validate(&module).map_err(|error| refused(error.emit_to_string(wgsl)))?;
    let by_hardware = [("ltc_hardware_filter".to_owned(), 1.0)].into_iter();
    let entry = (ShaderStage::Compute, "main");
    let known =
        by_hardware.filter(|(name, _)| module.overrides.iter().any(|(_, known)| known.name.as_ref() == Some(name)));
    let (module, info) =
        process_overrides(&module, &info, Some(entry), &known.collect()).map_err(|error| refused(error.to_string()))?;
    let unchecked = BoundsCheckPolicy::Unchecked;
    let options = spv::Options {
        lang_version: (1, 3),
        bounds_check_policies: BoundsCheckPolicies {
            index: unchecked,
            buffer: unchecked,
            image_load: unchecked,
            binding_array: unchecked,
        },
        ..spv::Options::default()
    };
    let pipeline = spv::PipelineOptions { shader_stage: entry.0, entry_point: entry.1.to_owned() };
    let words =
        spv::write_vec(&module, &info, &options, Some(&pipeline)).map_err(|error| refused(error.to_string()))?;
    let resources = module.global_variables.iter().filter_map(|(_, global)| {
        let resource = match (global.space, &module.types[global.ty].inner) {
            (AddressSpace::Uniform, _) => Resource::Uniform,
            (AddressSpace::Storage { .. }, _) => Resource::Storage,
            (_, TypeInner::Sampler { .. }) => Resource::Sampler,
            (_, TypeInner::Image { class: ImageClass::Sampled { .. }, .. }) => Resource::Texture,
            _ => return None,
        };
        Some((global.binding.as_ref()?.binding, resource))
    });
    Ok(driver.figures(&words, entry.1, &resources.collect::<Vec<_>>())?)
}
