//! Tests image files in each format, and damaged files.

mod colours;
mod files;
mod incomplete;

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
    let pq = rgb8(Some((*b"cICP", &[1, 16, 0, 1])));
    assert_eq!(LightPicture::decode(&pq, None), Err(LightFileError::Transfer(16)));
    let linear = LightPicture::decode(&pq, Some(TransferFunction::Linear)).expect("a picture");
    assert_eq!(linear.image.texels()[0], [0.0, 128.0 / 255.0, 1.0]);
    let bent = exr(&["R", "G", "B"], vec![0.5; 6]);
    let bent = LightPicture::decode(&bent, Some(TransferFunction::Srgb)).expect("a picture");
    assert!((bent.image.texels()[0][0] - 0.214_041).abs() < 1e-5);
}

/// Exif with this orientation, and an entry before it. The bytes of numbers are in both orders.
fn exif(orientation: u8) -> [Vec<u8>; 2] {
    let entry = [1, 15, 0, 2, 0, 0, 0, 1, 0, 0, 0, 0, 1, 18, 0, 3, 0, 0, 0, 1, 0, orientation, 0, 0];
    let little = [15, 1, 2, 0, 1, 0, 0, 0, 0, 0, 0, 0, 18, 1, 3, 0, 1, 0, 0, 0, orientation, 0, 0, 0];
    [
        [b"MM\0\x2a\0\0\0\x08\0\x02".as_slice(), &entry].concat(),
        [b"II\x2a\0\x08\0\0\0\x02\0".as_slice(), &little].concat(),
    ]
}

#[test]
fn images_are_turned_as_exif_states() {
    let expected: [&[[u8; 2]]; 8] = [
        &[[0, 1], [2, 3], [4, 5]],
        &[[2, 1], [0, 5], [4, 3]],
        &[[5, 4], [3, 2], [1, 0]],
        &[[3, 4], [5, 0], [1, 2]],
        &[[0, 3], [1, 4], [2, 5]],
        &[[3, 0], [4, 1], [5, 2]],
        &[[5, 2], [4, 1], [3, 0]],
        &[[2, 5], [1, 4], [0, 3]],
    ];
    for (i, expected) in expected.into_iter().enumerate() {
        for exif in exif(i as u8 + 1) {
            let chunk = Some((*b"eXIf", &exif[..]));
            let bytes = png([3, 2], ::png::ColorType::Grayscale, ::png::BitDepth::Eight, chunk, &[0, 1, 2, 3, 4, 5]);
            let image = LightPicture::decode(&bytes, Some(TransferFunction::Linear)).expect("a picture").image;
            let found: Vec<u8> = image.texels().iter().map(|texel| (texel[0] * 255.0).round() as u8).collect();
            assert_eq!((image.width(), &found[..]), (if i < 4 { 3 } else { 2 }, expected.as_flattened()), "{i}");
        }
    }
    // The left half of a JPEG is white. A quarter turn clockwise moves it up.
    let mut bytes = Vec::new();
    let mut encoder = jpeg_encoder::Encoder::new(&mut bytes, 100);
    encoder.add_exif_metadata(&exif(6)[1]).expect("Exif");
    let pixels: Vec<u8> = (0..256).map(|i| if i % 32 < 16 { 255 } else { 0 }).collect();
    encoder.encode(&pixels, 32, 8, jpeg_encoder::ColorType::Luma).expect("a JPEG");
    let image = decoded(&bytes).image;
    assert_eq!((image.width(), image.height()), (8, 32));
    assert!(image.row(1).iter().all(|x| x[0] > 0.9) && image.row(30).iter().all(|x| x[0] < 0.1));
    // Damaged metadata count as none.
    for damaged in
        [exif(9)[0].clone(), exif(0)[1].clone(), exif(6)[0][..20].to_vec(), b"II\x2a\0\xff\xff\xff\xff".to_vec()]
    {
        assert_eq!(super::decode::orientation(Some(&damaged)), 1, "{damaged:?}");
    }
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
