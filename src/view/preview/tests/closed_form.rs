//! The error of the closed form over whole pictures.

use super::*;
use crate::preview::{Mode, NamedScene, PanelError, Scene};
use ltcforge_light::LightModel;

/// Scenes of `docs/normals.md`. The number is the largest mean error over the surfaces of the scene.
const LIMITS: [(NamedScene, f64); 4] = [
    (NamedScene::Sphere, 6e-4),
    (NamedScene::Figure14, 6e-4),
    (NamedScene::BrushedFloor, 10e-4),
    (NamedScene::Horizon, 30e-4),
];

#[test]
fn in_pictures_the_closed_form_is_near_the_reference() {
    let (mut renderers, table) = (renderers(), shader_table(TexelFormat::F32));
    for (named, most) in LIMITS {
        let scene = Scene { size: 96, spp: 4096, mode: Mode::Difference, model: LightModel::Normals, ..named.scene() };
        let errors = renderers[0].render(&table, &scene, &|| false).expect("a picture").errors;
        assert_eq!(errors.len(), scene.materials.len());
        for PanelError { alpha_x, alpha_y, mean_absolute, mean_radiance, .. } in errors {
            let what = format!("{} {alpha_x} {alpha_y}", named.name());
            assert!(mean_absolute <= most, "{what}: {mean_absolute}, more than {most}");
            assert!(mean_radiance > 0.03, "{what} is dark: {mean_radiance}");
        }
    }
}
