//! `light-texture`, by the binary.

use std::{fs, path::Path};

use ltcforge::{Digest, light::textured::LightPyramid, textures::LightPicture};
use serde_json::Value;

use crate::common::command::run;

/// A PNG of 6 x 4 pixels.
fn picture(folder: &Path) {
    let file = fs::File::create(folder.join("sign.png")).expect("a file");
    let mut encoder = png::Encoder::new(file, 6, 4);
    encoder.set_color(png::ColorType::Rgb);
    let pixels: Vec<u8> = (0_u8..72).map(|i| i.wrapping_mul(37)).collect();
    encoder.write_header().expect("a header").write_image_data(&pixels).expect("pixels");
}

#[test]
fn a_picture_becomes_one_file_of_all_levels() {
    let folder = tempfile::tempdir().expect("a folder");
    let here = folder.path();
    picture(here);
    let told = run(here, ["light-texture", "sign.png", "-o", "a/b", "--light", "3x1", "--json"]).exited(0).stdout;
    let told: Value = serde_json::from_str(&told).expect("JSON");
    assert_eq!([&told["format"], &told["transfer"]], ["PNG", "srgb"]);
    assert_eq!((&told["picture"], &told["size"]), (&serde_json::json!([6, 4]), &serde_json::json!([12, 4])));
    let bytes = fs::read(here.join("a/b/light.ktx2")).expect("the file");
    assert_eq!(told["files"][0]["sha256"], Digest::of(&bytes).hex());
    let reader = ktx2::Reader::new(&bytes).expect("KTX2");
    assert_eq!([reader.header().pixel_width, reader.header().pixel_height, reader.header().level_count], [12, 4, 4]);
    assert_eq!(told["levels"], 4);
    let about = reader.key_value_data().find(|(key, _)| *key == "ltcforge").expect("about").1;
    assert!(String::from_utf8_lossy(about).contains("square on a light of 3 x 1"));

    // The same levels one by one, as the library makes them, on one thread.
    let line = [
        "light-texture",
        "sign.png",
        "-o",
        "c",
        "--as",
        "exr",
        "--texels",
        "rgba32f",
        "--name",
        "tv",
        "--threads",
        "1",
    ];
    let said = run(here, line).exited(0).stdout;
    assert!(said.starts_with("PNG of 6 x 4 pixels, srgb; 6 x 4 texels, 3 levels, rgba32f\nc/tv_0.exr  "), "{said}");
    let decode =
        |path: &str| LightPicture::decode(&fs::read(here.join(path)).expect("a file"), None).expect("a picture");
    let pyramid = LightPyramid::new(&decode("sign.png").image);
    for (i, level) in pyramid.levels().iter().enumerate() {
        assert_eq!(&decode(&format!("c/tv_{i}.exr")).image, level);
    }
}

#[test]
fn what_is_no_picture_is_named_and_nothing_is_written() {
    let folder = tempfile::tempdir().expect("a folder");
    let here = folder.path();
    picture(here);
    fs::write(here.join("text.png"), "no picture").expect("a file");
    // Two pixels of Radiance HDR, then one.
    fs::write(here.join("short.hdr"), b"#?RADIANCE\n\n-Y 1 +X 2\n\x01\x02\x03\x80").expect("a file");
    for (file, more, exit, said) in [
        ("text.png", [].as_slice(), 1, "text.png: this file is not an image that can be read; allowed: PNG, OpenEXR"),
        ("short.hdr", &[], 1, "short.hdr: no Radiance HDR that can be read"),
        ("none.png", &[], 1, "none.png: "),
        ("sign.png", &["--as", "dds", "--texels", "rgb9e5"], 2, "texels is rgb9e5; dds allows rgba16f, rgba32f"),
        ("sign.png", &["--light", "3x0"], 2, "a width and a height above zero"),
    ] {
        let line = ["light-texture", file, "-o", "out"].into_iter().chain(more.iter().copied());
        let ran = run(here, line).exited(exit);
        assert!(ran.stderr.contains(said), "{}", ran.stderr);
        assert!(!here.join("out").exists(), "{file}");
    }
}
