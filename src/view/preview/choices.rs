//! A caller's choice of a scene: a named scene, and parameters that differ from it. The command line and HTTP have the
//! same parameters.

use std::collections::BTreeMap;

use super::{
    Scene,
    parameter::{Parameter, Value},
    parameters::PARAMETERS,
};
use crate::parameters::{ParameterFault, read_pairs};

/// Values of parameters, by their index in [`PARAMETERS`]. A missing parameter keeps the value of the named scene.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Choices {
    values: BTreeMap<usize, Value>,
}

impl Choices {
    /// The scene for a list of (name, text) pairs.
    ///
    /// # Errors
    /// Every parameter that is unknown, repeated, malformed or out of bounds.
    pub fn read<'a>(pairs: impl IntoIterator<Item = (&'a str, &'a str)>) -> Result<Scene, Vec<ParameterFault>> {
        let mut choices = Self::default();
        let mut faults = read_pairs(pairs, |name, text| choices.set(name, text));
        let scene = choices.into_scene();
        for fault in scene.faults() {
            let (field, detail) = fault.named();
            let fault = ParameterFault::new(field, detail);
            // A fault that all materials share is reported once.
            if !faults.contains(&fault) {
                faults.push(fault);
            }
        }
        if faults.is_empty() { Ok(scene) } else { Err(faults) }
    }

    /// Sets the parameter `name` to the value in `text`.
    fn set(&mut self, name: &str, text: &str) -> Result<(), String> {
        let Some(index) = PARAMETERS.iter().position(|parameter| parameter.name == name) else {
            return Err(format!("is not a parameter of a preview; its parameters are table, {}", names().join(", ")));
        };
        self.values.insert(index, PARAMETERS[index].parse(text)?);
        Ok(())
    }

    /// The choices for the parameters for which `value` returns a value. The value must be parsed by the same
    /// parameter.
    pub fn of(value: impl Fn(&Parameter) -> Option<Value>) -> Self {
        let chosen = PARAMETERS.iter().enumerate().filter_map(|(index, parameter)| Some((index, value(parameter)?)));
        Self { values: chosen.collect() }
    }

    /// The named scene with the chosen values. Their bounds are not checked.
    #[must_use]
    pub fn into_scene(self) -> Scene {
        let mut scene = Scene::default();
        for (index, value) in &self.values {
            PARAMETERS[*index].set(&mut scene, value);
        }
        scene
    }
}

fn names() -> Vec<&'static str> {
    PARAMETERS.iter().map(|parameter| parameter.name).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::preview::{Light, LightKind, Material, Mode, NamedScene};

    #[test]
    fn texts_set_fields_in_any_order() {
        let pairs = [("mode", "strip"), ("light", "hexagon"), ("light_centre", "-1, 2,3e0"), ("scene", "figure14")];
        let usual = NamedScene::Figure14.scene();
        let light = Light { kind: LightKind::Polygon(6), centre: [-1.0, 2.0, 3.0], ..usual.light };
        assert_eq!(Choices::read(pairs), Ok(Scene { mode: Mode::Strip, light, ..usual }));
        assert_eq!(Choices::read([]), Ok(Scene::default()));
    }

    #[test]
    fn every_name_is_known() {
        for name in names() {
            let detail = Choices::read([(name, "?")]).expect_err("no value of any").remove(0).detail;
            assert!(detail.starts_with("«?» is"), "{name}: {detail}");
        }
    }

    #[test]
    fn one_material_replaces_the_materials_of_the_scene() {
        let scene = Choices::read([("scene", "figure14"), ("alpha_y", "0.75")]).expect("known parameters");
        assert_eq!(scene.materials, [Material { alpha_x: 0.05, alpha_y: 0.75, rotation: 0.0 }]);
    }

    #[test]
    fn a_described_material_replaces_them_and_roughness_overrides_it() {
        let material = ("material", "openpbr:specular_roughness=1,specular_roughness_anisotropy=0.5");
        let scene = Choices::read([("scene", "figure14"), material, ("rotation", "1")]).expect("known parameters");
        let alpha_y = 0.5 * 1.6_f64.sqrt();
        assert_eq!(scene.materials, [Material { alpha_x: 1.0, alpha_y, rotation: 1.0 }]);
        let detail = Choices::read([("material", "openpbr:a=1,b=1")]).expect_err("two faults").remove(0).detail;
        assert_eq!(detail.matches("openpbr has no").count(), 2, "{detail}");
    }

    #[test]
    fn every_fault_is_reported() {
        let pairs = [
            ("colour", "red"),
            ("size", "63"),
            ("spp", "99999999999"),
            ("f0", "1,2"),
            ("phi", "NaN"),
            ("exposure", "1"),
            ("exposure", "1"),
            ("light", "cube"),
            ("scene", "figure14"),
            ("rotation", "7"),
        ];
        let faults = Choices::read(pairs).expect_err("faults");
        let found: Vec<String> = faults.iter().map(|fault| format!("{}: {}", fault.parameter, fault.detail)).collect();
        let expected = [
            &format!("colour: is not a parameter of a preview; its parameters are table, {}", names().join(", ")),
            "spp: «99999999999» is not a whole number from 1 to 4096",
            "f0: «1,2» is not 3 comma-separated numbers",
            "exposure: is given more than once",
            "light: «cube» is not one of rectangle, disk, sphere, tube, line, triangle, pentagon, hexagon, heptagon, octagon",
            "size: must be 64 to 2048, got 63",
            "rotation: must be -6.283185307179586 to 6.283185307179586, got 7",
            "phi: must be -6.283185307179586 to 6.283185307179586, got NaN",
        ];
        assert_eq!(found, expected);
    }
}
