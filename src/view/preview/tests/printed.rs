//! Compiles the programs in GLSL and HLSL with glslang, runs them on the GPU, and compares them with the original WGSL.

use std::{borrow::Cow, fs, io::ErrorKind, path::Path, process::Command};

use bytemuck::Pod;

use super::{
    ported::{case_words, example_lights, lit_by, round_lights, sg_light},
    report_skipped,
};
use crate::preview::{
    ShaderTable, TexelFormat,
    gpu::{GpuFailure, tests::example},
};
use ltcforge_fit::Layout;
use ltcforge_light::{LightModel, normals::NormalsRule};
use ltcforge_shaders::{Bound, CASES, Language, LitBy, golden_table};
use ltcforge_translate::port;

/// The tolerance between two compilers. They may reorder sums and fuse products differently.
const APART: f32 = 2e-5;

/// Replaces the bindings of OpenGL by those of Vulkan, which has separate samplers.
const VULKAN: [(&str, &str); 7] = [
    ("#version 450 core", "#version 450 core\n#extension GL_EXT_samplerless_texture_functions : require"),
    ("layout(binding = 0) uniform sampler3D", "layout(binding = 1) uniform texture3D"),
    ("layout(binding = 1) uniform sampler3D", "layout(binding = 2) uniform texture3D"),
    ("layout(binding = 2) uniform sampler3D", "layout(binding = 3) uniform texture3D"),
    ("layout(std140, binding = 1) uniform", "layout(std140, set = 1, binding = 0) uniform"),
    ("layout(std430, binding = 2) buffer", "layout(std430, set = 1, binding = 1) buffer"),
    ("layout(std140, binding = 0) uniform", "layout(std140, set = 0, binding = 0) uniform"),
];

/// The program in SPIR-V. `None` without glslang.
fn compiled(language: Language, lit_by: LitBy, folder: &Path) -> Option<Vec<u32>> {
    let mut text = String::from_utf8(port(language, lit_by).expect("a program")).expect("UTF-8");
    if language == Language::Glsl && lit_by.layout().is_some() {
        for (found, wanted) in VULKAN {
            assert_eq!(text.matches(found).count(), 1, "{found}");
            text = text.replace(found, wanted);
        }
    }
    fs::write(folder.join("program.comp"), text).expect("a file");
    let entry = lit_by.shader().example;
    let more: &[&str] = if language == Language::Hlsl { &["-D", "-e", entry] } else { &[] };
    let mut command = Command::new("glslangValidator");
    command.current_dir(folder).args(["-V", "-S", "comp", "-o", "program.spv", "program.comp"]).args(more);
    match command.output() {
        Ok(output) => {
            assert!(output.status.success(), "{lit_by:?}: {}", String::from_utf8_lossy(&output.stdout));
        }
        Err(error) if error.kind() == ErrorKind::NotFound => {
            report_skipped("glslangValidator is missing (Debian: glslang-tools)");
            return None;
        }
        Err(error) => panic!("glslangValidator: {error}"),
    }
    let bytes = fs::read(folder.join("program.spv")).expect("SPIR-V");
    Some(bytes.chunks_exact(4).map(|word| u32::from_le_bytes([word[0], word[1], word[2], word[3]])).collect())
}

/// Compares both languages with WGSL. Returns the number of nonzero results, or `None` if the check was skipped.
fn compare<Found: Pod + AsRef<[f32]>>(lit_by: LitBy) -> Option<usize> {
    let table = lit_by.layout().map(|layout| ShaderTable::new(&golden_table(layout), TexelFormat::F32));
    let table = table.as_ref().map(|table| (table, Bound::Volumes));
    let mut lights = example_lights();
    match lit_by.model() {
        LightModel::Ltc | LightModel::LtcFormula => lights.extend(round_lights()),
        LightModel::Sg | LightModel::Asg => lights.push(sg_light()),
        LightModel::Normals => {}
    }
    let mut words = Vec::new();
    for (number, (case, light)) in
        CASES.iter().flat_map(|case| lights.iter().map(move |light| (case, light))).enumerate()
    {
        let mut word = case_words(case, light, number % 2 == 0);
        if matches!(lit_by.model(), LightModel::Sg | LightModel::Asg) {
            word[7] = f32::from(u8::from(number % 3 == 0));
        }
        if lit_by.model() == LightModel::LtcFormula {
            word[11] = [1.0, 0.04][number % 2];
        }
        words.push(word);
    }
    let example = lit_by.shader().example;
    let wgsl = String::from_utf8(port(Language::Wgsl, lit_by).expect("WGSL")).expect("UTF-8");
    let wanted: Vec<Found> = match example::run(&wgsl, example, table, &words) {
        Ok(found) => found,
        Err(GpuFailure::Absent(reason)) => {
            report_skipped(&reason);
            return None;
        }
        Err(error) => panic!("{error}"),
    };
    let folder = tempfile::tempdir().expect("a folder");
    for (language, entry) in [(Language::Glsl, "main"), (Language::Hlsl, example)] {
        let spirv = compiled(language, lit_by, folder.path())?;
        let source = wgpu::ShaderSource::SpirV(Cow::Owned(spirv));
        let found: Vec<Found> = example::run_source(source, entry, table, &words).expect("a run");
        for (case, (found, wanted)) in found.iter().zip(&wanted).enumerate() {
            for (found, wanted) in found.as_ref().iter().zip(wanted.as_ref()) {
                let off = (found - wanted).abs();
                assert!(off < APART, "{} {lit_by:?} case {case}: {found}, not {wanted}", language.name());
            }
        }
    }
    Some(wanted.iter().flat_map(|found| found.as_ref().iter()).filter(|number| **number != 0.0).count())
}

#[test]
fn programs_without_a_table_agree_with_the_wgsl() {
    let rules = NormalsRule::SHADED.map(|rule| lit_by(LightModel::Normals, None).by_rule(Some(rule)).expect("a rule"));
    for lit_by in rules.into_iter().chain([lit_by(LightModel::LtcFormula, None), lit_by(LightModel::Asg, None)]) {
        let Some(lit) = compare::<[f32; 4]>(lit_by) else { return };
        assert!(lit > 20, "{lit_by:?}: {lit}");
    }
}

#[test]
fn programs_that_read_a_table_agree_with_the_wgsl() {
    for layout in Layout::ALL {
        let Some(lit) = compare::<[f32; 16]>((*layout).into()) else { return };
        assert!(lit > 100, "{layout}: {lit}");
    }
    let Some(lit) = compare::<[f32; 4]>(lit_by(LightModel::Asg, Some(Layout::Reflected))) else { return };
    assert!(lit > 20, "{lit}");
}
