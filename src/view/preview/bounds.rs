//! Checks of a scene: numbers within bounds, and pictures only on lights that support them.

use super::{LightKind, Mode, Scene, ScenePicture, parameters::PARAMETERS, scene::MAX_MATERIALS};
use ltcforge_fit::MAX_VERTICES;
use ltcforge_light::LightModel;

/// The reason that a scene is not rendered.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SceneFault {
    /// A parameter is out of bounds.
    #[error("{field} must be between {low} and {high}, got {value}")]
    Bounds {
        /// The parameter, such as `light_intensity`.
        field: String,
        /// The parameter's value.
        value: f64,
        /// The least allowed value.
        low: f64,
        /// The greatest allowed value.
        high: f64,
    },
    /// Mode `shadows` shows another shape of light than a polygon.
    #[error("light must be a polygon in mode shadows, got {0}")]
    Shadows(&'static str),
    /// The light cannot have a picture.
    #[error("light_picture {0}")]
    Picture(#[from] PictureFault),
}

/// The reason that a light cannot have a picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum PictureFault {
    /// The light has another shape.
    #[error("needs light rectangle, got {0}: change the light or leave the picture out")]
    Shape(&'static str),
    /// The model does not support pictures.
    #[error(
        "works with models {models}, not {0}: change the model or leave the picture out",
        models = LightModel::names_of(LightModel::has_pictures)
    )]
    Model(LightModel),
}

impl SceneFault {
    /// The name of the parameter, and its fault.
    pub(super) fn named(&self) -> (&str, String) {
        match self {
            Self::Bounds { field, value, low, high } => (field, format!("must be {low} to {high}, got {value}")),
            Self::Shadows(shape) => ("light", format!("must be a polygon in mode shadows, got {shape}")),
            Self::Picture(fault) => ("light_picture", fault.to_string()),
        }
    }
}

impl Scene {
    /// Every number that is out of bounds: counts, then parameters in their order. Also every reason that the light
    /// cannot have its picture. A NaN is out of bounds.
    #[must_use]
    pub fn faults(&self) -> Vec<SceneFault> {
        let mut scene = self.clone();
        // These two counts are not parameters.
        let sides = if let LightKind::Polygon(sides) = self.light.kind { sides } else { 3 };
        let counts = [
            ("materials", [1.0, MAX_MATERIALS as f64], vec![self.materials.len() as f64]),
            ("light", [3.0, MAX_VERTICES as f64], vec![f64::from(sides)]),
        ];
        let parameters = PARAMETERS.iter().map(|parameter| {
            let (bounds, numbers) = parameter.bounded(&mut scene);
            (parameter.name, bounds, numbers)
        });
        let mut faults = Vec::new();
        for (field, [low, high], numbers) in counts.into_iter().chain(parameters) {
            let outside = numbers.into_iter().filter(|value| !(low..=high).contains(value));
            faults.extend(outside.map(|value| SceneFault::Bounds { field: field.to_owned(), value, low, high }));
        }
        let has_corners = matches!(self.light.kind, LightKind::Rectangle | LightKind::Polygon(_));
        if self.mode == Mode::Shadows && !has_corners {
            faults.push(SceneFault::Shadows(self.light.kind.name()));
        }
        faults.extend(self.picture_faults().into_iter().map(SceneFault::from));
        faults
    }

    fn picture_faults(&self) -> Vec<PictureFault> {
        if self.picture == ScenePicture::None || self.mode == Mode::Lobe {
            return Vec::new();
        }
        let other = LightModel::ALL.iter().filter(|model| !model.has_pictures() && self.shows(**model));
        let shape = (self.light.kind != LightKind::Rectangle).then(|| PictureFault::Shape(self.light.kind.name()));
        shape.into_iter().chain(other.map(|model| PictureFault::Model(*model))).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::preview::{Light, Material, NamedScene};

    #[test]
    fn defaults_and_named_scenes_are_within_bounds() {
        assert_eq!(Scene::default().faults(), []);
        for named in NamedScene::ALL {
            assert_eq!(named.scene().faults(), [], "{}", named.name());
        }
    }

    #[test]
    fn every_fault_is_named() {
        let mut scene = Scene { size: 63, spp: 0, ..Scene::default() };
        scene.materials.push(Material { alpha_x: f64::NAN, ..Material::default() });
        scene.light.kind = LightKind::Polygon(9);
        let faults = scene.faults();
        let fields: Vec<&str> = faults.iter().map(|fault| fault.named().0).collect();
        assert_eq!(fields, ["light", "size", "spp", "alpha_x"]);
        assert_eq!(faults[1].to_string(), "size must be between 64 and 2048, got 63");
        let none = Scene { materials: Vec::new(), ..Scene::default() };
        assert_eq!(none.faults()[0].to_string(), "materials must be between 1 and 4, got 0");
    }

    #[test]
    fn only_rectangles_and_some_models_support_pictures() {
        let usual = NamedScene::Screen.scene();
        let refused = |scene: &Scene| scene.faults().iter().map(ToString::to_string).collect::<Vec<_>>();
        let light = Light { kind: LightKind::Tube, ..usual.light };
        let both = Scene { light, model: LightModel::Sg, mode: Mode::Strip, spp: 0, ..usual.clone() };
        let messages = [
            "spp must be between 1 and 4096, got 0",
            "light_picture needs light rectangle, got tube: change the light or leave the picture out",
            "light_picture works with models normals, ltc and ltc-formula, not sg: change the model or leave the picture out",
        ];
        assert_eq!(refused(&both), messages);
        // Parameters that a mode does not use cause no fault.
        assert_eq!(refused(&Scene { spp: 4, mode: Mode::Reference, light: usual.light, ..both.clone() }), [""; 0]);
        assert_eq!(refused(&Scene { spp: 4, mode: Mode::Lobe, ..both.clone() }), [""; 0]);
        assert_eq!(refused(&Scene { spp: 4, picture: ScenePicture::None, ..both }), [""; 0]);
    }
}
