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
    let bundle = LutExport::Engine(Engine::Three).bundle(&of, Digest::of(b"")).expect("files");
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
fn bevy_gets_a_ktx2_file_with_two_halves_and_the_cosine_along_x() {
    let of = fitted(r#"{"table": "dfg", "resolution": {"roughness": 8, "cos_theta": 16}}"#);
    let bundle = LutExport::Engine(Engine::Bevy).bundle(&of, Digest::of(b"")).expect("files");
    let bytes = &bundle.files[0].bytes;
    let word = |at: usize| u32::from_le_bytes(bytes[at..at + 4].try_into().expect("four bytes"));
    // VK_FORMAT_R16G16_SFLOAT, width, height.
    assert_eq!((bundle.files[0].path.as_str(), word(12), word(20), word(24)), ("dfg.ktx2", 83, 16, 8));
    assert_eq!(LutExport::Engine(Engine::Bevy).recipe(&of.recipe).expect("a recipe").axes, AXES);
}

#[test]
fn an_albedo_table_has_two_textures_and_other_engines_are_refused() {
    let of = fitted(r#"{"table": "albedo", "resolution": {"roughness": 4, "cos_theta": 4}}"#);
    let export: LutExport = "npy.f32".parse().expect("an export");
    let bundle = export.bundle(&of, Digest::of(b"")).expect("files");
    let paths: Vec<&str> = bundle.files.iter().map(|file| file.path.as_str()).collect();
    assert_eq!(paths, ["albedo.npy", "average.npy", "ltcforge.json"]);
    let refused = LutExport::Engine(Engine::Three).bundle(&of, Digest::of(b"")).expect_err("no such table");
    assert!(
        refused
            .to_string()
            .starts_with("three loads no file of table albedo; engines that load a dfg table: three, bevy"),
        "{refused}"
    );
    assert!("ktx2.f8".parse::<LutExport>().is_err());
    assert!(LutExport::all(&of.recipe).all(|export| export.to_string().parse() == Ok(export)));
}
