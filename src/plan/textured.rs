//! Predictions of textured scenes, compared with the measured errors of their tables.

use std::ops::ControlFlow;

use serde_json::{Value, json};

use crate::{
    Budget, Form, GpuLimit, Needs, Scene, TablePlan,
    probes::{POINTS, Probes},
    scene::tests::glb::Glb,
};
use ltcforge_fit::{Plan, fit_plan};

/// A PNG of 64 x 64 texels.
fn image(texel: impl Fn(u32, u32) -> [u8; 3]) -> Vec<u8> {
    let texels: Vec<u8> = (0..64 * 64).flat_map(|i| texel(i % 64, i / 64)).collect();
    let mut out = Vec::new();
    let mut encoder = png::Encoder::new(&mut out, 64, 64);
    encoder.set_color(png::ColorType::Rgb);
    let mut writer = encoder.write_header().expect("a header");
    writer.write_image_data(&texels).expect("texels");
    writer.finish().expect("an image");
    out
}

/// A unit square of a material that names one texture.
fn square(image: &[u8], material: impl Fn(Value) -> Value) -> Scene {
    let mut glb = Glb::default();
    let texture = glb.texture(image, [10497; 2]);
    let material = glb.material(material(json!({ "index": texture })));
    let mesh = glb.quad(Some(material));
    glb.node(json!({ "mesh": mesh }));
    Scene::from_bytes(glb.bytes(), &|| true).expect("a scene")
}

/// Textures have many roughnesses and, if they mix metal and dielectrics, two kinds of lobes.
#[test]
fn errors_of_textured_scenes_are_as_predicted() {
    let worn = image(|x, y| [0, 40 + 3 * x as u8, if (x + 2 * y) % 5 < 2 { 255 } else { 0 }]);
    let slope = image(|x, y| [0, 30 + 3 * (x / 2 + y / 2) as u8, 255 - 4 * x as u8]);
    let brushed = image(|x, y| [128 + x as u8, 128, 4 * y as u8]);
    let of_surface = |info: Value| json!({ "pbrMetallicRoughness": { "metallicRoughnessTexture": info } });
    let of_coat = |info: Value| {
        let coat = json!({
            "clearcoatFactor": 0.8, "clearcoatRoughnessFactor": 0.6, "clearcoatRoughnessTexture": info,
        });
        let surface = json!({ "roughnessFactor": 0.7, "metallicRoughnessTexture": info });
        json!({ "pbrMetallicRoughness": surface, "extensions": { "KHR_materials_clearcoat": coat } })
    };
    let of_anisotropy = |info: Value| {
        let anisotropy = json!({ "anisotropyStrength": 0.9, "anisotropyTexture": info });
        let surface = json!({ "roughnessFactor": 0.3 });
        json!({ "pbrMetallicRoughness": surface, "extensions": { "KHR_materials_anisotropy": anisotropy } })
    };
    for (name, scene, is_mixed) in [
        ("worn", square(&worn, of_surface), true),
        ("coated", square(&slope, of_coat), true),
        ("brushed", square(&brushed, of_anisotropy), false),
    ] {
        let needs = Needs::of(&scene, false).expect("lobes");
        let probes = Probes::new(&needs, POINTS);
        let plan = TablePlan::new(needs, Budget::Knee, Form::default(), &|| true).expect("nothing stops it");
        for budget in [Budget::Bytes(4000), Budget::Bytes(1200)] {
            let chosen = plan.within(budget, GpuLimit::default()).chosen;
            assert_eq!(chosen.recipe.brdf.fresnel().second().is_some(), is_mixed, "{name}");
            let table = fit_plan(&Plan::new(&chosen.recipe), &|_| ControlFlow::Continue(())).expect("nothing stops it");
            let off_by = probes.error(&table) / chosen.error;
            println!("{name} {budget:?}: {:.4}, off by {off_by:.3}", chosen.error);
            assert!((0.85..1.15).contains(&off_by), "{name} {budget:?}: {off_by} of {}", chosen.error);
        }
    }
}
