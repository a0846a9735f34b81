//! Scenes whose areas and texels are known in closed form, and hostile ones.

mod areas;
pub(crate) mod glb;
mod hostile;

use std::f64::consts::FRAC_PI_2;

use serde_json::{Value, json};

use self::glb::{Glb, checker, quad_scene};
use super::*;
use crate::histogram::Spot;

fn scene(glb: &Glb) -> Scene {
    Scene::from_bytes(glb.bytes(), &|| true).expect("a scene")
}

/// The part of a lobe's weight with a roughness.
fn part(lobe: &SceneLobe, alpha: f64, ratio: f64) -> f64 {
    let near = |spot: &&Spot| (spot.alpha - alpha).abs() < 1e-3 && (spot.ratio - ratio).abs() < 1e-2;
    lobe.spots.iter().filter(near).map(|spot| spot.weight).sum::<f64>() / lobe.weight()
}

fn rough(roughness: f64) -> Value {
    json!({ "pbrMetallicRoughness": { "roughnessFactor": roughness, "metallicFactor": 0.0 } })
}

#[test]
fn surfaces_weigh_by_their_area_in_the_world_and_once_for_each_instance() {
    let mut glb = Glb::default();
    let [first, second] = [0.3, 0.5].map(|roughness| glb.material(rough(roughness)));
    let (a, b) = (glb.quad(Some(first)), glb.quad(Some(second)));
    glb.node(json!({ "mesh": a, "scale": [2.0, 3.0, 1.0] }));
    glb.node(json!({ "mesh": a, "rotation": [0.0, 0.6, 0.0, 0.8], "translation": [9.0, 0.0, 0.0] }));
    let inner = glb.child(json!({ "mesh": b, "scale": [0.5, 0.5, 1.0] }));
    glb.node(json!({ "children": [inner], "matrix": [4.0, 0, 0, 0, 0, 2.0, 0, 0, 0, 0, 1.0, 0, 0, 0, 0, 1.0] }));
    let scene = scene(&glb);
    let areas: Vec<f64> = scene.materials.iter().map(|material| material.area).collect();
    assert!((areas[0] - 7.0).abs() < 1e-6 && (areas[1] - 2.0).abs() < 1e-6, "{areas:?}");
    assert_eq!(scene.triangles, 6);
    let lobe = &scene.materials[0].lobes[0];
    assert_eq!((lobe.spots.len(), lobe.spots[0].ratio, lobe.views.is_all()), (1, 1.0, true));
    assert!((lobe.spots[0].alpha - 0.09).abs() < 1e-15);
    assert_eq!(scene.materials[0].name, "material 0");
}

/// The image has three levels. The surface is a quad whose texture coordinates run from 0 to the `end` of each case.
#[test]
fn texels_weigh_by_the_surface_that_they_cover() {
    // Left half of level 51, right half 204; the upper quarter of the image 255.
    let image = checker(64, |x, y| {
        if y < 16 {
            255
        } else if x < 32 {
            51
        } else {
            204
        }
    });
    let level = |level: f64| (level / 255.0) * (level / 255.0);
    // (uv end, wrap modes, the parts of 51, 204 and 255)
    let cases = [
        ([1.0, 1.0], [10497, 10497], [0.375, 0.375, 0.25]),
        ([3.0, 1.0], [10497, 10497], [0.375, 0.375, 0.25]),
        ([0.25, 1.0], [10497, 10497], [0.75, 0.0, 0.25]),
        ([2.0, 1.0], [33071, 33071], [0.1875, 0.5625, 0.25]),
        ([1.0, 2.0], [10497, 33071], [0.4375, 0.4375, 0.125]),
        ([1.5, 1.0], [33648, 10497], [0.25, 0.5, 0.25]),
        ([1.5, 1.0], [10497, 10497], [0.5, 0.25, 0.25]),
    ];
    for (end, wrap, wanted) in cases {
        let scene = scene(&quad_scene(&image, end, wrap, &json!({})));
        let lobe = &scene.materials[0].lobes[0];
        for (texel, wanted) in [51.0, 204.0, 255.0].into_iter().zip(wanted) {
            let found = part(lobe, level(texel), 1.0);
            assert!((found - wanted).abs() < 0.01 * wanted.max(0.1), "{end:?} {wrap:?} {texel}: {found} {wanted}");
        }
        assert!((lobe.weight() - 1.0).abs() < 1e-6, "{}", lobe.weight());
    }
}

/// JPEG rounds, lossless WebP does not. A grey image has one channel for all.
#[test]
fn images_of_every_format_are_read() {
    let texels: Vec<u8> = [[9, 102, 0]; 16 * 16].concat();
    let (mut jpeg, mut grey, mut webp) = (Vec::new(), Vec::new(), Vec::new());
    let encoder = jpeg_encoder::Encoder::new(&mut jpeg, 100);
    encoder.encode(&texels, 16, 16, jpeg_encoder::ColorType::Rgb).expect("a JPEG");
    let encoder = jpeg_encoder::Encoder::new(&mut grey, 100);
    encoder.encode(&[102; 16 * 16], 16, 16, jpeg_encoder::ColorType::Luma).expect("a JPEG");
    let encoder = image_webp::WebPEncoder::new(&mut webp);
    encoder.encode(&texels, 16, 16, image_webp::ColorType::Rgb8).expect("a WebP");
    for (image, tolerance) in [(&jpeg, 0.01), (&grey, 0.01), (&webp, 1e-9)] {
        let scene = scene(&quad_scene(image, [1.0; 2], [10497; 2], &json!({})));
        let spots = &scene.materials[0].lobes[0].spots;
        assert!(spots.iter().all(|spot| (spot.alpha.sqrt() - 0.4).abs() < tolerance), "{spots:?}");
    }
    let broken = quad_scene(&jpeg[..jpeg.len() / 2], [1.0; 2], [10497; 2], &json!({}));
    let read = Scene::from_bytes(broken.bytes(), &|| true).map_err(|error| error.to_string());
    assert!(read.is_err_and(|error| error.contains("/images/0")));
}

#[test]
fn a_transform_of_a_texture_moves_what_is_covered() {
    let image = checker(64, |x, _| if x < 16 { 51 } else { 204 });
    let change = json!({ "KHR_texture_transform": { "offset": [0.25, 0.0], "scale": [0.5, 1.0] } });
    let moved = scene(&quad_scene(&image, [1.0; 2], [10497; 2], &change));
    assert!((part(&moved.materials[0].lobes[0], 0.64, 1.0) - 1.0).abs() < 1e-9);
    let quarter_turn = json!({ "KHR_texture_transform": { "rotation": FRAC_PI_2, "scale": [1.0, 0.125] } });
    let turned = scene(&quad_scene(&image, [1.0; 2], [10497; 2], &quarter_turn));
    assert!(
        (part(&turned.materials[0].lobes[0], 0.04, 1.0) - 1.0).abs() < 1e-9,
        "{:?}",
        turned.materials[0].lobes[0].spots
    );
}

/// A PNG of four channels, with different texels in its left and its right half.
fn halves(left: [u8; 4], right: [u8; 4]) -> Vec<u8> {
    let texels: Vec<u8> = (0..64 * 64).flat_map(|i| if i % 64 < 32 { left } else { right }).collect();
    let mut out = Vec::new();
    let mut encoder = png::Encoder::new(&mut out, 64, 64);
    encoder.set_color(png::ColorType::Rgba);
    let mut writer = encoder.write_header().expect("a header");
    writer.write_image_data(&texels).expect("texels");
    writer.finish().expect("an image");
    out
}

/// The lobes of a unit square of a material with textures of one image.
fn lobes_of(image: &[u8], material: impl Fn(Value) -> Value) -> SceneMaterial {
    let mut glb = Glb::default();
    let texture = glb.texture(image, [10497; 2]);
    let material = glb.material(material(json!({ "index": texture })));
    let mesh = glb.quad(Some(material));
    glb.node(json!({ "mesh": mesh }));
    scene(&glb).materials.remove(0)
}

/// A masked surface counts as 0 or 1, a blended one by its alpha.
#[test]
fn surfaces_weigh_by_their_alpha() {
    let image = halves([255, 255, 255, 51], [255, 255, 255, 204]);
    // (mode, cutoff, factor, area)
    for (mode, cutoff, factor, area) in [
        ("OPAQUE", 0.5, 1.0, 1.0),
        ("MASK", 0.5, 1.0, 0.5),
        ("MASK", 0.1, 1.0, 1.0),
        ("BLEND", 0.5, 1.0, 0.5),
        ("BLEND", 0.5, 0.5, 0.25),
    ] {
        let found = lobes_of(&image, |info| {
            let pbr = json!({ "baseColorTexture": info, "baseColorFactor": [1, 1, 1, factor] });
            json!({ "pbrMetallicRoughness": pbr, "alphaMode": mode, "alphaCutoff": cutoff })
        });
        for weight in [found.area, found.lobes[0].weight()] {
            assert!((weight - area).abs() < 0.01 * area, "{mode} {cutoff} {factor}: {weight}");
        }
    }
    let mut glb = Glb::default();
    let away = json!({ "pbrMetallicRoughness": { "baseColorFactor": [1, 1, 1, 0.4] }, "alphaMode": "MASK" });
    for material in [away, rough(0.5)] {
        let material = glb.material(material);
        let mesh = glb.quad(Some(material));
        glb.node(json!({ "mesh": mesh }));
    }
    let found = scene(&glb);
    assert_eq!((found.materials[0].area, found.materials[0].lobes.len()), (0.0, 0));
}

#[test]
fn textures_of_reflectance_and_of_sheen_count() {
    let image = halves([255, 255, 255, 255], [0, 0, 0, 51]);
    let plastic = json!({ "metallicFactor": 0.0 });
    let found = lobes_of(&image, |info| {
        let specular = json!({ "specularTexture": info });
        json!({ "pbrMetallicRoughness": plastic, "extensions": { "KHR_materials_specular": specular } })
    });
    // The factor is the weight; the shape of the lobe remains.
    assert!((found.lobes[0].f0[0][0] - 0.04).abs() < 1e-9, "{:?}", found.lobes[0].f0);
    assert!((found.lobes[0].weight() - 0.6).abs() < 1e-4, "{}", found.lobes[0].weight());
    let found = lobes_of(&image, |info| {
        let specular = json!({ "specularColorTexture": info, "specularColorFactor": [0.5, 0.5, 0.5] });
        json!({ "pbrMetallicRoughness": plastic, "extensions": { "KHR_materials_specular": specular } })
    });
    assert!((found.lobes[0].f0[0][0] - 0.5 * 0.04 * 0.5).abs() < 1e-4, "{:?}", found.lobes[0].f0);
    let found = lobes_of(&image, |info| {
        let sheen = json!({
            "sheenColorFactor": [0.5, 0.25, 0.5], "sheenRoughnessFactor": 0.5,
            "sheenColorTexture": info, "sheenRoughnessTexture": info,
        });
        json!({ "extensions": { "KHR_materials_sheen": sheen } })
    });
    let sheen = found.lobes.iter().find(|lobe| lobe.kind == LobeKind::Sheen).expect("a lobe");
    // The black half has no sheen.
    assert!((sheen.weight() - 0.25).abs() < 2.5e-3 && sheen.spots.len() == 1, "{sheen:?}");
    assert_eq!(sheen.spots[0].alpha, 0.25);
}

#[test]
fn anisotropy_is_along_the_tangent_and_coats_are_separate_lobes() {
    let mut glb = Glb::default();
    let brushed = glb.material(json!({
        "name": "brushed", "pbrMetallicRoughness": { "roughnessFactor": 0.4, "baseColorFactor": [0.5, 0.5, 0.5, 1] },
        "extensions": {
            "KHR_materials_anisotropy": { "anisotropyStrength": 0.5 },
            "KHR_materials_clearcoat": { "clearcoatFactor": 0.5, "clearcoatRoughnessFactor": 0.2 },
            "KHR_materials_sheen": { "sheenColorFactor": [0, 0.1, 0], "sheenRoughnessFactor": 0.5 },
            "KHR_materials_transmission": { "transmissionFactor": 1.0 },
        },
    }));
    let mesh = glb.quad(Some(brushed));
    glb.node(json!({ "mesh": mesh }));
    let scene = scene(&glb);
    let [base, coat, sheen] = &scene.materials[0].lobes[..] else { panic!("{:?}", scene.materials[0].lobes) };
    let along = 0.16 + 0.84 * 0.25;
    assert!((base.spots[0].alpha - along).abs() < 1e-9 && (base.spots[0].ratio - 0.16 / along).abs() < 1e-9);
    assert!((base.f0[0][0] - 0.5).abs() < 1e-9 && base.f0.len() == 1, "{:?}", base.f0);
    assert_eq!((coat.kind, coat.spots[0].ratio), (LobeKind::Clearcoat, 1.0));
    assert!((coat.spots[0].alpha - 0.04).abs() < 1e-12 && (coat.weight() - 0.5).abs() < 1e-6);
    assert_eq!((sheen.kind, sheen.spots[0].alpha), (LobeKind::Sheen, 0.25));
    assert!((sheen.weight() - 0.1).abs() < 1e-9);
    assert!(scene.materials[0].uncovered[0].contains("KHR_materials_transmission"));
}

/// A camera straight above a wide floor sees the angles within its picture, and no surface behind it.
#[test]
fn cameras_limit_the_views() {
    let mut glb = Glb::default();
    let [floor, hidden] = [0.3, 0.6].map(|roughness| glb.material(rough(roughness)));
    let (a, b) = (glb.quad(Some(floor)), glb.quad(Some(hidden)));
    glb.node(json!({ "mesh": a, "scale": [40.0, 40.0, 1.0], "translation": [-20.0, -20.0, 0.0] }));
    glb.node(json!({ "mesh": b, "translation": [0.0, 0.0, 9.0] }));
    let camera =
        glb.camera(json!({ "type": "perspective", "perspective": { "yfov": 1.0, "aspectRatio": 1.0, "znear": 0.1 } }));
    glb.node(json!({ "camera": camera, "translation": [0.0, 0.0, 2.0] }));
    let scene = scene(&glb);
    let [floor, hidden] = &scene.materials[..] else { panic!("two materials") };
    let side = 2.0 * 2.0 * 0.5_f64.tan();
    assert!((floor.area / (side * side) - 1.0).abs() < 0.01, "{} {}", floor.area, side * side);
    assert_eq!((hidden.area, hidden.lobes.len()), (0.0, 0));
    let corner = (2.0_f64.sqrt() * 0.5_f64.tan()).atan();
    let [low, high] = floor.lobes[0].views.theta;
    assert!(low < 0.02 && (high - corner).abs() < 0.01, "{low} {high} {corner}");
}

/// The scale of nodes above a camera changes neither its picture nor its depths.
#[test]
fn a_camera_is_not_scaled() {
    let views = |scale: f64| {
        let mut glb = Glb::default();
        let floor = glb.material(rough(0.3));
        let mesh = glb.quad(Some(floor));
        glb.node(json!({ "mesh": mesh }));
        let perspective = json!({ "yfov": 1.0, "aspectRatio": 1.0, "znear": 0.1, "zfar": 10.0 });
        let camera = glb.camera(json!({ "type": "perspective", "perspective": perspective }));
        let at = [0.5 / scale, 0.5 / scale, 3.0 / scale];
        let child = glb.child(json!({ "camera": camera, "translation": at }));
        glb.node(json!({ "children": [child], "scale": [scale, scale, scale] }));
        scene(&glb).materials[0].lobes[0].views.theta
    };
    let (plain, scaled) = (views(1.0), views(0.01));
    assert!(plain.iter().zip(scaled).all(|(a, b)| (a - b).abs() < 1e-9), "{plain:?} {scaled:?}");
}

#[test]
fn unknown_extensions_and_missing_attributes_are_named() {
    let mut glb = Glb::default();
    let texture = glb.texture(&checker(2, |x, _| 255 * x as u8), [33_071; 2]);
    let info = json!({ "index": texture, "texCoord": 1 });
    let extensions = json!({ "VENDOR_materials_glow": {} });
    let pbr = json!({ "metallicRoughnessTexture": info });
    let material = glb.material(json!({ "name": "m", "pbrMetallicRoughness": pbr, "extensions": extensions }));
    let mesh = glb.quad(Some(material));
    glb.node(json!({ "mesh": mesh }));
    let found = scene(&glb);
    assert!(found.materials[0].uncovered.iter().any(|what| what.contains("VENDOR_materials_glow")), "{found:?}");
    assert!(found.notes.iter().any(|note| note.contains("TEXCOORD_1")), "{:?}", found.notes);
    assert!(found.materials[0].lobes[0].spots.len() > 1, "both levels of the texture count");
}

#[test]
fn parts_that_are_ignored_are_named() {
    let mut glb = Glb::default();
    let material = glb.material(rough(0.5));
    let mesh = glb.quad(Some(material));
    glb.node(json!({ "mesh": mesh }));
    assert!(scene(&glb).notes.is_empty());
    glb.json["extensionsUsed"] = json!(["KHR_materials_variants", "KHR_mesh_quantization", "VENDOR_geometry"]);
    glb.json["extensionsRequired"] = json!(["KHR_mesh_quantization", "VENDOR_geometry"]);
    let notes = scene(&glb).notes;
    for words in ["requires VENDOR_geometry", "variants of materials"] {
        assert_eq!(notes.iter().filter(|note| note.contains(words)).count(), 1, "{words}: {notes:?}");
    }
    assert_eq!(notes.len(), 2, "{notes:?}");
    glb.json["asset"]["version"] = json!("1.0");
    let refused = Scene::from_bytes(glb.bytes(), &|| true).expect_err("another format").to_string();
    assert!(refused.contains("/asset/version") && refused.contains("\"1.0\" is not glTF 2"), "{refused}");
}

#[test]
fn phi_is_from_the_axis_of_the_larger_roughness() {
    for (rotation, wanted) in [(0.0, 0.0), (FRAC_PI_2, FRAC_PI_2)] {
        let mut glb = Glb::default();
        let anisotropy = json!({ "anisotropyStrength": 1.0, "anisotropyRotation": rotation });
        let brushed = glb.material(json!({ "extensions": { "KHR_materials_anisotropy": anisotropy } }));
        let mesh = glb.quad(Some(brushed));
        glb.node(json!({ "mesh": mesh, "scale": [0.1, 0.1, 1.0], "translation": [-0.05, -0.05, 0.0] }));
        // The camera looks at the origin along x, from 45 degrees above.
        let camera = glb.camera(json!({ "perspective": { "yfov": 1.0, "znear": 0.1 } }));
        let half = (0.125 * std::f64::consts::PI).sin();
        let up = (0.125 * std::f64::consts::PI).cos();
        glb.node(json!({ "camera": camera, "translation": [5.0, 0.0, 5.0], "rotation": [0.0, half, 0.0, up] }));
        let found = scene(&glb);
        let views = &found.materials[0].lobes[0].views;
        let [phi, theta] = [views.phi, views.theta].map(|[low, high]| 0.5 * (low + high));
        assert!((phi - wanted).abs() < 0.02 && (theta - 0.5 * FRAC_PI_2).abs() < 0.02, "{phi} {theta}");
    }
}

#[test]
fn a_mesh_that_cannot_be_read_is_named_and_weighs_as_its_box() {
    let mut glb = Glb::default();
    let material = glb.material(rough(0.5));
    let mesh = glb.quad(Some(material));
    glb.json["meshes"][mesh]["primitives"][0]["extensions"] = json!({ "KHR_draco_mesh_compression": {} });
    glb.node(json!({ "mesh": mesh, "scale": [2.0, 2.0, 1.0] }));
    let scene = scene(&glb);
    // A flat box counts the quad on both sides.
    assert!((scene.materials[0].area - 8.0).abs() < 1e-6, "{}", scene.materials[0].area);
    assert!(scene.notes[0].contains("KHR_draco_mesh_compression"), "{:?}", scene.notes);
    let mut textured = quad_scene(&checker(4, |_, _| 255), [1.0; 2], [10497; 2], &json!({}));
    textured.json["images"][0] = json!({ "uri": "far.ktx2" });
    let scene = self::scene(&textured);
    assert!(scene.notes[0].contains("far.ktx2") && scene.notes[0].contains("roughness"), "{:?}", scene.notes);
}

#[test]
fn equal_files_give_equal_scenes() {
    let image = checker(16, |x, y| (x * 16 + y) as u8);
    let glb = quad_scene(&image, [1.7, 0.6], [33648, 10497], &json!({}));
    assert_eq!(scene(&glb), scene(&glb));
}

/// Positions by the vertex codec and indices by the triangle codec; a stream that is cut off is refused.
#[test]
fn meshes_that_meshopt_compresses_are_read() {
    use meshoptimizer_rs::{
        Workspace,
        codec::{IndexEncoding, VertexEncoding, encode_index_buffer, encode_vertex_buffer},
    };
    let corners = [[0.0_f32, 0.0, 0.0], [2.0, 0.0, 0.0], [2.0, 3.0, 0.0], [0.0, 3.0, 0.0]];
    let vertices: Vec<u8> = corners.as_flattened().iter().flat_map(|x| x.to_le_bytes()).collect();
    let work = &mut Workspace::default();
    // The versions of `EXT_meshopt_compression`.
    let of_vertices = VertexEncoding::new(0, 2).expect("a version");
    let of_order = IndexEncoding::new(1).expect("a version");
    let positions = encode_vertex_buffer(&vertices, 4, 12, of_vertices, work).expect("bytes");
    let order = encode_index_buffer(&[0, 1, 2, 0, 2, 3], of_order, work).expect("bytes");
    let compressed = |cut: usize| {
        let mut glb = Glb::default();
        let material = glb.material(rough(0.3));
        let mesh = glb.quad(Some(material));
        glb.node(json!({ "mesh": mesh }));
        for (accessor, bytes, stride, count, mode) in
            [(0, &positions[..positions.len() - cut], 12, 4, "ATTRIBUTES"), (2, &order[..], 2, 6, "TRIANGLES")]
        {
            let source = glb.view(bytes);
            let at = glb.json["bufferViews"][source]["byteOffset"].clone();
            let view = glb.json["accessors"][accessor]["bufferView"].as_u64().expect("an index") as usize;
            glb.json["bufferViews"][view]["extensions"] = json!({ "EXT_meshopt_compression": {
                "buffer": 0, "byteOffset": at, "byteLength": bytes.len(), "byteStride": stride, "count": count, "mode": mode,
            } });
        }
        Scene::from_bytes(glb.bytes(), &|| true)
    };
    let read = compressed(0).expect("a scene");
    assert!((read.materials[0].area - 6.0).abs() < 1e-6 && read.notes.is_empty(), "{read:?}");
    let refused = compressed(3).expect_err("a cut stream").to_string();
    assert!(refused.contains("/bufferViews/0/extensions/EXT_meshopt_compression"), "{refused}");
}
