//! A scene as its callers choose it: by a name and by parameters that differ from it. The command line and HTTP choose
//! by the same parameters.

use std::collections::BTreeMap;

use super::{
    Scene,
    parameter::{Parameter, Value},
    parameters::PARAMETERS,
};
use crate::parameters::{ParameterFault, read_pairs};

/// Values of parameters, by their places in [`PARAMETERS`]. A parameter that is left out is as in the named scene.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Choices {
    values: BTreeMap<usize, Value>,
}

impl Choices {
    /// The scene of a list of parameters as texts.
    ///
    /// # Errors
    /// Every parameter that is unknown, stands twice, is malformed or is out of its bounds.
    pub fn read<'a>(pairs: impl IntoIterator<Item = (&'a str, &'a str)>) -> Result<Scene, Vec<ParameterFault>> {
        let mut choices = Self::default();
        let mut faults = read_pairs(pairs, |name, text| choices.set(name, text));
        let scene = choices.into_scene();
        for fault in scene.faults() {
            let (field, detail) = fault.told();
            let fault = ParameterFault::new(field, detail);
            // A parameter that all materials share is reported once.
            if !faults.contains(&fault) {
                faults.push(fault);
            }
        }
        if faults.is_empty() { Ok(scene) } else { Err(faults) }
    }

    /// Sets the parameter `name` to the value in `text`.
    fn set(&mut self, name: &str, text: &str) -> Result<(), String> {
        let Some(index) = PARAMETERS.iter().position(|parameter| parameter.name == name) else {
            return Err(format!("is no parameter of a preview, which are table, {}", names().join(", ")));
        };
        self.values.insert(index, PARAMETERS[index].parse(text)?);
        Ok(())
    }

    /// The choices that `value` finds for each parameter; a value is one that the parameter has parsed.
    pub fn of(value: impl Fn(&Parameter) -> Option<Value>) -> Self {
        let chosen = PARAMETERS.iter().enumerate().filter_map(|(index, parameter)| Some((index, value(parameter)?)));
        Self { values: chosen.collect() }
    }

    /// The named scene with the changes. Its bounds are not checked.
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
    fn texts_set_fields_whatever_their_order() {
        let pairs = [("mode", "strip"), ("light", "hexagon"), ("light_centre", "-1, 2,3e0"), ("scene", "figure14")];
        let usual = NamedScene::Figure14.scene();
        let light = Light { kind: LightKind::Polygon(6), centre: [-1.0, 2.0, 3.0], ..usual.light };
        assert_eq!(Choices::read(pairs), Ok(Scene { mode: Mode::Strip, light, ..usual }));
        assert_eq!(Choices::read([]), Ok(Scene::default()));
    }

    #[test]
    fn every_name_is_taken() {
        for name in names() {
            let told = Choices::read([(name, "?")]).expect_err("no value of any").remove(0).detail;
            assert!(told.starts_with("«?» is"), "{name}: {told}");
        }
    }

    #[test]
    fn one_material_takes_the_place_of_the_scene_s() {
        let scene = Choices::read([("scene", "figure14"), ("alpha_y", "0.75")]).expect("known parameters");
        assert_eq!(scene.materials, [Material { alpha_x: 0.05, alpha_y: 0.75, rotation: 0.0 }]);
    }

    #[test]
    fn a_described_material_takes_their_place_and_roughness_beside_it_its() {
        let material = ("material", "openpbr:specular_roughness=1,specular_roughness_anisotropy=0.5");
        let scene = Choices::read([("scene", "figure14"), material, ("rotation", "1")]).expect("known parameters");
        let alpha_y = 0.5 * 1.6_f64.sqrt();
        assert_eq!(scene.materials, [Material { alpha_x: 1.0, alpha_y, rotation: 1.0 }]);
        let told = Choices::read([("material", "openpbr:a=1,b=1")]).expect_err("two faults").remove(0).detail;
        assert_eq!(told.matches("openpbr has no").count(), 2, "{told}");
    }

    #[test]
    fn every_fault_is_told() {
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
        let told: Vec<String> = faults.iter().map(|fault| format!("{}: {}", fault.parameter, fault.detail)).collect();
        let expected = [
            &format!("colour: is no parameter of a preview, which are table, {}", names().join(", ")),
            "spp: «99999999999» is not a whole number from 1 to 4096",
            "f0: «1,2» is not 3 numbers with commas between them",
            "exposure: is given more than once",
            "light: «cube» is none of rectangle, disk, sphere, tube, line, triangle, pentagon, hexagon, heptagon, octagon",
            "size: 63 is not within 64 to 2048",
            "rotation: 7 is not within -6.283185307179586 to 6.283185307179586",
            "phi: NaN is not within -6.283185307179586 to 6.283185307179586",
        ];
        assert_eq!(told, expected);
    }
}
