use std::process::Command;

use half::f16;
use serde_json::Value;

use super::*;
use crate::round;
use ltcforge_files::digest::Digest;
use ltcforge_fit::{BrdfKind, Layout, PerAxis, Precision, ShaderAxes};

/// The manifest.
const MANIFEST: &str = "ltcforge.json";

/// Two textures in which each number identifies its position.
fn textures(size: u32) -> Vec<Texture> {
    let texture = |name: &str, scale: f32| {
        let count = (size * size * 4) as usize;
        let texels = (0..count).map(|i| scale * (i as f32 + 1.0) / 7.0).collect();
        Texture::flat(name, [size, size], &["x", "y", "z", "w"], texels).expect("a texture")
    };
    vec![texture("LTC_1", 1.0), texture("LTC_2", -0.01)]
}

fn axes() -> ShaderAxes {
    let axes = PerAxis { alpha: vec![0.1, 1.0], ratio: vec![1.0], theta: vec![0.0, 0.5, 1.0], phi: vec![0.0] };
    Layout::Kt2022.shader_axes(&axes)
}

/// The textures for our own shader.
fn own() -> Vec<Texture> {
    let of = |name| Texture::new(name, [1, 3, 2], 1, &["a", "b", "c", "d"], vec![0.5; 24]).expect("a texture");
    ["ltc_matrix_a", "ltc_matrix_b", "ltc_terms"].map(of).into()
}

fn bundle(engine: Engine, size: u32) -> Bundle {
    let about = About::new(["table 1234"]);
    let (given, about) = match engine {
        Engine::Wgpu | Engine::WgpuHalf => (own(), about.for_shader(&axes())),
        _ => (textures(size), about),
    };
    engine.bundle(BrdfKind::Ggx, &given, &about).unwrap_or_else(|error| panic!("{engine}: {error}"))
}

fn bytes<'a>(bundle: &'a Bundle, path: &str) -> &'a [u8] {
    let file = bundle.files.iter().find(|file| file.path == path);
    &file.unwrap_or_else(|| panic!("no {path}")).bytes
}

fn text<'a>(bundle: &'a Bundle, path: &str) -> &'a str {
    std::str::from_utf8(bytes(bundle, path)).expect("text")
}

fn halves(name: usize) -> Vec<u16> {
    round(&textures(64)[name].texels, Precision::F16).half_bits().collect()
}

#[test]
fn each_bundle_has_steps_and_lists_its_files() {
    for engine in Engine::ALL {
        let bundle = bundle(*engine, 64);
        assert!(!bundle.steps.is_empty() && bundle.files.len() >= 2, "{engine}");
        // The service has URLs only for files in the top folder, and in one folder below it.
        assert!(bundle.files.iter().all(|file| file.path.split('/').count() <= 2), "{engine}");
        let manifest: Value = serde_json::from_str(text(&bundle, MANIFEST)).expect("JSON");
        let listed = manifest["files"].as_array().expect("files");
        assert_eq!(listed.len(), bundle.files.len() - 1, "{engine}");
        for (entry, file) in listed.iter().zip(&bundle.files) {
            assert_eq!(entry["path"], file.path);
            assert_eq!(entry["sha256"], Digest::of(&file.bytes).hex());
        }
        assert_eq!(manifest["for"], engine.name());
        assert_eq!(manifest["about"][0], "table 1234");
        assert_eq!(bundle, self::bundle(*engine, 64), "{engine}: the second bundle has different bytes");
    }
}

/// HDRP has one file per scattering model.
#[test]
fn hdrp_names_its_file_by_the_model() {
    for (brdf, name) in
        [(BrdfKind::Ggx, "GGX"), (BrdfKind::BurleyDiffuse, "Disney"), (BrdfKind::CharlieNeubelt, "Charlie")]
    {
        let bundle = Engine::Hdrp.bundle(brdf, &textures(64), &About::default()).expect("a bundle");
        let code = text(&bundle, &format!("LtcData.BRDF_{name}.cs"));
        assert!(code.contains(&format!("ushort[] s_LtcMatrixData_BRDF_{name} = new")), "{code:.300}");
        assert!(Engine::Hdrp.brdfs().contains(&brdf) && bundle.steps[1].contains(name), "{:?}", bundle.steps);
    }
    assert!(!Engine::Hdrp.brdfs().contains(&BrdfKind::OrenNayar) && Engine::Three.brdfs() == [BrdfKind::Ggx]);
}

#[test]
fn a_wrong_size_or_a_missing_texture_is_reported() {
    for engine in Engine::ALL {
        let about = About::default();
        assert!(engine.bundle(BrdfKind::Ggx, &[], &about).is_err(), "{engine}");
        if !matches!(engine, Engine::O3de | Engine::Wgpu | Engine::WgpuHalf) {
            let error = engine.bundle(BrdfKind::Ggx, &textures(32), &about).expect_err("a size").to_string();
            assert!(error.contains("64 x 64 texels and 4 channels") && error.contains("32 x 32 x 1"), "{error}");
        }
    }
}

#[test]
fn babylon_has_eight_halves_a_texel() {
    let bundle = bundle(Engine::Babylon, 64);
    let file = bytes(&bundle, "areaLights/areaLightsLTC.bin");
    assert_eq!(file.len(), 65_536);
    let words: Vec<u16> = file.as_chunks::<2>().0.iter().map(|word| u16::from_le_bytes(*word)).collect();
    let part = |first: usize| words.chunks(8).flat_map(|texel| texel[first..first + 4].to_vec()).collect::<Vec<u16>>();
    assert_eq!([part(0), part(4)], [halves(0), halves(1)]);
}

#[test]
fn playcanvas_rounds_to_the_intended_halves() {
    let bundle = bundle(Engine::PlayCanvas, 64);
    let luts: Value = serde_json::from_str(text(&bundle, "area-light-luts.json")).expect("JSON");
    for (key, expected) in [("LTC_MAT_1", halves(0)), ("LTC_MAT_2", halves(1))] {
        let numbers = luts[key].as_array().expect("an array").iter().map(|x| x.as_f64().expect("a number"));
        assert_eq!(numbers.map(|x| f16::from_f32_const(x as f32).to_bits()).collect::<Vec<u16>>(), expected, "{key}");
    }
}

#[test]
fn bevy_has_an_array_of_halves_in_zstd() {
    let bundle = bundle(Engine::Bevy, 64);
    let reader = ktx2::Reader::new(bytes(&bundle, "ltc.ktx2")).expect("KTX2");
    let header = reader.header();
    assert_eq!([header.pixel_width, header.pixel_height, header.pixel_depth, header.layer_count], [64, 64, 0, 2]);
    assert_eq!(header.format, Some(ktx2::Format::R16G16B16A16_SFLOAT));
    assert_eq!(header.supercompression_scheme, Some(ktx2::SupercompressionScheme::Zstandard));
    let level = reader.levels().next().expect("a level");
    let mut data = Vec::new();
    let mut decoder = ruzstd::decoding::StreamingDecoder::new(level.data).expect("zstd");
    std::io::Read::read_to_end(&mut decoder, &mut data).expect("all of it");
    let words: Vec<u16> = data.as_chunks::<2>().0.iter().map(|word| u16::from_le_bytes(*word)).collect();
    assert_eq!(words, [halves(0), halves(1)].concat());
}

#[test]
fn godot_skips_148_bytes() {
    let bundle = bundle(Engine::Godot, 64);
    for (path, texture) in [("ltc_lut1.dds", 0), ("ltc_lut2.dds", 1)] {
        let numbers: Vec<f32> =
            bytes(&bundle, path)[148..].as_chunks::<4>().0.iter().map(|x| f32::from_le_bytes(*x)).collect();
        assert_eq!(numbers, textures(64)[texture].texels);
    }
}

#[test]
fn o3de_has_two_channels_in_the_second_and_a_size_in_its_shader() {
    let small = bundle(Engine::O3de, 32);
    let amplitude = ddsfile::Dds::read(bytes(&small, "ltc_amp_lutrg32f.dds")).expect("DDS");
    assert_eq!(amplitude.get_dxgi_format(), Some(ddsfile::DxgiFormat::R32G32_Float));
    let expected: Vec<u8> =
        textures(32)[1].texels.chunks(4).flat_map(|t| [t[0], t[1]]).flat_map(f32::to_le_bytes).collect();
    assert_eq!(amplitude.data, expected);
    assert_eq!(small.steps.len(), 1);
    assert!(bundle(Engine::O3de, 64).steps[1].contains("LUT_SIZE in LtcCoords of Ltc.azsli to 64.0"));
}

#[test]
fn unity_has_every_number() {
    let unity = bundle(Engine::Hdrp, 64);
    let code = text(&unity, "LtcData.BRDF_GGX.cs");
    let (_, rows) = code.split_once("new ushort[64 * 64 * 4]\n        {").expect("an array");
    let (rows, _) = rows.split_once('}').expect("its end");
    let numbers = rows.split(',').map(str::trim).filter(|word| !word.is_empty());
    assert_eq!(numbers.map(|word| word.parse().expect("bits")).collect::<Vec<u16>>(), halves(0));
}

/// Writes the numbers of the four textures one after another, little-endian.
const PRINT_THREE: &str = "
import { createLTC } from './ltc.mjs';
import { writeFileSync } from 'node:fs';
class DataTexture { constructor( data, width, height, format, type ) { Object.assign( this, { data, width, height, format, type } ); } }
const made = createLTC( { DataTexture, RGBAFormat: 'RGBA', FloatType: 'float', HalfFloatType: 'half' } );
const textures = [ 'LTC_FLOAT_1', 'LTC_FLOAT_2', 'LTC_HALF_1', 'LTC_HALF_2' ].map( ( name ) => made[ name ] );
writeFileSync( 'numbers', Buffer.concat( textures.map( ( texture ) => Buffer.from( texture.data.buffer ) ) ) );
console.log( textures.map( ( { width, height, format, type } ) => [ width, height, format, type ].join( ' ' ) ).join( ', ' ) );
";

#[test]
fn three_unpacks_every_number_and_its_half() {
    if Command::new("node").arg("--version").output().is_err() {
        eprintln!("SKIPPED: no node on this machine, so the module for three.js is not run");
        return;
    }
    // Hard numbers: above the halves, between the largest half and infinity, almost zero, subnormal, equal to a half,
    // and between two halves.
    let hard = [7e4, 65519.0, 1e-12, 3e-8, 5e-8, 3.3e-6, 6.1e-5, 0.0, 1.0, 0.1];
    let mut given = textures(64);
    for (which, texture) in given.iter_mut().enumerate() {
        for (i, x) in texture.texels.iter_mut().enumerate().step_by(3) {
            *x = hard[i % hard.len()] * if (i + which) % 2 == 0 { 1.0 } else { -1.0 };
        }
    }
    let bundle = Engine::Three.bundle(BrdfKind::Ggx, &given, &About::new(["table 1234"])).expect("a bundle");
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join("ltc.mjs"), text(&bundle, "ltc.js")).expect("a file");
    std::fs::write(folder.path().join("print.mjs"), PRINT_THREE).expect("a file");
    let ran = Command::new("node").arg("print.mjs").current_dir(folder.path()).output().expect("node");
    assert!(ran.status.success(), "{}", String::from_utf8_lossy(&ran.stderr));
    let [float, half] = ["64 64 RGBA float", "64 64 RGBA half"];
    assert_eq!(String::from_utf8_lossy(&ran.stdout).trim(), [float, float, half, half].join(", "));
    let rounded = |precision| given.iter().flat_map(move |texture| round(&texture.texels, precision).little_endian());
    let expected: Vec<u8> = rounded(Precision::F32).chain(rounded(Precision::F16)).collect();
    let found = std::fs::read(folder.path().join("numbers")).expect("the numbers");
    assert_eq!(found.len(), expected.len());
    assert_eq!(found.iter().zip(&expected).position(|(found, expected)| found != expected), None);
}

/// The bundle must be shorter than the 314,764 bytes of three.js for its own tables.
#[test]
fn the_module_for_three_is_shorter_than_the_tables_of_three() {
    assert!(bytes(&bundle(Engine::Three, 64), "ltc.js").len() < 190_000);
}

#[test]
fn our_own_shader_finds_its_buffers() {
    let bundle = bundle(Engine::Wgpu, 64);
    let document: Value = serde_json::from_str(text(&bundle, "ltc.json")).expect("JSON");
    let words = &document["ltc_table"];
    assert_eq!(words["nodes"], serde_json::json!([2, 1, 3, 1]));
    assert_eq!(words["reading"][1], 1, "isotropic with one phi");
    assert_eq!(words["spacing"], serde_json::json!([0.9_f32, 1.0, 0.5, 1.0]));
    assert_eq!(words.as_object().map(serde_json::Map::len), Some(9));
    assert_eq!(document["textures"], serde_json::json!(["ltc_matrix_a.ktx2", "ltc_matrix_b.ktx2", "ltc_terms.ktx2"]));
}

#[test]
fn our_own_shader_has_halves_on_request_or_if_nothing_is_rounded() {
    let format = |engine: Engine, number: f32| {
        let mut given = own();
        given[1].texels[5] = number;
        let about = About::default().for_shader(&axes());
        let bundle = engine.bundle(BrdfKind::Ggx, &given, &about).expect("a bundle");
        let reader = ktx2::Reader::new(bytes(&bundle, "ltc_matrix_b.ktx2")).expect("KTX2");
        reader.header().format.expect("a format")
    };
    let [half, single] = [ktx2::Format::R16G16B16A16_SFLOAT, ktx2::Format::R32G32B32A32_SFLOAT];
    assert_eq!([0.25, 0.1].map(|number| format(Engine::Wgpu, number)), [half, single]);
    assert_eq!([0.25, 0.1].map(|number| format(Engine::WgpuHalf, number)), [half, half]);
}
