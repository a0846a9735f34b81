//! Reads each format back with the reader of another crate. If reader and writer are the same crate, the tests also
//! check published offsets.

use std::io::Cursor;

use half::f16;
use proptest::prelude::*;
use serde_json::Value;

use super::*;
use crate::rounding::round;

const ABOUT: [&str; 2] = ["table 1234 → «ü»", "licence: */ \"CC0\" \\"];

fn about() -> About {
    About::new(ABOUT)
}

/// A texture with numbers of all magnitudes, different in each row.
fn planted(sides: [u32; 3], layers: u32, channels: usize) -> Texture {
    let names = ["r", "g", "b", "a", "fifth"];
    let count = sides.iter().product::<u32>() as usize * layers as usize * channels;
    let texels =
        (0..count).map(|i| (i as f32 * 0.7).sin() * 10.0_f32.powi([-5, -4, -3, -2, -1, 0, 1, 2, 3][i % 9])).collect();
    Texture::new("LTC_1", sides, layers, &names[..channels], texels).expect("a texture")
}

fn write(container: TextureContainer, texture: &Texture, precision: Precision) -> Vec<TextureFile> {
    container
        .files("ltc", std::slice::from_ref(texture), precision, &about())
        .unwrap_or_else(|error| panic!("{container}: {error}"))
}

fn u32_at(bytes: &[u8], at: usize) -> u32 {
    u32::from_le_bytes(bytes[at..at + 4].try_into().expect("four bytes"))
}

fn numbers(bytes: &[u8], precision: Precision) -> Vec<f32> {
    match precision {
        Precision::F32 => bytes.as_chunks::<4>().0.iter().map(|x| f32::from_le_bytes(*x)).collect(),
        Precision::F16 => bytes.as_chunks::<2>().0.iter().map(|x| f16::from_le_bytes(*x).to_f32_const()).collect(),
    }
}

fn unzstd(bytes: &[u8]) -> Vec<u8> {
    let mut decoder = ruzstd::decoding::StreamingDecoder::new(bytes).expect("a zstd frame");
    let mut data = Vec::new();
    std::io::Read::read_to_end(&mut decoder, &mut data).expect("all of it");
    data
}

/// The numbers of a KTX2 file with one level. Checks that all fields describe the texture.
fn read_ktx2(file: &[u8], texture: &Texture, precision: Precision, zstd: bool) -> Vec<f32> {
    let reader = ::ktx2::Reader::new(file).expect("KTX2");
    let header = reader.header();
    let none_if_one = |n: u32| if n == 1 { 0 } else { n };
    assert_eq!([header.pixel_width, header.pixel_height], [texture.width, texture.height]);
    assert_eq!(
        [header.pixel_depth, header.layer_count, header.face_count, header.level_count],
        [none_if_one(texture.depth), none_if_one(texture.layers), 1, 1]
    );
    let channels = texture.channels.len();
    let (number_bytes, formats) = match precision {
        Precision::F16 => (2, [76, 83, 90, 97]),
        Precision::F32 => (4, [100, 103, 106, 109]),
    };
    assert_eq!(header.format.map(|format| format.value()), Some(formats[channels - 1]));
    assert_eq!(header.type_size, number_bytes);
    let descriptor = reader.basic_dfd().expect("a descriptor");
    assert_eq!(descriptor.color_model, Some(::ktx2::ColorModel::RGBSDA));
    assert_eq!(descriptor.transfer_function, Some(::ktx2::TransferFunction::Linear));
    assert_eq!(u32::from(descriptor.bytes_planes[0]), channels as u32 * number_bytes);
    assert_eq!(descriptor.sample_information.len(), channels);
    let mut before = String::new();
    for (key, value) in reader.key_value_data() {
        assert!(before.as_str() < key, "{before} before {key}");
        assert_eq!(value.last(), Some(&0), "{key}");
        before = key.to_owned();
    }
    let value = |key| reader.key_value_data().find(|(own, _)| *own == key).map(|(_, value)| value.to_vec());
    assert_eq!(value("ltcforge").expect("about"), format!("{}\n{}\0", ABOUT[0], ABOUT[1]).as_bytes());
    assert_eq!(value("ltcforge.channels").expect("channels"), format!("{}\0", texture.channels.join(",")).as_bytes());
    assert!(value("KTXwriter").expect("a writer").starts_with(b"ltcforge "));
    let level = reader.levels().next().expect("a level");
    assert_eq!(header.supercompression_scheme.is_some(), zstd);
    let at = level.data.as_ptr() as usize - file.as_ptr() as usize;
    assert_eq!(at + level.data.len(), file.len(), "nothing follows");
    let data = if zstd { unzstd(level.data) } else { level.data.to_vec() };
    if !zstd {
        assert_eq!(at % (channels * number_bytes as usize), 0, "aligned to texels");
        assert_eq!(at % 4, 0);
    }
    assert_eq!(level.uncompressed_byte_length, data.len() as u64);
    numbers(&data, precision)
}

fn read_dds(file: &[u8], texture: &Texture, precision: Precision) -> Vec<f32> {
    let dds = ddsfile::Dds::read(Cursor::new(file)).expect("DDS");
    assert_eq!([dds.get_width(), dds.get_height()], [texture.width, texture.height]);
    assert_eq!([dds.get_depth(), dds.get_num_array_layers()], [texture.depth, texture.layers]);
    numbers(&dds.data, precision)
}

/// The numbers of all parts of an EXR file, with channels in the texture's order.
fn read_exr(file: &[u8], texture: &Texture) -> Vec<f32> {
    use ::exr::prelude::{ReadChannels as _, ReadLayers as _, read};
    let image = read().no_deep_data().largest_resolution_level().all_channels().all_layers().all_attributes();
    let image = image.non_parallel().from_buffered(Cursor::new(file)).expect("EXR");
    let mut texels = Vec::new();
    for layer in &image.layer_data {
        assert_eq!([layer.size.0, layer.size.1], [texture.width as usize, texture.height as usize]);
        let comments = layer.attributes.comments.as_ref().expect("comments");
        assert_eq!(comments.as_slice(), ABOUT.join("\n").as_bytes());
        let channels: Vec<Vec<f32>> = texture
            .channels
            .iter()
            .map(|name| {
                let found = layer.channel_data.list.iter().find(|channel| channel.name.to_string() == *name);
                found.expect("the channel").sample_data.values_as_f32().collect()
            })
            .collect();
        texels.extend((0..layer.size.0 * layer.size.1).flat_map(|i| channels.iter().map(move |channel| channel[i])));
    }
    texels
}

/// The numbers of an array file. Checks that the header describes the texture.
fn read_npy(file: &[u8], texture: &Texture, precision: Precision) -> Vec<f32> {
    assert_eq!(&file[..8], b"\x93NUMPY\x01\x00");
    let length = usize::from(u16::from_le_bytes([file[8], file[9]]));
    assert_eq!((10 + length) % 64, 0);
    let header = std::str::from_utf8(&file[10..10 + length]).expect("text");
    let shape: Vec<String> = texture.shape().iter().map(usize::to_string).collect();
    let descr = if precision == Precision::F32 { "<f4" } else { "<f2" };
    let expected = format!("{{'descr': '{descr}', 'fortran_order': False, 'shape': ({}), }}", shape.join(", "));
    assert_eq!(header.trim_end(), expected);
    assert!(header.ends_with('\n'));
    numbers(&file[10 + length..], precision)
}

fn read_npz(file: &[u8], texture: &Texture, precision: Precision) -> Vec<f32> {
    let mut archive = zip::ZipArchive::new(Cursor::new(file)).expect("a ZIP file");
    let names: Vec<String> = archive.file_names().map(|name| name.expect("a name").into_owned()).collect();
    assert_eq!(names, ["LTC_1.npy", "about.txt"]);
    let mut member = |name: &str| {
        let mut bytes = Vec::new();
        let mut entry = archive.by_name(name).expect("a member");
        assert_eq!(entry.compression(), zip::CompressionMethod::Stored);
        std::io::Read::read_to_end(&mut entry, &mut bytes).expect("bytes with the right checksum");
        bytes
    };
    assert_eq!(member("about.txt"), format!("{}\n{}\n", ABOUT[0], ABOUT[1]).as_bytes());
    read_npy(&member("LTC_1.npy"), texture, precision)
}

/// The numbers between brackets after the text `before`.
fn numbers_of_text(text: &str, before: &str, precision: Precision) -> Vec<f32> {
    let (_, rest) = text.split_once(before).unwrap_or_else(|| panic!("«{before}» in {text}"));
    let end = rest.find([']', '}']).expect("an end");
    let words = rest[..end].split(',').map(str::trim).filter(|word| !word.is_empty());
    let number = |word: &str| match precision {
        Precision::F32 => word.trim_end_matches('f').parse().unwrap_or_else(|_| panic!("{word}")),
        Precision::F16 => f16::from_bits(word.parse().unwrap_or_else(|_| panic!("{word}"))).to_f32_const(),
    };
    words.map(number).collect()
}

/// The numbers that a reader of the format returns, in the texture's order.
fn read_back(container: TextureContainer, files: &[TextureFile], texture: &Texture, precision: Precision) -> Vec<f32> {
    let bytes = &files[0].bytes;
    let text = || std::str::from_utf8(bytes).expect("text");
    let half = precision == Precision::F16;
    match container {
        TextureContainer::Ktx2 => read_ktx2(bytes, texture, precision, false),
        TextureContainer::Ktx2Zstd => read_ktx2(bytes, texture, precision, true),
        TextureContainer::Dds | TextureContainer::DdsDx10 => read_dds(bytes, texture, precision),
        TextureContainer::Exr => read_exr(bytes, texture),
        TextureContainer::Npy => read_npy(bytes, texture, precision),
        TextureContainer::Npz => read_npz(bytes, texture, precision),
        TextureContainer::Raw => {
            let sidecar: Value = serde_json::from_slice(&files[1].bytes).expect("JSON");
            assert_eq!([&files[0].path, &files[1].path], ["LTC_1.bin", "LTC_1.json"]);
            assert_eq!(sidecar["file"], "LTC_1.bin");
            assert_eq!(sidecar["bytes"], bytes.len());
            assert_eq!(sidecar["about"][0], ABOUT[0]);
            assert_eq!(sidecar["layers"], texture.layers);
            numbers(bytes, precision)
        }
        TextureContainer::CHeader => {
            let number = if half { "uint16_t" } else { "float" };
            numbers_of_text(text(), &format!("static const {number} LTC_1[{}] = {{", texture.texels.len()), precision)
        }
        TextureContainer::RustModule => {
            syn::parse_file(text()).expect("Rust");
            let number = if half { "u16" } else { "f32" };
            numbers_of_text(text(), &format!("pub static LTC_1: [{number}; {}] = [", texture.texels.len()), precision)
        }
        TextureContainer::CSharp => {
            let number = if half { "ushort" } else { "float" };
            numbers_of_text(text(), &format!("LTC_1 = new {number}[]\n    {{"), precision)
        }
        TextureContainer::JavaScript => {
            let array = if half { "Uint16Array" } else { "Float32Array" };
            numbers_of_text(text(), &format!("export const LTC_1 = new {array}( ["), precision)
        }
        TextureContainer::Json => {
            let document: Value = serde_json::from_str(text()).expect("JSON");
            assert_eq!(document["about"][0], ABOUT[0]);
            let texture = &document["textures"][0];
            let texels = texture["texels"].as_array().expect("numbers").iter();
            let number = |x: &Value| x.as_f64().expect("a number");
            match precision {
                Precision::F32 => texels.map(|x| number(x) as f32).collect(),
                Precision::F16 => texels.map(|x| f16::from_f64_const(number(x)).to_f32_const()).collect(),
            }
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]
    #[test]
    fn every_size_is_read_back_or_rejected_by_name(
        sides in [1_u32..6, 1_u32..6, 1_u32..4],
        layers in 1_u32..4,
        channels in 1_usize..6,
        half in any::<bool>(),
        container in prop::sample::select(TextureContainer::ALL),
    ) {
        let texture = planted(sides, layers, channels);
        let precision = if half { Precision::F16 } else { Precision::F32 };
        let written = container.files("ltc", std::slice::from_ref(&texture), precision, &about());
        let graphics = matches!(container, TextureContainer::Ktx2 | TextureContainer::Ktx2Zstd)
            || matches!(container, TextureContainer::Dds | TextureContainer::DdsDx10);
        let dds_lacks = matches!(container, TextureContainer::Dds | TextureContainer::DdsDx10) && half && channels == 3;
        let refused = graphics && (channels > 4 || (sides[2] > 1 && layers > 1)) || dds_lacks;
        match written {
            Err(error) => {
                prop_assert!(refused, "{error}");
                prop_assert!(error.to_string().starts_with("«LTC_1»: "), "{error}");
            }
            Ok(files) => {
                prop_assert!(!refused);
                let expected = round(&texture.texels, precision);
                prop_assert_eq!(files[0].rounding, expected.error);
                prop_assert_eq!(read_back(container, &files, &texture, precision), expected.numbers);
                prop_assert_eq!(files, write(container, &texture, precision), "the second export has different bytes");
            }
        }
    }
}

#[test]
fn engine_formats_have_the_numbers_that_engines_expect() {
    let texture = planted([64, 64, 1], 1, 4);
    for (precision, vk, fourcc, dxgi) in [(Precision::F16, 97, 113, 10), (Precision::F32, 109, 116, 2)] {
        let bytes_of = |container| write(container, &texture, precision).remove(0).bytes;
        assert_eq!(u32_at(&bytes_of(TextureContainer::Ktx2), 12), vk);
        // The Direct3D 9 header: size, flags, height and width; size and flag of the format; then the FourCC.
        let legacy = bytes_of(TextureContainer::Dds);
        let texel_bytes = if precision == Precision::F16 { 8 } else { 16 };
        assert_eq!(legacy.len(), 128 + 64 * 64 * texel_bytes);
        assert_eq!([4, 12, 16, 76, 80, 84].map(|at| u32_at(&legacy, at)), [124, 64, 64, 32, 4, fourcc]);
        let read = ddsfile::Dds::read(&*legacy).expect("DDS");
        assert_eq!(
            format!("{:?}", read.get_d3d_format()),
            if texel_bytes == 8 { "Some(A16B16G16R16F)" } else { "Some(A32B32G32R32F)" }
        );
        let dx10 = bytes_of(TextureContainer::DdsDx10);
        assert_eq!(dx10.len(), 148 + 64 * 64 * texel_bytes);
        assert_eq!(&dx10[84..88], b"DX10");
        assert_eq!([128, 132, 140].map(|at| u32_at(&dx10, at)), [dxgi, 3, 1]);
        assert_eq!(numbers(&dx10[148..], precision), round(&texture.texels, precision).numbers);
    }
}

#[test]
fn a_file_with_several_textures_names_each() {
    let mut other = planted([3, 2, 1], 1, 4);
    other.name = "LTC_2".to_owned();
    let textures = [planted([3, 2, 1], 1, 4), other];
    for container in TextureContainer::ALL {
        let files = container.files("ltc", &textures, Precision::F16, &about()).expect("files");
        let all: Vec<u8> = files.iter().flat_map(|file| file.path.bytes().chain(file.bytes.iter().copied())).collect();
        let all = String::from_utf8_lossy(&all);
        for texture in &textures {
            assert!(all.contains(&texture.name), "{container} lacks {}", texture.name);
        }
        let paths: std::collections::BTreeSet<&str> = files.iter().map(|file| file.path.as_str()).collect();
        assert_eq!(paths.len(), files.len(), "{container} has two files with one name");
    }
}

#[test]
fn each_file_reports_its_own_rounding_errors() {
    let texture = |name: &str, vanishing: usize| {
        let texels = (0..8).map(|i| if i < vanishing { 1e-12 } else { 1.0 }).collect();
        Texture::new(name, [2, 1, 1], 1, &["r", "g", "b", "a"], texels).expect("a texture")
    };
    let textures = [texture("LTC_1", 1), texture("LTC_2", 2)];
    for container in TextureContainer::ALL {
        let files = container.files("ltc", &textures, Precision::F16, &about()).expect("files");
        let reported = files.iter().map(|file| file.rounding.raised).sum::<u64>();
        assert_eq!(reported, 3, "{container}");
        for (name, raised) in [("LTC_1.", 1), ("LTC_2.", 2)] {
            if let Some(file) = files.iter().find(|file| file.path.starts_with(name)) {
                assert_eq!(file.rounding.raised, raised, "{container}: {}", file.path);
            }
        }
    }
}

/// Two tables of one layout, and two layouts, in one program. Rust and JavaScript do not need this, because they have
/// modules.
#[test]
fn code_of_several_tables_can_be_compiled_together() {
    use ltcforge_files::digest::Digest;
    let of = |table: &[u8], layout, container: TextureContainer| {
        let about = About::of_table(Digest::of(table), None, None).of_layout(layout);
        let texture = planted([2, 3, 1], 1, 4);
        let mut files = container.files("ltc", &[texture], Precision::F16, &about).expect("a file");
        String::from_utf8(files.remove(0).bytes).expect("text")
    };
    let all = [(b"one", "ltc2017"), (b"two", "ltc2017"), (b"one", "godot")];
    let sharp = all.map(|(table, layout)| of(table, layout, TextureContainer::CSharp));
    let classes: std::collections::BTreeSet<&str> =
        sharp.iter().filter_map(|text| text.lines().find(|line| line.contains("static class"))).collect();
    assert_eq!(classes.len(), 3, "{classes:?}");

    let folder = tempfile::tempdir().expect("a folder");
    let mut program = "#define LTCFORGE_LONG_NAMES\n".to_owned();
    for (i, (table, layout)) in all.into_iter().enumerate() {
        std::fs::write(folder.path().join(format!("{i}.h")), of(table, layout, TextureContainer::CHeader))
            .expect("a file");
        program += &[&format!("#include \"{i}.h\"\n"); 2].map(String::as_str).concat();
    }
    let digits = Digest::of(b"two").hex()[..8].to_owned();
    let array = format!("LTC_1_ltc2017_{digits}");
    program += &["int main(void) { return ", &array, "[", &array, "_WIDTH] == 0; }\n"].concat();
    std::fs::write(folder.path().join("all.c"), program).expect("a file");
    let short = "#include \"0.h\"\nint main(void) { return LTC_1[LTC_1_WIDTH] == 0; }\n";
    std::fs::write(folder.path().join("short.c"), short).expect("a file");
    for name in ["all.c", "short.c"] {
        let compiled = std::process::Command::new("gcc")
            .args(["-std=c99", "-Wall", "-Wno-unused-const-variable", "-Werror", "-fsyntax-only", name])
            .current_dir(folder.path())
            .output();
        let Ok(compiled) = compiled else {
            eprintln!("SKIPPED: no gcc on this machine, so the headers are not compiled");
            return;
        };
        assert!(compiled.status.success(), "{}", String::from_utf8_lossy(&compiled.stderr));
    }
}

#[test]
fn inconsistent_textures_are_rejected() {
    let texture = planted([2, 2, 1], 1, 4);
    let mut broken = texture.clone();
    broken.texels[3] = f32::INFINITY;
    let mut twin = texture.clone();
    twin.name = "ltc_1".to_owned();
    for container in TextureContainer::ALL {
        let refused = |textures: &[Texture]| {
            let files = container.files("ltc", textures, Precision::F32, &about());
            files.expect_err("no files").to_string()
        };
        assert!(refused(&[]).contains("no texture"));
        assert!(refused(std::slice::from_ref(&broken)).contains("texels[3] is inf"));
        assert!(refused(&[texture.clone(), twin.clone()]).contains("two textures are named «ltc_1»"));
    }
}
