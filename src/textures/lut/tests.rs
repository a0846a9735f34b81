use super::*;
use ltcforge_files::{
    recipe_document::{AnyRecipe, parse_any},
    tabulated::no_files,
};
use ltcforge_fit::{
    BrdfKind,
    albedo::{DfgForm, LutResolution},
};

fn fitted(document: &str) -> LutFile {
    let Ok(AnyRecipe::Lut(recipe)) = parse_any(document.as_bytes(), 10_000, &no_files) else { panic!("a recipe") };
    LutFile { recipe, lut: fit_lut(&LutPlan::new(&recipe), &|_| Continue(())).expect("nothing stops it") }
}

/// The numbers of three.js 0.185 at some texels `[roughness, cosine]`, from its `DFGLUTData.js`.
const THREE: [([usize; 2], [u16; 2]); 4] = [
    ([4, 15], [0x3bf2, 0x00fd]),
    ([8, 8], [0x3a93, 0x243a]),
    ([12, 4], [0x3987, 0x2580]),
    ([14, 14], [0x36d5, 0x0af0]),
];

#[test]
fn the_array_of_three_has_its_axes_channels_and_format() {
    let of = fitted(r#"{"table": "dfg", "resolution": {"roughness": 16, "cos_theta": 16}}"#);
    let bundle = LutExport::Engine(LutEngine::Three).bundle(&of, Digest::of(b"")).expect("files");
    assert_eq!(
        bundle.files.iter().map(|file| file.path.as_str()).collect::<Vec<_>>(),
        ["DFGLUTData.js", "ltcforge.json"]
    );
    let text = std::str::from_utf8(&bundle.files[0].bytes).expect("text");
    let array = text.split("new Uint16Array( [").nth(1).and_then(|rest| rest.split("] )").next()).expect("an array");
    let halves: Vec<u16> = array.split(',').filter_map(|word| word.trim().parse().ok()).collect();
    assert_eq!(halves.len(), 512);
    for ([rough, view], expected) in THREE {
        for (channel, expected) in expected.into_iter().enumerate() {
            let [found, expected] =
                [halves[2 * (16 * view + rough) + channel], expected].map(|bits| half::f16::from_bits(bits).to_f32());
            // The texels are solved for the filter, so they differ a little from values at texel centres.
            assert!((found - expected).abs() < 0.004, "{rough} {view} {channel}: {found}, not {expected}");
        }
    }
}

#[test]
fn the_table_of_three_has_at_most_half_of_the_error() {
    let of = fitted(r#"{"table": "dfg", "resolution": {"roughness": 16, "cos_theta": 16}}"#);
    let recipe = LutExport::Engine(LutEngine::Three).recipe(&of.recipe).expect("a recipe");
    let ours = MeasuredLut::new(&recipe).error(&super::fitted(&recipe).texels);
    // The two smoothest texels of the lowest view in DFGLUTData.js. At cosine .01 the filter reads nothing else.
    let [smooth, rough] = [0x30b5, 0x314c].map(|bits| f64::from(half::f16::from_bits(bits).to_f32()));
    let alpha: f64 = 0.002;
    let theirs = smooth + (rough - smooth) * (16.0 * alpha.sqrt() - 0.5) - recipe.truth(&[alpha, 0.01])[0];
    assert!((theirs - 0.0962).abs() < 1e-4 && ours.max < 0.5 * theirs, "{ours:?}, {theirs}");
}

#[test]
fn three_axes_make_a_volume_and_four_axes_make_a_volume_of_rows() {
    for (table, axes, size) in [
        ("transmission", r#"{"ior": 2, "roughness": 3, "cos_theta": 4}"#, [4, 3, 2]),
        ("anisotropic_dfg", r#"{"alpha": 2, "ratio": 3, "theta": 4, "phi": 5}"#, [5, 12, 2]),
    ] {
        let of = fitted(&format!(r#"{{"table": "{table}", "resolution": {axes}}}"#));
        for export in LutExport::all(&of.recipe) {
            let LutExport::Textures { container, precision } = export else { panic!("{table} has {export}") };
            // Not by `bundle`, which measures the table each time.
            let bundle = plain(container, precision, &of.recipe, &of.lut, &About::default());
            let files = bundle.unwrap_or_else(|error| panic!("{export}: {error}")).files;
            if export.to_string() == "ktx2.f16" {
                let word = |at: usize| u32::from_le_bytes(files[0].bytes[at..at + 4].try_into().expect("four bytes"));
                // VK_FORMAT_R16G16_SFLOAT, width, height, depth.
                assert_eq!((word(12), [word(20), word(24), word(28)]), (83, size), "{table}");
            }
        }
        let refused = LutExport::Png.bundle(&of, Digest::of(b"")).expect_err("no picture").to_string();
        assert!(refused.starts_with(&format!("png has no file of table {table}; no engine")), "{refused}");
    }
}

#[test]
fn bevy_gets_a_ktx2_file_with_two_halves_and_the_cosine_along_x() {
    let of = fitted(r#"{"table": "dfg", "resolution": {"roughness": 8, "cos_theta": 16}}"#);
    let bundle = LutExport::Engine(LutEngine::Bevy).bundle(&of, Digest::of(b"")).expect("files");
    let bytes = &bundle.files[0].bytes;
    let word = |at: usize| u32::from_le_bytes(bytes[at..at + 4].try_into().expect("four bytes"));
    // VK_FORMAT_R16G16_SFLOAT, width, height.
    assert_eq!((bundle.files[0].path.as_str(), word(12), word(20), word(24)), ("dfg.ktx2", 83, 16, 8));
}

#[test]
fn an_albedo_table_has_two_textures_and_other_engines_are_refused() {
    let of = fitted(r#"{"table": "albedo", "resolution": {"roughness": 4, "cos_theta": 4}}"#);
    let export: LutExport = "npy.f32".parse().expect("an export");
    let bundle = export.bundle(&of, Digest::of(b"")).expect("files");
    let paths: Vec<&str> = bundle.files.iter().map(|file| file.path.as_str()).collect();
    assert_eq!(paths, ["albedo.npy", "average.npy", "ltcforge.json"]);
    let refused = LutExport::Engine(LutEngine::Three).bundle(&of, Digest::of(b"")).expect_err("no such table");
    assert!(
        refused
            .to_string()
            .starts_with("three has no file of table albedo; no engine export has one; use a container: png, "),
        "{refused}"
    );
    assert!("ktx2.f8".parse::<LutExport>().is_err());
    assert!(LutExport::all(&of.recipe).all(|export| export.to_string().parse() == Ok(export)));
}

/// Pixels of an 8-bit PNG.
fn pixels(bytes: &[u8]) -> (u32, Vec<u8>) {
    let mut reader = png::Decoder::new(std::io::Cursor::new(bytes)).read_info().expect("a PNG");
    let mut pixels = vec![0; reader.output_buffer_size().expect("a size")];
    let info = reader.next_frame(&mut pixels).expect("pixels");
    (info.width, pixels)
}

#[test]
fn every_engine_gets_its_size_channels_and_format() {
    /// Fewer texels take less time.
    const N: usize = 8;
    let of = fitted(r#"{"table": "dfg", "resolution": {"roughness": 16, "cos_theta": 16}}"#).recipe;
    for (engine, path, size) in [
        (LutEngine::Babylon, "environmentBRDF.png", 256),
        (LutEngine::Godot, "dfg_lut.dds", 128),
        (LutEngine::Filament, "dfg.inc", 128),
        (LutEngine::Hdrp, "PreIntegratedFGD_GGXDisneyDiffuse.dds", 64),
        (LutEngine::GltfSampleViewer, "lut_ggx.png", 16),
        (LutEngine::Blender, "brdf_ggx.inc", 64),
    ] {
        let recipe = engine.recipe(&of).expect("the engine has this table");
        assert_eq!(recipe.resolution.texels(), [size; 2], "{engine}");
        let recipe = LutRecipe { resolution: LutResolution::new(recipe.table, |_| N as u32), ..recipe };
        let bundle = engine.bundle(&recipe, super::fitted(&recipe), &About::default()).expect("files");
        let bytes = &bundle.files[0].bytes;
        assert_eq!(bundle.files[0].path, path);
        assert!(!bundle.steps.is_empty());
        let text = || std::str::from_utf8(bytes).expect("text");
        // Bias, albedo and third channel of the texel at a column of the cosine and a row of roughness.
        let found = |column: usize, row: usize| -> [f64; 3] {
            match engine {
                LutEngine::Babylon => {
                    let (width, pixels) = pixels(bytes);
                    let texel = &pixels[4 * (row * N + column)..][..4];
                    assert_eq!((width as usize, pixels.len()), (N, 4 * N * N));
                    [0, 1, 2].map(|i| (f64::from(texel[i]) / 255.0).powf(2.2) * 255.0 / f64::from(texel[3]))
                }
                LutEngine::Godot => {
                    let half = |i: usize| {
                        let at = 148 + 8 * ((N - 1 - row) * N + column) + 2 * i;
                        f64::from(half::f16::from_le_bytes([bytes[at], bytes[at + 1]]))
                    };
                    assert_eq!((bytes.len(), half(3)), (148 + N * N * 8, 1.0));
                    [half(0), half(1), half(2)]
                }
                LutEngine::Filament => {
                    let words: Vec<&str> = text().split(|c: char| !c.is_alphanumeric()).collect();
                    let halves: Vec<u16> = words
                        .iter()
                        .filter_map(|word| u16::from_str_radix(word.strip_prefix("0x")?, 16).ok())
                        .collect();
                    assert_eq!(halves.len(), 3 * N * N);
                    [0, 1, 2].map(|i| f64::from(half::f16::from_bits(halves[3 * (row * N + column) + i])))
                }
                LutEngine::Hdrp => {
                    assert_eq!(bytes.len(), 148 + N * N * 4);
                    let at = 148 + 4 * (row * N + column);
                    let word = u32::from_le_bytes(bytes[at..at + 4].try_into().expect("four bytes"));
                    assert_eq!(word >> 30, 3);
                    [0, 1, 2].map(|i| f64::from(word >> (10 * i) & 1023) / 1023.0)
                }
                LutEngine::GltfSampleViewer => {
                    let (width, pixels) = pixels(bytes);
                    let texel = &pixels[4 * (row * N + column)..][..4];
                    assert_eq!((width as usize, pixels.len(), texel[2], texel[3]), (N, 4 * N * N, 0, 255));
                    let [scale, bias] = [0, 1].map(|i| f64::from(texel[i]) / 255.0);
                    [bias, scale + bias, 0.0]
                }
                _ => {
                    assert!(text().contains("const float brdf_ggx[8][8][3] = {\n    {{"));
                    let numbers: Vec<f64> = text()
                        .split(['{', '}', ',', ' ', '\n'])
                        .filter_map(|word| word.strip_suffix('f')?.parse().ok())
                        .collect();
                    assert_eq!(numbers.len(), 3 * N * N);
                    // Roughness is along x.
                    let at = 3 * (column * N + row);
                    [numbers[at + 1], numbers[at] + numbers[at + 1], numbers[at + 2]]
                }
            }
        };
        for (column, row) in [(5, 3), (0, N - 1), (2, N - 1), (N - 1, N - 1), (3, N / 2)] {
            let [x, y] = [column, row].map(|texel| recipe.texels().parameter(texel, N));
            let cosine = match engine {
                LutEngine::Hdrp => x * x,
                LutEngine::Blender => 1.0 - x * x,
                _ => x,
            };
            let place = [y * y, cosine];
            let [bias, albedo, _] = LutRecipe { form: Some(DfgForm::Filament), ..of }.truth(&place);
            let third = |table, brdf| LutRecipe { table, brdf, form: None, ..of }.truth(&place)[0];
            let third = match engine {
                LutEngine::Babylon | LutEngine::Godot | LutEngine::Filament => {
                    third(LutKind::Sheen, BrdfKind::CharlieNeubelt)
                }
                LutEngine::Hdrp => (third(LutKind::Diffuse, BrdfKind::BurleyDiffuse) / 1.035_71 - 0.5).min(1.0),
                LutEngine::Blender => LutRecipe { form: Some(DfgForm::F82), ..of }.truth(&place)[2],
                _ => 0.0,
            };
            let found = found(column, row);
            let errors = [found[0] - bias, found[1] - albedo, found[2] - third];
            // The texels are solved for the filter, so they differ from values at texel centres, most at edges.
            let most = match column {
                0 => [0.08; 3],
                5 => [0.01, 0.015, 0.01],
                _ => [0.08, 0.08, 0.015],
            };
            assert!(
                errors.iter().zip(most).all(|(error, most)| error.abs() < most),
                "{engine}, column {column}, row {row}: {found:?}, errors {errors:?}"
            );
        }
    }
}

/// A sheen above 1 would leave few steps to the other channels.
#[test]
fn babylon_keeps_its_divisor_high() {
    let of = fitted(r#"{"table": "dfg", "resolution": {"roughness": 2, "cos_theta": 2}}"#).recipe;
    let recipe = LutEngine::Babylon.recipe(&of).expect("a recipe");
    let resolution = LutResolution::new(recipe.table, |axis| if axis == "roughness" { 8 } else { 64 });
    let recipe = LutRecipe { resolution, ..recipe };
    let bundle = LutEngine::Babylon.bundle(&recipe, super::fitted(&recipe), &About::default()).expect("files");
    let (_, pixels) = pixels(&bundle.files[0].bytes);
    let least = pixels.iter().skip(3).step_by(4).min().copied();
    assert!(least >= Some(250), "{least:?}");
}

#[test]
fn an_engine_without_lookup_tables_is_named_with_the_others() {
    let refused = "playcanvas".parse::<LutExport>().expect_err("no table").to_string();
    assert!(refused.starts_with("lookup tables have no export «playcanvas»; engines: "), "{refused}");
    assert!(refused.contains("three, babylon, bevy, godot, filament, hdrp, gltf-sample-viewer, blender"), "{refused}");
    let of = fitted(r#"{"table": "dfg", "precision": "rgba8", "resolution": {"roughness": 4, "cos_theta": 4}}"#);
    let bundle = LutExport::Png.bundle(&of, Digest::of(b"")).expect("files");
    let (width, pixels) = pixels(&bundle.files[0].bytes);
    assert_eq!((width, pixels.len()), (4, 48));
    assert_eq!(f32::from(pixels[0]) / 255.0, of.lut.texels[0]);
}
