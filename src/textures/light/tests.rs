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
    let pq = rgb8(Some((*b"cICP", &[1, 16, 0, 1])));
    assert_eq!(LightPicture::decode(&pq, None), Err(LightFileError::Transfer(16)));
    let linear = LightPicture::decode(&pq, Some(TransferFunction::Linear)).expect("a picture");
    assert_eq!(linear.image.texels()[0], [0.0, 128.0 / 255.0, 1.0]);
    let bent = exr(&["R", "G", "B"], vec![0.5; 6]);
    let bent = LightPicture::decode(&bent, Some(TransferFunction::Srgb)).expect("a picture");
    assert!((bent.image.texels()[0][0] - 0.214_041).abs() < 1e-5);
}

/// An ICC profile from this space to XYZ.
fn icc(space: &[u8], tags: &[(&[u8; 4], Vec<u8>)]) -> Vec<u8> {
    let mut bytes = vec![0; 128];
    bytes[16..20].copy_from_slice(space);
    bytes[20..24].copy_from_slice(b"XYZ ");
    bytes.extend((tags.len() as u32).to_be_bytes());
    let mut at = 132 + 12 * tags.len();
    for (name, data) in tags {
        bytes.extend([&name[..], &(at as u32).to_be_bytes(), &(data.len() as u32).to_be_bytes()].concat());
        at += data.len();
    }
    for (_, data) in tags {
        bytes.extend(data);
    }
    bytes
}

/// A tag's data: its kind, four zeros, these bytes, and numbers with 16 bits after the point.
fn tag(kind: &[u8], bytes: &[u8], numbers: &[f64]) -> Vec<u8> {
    let numbers = numbers.iter().flat_map(|x| ((x * 65_536.0).round() as i32).to_be_bytes());
    [kind, &[0; 4], bytes].concat().into_iter().chain(numbers).collect()
}

/// The sRGB curve as a formula.
fn srgb_formula() -> Vec<u8> {
    tag(b"para", &[0, 3, 0, 0], &[2.4, 1.0 / 1.055, 0.055 / 1.055, 1.0 / 12.92, 0.04045])
}

/// An ICC profile with the same curve for each channel.
fn rgb_icc(curve: &[u8], columns: [[f64; 3]; 3]) -> Vec<u8> {
    let [red, green, blue] = columns.map(|xyz| tag(b"XYZ ", &[], &xyz));
    let curves = [b"rTRC", b"gTRC", b"bTRC"].map(|name| (name, curve.to_vec()));
    let matrix = [(b"rXYZ", red), (b"gXYZ", green), (b"bXYZ", blue)];
    icc(b"RGB ", &[&curves[..], &matrix[..]].concat())
}

/// The columns of widespread profiles for sRGB and Display P3.
const SRGB: [[f64; 3]; 3] = [[0.43607, 0.22249, 0.01392], [0.38515, 0.71687, 0.09708], [0.14307, 0.06061, 0.7141]];
const P3: [[f64; 3]; 3] = [[0.51512, 0.2412, -0.00105], [0.29198, 0.69225, 0.04189], [0.1571, 0.06657, 0.78407]];

/// Red, green and white, with a profile.
fn png_with_icc(icc: &[u8]) -> Vec<u8> {
    let mut info = ::png::Info::with_size(3, 1);
    (info.color_type, info.icc_profile) = (::png::ColorType::Rgb, Some(icc.into()));
    let mut bytes = Vec::new();
    let mut writer = ::png::Encoder::with_info(&mut bytes, info).expect("a header").write_header().expect("a header");
    writer.write_image_data(&[255, 0, 0, 0, 255, 0, 255, 255, 255]).expect("pixels");
    writer.finish().expect("an end");
    bytes
}

/// A JPEG of one colour.
fn jpeg_of(colour: [u8; 3], change: impl FnOnce(&mut jpeg_encoder::Encoder<&mut Vec<u8>>)) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = jpeg_encoder::Encoder::new(&mut bytes, 100);
    change(&mut encoder);
    encoder.encode(&colour.repeat(64), 8, 8, jpeg_encoder::ColorType::Rgb).expect("a JPEG");
    bytes
}

/// Red, green and white with the primaries of Display P3 and BT.2020, as their known matrices to BT.709 convert them.
/// Negative parts are zero.
#[test]
fn stated_primaries_become_bt709() {
    const WIDE: [[[f32; 3]; 2]; 2] =
        [[[1.2249, 0.0, 0.0], [0.0, 1.042, 0.0]], [[1.6605, 0.0, 0.0], [0.0, 1.1329, 0.0]]];
    let check = |what: &str, bytes: &[u8], [red, green]: [[f32; 3]; 2]| {
        let picture = decoded(bytes);
        for (found, wanted) in picture.image.texels().iter().zip([red, green, [1.0; 3]]) {
            assert!((0..3).all(|c| (found[c] - wanted[c]).abs() < 1e-3), "{what}: {found:?} {wanted:?}");
        }
        picture.primaries.to_string()
    };
    let pixels = [255, 0, 0, 0, 255, 0, 255, 255, 255];
    let with = |kind: &[u8; 4], data: &[u8]| {
        png([3, 1], ::png::ColorType::Rgb, ::png::BitDepth::Eight, Some((*kind, data)), &pixels)
    };
    let [p3, bt2020] = [
        [0.3127, 0.329, 0.68, 0.32, 0.265, 0.69, 0.15, 0.06],
        [0.3127, 0.329, 0.708, 0.292, 0.17, 0.797, 0.131, 0.046],
    ];
    for (numbers, code, name, wanted) in [(p3, 12, "Display P3", WIDE[0]), (bt2020, 9, "BT.2020", WIDE[1])] {
        let chrm: Vec<u8> = numbers.iter().flat_map(|x: &f64| ((x * 1e5).round() as u32).to_be_bytes()).collect();
        assert_eq!(check("cHRM", &with(b"cHRM", &chrm), wanted), name);
        assert_eq!(check("cICP", &with(b"cICP", &[code, 13, 0, 1]), wanted), name);

        let [wx, wy, rx, ry, gx, gy, bx, by] = numbers;
        let line = format!("PRIMARIES= {rx} {ry} {gx} {gy} {bx} {by} {wx} {wy}\n");
        let pixels = [[128, 0, 0, 129], [0, 128, 0, 129], [128, 128, 128, 129]];
        let hdr = [b"#?RADIANCE\n", line.as_bytes(), b"\n-Y 1 +X 3\n", pixels.as_flattened()].concat();
        assert_eq!(check("PRIMARIES", &hdr, wanted), name);
        let seven = String::from_utf8_lossy(&hdr).replacen("PRIMARIES= 0", "PRIMARIES= x", 1);
        assert!(LightPicture::decode(seven.as_bytes(), None).is_err());

        let colour = |at: Vec2<usize>| [(1.0_f32, 0.0_f32, 0.0_f32), (0.0, 1.0, 0.0), (1.0, 1.0, 1.0)][at.0];
        let channels = SpecificChannels::rgb(colour);
        let layer = Layer::new((3, 1), LayerAttributes::named("picture"), Encoding::default(), channels);
        let mut image = Image::from_layer(layer);
        let xy = |x: f64, y: f64| Vec2(x as f32, y as f32);
        image.attributes.chromaticities = Some(exr::meta::attribute::Chromaticities {
            red: xy(rx, ry),
            green: xy(gx, gy),
            blue: xy(bx, by),
            white: xy(wx, wy),
        });
        let mut file = Cursor::new(Vec::new());
        image.write().non_parallel().to_buffered(&mut file).expect("EXR");
        assert_eq!(check("chromaticities", &file.into_inner(), wanted), name);
    }
    let profile = rgb_icc(&srgb_formula(), P3);
    assert_eq!(check("iCCP", &png_with_icc(&profile), WIDE[0]), "of an ICC profile");
    let red = jpeg_of([254, 0, 0], |encoder| encoder.add_icc_profile(&profile).expect("a profile"));
    let found = decoded(&red).image.texels()[0];
    assert!(found[0] > 1.21 && found[1] == 0.0 && found[2] == 0.0, "{found:?}");
    // The chunk sRGB has priority over cHRM, and cICP over iCCP.
    let mut info = with(b"cHRM", &[0; 32]);
    assert!(LightPicture::decode(&info, None).expect_err("black primaries").to_string().contains("do not enclose"));
    let at = 33;
    info.splice(at..at, *b"\0\0\0\x01sRGB\0\xae\xce\x1c\xe9");
    assert_eq!(decoded(&info).primaries.to_string(), "BT.709");
    let mut info = png_with_icc(&profile);
    let mut chunk = b"cICP\x01\x0d\0\x01".to_vec();
    let mut crc = flate2_crc(&chunk);
    crc.reverse();
    chunk.splice(0..0, 4_u32.to_be_bytes());
    chunk.extend(crc);
    info.splice(at..at, chunk);
    assert_eq!(decoded(&info).primaries.to_string(), "BT.709");
    assert!(LightPicture::decode(&with(b"cICP", &[10, 13, 0, 1]), None).is_err());
}

#[test]
fn profiles_are_read_exactly_or_refused() {
    let curves = |curve: &[u8]| decoded(&png_with_icc(&rgb_icc(curve, SRGB)));
    let exact = decoded(&png(
        [3, 1],
        ::png::ColorType::Rgb,
        ::png::BitDepth::Eight,
        None,
        &[255, 0, 0, 0, 255, 0, 255, 255, 255],
    ));
    // sRGB as a formula and as samples, which the most common profile has.
    let linear = |i: u32| Curve::Srgb.linear(0, f64::from(i) / 1023.0);
    let samples: Vec<u8> = (0..1024).flat_map(|i| ((linear(i) * 65_535.0).round() as u16).to_be_bytes()).collect();
    let sampled = tag(b"curv", &[&1024_u32.to_be_bytes(), &samples[..]].concat(), &[]);
    for curve in [&srgb_formula(), &sampled] {
        assert_eq!(curves(curve), exact);
    }
    assert_eq!(curves(&tag(b"curv", &[0; 4], &[])).curve, Curve::Linear);
    let at = |curve: &[u8], x: u8| {
        let profile = icc(b"GRAY", &[(b"kTRC", curve.to_vec())]);
        let mut info = ::png::Info::with_size(1, 1);
        info.icc_profile = Some(profile.into());
        let mut bytes = Vec::new();
        let mut writer =
            ::png::Encoder::with_info(&mut bytes, info).expect("a header").write_header().expect("a header");
        writer.write_image_data(&[x]).expect("pixels");
        writer.finish().expect("an end");
        decoded(&bytes).image.texels()[0]
    };
    let x = 100.0 / 255.0_f64;
    for (curve, wanted) in [
        (tag(b"curv", &[0, 0, 0, 1, 2, 0x80], &[]), x.powf(2.5)),
        (tag(b"para", &[0; 4], &[3.0]), x.powi(3)),
        (tag(b"para", &[0, 1, 0, 0], &[2.0, 2.0, -0.5]), (2.0 * x - 0.5).powi(2)),
        (tag(b"para", &[0, 1, 0, 0], &[2.0, 1.0, -0.5]), 0.0),
        (tag(b"para", &[0, 2, 0, 0], &[2.0, 2.0, -0.5, 0.125]), (2.0 * x - 0.5).powi(2) + 0.125),
        (tag(b"para", &[0, 2, 0, 0], &[2.0, 1.0, -0.5, 0.125]), 0.125),
        (tag(b"para", &[0, 3, 0, 0], &[2.0, 1.0, 0.0, 0.5, 0.75]), 0.5 * x),
        (tag(b"para", &[0, 4, 0, 0], &[2.0, 1.0, 0.0, 0.5, 0.25, 0.125, 0.0]), x * x + 0.125),
        (tag(b"para", &[0, 4, 0, 0], &[2.0, 1.0, 0.0, 0.5, 0.75, 0.125, 0.25]), 0.5 * x + 0.25),
    ] {
        let [r, g, b] = at(&curve, 100);
        assert!((f64::from(r) - wanted).abs() < 1e-5 && r == g && g == b, "{r} {g} {b} {wanted}");
    }
    let said = |profile: &[u8]| {
        let jpeg = jpeg_of([9; 3], |encoder| encoder.add_icc_profile(profile).expect("a profile"));
        let [jpeg, png] =
            [jpeg, png_with_icc(profile)].map(|bytes| LightPicture::decode(&bytes, None).expect_err("refused"));
        assert_eq!(jpeg, png);
        jpeg.to_string()
    };
    let cmyk = said(&icc(b"CMYK", &[]));
    assert!(cmyk.contains("«CMYK» to «XYZ »") && cmyk.contains("-profile sRGB.icc"), "{cmyk}");
    let tables = [(b"A2B0", vec![0; 32]), (b"kTRC", srgb_formula())];
    let profiles = [icc(b"GRAY", &tables), rgb_icc(&tag(b"para", &[0, 5, 0, 0], &[2.0, 2.0, -0.5]), SRGB)];
    for profile in [b"RGB ", b"GRAY"].map(|space| icc(space, &[])).into_iter().chain(profiles) {
        assert!(said(&profile).contains("only a matrix with curves is"));
    }
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

/// JPEGs of 64 x 64 pixels: smooth and rough, in each way that the encoder has to store them. Bits of the index are
/// progressive, optimized, fewer colours, and restarts.
fn jpegs() -> Vec<Vec<u8>> {
    let smooth = vec![128; 3 * 64 * 64];
    let rough: Vec<u8> = (0..3 * 64 * 64_u32).map(|i| (i.wrapping_mul(2_654_435_761) >> 24) as u8).collect();
    let mut list = Vec::new();
    for pixels in [&smooth, &rough] {
        for way in 0..16 {
            let mut bytes = Vec::new();
            let mut encoder = jpeg_encoder::Encoder::new(&mut bytes, 60);
            encoder.set_progressive(way & 1 != 0);
            encoder.set_optimized_huffman_tables(way & 2 != 0);
            let sampling = [jpeg_encoder::SamplingFactor::R_4_4_4, jpeg_encoder::SamplingFactor::R_4_2_0];
            encoder.set_sampling_factor(sampling[way >> 2 & 1]);
            if way & 8 != 0 {
                encoder.set_restart_interval(4);
            }
            encoder.encode(pixels, 64, 64, jpeg_encoder::ColorType::Rgb).expect("a JPEG");
            list.push(bytes);
        }
    }
    list
}

#[test]
fn jpegs_with_too_few_pixels_are_refused() {
    let jpegs = jpegs();
    for (way, whole) in jpegs.iter().enumerate() {
        let found = LightPicture::decode(whole, None);
        // The encoder stores optimized colours in separate scans.
        if way & 0b11 == 0b10 {
            let said = found.expect_err("separate scans").to_string();
            assert!(said.contains("save it with one scan, or progressive"), "{said}");
            continue;
        }
        let picture = found.unwrap_or_else(|error| panic!("{way}: {error}"));
        assert!(picture == decoded(&jpegs[way & !0b1011]), "{way}");
        // Other images and metadata may follow the first image.
        assert!(decoded(&[&whole[..], whole, b"more"].concat()) == picture, "{way}");
        for tenths in 1..10 {
            let cut = &whole[..whole.len() * tenths / 10];
            assert!(LightPicture::decode(cut, None).is_err(), "{way}: {tenths} tenths");
            // Adding an end marker does not make the file valid. The last scans of an even progressive JPEG add nothing.
            let closed = LightPicture::decode(&[cut, &[0xff, 0xd9]].concat(), None);
            assert!(closed.is_err() || closed == Ok(picture.clone()), "{way}: {tenths} tenths with an end");
        }
        let at = whole.windows(2).position(|pair| matches!(pair, [0xff, 0xc0 | 0xc2])).expect("a header");
        for [width, height] in [[64, 80], [80, 64], [2048, 2048]] {
            let mut larger = whole.clone();
            larger[at + 5..at + 9].copy_from_slice(&[[0, height as u8], [0, width as u8]].concat());
            if width == 2048 {
                larger[at + 5..at + 9].copy_from_slice(&[8, 0, 8, 0]);
            }
            assert!(LightPicture::decode(&larger, None).is_err(), "{way}: {width} x {height}");
        }
    }
}

#[test]
fn channels_that_are_not_read_are_few() {
    let of = |count: usize| {
        let names: Vec<String> = (3..count).map(|i| format!("Z{i}")).collect();
        let names: Vec<&str> = ["R", "G", "B"].into_iter().chain(names.iter().map(String::as_str)).collect();
        LightPicture::decode(&exr(&names, vec![0.5; 2 * count]), None)
    };
    assert_eq!(of(16).expect("a picture").image.texels(), [[0.5; 3]; 2]);
    let said = of(17).expect_err("too many").to_string();
    assert!(said.contains("a part has 17 channels; at most 16 are allowed"), "{said}");
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
