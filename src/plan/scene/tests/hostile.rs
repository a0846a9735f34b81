//! Scenes that are too large, leave their folder or are invalid.

use serde_json::{Value, json};

use super::{
    super::*,
    glb::{Glb, checker, quad_scene},
};

fn refused(glb: &Glb) -> String {
    Scene::from_bytes(glb.bytes(), &|| true).expect_err("hostile").to_string()
}

fn plain() -> Glb {
    let mut glb = Glb::default();
    let mesh = glb.quad(None);
    glb.node(json!({ "mesh": mesh }));
    glb
}

#[test]
fn nodes_have_to_be_a_tree() {
    let mut glb = plain();
    glb.json["nodes"][0]["children"] = json!([0]);
    assert!(refused(&glb).contains("/nodes/0"));
    let mut glb = plain();
    glb.child(json!({ "children": [2] }));
    glb.child(json!({ "children": [1] }));
    glb.json["nodes"][0]["children"] = json!([1]);
    assert!(refused(&glb).contains("reached twice"));
}

#[test]
fn every_index_out_of_range_is_named_at_once() {
    let mut glb = plain();
    glb.node(json!({ "mesh": 7, "children": [8], "camera": 9 }));
    glb.json["meshes"][0]["primitives"][0]["material"] = json!(3);
    let error = refused(&glb);
    for place in
        ["/nodes/1/mesh: 7", "/nodes/1/children/0: 8", "/nodes/1/camera: 9", "/meshes/0/primitives/0/material: 3"]
    {
        assert!(error.contains(place), "{place} is not in {error}");
    }
}

#[test]
fn accessors_stay_within_their_buffers() {
    for (field, value) in [
        ("count", json!(5)),
        ("count", json!(60_000_000)),
        ("byteOffset", json!(u64::MAX)),
        ("byteOffset", json!(12)),
        ("componentType", json!(5124)),
        ("type", json!("MAT4")),
    ] {
        let mut glb = plain();
        glb.json["accessors"][0][field] = value.clone();
        assert!(refused(&glb).contains("/accessors/0"), "{field} {value}");
    }
    for (field, value) in [("byteLength", json!(u64::MAX)), ("byteOffset", json!(u64::MAX)), ("buffer", json!(4))] {
        let mut glb = plain();
        glb.json["bufferViews"][0][field] = value.clone();
        assert!(refused(&glb).contains("/bufferViews/0"), "{field} {value}");
    }
    let mut glb = plain();
    let view = glb.view(&9_u16.to_le_bytes().repeat(6));
    glb.json["accessors"][2]["bufferView"] = json!(view);
    assert!(refused(&glb).contains("index 9 of 4 corners"));
}

#[test]
fn numbers_that_are_not_finite_weigh_nothing() {
    let mut glb = plain();
    let positions = glb.floats(&[f32::NAN, 0.0, 0.0, f32::INFINITY, 0.0, 0.0, 1.0, 1.0, 0.0], "VEC3", 3);
    let mesh = glb.quad(None);
    glb.json["meshes"][mesh]["primitives"][0] = json!({ "attributes": { "POSITION": positions } });
    glb.node(json!({ "mesh": mesh }));
    let scene = Scene::from_bytes(glb.bytes(), &|| true).expect("a scene");
    assert!((scene.materials[0].area - 1.0).abs() < 1e-6);
    glb.json["nodes"][0]["scale"] = json!([1e300, 1e300, 1e300]);
    glb.json["nodes"][0]["children"] = json!([2]);
    glb.child(json!({ "mesh": 0, "scale": [1e300, 1.0, 1.0] }));
    assert!(refused(&glb).contains("not finite"));
}

#[test]
fn a_small_file_cannot_ask_for_a_large_image() {
    let of_size = |width: u32, height: u32| {
        let mut image = checker(4, |_, _| 9);
        // Width and height are after the signature and the head of the first chunk, whose checksum must match.
        image[16..20].copy_from_slice(&width.to_be_bytes());
        image[20..24].copy_from_slice(&height.to_be_bytes());
        let sum = crc(&image[12..29]).to_be_bytes();
        image[29..33].copy_from_slice(&sum);
        quad_scene(&image, [1.0; 2], [10497; 2], &json!({}))
    };
    let error = refused(&of_size(1 << 16, 1 << 16));
    assert!(error.contains("/images/0") && error.contains("4294967296"), "{error}");
    // A scene of one file has tighter limits, since a service may have received it.
    let error = refused(&of_size(4096, 4097));
    assert!(error.contains("/images/0") && error.contains("16781312; at most 16777216"), "{error}");
    let mut cut = checker(64, |x, y| (x * y) as u8);
    cut.truncate(60);
    assert!(refused(&quad_scene(&cut, [1.0; 2], [10497; 2], &json!({}))).contains("image is invalid"));
}

fn crc(bytes: &[u8]) -> u32 {
    let step = |crc: u32, byte: &u8| {
        (0..8).fold(crc ^ u32::from(*byte), |crc, _| (crc >> 1) ^ (0xedb8_8320 & 0_u32.wrapping_sub(crc & 1)))
    };
    !bytes.iter().fold(!0, step)
}

#[test]
fn huge_counts_of_instances_are_refused() {
    let mut glb = Glb::default();
    let numbers = vec![0.5_f32; 9 * 30_000];
    let positions = glb.floats(&numbers, "VEC3", 3);
    let mesh = glb.quad(None);
    glb.json["meshes"][mesh]["primitives"][0] = json!({ "attributes": { "POSITION": positions } });
    for _ in 0..3000 {
        glb.node(json!({ "mesh": mesh }));
    }
    assert!(refused(&glb).contains("triangles of all instances"));
}

#[test]
fn many_instances_of_nothing_are_refused() {
    let mut glb = Glb::default();
    let positions = glb.floats(&[0.0; 9], "VEC3", 3);
    let empty = json!({ "attributes": { "POSITION": positions }, "mode": 5 });
    let mesh = glb.quad(None);
    glb.json["meshes"][mesh]["primitives"] = json!(vec![empty; 10_000]);
    for _ in 0..10_000 {
        glb.node(json!({ "mesh": mesh }));
    }
    assert!(refused(&glb).contains("triangles of all instances"));
    let mut glb = plain();
    glb.json["accessors"][0]["count"] = json!(1 << 27);
    assert!(refused(&glb).contains("corners and indices"));
}

#[test]
fn no_other_file_is_read_for_a_scene_that_was_sent() {
    let mut glb = plain();
    glb.json["buffers"] = json!([{ "byteLength": 200, "uri": "/etc/hostname" }]);
    assert!(refused(&glb).contains("/buffers/0/uri"));
    glb.json["buffers"] = json!([{ "byteLength": 1 << 16, "uri": "other.bin" }]);
    let scene = Scene::from_bytes(glb.bytes(), &|| true).expect("a scene");
    assert!(scene.notes[0].contains("other.bin"), "{:?}", scene.notes);
}

#[test]
fn factors_beyond_their_bounds_are_faults() {
    let mut glb = plain();
    glb.material(json!({ "pbrMetallicRoughness": { "roughnessFactor": 1e9, "metallicFactor": -1.0 } }));
    glb.json["meshes"][0]["primitives"][0]["material"] = json!(0);
    let error = refused(&glb);
    assert!(error.contains("roughnessFactor") && error.contains("metallicFactor"), "{error}");
}

#[test]
fn a_scene_without_a_lobe_is_refused() {
    let mut glb = plain();
    glb.material(json!({ "extensions": { "KHR_materials_unlit": {} } }));
    glb.json["meshes"][0]["primitives"][0]["material"] = json!(0);
    assert!(refused(&glb).contains("no surface"));
    for bytes in [&b"{}"[..], b"[]", b"", b"null", b"{\"nodes\": 3}"] {
        assert!(Scene::from_bytes(bytes.to_vec(), &|| true).is_err());
    }
}

/// Sizes, modes and bytes of compressed views that are wrong.
#[test]
fn compressed_views_that_are_invalid_are_faults() {
    let compressed = |field: &str, value: Value| {
        let mut glb = plain();
        let mut extension = json!({ "buffer": 0, "byteLength": 40, "byteStride": 4, "count": 4, "mode": "ATTRIBUTES" });
        extension[field] = value;
        glb.json["bufferViews"][0]["extensions"]["EXT_meshopt_compression"] = extension;
        glb
    };
    for (field, value) in [
        ("byteStride", json!(0)),
        ("byteStride", json!(u64::MAX)),
        ("count", json!(u64::MAX)),
        ("count", json!(1_u64 << 40)),
        ("mode", json!("OTHER")),
        ("filter", json!("OTHER")),
        ("byteLength", json!(u64::MAX)),
        ("byteOffset", json!(u64::MAX)),
        ("buffer", json!(9)),
        // The bytes of the buffer are not compressed.
        ("count", json!(4)),
    ] {
        let glb = compressed(field, value.clone());
        match Scene::from_bytes(glb.bytes(), &|| true) {
            Ok(scene) => assert!(scene.notes.iter().any(|note| note.contains("meshopt")), "{field} {value}: {scene:?}"),
            Err(error) => assert!(error.to_string().contains("/bufferViews/0"), "{field} {value}: {error}"),
        }
    }
}

/// A floor with a lamp of two triangles, which is `changed`.
fn lamp(changed: impl Fn(&mut Glb, usize)) -> Glb {
    let mut glb = plain();
    let material = glb.material(json!({ "name": "glow", "emissiveFactor": [1, 1, 1], "doubleSided": true }));
    let mesh = glb.quad(Some(material));
    glb.json["meshes"][mesh]["name"] = json!("lamp");
    glb.node(json!({ "mesh": mesh, "translation": [0, 0, 1] }));
    changed(&mut glb, mesh);
    glb
}

/// Every light that is not read is named, and a lamp of two triangles is one light.
#[test]
fn lights_that_are_not_read_are_named() {
    let read = |glb: &Glb| Scene::from_bytes(glb.bytes(), &|| true).expect("a scene");
    let scene = read(&lamp(|_, _| ()));
    assert_eq!((scene.lights.len(), scene.lights[0].shapes.len()), (1, 2));
    assert!(scene.places.iter().any(|point| point.lights.len() == 2), "{:?}", scene.places.len());
    let bright = json!({ "KHR_materials_emissive_strength": { "emissiveStrength": 1e12 } });
    let noted = |glb: Glb, why: &str| {
        let scene = read(&glb);
        assert!(scene.lights.is_empty(), "{:?}", scene.lights);
        assert!(scene.notes.iter().any(|note| note.contains("lamp") && note.contains(why)), "{why}: {:?}", scene.notes);
    };
    noted(lamp(|glb, _| glb.json["materials"][0]["extensions"] = bright.clone()), "its emission is above 1e9");
    noted(lamp(|glb, _| glb.json["materials"][0]["emissiveTexture"] = json!({ "index": 0 })), "has a texture");
    noted(lamp(|glb, _| glb.json["nodes"][1]["translation"] = json!([0, 0, 1e200])), "too far away");
    noted(lamp(|glb, _| glb.json["nodes"][1]["scale"] = json!([0, 0, 0])), "empty");
    let without_numbers = lamp(|glb, mesh| {
        let index = glb.json["meshes"][mesh]["primitives"][0]["attributes"]["POSITION"].as_u64().expect("an index");
        glb.json["accessors"][index as usize].as_object_mut().expect("an object").remove("bufferView");
    });
    noted(without_numbers, "has no numbers");
    let negative = lamp(|glb, _| glb.json["materials"][0]["emissiveFactor"] = json!([-1, 0, 0]));
    assert!(refused(&negative).contains("/materials/0/emissiveFactor: -1"));
}

#[test]
fn area_lights_of_any_numbers_are_read_or_named() {
    let with = |light: Value, node: Value| {
        let mut glb = plain();
        glb.json["extensions"]["EXT_lights_area"]["lights"] = json!([light]);
        let mut node = node;
        node["extensions"]["EXT_lights_area"] = json!({ "light": 0 });
        glb.node(node);
        Scene::from_bytes(glb.bytes(), &|| true)
    };
    let above = json!({ "translation": [0, 0, 1] });
    for (field, value) in
        [("size", json!(-1)), ("size", json!(1e300)), ("intensity", json!(-1)), ("color", json!([0, -1, 0]))]
    {
        let mut light = json!({ "type": "rect" });
        light[field] = value;
        let error = with(light, above.clone()).expect_err("a fault").to_string();
        assert!(error.contains(&format!("/lights/0/{field}")), "{error}");
    }
    let notes = |light: Value, node: Value| with(light, node).expect("a scene").notes.join("; ");
    assert!(notes(json!({ "type": "tube" }), above.clone()).contains("type tube is not read"));
    assert!(notes(json!({ "type": "disk" }), json!({ "scale": [1e200, 1e200, 1e200] })).contains("above 1e9"));
    // Lights that touch the surface, have no area or shine away reach nothing.
    for node in [json!({}), json!({ "scale": [0, 0, 0] }), json!({ "translation": [0, 0, -1] })] {
        for kind in ["rect", "disk"] {
            let scene = with(json!({ "type": kind, "size": 1e-9 }), node.clone()).expect("a scene");
            let needs = crate::Needs::of(&scene, false).expect("lobes");
            let probes = crate::probes::Probes::new(&needs, 8);
            assert!(probes.are_lit() && !probes.reaches((0, LobeKind::Base)), "{node} {kind}");
        }
    }
    // Only the brightest of many lights are read.
    let mut glb = plain();
    glb.json["extensions"]["EXT_lights_area"]["lights"] = json!([{ "type": "rect" }]);
    for _ in 0..1000 {
        glb.node(json!({ "translation": [0, 0, 1], "extensions": { "EXT_lights_area": { "light": 0 } } }));
    }
    let scene = Scene::from_bytes(glb.bytes(), &|| true).expect("a scene");
    assert!(scene.lights.len() == 64 && scene.notes[0].contains("lights that are ignored: 936"), "{:?}", scene.notes);
    for _ in 0..4000 {
        glb.node(json!({ "extensions": { "EXT_lights_area": { "light": 0 } } }));
    }
    assert!(refused(&glb).contains("nodes with lights: 5000; at most 4096"));
}

/// The caller is asked before each image and mesh, and every thousand points.
#[test]
fn a_caller_can_stop_reading() {
    use std::sync::atomic::{AtomicU32, Ordering};
    let glb = quad_scene(&checker(4, |x, _| x as u8), [1.0; 2], [10497; 2], &json!({}));
    let asked = AtomicU32::new(0);
    let read_while = |most: u32, threads: usize| {
        asked.store(0, Ordering::Relaxed);
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        pool.install(|| Scene::from_bytes(glb.bytes(), &|| asked.fetch_add(1, Ordering::Relaxed) < most))
    };
    assert!(read_while(u32::MAX, 1).is_ok());
    let all = asked.load(Ordering::Relaxed);
    assert!(all > 1000, "{all}");
    for (most, threads) in [(0, 1), (1, 1), (2, 1), (all / 2, 1), (all - 1, 1), (all / 2, 3)] {
        assert!(matches!(read_while(most, threads), Err(SceneError::Stopped)), "{most}");
        // Each thread asks once more.
        let last = most + threads as u32;
        assert!((most + 1..=last).contains(&asked.load(Ordering::Relaxed)), "{most} {threads}");
    }
}

#[test]
fn many_cameras_and_many_images_of_the_same_bytes_are_refused() {
    let mut glb = plain();
    let camera = glb.camera(json!({ "perspective": { "yfov": 1.0, "znear": 0.1 } }));
    for _ in 0..300 {
        glb.node(json!({ "camera": camera, "translation": [0.0, 0.0, 2.0] }));
    }
    assert!(refused(&glb).contains("cameras: 300"));
    let mut glb = Glb::default();
    // A PNG with a long chunk that is not read.
    let mut image = checker(4, |_, _| 9);
    let end = image.split_off(image.len() - 12);
    let chunk = [b"ruSt".to_vec(), vec![0; 1 << 20]].concat();
    image.extend((1_u32 << 20).to_be_bytes());
    image.extend(&chunk);
    image.extend(crc(&chunk).to_be_bytes());
    image.extend(end);
    let view = glb.view(&image);
    let mesh = glb.quad(None);
    let primitive = glb.json["meshes"][mesh]["primitives"][0].clone();
    let mut primitives = Vec::new();
    for number in 0..1100 {
        glb.json["images"].as_array_mut().expect("a list").push(json!({ "bufferView": view }));
        glb.json["textures"].as_array_mut().expect("a list").push(json!({ "source": number }));
        let texture = json!({ "metallicRoughnessTexture": { "index": number } });
        let mut with_material = primitive.clone();
        with_material["material"] = json!(glb.material(json!({ "pbrMetallicRoughness": texture })));
        primitives.push(with_material);
    }
    glb.json["meshes"][mesh]["primitives"] = json!(primitives);
    glb.node(json!({ "mesh": mesh }));
    assert!(refused(&glb).contains("bytes of all images"));
}
