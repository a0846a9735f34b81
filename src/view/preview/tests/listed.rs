//! Tables of listed materials, and tables with explicit nodes: in shaders and on the CPU.

use std::ops::ControlFlow;

use super::{
    lookups::{Case, ENTRY, TOLERANCE, by_shaders, configurations, error, random},
    report_skipped,
};
use crate::preview::{
    ShaderTable, TexelFormat,
    cpu::tests as cpu,
    gpu::{GpuFailure, Weights, tests::example},
};
use ltcforge_files::recipe_document;
use ltcforge_fit::{Configuration, Layout, Plan, Table, fit_plan};
use ltcforge_shaders::{Bound, GivenAxes, table_reader};

fn fitted(document: &str) -> Table {
    let recipe = recipe_document::parse(document.as_bytes(), u64::MAX).expect("a recipe");
    fit_plan(&Plan::new(&recipe), &|_| ControlFlow::Continue(())).expect("nothing stops it")
}

/// The lookup by material number. The number replaces alpha.
const MATERIAL_ENTRY: &str = "
@compute @workgroup_size(256)
fn looked_up_material(@builtin(local_invocation_index) index: u32) {
    let given = given[index];
    let lobe = ltc_lookup_material(u32(given.alpha.x), given.wo.xyz);
    let m = transpose(lobe.m);
    found[index] = Found(
        vec4(m[0], m[1].x),
        vec4(m[1].yz, m[2].xy),
        vec4(m[2].z, lobe.amplitude, lobe.fresnel, 0.0),
    );
}
";

/// Each material is found by its number and by its roughness, with the larger roughness along x or y, and for all
/// views.
#[test]
fn materials_are_found_by_number_and_by_roughness() {
    let document = r#"{"layout": "materials", "fit": {"samples": 64, "directions": 6, "steps": 8},
        "materials": [{"alpha": 0.3, "ratio": 0.5}, {"alpha": 0.01}, {"alpha": 1}, {"alpha": 0.3, "ratio": 0.04}, {"alpha": 0.2, "ratio": 0.5}],
        "resolution": {"theta": 5, "phi": 4}}"#;
    let table = fitted(document);
    let pairs: Vec<[f64; 2]> = table.materials().collect();
    let places: Vec<(usize, Configuration)> = random(2560)
        .enumerate()
        .map(|(i, at)| {
            let [alpha, ratio] = pairs[i % pairs.len()];
            let [alpha_x, alpha_y] = if i % 2 == 0 { [alpha, alpha * ratio] } else { [alpha * ratio, alpha] };
            (i % pairs.len(), Configuration { alpha_x, alpha_y, ..at })
        })
        .collect();
    for format in [TexelFormat::F32, TexelFormat::F16] {
        let shader_table = ShaderTable::new(&table, format);
        // Rounding to 11 bits moves a lobe more than the arithmetic does.
        let tolerance = if format == TexelFormat::F16 { 0.02 } else { TOLERANCE };
        let cases: Vec<Case> = places.iter().map(|(_, c)| Case::of(c)).collect();
        let twin = cases.iter().map(|case| cpu::looked_up(&shader_table, case.alpha, case.wo)).collect();
        let mut all = vec![("twin", twin)];
        all.extend(by_shaders(&shader_table, &table, Weights::default(), "looked_up", &cases));
        for (who, found) in all {
            for (found, (_, at)) in found.iter().zip(&places) {
                let off = error(found, &table.lookup(at));
                assert!(off < tolerance, "{who} {format}: off by {off} at {at:?}");
            }
        }
        let numbered: Vec<Case> = places.iter().map(|(number, c)| Case::numbered(*number, c)).collect();
        let (groups, _) = numbered.as_chunks::<256>();
        for textures in [Bound::Volumes, Bound::Array] {
            let source = table_reader(textures, &[table.layout]) + ENTRY + MATERIAL_ENTRY;
            let bound = Some((&shader_table, textures));
            let found = match example::run::<_, [[f32; 12]; 256]>(&source, "looked_up_material", bound, groups) {
                Ok(found) => found.into_flattened(),
                Err(GpuFailure::Absent(reason)) => return report_skipped(&reason),
                Err(failure) => panic!("{failure}"),
            };
            for (found, (number, at)) in found.iter().zip(&places) {
                let wanted = table.lookup_material(*number, at.theta, at.phi).expect("a known material");
                let off = error(found, &wanted);
                assert!(off < tolerance, "{format}: off by {off} at {number} {at:?}");
            }
        }
    }
}

/// The shader finds the explicit nodes of a table, at every corner and at four thousand other points.
#[test]
fn explicit_nodes_are_found() {
    let configurations = configurations();
    let cases: Vec<Case> = configurations.iter().map(Case::of).collect();
    let (groups, _) = cases.as_chunks::<256>();
    for layout in [Layout::Reflected, Layout::Kt2022] {
        let table = fitted(&format!(
            r#"{{"layout": "{layout}", "fit": {{"samples": 64, "directions": 6, "steps": 8}}, "resolution": {{"ratio": 3}},
                "nodes": {{"alpha": [0.04, 0.09, 0.25, 0.9], "theta": [0, 0.3, 0.5, 1.4], "phi": [0, 0.2, 0.9, 1.5707963267948966]}}}}"#
        ));
        let given = GivenAxes::of(&table).expect("uneven nodes");
        let shader_table = ShaderTable::new(&table, TexelFormat::F32);
        for textures in [Bound::Volumes, Bound::Array] {
            let source = given.searched(&table_reader(textures, &[layout])) + ENTRY;
            let bound = Some((&shader_table, textures));
            let found = match example::run::<_, [[f32; 12]; 256]>(&source, "looked_up", bound, groups) {
                Ok(found) => found.into_flattened(),
                Err(GpuFailure::Absent(reason)) => return report_skipped(&reason),
                Err(failure) => panic!("{failure}"),
            };
            for (found, at) in found.iter().zip(&configurations) {
                let off = error(found, &table.lookup(at));
                assert!(off < NEAR_NODES * TOLERANCE, "{layout}: off by {off} at {at:?}");
            }
        }
    }
}

/// The factor on the tolerance for close nodes. Between them, an angle in 32 bits changes the weights more, and the
/// width of a narrow lobe is a small difference of large columns.
const NEAR_NODES: f64 = 3.0;
