//! Compares the GPU with the CPU.

use super::{lookups::fitted_to, *};
use crate::{
    picture::Picture,
    preview::{Camera, Choices, Light, LightKind, Material, Mode, NamedScene, Rendered, Scene, ScenePicture, Weights},
};
use ltcforge_fit::{Layout, Precision};
use ltcforge_light::{LightModel, NormalsRule, textured::Readings};

pub(super) const GO_ON: &dyn Fn() -> bool = &|| false;

pub(super) fn render(preview: &mut Preview, table: &Arc<ShaderTable>, scene: &Scene) -> Rendered {
    preview.render(table, scene, GO_ON).expect("a picture")
}

/// The mean absolute difference in units of 1/255, and the share of pixels that differ by more than 2/255.
pub(super) fn apart(a: &Picture, b: &Picture) -> (f64, f64) {
    assert_eq!((a.width, a.height), (b.width, b.height));
    let differences = a.rgb.iter().zip(&b.rgb).map(|(a, b)| [0, 1, 2].map(|i| a[i].abs_diff(b[i])));
    let (mut sum, mut far) = (0_u64, 0_u64);
    for pixel in differences {
        sum += pixel.iter().map(|x| u64::from(*x)).sum::<u64>();
        far += u64::from(pixel.iter().any(|x| *x > 2));
    }
    let pixels = a.rgb.len() as f64;
    (sum as f64 / 3.0 / pixels, far as f64 / pixels)
}

#[track_caller]
fn assert_twins(a: &Picture, b: &Picture, what: &str) {
    let (mean, far) = apart(a, b);
    assert!(mean <= 0.5 && far <= 0.001, "{what}: mean {mean}/255, {far} of the pixels beyond 2/255");
}

/// Every scene in every mode, including the cases that shaders must guard against.
#[test]
fn gpu_and_cpu_agree_in_every_mode_and_scene() {
    let mut renderers = renderers();
    let [gpu, cpu] = &mut *renderers else { return };
    for table in shader_tables() {
        for (named, mode) in NamedScene::ALL.iter().flat_map(|named| Mode::ALL.iter().map(move |mode| (named, *mode))) {
            // Only the CPU renders this mode.
            if mode == Mode::Shadows {
                continue;
            }
            let scene = Scene { size: 128, spp: 8, mode, ..named.scene() };
            let (a, b) = (render(gpu, &table, &scene), render(cpu, &table, &scene));
            assert_eq!(b.adapter, "cpu");
            assert_twins(
                &a.picture,
                &b.picture,
                &format!("{} {} {:?} {:?}", named.name(), mode.name(), table.layout, table.format),
            );
            for (a, b) in a.errors.iter().zip(&b.errors) {
                assert!((a.mean_absolute - b.mean_absolute).abs() < 1e-3 * (1.0 + b.mean_radiance), "{a:?} {b:?}");
            }
        }
    }
}

/// Cameras close to the sphere, straight above and below it, on the floor, and below the floor.
pub(super) fn cameras() -> impl Iterator<Item = Scene> {
    let places =
        [(1.5, 0.3, 2.5), (4.5, -1.57, 0.5), (4.5, 1.57, 0.5), (4.0, 0.0, 0.8), (4.0, 1e-4, 0.8), (4.0, -0.4, 2.0)];
    NamedScene::ALL.iter().flat_map(move |named| {
        places.map(|(distance, elevation, field_of_view)| {
            let scene = named.scene();
            let camera = Camera { distance, elevation, field_of_view, azimuth: 0.7, ..scene.camera };
            Scene { camera, size: 64, spp: 2, ..scene }
        })
    })
}

#[test]
fn gpu_and_cpu_agree_from_everywhere() {
    let mut renderers = renderers();
    let [gpu, cpu] = &mut *renderers else { return };
    let table = shader_table(TexelFormat::F32);
    let by_normals = |scene: &Scene| Scene { mode: Mode::Ltc, model: LightModel::Normals, ..scene.clone() };
    let by_gaussian = |scene: &Scene| {
        let picture = ScenePicture::None;
        Scene { mode: Mode::Ltc, model: LightModel::Asg, picture, ..scene.clone() }
    };
    let shown = |scene: &Scene| {
        let [ltc, reference] = [Mode::Ltc, Mode::Reference].map(|mode| Scene { mode, ..scene.clone() });
        [ltc, reference, by_normals(scene), by_gaussian(scene)]
    };
    for scene in cameras().flat_map(|scene| shown(&scene)) {
        let (a, b) = (render(gpu, &table, &scene), render(cpu, &table, &scene));
        assert_twins(&a.picture, &b.picture, &format!("{scene:?}"));
    }
}

/// The integrals of these lights are as small as rounding errors. The lights are so bright that rounding errors would
/// be visible.
#[test]
fn gpu_and_cpu_agree_under_small_lights() {
    let mut renderers = renderers();
    let [gpu, cpu] = &mut *renderers else { return };
    let table = shader_table(TexelFormat::F32);
    let ltc = &[LightModel::Ltc][..];
    for (half_size, centre, exposure, models) in [
        ("0.001,0.001", "-6,7,8", "10000", ltc),
        ("0.02,0.02", "-36,42,48", "1000", ltc),
        ("0.002,0.002", "-1.6,1.8,2.2", "100", ltc),
        // The closed form loses accuracy earlier: for a light of a hundredth of a radian.
        ("0.03,0.03", "-3.6,4.2,4.8", "10", LightModel::ALL),
    ] {
        let scene = [
            ("alpha_x", "0.8"),
            ("alpha_y", "0.5"),
            ("light_half_size", half_size),
            ("light_centre", centre),
            ("light_intensity", "10000"),
            ("exposure", exposure),
            ("size", "128"),
        ];
        let scene = Choices::read(scene).expect("a scene");
        for scene in models.iter().map(|model| Scene { model: *model, ..scene.clone() }) {
            let (a, b) = (render(gpu, &table, &scene), render(cpu, &table, &scene));
            assert_twins(&a.picture, &b.picture, &format!("{scene:?}"));
            assert!(b.picture.rgb.iter().any(|pixel| pixel[0] > 128), "{half_size} lights nothing");
        }
    }
}

/// Lights of every shape, by every model: next to the surface, around a part of the surface, and far away.
#[test]
fn gpu_and_cpu_agree_on_every_shape() {
    let mut renderers = renderers();
    let [gpu, cpu] = &mut *renderers else { return };
    let table = shader_table(TexelFormat::F32);
    for (named, kind) in [NamedScene::Sphere, NamedScene::BrushedFloor, NamedScene::Horizon]
        .into_iter()
        .flat_map(|named| LightKind::NAMED.map(|(_, kind)| (named, kind)))
    {
        let usual = named.scene();
        for (centre, half_size) in
            [(usual.light.centre, [0.8, 0.3]), ([0.9, 0.7, 0.2], [2.0, 0.5]), ([3.0, 0.5, 0.0], [1.5, 1e-2])]
        {
            let light = Light { kind, centre, half_size, rotation: [0.3, 0.8, 0.1], ..usual.light };
            for (mode, model) in
                LightModel::ALL.iter().map(|model| (Mode::Ltc, *model)).chain([(Mode::Reference, LightModel::Ltc)])
            {
                let scene = Scene { size: 64, spp: 4, mode, model, light, ..usual.clone() };
                let (a, b) = (render(gpu, &table, &scene), render(cpu, &table, &scene));
                assert_twins(
                    &a.picture,
                    &b.picture,
                    &format!("{kind:?} {} {} {model} {centre:?}", named.name(), mode.name()),
                );
            }
        }
    }
}

/// A picture on a light that is above, below or behind the surface, or shows its dark side. Every model, rule and
/// number of texture reads renders it.
#[test]
fn gpu_and_cpu_agree_on_pictures() {
    let mut renderers = renderers();
    let [gpu, cpu] = &mut *renderers else { return };
    let two_lobes =
        ["two_lobes", "blended_lobes"].map(|fresnel| fitted_to(fresnel, Layout::Reflected, Precision::F32, false));
    let tables = [vec![reflected()], two_lobes.into()].concat();
    let tables: Vec<_> = tables.iter().map(|table| Arc::new(ShaderTable::new(table, TexelFormat::F32))).collect();
    let screen = NamedScene::Screen.scene();
    let horizon = NamedScene::Horizon.scene();
    let places = [
        screen.clone(),
        Scene { light: Light { two_sided: true, rotation: [2.0, 0.3, 0.2], ..screen.light }, ..screen.clone() },
        Scene { picture: ScenePicture::Window, ..horizon.clone() },
        Scene { picture: ScenePicture::Television, light: Light { two_sided: false, ..horizon.light }, ..horizon },
    ];
    let mut changed = 0;
    for scene in places.map(|scene| Scene { size: 64, spp: 8, ..scene }) {
        let by_readings =
            Readings::ALL.iter().map(|readings| Scene { readings: *readings, mode: Mode::Ltc, ..scene.clone() });
        let by_rule = NormalsRule::SHADED.map(|rule| Scene {
            rule,
            model: LightModel::Normals,
            mode: Mode::Ltc,
            ..scene.clone()
        });
        let others = [
            Scene { cut: true, mode: Mode::Ltc, ..scene.clone() },
            Scene { model: LightModel::LtcFormula, mode: Mode::Ltc, ..scene.clone() },
            Scene { compensate: true, mode: Mode::Models, ..scene.clone() },
            Scene { mode: Mode::Reference, ..scene.clone() },
        ];
        for scene in by_readings.chain(by_rule).chain(others) {
            for table in &tables {
                let (a, b) = (render(gpu, table, &scene), render(cpu, table, &scene));
                let what = format!("{:?} {} {} {}", scene.picture, scene.mode.name(), scene.model, scene.readings);
                assert_twins(&a.picture, &b.picture, &what);
                let even = render(cpu, table, &Scene { picture: ScenePicture::None, ..scene.clone() });
                changed += usize::from(apart(&even.picture, &b.picture).1 > 0.05);
            }
        }
    }
    assert!(changed > 70, "{changed} pictures differ without the picture on the light");
}

/// Every model and the reference compensate for the light lost between facets. The pictures must become brighter.
#[test]
fn gpu_and_cpu_agree_on_compensation() {
    let mut renderers = renderers();
    let [gpu, cpu] = &mut *renderers else { return };
    let table = shader_table(TexelFormat::F32);
    let materials = vec![Material { alpha_x: 0.9, alpha_y: 0.4, rotation: 0.5 }];
    let models = LightModel::ALL.iter().map(|model| (Mode::Ltc, *model));
    for (mode, model) in models.chain([(Mode::Reference, LightModel::Ltc)]) {
        let scene = Scene { size: 96, mode, model, compensate: true, materials: materials.clone(), ..Scene::default() };
        let (a, b) = (render(gpu, &table, &scene), render(cpu, &table, &scene));
        assert_twins(&a.picture, &b.picture, &format!("{} {model}", mode.name()));
        let once = render(cpu, &table, &Scene { compensate: false, ..scene });
        let sum = |picture: &Picture| picture.rgb.iter().map(|pixel| u64::from(pixel[1])).sum::<u64>();
        let (all, once) = (sum(&b.picture), sum(&once.picture));
        assert!(all > once + once / 20, "{} {model}: {all} {once}", mode.name());
    }
}

/// Lights of every shape. The part of the light below the surface is cut off.
#[test]
fn gpu_and_cpu_agree_on_lights_that_the_surface_cuts() {
    let mut renderers = renderers();
    let [gpu, cpu] = &mut *renderers else { return };
    let table = shader_table(TexelFormat::F32);
    let mut darker = 0;
    for (named, kind) in [NamedScene::BrushedFloor, NamedScene::Horizon, NamedScene::Sphere]
        .into_iter()
        .flat_map(|named| LightKind::NAMED.map(|(_, kind)| (named, kind)))
    {
        let usual = named.scene();
        for (centre, half_size) in [(usual.light.centre, [0.8, 0.3]), ([0.9, 0.1, 0.2], [2.0, 0.5])] {
            let light = Light { kind, centre, half_size, rotation: [0.3, 0.8, 0.1], ..usual.light };
            for model in [LightModel::Ltc, LightModel::LtcFormula] {
                let scene = Scene { size: 64, cut: true, light, model, ..usual.clone() };
                let (a, b) = (render(gpu, &table, &scene), render(cpu, &table, &scene));
                assert_twins(&a.picture, &b.picture, &format!("{model} {kind:?} {} {centre:?}", named.name()));
                let uncut = render(cpu, &table, &Scene { cut: false, ..scene });
                darker += usize::from(apart(&uncut.picture, &b.picture).1 > 0.01);
            }
        }
    }
    assert!(darker > 20, "only {darker} pictures change without the cut");
}

#[test]
fn gpu_and_cpu_agree_on_mirrors_and_needles() {
    let mut renderers = renderers();
    let [gpu, cpu] = &mut *renderers else { return };
    let extremes = [(0.0, 0.0), (1e-4, 1e-4), (1.0, 1e-3), (0.001, 0.3), (1.0, 1.0)];
    for (table, (alpha_x, alpha_y)) in shader_tables().iter().flat_map(|table| extremes.map(|alphas| (table, alphas))) {
        for mode in [Mode::Ltc, Mode::Reference, Mode::Lobe] {
            let materials = vec![Material { alpha_x, alpha_y, rotation: 1.0 }];
            let scene = Scene { size: 128, spp: 8, mode, materials, ..Scene::default() };
            let (a, b) = (render(gpu, table, &scene), render(cpu, table, &scene));
            assert_twins(
                &a.picture,
                &b.picture,
                &format!("{alpha_x} {alpha_y} {} {:?} {:?}", mode.name(), table.layout, table.format),
            );
        }
    }
}

/// The closed form, by each of its rules.
#[test]
fn gpu_and_cpu_agree_on_mirrors_and_needles_by_normals() {
    let mut renderers = renderers();
    let [gpu, cpu] = &mut *renderers else { return };
    let table = shader_table(TexelFormat::F32);
    let extremes = [(0.0, 0.0), (1e-4, 1e-4), (1.0, 1e-3), (0.001, 0.3), (1.0, 1.0)];
    for (rule, (alpha_x, alpha_y)) in NormalsRule::SHADED.iter().flat_map(|rule| extremes.map(|alphas| (*rule, alphas)))
    {
        let materials = vec![Material { alpha_x, alpha_y, rotation: 1.0 }];
        let scene = Scene { size: 128, model: LightModel::Normals, rule, materials, ..Scene::default() };
        let (a, b) = (render(gpu, &table, &scene), render(cpu, &table, &scene));
        assert_twins(&a.picture, &b.picture, &format!("{alpha_x} {alpha_y} {rule}"));
    }
}

/// The LTC without a table and both Gaussians, on surfaces with mirror-like to narrow lobes, and in every scene.
#[test]
fn gpu_and_cpu_agree_by_formulas() {
    let mut renderers = renderers();
    let [gpu, cpu] = &mut *renderers else { return };
    let table = shader_table(TexelFormat::F32);
    let extremes = [(0.0, 0.0), (1e-4, 1e-4), (1.0, 1e-3), (0.001, 0.3), (1.0, 1.0)].map(|(alpha_x, alpha_y)| Scene {
        size: 128,
        materials: vec![Material { alpha_x, alpha_y, rotation: 1.0 }],
        ..Scene::default()
    });
    let named: Vec<Scene> = NamedScene::ALL.iter().map(|named| Scene { size: 96, ..named.scene() }).collect();
    for scene in extremes.iter().chain(&named) {
        for model in [LightModel::LtcFormula, LightModel::Sg, LightModel::Asg] {
            let scene = Scene { model, picture: ScenePicture::None, ..scene.clone() };
            let (a, b) = (render(gpu, &table, &scene), render(cpu, &table, &scene));
            assert_twins(&a.picture, &b.picture, &format!("{model} {:?} {:?}", scene.materials, scene.camera));
        }
    }
}

/// Lights on the floor, above it, behind it and around it, by each rule.
#[test]
fn gpu_and_cpu_agree_in_every_scene_by_normals() {
    let mut renderers = renderers();
    let [gpu, cpu] = &mut *renderers else { return };
    let table = shader_table(TexelFormat::F32);
    for (named, rule) in
        NamedScene::ALL.iter().flat_map(|named| NormalsRule::SHADED.iter().map(move |rule| (named, *rule)))
    {
        let scene = Scene { size: 96, spp: 4, model: LightModel::Normals, rule, ..named.scene() };
        let (a, b) = (render(gpu, &table, &scene), render(cpu, &table, &scene));
        assert_eq!(b.adapter, "cpu");
        assert_twins(&a.picture, &b.picture, &format!("{} {rule}", named.name()));
    }
}

/// Pictures whose edge is within a workgroup, and more samples than one pass takes.
#[test]
fn gpu_and_cpu_agree_on_odd_sizes_and_many_samples() {
    let mut renderers = renderers();
    let [gpu, cpu] = &mut *renderers else { return };
    let table = shader_table(TexelFormat::F32);
    for (size, spp, mode) in [(101, 3, Mode::Strip), (64, 2100, Mode::Reference)] {
        let scene = Scene { size, spp, mode, ..NamedScene::Figure14.scene() };
        let (a, b) = (render(gpu, &table, &scene), render(cpu, &table, &scene));
        assert_twins(&a.picture, &b.picture, &format!("{size} {spp}"));
    }
}

/// A GPU's sampler has 8-bit weights, which is visible. Lavapipe's sampler has f32 weights.
#[test]
fn sampler_and_shader_weights_make_the_same_picture() {
    let mut renderers = renderers();
    let [_, cpu] = &mut *renderers else { return };
    for weights in [Weights::Shader, Weights::Sampler] {
        let mut gpu = Preview::with_weights(Adapter::Gpu, weights);
        // A GPU may be unable to sample 32-bit tables.
        let is_software = match gpu.adapter_name() {
            Ok(name) => name.contains("llvmpipe"),
            Err(PreviewError::NoAdapter(reason)) => {
                report_skipped(&reason);
                continue;
            }
            Err(error) => panic!("{error}"),
        };
        for (named, format) in [(NamedScene::Sphere, TexelFormat::F32), (NamedScene::Figure14, TexelFormat::F16)] {
            let table = shader_table(format);
            let scene = Scene { size: 128, ..named.scene() };
            let (a, b) = (render(&mut gpu, &table, &scene), render(cpu, &table, &scene));
            if weights == Weights::Shader || is_software {
                assert_twins(&a.picture, &b.picture, &format!("{weights:?} {format:?}"));
            } else {
                assert!(apart(&a.picture, &b.picture).0 < 1.0);
            }
        }
    }
}
