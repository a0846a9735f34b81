//! The bounds of a scene's parameters.

use std::{f64::consts::TAU, ops::RangeInclusive};

use glam::DVec3;

use super::{LightKind, Scene};
use crate::fit::MAX_VERTICES;

/// Materials that a picture can hold.
pub(super) const MAX_MATERIALS: usize = 4;
/// Pixels a side.
pub(super) const SIZE: RangeInclusive<u32> = 64..=2048;
/// Samples a pixel.
pub(super) const SPP: RangeInclusive<u32> = 1..=4096;
/// Where things may stand, in radii of the sphere.
const PLACE: f64 = 100.0;
/// The nearest that the camera comes to what it looks at: outside of the sphere.
const NEAREST: f64 = 1.5;
/// How far from the origin it may look: too little to bring the camera into the sphere.
const FARTHEST_TARGET: f64 = 0.45;

/// A parameter that is out of its bounds.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("{field} is {value}, not within {low} to {high}")]
pub struct SceneFault {
    /// The parameter, such as `light_intensity`.
    pub field: String,
    /// What it is.
    pub value: f64,
    /// The least it may be.
    pub low: f64,
    /// The most it may be.
    pub high: f64,
}

impl Scene {
    /// Every parameter that is out of its bounds, in their order.
    #[must_use]
    pub fn faults(&self) -> Vec<SceneFault> {
        let mut check = Check::default();
        check.within("materials", self.materials.len() as f64, 1.0, MAX_MATERIALS as f64);
        for material in &self.materials {
            check.within("alpha_x", material.alpha_x, 0.0, 1.0);
            check.within("alpha_y", material.alpha_y, 0.0, 1.0);
            check.within("rotation", material.rotation, -TAU, TAU);
        }
        check.each("f0", &self.f0, 0.0, 1.0);
        let light = &self.light;
        if let LightKind::Polygon(sides) = light.kind {
            check.within("light", f64::from(sides), 3.0, MAX_VERTICES as f64);
        }
        check.each("light_centre", &light.centre, -PLACE, PLACE);
        check.each("light_half_size", &light.half_size, 1e-3, PLACE);
        check.each("light_rotation", &light.rotation, -TAU, TAU);
        check.within("light_intensity", light.intensity, 0.0, 1e4);
        let camera = &self.camera;
        check.within("camera_distance", camera.distance, NEAREST, PLACE);
        check.within("camera_azimuth", camera.azimuth, -TAU, TAU);
        check.within("camera_elevation", camera.elevation, -TAU / 4.0, TAU / 4.0);
        check.within("camera_target", DVec3::from(camera.target).length(), 0.0, FARTHEST_TARGET);
        check.within("field_of_view", camera.field_of_view, 0.01, 2.5);
        check.within("theta", self.lobe.theta, 0.0, TAU / 4.0);
        check.within("phi", self.lobe.phi, -TAU, TAU);
        check.within("size", f64::from(self.size), f64::from(*SIZE.start()), f64::from(*SIZE.end()));
        check.within("spp", f64::from(self.spp), f64::from(*SPP.start()), f64::from(*SPP.end()));
        check.within("exposure", self.exposure, 1e-4, 1e4);
        check.within("difference_scale", self.difference_scale, 1e-6, 1e4);
        check.faults
    }
}

#[derive(Default)]
struct Check {
    faults: Vec<SceneFault>,
}

impl Check {
    /// Not-a-number is within no bounds.
    fn within(&mut self, field: &str, value: f64, low: f64, high: f64) {
        if !(low..=high).contains(&value) {
            self.faults.push(SceneFault { field: field.to_owned(), value, low, high });
        }
    }

    fn each(&mut self, field: &str, values: &[f64], low: f64, high: f64) {
        for value in values {
            self.within(field, *value, low, high);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::view::preview::{Choices, Material, NamedScene};

    #[test]
    fn defaults_and_named_scenes_are_within_bounds() {
        assert_eq!(Scene::default().faults(), []);
        for named in NamedScene::ALL {
            assert_eq!(named.scene().faults(), [], "{}", named.name());
        }
    }

    /// A number as `docs/preview.md` writes it.
    fn number(text: &str) -> f64 {
        let angle = [("-2 pi", -TAU), ("2 pi", TAU), ("-pi/2", -TAU / 4.0), ("pi/2", TAU / 4.0), ("0", 0.0)];
        let found = angle.iter().find(|(name, _)| *name == text).map(|(_, angle)| *angle);
        found.unwrap_or_else(|| text.parse().unwrap_or_else(|_| panic!("{text} is no number")))
    }

    #[test]
    fn defaults_and_bounds_are_those_of_the_docs() {
        let is_taken = |name: &str, text: &str| Choices::read([(name, text)]).is_ok();
        let mut rows = 0;
        for row in include_str!("../../../docs/preview.md").lines() {
            let cells: Vec<&str> = row.split('|').map(str::trim).collect();
            let ["", names, defaults, low, high, _, ""] = cells[..] else { continue };
            let Some(names) = names.strip_prefix('`').and_then(|names| names.strip_suffix('`')) else { continue };
            rows += 1;
            for (name, default) in names.split("`, `").zip(defaults.split(", ")) {
                assert_eq!(Choices::read([(name, default)]), Ok(Scene::default()), "{name}");
                if low.is_empty() {
                    continue;
                }
                let step = if ["size", "spp"].contains(&name) { 1.0 } else { 1e-7 };
                let rest = default.split_once(',').map_or(String::new(), |(_, rest)| format!(",{rest}"));
                for (bound, outwards) in [(number(low), -step), (number(high), step)] {
                    assert!(is_taken(name, &format!("{bound}{rest}")), "{name} {bound}");
                    let beyond = bound + outwards;
                    assert!(!is_taken(name, &format!("{beyond}{rest}")), "{name} {beyond}");
                }
            }
        }
        assert_eq!(rows, 20);
    }

    #[test]
    fn every_fault_is_named() {
        let mut scene = Scene { size: 63, spp: 0, ..Scene::default() };
        scene.materials.push(Material { alpha_x: f64::NAN, ..Material::default() });
        scene.light.kind = LightKind::Polygon(9);
        let faults = scene.faults();
        let fields: Vec<&str> = faults.iter().map(|fault| fault.field.as_str()).collect();
        assert_eq!(fields, ["alpha_x", "light", "size", "spp"]);
        assert_eq!(faults[2].to_string(), "size is 63, not within 64 to 2048");
    }
}
