//! `light-texture`, tested with the binary.

use std::{fs, path::Path};

use ltcforge::{Digest, light::textured::LightPyramid, textures::LightPicture};
use serde_json::Value;

use crate::common::command::run;

/// A PNG of 6 x 4 pixels.
fn picture(folder: &Path) {
    picture_of(folder, [6, 4]);
}

/// A PNG file `sign.png`.
fn picture_of(folder: &Path, [width, height]: [u32; 2]) {
    let file = fs::File::create(folder.join("sign.png")).expect("a file");
    let mut encoder = png::Encoder::new(file, width, height);
    encoder.set_color(png::ColorType::Rgb);
    let pixels: Vec<u8> = (0..3 * width * height).map(|i| (i as u8).wrapping_mul(37)).collect();
    encoder.write_header().expect("a header").write_image_data(&pixels).expect("pixels");
}

#[test]
fn a_picture_becomes_one_file_with_all_levels() {
    let folder = tempfile::tempdir().expect("a folder");
    let here = folder.path();
    picture(here);
    let output = run(here, ["light-texture", "sign.png", "-o", "a/b", "--light", "3x1", "--json"]).exited(0).stdout;
    let output: Value = serde_json::from_str(&output).expect("JSON");
    assert_eq!([&output["format"], &output["transfer"], &output["primaries"]], ["PNG", "srgb", "BT.709"]);
    assert_eq!((&output["picture"], &output["size"]), (&serde_json::json!([6, 4]), &serde_json::json!([12, 4])));
    let bytes = fs::read(here.join("a/b/light.ktx2")).expect("the file");
    assert_eq!(output["files"][0]["sha256"], Digest::of(&bytes).hex());
    let reader = ktx2::Reader::new(&bytes).expect("KTX2");
    assert_eq!([reader.header().pixel_width, reader.header().pixel_height, reader.header().level_count], [12, 4, 4]);
    assert_eq!(output["levels"], 4);
    let about = reader.key_value_data().find(|(key, _)| *key == "ltcforge").expect("about").1;
    assert!(String::from_utf8_lossy(about).contains("square on a light of 3 x 1"));

    // The same levels in separate files, as the library makes them on one thread.
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
    assert!(
        said.starts_with("PNG, 6 x 4 pixels, srgb, BT.709; 3 levels from 6 x 4 texels, rgba32f\nc/tv_0.exr  "),
        "{said}"
    );
    let decode =
        |path: &str| LightPicture::decode(&fs::read(here.join(path)).expect("a file"), None).expect("a picture");
    let pyramid = LightPyramid::new(&decode("sign.png").image);
    for (i, level) in pyramid.levels().iter().enumerate() {
        assert_eq!(&decode(&format!("c/tv_{i}.exr")).image, level);
    }
}

/// Texels are square on a light of this size, with at most 8192 texels per side. This picture loses every second pixel.
#[test]
fn a_picture_that_becomes_coarser_is_reported() {
    let folder = tempfile::tempdir().expect("a folder");
    let here = folder.path();
    picture_of(here, [16384, 2]);
    let said = |more: &[&str]| {
        let line = ["light-texture", "sign.png", "-o", "out"].into_iter().chain(more.iter().copied());
        run(here, line).exited(0).stdout
    };
    let coarser = said(&["--light", "8192x1"]);
    assert!(coarser.contains("BT.709; 14 levels from 8192 x 1 texels"), "{coarser}");
    assert!(
        coarser.contains("coarser than the picture: the limit is 8192 texels per side and 16777216 in total\n"),
        "{coarser}"
    );
    assert!(!said(&[]).contains("coarser"), "{}", said(&[]));
    // Coarser along only one side.
    picture_of(here, [776, 866]);
    let coarser = said(&["--light", "20x1"]);
    assert!(coarser.contains("8192 x 410 texels") && coarser.contains("coarser than the picture"), "{coarser}");
}

#[test]
fn a_profile_becomes_a_picture_of_its_directions() {
    let folder = tempfile::tempdir().expect("a folder");
    let here = folder.path();
    let profile = "IESNA:LM-63-2002\nTILT=NONE\n1 -1 1 3 1 1 2 0 0 0 1 1 9\n0 45 90 0\n800 400 0\n";
    fs::write(here.join("spot.ies"), profile).expect("a file");
    let line = ["light-texture", "spot.ies", "-o", "out", "--as", "exr"];
    let said = run(here, line).exited(0).stdout;
    assert!(
        said.starts_with("IES LM-63, 1 x 3 angles, linear, BT.709; 10 levels from 512 x 512 texels, rgba16f\n"),
        "{said}"
    );
    let image =
        LightPicture::decode(&fs::read(here.join("out/light_0.exr")).expect("a file"), None).expect("a picture");
    // The finest level is blurred by two texels. Around 45 degrees the radiance decreases evenly.
    let texel = f64::from(image.image.row(256)[256 + 64][1]);
    assert!((texel / (400.0 * 2.0_f64.sqrt()) - 1.0).abs() < 0.03, "{texel}");
    let line = ["light-texture", "spot.ies", "-o", "none", "--light", "1x2", "--transfer", "srgb"];
    let ran = run(here, line).exited(1);
    let wanted = "spot.ies: an IES profile is always linear and has no light size: leave out light and transfer";
    assert!(ran.stderr.contains(wanted), "{}", ran.stderr);
    fs::write(here.join("broken.ies"), profile.replace("800", "-800")).expect("a file");
    let ran = run(here, ["light-texture", "broken.ies", "-o", "none"]).exited(1);
    let wanted = "broken.ies: not a readable IES LM-63 file: candela 1 is -800; candelas must not be negative";
    assert!(ran.stderr.contains(wanted), "{}", ran.stderr);
    assert!(!here.join("none").exists());
}

#[test]
fn files_that_are_not_pictures_are_named_and_nothing_is_written() {
    let folder = tempfile::tempdir().expect("a folder");
    let here = folder.path();
    picture(here);
    fs::write(here.join("text.png"), "no picture").expect("a file");
    // A Radiance HDR file for two pixels, with only one pixel.
    fs::write(here.join("short.hdr"), b"#?RADIANCE\n\n-Y 1 +X 2\n\x01\x02\x03\x80").expect("a file");
    for (file, more, exit, said) in [
        (
            "text.png",
            [].as_slice(),
            1,
            "text.png: this file is neither a readable image nor a readable profile; allowed: PNG, OpenEXR, Radiance HDR, JPEG, IES LM-63",
        ),
        ("short.hdr", &[], 1, "short.hdr: not a readable Radiance HDR file"),
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
