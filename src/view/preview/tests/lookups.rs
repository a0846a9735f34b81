//! Compares three lookups of one table: by the table in 64 bits, by the shader's twin, and by the shader.

use std::{f64::consts::PI, ops::ControlFlow};

use glam::DMat3;
use rand_core::{Rng, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

use super::report_skipped;
use crate::preview::{
    ShaderTable, TexelFormat,
    cpu::tests as cpu,
    gpu::{GpuFailure, Weights, tests::example},
};
use ltcforge_files::recipe_document;
use ltcforge_fit::{
    Configuration, Layout, LookedUp, PerAxis, Plan, Precision, Table, blend_weight, blended,
    brdf::LobeTerms,
    fit_plan,
    math::{direction, from_row_major},
};
use ltcforge_shaders::{Bound, table_reader};

/// The lookup for the configuration of each case.
pub(super) const ENTRY: &str = "
struct Case {
    alpha: vec4<f32>,
    wo: vec4<f32>,
}

struct Found {
    a: vec4<f32>,
    b: vec4<f32>,
    c: vec4<f32>,
}

@group(1) @binding(0) var<uniform> given: array<Case, 256>;
@group(1) @binding(1) var<storage, read_write> found: array<Found, 256>;

@compute @workgroup_size(256)
fn looked_up(@builtin(local_invocation_index) index: u32) {
    let given = given[index];
    let lobe = ltc_lookup(given.alpha.x, given.alpha.y, given.wo.xyz);
    let m = transpose(lobe.m);
    found[index] = Found(
        vec4(m[0], m[1].x),
        vec4(m[1].yz, m[2].xy),
        vec4(m[2].z, lobe.amplitude, lobe.fresnel, 0.0),
    );
}
";

/// The lookup of the second lobe, and the diagonal of the blend for F0 = 0.04.
const SECOND_ENTRY: &str = "
@compute @workgroup_size(256)
fn looked_up_second(@builtin(local_invocation_index) index: u32) {
    let given = given[index];
    let lobes = ltc_lookup_both(given.alpha.x, given.alpha.y, given.wo.xyz);
    let m = transpose(lobes.second);
    let blend = ltc_blend(lobes, 0.04, 1.0);
    found[index] = Found(
        vec4(m[0], m[1].x),
        vec4(m[1].yz, m[2].xy),
        vec4(m[2].z, blend[0].x, blend[1].y, blend[2].z),
    );
}
";

/// A small fitted table for the whole domain, or only for isotropic surfaces.
fn fitted(layout: Layout, precision: Precision, isotropic: bool) -> Table {
    fitted_to("one", layout, precision, isotropic)
}

/// [`fitted`] with a given value for the field `fresnel`.
pub(super) fn fitted_to(fresnel: &str, layout: Layout, precision: Precision, isotropic: bool) -> Table {
    let (ratio, phi) = if isotropic { (1, 1) } else { (5, 4) };
    let range = if isotropic { r#", "range": {"ratio": [1, 1], "phi": [0, 0]}"# } else { "" };
    let document = format!(
        r#"{{"layout": "{layout}", "fresnel": "{fresnel}", "precision": "{precision}", "fit": {{"samples": 64, "directions": 6, "steps": 8}},
            "resolution": {{"alpha": 6, "ratio": {ratio}, "theta": 5, "phi": {phi}}}{range}}}"#
    );
    let recipe = recipe_document::parse(document.as_bytes(), u64::MAX).expect("a recipe");
    fit_plan(&Plan::new(&recipe), &|_| ControlFlow::Continue(())).expect("nothing stops it")
}

/// All combinations of values at which the lookup changes: lower limits, folds and ends.
fn corners() -> Vec<Configuration> {
    let alphas = [0.0, 1e-6, 1e-5, 3e-5, 1e-4, 2e-4, 0.03, 1.0];
    let thetas = [0.0, 1e-3, 0.7, 1.57, 0.9999 * PI / 2.0, PI / 2.0];
    let phis = (-4..=8).map(|eighth| f64::from(eighth) * PI / 4.0).collect::<Vec<f64>>();
    let mut corners = Vec::new();
    for alpha_x in alphas {
        for alpha_y in alphas {
            for theta in thetas {
                corners.extend(phis.iter().map(|phi| Configuration { alpha_x, alpha_y, theta, phi: *phi }));
            }
        }
    }
    corners
}

/// Random configurations. Roughness goes down to a tenth of the least roughness, and views go in all directions.
pub(super) fn random(count: usize) -> impl Iterator<Item = Configuration> {
    let mut random = Xoshiro256PlusPlus::seed_from_u64(7);
    let mut uniform = move || (random.next_u64() >> 11) as f64 / (1_u64 << 53) as f64;
    (0..count).map(move |_| Configuration {
        alpha_x: 10_f64.powf(-6.0 * uniform()),
        alpha_y: 10_f64.powf(-6.0 * uniform()),
        theta: 0.5 * PI * uniform(),
        phi: 2.0 * PI * (2.0 * uniform() - 1.0),
    })
}

/// A configuration as the shader reads it.
#[derive(Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub(super) struct Case {
    pub(super) alpha: [f32; 4],
    pub(super) wo: [f32; 4],
}

impl Case {
    pub(super) fn of(c: &Configuration) -> Self {
        let [x, y, z] = direction(c.theta, c.phi).as_vec3().to_array();
        Self { alpha: [c.alpha_x as f32, c.alpha_y as f32, 0.0, 0.0], wo: [x, y, z, 0.0] }
    }

    /// A case with a material's number, and the view direction of a configuration.
    pub(super) fn numbered(number: usize, c: &Configuration) -> Self {
        Self { alpha: [number as f32, 0.0, 0.0, 0.0], ..Self::of(c) }
    }
}

/// The error of a 32-bit lookup, relative to the table's lookup. Errors of the columns of `M` are relative to their
/// lengths, because the second column of a narrow lobe is tiny. Errors of the terms are absolute.
pub(super) fn error(found: &[f32; 12], wanted: &LookedUp) -> f64 {
    let found = found.map(f64::from);
    let matrix = |numbers: &[f64]| DMat3::from_cols_slice(numbers).transpose();
    let (m, w) = (matrix(&found[..9]), matrix(&wanted.matrix));
    let column = |i: usize| (m.col(i) - w.col(i)).length() / w.col(i).length();
    let terms = [(found[9], wanted.amplitude), (found[10], wanted.fresnel)];
    let terms = terms.map(|(found, wanted)| (found - wanted.expect("the recipe has terms")).abs());
    (0..3).map(column).chain(terms).fold(0.0, f64::max)
}

/// The tolerance of a 32-bit lookup. Directions in f32 are 6e-8 apart. The error grows near the horizon, where the
/// table changes fast, and in columns that are differences of larger columns.
pub(super) const TOLERANCE: f64 = 2e-3;

/// The configurations for the comparison, in whole workgroups.
pub(super) fn configurations() -> Vec<Configuration> {
    let corners = corners();
    let count = (4000 + corners.len()).next_multiple_of(256);
    let extra = count - corners.len();
    corners.into_iter().chain(random(extra)).collect()
}

/// Each way to read the table: its name, textures and layouts.
fn readers(table: &Table) -> [(&'static str, Bound, Vec<Layout>); 4] {
    let only = || vec![table.layout];
    [
        ("shader", Bound::Volumes, Layout::ALL.to_vec()),
        ("shader of the layout", Bound::Volumes, only()),
        ("shader of an array", Bound::Array, Layout::ALL.to_vec()),
        ("shader of the layout's array", Bound::Array, only()),
    ]
}

/// The results of an entry point for all cases, for each way to read the table. Empty without an adapter.
pub(super) fn by_shaders(
    table: &ShaderTable,
    of: &Table,
    weights: Weights,
    entry: &str,
    cases: &[Case],
) -> Vec<(&'static str, Vec<[f32; 12]>)> {
    let (groups, rest) = cases.as_chunks::<256>();
    assert!(rest.is_empty(), "the shader takes 256 at a time");
    let mut all = Vec::new();
    for (who, textures, layouts) in readers(of) {
        let source = table_reader(textures, &layouts) + ENTRY + SECOND_ENTRY;
        match example::run_with::<_, [[f32; 12]; 256]>(weights, &source, entry, Some((table, textures)), groups) {
            Ok(found) => all.push((who, found.into_flattened())),
            Err(GpuFailure::Absent(reason)) => report_skipped(&reason),
            Err(failure) => panic!("{failure}"),
        }
    }
    all
}

fn compare(table: &Table, format: TexelFormat, name: &str) {
    let configurations = configurations();
    let wanted: Vec<LookedUp> = configurations.iter().map(|c| table.lookup(c)).collect();
    let cases: Vec<Case> = configurations.iter().map(Case::of).collect();
    let shader_table = ShaderTable::new(table, format);
    let twin: Vec<[f32; 12]> = cases.iter().map(|case| cpu::looked_up(&shader_table, case.alpha, case.wo)).collect();
    let mut all = vec![("twin", twin)];
    all.extend(by_shaders(&shader_table, table, Weights::default(), "looked_up", &cases));
    for (who, found) in all {
        for ((found, wanted), at) in found.iter().zip(&wanted).zip(&configurations) {
            let error = error(found, wanted);
            assert!(error < TOLERANCE, "{name}, {who}: off by {error} at {at:?}:\n{found:?}\n{wanted:?}");
        }
    }
}

/// Reads the second lobe and the blend of an anisotropic and an isotropic table, by each reader.
#[test]
fn both_lobes_are_read_from_any_textures() {
    for (layout, isotropic) in [(Layout::Reflected, false), (Layout::Kt2022, false), (Layout::Ltc2017, true)] {
        let table = fitted_to("blended_lobes", layout, Precision::F32, isotropic);
        let configurations = configurations();
        let cases: Vec<Case> = configurations.iter().map(Case::of).collect();
        let shader_table = ShaderTable::new(&table, TexelFormat::F32);
        let twin = cases.iter().map(|case| cpu::looked_up_second(&shader_table, case.alpha, case.wo)).collect();
        let mut all = vec![("twin", twin)];
        all.extend(by_shaders(&shader_table, &table, Weights::default(), "looked_up_second", &cases));
        for (who, found) in all {
            for (found, at) in found.iter().zip(&configurations) {
                let wanted = table.lookup(at);
                let [first, second] = [wanted.matrix, wanted.second.expect("two lobes")];
                let terms = wanted.amplitude.zip(wanted.fresnel).expect("terms");
                let weight = blend_weight(LobeTerms { amplitude: terms.0, fresnel: terms.1 }, 0.04, 1.0);
                let of_second = LookedUp { matrix: second, ..wanted };
                let [.., x, y, z] = *found;
                let mut with_terms = *found;
                with_terms[9] = terms.0 as f32;
                with_terms[10] = terms.1 as f32;
                let off = error(&with_terms, &of_second);
                assert!(off < TOLERANCE, "{layout}, {who}: off by {off} at {at:?}:\n{found:?}\n{wanted:?}");
                let blend = blended(&from_row_major(&first), &from_row_major(&second), weight);
                let diagonal = [blend.x_axis.x, blend.y_axis.y, blend.z_axis.z];
                for (found, wanted) in [x, y, z].into_iter().zip(diagonal) {
                    assert!(
                        (f64::from(found) - wanted).abs() < TOLERANCE,
                        "{layout}, {who}: {found} {wanted} at {at:?}"
                    );
                }
            }
        }
    }
}

/// A texture sampler weights entries like the shader, in volumes and in arrays.
#[test]
fn samplers_weight_entries_like_shaders() {
    let by_sampler = Weights::Sampler;
    for (layout, isotropic) in [(Layout::Reflected, false), (Layout::Ltc2017, true)] {
        let table = fitted_to("two_lobes", layout, Precision::F32, isotropic);
        let configurations = configurations();
        let cases: Vec<Case> = configurations.iter().map(Case::of).collect();
        let shader_table = ShaderTable::new(&table, TexelFormat::F32);
        for entry in ["looked_up", "looked_up_second"] {
            let [exact, sampled] = [Weights::default(), by_sampler]
                .map(|weights| by_shaders(&shader_table, &table, weights, entry, &cases));
            for ((who, exact), (_, sampled)) in exact.iter().zip(&sampled) {
                for ((exact, sampled), at) in exact.iter().zip(sampled).zip(&configurations) {
                    let most = exact.iter().zip(sampled).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
                    assert!(most < SAMPLED, "{layout}, {who}, {entry}: {exact:?} {sampled:?} at {at:?}");
                }
            }
        }
    }
}

/// The tolerance for samplers with 8-bit weights. Neighbouring numbers differ by about one, and by twenty for narrow
/// lobes. The largest error is 0.084, on an NVIDIA H100.
const SAMPLED: f32 = 0.1;

#[test]
fn shader_twin_and_table_agree_at_every_corner_and_four_thousand_points() {
    for layout in Layout::ALL.iter().filter(|layout| !layout.is_of_materials()) {
        for (precision, format) in [(Precision::F32, TexelFormat::F32), (Precision::F16, TexelFormat::F16)] {
            for isotropic in [false, true] {
                if !isotropic && layout.only_ranges().is_some() {
                    continue;
                }
                let table = fitted(*layout, precision, isotropic);
                let PerAxis { ratio, .. } = table.axes().lengths();
                assert_eq!(isotropic, ratio == 1);
                compare(&table, format, &format!("{layout} {precision}, isotropic: {isotropic}"));
            }
        }
    }
}
