//! Pictures of lights over HTTP: sent, prefiltered, kept by digest.

use ltcforge::Digest;
use serde_json::{Value, json};

use crate::{
    brdfs::OCTETS,
    common::{
        command::run,
        server::{Server, text},
    },
};

const PNG: (&str, &str) = ("content-type", "image/png");

/// A PNG of 6 x 4 pixels, another for each seed.
fn picture(seed: u8) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, 6, 4);
    encoder.set_color(png::ColorType::Rgb);
    let pixels: Vec<u8> = (0_u8..72).map(|i| i.wrapping_mul(seed)).collect();
    encoder.write_header().expect("a header").write_image_data(&pixels).expect("pixels");
    bytes
}

#[test]
fn a_picture_is_prefiltered_kept_and_deleted() {
    let folder = tempfile::tempdir().expect("a folder");
    let server = Server::start(folder.path(), &["--light-texture-limit", "2"]);
    let send =
        |query: &str, bytes: &[u8]| server.request("POST", &format!("/v1/light-textures{query}"), &[PNG], Some(bytes));
    let sent = send("?light=3x1&texels=rgb9e5&as=ktx2-zstd", &picture(37)).with_status(201);
    let stored = sent.json();
    let digest = text(&stored["digest"]).to_owned();
    assert_eq!(sent.header("location"), Some(format!("/v1/light-textures/{digest}").as_str()));
    assert_eq!((&stored["picture"], &stored["size"], &stored["levels"]), (&json!([6, 4]), &json!([12, 4]), &json!(4)));
    send("?light=3x1&texels=rgb9e5&as=ktx2-zstd", &picture(37)).with_status(200);

    let got = server.get(&format!("/v1/light-textures/{digest}")).with_status(200);
    assert_eq!(got.header("content-type"), Some("image/ktx2"));
    assert_eq!(Digest::of(&got.body).to_string(), digest);
    assert_eq!(stored["bytes"], got.body.len());
    let reader = ktx2::Reader::new(&got.body).expect("KTX2");
    let header = reader.header();
    assert_eq!([header.pixel_width, header.pixel_height, header.level_count], [12, 4, 4]);
    assert_eq!(header.format, Some(ktx2::Format::E5B9G9R9_UFLOAT_PACK32));
    // It is neither a table nor a BRDF.
    for of in ["tables", "brdfs"] {
        server.get(&format!("/v1/{of}/{digest}")).with_status(404);
        assert_eq!(server.get(&format!("/v1/{of}")).with_status(200).json()["items"], json!([]), "{of}");
    }

    let other = send("", &picture(38)).with_status(201).json();
    let full = send("", &picture(39)).with_status(507).json();
    assert_eq!(text(&full["type"]), "/problems/light-texture-limit");
    let first = server.get("/v1/light-textures?limit=1").with_status(200).json();
    assert_eq!(first["items"][0]["digest"], other["digest"], "newest first");
    let next = format!("/v1/light-textures?limit=1&cursor={}", text(&first["next"]));
    assert_eq!(text(&server.get(&next).with_status(200).json()["items"][0]["digest"]), digest);

    server.request("DELETE", &format!("/v1/light-textures/{digest}"), &[], None).with_status(204);
    let gone = server.get(&format!("/v1/light-textures/{digest}")).with_status(404).json();
    assert_eq!(text(&gone["type"]), "/problems/unknown-light-texture");
    server.request("DELETE", &format!("/v1/light-textures/{digest}"), &[], None).with_status(404);
    send("", &picture(39)).with_status(201);

    // What was acknowledged survives, and counts as no table.
    server.kill();
    let report = run(folder.path(), ["fsck", "--data", ".", "--json"]).exited(0).stdout;
    let report: Value = serde_json::from_str(&report).expect("JSON");
    assert_eq!((&report["clean"], &report["tables"]), (&json!(true), &json!(0)));
    let server = Server::start(folder.path(), &[]);
    let kept = server.get("/v1/light-textures").with_status(200).json();
    assert_eq!(kept["items"].as_array().map(Vec::len), Some(2));
}

#[test]
fn what_is_no_picture_is_refused_and_not_kept() {
    let folder = tempfile::tempdir().expect("a folder");
    let server = Server::start(folder.path(), &[]);
    let send = |query: &str, kind, bytes: &[u8]| {
        server.request("POST", &format!("/v1/light-textures{query}"), &[kind], Some(bytes))
    };
    let large = b"#?RADIANCE\n\n-Y 3000 +X 3000\n";
    let strip = [b"#?RADIANCE\n\n-Y 1 +X 2100\n".to_vec(), [64, 64, 64, 128].repeat(2100)].concat();
    for (query, kind, bytes, status, said) in [
        ("", OCTETS, b"no picture".as_slice(), 422, "allowed: PNG, OpenEXR, Radiance HDR, JPEG"),
        ("", OCTETS, large, 422, "3000 x 3000 pixels; 1 to 16384 along a side are allowed, and 4194304 in all"),
        ("?light=1x1", OCTETS, &strip, 422, "2100 x 2100 texels are square on the light; 4194304 are allowed in all"),
        ("?light=1", PNG, &picture(1), 400, "«1» is not a size of a light"),
        ("?texels=rgb8", PNG, &picture(1), 400, "rgb8"),
        ("?as=exr", PNG, &picture(1), 400, "exr"),
        ("?size=1x1", PNG, &picture(1), 400, "size"),
        ("", ("content-type", "text/plain"), &picture(1), 415, "is not that of a picture"),
    ] {
        let refused = send(query, kind, bytes).with_status(status).json();
        assert!(text(&refused["detail"]).contains(said), "{refused:#}");
    }
    assert_eq!(server.get("/v1/light-textures").with_status(200).json()["items"], json!([]));
}
