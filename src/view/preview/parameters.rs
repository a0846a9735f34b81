//! All parameters of a preview. A new parameter is declared here, next to its field of the scene. The query, the
//! command line, the bounds, and the checks of docs and openapi.yaml follow from this list.

use std::{f64::consts::TAU, slice};

use super::{
    LightKind, Material, Mode, NamedScene, Scene, ScenePicture,
    parameter::{Parameter, ParameterForm},
};
use ltcforge_light::{LightModel, normals::NormalsRule, textured::Readings};

/// Largest coordinate and half size of a light, and largest camera distance, in radii of the sphere.
const PLACE: f64 = 100.0;
/// The least distance of the camera from its target. The camera stays outside the sphere.
const NEAREST: f64 = 1.5;
/// The largest distance of the camera's target from the origin. It is too small to bring the camera into the sphere.
const FARTHEST_TARGET: f64 = 0.45;
/// Bounds of an angle about an axis.
const TURN: [f64; 2] = [-TAU, TAU];
const QUARTER: f64 = TAU / 4.0;

/// A parameter with a name from a list.
macro_rules! listed {
    ($name:literal, $help:literal, $kind:ident::$list:ident, $field:ident) => {
        name(
            $name,
            $help,
            || $kind::$list.iter().map(|known| known.name()).collect(),
            |s| $kind::$list.iter().position(|known| *known == s.$field),
            |s, i| s.$field = $kind::$list[i],
        )
    };
}

/// A parameter with one number.
macro_rules! number {
    ($name:literal, $help:literal, $unit:expr, $bounds:expr, $($field:ident).+) => {
        numbers($name, $help, "X", $unit, $bounds, |s| slice::from_mut(&mut s.$($field).+))
    };
}

/// Every parameter. They are applied in this order: first the named scene, then the parameters that change it.
pub static PARAMETERS: [Parameter; 30] = [
    name(
        "scene",
        "Scene",
        || NamedScene::ALL.iter().map(|named| named.name()).collect(),
        |_| Some(0),
        |s, i| *s = NamedScene::ALL[i].scene(),
    ),
    listed!("mode", "View of the scene", Mode::ALL, mode),
    listed!("model", "Model of light", LightModel::ALL, model),
    listed!("rule", "Rule of model normals: speed against accuracy", NormalsRule::SHADED, rule),
    flag("cut", "Cut light and lobe of an LTC at the surface", |s| &mut s.cut),
    flag("compensate", "Compensate multiple scattering of metals", |s| &mut s.compensate),
    whole("size", "Pixels per side of a panel", [64, 2048], |s| &mut s.size),
    whole("spp", "Samples per pixel of the reference", [1, 4096], |s| &mut s.spp),
    Parameter {
        name: "material",
        help: "One material instead of the scene's",
        value_name: "MODEL:NAME=X,...",
        unit: None,
        form: ParameterForm::OneMaterial,
    },
    alpha("alpha_x", "Show one material: GGX roughness along the tangent", |m| &mut m.alpha_x),
    alpha("alpha_y", "Show one material: GGX roughness across the tangent", |m| &mut m.alpha_y),
    Parameter {
        name: "rotation",
        help: "Rotation of the tangents",
        value_name: "ANGLE",
        unit: RAD,
        form: ParameterForm::OfMaterials(TURN, |m| &mut m.rotation),
    },
    numbers("f0", "Reflectance at normal incidence, linear sRGB", "R,G,B", None, [0.0, 1.0], |s| &mut s.f0),
    name(
        "light",
        "Shape of the light",
        || LightKind::NAMED.map(|(name, _)| name).into(),
        |s| LightKind::NAMED.iter().position(|(_, kind)| *kind == s.light.kind),
        |s, i| s.light.kind = LightKind::NAMED[i].1,
    ),
    numbers("light_centre", "Centre of the light", "X,Y,Z", RADII, [-PLACE, PLACE], |s| &mut s.light.centre),
    numbers("light_half_size", "Half width, height (tube: length, radius)", "X,Y", RADII, [1e-3, PLACE], |s| {
        &mut s.light.half_size
    }),
    numbers("light_rotation", "Rotation; at zero the light faces the origin", "YAW,PITCH,ROLL", RAD, TURN, |s| {
        &mut s.light.rotation
    }),
    number!("light_intensity", "Radiance of the light", None, [0.0, 1e4], light.intensity),
    flag("light_two_sided", "Let both sides of a flat light emit", |s| &mut s.light.two_sided),
    name(
        "light_picture",
        "Picture on a rectangle light",
        || ScenePicture::NAMED.map(|(name, _)| name).into(),
        |s| ScenePicture::NAMED.iter().position(|(_, picture)| *picture == s.picture),
        |s, i| s.picture = ScenePicture::NAMED[i].1.clone(),
    ),
    listed!("light_readings", "Texture reads per shaded point", Readings::ALL, readings),
    number!("camera_distance", "Distance from the camera to its target", RADII, [NEAREST, PLACE], camera.distance),
    number!("camera_azimuth", "Azimuth of the camera", RAD, TURN, camera.azimuth),
    number!(
        "camera_elevation",
        "Elevation of the camera (above 0 to see a floor)",
        RAD,
        [-QUARTER, QUARTER],
        camera.elevation
    ),
    Parameter {
        name: "camera_target",
        help: "Target of the camera",
        value_name: "X,Y,Z",
        unit: RADII,
        form: ParameterForm::Point(FARTHEST_TARGET, |s| &mut s.camera.target),
    },
    number!("field_of_view", "Field of view, edge to edge", RAD, [0.01, 2.5], camera.field_of_view),
    number!("theta", "Polar angle of the view in mode lobe", RAD, [0.0, QUARTER], lobe.theta),
    number!("phi", "Azimuth of the view in mode lobe", RAD, TURN, lobe.phi),
    number!("exposure", "Factor on the displayed radiance", None, [1e-4, 1e4], exposure),
    number!(
        "difference_scale",
        "Difference at the ends of the colours; 0 fits the picture",
        None,
        [0.0, 1e4],
        difference_scale
    ),
];

const RAD: Option<&str> = Some("rad");
/// The unit of lengths: radii of the sphere.
const RADII: Option<&str> = Some("radii");

const fn name(
    name: &'static str,
    help: &'static str,
    names: fn() -> Vec<&'static str>,
    get: fn(&Scene) -> Option<usize>,
    set: fn(&mut Scene, usize),
) -> Parameter {
    Parameter { name, help, value_name: "NAME", unit: None, form: ParameterForm::Name { names, get, set } }
}

const fn flag(name: &'static str, help: &'static str, field: fn(&mut Scene) -> &mut bool) -> Parameter {
    Parameter { name, help, value_name: "BOOL", unit: None, form: ParameterForm::Flag(field) }
}

const fn whole(
    name: &'static str,
    help: &'static str,
    bounds: [u32; 2],
    field: fn(&mut Scene) -> &mut u32,
) -> Parameter {
    Parameter { name, help, value_name: "N", unit: None, form: ParameterForm::Whole(bounds, field) }
}

const fn alpha(name: &'static str, help: &'static str, field: fn(&mut Material) -> &mut f64) -> Parameter {
    Parameter { name, help, value_name: "X", unit: None, form: ParameterForm::OfOneMaterial([0.0, 1.0], field) }
}

const fn numbers(
    name: &'static str,
    help: &'static str,
    value_name: &'static str,
    unit: Option<&'static str>,
    bounds: [f64; 2],
    field: fn(&mut Scene) -> &mut [f64],
) -> Parameter {
    Parameter { name, help, value_name, unit, form: ParameterForm::Numbers(bounds, field) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::preview::Choices;

    #[test]
    fn every_default_is_within_bounds_and_reads_as_itself() {
        for parameter in &PARAMETERS {
            let default = parameter.text(&Scene::default());
            assert_eq!(Choices::read([(parameter.name, default.as_str())]), Ok(Scene::default()), "{}", parameter.name);
        }
    }

    /// Values on the bounds are accepted, and values beyond are rejected, for each number of each parameter.
    #[test]
    fn every_bound_is_checked_on_both_sides() {
        let mut tried = 0;
        for parameter in &PARAMETERS {
            let (bounds, numbers) = parameter.bounded(&mut Scene::default());
            let is_point = matches!(parameter.form, ParameterForm::Point(..));
            let step = if matches!(parameter.form, ParameterForm::Whole(..)) { 1.0 } else { 1e-9 };
            let default = parameter.text(&Scene::default());
            let with = |place: usize, number: f64| {
                let mut words: Vec<String> = default.split(',').map(str::to_owned).collect();
                words[place] = number.to_string();
                Choices::read([(parameter.name, words.join(",").as_str())])
            };
            for place in 0..if numbers.is_empty() { 0 } else { parameter.count() } {
                for (bound, outwards) in bounds.into_iter().zip([-step, step]) {
                    // A point only has an upper bound, on its distance from the origin.
                    if is_point && outwards < 0.0 {
                        continue;
                    }
                    tried += 1;
                    assert!(with(place, bound).is_ok(), "{} {bound}", parameter.name);
                    let beyond = with(place, bound + outwards).expect_err(parameter.name);
                    assert_eq!(beyond.len(), 1);
                    assert_eq!(beyond[0].parameter, parameter.name);
                }
            }
        }
        assert_eq!(tried, 53);
    }

    #[test]
    fn lines_show_bounds_units_and_defaults() {
        let line = |name: &str| PARAMETERS.iter().find(|p| p.name == name).map(Parameter::line).expect(name);
        assert_eq!(line("size"), "Pixels per side of a panel, 64 to 2048 [default of scene sphere: 512]");
        assert_eq!(line("theta"), "Polar angle of the view in mode lobe, 0 to pi/2 rad [default: 1]");
        assert_eq!(line("mode"), "View of the scene [default of scene sphere: ltc]");
        assert!(line("rotation").ends_with(", -2 pi to 2 pi rad [default of scene sphere: 0]"), "{}", line("rotation"));
        assert!(line("f0").ends_with(", each 0 to 1 [default: 0.91,0.92,0.92]"), "{}", line("f0"));
        assert!(
            line("camera_target").ends_with(", at most 0.45 radii from the origin [default of scene sphere: 0,0,0]")
        );
    }
}
