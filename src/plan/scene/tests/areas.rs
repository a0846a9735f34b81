//! Scenes whose histograms are known in closed form: the weight of each roughness must be within 1 %.

use serde_json::{Value, json};

use super::{Glb, LobeKind, checker, rough, scene};
use crate::scene::Scene;

/// A lobe of a material with its roughness (not squared), ratio and weight.
type Wanted = (usize, LobeKind, f64, f64, f64);

const BASE: LobeKind = LobeKind::Base;

fn check(name: &str, scene: &Scene, wanted: &[Wanted]) {
    for (material, kind, roughness, ratio, weight) in wanted {
        let lobe = scene.materials[*material].lobes.iter().find(|lobe| lobe.kind == *kind);
        let spots = lobe.map_or(&[][..], |lobe| &lobe.spots);
        let near = spots
            .iter()
            .filter(|spot| (spot.alpha.sqrt() - roughness).abs() < 2e-3 && (spot.ratio - ratio).abs() < 1e-2);
        let found: f64 = near.map(|spot| spot.weight).sum();
        assert!(
            (found - weight).abs() <= 0.01 * weight,
            "{name}: {roughness} {ratio}: {found}, not {weight}: {spots:?}"
        );
    }
    let all: f64 = scene.lobes().map(|(_, lobe)| lobe.weight()).sum();
    let sum: f64 = wanted.iter().map(|wanted| wanted.4).sum();
    assert!((all - sum).abs() <= 0.01 * sum, "{name}: {all} in all, not {sum}");
}

/// Two unit squares next to each other, of roughness 0.3 and 0.5. The first has `material`.
fn pair(material: Value) -> Glb {
    let mut glb = Glb::default();
    let (first, second) = (glb.material(material), glb.material(rough(0.5)));
    for material in [first, second] {
        let mesh = glb.quad(Some(material));
        glb.node(json!({ "mesh": mesh }));
    }
    glb
}

fn with(mut material: Value, name: &str, extension: Value) -> Value {
    material["extensions"][name] = extension;
    material
}

/// A PNG of 16 bits with one roughness for all texels.
fn deep(level: u16) -> Vec<u8> {
    let [high, low] = level.to_be_bytes();
    let texels: Vec<u8> = [0, 0, high, low, 0, 0].repeat(16);
    let mut out = Vec::new();
    let mut encoder = png::Encoder::new(&mut out, 4, 4);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Sixteen);
    let mut writer = encoder.write_header().expect("a header");
    writer.write_image_data(&texels).expect("texels");
    writer.finish().expect("an image");
    out
}

/// A quad that a joint moves and scales. The node of the mesh is scaled too, which does not count.
fn skinned(of_node: f64, of_joint: f64, bind: f32) -> Glb {
    let mut glb = pair(rough(0.3));
    let joint = glb.child(json!({ "scale": [of_joint, of_joint, of_joint], "translation": [7.0, 0.0, 1.0] }));
    let mut matrix = [0.0; 16];
    [matrix[0], matrix[5], matrix[10], matrix[15]] = [bind, bind, bind, 1.0];
    let bound = glb.floats(&matrix, "MAT4", 16);
    glb.json["skins"] = json!([{ "joints": [joint], "inverseBindMatrices": bound }]);
    let weights = glb.floats(&[1.0, 0.0, 0.0, 0.0].repeat(4), "VEC4", 4);
    let view = glb.view(&[0; 16]);
    let joints = json!({ "bufferView": view, "componentType": 5121, "count": 4, "type": "VEC4" });
    let joints = {
        glb.json["accessors"].as_array_mut().expect("a list").push(joints);
        weights + 1
    };
    glb.json["meshes"][0]["primitives"][0]["attributes"]["WEIGHTS_0"] = json!(weights);
    glb.json["meshes"][0]["primitives"][0]["attributes"]["JOINTS_0"] = json!(joints);
    glb.json["nodes"][0]["skin"] = json!(0);
    let armature = glb.node(json!({ "children": [0, joint], "scale": [of_node, of_node, of_node] }));
    glb.json["scenes"][0]["nodes"] = json!([1, armature]);
    glb
}

/// A quad with a morph target that stretches it along x by the target's weight.
fn morphed(of_mesh: &[f64], of_node: &[f64]) -> Glb {
    let mut glb = pair(rough(0.3));
    let added = glb.floats(&[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0], "VEC3", 3);
    glb.json["meshes"][0]["primitives"][0]["targets"] = json!([{ "POSITION": added }]);
    glb.json["meshes"][0]["weights"] = json!(of_mesh);
    glb.json["nodes"][0]["weights"] = json!(of_node);
    glb
}

/// A quad of which a sparse accessor moves two corners, so that it is `width` wide.
fn sparse(width: f32, has_view: bool) -> Glb {
    let mut glb = pair(rough(0.3));
    let positions =
        glb.json["meshes"][0]["primitives"][0]["attributes"]["POSITION"].as_u64().expect("an index") as usize;
    let indices = glb.view(&[1, 2, 3]);
    let corners: [f32; 9] = [width, 0.0, 0.0, width, 1.0, 0.0, 0.0, 1.0, 0.0];
    let values = glb.view(&corners.iter().flat_map(|x| x.to_le_bytes()).collect::<Vec<u8>>());
    let accessor = &mut glb.json["accessors"][positions];
    accessor["sparse"] = json!({
        "count": 3, "indices": { "bufferView": indices, "componentType": 5121 }, "values": { "bufferView": values },
    });
    if !has_view {
        accessor.as_object_mut().expect("an object").remove("bufferView");
    }
    glb
}

/// A quad with an instance for each scale.
fn instanced(scales: &[f32]) -> Glb {
    let mut glb = pair(rough(0.3));
    let three: Vec<f32> = scales.iter().flat_map(|scale| [*scale; 3]).collect();
    let scale = glb.floats(&three, "VEC3", 3);
    let turn = glb.floats(&[0.0, 0.0, 0.6, 0.8].repeat(scales.len()), "VEC4", 4);
    let attributes = json!({ "SCALE": scale, "ROTATION": turn, "TRANSLATION": scale });
    glb.json["nodes"][0]["extensions"] = json!({ "EXT_mesh_gpu_instancing": { "attributes": attributes } });
    glb
}

#[test]
fn histograms_of_forty_scenes_are_within_one_percent() {
    let second = (1, BASE, 0.5, 1.0, 1.0);
    let mut scenes: Vec<(String, Glb, Vec<Wanted>)> = Vec::new();
    let mut add = |name: String, glb: Glb, first: Vec<Wanted>| scenes.push((name, glb, [first, vec![second]].concat()));
    let one = |weight: f64| vec![(0, BASE, 0.3, 1.0, weight)];
    for factor in [0.1, 0.5, 1.0] {
        let glossy = with(rough(0.3), "KHR_materials_specular", json!({ "specularFactor": factor }));
        add(format!("specular {factor}"), pair(glossy), one(factor));
        let mut half = with(rough(0.3), "KHR_materials_specular", json!({ "specularFactor": factor }));
        half["pbrMetallicRoughness"]["metallicFactor"] = json!(0.25);
        add(format!("metal and specular {factor}"), pair(half), one(0.25 + 0.75 * factor));
    }
    let matte = with(rough(0.3), "KHR_materials_specular", json!({ "specularFactor": 0.0 }));
    add("matte".to_owned(), pair(matte), vec![]);
    for (node, joint, bind, area) in
        [(0.01, 1.0, 100.0, 1.0), (0.01, 2.0, 100.0, 4.0), (5.0, 1.0, 1.0, 25.0), (1.0, 0.5, 1.0, 0.25)]
    {
        add(format!("skin {node} {joint} {bind}"), skinned(node, joint, bind), one(area));
    }
    for (mesh, node, area) in
        [(&[0.5][..], &[][..], 1.5), (&[0.5], &[2.0], 3.0), (&[], &[], 1.0), (&[0.0], &[1.0], 2.0)]
    {
        add(format!("morph {mesh:?} {node:?}"), morphed(mesh, node), one(area));
    }
    for (width, has_view) in [(3.0, true), (0.5, true), (3.0, false), (2.0, false)] {
        add(format!("sparse {width} {has_view}"), sparse(width, has_view), one(width.into()));
    }
    for scales in [&[1.0; 7][..], &[1.0, 2.0, 3.0], &[0.5]] {
        let area: f32 = scales.iter().map(|scale| scale * scale).sum();
        add(format!("instances {scales:?}"), instanced(scales), one(area.into()));
    }
    for level in [300_u16, 19_661, 19_700, 45_000] {
        let mut glb = pair(rough(0.3));
        let texture = glb.texture(&deep(level), [10497; 2]);
        glb.json["materials"][0]["pbrMetallicRoughness"] =
            json!({ "metallicRoughnessTexture": { "index": texture }, "metallicFactor": 0.0 });
        let roughness = f64::from(level) / 65_535.0;
        add(format!("16 bits {level}"), glb, vec![(0, BASE, roughness.max(0.01), 1.0, 1.0)]);
    }
    for ior in [0.0, 1.0, 1.33, 2.4] {
        add(format!("index {ior}"), pair(with(rough(0.3), "KHR_materials_ior", json!({ "ior": ior }))), one(1.0));
    }
    for (strength, ratio) in [(0.5, 0.09 / 0.3175), (1.0, 0.09)] {
        let brushed = with(rough(0.3), "KHR_materials_anisotropy", json!({ "anisotropyStrength": strength }));
        add(format!("strength {strength}"), pair(brushed), vec![(0, BASE, (0.09_f64 / ratio).sqrt(), ratio, 1.0)]);
    }
    for factor in [0.25, 1.0] {
        let coat = json!({ "clearcoatFactor": factor, "clearcoatRoughnessFactor": 0.2 });
        let coat = pair(with(rough(0.3), "KHR_materials_clearcoat", coat));
        add(format!("coat {factor}"), coat, [one(1.0), vec![(0, LobeKind::Clearcoat, 0.2, 1.0, factor)]].concat());
        let sheen = json!({ "sheenColorFactor": [factor, 0.0, 0.0], "sheenRoughnessFactor": 0.6 });
        let sheen = pair(with(rough(0.3), "KHR_materials_sheen", sheen));
        add(format!("sheen {factor}"), sheen, [one(1.0), vec![(0, LobeKind::Sheen, 0.6, 1.0, factor)]].concat());
    }
    for (mode, alpha, area) in [("BLEND", 0.25, 0.25), ("MASK", 0.25, 0.0), ("MASK", 0.75, 1.0), ("OPAQUE", 0.25, 1.0)]
    {
        let mut clear = rough(0.3);
        clear["alphaMode"] = json!(mode);
        clear["pbrMetallicRoughness"]["baseColorFactor"] = json!([1.0, 1.0, 1.0, alpha]);
        add(format!("{mode} {alpha}"), pair(clear), one(area));
    }
    for part in [0.25, 0.5] {
        let mut glb = pair(rough(0.3));
        let image = checker(64, |x, _| if f64::from(x) < 64.0 * part { 51 } else { 204 });
        let texture = glb.texture(&image, [10497; 2]);
        glb.json["materials"][0]["pbrMetallicRoughness"] = json!({ "metallicRoughnessTexture": { "index": texture } });
        add(format!("texture {part}"), glb, vec![(0, BASE, 0.2, 1.0, part), (0, BASE, 0.8, 1.0, 1.0 - part)]);
    }
    assert!(scenes.len() >= 40, "{}", scenes.len());
    for (name, glb, wanted) in scenes {
        let scene = scene(&glb);
        check(&name, &scene, &wanted);
        assert!(scene.notes.is_empty(), "{name}: {:?}", scene.notes);
    }
}

/// The specification's formula agrees with the reduction to weighted lobes.
#[test]
fn a_specular_factor_weighs_the_lobe_and_keeps_its_shape() {
    for (factor, metallic) in [(0.1, 0.0), (0.4, 0.5), (1.0, 1.0)] {
        let specular = json!({ "specularFactor": factor, "specularColorFactor": [0.5, 1.0, 40.0] });
        let mut material = with(rough(0.3), "KHR_materials_specular", specular);
        material["pbrMetallicRoughness"]["metallicFactor"] = json!(metallic);
        material["pbrMetallicRoughness"]["baseColorFactor"] = json!([0.9, 0.5, 0.1, 1.0]);
        let lobe = scene(&pair(material)).materials[0].lobes[0].clone();
        let [f0, f90, area] = lobe.formula[0];
        let by_parts: f64 = lobe.f0.iter().map(|[f0, weight]| f0 * weight).sum();
        let weight: f64 = lobe.f0.iter().map(|[_, weight]| weight).sum();
        assert!((by_parts - f0 * area).abs() < 1e-9 && (weight - f90 * area).abs() < 1e-9, "{lobe:?}");
        if metallic == 0.0 {
            let shape = 0.2126 * 0.02 + 0.7152 * 0.04 + 0.0722;
            assert!((lobe.f0[0][0] - shape).abs() < 1e-9 && (f90 - factor).abs() < 1e-9, "{lobe:?}");
        }
    }
    let matte = with(rough(0.3), "KHR_materials_specular", json!({ "specularFactor": 0.0 }));
    let matte = scene(&pair(matte));
    assert!(matte.materials[0].lobes.is_empty() && matte.materials[0].uncovered[0].contains("specularFactor is 0"));
}

#[test]
fn factors_outside_of_the_format_are_refused_and_a_missing_tangent_is_named() {
    for (name, extension, pointer) in [
        ("KHR_materials_ior", json!({ "ior": 0.5 }), "KHR_materials_ior/ior: 0.5 is neither 0 nor at least 1"),
        ("KHR_materials_specular", json!({ "specularFactor": 1.5 }), "specularFactor: 1.5 is not between 0 and 1"),
        ("KHR_materials_specular", json!({ "specularColorFactor": [1, -1, 1] }), "specularColorFactor: -1 is not"),
        ("KHR_materials_sheen", json!({ "sheenColorFactor": [-1, 0, 0] }), "sheenColorFactor: -1 is not"),
        ("KHR_materials_clearcoat", json!({ "clearcoatFactor": -1 }), "clearcoatFactor: -1 is not"),
    ] {
        let refused = Scene::from_bytes(pair(with(rough(0.3), name, extension)).bytes(), &|| true);
        let refused = refused.expect_err("out of range").to_string();
        assert!(refused.contains(pointer), "{refused}");
    }
    let mut glb = pair(with(rough(0.3), "KHR_materials_anisotropy", json!({ "anisotropyStrength": 1.0 })));
    glb.json["meshes"][0]["primitives"][0]["attributes"].as_object_mut().expect("an object").remove("TEXCOORD_0");
    let camera = glb.camera(json!({ "type": "perspective", "perspective": { "yfov": 1.0, "znear": 0.1 } }));
    glb.node(json!({ "camera": camera, "translation": [0.5, 0.5, 2.0] }));
    let notes = scene(&glb).notes;
    assert!(notes[0].contains("it has no TANGENT, which its anisotropic material needs"), "{notes:?}");
}

#[test]
fn instances_and_zeros_of_hostile_scenes_are_limited() {
    let mut glb = instanced(&[1.0; 3]);
    let scale = glb.json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"]["SCALE"].clone();
    glb.json["accessors"][scale.as_u64().expect("an index") as usize]["count"] = json!(1 << 20);
    let refused = Scene::from_bytes(glb.bytes(), &|| true).expect_err("too many").to_string();
    assert!(refused.contains("instances by EXT_mesh_gpu_instancing: 1048576; at most 262144"), "{refused}");
    let mut glb = sparse(1.0, false);
    glb.json["accessors"][0]["count"] = json!(1 << 24);
    let refused = Scene::from_bytes(glb.bytes(), &|| true).expect_err("too many").to_string();
    assert!(refused.contains("/accessors/0/count: 16777216; at most 4194304"), "{refused}");
    let mut glb = sparse(1.0, true);
    glb.json["accessors"][0]["count"] = json!(3);
    let refused = Scene::from_bytes(glb.bytes(), &|| true).expect_err("out of range").to_string();
    assert!(refused.contains("sparse index 3 of 3 elements"), "{refused}");
}
