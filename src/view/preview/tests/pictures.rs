//! Properties of pictures, for every renderer.

use super::{
    twins::{GO_ON, cameras, render},
    *,
};
use crate::preview::{Choices, Estimator, Material, Mode, NamedScene, Scene};
use ltcforge_fit::{LobeModel, SecondLobe};
use ltcforge_light::LightModel;

fn estimators() -> impl Iterator<Item = Estimator> {
    let tables = LobeModel::ALL.iter().map(|lobe| Estimator::Table(*lobe));
    let tables = tables.chain(SecondLobe::ALL.map(Estimator::TwoLobes));
    let formulas = LightModel::ALL.iter().flat_map(|model| model.closed_forms()).map(Estimator::ClosedForm);
    tables.chain(formulas).chain([Estimator::Reference, Estimator::TableLobe, Estimator::ReferenceLobe])
}

#[test]
fn rendering_a_picture_twice_gives_the_same_bytes() {
    let table = shader_table(TexelFormat::F32);
    for preview in renderers().iter_mut() {
        for mode in Mode::ALL.iter().copied() {
            let scene = Scene { size: 96, spp: 4, mode, ..NamedScene::Figure14.scene() };
            let first = render(preview, &table, &scene).picture.png().expect("a file");
            let again = render(preview, &table, &scene).picture.png().expect("a file");
            assert_eq!(first, again, "{}", mode.name());
        }
    }
}

#[test]
fn a_lost_device_is_opened_again() {
    let mut renderers = renderers();
    let [gpu, _] = &mut *renderers else { return };
    let table = shader_table(TexelFormat::F32);
    let scene = Scene { size: 64, ..Scene::default() };
    let before = render(gpu, &table, &scene);
    gpu.lose_device();
    assert_eq!(render(gpu, &table, &scene), before);
}

#[test]
fn a_picture_is_not_shared_between_gpu_and_cpu() {
    // Without a GPU, nothing fails in the middle.
    let [_, _] = &*renderers() else { return };
    let table = shader_table(TexelFormat::F32);
    let mut any = Preview::new(Adapter::Any);
    for mode in [Mode::Difference, Mode::Strip, Mode::Lobe] {
        let scene = Scene { mode, size: 64, spp: 4, ..Scene::default() };
        any.fail_after(1);
        let rendered = render(&mut any, &table, &scene);
        assert_eq!(rendered.adapter, "cpu");
        let by_cpu = render(&mut Preview::new(Adapter::Cpu), &table, &scene);
        assert!(rendered == by_cpu, "{}: a part of the picture is not from the CPU", mode.name());
    }
}

#[test]
fn a_picture_can_be_stopped_and_a_bad_scene_is_refused() {
    let table = shader_table(TexelFormat::F32);
    for preview in renderers().iter_mut() {
        let scene = Scene::default();
        assert_eq!(preview.render(&table, &scene, &|| true), Err(PreviewError::Stopped));
        let bad = Scene { size: 4096, ..scene };
        let Err(PreviewError::Scene(faults, _)) = preview.render(&table, &bad, GO_ON) else { panic!("accepted") };
        assert_eq!(faults.len(), 1);
    }
}

/// Two scenes make the same picture if and only if they have the same canonical form.
#[test]
fn parameters_that_a_mode_does_not_show_are_not_in_its_canonical_form() {
    let table = shader_table(TexelFormat::F32);
    let mut cpu = Preview::new(Adapter::Cpu);
    let others = [
        ("scene", "horizon"),
        ("alpha_x", "0.3"),
        ("alpha_y", "0.4"),
        ("rotation", "1"),
        ("f0", "1,0.5,0"),
        ("light", "triangle"),
        ("light_centre", "1,2,2"),
        ("light_half_size", "0.5,0.5"),
        ("light_rotation", "1.5,0,0"),
        ("light_intensity", "1"),
        ("camera_distance", "6"),
        ("camera_azimuth", "1"),
        ("camera_elevation", "1"),
        ("camera_target", "0.2,0,0.1"),
        ("field_of_view", "1"),
        ("theta", "0.5"),
        ("phi", "1.5"),
        ("exposure", "2"),
        ("difference_scale", "0.07"),
        ("spp", "3"),
    ];
    for mode in Mode::ALL.iter().copied() {
        let usual = [("mode", mode.name()), ("size", "64")];
        let scene = Choices::read(usual).expect("a scene");
        let picture = render(&mut cpu, &table, &scene).picture;
        for other in others {
            let changed = Choices::read(usual.into_iter().chain([other])).expect("a scene");
            let is_same = render(&mut cpu, &table, &changed).picture == picture;
            assert_eq!(scene.clone().canonical() == changed.canonical(), is_same, "{} {other:?}", mode.name());
        }
    }
}

#[test]
fn a_floor_is_visible_only_from_above() {
    let table = shader_table(TexelFormat::F32);
    for preview in renderers().iter_mut() {
        for elevation in ["0", "-0.3", "-1.5", "1e-9"] {
            let scene = [("scene", "brushed_floor"), ("camera_elevation", elevation), ("size", "64")];
            let scene = Choices::read(scene).expect("a scene");
            let picture = render(preview, &table, &scene).picture;
            assert!(picture.rgb.iter().all(|pixel| *pixel == picture.rgb[0]), "{elevation}");
        }
    }
}

/// No table and no scene produces a NaN.
#[test]
fn every_pixel_is_a_number() {
    let mut hostile = planted();
    // Singular, mirroring, huge and tiny matrices.
    for (i, matrix) in hostile.matrix.iter_mut().enumerate() {
        match i % 5 {
            0 => *matrix = [0.0; 9],
            1 => matrix[0] = -matrix[0],
            2 => *matrix = matrix.map(|x| x * 1e12),
            3 => *matrix = matrix.map(|x| x * 1e-12),
            _ => {}
        }
    }
    for table in [shader_table(TexelFormat::F16), Arc::new(ShaderTable::new(&hostile, TexelFormat::F32))] {
        for preview in renderers().iter_mut() {
            for mut scene in cameras() {
                scene.materials[0] = Material { alpha_x: 0.0, alpha_y: 1.0, rotation: 0.0 };
                for estimator in estimators() {
                    let part = preview.part(&table, &scene, estimator, [16; 2], [32; 2]).expect("radiances");
                    assert_eq!(part.pixels.len(), 32 * 32);
                    let lowest = if matches!(estimator, Estimator::Table(LobeModel::Ltc) | Estimator::Reference) {
                        0.0
                    } else {
                        -1.0
                    };
                    let bad = part.pixels.iter().flatten().find(|x| !(x.is_finite() && **x >= lowest));
                    assert_eq!(bad, None, "{estimator:?} {scene:?}");
                }
            }
        }
    }
}
