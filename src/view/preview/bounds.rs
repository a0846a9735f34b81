//! Scenes whose numbers are out of bounds.

use super::{LightKind, Scene, parameters::PARAMETERS, scene::MAX_MATERIALS};
use ltcforge_fit::MAX_VERTICES;

/// A parameter that is out of its bounds.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("{field} is {value}, not within {low} to {high}")]
pub struct SceneFault {
    /// The parameter, such as `light_intensity`.
    pub field: String,
    /// Its value.
    pub value: f64,
    /// The least it may be.
    pub low: f64,
    /// The most it may be.
    pub high: f64,
}

impl Scene {
    /// Every number that is out of its bounds, in the order of the parameters. Not-a-number is within no bounds.
    #[must_use]
    pub fn faults(&self) -> Vec<SceneFault> {
        let mut scene = self.clone();
        // Two counts that no parameter gives.
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
            faults.extend(outside.map(|value| SceneFault { field: field.to_owned(), value, low, high }));
        }
        faults
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::preview::{Material, NamedScene};

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
        let fields: Vec<&str> = faults.iter().map(|fault| fault.field.as_str()).collect();
        assert_eq!(fields, ["light", "size", "spp", "alpha_x"]);
        assert_eq!(faults[1].to_string(), "size is 63, not within 64 to 2048");
        let none = Scene { materials: Vec::new(), ..Scene::default() };
        assert_eq!(none.faults()[0].to_string(), "materials is 0, not within 1 to 4");
    }
}
