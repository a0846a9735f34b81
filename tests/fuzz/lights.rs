//! Pictures and profiles of lights.

use ltcforge::{
    light::textured::{LightImage, LightPyramid},
    textures::{About, LightPicture, LightTexels, Profile, TextureContainer, light_texture_files},
};

use super::target::Target;

/// The largest number of pixels in a decoded picture.
const MOST_PIXELS: u64 = 1 << 18;

fn png(color: png::ColorType, depth: png::BitDepth, pixels: &[u8]) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, 2, 2);
    encoder.set_color(color);
    encoder.set_depth(depth);
    encoder.set_source_gamma(png::ScaledFloat::new(1.0));
    if color == png::ColorType::Indexed {
        encoder.set_palette(vec![0, 1, 2, 250, 251, 252]);
    }
    encoder.write_header().expect("a header").write_image_data(pixels).expect("pixels");
    bytes
}

fn jpeg() -> Vec<u8> {
    let mut bytes = Vec::new();
    let pixels = [[200_u8, 100, 50]; 64].concat();
    jpeg_encoder::Encoder::new(&mut bytes, 90).encode(&pixels, 8, 8, jpeg_encoder::ColorType::Rgb).expect("a JPEG");
    bytes
}

fn exr() -> Vec<u8> {
    let image = LightImage::new(2, 2, vec![[1.0, 0.5, 0.25]; 4]).expect("an image");
    let about = About::new(["a seed"]);
    let files =
        light_texture_files("seed", &LightPyramid::new(&image), TextureContainer::Exr, LightTexels::Rgba16f, &about);
    files.expect("files").files.remove(0).bytes
}

/// Four uncompressed pixels, and a line of eight pixels with a run in each channel.
fn radiance() -> [Vec<u8>; 2] {
    let flat =
        [b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 2 +X 2\n".as_slice(), &[128, 64, 32, 129].repeat(4)].concat();
    let run = [128 + 8, 200];
    let line = [[2, 2, 0, 8].as_slice(), &run, &run, &run, &run].concat();
    [flat, [b"#?RGBE\nEXPOSURE=2\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 8\n".as_slice(), &line].concat()]
}

#[test]
fn pictures() {
    let [flat, runs] = radiance();
    let seeds = vec![
        png(png::ColorType::Rgb, png::BitDepth::Eight, &[7; 12]),
        png(png::ColorType::Rgba, png::BitDepth::Sixteen, &[7; 32]),
        png(png::ColorType::Indexed, png::BitDepth::One, &[0b0100_0000, 0b1000_0000]),
        jpeg(),
        exr(),
        flat,
        runs,
    ];
    for seed in &seeds {
        LightPicture::decode(seed, None).expect("a valid seed");
    }
    let words = [
        "IHDR",
        "IDAT",
        "PLTE",
        "tRNS",
        "cICP",
        "gAMA",
        "cHRM",
        "-Y ",
        "+X ",
        "FORMAT=",
        "PRIMARIES=",
        "\n",
        "channels\0",
        "chlist\0",
    ];
    Target { name: "picture", seeds, words: &words, inputs: 1500 }.survive(|bytes| {
        match LightPicture::decode_within(bytes, None, MOST_PIXELS) {
            Ok(picture) => {
                assert!(picture.image.texels().iter().flatten().all(|number| number.is_finite() && *number >= 0.0));
                format!("{} {}", picture.format.name(), picture.curve)
            }
            // Names and checksums of chunks come from the file, so they are removed.
            Err(error) => error.to_string().split("ChunkType").next().unwrap_or_default().to_owned(),
        }
    });
}

#[test]
fn profiles() {
    let round = "IESNA:LM-63-2002\n[TEST] a seed\nTILT=NONE\n1 -1 1 3 1 1 2 0 0 0\n1 1 20\n0 45 90\n0\n100 50 0\n";
    let quarters = "IESNA91\nTILT=NONE\n1,1000,2,2,3,1,1,0.1,0.1,0,1,1,50\n0 180\n0 45 90\n1 2 3 4 5 6\n";
    let seeds = [round, quarters].map(|text| text.as_bytes().to_vec()).to_vec();
    for seed in &seeds {
        Profile::parse(seed).expect("a valid seed");
    }
    let words = ["TILT=NONE\n", "TILT=INCLUDE\n", " ", ",", "\n", "0 90", "0 180", "360"];
    Target { name: "profile", seeds, words: &words, inputs: 1500 }.survive(|bytes| match Profile::parse(bytes) {
        Ok(profile) => {
            let image = profile.image();
            assert!(image.texels().iter().flatten().all(|number| number.is_finite() && *number >= 0.0));
            "a profile".to_owned()
        }
        Err(error) => error.to_string(),
    });
}
