//! A scene as its callers choose it: by a name and what is to differ. The command line fills [`Choices`] from flags,
//! HTTP from texts; both mean the same by the same names.

use super::{
    LightKind, Material, Mode, NamedScene, Scene,
    bounds::{SIZE, SPP},
};
use crate::view::parameters::{ParameterFault, read_pairs};

/// What a caller chooses. What is left out is as in the named scene.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
#[expect(missing_docs, reason = "each is the field of the scene that has its name")]
pub struct Choices {
    pub scene: Option<NamedScene>,
    pub mode: Option<Mode>,
    pub size: Option<u32>,
    pub spp: Option<u32>,
    pub alpha_x: Option<f64>,
    pub alpha_y: Option<f64>,
    pub rotation: Option<f64>,
    pub f0: Option<[f64; 3]>,
    pub light: Option<LightKind>,
    pub light_centre: Option<[f64; 3]>,
    pub light_half_size: Option<[f64; 2]>,
    pub light_rotation: Option<[f64; 3]>,
    pub light_intensity: Option<f64>,
    pub light_two_sided: Option<bool>,
    pub camera_distance: Option<f64>,
    pub camera_azimuth: Option<f64>,
    pub camera_elevation: Option<f64>,
    pub camera_target: Option<[f64; 3]>,
    pub field_of_view: Option<f64>,
    pub theta: Option<f64>,
    pub phi: Option<f64>,
    pub exposure: Option<f64>,
    pub difference_scale: Option<f64>,
}

/// The parameters' names.
const NAMES: [&str; 23] = [
    "scene",
    "mode",
    "size",
    "spp",
    "alpha_x",
    "alpha_y",
    "rotation",
    "f0",
    "light",
    "light_centre",
    "light_half_size",
    "light_rotation",
    "light_intensity",
    "light_two_sided",
    "camera_distance",
    "camera_azimuth",
    "camera_elevation",
    "camera_target",
    "field_of_view",
    "theta",
    "phi",
    "exposure",
    "difference_scale",
];

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
            let detail = format!("{} is not within {} to {}", fault.value, fault.low, fault.high);
            let fault = ParameterFault::new(&fault.field, detail);
            // Of a parameter that every material shares, one word is enough.
            if !faults.contains(&fault) {
                faults.push(fault);
            }
        }
        if faults.is_empty() { Ok(scene) } else { Err(faults) }
    }

    /// Sets the parameter `name` to what `text` says.
    fn set(&mut self, name: &str, text: &str) -> Result<(), String> {
        match name {
            "scene" => self.scene = Some(named(text, NamedScene::ALL.map(|scene| (scene.name(), scene)))?),
            "mode" => self.mode = Some(named(text, Mode::ALL.map(|mode| (mode.name(), mode)))?),
            "size" => self.size = Some(pixels(text)?),
            "spp" => self.spp = Some(samples(text)?),
            "alpha_x" => self.alpha_x = Some(number(text)?),
            "alpha_y" => self.alpha_y = Some(number(text)?),
            "rotation" => self.rotation = Some(number(text)?),
            "f0" => self.f0 = Some(numbers(text)?),
            "light" => self.light = Some(named(text, LightKind::NAMED)?),
            "light_centre" => self.light_centre = Some(numbers(text)?),
            "light_half_size" => self.light_half_size = Some(numbers(text)?),
            "light_rotation" => self.light_rotation = Some(numbers(text)?),
            "light_intensity" => self.light_intensity = Some(number(text)?),
            "light_two_sided" => self.light_two_sided = Some(one(text, "true or false")?),
            "camera_distance" => self.camera_distance = Some(number(text)?),
            "camera_azimuth" => self.camera_azimuth = Some(number(text)?),
            "camera_elevation" => self.camera_elevation = Some(number(text)?),
            "camera_target" => self.camera_target = Some(numbers(text)?),
            "field_of_view" => self.field_of_view = Some(number(text)?),
            "theta" => self.theta = Some(number(text)?),
            "phi" => self.phi = Some(number(text)?),
            "exposure" => self.exposure = Some(number(text)?),
            "difference_scale" => self.difference_scale = Some(number(text)?),
            _ => return Err(format!("is no parameter of a preview, which are table, {}", NAMES.join(", "))),
        }
        Ok(())
    }

    /// The named scene with what differs. Its bounds are not checked.
    #[must_use]
    pub fn into_scene(self) -> Scene {
        fn set<T>(place: &mut T, value: Option<T>) {
            if let Some(value) = value {
                *place = value;
            }
        }
        let mut scene = self.scene.unwrap_or(NamedScene::Sphere).scene();
        set(&mut scene.mode, self.mode);
        set(&mut scene.size, self.size);
        set(&mut scene.spp, self.spp);
        if self.alpha_x.is_some() || self.alpha_y.is_some() {
            let mut material = scene.materials.first().copied().unwrap_or_else(Material::default);
            set(&mut material.alpha_x, self.alpha_x);
            set(&mut material.alpha_y, self.alpha_y);
            scene.materials = vec![material];
        }
        for material in &mut scene.materials {
            set(&mut material.rotation, self.rotation);
        }
        set(&mut scene.f0, self.f0);
        set(&mut scene.light.kind, self.light);
        set(&mut scene.light.centre, self.light_centre);
        set(&mut scene.light.half_size, self.light_half_size);
        set(&mut scene.light.rotation, self.light_rotation);
        set(&mut scene.light.intensity, self.light_intensity);
        set(&mut scene.light.two_sided, self.light_two_sided);
        set(&mut scene.camera.distance, self.camera_distance);
        set(&mut scene.camera.azimuth, self.camera_azimuth);
        set(&mut scene.camera.elevation, self.camera_elevation);
        set(&mut scene.camera.target, self.camera_target);
        set(&mut scene.camera.field_of_view, self.field_of_view);
        set(&mut scene.lobe.theta, self.theta);
        set(&mut scene.lobe.phi, self.phi);
        set(&mut scene.exposure, self.exposure);
        set(&mut scene.difference_scale, self.difference_scale);
        scene
    }
}

/// Numbers between commas.
///
/// # Errors
/// Another count of them, or what is no number.
pub fn numbers<const N: usize>(text: &str) -> Result<[f64; N], String> {
    let numbers: Result<Vec<f64>, _> = text.split(',').map(|number| number.trim().parse()).collect();
    let numbers = numbers.ok().and_then(|numbers| numbers.try_into().ok());
    numbers.ok_or_else(|| format!("«{text}» is not {N} numbers with commas between them"))
}

/// Pixels a side.
///
/// # Errors
/// When `text` is no number of them. Bounds are checked with the scene.
pub fn pixels(text: &str) -> Result<u32, String> {
    one(text, &format!("a whole number from {} to {}", SIZE.start(), SIZE.end()))
}

/// Samples a pixel.
///
/// # Errors
/// As [`pixels`].
pub fn samples(text: &str) -> Result<u32, String> {
    one(text, &format!("a whole number from {} to {}", SPP.start(), SPP.end()))
}

fn number(text: &str) -> Result<f64, String> {
    one(text, "a number")
}

fn one<T: std::str::FromStr>(text: &str, what: &str) -> Result<T, String> {
    text.parse().map_err(|_| format!("«{text}» is not {what}"))
}

fn named<T: Copy, const N: usize>(text: &str, known: [(&str, T); N]) -> Result<T, String> {
    let found = known.iter().find(|(name, _)| *name == text);
    found
        .map(|(_, value)| *value)
        .ok_or_else(|| format!("«{text}» is none of {}", known.map(|(name, _)| name).join(", ")))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_and_fields_give_the_same_scene() {
        let pairs = [("scene", "figure14"), ("mode", "strip"), ("light", "hexagon"), ("light_centre", "-1, 2,3e0")];
        let chosen = Choices {
            scene: Some(NamedScene::Figure14),
            mode: Some(Mode::Strip),
            light: Some(LightKind::Polygon(6)),
            light_centre: Some([-1.0, 2.0, 3.0]),
            ..Choices::default()
        };
        assert_eq!(Choices::read(pairs), Ok(chosen.into_scene()));
        assert_eq!(Choices::read([]), Ok(Scene::default()));
    }

    #[test]
    fn every_name_is_taken() {
        for name in NAMES {
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
            &format!("colour: is no parameter of a preview, which are table, {}", NAMES.join(", ")),
            "spp: «99999999999» is not a whole number from 1 to 4096",
            "f0: «1,2» is not 3 numbers with commas between them",
            "exposure: is given more than once",
            "light: «cube» is none of rectangle, disk, triangle, pentagon, hexagon, heptagon, octagon",
            "rotation: 7 is not within -6.283185307179586 to 6.283185307179586",
            "phi: NaN is not within -6.283185307179586 to 6.283185307179586",
            "size: 63 is not within 64 to 2048",
        ];
        assert_eq!(told, expected);
    }
}
