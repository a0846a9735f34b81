//! Named scenes.

use super::{Camera, Light, LightKind, Material, Mode, Scene, ScenePicture, Surface};
use ltcforge_fit::named_list;

named_list! {
    /// A named scene.
    pub enum NamedScene {
        /// One sphere under a rectangle.
        Sphere = "sphere",
        /// The four materials of KT et al. 2022, figure 14.
        Figure14 = "figure14",
        /// A brushed metal floor at a grazing angle, with a light on its far side.
        BrushedFloor = "brushed_floor",
        /// A light of a few degrees, reflected by metal of roughness 0.02.
        TinyLight = "tiny_light",
        /// A light next to the sphere and as large as the sphere. The horizons of most points cut it.
        Horizon = "horizon",
        /// A television with its picture, behind a brushed metal floor.
        Screen = "screen",
        /// Balls and a box on a brushed metal floor, with shadows by few samples.
        Shadows = "shadows",
    }
}

impl NamedScene {
    /// The parameters of the named scene.
    #[must_use]
    pub fn scene(self) -> Scene {
        let usual = Scene::default();
        match self {
            Self::Sphere => usual,
            Self::Figure14 => Scene {
                materials: [(0.05, 0.25), (0.5, 0.02), (0.5, 0.25), (0.5, 1.0)]
                    .map(|(alpha_x, alpha_y)| Material { alpha_x, alpha_y, rotation: 0.0 })
                    .into(),
                ..usual
            },
            Self::BrushedFloor => Scene {
                surface: Surface::Floor,
                materials: vec![Material { alpha_x: 0.05, alpha_y: 0.4, rotation: 0.0 }],
                light: Light { centre: [0.0, 0.8, -3.0], half_size: [1.2, 0.6], ..usual.light },
                camera: Camera { distance: 4.0, elevation: 0.1, field_of_view: 0.8, target: [0.0; 3], ..usual.camera },
                ..usual
            },
            Self::TinyLight => Scene {
                materials: vec![Material { alpha_x: 0.02, alpha_y: 0.02, rotation: 0.0 }],
                light: Light { kind: LightKind::Disk, half_size: [0.1, 0.1], intensity: 30.0, ..usual.light },
                camera: Camera { field_of_view: 0.25, target: [-0.3, 0.25, 0.0], ..usual.camera },
                ..usual
            },
            Self::Horizon => Scene {
                materials: vec![Material { alpha_x: 0.4, alpha_y: 0.15, rotation: 0.5 }],
                light: Light {
                    centre: [-1.5, 0.0, 0.0],
                    half_size: [1.5, 1.5],
                    intensity: 2.0,
                    two_sided: true,
                    ..usual.light
                },
                ..usual
            },
            Self::Shadows => Scene {
                surface: Surface::Floor,
                materials: vec![Material { alpha_x: 0.1, alpha_y: 0.3, rotation: 0.0 }],
                light: Light { centre: [0.0, 0.9, -2.6], half_size: [1.4, 0.7], ..usual.light },
                camera: Camera {
                    distance: 4.0,
                    elevation: 0.3,
                    field_of_view: 0.55,
                    target: [0.0, 0.2, 0.0],
                    ..usual.camera
                },
                mode: Mode::Shadows,
                size: 256,
                spp: 256,
                ..usual
            },
            Self::Screen => Scene {
                surface: Surface::Floor,
                materials: vec![Material { alpha_x: 0.05, alpha_y: 0.2, rotation: 0.0 }],
                light: Light {
                    centre: [0.0, 0.6, -1.2],
                    half_size: [0.96, 0.54],
                    rotation: [0.0, -0.46, 0.0],
                    intensity: 1.5,
                    ..usual.light
                },
                picture: ScenePicture::Television,
                camera: Camera {
                    distance: 4.0,
                    elevation: 0.25,
                    field_of_view: 0.6,
                    target: [0.0, 0.15, 0.0],
                    ..usual.camera
                },
                ..usual
            },
        }
    }
}
