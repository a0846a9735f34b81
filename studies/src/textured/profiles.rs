//! Photometric lights: a rectangle whose radiance depends on the direction alone, as that of a lamp with an IES profile.
//!
//! A point p of the light's plane sends to the shaded point in the direction `(f - p, h)`, for the foot f of the
//! perpendicular and the distance h. Over `g = (f - p) / h`, the tangents of a direction, a profile is a picture of which the
//! light sees a window: it is prefiltered once for all, and a lobe's readings of the light are readings of it.

use std::fmt::Write as _;

use glam::DVec3;
use ltcforge::{
    fit::{
        Configuration, Sides,
        math::{atan2, direction},
    },
    light::{
        NormalsRule,
        textured::{
            LightImage, LightPyramid, Reading, Readings, TexturedLight, TexturedReflection, colour, normals_readings,
        },
    },
};
use rayon::prelude::*;

use super::cases::{FORMS, SETS, Set, TOLERANCE, drawn};
use crate::{
    lights::Spread,
    markdown::{short, spread},
};

/// The tangent up to which a profile has texels, and how many along a side.
const TANGENT: f64 = 4.0;
const SIDE: usize = 512;
/// The variance of a square's points along a side, over its area: no kernel is wider than the light.
const OF_AREA: f64 = 1.0 / 12.0;

/// The radiance of a direction, up to one.
type Profile = fn(DVec3) -> f64;

const PROFILES: [(&str, Profile); 3] = [
    ("spot, cos^16", |d| d.z.powi(16)),
    ("batwing, 40 degrees", |d| (-0.5 * ((atan2(d.truncate().length(), d.z) - 0.7) / 0.2).powi(2)).exp()),
    ("asymmetric, tilted by 35 degrees", |d| d.dot(direction(0.61, 0.0)).max(0.0).powi(12)),
];

/// Where a light's readings are in its profiles.
struct Window {
    foot: [f64; 2],
    size: [f64; 2],
    height: f64,
}

impl Window {
    fn new(light: &TexturedLight) -> Self {
        let corners = light.polygon().vertices();
        let size = light.size();
        let axes = [(corners[1] - corners[0]) / size[0], (corners[3] - corners[0]) / size[1]];
        let foot = axes.map(|axis| -corners[0].dot(axis));
        Self { foot, size, height: axes[0].cross(axes[1]).dot(corners[0]).abs().max(1e-6) }
    }

    /// The tangents of the direction from a place of the light to the shaded point.
    fn tangents(&self, uv: [f64; 2]) -> [f64; 2] {
        [0, 1].map(|i| (self.foot[i] - uv[i] * self.size[i]) / self.height)
    }

    fn direction(&self, uv: [f64; 2]) -> DVec3 {
        let [x, y] = self.tangents(uv);
        DVec3::new(x, y, 1.0).normalize()
    }

    /// A reading of a picture on the light as one of the picture of a profile.
    fn of_profile(&self, reading: &Reading<f64>) -> Reading<f64> {
        let uv = self.tangents(reading.uv).map(|g| (0.5 + 0.5 * g / TANGENT).clamp(0.0, 1.0));
        let narrower = 1.0 / (1.0 / reading.radius.powi(2) + 1.0 / OF_AREA);
        let area = self.size[0] * self.size[1];
        Reading { uv, radius: (narrower * area).sqrt() / (self.height * 2.0 * TANGENT), weight: reading.weight }
    }
}

/// The pyramid of the profiles, a channel each.
fn pyramid() -> LightPyramid {
    let texel = |i: usize| {
        let [x, y] = [i % SIDE, i / SIDE].map(|i| ((i as f64 + 0.5) / SIDE as f64 - 0.5) * 2.0 * TANGENT);
        let d = DVec3::new(x, y, 1.0).normalize();
        PROFILES.map(|(_, profile)| profile(d) as f32)
    };
    LightPyramid::new(&LightImage::new(SIDE, SIDE, (0..SIDE * SIDE).map(texel).collect()).expect("an image"))
}

const WAYS: [&str; 4] = ["at the light's middle", "one reading", "four readings", "four, without a blur"];

/// What each way finds of each profile.
fn found(at: &Configuration, light: &TexturedLight, pyramid: &LightPyramid) -> [[f64; 3]; 4] {
    let corners = [0, 1, 2, 3].map(|i| light.polygon().vertices()[i].to_array());
    let wo = direction(at.theta, at.phi).to_array();
    let readings =
        |number| normals_readings([at.alpha_x, at.alpha_y], wo, &corners, Sides::Two, (NormalsRule::Balanced, number));
    let window = Window::new(light);
    let at_point = |uv: [f64; 2]| PROFILES.map(|(_, profile)| profile(window.direction(uv)));
    let ([energy, _], one) = readings(Readings::One);
    let (_, four) = readings(Readings::Four);
    let blurred = |readings: &[Reading<f64>]| {
        colour(&readings.iter().map(|reading| window.of_profile(reading)).collect::<Vec<_>>(), pyramid)
    };
    let weights: f64 = four.iter().map(|reading| reading.weight).sum();
    let sharp = four.iter().fold([0.0; 3], |sum, reading| {
        let values = at_point(reading.uv);
        [0, 1, 2].map(|i| sum[i] + values[i] * reading.weight / weights)
    });
    [at_point([0.5, 0.5]), blurred(&one), blurred(&four), sharp].map(|values| values.map(|value| value * energy))
}

/// What is truly reflected of a light with each profile, and the error of each way.
type Measured = ([f64; 3], [[f64; 3]; 4]);

fn measured(set: Set, lights: usize, pyramid: &LightPyramid) -> Vec<Measured> {
    let of_light = |(at, light, form): &(Configuration, TexturedLight, usize)| {
        let size = FORMS[*form].map(|texels| texels / 4);
        let texels = light.texel_lights(at, size, TOLERANCE).ok()?;
        let window = Window::new(light);
        let value = |i: usize| {
            let d = window
                .direction([0, 1].map(|axis| ([i % size[0], i / size[0]][axis] as f64 + 0.5) / size[axis] as f64));
            PROFILES.map(|(_, profile)| profile(d) as f32)
        };
        let values: Vec<[f32; 3]> = (0..texels.len()).map(value).collect();
        let truth = TexturedReflection::of_texels(texels.iter().zip(&values)).energy;
        Some((truth, found(at, light, pyramid).map(|found| [0, 1, 2].map(|i| (found[i] - truth[i]).abs()))))
    };
    let known: Vec<_> = drawn(set, lights).par_iter().map(of_light).collect();
    known.into_iter().flatten().take(lights).collect()
}

/// The table of docs/textured.md, `lights` a set.
///
/// # Panics
/// Never: what is drawn is a light.
#[must_use]
pub fn profiles(lights: usize) -> String {
    let pyramid = pyramid();
    let sets = SETS.map(|set| (set, measured(set, lights, &pyramid)));
    let mut out = format!("docs/textured.md, {lights} lights a set, mean / 95th percentile / largest error:\n\n| | |");
    // Writing to a String cannot fail.
    for (set, _) in &sets {
        let _ = write!(out, " {} |", set.name());
    }
    let _ = writeln!(out, "\n|---|{}", "---|".repeat(SETS.len() + 1));
    for (i, (profile, _)) in PROFILES.iter().enumerate() {
        let _ = write!(out, "| {profile} | mean of the truth |");
        for (_, lights) in &sets {
            let mean = lights.iter().map(|(truth, _)| truth[i]).sum::<f64>() / lights.len() as f64;
            let _ = write!(out, " {} |", short(mean, 2));
        }
        out += "\n";
        for (j, way) in WAYS.iter().enumerate() {
            let _ = write!(out, "| | {way} |");
            for (_, lights) in &sets {
                let errors = lights.iter().map(|(_, errors)| errors[j][i]).collect();
                let _ = write!(out, " {} |", spread(Spread::of(errors)));
            }
            out += "\n";
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use ltcforge::light::PolygonLight;

    #[test]
    fn directions_come_from_the_place_on_the_light() {
        let vertices = [[-1.0, 1.0], [1.0, 1.0], [1.0, -1.0], [-1.0, -1.0]].map(|[x, y]| DVec3::new(x, y, 2.0));
        let light = PolygonLight::new(vertices.to_vec(), Sides::Two).and_then(TexturedLight::new).expect("a rectangle");
        let window = Window::new(&light);
        for (uv, wanted) in [([0.5, 0.5], [0.0, 0.0]), ([0.0, 0.5], [0.5, 0.0]), ([0.5, 1.0], [0.0, -0.5])] {
            assert_eq!(window.tangents(uv), wanted);
        }
        // A kernel far wider than the light is as wide as the light, a narrow one keeps its width.
        let read = |radius| window.of_profile(&Reading { uv: [0.25, 0.5], radius, weight: 2.0 });
        let of_one = 2.0 / (2.0 * 2.0 * TANGENT);
        assert!((read(1e3).radius / (OF_AREA.sqrt() * of_one) - 1.0).abs() < 1e-3);
        assert!((read(1e-3).radius / (1e-3 * of_one) - 1.0).abs() < 1e-3);
        assert_eq!((read(1.0).uv, read(1.0).weight), ([0.5 + 0.125 / TANGENT, 0.5], 2.0));
    }

    /// docs/textured.md: a fourth of the error of the light's middle, on rough surfaces half of that without a blur.
    #[test]
    fn four_readings_follow_a_profile() {
        let pyramid = pyramid();
        let means = [Set::Random, Set::Rough].map(|set| {
            let found = measured(set, 100, &pyramid);
            [0, 1, 2].map(|i| {
                [0, 1, 2, 3].map(|way| {
                    found.iter().map(|(_, errors): &Measured| errors[way][i]).sum::<f64>() / found.len() as f64
                })
            })
        });
        println!("{means:.4?}");
        for [[middle, one, four, _], [_, _, rough, sharp]] in [0, 1, 2].map(|i| means.map(|set| set[i])) {
            assert!(four < 0.3 * middle && four < 0.8 * one && four < 0.008, "{middle} {one} {four}");
            assert!(rough < 0.75 * sharp && rough < 0.006, "{rough} {sharp}");
        }
    }
}
