//! Checks the exported shaders with other compilers and validators.

use std::{
    fs,
    io::ErrorKind,
    path::Path,
    process::{Command, Output},
};

use crate::common::{command::run, report_skipped};

/// The result of a program from a Debian package on a file. `None` if it is not installed.
pub(super) fn checked(package: &str, program: &str, args: &[&str], folder: &Path) -> Option<Output> {
    match Command::new(program).args(args).current_dir(folder).output() {
        Ok(output) => Some(output),
        Err(error) if error.kind() == ErrorKind::NotFound => {
            report_skipped(&format!("there is no {program} (Debian: {package})"));
            None
        }
        Err(error) => panic!("{program}: {error}"),
    }
}

#[track_caller]
pub(super) fn assert_sound(output: &Output) {
    let texts = [&output.stdout, &output.stderr].map(|text| String::from_utf8_lossy(text));
    assert!(output.status.success(), "{texts:?}");
}

/// The kinds of shaders: with tables of each layout, and without a table.
const LIT_BY: [&[&str]; 16] = [
    &["--layout", "kt2022"],
    &["--layout", "reflected"],
    &["--layout", "ltc2017"],
    &["--layout", "ltc2016"],
    &["--layout", "godot"],
    &["--layout", "hdrp"],
    &["--layout", "inverse"],
    &["--layout", "matrix33"],
    &["--layout", "materials"],
    &["--model", "normals"],
    &["--model", "normals", "--rule", "fast"],
    &["--model", "normals", "--rule", "fine"],
    &["--model", "ltc-formula"],
    &["--model", "asg"],
    &["--model", "asg", "--layout", "reflected"],
    &["--model", "sg", "--layout", "kt2022"],
];

/// Writes a shader.
fn write(folder: &Path, language: &str, lit_by: &[&str], file: &str) {
    run(folder, ["shader", "--as", "example", "--language", language, "-o", file].iter().chain(lit_by)).exited(0);
}

#[test]
fn spirv_is_valid_for_vulkan() {
    let folder = tempfile::tempdir().expect("a folder");
    for lit_by in LIT_BY {
        write(folder.path(), "spirv", lit_by, "ltc.spv");
        let args = ["--target-env", "vulkan1.1", "ltc.spv"];
        let Some(output) = checked("spirv-tools", "spirv-val", &args, folder.path()) else { return };
        assert_sound(&output);
    }
}

#[test]
fn glsl_is_valid_for_opengl() {
    let folder = tempfile::tempdir().expect("a folder");
    for lit_by in LIT_BY {
        write(folder.path(), "glsl", lit_by, "ltc.comp");
        let args = ["-G", "ltc.comp", "-o", "ltc.spv"];
        let Some(output) = checked("glslang-tools", "glslangValidator", &args, folder.path()) else { return };
        assert_sound(&output);
        // OpenGL ES has no such binaries, so the validator checks the text.
        write(folder.path(), "glsl-es", lit_by, "es.comp");
        let Some(output) = checked("glslang-tools", "glslangValidator", &["es.comp"], folder.path()) else { return };
        assert_sound(&output);
    }
}

#[test]
fn hlsl_is_valid_for_direct3d() {
    let folder = tempfile::tempdir().expect("a folder");
    let here = folder.path();
    for lit_by in LIT_BY {
        write(here, "hlsl", lit_by, "ltc.hlsl");
        let text = fs::read_to_string(here.join("ltc.hlsl")).expect("a shader");
        let (_, after) = text.split_once("[numthreads(").expect("a compute shader");
        let entry = after.split_once("void ").and_then(|(_, rest)| rest.split_once('(')).expect("its function").0;
        let args = ["-D", "-V", "-S", "comp", "-e", entry, "-o", "out.spv", "ltc.hlsl"];
        let Some(output) = checked("glslang-tools", "glslangValidator", &args, here) else { return };
        assert_sound(&output);
        let args = ["--target-env", "vulkan1.0", "out.spv"];
        let Some(output) = checked("spirv-tools", "spirv-val", &args, here) else { return };
        assert_sound(&output);
    }
}

/// Layers belong to no model. Their functions compile on their own, and all options of models are rejected at once.
#[test]
fn layers_have_their_own_shader_text() {
    let folder = tempfile::tempdir().expect("a folder");
    let here = folder.path();
    let text = run(here, ["shader", "--as", "layers", "--language", "glsl"]).exited(0).stdout;
    let call = "layers_fuzzed(layers_coated(vec3(0.5), vec3(0.1), layers_albedo(0.9, 0.1, 0.04), 0.5, vec3(1.0)), vec3(0.2), \
                layers_fuzz(0.5, vec3(0.0, 0.0, 1.0)).albedo, 0.5)";
    let program = format!(
        "#version 450\n{text}\nlayout(location = 0) out vec4 colour;\nvoid main() {{ colour = vec4({call}, 1.0); }}\n"
    );
    fs::write(here.join("layers.frag"), program).expect("a file");
    let args = ["-V", "layers.frag", "-o", "layers.spv"];
    if let Some(output) = checked("glslang-tools", "glslangValidator", &args, here) {
        assert_sound(&output);
    }
    let words = ["shader", "--as", "layers", "--language", "wgsl", "--layout", "kt2022", "--prefix", "a"];
    let output = run(here, words).exited(2).stderr;
    assert!(output.contains("leave out --layout, --prefix"), "{output}");
    run(here, ["shader", "--as", "layers", "--language", "spirv", "-o", "layers.spv"]).exited(2);
}

/// Runs the command of docs/shaders.md.
#[test]
fn the_digest_in_a_text_equals_sha256sum() {
    let folder = tempfile::tempdir().expect("a folder");
    for (language, form) in [("wgsl", "include"), ("glsl-es", "include"), ("hlsl", "example"), ("glsl", "example")] {
        let words = ["shader", "--language", language, "--as", form, "--model", "normals", "-o", "normals.glsl"];
        run(folder.path(), words).exited(0);
        let args = ["-c", "sed '1,/^$/d' normals.glsl | sha256sum"];
        let Some(output) = checked("coreutils", "sh", &args, folder.path()) else { return };
        assert_sound(&output);
        let digest = String::from_utf8_lossy(&output.stdout).chars().take(16).collect::<String>();
        let text = fs::read_to_string(folder.path().join("normals.glsl")).expect("a shader");
        assert!(text.contains(&format!("sha256 of the text below: {digest}\n")), "{language}: {digest}");
    }
}

#[test]
fn wgsl_is_valid_for_webgpu() {
    let folder = tempfile::tempdir().expect("a folder");
    for (lit_by, form) in LIT_BY.into_iter().flat_map(|lit_by| ["example", "include"].map(|form| (lit_by, form))) {
        let words = ["shader", "--as", form, "--language", "wgsl", "-o", "ltc.wgsl"];
        run(folder.path(), words.iter().chain(lit_by)).exited(0);
        let Some(output) = checked("none; cargo install naga-cli", "naga", &["ltc.wgsl"], folder.path()) else {
            return;
        };
        assert_sound(&output);
    }
}

#[test]
fn msl_is_valid_for_metal() {
    let folder = tempfile::tempdir().expect("a folder");
    for (lit_by, form) in LIT_BY.into_iter().flat_map(|lit_by| ["example", "include"].map(|form| (lit_by, form))) {
        let words = ["shader", "--as", form, "--language", "msl", "-o", "ltc.metal"];
        run(folder.path(), words.iter().chain(lit_by)).exited(0);
        let args = ["-sdk", "macosx", "metal", "-std=macos-metal2.0", "-c", "ltc.metal", "-o", "ltc.air"];
        let Some(output) = checked("none; Xcode has it", "xcrun", &args, folder.path()) else { return };
        assert_sound(&output);
    }
}

/// Programs that call the included functions, as the shader of a renderer does.
const TABLE_CALL: &str = "
    LtcLobe lobe = ltc_lookup(0.4, 0.2, normalize(vec3(place, 1.0)));
    LtcInverse inverse_ = ltc_inverse(lobe.m);
    vec3 corners[4] = vec3[4](vec3(-1, -1, 1), vec3(-1, 1, 1), vec3(1, 1, 1), vec3(1, -1, 1));
    colour = vec4(ltc_rectangle(inverse_, corners, true) * lobe.amplitude);
";
const NORMALS_CALL: &str = "
    NormalsView view = normals_view(0.4, 0.2, normalize(vec3(place, 1.0)));
    vec3 corners[4] = vec3[4](vec3(-1, -1, 1), vec3(-1, 1, 1), vec3(1, 1, 1), vec3(1, -1, 1));
    colour = vec4(normals_rectangle(view, corners, true), 0.0, 1.0);
";
const FORMULA_CALL: &str = "
    LtcFormula lobe = ltc_formula(0.4, 0.2, normalize(vec3(place, 1.0)), 0.04, 1.0);
    vec3 corners[4] = vec3[4](vec3(-1, -1, 1), vec3(-1, 1, 1), vec3(1, 1, 1), vec3(1, -1, 1));
    colour = vec4(ltc_rectangle(lobe.inverse, corners, true) * lobe.amplitude);
";
const GAUSSIANS_CALL: &str = "
    GaussiansView view = gaussians_view(1u, 0.4, 0.2, normalize(vec3(place, 1.0)));
    vec3 corners[4] = vec3[4](vec3(-1, -1, 1), vec3(-1, 1, 1), vec3(1, 1, 1), vec3(1, -1, 1));
    colour = vec4(gaussians_rectangle(view, corners, true), gaussians_sg(view, normalize(corners[0]), 20.0, 1.0));
";

const GAUSSIANS_TABLE_CALL: &str = "
    GaussiansView view = gaussians_lookup(1u, 0.4, 0.2, normalize(vec3(place, 1.0)));
    vec3 corners[4] = vec3[4](vec3(-1, -1, 1), vec3(-1, 1, 1), vec3(1, 1, 1), vec3(1, -1, 1));
    colour = vec4(gaussians_rectangle(view, corners, true), gaussians_sg(view, normalize(corners[0]), 20.0, 1.0));
";

/// The same calls in HLSL.
const TABLE_CALL_HLSL: &str = "
    LtcLobe lobe = ltc_lookup(0.4, 0.2, normalize(float3(place, 1.0)));
    LtcInverse inverse_ = ltc_inverse(lobe.m);
    float3 corners[4] = { float3(-1, -1, 1), float3(-1, 1, 1), float3(1, 1, 1), float3(1, -1, 1) };
    return (ltc_rectangle(inverse_, corners, true) * lobe.amplitude).xxxx;
";
const NORMALS_CALL_HLSL: &str = "
    NormalsView view = normals_view(0.4, 0.2, normalize(float3(place, 1.0)));
    float3 corners[4] = { float3(-1, -1, 1), float3(-1, 1, 1), float3(1, 1, 1), float3(1, -1, 1) };
    return float4(normals_rectangle(view, corners, true), 0.0, 1.0);
";
const FORMULA_CALL_HLSL: &str = "
    LtcFormula lobe = ltc_formula(0.4, 0.2, normalize(float3(place, 1.0)), 0.04, 1.0);
    float3 corners[4] = { float3(-1, -1, 1), float3(-1, 1, 1), float3(1, 1, 1), float3(1, -1, 1) };
    return (ltc_rectangle(lobe.inverse, corners, true) * lobe.amplitude).xxxx;
";
const GAUSSIANS_CALL_HLSL: &str = "
    GaussiansView view = gaussians_view(1u, 0.4, 0.2, normalize(float3(place, 1.0)));
    float3 corners[4] = { float3(-1, -1, 1), float3(-1, 1, 1), float3(1, 1, 1), float3(1, -1, 1) };
    return float4(gaussians_rectangle(view, corners, true), gaussians_sg(view, normalize(corners[0]), 20.0, 1.0));
";

const GAUSSIANS_TABLE_CALL_HLSL: &str = "
    GaussiansView view = gaussians_lookup(1u, 0.4, 0.2, normalize(float3(place, 1.0)));
    float3 corners[4] = { float3(-1, -1, 1), float3(-1, 1, 1), float3(1, 1, 1), float3(1, -1, 1) };
    return float4(gaussians_rectangle(view, corners, true), gaussians_sg(view, normalize(corners[0]), 20.0, 1.0));
";

/// The ways to read a table.
const READINGS: [&[&str]; 4] =
    [&[], &["--hardware-filter"], &["--texture-array"], &["--hardware-filter", "--texture-array"]];

/// The calls for a kind of shader, in GLSL and in HLSL.
fn calls_of(lit_by: &[&str]) -> [&'static str; 2] {
    match lit_by {
        ["--layout", _] => [TABLE_CALL, TABLE_CALL_HLSL],
        [_, "ltc-formula"] => [FORMULA_CALL, FORMULA_CALL_HLSL],
        [_, "normals", ..] => [NORMALS_CALL, NORMALS_CALL_HLSL],
        [_, _, "--layout", _] => [GAUSSIANS_TABLE_CALL, GAUSSIANS_TABLE_CALL_HLSL],
        _ => [GAUSSIANS_CALL, GAUSSIANS_CALL_HLSL],
    }
}

#[test]
fn included_hlsl_compiles_in_a_pixel_shader() {
    let folder = tempfile::tempdir().expect("a folder");
    for lit_by in LIT_BY {
        let is_table = lit_by.contains(&"--layout");
        for reading in if is_table { &READINGS[..] } else { &READINGS[..1] } {
            let words = ["shader", "--language", "hlsl"];
            let arguments = words.iter().chain(lit_by).chain(*reading);
            let functions = run(folder.path(), arguments).exited(0).stdout;
            let [_, call] = calls_of(lit_by);
            let whole = format!("{functions}\nfloat4 main(float2 place : TEXCOORD0) : SV_Target {{{call}}}\n");
            fs::write(folder.path().join("whole.hlsl"), whole).expect("a file");
            let args = ["-D", "-V", "-S", "frag", "-e", "main", "-o", "out.spv", "whole.hlsl"];
            let Some(output) = checked("glslang-tools", "glslangValidator", &args, folder.path()) else { return };
            assert_sound(&output);
            let args = ["--target-env", "vulkan1.0", "out.spv"];
            let Some(output) = checked("spirv-tools", "spirv-val", &args, folder.path()) else { return };
            assert_sound(&output);
        }
    }
}

#[test]
fn the_polynomials_of_a_table_compile_in_other_shaders() {
    let folder = tempfile::tempdir().expect("a folder");
    let here = folder.path();
    let recipe = r#"{"resolution":{"alpha":32,"ratio":1,"theta":32,"phi":1},"range":{"ratio":[1,1],"phi":[0,0]},
        "fit":{"samples":64,"directions":4,"steps":5}}"#;
    fs::write(here.join("recipe.json"), recipe).expect("a recipe");
    let fitted = run(here, ["fit", "recipe.json", "-o", "."]).exited(0);
    // The table is isotropic, so both roughnesses must be equal.
    let [call, call_hlsl] = [TABLE_CALL, TABLE_CALL_HLSL].map(|call| call.replace("0.4, 0.2", "0.4, 0.4"));
    let es = "#version 300 es\nprecision highp float;\nprecision highp int;";
    let es_end = format!("in vec2 place;\nout vec4 colour;\nvoid main() {{{call}}}\n");
    let hlsl_end = format!("float4 main(float2 place : TEXCOORD0) : SV_Target {{{call_hlsl}}}\n");
    // Only a few languages, because each run measures the table.
    for (language, head, end, args) in [
        ("glsl-es", es, es_end, &["whole.frag"][..]),
        ("hlsl", "", hlsl_end, &["-D", "-V", "-S", "frag", "-e", "main", "-o", "out.spv", "whole.frag"]),
    ] {
        let words = ["shader", "--language", language, "--without-textures", fitted.last_line()];
        let functions = run(here, words).exited(0).stdout;
        fs::write(here.join("whole.frag"), format!("{head}\n{functions}\n{end}")).expect("a file");
        let Some(output) = checked("glslang-tools", "glslangValidator", args, here) else { return };
        assert_sound(&output);
    }
}

/// The lights of two tables and the lights without a table, for one shader.
fn together(folder: &Path, language: &str) -> String {
    let second: &[&str] = match language {
        // Uniforms outside blocks have no binding numbers.
        "glsl-330" | "glsl-es" => &["--layout", "ltc2017", "--prefix", "iso"],
        _ => &["--layout", "ltc2017", "--prefix", "iso", "--first-binding", "6", "--group", "1"],
    };
    let lights = [&["--layout", "reflected"], second, &["--model", "normals"], &["--model", "sg"]];
    lights.map(|light| run(folder, ["shader", "--language", language].iter().chain(light)).exited(0).stdout).concat()
}

#[test]
fn several_lights_compile_in_one_shader() {
    let folder = tempfile::tempdir().expect("a folder");
    let hlsl: &[&str] = &["-D", "-V", "-S", "frag", "-e", "main", "-o", "out.spv"];
    for (language, version, args) in [
        ("glsl", "#version 450 core", &["-V", "-o", "out.spv"][..]),
        ("glsl-330", "#version 330 core", &[]),
        ("glsl-es", "#version 300 es\nprecision highp float;\nprecision highp int;", &[]),
        ("hlsl", "", hlsl),
    ] {
        let functions = together(folder.path(), language);
        let call = |lit_by: [&str; 2]| calls_of(&lit_by)[usize::from(language == "hlsl")];
        let [table, normals, gaussians] = [["--layout", ""], ["--model", "normals"], ["--model", "sg"]].map(call);
        let iso = table.replace("ltc_", "iso_").replace("Ltc", "Iso");
        let calls = [table, &iso, normals, gaussians];
        let whole = if language == "hlsl" {
            let of = |(n, call)| format!("float4 light{n}(float2 place) {{{call}}}\n");
            let lights: String = calls.iter().enumerate().map(of).collect();
            let sum = "return light0(place) + light1(place) + light2(place) + light3(place);";
            format!("{functions}\n{lights}float4 main(float2 place : TEXCOORD0) : SV_Target {{{sum}}}\n")
        } else {
            let end = if language == "glsl" { "layout(location = 0) " } else { "" };
            let calls: String = calls.iter().flat_map(|call| ["{", call, "}\n"]).collect();
            format!("{version}\n{functions}\n{end}in vec2 place;\n{end}out vec4 colour;\nvoid main() {{{calls}}}\n")
        };
        let file = if language == "hlsl" { "whole.hlsl" } else { "whole.frag" };
        fs::write(folder.path().join(file), whole).expect("a file");
        let args: Vec<&str> = args.iter().copied().chain([file]).collect();
        let Some(output) = checked("glslang-tools", "glslangValidator", &args, folder.path()) else { return };
        assert_sound(&output);
    }
    for refused in [
        &["--language", "glsl", "--layout", "reflected", "--prefix", "GL"][..],
        &["--language", "glsl", "--layout", "reflected", "--prefix", "a", "--as", "example"],
        &["--language", "glsl-es", "--layout", "reflected", "--first-binding", "3"],
        &["--language", "glsl", "--model", "normals", "--first-binding", "3"],
        &["--language", "glsl-330", "--layout", "reflected", "--group", "1"],
        &["--language", "glsl", "--layout", "reflected", "--as", "example", "--group", "1"],
    ] {
        run(folder.path(), ["shader"].iter().chain(refused)).exited(2);
    }
}

#[test]
fn included_texts_compile_in_a_fragment_shader() {
    let folder = tempfile::tempdir().expect("a folder");
    let versions: [(&str, &str, &[&str]); 4] = [
        ("glsl", "#version 450 core", &["-V", "-o", "out.spv"]),
        ("glsl", "#version 450 core", &["-G", "-o", "out.spv"]),
        ("glsl-330", "#version 330 core", &[]),
        ("glsl-es", "#version 300 es", &[]),
    ];
    for lit_by in LIT_BY {
        let is_table = lit_by.contains(&"--layout");
        for reading in if is_table { &READINGS[..] } else { &READINGS[..1] } {
            for (language, version, args) in versions {
                let words = ["shader", "--language", language];
                let arguments = words.iter().chain(lit_by).chain(*reading);
                let functions = run(folder.path(), arguments).exited(0).stdout;
                let precision = if language == "glsl-es" { "precision highp float;\nprecision highp int;" } else { "" };
                let ends = if version.contains("450") { ["layout(location = 0) "; 2] } else { [""; 2] };
                let [call, _] = calls_of(lit_by);
                let whole = format!(
                    "{version}\n{precision}\n{functions}\n{}in vec2 place;\n{}out vec4 colour;\nvoid main() {{{call}}}\n",
                    ends[0], ends[1]
                );
                fs::write(folder.path().join("whole.frag"), whole).expect("a file");
                let args: Vec<&str> = args.iter().copied().chain(["whole.frag"]).collect();
                let Some(output) = checked("glslang-tools", "glslangValidator", &args, folder.path()) else { return };
                assert_sound(&output);
            }
        }
    }
}
