//! A parameter of a preview: its form, its bounds, and its field in a scene.

use std::f64::consts::FRAC_PI_2;

use glam::DVec3;

use super::{Material, NamedScene, Scene};
use ltcforge_light::AnisotropicRoughness;

/// A parameter. Its default is its value in [`Scene::default`].
#[derive(Debug, Clone, Copy)]
pub struct Parameter {
    /// The parameter's name in a query. The command line writes dashes for the underscores.
    pub name: &'static str,
    /// The meaning, without bounds and default.
    pub help: &'static str,
    /// The placeholder for the value in the command line's help, such as `X,Y,Z`.
    pub value_name: &'static str,
    /// The unit, if there is one.
    pub unit: Option<&'static str>,
    /// The form of the value, and its field in a scene.
    pub form: ParameterForm,
}

/// The form of a parameter, and its field in a scene.
#[derive(Debug, Clone, Copy)]
pub enum ParameterForm {
    /// A name from a list.
    Name {
        /// The names.
        names: fn() -> Vec<&'static str>,
        /// The index of the scene's current name. `None` for a light without a name.
        get: fn(&Scene) -> Option<usize>,
        /// Gives the scene the name with this index.
        set: fn(&mut Scene, usize),
    },
    /// A whole number between two bounds.
    Whole([u32; 2], fn(&mut Scene) -> &mut u32),
    /// Comma-separated numbers, each between two bounds.
    Numbers([f64; 2], fn(&mut Scene) -> &mut [f64]),
    /// A point. Its distance from the origin has an upper bound.
    Point(f64, fn(&mut Scene) -> &mut [f64; 3]),
    /// A number of each material, between two bounds.
    OfMaterials([f64; 2], fn(&mut Material) -> &mut f64),
    /// The same number, but setting it removes all materials except the first.
    OfOneMaterial([f64; 2], fn(&mut Material) -> &mut f64),
    /// A material, described by its parameters. It replaces the scene's materials.
    OneMaterial,
    /// True or false.
    Flag(fn(&mut Scene) -> &mut bool),
}

/// The value of a parameter.
#[derive(Debug, Clone, PartialEq)]
pub enum Value {
    /// The index of a name.
    Name(usize),
    /// A whole number.
    Whole(u32),
    /// One or more numbers.
    Numbers(Vec<f64>),
    /// A material; `None` keeps the scene's materials.
    Material(Option<Material>),
    /// True or false.
    Flag(bool),
}

impl Parameter {
    /// Parses `text`.
    ///
    /// # Errors
    /// The expected form of the value. [`Scene::faults`] checks the bounds of numbers later.
    pub fn parse(&self, text: &str) -> Result<Value, String> {
        let expected = |what: &str| format!("«{text}» is not {what}");
        match self.form {
            ParameterForm::Name { names, .. } => {
                let known = names();
                let found = known.iter().position(|name| *name == text).map(Value::Name);
                found.ok_or_else(|| format!("«{text}» is not one of {}", known.join(", ")))
            }
            ParameterForm::Whole([low, high], _) => {
                let whole = text.parse().map(Value::Whole);
                whole.map_err(|_| expected(&format!("a whole number from {low} to {high}")))
            }
            ParameterForm::OneMaterial if text.is_empty() => Ok(Value::Material(None)),
            ParameterForm::OneMaterial => {
                let roughness = AnisotropicRoughness::parse(text).map_err(|faults| faults.to_string())?;
                Ok(Value::Material(Some(roughness.within_bounds().into())))
            }
            ParameterForm::Flag(_) => text.parse().map(Value::Flag).map_err(|_| expected("true or false")),
            ParameterForm::Numbers(..)
            | ParameterForm::Point(..)
            | ParameterForm::OfMaterials(..)
            | ParameterForm::OfOneMaterial(..) => {
                let numbers: Result<Vec<f64>, _> = text.split(',').map(|number| number.trim().parse()).collect();
                let count = self.count();
                let numbers = numbers.ok().filter(|numbers| numbers.len() == count).map(Value::Numbers);
                numbers.ok_or_else(|| match count {
                    1 => expected("a number, such as 0.5"),
                    _ => expected(&format!("{count} comma-separated numbers")),
                })
            }
        }
    }

    /// Sets the field of a scene. `value` must be a result of [`Parameter::parse`] of the same parameter.
    pub(super) fn set(&self, scene: &mut Scene, value: &Value) {
        match (self.form, value) {
            (ParameterForm::Name { set, .. }, Value::Name(index)) => set(scene, *index),
            (ParameterForm::Whole(_, field), Value::Whole(whole)) => *field(scene) = *whole,
            (ParameterForm::Flag(field), Value::Flag(flag)) => *field(scene) = *flag,
            (ParameterForm::Numbers(_, field), Value::Numbers(numbers)) => field(scene).copy_from_slice(numbers),
            (ParameterForm::Point(_, field), Value::Numbers(numbers)) => field(scene).copy_from_slice(numbers),
            (ParameterForm::OfMaterials(_, field), Value::Numbers(numbers)) => {
                scene.materials.iter_mut().for_each(|material| *field(material) = numbers[0]);
            }
            (ParameterForm::OfOneMaterial(_, field), Value::Numbers(numbers)) => {
                let mut material = scene.materials.first().copied().unwrap_or_default();
                *field(&mut material) = numbers[0];
                scene.materials = vec![material];
            }
            (ParameterForm::OneMaterial, Value::Material(material)) => {
                scene.materials = material.map_or_else(|| scene.materials.clone(), |material| vec![material]);
            }
            (_, value) => unreachable!("{} does not read {value:?}", self.name),
        }
    }

    /// The bounds, and the scene's numbers that must be within them. For a point, the number is its distance from the
    /// origin.
    pub(super) fn bounded(&self, scene: &mut Scene) -> ([f64; 2], Vec<f64>) {
        match self.form {
            ParameterForm::Name { .. } | ParameterForm::Flag(_) | ParameterForm::OneMaterial => ([0.0; 2], Vec::new()),
            ParameterForm::Whole(bounds, field) => (bounds.map(f64::from), vec![f64::from(*field(scene))]),
            ParameterForm::Numbers(bounds, field) => (bounds, field(scene).to_vec()),
            ParameterForm::Point(farthest, field) => ([0.0, farthest], vec![DVec3::from(*field(scene)).length()]),
            ParameterForm::OfMaterials(bounds, field) | ParameterForm::OfOneMaterial(bounds, field) => {
                (bounds, scene.materials.iter_mut().map(|material| *field(material)).collect())
            }
        }
    }

    /// The value of a scene as text that [`Parameter::parse`] can read. If there are several materials, it is the value
    /// of the first.
    #[must_use]
    pub fn text(&self, scene: &Scene) -> String {
        let mut scene = scene.clone();
        let listed = |numbers: &[f64]| numbers.iter().map(ToString::to_string).collect::<Vec<_>>().join(",");
        match self.form {
            ParameterForm::Name { names, get, .. } => {
                get(&scene).map_or_else(String::new, |index| names()[index].to_owned())
            }
            ParameterForm::Whole(_, field) => field(&mut scene).to_string(),
            ParameterForm::OneMaterial => String::new(),
            ParameterForm::Flag(field) => field(&mut scene).to_string(),
            ParameterForm::Numbers(_, field) => listed(field(&mut scene)),
            ParameterForm::Point(_, field) => listed(field(&mut scene)),
            ParameterForm::OfMaterials(_, field) | ParameterForm::OfOneMaterial(_, field) => {
                scene.materials.first_mut().map_or_else(String::new, |material| field(material).to_string())
            }
        }
    }

    /// How many numbers the value has.
    #[must_use]
    pub fn count(&self) -> usize {
        match self.form {
            ParameterForm::Numbers(_, field) => field(&mut Scene::default()).len(),
            ParameterForm::Point(..) => 3,
            _ => 1,
        }
    }

    /// The bounds as text. `None` if the value is not a number. The lower bound of a point is empty.
    #[must_use]
    pub fn bounds(&self) -> Option<[String; 2]> {
        match self.form {
            ParameterForm::Name { .. } | ParameterForm::Flag(_) | ParameterForm::OneMaterial => None,
            ParameterForm::Whole(bounds, _) => Some(bounds.map(|bound| bound.to_string())),
            ParameterForm::Numbers(bounds, _)
            | ParameterForm::OfMaterials(bounds, _)
            | ParameterForm::OfOneMaterial(bounds, _) => Some(bounds.map(|bound| self.bound(bound))),
            ParameterForm::Point(farthest, _) => Some([String::new(), self.bound(farthest)]),
        }
    }

    /// The line in the command line's help: meaning, bounds and default.
    #[must_use]
    pub fn line(&self) -> String {
        let unit = self.unit.map_or_else(String::new, |unit| format!(" {unit}"));
        let bounds = match (self.form, self.bounds()) {
            (_, None) => String::new(),
            (ParameterForm::Point(..), Some([_, high])) => format!(", at most {high}{unit} from the origin"),
            (_, Some([low, high])) if self.count() > 1 => format!(", each {low} to {high}{unit}"),
            (_, Some([low, high])) => format!(", {low} to {high}{unit}"),
        };
        let scene = if self.differs_between_scenes() { " of scene sphere" } else { "" };
        let default = match self.form {
            ParameterForm::OneMaterial => "the scene's".to_owned(),
            _ => self.text(&Scene::default()),
        };
        format!("{}{bounds} [default{scene}: {default}]", self.help)
    }

    /// Whether the value differs between named scenes.
    #[must_use]
    pub fn differs_between_scenes(&self) -> bool {
        let default = self.text(&Scene::default());
        NamedScene::ALL.iter().any(|named| self.text(&named.scene()) != default)
    }

    /// A bound as text. Multiples of a quarter turn are written with pi.
    fn bound(&self, bound: f64) -> String {
        let quarters = bound / FRAC_PI_2;
        match quarters as i32 {
            n if self.unit != Some("rad") || f64::from(n) != quarters => bound.to_string(),
            0 => "0".to_owned(),
            1 => "pi/2".to_owned(),
            -1 => "-pi/2".to_owned(),
            n => format!("{} pi", f64::from(n) / 2.0),
        }
    }
}
