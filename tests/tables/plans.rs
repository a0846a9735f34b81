//! Plans all scenes of the project: lists in the docs, and glTF files.

use std::{
    fs,
    ops::ControlFlow,
    path::{Path, PathBuf},
};

use ltcforge::fit::{Plan, fit_plan};
use ltcforge_plan::{Budget, Form, LobeKind, Needs, Scene, SceneMaterial, TablePlan, left_out};

/// The files in a folder with some extensions, sorted by name.
fn files(folder: &str, extensions: &[&str]) -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join(folder);
    let all = fs::read_dir(folder).expect("a folder").map(|entry| entry.expect("an entry").path());
    let is_scene = |path: &PathBuf| path.extension().is_some_and(|of| extensions.iter().any(|known| of == *known));
    let mut files: Vec<PathBuf> = all.filter(is_scene).collect();
    files.sort();
    files
}

fn scene(path: &Path) -> Scene {
    if path.extension().is_some_and(|extension| extension == "json") {
        return Scene::from_list(&fs::read(path).expect("a list")).expect("a scene");
    }
    Scene::open(path, Vec::new(), &|| true).expect("a scene")
}

fn shipped(name: &str) -> Scene {
    scene(&Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/scenes").join(name))
}

/// On every scene, a planned table with half the bytes is as good as the table of the whole domain, and as good as
/// predicted.
#[test]
#[ignore = "make test-all runs it"]
fn a_plan_with_half_the_bytes_is_not_worse_on_any_scene() {
    let scenes = [files("docs/plan", &["json"]), files("tests/scenes", &["gltf", "glb"])].concat();
    assert!(scenes.len() >= 9, "{scenes:?}");
    let mut wrong = Vec::new();
    for path in scenes {
        let scene = scene(&path);
        let needs = Needs::of(&scene, false).expect("lobes of GGX");
        let planned =
            |budget| TablePlan::new(needs.clone(), budget, Form::default(), &|| true).expect("nothing stops it");
        let mut plan = planned(Budget::Bytes(83_160));
        assert_eq!(plan.whole.recipe.bytes(), 2 * 83_160);
        let table =
            fit_plan(&Plan::new(&plan.chosen.recipe), &|_| ControlFlow::Continue(())).expect("nothing stops it");
        plan.measure(&table, None);
        let (fitted, whole) = (&plan.fitted[0], plan.whole.error.expect("the default table is kept"));
        let (off_by, bytes) = (fitted.off_by(), fitted.candidate.bytes);
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        let line = format!("{name}: {:.4}, off by {off_by:.3}, {bytes} bytes; whole {whole:.4}", fitted.error);
        println!("{line}");
        if bytes > 83_160 || fitted.error > whole || !(0.85..1.15).contains(&off_by) {
            wrong.push(line);
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

/// The part of a lobe's total weight with a roughness in this range.
fn part(material: &SceneMaterial, kind: LobeKind, alpha: [f64; 2]) -> f64 {
    let lobe = material.lobes.iter().find(|lobe| lobe.kind == kind).expect("a lobe");
    let within = lobe.spots.iter().filter(|spot| (alpha[0]..=alpha[1]).contains(&spot.alpha));
    within.map(|spot| spot.weight).sum::<f64>() / lobe.weight()
}

fn material<'a>(scene: &'a Scene, name: &str) -> &'a SceneMaterial {
    scene.materials.iter().find(|material| material.name == name).expect(name)
}

/// The texture of each disc has all strengths, so alpha ranges from the disc's alpha to one.
#[test]
fn discs_of_anisotropy_have_every_strength() {
    let scene = shipped("AnisotropyDiscTest.glb");
    assert_eq!((scene.materials.len(), scene.cameras), (12, 0));
    assert_eq!(left_out(&scene), [""; 0]);
    for (roughness, name) in [(0.2_f64, "roughness 0.2"), (0.5, "roughness 0.5"), (0.9, "roughness 0.9")] {
        let disc = material(&scene, name);
        let [low, high] = [f64::min, f64::max]
            .map(|least| disc.lobes[0].spots.iter().map(|spot| spot.alpha).reduce(least).expect("spots"));
        assert!((low - roughness * roughness).abs() < 2e-3 && high > 0.99, "{name}: {low} to {high}");
        // At every strength, the smaller roughness equals the roughness without anisotropy.
        let smaller = disc.lobes[0].spots.iter().map(|spot| spot.alpha * spot.ratio);
        assert!(smaller.into_iter().all(|alpha| (alpha - roughness * roughness).abs() < 5e-3), "{name}");
    }
    assert!(material(&scene, "roughness 1.0").lobes[0].is_isotropic());
}

/// Coats are separate lobes. Their roughness comes from a factor or a texture, on the surface that they cover.
#[test]
fn coats_have_the_roughness_and_the_surface_of_their_textures() {
    let scene = shipped("ClearCoatTest.glb");
    assert_eq!(scene.materials.len(), 19);
    let simple = material(&scene, "Simple_Coated");
    assert_eq!(part(simple, LobeKind::Clearcoat, [8.9e-4, 9.1e-4]), 1.0);
    assert!((part(simple, LobeKind::Base, [0.193, 0.194]) - 1.0).abs() < 1e-12);
    let partial = material(&scene, "Partial_Coated");
    let [base, coat] = [0, 1].map(|lobe| partial.lobes[lobe].weight());
    assert!((0.2..0.8).contains(&(coat / base)), "{coat} of {base}");
    // The texture of a coat and the texture of a surface without a coat have the same roughnesses.
    let [striped, surface] = ["RoughVariations_Coated", "RoughVariations_Coating"].map(|name| material(&scene, name));
    for alpha in [[0.0, 0.05], [0.05, 0.2], [0.2, 1.0]] {
        let [coat, plain] = [part(striped, LobeKind::Clearcoat, alpha), part(surface, LobeKind::Base, alpha)];
        assert!((coat - plain).abs() < 0.01, "{alpha:?}: {coat} {plain}");
    }
}

/// With many glass materials, the light through the glass is reported once, and their reflection is planned.
#[test]
fn many_materials_of_glass_are_reported() {
    let scene = shipped("AttenuationTest.glb");
    assert_eq!(scene.materials.len(), 18);
    let of_glass =
        |material: &&SceneMaterial| material.uncovered.iter().any(|what| what.contains("KHR_materials_volume"));
    let glass = scene.materials.iter().filter(of_glass).count();
    let notes = left_out(&scene);
    let of_volume: Vec<&String> = notes.iter().filter(|line| line.contains("KHR_materials_volume")).collect();
    assert_eq!(of_volume.len(), 1, "{notes:?}");
    assert!(of_volume[0].starts_with(&format!("not covered on {glass} materials: ")), "{of_volume:?}");
    assert!(glass >= 10 && scene.materials.iter().all(|material| !material.lobes.is_empty()), "{glass}: {notes:?}");
}
