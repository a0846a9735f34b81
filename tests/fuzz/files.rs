//! Documents and containers, as the library reads them.

use std::{ops::ControlFlow, path::Path};

use ltcforge::{
    Preset, Recipe, RecipeDocument as _, TableFile,
    client::{LockFile, with_pins},
    files::{
        compact,
        container::{AnyFile, NPY_MAGIC, decode_any, decode_npy, encode, encode_lut},
        recipe_document::{AnyRecipe, DEFAULT_ENTRY_LIMIT, RecipeError, canonical_json, digest, parse, parse_any},
        tabulated,
    },
    fit::{
        BrdfKind, TabulatedAxes, TabulatedBrdf,
        albedo::{LutPlan, LutRecipe, fit_lut},
    },
};
use ltcforge_plan::Scene;

use super::target::Target;

/// Recipe documents with every kind of field.
const RECIPES: [&str; 9] = [
    "{}",
    r#"{"preset": "draft", "resolution": {"alpha": 2, "ratio": 2, "theta": 2, "phi": 2}, "fit": {"samples": 64, "seed": 7}}"#,
    r#"{"preset": "paper", "brdf": "beckmann", "layout": "kt2022", "precision": "f16", "terms": false}"#,
    r#"{"nodes": {"alpha": [0.1, 0.5, 1], "ratio": [0.5, 1]}, "range": {"theta": [0, 1.2]}, "fit": {"metric": "l3"}}"#,
    r#"{"layout": "ltc2017", "brdf": "charlie", "resolution": {"alpha": 8, "theta": 8}, "fresnel": [{"f0": 0.04}]}"#,
    r#"{"brdf": "fuzz", "lobe": "sg", "fitter": 4, "second": "coat", "fit": {"solver": "nelder_mead", "steps": 3}}"#,
    r#"{"table": "dfg", "form": "f82", "resolution": {"roughness": 4, "cos_theta": 5}, "axes": {"texels": "centres"}}"#,
    r#"{"table": "transmission", "resolution": {"ior": 2, "roughness": 3, "cos_theta": 64}, "precision": "unorm16"}"#,
    r#"{"preset": "anisotropic_dfg", "table": "anisotropic_dfg", "resolution": {"ratio": 2, "phi": 16}}"#,
];

const RECIPE_WORDS: [&str; 19] = [
    "\"table\":",
    "\"form\":",
    "\"axes\":",
    "\"preset\":",
    "\"brdf\":",
    "\"layout\":",
    "\"lobe\":",
    "\"nodes\":",
    "\"range\":",
    "\"fit\":",
    "\"resolution\":",
    "\"terms\":",
    "[",
    "{",
    "}",
    ",",
    "null",
    "true",
    "\"tabulated\"",
];

/// A table with few entries.
fn small() -> TableFile {
    let recipe = Recipe::builder().preset(Preset::Draft);
    let recipe = ["alpha", "ratio", "theta", "phi"].into_iter().fold(recipe, |recipe, axis| recipe.resolution(axis, 2));
    ltcforge::fit(&recipe.build().expect("a recipe")).expect("a table")
}

#[test]
fn recipes() {
    let seeds = RECIPES.map(|text| text.as_bytes().to_vec()).to_vec();
    Target { name: "recipe", seeds, words: &RECIPE_WORDS, inputs: 4000 }.survive(|bytes| {
        let parse = |bytes: &[u8]| parse_any(bytes, DEFAULT_ENTRY_LIMIT, &tabulated::no_files);
        match parse(bytes) {
            Ok(recipe) => {
                let again = parse(canonical_json(&recipe).as_bytes()).expect("its canonical form");
                assert_eq!(digest(&again), digest(&recipe));
                match recipe {
                    AnyRecipe::Ltc(recipe) => {
                        format!("a recipe of {:?}", (recipe.brdf(), recipe.layout(), recipe.lobe()))
                    }
                    AnyRecipe::Lut(LutRecipe { table, form, .. }) => format!("a recipe of {table} {form:?}"),
                }
            }
            Err(RecipeError::Json(error)) => error,
            Err(RecipeError::Faults(faults)) => {
                faults.iter().map(|fault| format!("{}: {}", fault.pointer, fault.detail)).collect::<Vec<_>>().join("\n")
            }
        }
    });
}

#[test]
fn tables() {
    let small = small();
    let document = br#"{"table": "albedo", "resolution": {"roughness": 2, "cos_theta": 3}, "precision": "f16"}"#;
    let Ok(AnyRecipe::Lut(recipe)) = parse_any(document, DEFAULT_ENTRY_LIMIT, &tabulated::no_files) else {
        panic!("the recipe of a lookup table")
    };
    let lut = fit_lut(&LutPlan::new(&recipe), &|_| ControlFlow::Continue(())).expect("nothing stops it");
    let seeds = vec![
        encode(small.recipe(), small.table()).expect("a file"),
        encode_lut(&recipe, &lut).expect("the file of a lookup table"),
    ];
    let words = ["\"F32\"", "\"F16\"", "\"shape\":", "\"data_offsets\":", "\"__metadata__\":", "[", "{", "}", ","];
    Target { name: "safetensors", seeds, words: &words, inputs: 2000 }.survive(|bytes| match decode_any(bytes) {
        Ok(file) => {
            let encoded = match &file {
                AnyFile::Ltc(file) => encode(file.recipe(), file.table()),
                AnyFile::Lut(file) => encode_lut(&file.recipe, &file.lut),
            };
            assert!(encoded.is_ok_and(|encoded| encoded == bytes), "the same table was encoded differently");
            "a table".to_owned()
        }
        Err(error) => error.to_string(),
    });
}

#[test]
fn compact_tables() {
    let seeds = vec![compact::encode(small().table()).expect("a file")];
    Target { name: "compact", seeds, words: &[], inputs: 1000 }.survive(|bytes| match compact::decode(bytes) {
        Ok(table) => {
            assert!(table.matrices().iter().flatten().all(|number| number.is_finite()));
            "a table".to_owned()
        }
        Err(error) => error.to_string(),
    });
}

#[test]
fn npy() {
    let header = "{'descr': '<f4', 'fortran_order': False, 'shape': (2, 3, 2, 2, 3, 3), }";
    let length = u16::try_from(header.len()).expect("a short header").to_le_bytes();
    let numbers: Vec<u8> = (0_u16..216).flat_map(|n| f32::from(n).to_le_bytes()).collect();
    let seeds = vec![[NPY_MAGIC, &[1, 0], &length, header.as_bytes(), &numbers].concat()];
    let words = ["'descr':", "'fortran_order':", "True", "'shape':", "(", ")", ",", "'<f8'", "'>f4'"];
    Target { name: "npy", seeds, words: &words, inputs: 4000 }.survive(|bytes| match decode_npy(bytes) {
        Ok(_) => "a table".to_owned(),
        Err(error) => error.to_string(),
    });
}

#[test]
fn tabulated_brdfs() {
    let planted = |alpha: &[f64]| {
        let brdf = TabulatedBrdf::tabulate(BrdfKind::OrenNayar, TabulatedAxes::spread(alpha.to_vec(), 48, 24));
        tabulated::encode(&brdf.expect("a BRDF")).expect("a file")
    };
    let seeds = vec![planted(&[]), planted(&[0.25, 0.5])];
    let words =
        ["\"value\":", "\"F32\"", "\"F64\"", "\"shape\":", "\"data_offsets\":", "\"alpha\":", "[", "{", "}", ","];
    Target { name: "tabulated", seeds, words: &words, inputs: 600 }.survive(|bytes| match tabulated::decode(bytes) {
        Ok(file) => {
            let surface = ltcforge::BrdfModel::tabulated(file).surface([0.6; 2]);
            let sample = surface.sample(ltcforge::glam::DVec3::new(0.6, 0.0, 0.8), [0.3, 0.7]);
            assert!(sample.wi.is_finite() && sample.weight.is_finite());
            "a BRDF".to_owned()
        }
        Err(error) => error.to_string(),
    });
}

#[test]
fn lock_files() {
    let path = Path::new("ltcforge.lock");
    let digest_text = ltcforge::Digest::of(b"a");
    let old = format!(
        "# ours\nversion = 1\n\n[[table]]\nname = \"a\"\ndigest = \"{digest_text}\"\npath = \"x\"\nserver = \"http://h\"\n\n\
         [[table]]\nname = \"b\"\ndigest = \"{digest_text}\"\npath = \"y\"\nbytes = 7\n"
    );
    let recipe = canonical_json(&parse(br#"{"preset": "draft"}"#, DEFAULT_ENTRY_LIMIT).expect("a recipe"));
    let recipe_digest = ltcforge::Digest::of(recipe.as_bytes());
    let new = format!(
        "version = 2\nsources = [\"http://h:1\"]\n\n[[table]]\nname = \"a\"\npath = \"a.safetensors\"\ndigest = \"{digest_text}\"\nbytes = 7\n\
         recipe_digest = \"{recipe_digest}\"\nrecipe = '{recipe}'\n\n[[table.export]]\nfor = \"wgpu\"\nto = \"out\"\n\
         file = [{{ path = \"out/1\", bytes = 3, digest = \"{digest_text}\" }}]\n"
    );
    for seed in [&old, &new] {
        LockFile::parse(seed, path).expect("a valid seed");
    }
    let seeds = vec![old.into_bytes(), new.into_bytes()];
    let words =
        ["[[table]]\n", "version = ", "path = ", "\"../x\"", "\"/etc/passwd\"", "'", "\"\"\"", "= {", "\n", "file = ["];
    Target { name: "lock", seeds, words: &words, inputs: 3000 }.survive(|bytes| {
        let Ok(text) = std::str::from_utf8(bytes) else { return "not UTF-8".to_owned() };
        match LockFile::parse(text, path) {
            Ok(lock) => {
                // Version 1 has no recipes, but writing a lock file needs recipes.
                if lock.pins.iter().all(|pin| pin.recipe.is_some()) {
                    let written = with_pins(text, &lock.pins).expect("what was read can be written");
                    assert_eq!(LockFile::parse(&written, path).expect("a lock file").pins, lock.pins);
                }
                "a lock file".to_owned()
            }
            // Lines quoted from the file are removed.
            Err(error) => error.to_string().lines().filter(|line| !line.contains('|')).collect::<Vec<_>>().join("\n"),
        }
    });
}

/// A scene in one file: JSON, followed by the numbers.
fn glb(json: &str, binary: &[u8]) -> Vec<u8> {
    let mut json = json.as_bytes().to_vec();
    json.resize(json.len().next_multiple_of(4), b' ');
    let mut binary = binary.to_vec();
    binary.resize(binary.len().next_multiple_of(4), 0);
    let chunk = |kind: &[u8; 4], data: &[u8]| {
        let length = u32::try_from(data.len()).expect("short").to_le_bytes();
        [&length[..], kind, data].concat()
    };
    let chunks = [chunk(b"JSON", &json), chunk(b"BIN\0", &binary)].concat();
    let length = u32::try_from(chunks.len() + 12).expect("short").to_le_bytes();
    [&b"glTF"[..], &2_u32.to_le_bytes(), &length, &chunks].concat()
}

/// The corners of a square (48 bytes), and its two triangles (12 bytes).
fn corners() -> Vec<u8> {
    let positions: [f32; 12] = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 1.0, 0.0];
    let mut binary: Vec<u8> = positions.iter().flat_map(|number| number.to_le_bytes()).collect();
    binary.extend([0_u16, 1, 2, 0, 2, 3].iter().flat_map(|index| index.to_le_bytes()));
    binary
}

fn square() -> Vec<u8> {
    let json = r#"{"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0,"scale":[1,2,1]}],
        "meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1,"material":0}]}],
        "materials":[{"name":"m","pbrMetallicRoughness":{"metallicFactor":1,"roughnessFactor":0.4}}],
        "accessors":[{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3","min":[0,0,0],"max":[1,1,0]},
        {"bufferView":1,"componentType":5123,"count":6,"type":"SCALAR"}],
        "bufferViews":[{"buffer":0,"byteOffset":0,"byteLength":48},{"buffer":0,"byteOffset":48,"byteLength":12}],
        "buffers":[{"byteLength":60}]}"#;
    glb(json, &corners())
}

/// The square with a texture, texture coordinates, two extensions and a camera.
fn textured_square() -> Vec<u8> {
    let mut png = Vec::new();
    let mut encoder = png::Encoder::new(&mut png, 2, 1);
    encoder.set_color(png::ColorType::Rgb);
    encoder.write_header().expect("a header").write_image_data(&[0, 90, 255, 0, 200, 10]).expect("pixels");
    let places: Vec<u8> =
        [0_f32, 0.0, 1.0, 0.0, 1.0, 1.0, 0.0, 1.0].iter().flat_map(|number| number.to_le_bytes()).collect();
    let binary = [corners(), places, png.clone()].concat();
    let json = format!(
        r#"{{"asset":{{"version":"2.0"}},"extensionsUsed":["KHR_materials_anisotropy","KHR_materials_clearcoat"],
        "scenes":[{{"nodes":[0,1]}}],"nodes":[{{"mesh":0}},{{"camera":0,"translation":[0,0,2]}}],
        "cameras":[{{"type":"perspective","perspective":{{"yfov":1,"znear":0.1}}}}],
        "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0,"TEXCOORD_0":2}},"indices":1,"material":0}}]}}],
        "materials":[{{"pbrMetallicRoughness":{{"metallicRoughnessTexture":{{"index":0}}}},
        "extensions":{{"KHR_materials_anisotropy":{{"anisotropyStrength":0.5}},"KHR_materials_clearcoat":{{"clearcoatFactor":1}}}}}}],
        "textures":[{{"source":0}}],"images":[{{"bufferView":3,"mimeType":"image/png"}}],
        "accessors":[{{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3","min":[0,0,0],"max":[1,1,0]}},
        {{"bufferView":1,"componentType":5123,"count":6,"type":"SCALAR"}},{{"bufferView":2,"componentType":5126,"count":4,"type":"VEC2"}}],
        "bufferViews":[{{"buffer":0,"byteOffset":0,"byteLength":48}},{{"buffer":0,"byteOffset":48,"byteLength":12}},
        {{"buffer":0,"byteOffset":60,"byteLength":32}},{{"buffer":0,"byteOffset":92,"byteLength":{}}}],
        "buffers":[{{"byteLength":{}}}]}}"#,
        png.len(),
        binary.len()
    );
    glb(&json, &binary)
}

#[test]
fn scenes() {
    let seeds = vec![square(), textured_square()];
    for seed in &seeds {
        Scene::from_bytes(seed.clone(), &|| true).expect("a valid seed");
    }
    let words = [
        "\"children\":[0]",
        "\"extensions\":{",
        "\"KHR_materials_anisotropy\":",
        "\"images\":[",
        "\"uri\":",
        "\"data:image/png;base64,",
        "[",
        "{",
        "}",
        ",",
    ];
    Target { name: "gltf", seeds, words: &words, inputs: 3000 }.survive(|bytes| {
        match Scene::from_bytes(bytes.to_vec(), &|| true) {
            Ok(scene) => scene.notes.iter().fold("a scene".to_owned(), |text, note| text + "\n" + note),
            Err(error) => error.to_string(),
        }
    });
}

#[test]
fn lists_of_materials() {
    let list = br#"{"materials": [{"name": "steel", "alpha_x": 0.2, "alpha_y": 0.2, "weight": 2}, {"gltf": {"roughness": 0.1}}]}"#;
    let words = ["\"openpbr\":", "\"gltf\":", "\"weight\":", "\"f0\":", "[", "{", "}", ","];
    Target { name: "materials", seeds: vec![list.to_vec()], words: &words, inputs: 3000 }.survive(|bytes| {
        match Scene::from_list(bytes) {
            Ok(scene) => scene.notes.iter().fold("a scene".to_owned(), |text, note| text + "\n" + note),
            Err(error) => error.to_string(),
        }
    });
}
