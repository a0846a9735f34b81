//! The table of docs/textured.md for lamps with a profile: the radiance of these lights only depends on the direction.

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
            LightImage, LightPyramid, PROFILE_TANGENT, ProfileWindow, Reading, Readings, TexturedLight,
            TexturedReflection, colour, normals_readings,
        },
    },
};
use rayon::prelude::*;

use super::cases::{FORMS, SETS, Set, TOLERANCE, drawn};
use crate::{
    lights::Spread,
    markdown::{short, spread},
};

/// Side of a profile in texels.
const SIDE: usize = 512;

/// The radiance in a direction, at most one.
type Profile = fn(DVec3) -> f64;

const PROFILES: [(&str, Profile); 3] = [
    ("spot, cos^16", |d| d.z.powi(16)),
    ("batwing, 40 degrees", |d| (-0.5 * ((atan2(d.truncate().length(), d.z) - 0.7) / 0.2).powi(2)).exp()),
    ("asymmetric, tilted by 35 degrees", |d| d.dot(direction(0.61, 0.0)).max(0.0).powi(12)),
];

/// The direction from a point of the light to the shaded point, in the frame of the lamp's axis.
fn direction_of(window: &ProfileWindow, uv: [f64; 2]) -> DVec3 {
    let [x, y] = window.tangents(uv);
    DVec3::new(x, y, 1.0).normalize()
}

/// The pyramid of the profiles, with one profile per channel.
fn pyramid() -> LightPyramid {
    let texel = |i: usize| {
        let [x, y] = [i % SIDE, i / SIDE].map(|i| ((i as f64 + 0.5) / SIDE as f64 - 0.5) * 2.0 * PROFILE_TANGENT);
        let d = DVec3::new(x, y, 1.0).normalize();
        PROFILES.map(|(_, profile)| profile(d) as f32)
    };
    LightPyramid::new(&LightImage::new(SIDE, SIDE, (0..SIDE * SIDE).map(texel).collect()).expect("an image"))
}

const WAYS: [&str; 4] = ["at the light's middle", "one reading", "four readings", "four, without a blur"];

/// The light of each profile, for each method.
fn found(at: &Configuration, light: &TexturedLight, pyramid: &LightPyramid) -> [[f64; 3]; 4] {
    let corners = [0, 1, 2, 3].map(|i| light.polygon().vertices()[i].to_array());
    let wo = direction(at.theta, at.phi).to_array();
    let readings =
        |number| normals_readings([at.alpha_x, at.alpha_y], wo, &corners, Sides::Two, (NormalsRule::Balanced, number));
    let window = ProfileWindow::new(light);
    let at_point = |uv: [f64; 2]| PROFILES.map(|(_, profile)| profile(direction_of(&window, uv)));
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

/// The true reflected light for each profile, and the error of each method.
type Measured = ([f64; 3], [[f64; 3]; 4]);

fn measured(set: Set, lights: usize, pyramid: &LightPyramid) -> Vec<Measured> {
    let of_light = |(at, light, form): &(Configuration, TexturedLight, usize)| {
        let size = FORMS[*form].map(|texels| texels / 4);
        let texels = light.texel_lights(at, size, TOLERANCE).ok()?;
        let window = ProfileWindow::new(light);
        let value = |i: usize| {
            let place = [0, 1].map(|axis| ([i % size[0], i / size[0]][axis] as f64 + 0.5) / size[axis] as f64);
            let d = direction_of(&window, place);
            PROFILES.map(|(_, profile)| profile(d) as f32)
        };
        let values: Vec<[f32; 3]> = (0..texels.len()).map(value).collect();
        let truth = TexturedReflection::of_texels(texels.iter().zip(&values)).energy;
        Some((truth, found(at, light, pyramid).map(|found| [0, 1, 2].map(|i| (found[i] - truth[i]).abs()))))
    };
    let known: Vec<_> = drawn(set, lights).par_iter().map(of_light).collect();
    known.into_iter().flatten().take(lights).collect()
}

/// The table of docs/textured.md, with `lights` cases per set.
///
/// # Panics
/// Never: all drawn lights are valid.
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

    /// Four readings have about a quarter of the error of the profile at the light's middle, as in docs/textured.md. On
    /// rough surfaces, a blur about halves their error.
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
