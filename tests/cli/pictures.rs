//! Commands that render pictures and translate shaders.

use std::{fs, path::Path};

use serde_json::Value;

use crate::common::{
    SMALL,
    command::{ltcforge, run, run_with_stdin},
};

#[test]
fn preview_writes_a_picture_and_names_the_renderer() {
    let folder = tempfile::tempdir().expect("a folder");
    let fitted = run_with_stdin(folder.path(), ["fit", "-"], SMALL).exited(0);
    let beginning = &fitted.last_line()[..16];
    let arguments = ["preview", beginning, "-o", "p.png", "--size", "64", "--spp", "2", "--adapter", "cpu"];
    let output = run(folder.path(), arguments.iter().chain(&["--mode", "strip", "--scene", "figure14"])).exited(0);
    assert!(output.stderr.starts_with("adapter: cpu\n"), "{output:#?}");
    assert_eq!(output.stderr.matches("mean absolute error").count(), 4);
    let file = fs::read(folder.path().join("p.png")).expect("the picture");
    assert!(file.starts_with(b"\x89PNG\r\n"));

    // One material replaces the scene's four materials.
    let one = ["--mode", "difference", "--scene", "figure14", "--alpha-x", "0.2", "--json"];
    let output = run(folder.path(), arguments.iter().chain(&one)).exited(0);
    let output: Value = serde_json::from_str(&output.stdout).expect("JSON");
    assert_eq!(output["errors"].as_array().map(Vec::len), Some(1));
    assert_eq!((&output["adapter"], &output["errors"][0]["alpha_x"]), (&"cpu".into(), &0.2.into()));

    let refused =
        run(folder.path(), arguments.iter().chain(&["--alpha-y", "2", "--light-centre", "-1,0,200"])).exited(2);
    assert_eq!(
        refused.complaints(),
        ["alpha_y must be between 0 and 1, got 2", "light_centre must be between -100 and 100, got 200"]
    );
}

/// A picture of one colour lights like no picture. Lights that cannot have a picture are rejected, with all errors at
/// once.
#[test]
fn preview_shows_a_picture_on_the_light() {
    let folder = tempfile::tempdir().expect("a folder");
    let fitted = run_with_stdin(folder.path(), ["fit", "-"], SMALL).exited(0);
    let table = &fitted.last_line()[..16];
    let preview = |more: &[&str]| {
        let usual = ["preview", table, "--size", "64", "--spp", "16", "--adapter", "cpu", "-o", "p.png"];
        run(folder.path(), usual.iter().chain(more))
    };
    let radiance = |more: &[&str]| {
        let output: Value =
            serde_json::from_str(&preview(&[more, &["--json"]].concat()).exited(0).stdout).expect("JSON");
        let errors = output["errors"].as_array().expect("errors").clone();
        let of = |name: &'static str| errors.iter().map(move |error| error[name].as_f64().expect("a number"));
        (of("mean_radiance").sum::<f64>(), of("mean_absolute_error").sum::<f64>())
    };
    write_png(folder.path(), "white.png", [255; 3]);
    write_png(folder.path(), "red.png", [255, 0, 0]);
    let even = radiance(&["--mode", "models"]);
    let white = radiance(&["--mode", "models", "--light-texture", "white.png"]);
    assert!((even.0 - white.0).abs() < 1e-5 && (even.1 - white.1).abs() < 1e-4, "{even:?} {white:?}");
    let red = radiance(&["--mode", "models", "--light-texture", "red.png", "--light-readings", "2"]);
    // The grey background is visible at the rim of the sphere.
    assert!((even.0 - 3.0 * red.0).abs() < 0.02 * even.0, "{even:?} {red:?}");
    let screen = radiance(&["--mode", "models", "--scene", "screen"]);
    assert!(screen.1 < 0.5 * screen.0, "{screen:?}");

    let refused = preview(&["--scene", "screen", "--light", "disk", "--model", "asg", "--exposure", "0"]).exited(2);
    assert_eq!(
        refused.complaints(),
        [
            "exposure must be between 0.0001 and 10000, got 0",
            "light_picture needs light rectangle, got disk: change the light or leave the picture out",
            "light_picture works with models normals, ltc and ltc-formula, not asg: change the model or leave the picture out",
        ]
    );
    fs::write(folder.path().join("no.png"), "no picture").expect("a file");
    assert!(
        preview(&["--light-texture", "no.png"]).exited(1).stderr.contains("no.png: this file is not a readable image")
    );
    let both = preview(&["--light-texture", "red.png", "--light-picture", "window"]).exited(2);
    assert!(both.stderr.contains("--light-texture") && both.stderr.contains("--light-picture"), "{}", both.stderr);
}

/// A picture of 8 x 6 pixels of one colour.
fn write_png(folder: &Path, name: &str, colour: [u8; 3]) {
    let file = fs::File::create(folder.join(name)).expect("a file");
    let mut encoder = png::Encoder::new(file, 8, 6);
    encoder.set_color(png::ColorType::Rgb);
    let pixels = colour.repeat(8 * 6);
    encoder.write_header().and_then(|mut writer| writer.write_image_data(&pixels)).expect("a picture");
}

/// A table is compared with its own scattering model. Comparisons with models that only support GGX are rejected.
#[test]
fn a_table_of_another_scattering_model_is_compared_with_this_model() {
    let folder = tempfile::tempdir().expect("a folder");
    let recipe = r#"{"brdf": "charlie", "resolution": {"alpha": 4, "theta": 4}, "fit": {"samples": 64, "directions": 6, "steps": 20}}"#;
    let fitted = run_with_stdin(folder.path(), ["fit", "-"], recipe).exited(0);
    let table = &fitted.last_line()[..16];
    let preview = |more: &[&str]| {
        let arguments = ["preview", table, "-o", "p.png", "--size", "64", "--spp", "64", "--f0", "1,1,1"];
        let material = ["--alpha-x", "0.5", "--alpha-y", "0.5"];
        run(folder.path(), arguments.iter().chain(&material).chain(more))
    };
    let output = preview(&["--mode", "strip", "--json"]).exited(0);
    let output: Value = serde_json::from_str(&output.stdout).expect("JSON");
    let of = |name: &str| output["errors"][0][name].as_f64().expect("a number");
    assert_eq!(output["adapter"], "cpu");
    assert!(of("mean_absolute_error") < 0.3 * of("mean_radiance") && of("mean_radiance") > 0.0, "{output}");
    for refused in [
        &["--model", "normals", "--mode", "strip"][..],
        &["--mode", "models"],
        &["--model", "asg"],
        &["--mode", "reference", "--adapter", "gpu"],
        &["--ggx-terms"],
    ] {
        let refused = preview(refused).exited(2);
        assert!(refused.complaints().len() == 1 && refused.stderr.contains("brdf charlie"), "{refused:#?}");
    }

    let lights = "0.5,0.5,0.7,0.3,2,-1,-1,2,-1,1,2,1,1,2,1,-1,2\n";
    let light = |more: &[&str]| {
        run_with_stdin(folder.path(), ["light", "-", "--model", "ltc", "--table", table].iter().chain(more), lights)
    };
    assert!(light(&[]).exited(0).stdout.lines().count() == 2);
    let output = light(&["--truth", "--json"]).exited(0);
    let output: Value = serde_json::from_str(&output.stdout).expect("JSON");
    let [by_table, truth] = ["energy", "true_energy"].map(|name| output[name].as_f64().expect("a number"));
    assert!(truth > 0.01 && by_table != truth && (by_table - truth).abs() < 0.3 * truth, "{output}");
    let tradeoff = run_with_stdin(folder.path(), ["tradeoff", "--recipe", "-", "--quick", "-o", "."], recipe).exited(2);
    assert!(tradeoff.stderr.contains("/brdf: ") && tradeoff.stderr.contains("got charlie"), "{tradeoff:#?}");

    // Normally distributed slopes have shorter tails than an LTC.
    let recipe = SMALL.replacen('{', r#"{"brdf": "beckmann","#, 1);
    let beckmann = run_with_stdin(folder.path(), ["fit", "-"], &recipe).exited(0);
    let output = run(folder.path(), ["report", &beckmann.last_line()[..16], "--points", "16"]).exited(0);
    assert!(output.stdout.contains("where an LTC models the lobe poorly"), "{output:#?}");
}

/// Without a Vulkan driver, only the renderer changes.
#[test]
fn preview_without_a_vulkan_driver_renders_on_the_cpu() {
    let folder = tempfile::tempdir().expect("a folder");
    let fitted = run_with_stdin(folder.path(), ["fit", "-"], SMALL).exited(0);
    let hide = |adapter: &str| {
        let arguments = ["preview", &fitted.last_line()[..16], "-o", "p.png", "--size", "64", "--adapter", adapter];
        let mut command = ltcforge(folder.path(), arguments);
        command.envs(["VK_DRIVER_FILES", "VK_ICD_FILENAMES"].map(|name| (name, "/nowhere.json")));
        crate::common::command::Run::from(command.output().expect("the binary runs"))
    };
    let output = hide("any").exited(0);
    assert!(output.stderr.contains("adapter: cpu\n"), "{output:#?}");
    assert!(hide("gpu").exited(1).stderr.contains("no adapter"));
}

/// The closed form lights without a table. A picture that shows a table needs one.
#[test]
fn a_picture_of_model_normals_needs_no_table() {
    let folder = tempfile::tempdir().expect("a folder");
    let preview = |more: &[&str]| {
        let arguments = ["preview", "--size", "64", "--spp", "16", "--adapter", "cpu", "-o", "p.png"];
        run(folder.path(), arguments.iter().chain(more))
    };
    let output = preview(&["--model", "normals", "--mode", "strip", "--json"]).exited(0);
    let output: Value = serde_json::from_str(&output.stdout).expect("JSON");
    assert_eq!((&output["table"], &output["errors"][0]["model"]), (&Value::Null, &"normals".into()));
    let error = output["errors"][0]["mean_absolute_error"].as_f64().expect("a number");
    assert!(error < 0.02, "{error}");
    for model in ["sg", "asg", "ltc-formula"] {
        let output = preview(&["--model", model, "--mode", "strip", "--json"]).exited(0);
        let output: Value = serde_json::from_str(&output.stdout).expect("JSON");
        let error = output["errors"][0]["mean_absolute_error"].as_f64().expect("a number");
        assert!(output["errors"][0]["model"] == model && error > 1e-3 && error < 0.1, "{output}");
    }
    for shows_a_table in [&["--model", "ltc"][..], &["--mode", "models"], &["--mode", "lobe", "--model", "normals"]] {
        assert!(preview(shows_a_table).exited(2).stderr.contains("needs a table"), "{shows_a_table:?}");
    }
}

#[test]
fn shader_is_written_in_each_language_to_a_file_or_to_standard_output() {
    let folder = tempfile::tempdir().expect("a folder");
    for language in ["wgsl", "glsl", "glsl-es", "hlsl", "msl", "spirv"] {
        for layout in ["reflected", "kt2022"] {
            let arguments = ["shader", "--as", "example", "--language", language, "--layout", layout];
            let output = run(folder.path(), arguments.iter().chain(&["-o", "s", "--json"])).exited(0);
            let output: Value = serde_json::from_str(&output.stdout).expect("JSON");
            let file = fs::read(folder.path().join("s")).expect("the shader");
            assert_eq!((&output["language"], &output["layout"]), (&language.into(), &layout.into()));
            assert_eq!(output["bytes"], file.len());
            let start: &[u8] = match language {
                "spirv" => b"\x03\x02\x23\x07",
                "glsl" => b"#version 450 core\n// SPDX-License-Identifier",
                "glsl-es" => b"#version 310 es\n// SPDX-License-Identifier",
                _ => b"// SPDX-License-Identifier",
            };
            assert!(file.starts_with(start), "{language}");
            let output = ltcforge(folder.path(), arguments).output().expect("the binary runs");
            assert!(output.status.success() && output.stdout == file, "{language}");
        }
    }
    let normals = ["shader", "--language", "hlsl", "--model", "normals", "--json"];
    let output: Value = serde_json::from_str(&run(folder.path(), normals).exited(0).stdout).expect("JSON");
    assert_eq!((&output["model"], &output["layout"]), (&"normals".into(), &Value::Null));
    assert!(output["source"].as_str().expect("text").contains("normals_polygon("));
    let texts = ["sg", "asg"].map(|model| {
        let arguments = ["shader", "--language", "glsl-es", "--model", model, "--json"];
        let output: Value = serde_json::from_str(&run(folder.path(), arguments).exited(0).stdout).expect("JSON");
        assert_eq!((&output["model"], &output["layout"]), (&model.into(), &Value::Null));
        output["source"].as_str().expect("text").to_owned()
    });
    assert!(texts[0].contains("gaussians_polygon(") && texts[0] == texts[1]);
    assert!(run(folder.path(), ["shader", "--language", "hlsl"]).exited(2).stderr.contains("--layout"));
    let both = ["shader", "--language", "hlsl", "--model", "normals", "--layout", "kt2022"];
    assert!(run(folder.path(), both).exited(2).stderr.contains("reads no table"));
    let wgsl = ["shader", "--language", "wgsl", "--layout", "kt2022", "--json"];
    let output: Value = serde_json::from_str(&run(folder.path(), wgsl).exited(0).stdout).expect("JSON");
    let text = output["source"].as_str().expect("text");
    assert!(text.contains("fn ltc_lookup(") && text.contains("fn ltc_tube("));
    let [all, polygons] = ["all", "polygons"]
        .map(|lights| run(folder.path(), wgsl[..5].iter().chain(&["--lights", lights])).exited(0).stdout);
    assert!(all == text && polygons.contains("fn ltc_polygon(") && !polygons.contains("ltc_tube"));
}

#[test]
fn a_shader_is_written_as_a_module_with_its_types() {
    let folder = tempfile::tempdir().expect("a folder");
    let read = |file: &str| fs::read_to_string(folder.path().join(file)).expect("a file");
    for (file, types) in [("normals.js", "normals.d.ts"), ("normals.glsl.mjs", "normals.glsl.d.mts")] {
        let arguments = ["shader", "--language", "glsl-es", "--model", "normals"];
        let text = run(folder.path(), arguments).exited(0).stdout;
        let module = ["--es-module", "--json", "-o", file];
        let output = run(folder.path(), arguments.iter().chain(&module)).exited(0).stdout;
        let output: Value = serde_json::from_str(&output).expect("JSON");
        assert_eq!((&output["file"], &output["declarations"]), (&file.into(), &types.into()));
        assert_eq!(read(file), format!("export default /* glsl */ `{text}`;\n"));
        assert!(read(types).ends_with("declare const text: string;\nexport default text;\n"));
    }
    let spirv = ["shader", "--language", "spirv", "--model", "sg", "--as", "example", "--es-module", "-o", "sg.js"];
    let refused = run(folder.path(), spirv).exited(2).stderr;
    assert!(refused.contains("--es-module") && refused.contains("binary"), "{refused}");
    let refused = run(folder.path(), ["shader", "--language", "wgsl", "--model", "sg", "--es-module"]).exited(2).stderr;
    assert!(refused.contains("-o NAME.js"), "{refused}");
}

#[test]
fn shader_rejects_unknown_arguments_and_spirv_without_an_output_file() {
    let folder = tempfile::tempdir().expect("a folder");
    let cases: [&[&str]; 20] = [
        &["--language", "glsl", "--model", "sg", "--es-module"],
        &["--language", "glsl", "--model", "sg", "--es-module", "-o", "sg.glsl"],
        &["--language", "glsl", "--model", "sg", "--es-module", "-o", ".js"],
        &["--language", "spirv", "--model", "sg", "--as", "example", "--es-module", "-o", "sg.js"],
        &["--language", "glsl", "--model", "sg", "--hardware-filter"],
        &["--language", "glsl", "--model", "normals", "--texture-array"],
        &["--language", "glsl", "--layout", "kt2022", "--texture-array", "--as", "example"],
        &["--language", "glsl", "--model", "asg", "--layout", "ltc2017"],
        &["--language", "cg", "--layout", "kt2022"],
        &["--language", "wgsl", "--layout", "square"],
        &["--language", "spirv", "--layout", "kt2022"],
        &["--language", "glsl-330", "--layout", "kt2022", "--as", "example"],
        &["--language", "glsl", "--model", "normals", "--hardware-filter"],
        &["--language", "wgsl", "--layout", "kt2022", "--hardware-filter"],
        &["--language", "wgsl"],
        &["--layout", "kt2022"],
        &["--language", "spirv", "--layout", "kt2022", "--json"],
        &["--language", "glsl", "--layout", "kt2022", "--lights", "cubes"],
        &["--language", "glsl", "--layout", "kt2022", "--lights", "polygons", "--as", "example"],
        &["--language", "glsl", "--model", "normals", "--lights", "polygons"],
    ];
    for case in cases {
        let refused = run(folder.path(), ["shader"].iter().chain(case)).exited(2);
        assert!(refused.stdout.is_empty() && !refused.stderr.is_empty(), "{case:?}");
    }
    let nowhere = ["shader", "--language", "glsl", "--layout", "kt2022", "-o", "none/s.glsl"];
    assert!(run(folder.path(), nowhere).exited(1).stderr.contains("none/s.glsl"));
}

#[test]
fn plots_reject_parameters_that_they_do_not_have() {
    let folder = tempfile::tempdir().expect("a folder");
    for (arguments, output) in [
        (&["plot", "t.npy", "light", "-o", "x.png"][..], "light"),
        (&["plot", "t.npy", "matrix", "--ratio", "0.2", "-o", "x.png"], "--ratio"),
        (&["plot", "t.npy", "error", "--phi", "7", "-o", "x.png"], "azimuth"),
        (&["plot", "error", "-o", "x.png"], "<NAME>"),
        (&["report", "--model", "ltc"], "--model"),
    ] {
        let refused = run(folder.path(), arguments).exited(2);
        assert!(refused.stderr.contains(output), "{arguments:?}: {}", refused.stderr);
    }
}
