//! Measures the memory that hostile bodies take in addition to their own bytes, for every format that the service
//! parses. Each body is read in its own process.

use std::{env, fs, process::Command};

use crate::Scene;
use ltcforge_files::{
    recipe_document::{DEFAULT_ENTRY_LIMIT, parse},
    tabulated,
};
use ltcforge_textures::{LightPicture, Profile};

/// Environment variable that names the body in the process that reads it.
const VARIABLE: &str = "LTCFORGE_TEST_HOSTILE_BODY";
/// The size of a body in bytes.
const BODY: usize = 60_000_000;
/// Maximum bytes that reading a body may take in addition to the body.
const MOST: u64 = 256 << 20;
/// Numbers of parts that are just within the limits of a document.
const WITHIN: usize = 500_000;
const VALUES_WITHIN: usize = 2_097_000;

/// A body of `part`, repeated, between `start` and `end`.
fn filled(start: &str, part: &str, end: &str) -> Vec<u8> {
    times(start, part, BODY / part.len(), end)
}

fn times(start: &str, part: &str, count: usize, end: &str) -> Vec<u8> {
    [start, &part.repeat(count), end].concat().into_bytes()
}

/// An object with distinct names, about as many as a scene may have values.
fn distinct(start: &str, end: &str) -> Vec<u8> {
    let names: Vec<String> = (0..VALUES_WITHIN).map(|number| format!(r#""{number:07}":0"#)).collect();
    [start, &names.join(","), end].concat().into_bytes()
}

/// Views that each decode from one megabyte to 64: the first takes all bytes that views may decode to.
fn compressed() -> Vec<u8> {
    const COUNT: usize = 1 << 24;
    // A header, the heads of all groups of zeros, and the first element.
    let source = [&[0xa0][..], &vec![0; COUNT / 16], &[0; 32]].concat();
    let view = format!(
        r#"{{"buffer":0,"byteLength":4,"extensions":{{"EXT_meshopt_compression":{{"buffer":0,"byteLength":{},"byteStride":4,"count":{COUNT},"mode":"ATTRIBUTES"}}}}}}"#,
        source.len()
    );
    let views = vec![view; 500].join(",");
    let mut json = format!(r#"{{"buffers":[{{"byteLength":{}}}],"bufferViews":[{views}]}}"#, source.len()).into_bytes();
    json.resize(json.len().next_multiple_of(4), b' ');
    let word = |number: usize| (number as u32).to_le_bytes();
    let length = 28 + json.len() + source.len();
    let head = [&b"glTF"[..], &word(2), &word(length), &word(json.len()), b"JSON"].concat();
    [&head[..], &json, &word(source.len()), b"BIN\0", &source].concat()
}

fn png_of(chunk: &[u8]) -> Vec<u8> {
    let header = b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR\0\0\0\x01\0\0\0\x01\x08\0\0\0\0\x3a\x7e\x9b\x55";
    [&header[..], &chunk.repeat(BODY / chunk.len())].concat()
}

fn jpeg_of(segment: &[u8]) -> Vec<u8> {
    [&b"\xff\xd8"[..], &segment.repeat(BODY / segment.len())].concat()
}

fn exr_of(attribute: &[u8], name_at: Option<usize>) -> Vec<u8> {
    let mut bytes = b"\x76\x2f\x31\x01\x02\0\0\0".to_vec();
    for number in 0..BODY / attribute.len() {
        let start = bytes.len();
        bytes.extend(attribute);
        if let Some(at) = name_at {
            bytes[start + at..start + at + 8].copy_from_slice(format!("{number:08}").as_bytes());
        }
    }
    bytes
}

type Read = fn(Vec<u8>) -> String;

const SCENE: Read = |bytes| Scene::from_bytes(bytes, &|| true).expect_err("hostile").to_string();
const LIST: Read = |bytes| Scene::from_list(&bytes).expect_err("hostile").to_string();
const RECIPE: Read = |bytes| parse(&bytes, DEFAULT_ENTRY_LIMIT).expect_err("hostile").to_string();
const PICTURE: Read = |bytes| LightPicture::decode(&bytes, None).expect_err("hostile").to_string();
const PROFILE: Read = |bytes| Profile::parse(&bytes).expect_err("hostile").to_string();
const TABULATED: Read = |bytes| tabulated::decode(&bytes).expect_err("hostile").to_string();

type Body = (&'static str, fn() -> Vec<u8>, Read, &'static str);

/// Each body with its reader, and a part of the reader's error.
const BODIES: [Body; 31] = [
    ("nodes", || filled(r#"{"nodes":["#, "{},", "{}]}"), SCENE, "/nodes: more than 524288 objects and lists"),
    ("nodes as lists", || filled(r#"{"nodes":["#, "[],", "[]]}"), SCENE, "/nodes: more than 524288"),
    ("nodes within", || times(r#"{"nodes":["#, "{},", WITHIN, "{}]}"), SCENE, "/nodes: 500001; at most 262144"),
    ("children", || filled(r#"{"nodes":[{"children":["#, "0,", "0]}]}"), SCENE, "/nodes: more than 2097152 values"),
    (
        "accessors",
        || filled(r#"{"accessors":["#, r#"{"componentType":1,"count":1,"type":""},"#, "0]}"),
        SCENE,
        "/accessors: more than 524288",
    ),
    (
        "materials within",
        || times(r#"{"materials":["#, "{},", WITHIN, "{}]}"),
        SCENE,
        "/materials: 500001; at most 4096",
    ),
    ("textures", || filled(r#"{"textures":["#, "{},", "{}]}"), SCENE, "/textures: more than 524288"),
    ("images", || filled(r#"{"images":["#, "{},", "{}]}"), SCENE, "/images: more than 524288"),
    (
        "primitives within",
        || times(r#"{"meshes":["#, r#"{"primitives":[{"attributes":{"A":0}}]},"#, WITHIN / 4, "{}]}"),
        SCENE,
        "/meshes/0/primitives/0/attributes/A: 0 is out of range",
    ),
    (
        "extensions within",
        || times(r#"{"materials":["#, r#"{"extensions":{"a":{}}},"#, WITHIN / 3, "{}]}"),
        SCENE,
        "/materials: 166667; at most 4096",
    ),
    (
        "names of extensions",
        || filled(r#"{"extensionsUsed":["#, r#""a","#, r#""a"]}"#),
        SCENE,
        "more than 2097152 values",
    ),
    (
        "distinct extensions",
        || {
            let used =
                r#"{"nodes":[{"mesh":0}],"meshes":[{"primitives":[{"material":0}]}],"materials":[{"extensions":{"#;
            distinct(used, "}}]}")
        },
        SCENE,
        "no surface",
    ),
    (
        "distinct attributes",
        || distinct(r#"{"meshes":[{"primitives":[{"attributes":{"#, "}}]}]}"),
        SCENE,
        "is out of range",
    ),
    ("names within", || times(r#"{"extensionsRequired":["#, r#""a","#, VALUES_WITHIN, r#""a"]}"#), SCENE, "no surface"),
    ("a name", || filled(r#"{"meshes":[{"name":""#, "a", r#""}]}"#), SCENE, "no surface"),
    (
        "lights within",
        || times(r#"{"extensions":{"EXT_lights_area":{"lights":["#, "{},", WITHIN, "{}]}}}"),
        SCENE,
        "no surface",
    ),
    (
        "nodes with lights within",
        || {
            let node = r#"{"extensions":{"EXT_lights_area":{"light":0}}},"#;
            times(r#"{"extensions":{"EXT_lights_area":{"lights":[{}]}},"nodes":["#, node, WITHIN / 4, "{}]}")
        },
        SCENE,
        "nodes with lights: 125000; at most 4096",
    ),
    (
        "emissive primitives in many poses",
        || {
            let start = r#"{"materials":[{"emissiveFactor":[1,1,1],"emissiveTexture":{}}],"meshes":[{"primitives":["#;
            let poses = r#"{"mesh":0,"weights":[1]},"#.repeat(20_000);
            let end = format!(r#"{{"material":0}}]}}],"nodes":[{poses}{{}}]}}"#);
            times(start, r#"{"material":0},"#, 20_000, &end)
        },
        SCENE,
        "primitives of all meshes in their poses",
    ),
    ("compressed views", compressed, SCENE, "no surface"),
    ("a list", || filled(r#"{"materials":["#, "{},", "{}]}"), LIST, "/materials: more than 65536"),
    ("a list within", || times(r#"{"materials":["#, "{},", 60_000, "{}]}"), LIST, "/materials: 60001; at most 4096"),
    ("fields of a recipe", || filled("{", r#""a":0,"#, r#""b":0}"#), RECIPE, "more than 131072 values"),
    ("objects of a recipe", || filled(r#"{"fit":["#, r#"{"":0},"#, "0]}"), RECIPE, "/fit: more than 4096"),
    ("attributes", || exr_of(b"00000000\0int\0\x04\0\0\0abcd", Some(0)), PICTURE, "more than 4096 attributes"),
    ("an attribute", || exr_of(b"a\0string\0\0\0\0\x01a", None), PICTURE, "longer than 4194304 bytes"),
    ("lines", || filled("#?RADIANCE\n", "a=\n", "\n-Y 1 +X 0\n"), PICTURE, "0 x 1"),
    ("text of a PNG", || png_of(b"\0\0\0\x02tEXta\0\x90\xc5\x84\x6a"), PICTURE, "PNG"),
    ("a profile of a JPEG", || jpeg_of(b"\xff\xe2\0\x11ICC_PROFILE\0\x01\x01a"), PICTURE, "more than 512 segments"),
    ("a photometric profile", || [&b"IESNA"[..], &vec![0xff; BODY]].concat(), PROFILE, "at most 16777216 are read"),
    (
        "a header",
        || [&[0, 0, 0, 2, 0, 0, 0, 0][..], &vec![b' '; BODY]].concat(),
        TABULATED,
        "a header of 33554432 bytes",
    ),
    (
        "values",
        || {
            let header = r#"{"value":{"dtype":"F32","shape":[15000000],"data_offsets":[0,60000000]}}"#;
            [&(header.len() as u64).to_le_bytes()[..], header.as_bytes(), &vec![0; BODY]].concat()
        },
        TABULATED,
        "theta_o",
    ),
];

/// A value in kilobytes from the status of this process.
fn kilobytes(line: &str) -> u64 {
    let status = fs::read_to_string("/proc/self/status").expect("Linux");
    let found = status.lines().find_map(|text| text.strip_prefix(line)).expect("a line");
    found.trim_matches(|c: char| !c.is_ascii_digit()).parse().expect("a number")
}

#[test]
fn hostile_bodies_end_in_errors_within_their_memory() {
    if let Ok(name) = env::var(VARIABLE) {
        let (_, body, read, wanted) = BODIES.into_iter().find(|(known, ..)| *known == name).expect("a body");
        let body = body();
        // Writing 5 resets the peak.
        fs::write("/proc/self/clear_refs", "5").expect("Linux");
        let before = kilobytes("VmRSS:");
        let error = read(body);
        let more = (kilobytes("VmHWM:").saturating_sub(before)) << 10;
        println!("{name}: {} MiB beyond the body: {}", more >> 20, error.chars().take(200).collect::<String>());
        assert!(error.contains(wanted) && more <= MOST, "{name}: {more} bytes: {error:.200}");
        return;
    }
    let this = env::current_exe().expect("a path");
    for (name, ..) in BODIES {
        let mut reads = Command::new(&this);
        reads.args(["--exact", "hostile::hostile_bodies_end_in_errors_within_their_memory", "--nocapture"]);
        let output = reads.env(VARIABLE, name).output().expect("it runs");
        let printed = String::from_utf8_lossy(&output.stdout);
        printed.lines().filter(|line| line.starts_with(name)).for_each(|line| println!("{line}"));
        assert!(output.status.success(), "{name}: {printed}{}", String::from_utf8_lossy(&output.stderr));
    }
}
