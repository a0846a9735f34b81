use super::*;
use ltcforge_files::{
    recipe_document::{AnyRecipe, parse_any},
    tabulated::no_files,
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
            let bundle = export.bundle(&of, Digest::of(b"")).unwrap_or_else(|error| panic!("{export}: {error}"));
            if export.to_string() == "ktx2.f16" {
                let bytes = &bundle.files[0].bytes;
                let word = |at: usize| u32::from_le_bytes(bytes[at..at + 4].try_into().expect("four bytes"));
                // VK_FORMAT_R16G16_SFLOAT, width, height, depth.
                assert_eq!((word(12), [word(20), word(24), word(28)]), (83, size), "{table}");
            }
        }
        let refused = LutExport::Png.bundle(&of, Digest::of(b"")).expect_err("no picture").to_string();
        assert!(refused.starts_with("a picture has two axes, and table"), "{refused}");
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
        refused.to_string().starts_with("three loads no file of table albedo; engines that load such a table: none"),
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
    let of = fitted(r#"{"table": "dfg", "resolution": {"roughness": 16, "cos_theta": 16}}"#);
    for (engine, path) in [
        (LutEngine::Godot, "dfg_lut.dds"),
        (LutEngine::Filament, "dfg.inc"),
        (LutEngine::Hdrp, "PreIntegratedFGD_GGXDisneyDiffuse.dds"),
        (LutEngine::GltfSampleViewer, "lut_ggx.png"),
        (LutEngine::Blender, "brdf_ggx.inc"),
    ] {
        let bundle = LutExport::Engine(engine).bundle(&of, Digest::of(b"")).expect("files");
        let bytes = &bundle.files[0].bytes;
        assert_eq!(bundle.files[0].path, path);
        let text = || std::str::from_utf8(bytes).expect("text");
        let [total, bias, _] = ltcforge_values(0.25, 0.5);
        // The numbers of the texel at perceptual roughness 1/2 and cosine 1/2, in the engine's order.
        let found: Vec<f64> = match engine {
            LutEngine::Godot => {
                let half = |i: usize| {
                    let at = 148 + 8 * (63 * 128 + 64) + 2 * i;
                    f64::from(half::f16::from_le_bytes([bytes[at], bytes[at + 1]]))
                };
                assert_eq!((bytes.len(), half(3)), (148 + 128 * 128 * 8, 1.0));
                (0..2).map(half).collect()
            }
            LutEngine::Filament => {
                let words: Vec<&str> = text().split(|c: char| !c.is_alphanumeric()).collect();
                let halves: Vec<u16> =
                    words.iter().filter_map(|word| u16::from_str_radix(word.strip_prefix("0x")?, 16).ok()).collect();
                assert_eq!(halves.len(), 128 * 128 * 3);
                (0..2).map(|i| f64::from(half::f16::from_bits(halves[3 * (64 * 128 + 64) + i]))).collect()
            }
            LutEngine::Hdrp => {
                assert_eq!(bytes.len(), 148 + 64 * 64 * 4);
                // The texel nearest to the root of 1/2.
                let at = 148 + 4 * (32 * 64 + 45);
                let word = u32::from_le_bytes(bytes[at..at + 4].try_into().expect("four bytes"));
                assert_eq!(word >> 30, 3);
                (0..2).map(|i| f64::from(word >> (10 * i) & 1023) / 1023.0).collect()
            }
            LutEngine::GltfSampleViewer => {
                let (width, pixels) = pixels(bytes);
                let at = 4 * (8 * 16 + 8);
                assert_eq!((width, pixels.len(), pixels[at + 2], pixels[at + 3]), (16, 1024, 0, 255));
                let [scale, bias] = [0, 1].map(|i| f64::from(pixels[at + i]) / 255.0);
                vec![bias, scale + bias]
            }
            _ => {
                assert!(text().contains("const float brdf_ggx[64][64][3] = {\n    {{"));
                let numbers: Vec<f64> = text()
                    .split(['{', '}', ',', ' ', '\n'])
                    .filter_map(|word| word.strip_suffix('f')?.parse().ok())
                    .collect();
                assert_eq!(numbers.len(), 64 * 64 * 3);
                // sqrt(1 - 1/2) along y, roughness along x.
                let at = 3 * (45 * 64 + 32);
                vec![numbers[at + 1], numbers[at] + numbers[at + 1]]
            }
        };
        // These texels are not exactly at the place.
        assert!((found[0] - bias).abs() < 0.012 && (found[1] - total).abs() < 0.025, "{engine}: {found:?}");
        assert!(!bundle.steps.is_empty());
    }
}

/// Albedo and bias.
fn ltcforge_values(alpha: f64, cosine: f64) -> [f64; 3] {
    let document = r#"{"table": "dfg", "form": "filament", "resolution": {"roughness": 2, "cos_theta": 2}}"#;
    let [bias, total, _] = fitted(document).recipe.truth(&[alpha, cosine]);
    [total, bias, 0.0]
}

#[test]
fn an_engine_without_lookup_tables_is_named_with_the_others() {
    let refused = "playcanvas".parse::<LutExport>().expect_err("no table").to_string();
    assert!(refused.starts_with("playcanvas loads no lookup table; engines that do: "), "{refused}");
    assert!(refused.contains("three, babylon, bevy, godot, filament, hdrp, gltf-sample-viewer, blender"), "{refused}");
    let of = fitted(r#"{"table": "dfg", "precision": "rgba8", "resolution": {"roughness": 4, "cos_theta": 4}}"#);
    let bundle = LutExport::Png.bundle(&of, Digest::of(b"")).expect("files");
    let (width, pixels) = pixels(&bundle.files[0].bytes);
    assert_eq!((width, pixels.len()), (4, 48));
    assert_eq!(f32::from(pixels[0]) / 255.0, of.lut.texels[0]);
}
