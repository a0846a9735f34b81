//! Tests image files in each format, damaged files, and the files of a pyramid, which are read back.

use std::io::{Cursor, Read as _};

use exr::prelude::{Compression, Encoding, Image, Layer, LayerAttributes, SpecificChannels, Vec2, WritableImage as _};
use half::f16;
use ltcforge_light::textured::{LightImage, LightPyramid};
use proptest::prelude::*;

use super::{
    Curve, LightFileError, LightPicture, LightTexels, PictureFormat, TransferFunction, light_texture_files,
    shared_exponent::unpack,
};
use crate::{About, Texture, TextureContainer};
use ltcforge_fit::Precision;

/// Compressors of `OpenEXR` that store small whole numbers exactly.
const PACKED: [Compression; 4] = [Compression::RLE, Compression::ZIP16, Compression::PIZ, Compression::PXR24];

/// A PNG file with these numbers, and a chunk before the pixels.
fn png(
    size: [u32; 2],
    color: ::png::ColorType,
    depth: ::png::BitDepth,
    chunk: Option<([u8; 4], &[u8])>,
    pixels: &[u8],
) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = ::png::Encoder::new(&mut bytes, size[0], size[1]);
    encoder.set_color(color);
    encoder.set_depth(depth);
    let mut writer = encoder.write_header().expect("a header");
    if let Some((kind, data)) = chunk {
        writer.write_chunk(::png::chunk::ChunkType(kind), data).expect("a chunk");
    }
    writer.write_image_data(pixels).expect("pixels");
    writer.finish().expect("an end");
    bytes
}

fn exr(channels: &[&str], texels: Vec<f32>) -> Vec<u8> {
    let texture = Texture::flat("picture", [2, 1], channels, texels).expect("a texture");
    let files = TextureContainer::Exr.files("x", &[texture], Precision::F32, &About::new(["a picture"]));
    files.expect("EXR").remove(0).bytes
}

/// An `OpenEXR` file of 16 x 16 pixels with this compressor.
fn packed_exr(compression: Compression) -> Vec<u8> {
    let channels = SpecificChannels::rgb(|at: Vec2<usize>| (at.0 as f32, at.1 as f32, 0.25_f32));
    let encoding = Encoding { compression, ..Encoding::default() };
    let image = Image::from_layer(Layer::new((16, 16), LayerAttributes::named("picture"), encoding, channels));
    let mut file = Cursor::new(Vec::new());
    image.write().non_parallel().to_buffered(&mut file).expect("EXR");
    file.into_inner()
}

/// A Radiance HDR file of two pixels, without run-length encoding.
fn radiance(magic: &str, pixels: [[u8; 4]; 2]) -> Vec<u8> {
    let header = format!("{magic}\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 2\n");
    [header.as_bytes(), pixels.as_flattened()].concat()
}

fn jpeg() -> Vec<u8> {
    let mut bytes = Vec::new();
    let pixels = [[200_u8, 100, 50]; 64].concat();
    jpeg_encoder::Encoder::new(&mut bytes, 100).encode(&pixels, 8, 8, jpeg_encoder::ColorType::Rgb).expect("a JPEG");
    bytes
}

fn rgb8(chunk: Option<([u8; 4], &[u8])>) -> Vec<u8> {
    png([2, 1], ::png::ColorType::Rgb, ::png::BitDepth::Eight, chunk, &[0, 128, 255, 10, 255, 0])
}

fn decoded(bytes: &[u8]) -> LightPicture {
    LightPicture::decode(bytes, None).expect("a picture")
}

#[test]
fn each_format_becomes_linear() {
    let near = |a: f32, b: f64| assert!((f64::from(a) - b).abs() < 1e-6, "{a} {b}");
    let picture = decoded(&rgb8(None));
    assert_eq!((picture.format, picture.curve), (PictureFormat::Png, Curve::Srgb));
    assert_eq!((picture.image.width(), picture.image.height()), (2, 1));
    near(picture.image.texels()[0][1], 0.215_860_5);
    near(picture.image.texels()[1][0], 10.0 / 255.0 / 12.92);
    assert_eq!(picture.image.texels()[0][2], 1.0);

    let grey = png([1, 1], ::png::ColorType::GrayscaleAlpha, ::png::BitDepth::Sixteen, None, &[255, 255, 64, 0]);
    let [r, g, b] = decoded(&grey).image.texels()[0];
    near(r, 16_384.0 / 65_535.0);
    assert_eq!([g, b], [r; 2]);

    let picture = decoded(&exr(&["R", "G", "B"], vec![0.5, 2.0, 1e9, 0.0, 3.0, 7.0]));
    assert_eq!((picture.format, picture.curve), (PictureFormat::Exr, Curve::Linear));
    assert_eq!(picture.image.texels(), [[0.5, 2.0, 1e9], [0.0, 3.0, 7.0]]);
    assert_eq!(decoded(&exr(&["Y"], vec![0.5, 2.0])).image.texels(), [[0.5; 3], [2.0; 3]]);
    for compression in PACKED {
        let picture = decoded(&packed_exr(compression));
        assert_eq!(picture.image.row(3)[7], [7.0, 3.0, 0.25], "{compression:?}");
    }

    for magic in ["#?RADIANCE", "#?RGBE"] {
        let picture = decoded(&radiance(magic, [[128, 64, 0, 129], [0; 4]]));
        assert_eq!((picture.format, picture.curve), (PictureFormat::Radiance, Curve::Linear));
        near(picture.image.texels()[0][1], 0.5);
    }

    let picture = decoded(&jpeg());
    assert_eq!((picture.format, picture.curve), (PictureFormat::Jpeg, Curve::Srgb));
    assert!((picture.image.texels()[9][0] - 0.577).abs() < 0.02, "{:?}", picture.image.texels()[9]);
}

#[test]
fn the_file_or_the_caller_selects_the_curve() {
    let curve = |chunk: ([u8; 4], &[u8])| decoded(&rgb8(Some(chunk))).curve;
    assert_eq!(curve((*b"gAMA", &100_000_u32.to_be_bytes())), Curve::Linear);
    assert_eq!(curve((*b"gAMA", &45_455_u32.to_be_bytes())), Curve::Srgb);
    assert_eq!(curve((*b"gAMA", &50_000_u32.to_be_bytes())), Curve::Power(2.0));
    assert_eq!(curve((*b"cICP", &[1, 8, 0, 1])), Curve::Linear);
    assert_eq!(curve((*b"cICP", &[1, 13, 0, 1])), Curve::Srgb);
    let pq = rgb8(Some((*b"cICP", &[9, 16, 0, 1])));
    assert_eq!(LightPicture::decode(&pq, None), Err(LightFileError::Transfer(16)));
    let linear = LightPicture::decode(&pq, Some(TransferFunction::Linear)).expect("a picture");
    assert_eq!(linear.image.texels()[0], [0.0, 128.0 / 255.0, 1.0]);
    let bent = exr(&["R", "G", "B"], vec![0.5; 6]);
    let bent = LightPicture::decode(&bent, Some(TransferFunction::Srgb)).expect("a picture");
    assert!((bent.image.texels()[0][0] - 0.214_041).abs() < 1e-5);
}

#[test]
fn files_that_are_not_light_are_rejected() {
    let said = |bytes: &[u8]| LightPicture::decode(bytes, None).expect_err("not light").to_string();
    assert_eq!(said(b"GIF89a"), "this file is not a readable image; allowed: PNG, OpenEXR, Radiance HDR, JPEG");
    assert_eq!(said(b""), said(b"GIF89a"));
    assert!(said(&exr(&["R", "G", "B"], vec![0.5, -2.0, 1.0, 0.0, 3.0, -7.0])).contains("x 0, y 0 has green -2; 2 of"));
    assert!(said(&exr(&["A", "Z"], vec![0.5; 4])).contains("its channels are A, Z; R, G and B, or Y, are required"));
    let mut large = rgb8(None);
    large[16..20].copy_from_slice(&20_000_u32.to_be_bytes());
    let crc = 29..33;
    let mut hash = flate2_crc(&large[12..29]);
    hash.reverse();
    large[crc].copy_from_slice(&hash);
    assert!(said(&large).contains("20000 x 1 pixels; 1 to 16384 on each side"), "{}", said(&large));
    let long = b"#?RADIANCE\n\n-Y 16000 +X 16000\n";
    assert!(said(long).contains("16000 x 16000 pixels"));
    for whole in [rgb8(None), exr(&["R", "G", "B"], vec![0.5; 6]), radiance("#?RADIANCE", [[1; 4]; 2]), jpeg()] {
        let half = said(&whole[..whole.len() * 2 / 3]);
        assert!(half.contains("not a readable"), "{half}");
    }
}

/// The checksum of a PNG chunk, lowest byte first.
fn flate2_crc(bytes: &[u8]) -> [u8; 4] {
    let step = |crc: u32, byte: &u8| {
        (0..8).fold(crc ^ u32::from(*byte), |crc, _| if crc & 1 == 1 { 0xedb8_8320 ^ (crc >> 1) } else { crc >> 1 })
    };
    (!bytes.iter().fold(!0, step)).to_le_bytes()
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, ..ProptestConfig::default() })]

    #[test]
    fn hostile_bytes_are_errors(
        file in 0_usize..9,
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..6),
        length in 0.2..1.2_f64,
    ) {
        let mut bytes = match file {
            0 => rgb8(Some((*b"gAMA", &50_000_u32.to_be_bytes()))),
            1 => exr(&["R", "G", "B"], vec![0.5, 2.0, 1.0, 0.0, 3.0, 7.0]),
            2 => radiance("#?RADIANCE", [[2, 2, 0, 2], [130, 7, 2, 9]]),
            3 => jpeg(),
            4 => exr(&["Y"], vec![0.5, 2.0]),
            packed => packed_exr(PACKED[packed - 5]),
        };
        for (index, byte) in changes {
            let at = index.index(bytes.len());
            // The first bytes are unchanged, because they select the decoder.
            if at > 8 {
                bytes[at] = byte;
            }
        }
        bytes.resize((bytes.len() as f64 * length.min(1.0)) as usize, 0);
        if let Ok(picture) = LightPicture::decode(&bytes, None) {
            prop_assert!(picture.image.texels().as_flattened().iter().all(|x| x.is_finite() && *x >= 0.0));
        }
    }
}

fn pyramid() -> LightPyramid {
    let texels = (0_u8..15).map(|i| [f32::from(i) / 3.0, 1.0, 0.01 * f32::from(i * i)]).collect();
    LightPyramid::new(&LightImage::new(5, 3, texels).expect("an image"))
}

/// The levels of a KTX2 file. Checks that the fields of the file describe them.
fn ktx2_levels(file: &[u8], texels: LightTexels, zstd: bool) -> Vec<Vec<u8>> {
    let reader = ktx2::Reader::new(file).expect("KTX2");
    let header = reader.header();
    let (format, texel_bytes, samples) = match texels {
        LightTexels::Rgba16f => (ktx2::Format::R16G16B16A16_SFLOAT, 8, 4),
        LightTexels::Rgba32f => (ktx2::Format::R32G32B32A32_SFLOAT, 16, 4),
        LightTexels::Rgb9e5 => (ktx2::Format::E5B9G9R9_UFLOAT_PACK32, 4, 6),
    };
    assert_eq!(header.format, Some(format));
    assert_eq!([header.pixel_width, header.pixel_height, header.pixel_depth, header.layer_count], [5, 3, 0, 0]);
    assert_eq!([header.face_count, header.level_count], [1, 3]);
    let descriptor = reader.basic_dfd().expect("a descriptor");
    assert_eq!((descriptor.bytes_planes[0], descriptor.sample_information.len()), (texel_bytes, samples));
    let keys: Vec<(String, Vec<u8>)> =
        reader.key_value_data().map(|(key, value)| (key.to_owned(), value.to_vec())).collect();
    assert_eq!(
        keys.iter().map(|(key, _)| key.as_str()).collect::<Vec<_>>(),
        ["KTXorientation", "KTXwriter", "ltcforge"]
    );
    assert_eq!(keys[0].1, b"rd\0");
    let places: Vec<usize> =
        reader.levels().map(|level| level.data.as_ptr() as usize - file.as_ptr() as usize).collect();
    assert!(places.is_sorted_by(|a, b| a > b), "the smallest level comes first: {places:?}");
    assert!(zstd || places.iter().all(|place| place % usize::from(texel_bytes) == 0), "{places:?}");
    let data = |level: ktx2::Level<'_>| {
        let mut data = Vec::new();
        if zstd {
            let mut decoder = ruzstd::decoding::StreamingDecoder::new(level.data).expect("a zstd frame");
            decoder.read_to_end(&mut data).expect("all of it");
        } else {
            data.extend(level.data);
        }
        assert_eq!(level.uncompressed_byte_length, data.len() as u64);
        data
    };
    reader.levels().map(data).collect()
}

/// Checks the file sizes in docs/textured.md.
#[test]
fn files_are_four_thirds_of_the_texels() {
    let image = LightImage::new(1024, 1024, vec![[0.5; 3]; 1 << 20]).expect("an image");
    let pyramid = LightPyramid::new(&image);
    for (texels, bytes) in [(LightTexels::Rgba16f, 11_185_344), (LightTexels::Rgb9e5, 5_593_000)] {
        let made = light_texture_files("light", &pyramid, TextureContainer::Ktx2, texels, &About::new(["a light"]));
        let length = made.expect("a file").files[0].bytes.len();
        println!("{texels}: {length} bytes");
        assert!(length.abs_diff(bytes) < 1000, "{texels}: {length}");
    }
}

#[test]
fn ktx2_stores_all_levels() {
    let (pyramid, about) = (pyramid(), About::new(["a light"]));
    for (texels, most) in
        [(LightTexels::Rgba16f, 2e-4..5e-4), (LightTexels::Rgb9e5, 5e-4..2e-3), (LightTexels::Rgba32f, 0.0..1e-9)]
    {
        for container in [TextureContainer::Ktx2, TextureContainer::Ktx2Zstd] {
            let made = light_texture_files("screen", &pyramid, container, texels, &about).expect("a file");
            assert_eq!((made.files.len(), made.files[0].name.as_str(), made.clamped), (1, "screen.ktx2", 0));
            assert!(most.contains(&made.error), "{texels:?}: {}", made.error);
            let levels = ktx2_levels(&made.files[0].bytes, texels, container == TextureContainer::Ktx2Zstd);
            for (level, data) in pyramid.levels().iter().zip(levels) {
                let found: Vec<[f32; 3]> = match texels {
                    LightTexels::Rgba16f => data
                        .as_chunks::<2>()
                        .0
                        .as_chunks::<4>()
                        .0
                        .iter()
                        .map(|texel| {
                            assert_eq!(f16::from_le_bytes(texel[3]), f16::ONE);
                            [0, 1, 2].map(|c| f16::from_le_bytes(texel[c]).to_f32_const())
                        })
                        .collect(),
                    LightTexels::Rgba32f => data
                        .as_chunks::<4>()
                        .0
                        .as_chunks::<4>()
                        .0
                        .iter()
                        .map(|texel| [0, 1, 2].map(|c| f32::from_le_bytes(texel[c])))
                        .collect(),
                    LightTexels::Rgb9e5 => {
                        data.as_chunks::<4>().0.iter().map(|x| unpack(u32::from_le_bytes(*x))).collect()
                    }
                };
                assert_eq!(found.len(), level.texels().len());
                for (a, b) in level.texels().iter().zip(found) {
                    let largest = a[0].max(a[1]).max(a[2]);
                    assert!((0..3).all(|c| f64::from((a[c] - b[c]).abs() / largest) <= made.error), "{a:?} {b:?}");
                }
            }
        }
    }
}

#[test]
fn other_containers_store_a_texture_for_each_level() {
    let (pyramid, about) = (pyramid(), About::new(["a light"]));
    let files = |container, texels| light_texture_files("screen", &pyramid, container, texels, &about);
    let made = files(TextureContainer::Exr, LightTexels::Rgba32f).expect("files");
    let names: Vec<&str> = made.files.iter().map(|file| file.name.as_str()).collect();
    assert_eq!(names, ["screen_0.exr", "screen_1.exr", "screen_2.exr"]);
    for (file, level) in made.files.iter().zip(pyramid.levels()) {
        assert_eq!(&decoded(&file.bytes).image, level);
    }
    let refused = files(TextureContainer::Exr, LightTexels::Rgb9e5).expect_err("no such texels").to_string();
    assert_eq!(refused, "«screen»: texels is rgb9e5; exr allows rgba16f, rgba32f");
    let refused = files(TextureContainer::Dds, LightTexels::Rgba16f).expect_err("no such texels").to_string();
    assert_eq!(refused, "«screen»: texels is rgba16f; dds allows rgba32f");
}

#[test]
fn numbers_above_the_largest_are_counted() {
    let image = LightImage::new(2, 1, vec![[1e6, 1.0, 1.0], [70_000.0, 70_000.0, 1.0]]).expect("an image");
    let made = |texels| {
        let container = TextureContainer::Ktx2;
        light_texture_files("sun", &LightPyramid::new(&image), container, texels, &About::default()).expect("a file")
    };
    // The last level is the mean: 535000, 35000.5, 1.
    assert_eq!(made(LightTexels::Rgba32f).clamped, 0);
    assert!(made(LightTexels::Rgba16f).clamped >= 3 && made(LightTexels::Rgb9e5).clamped >= 3);
}
