//! How far the Gaussians are from the truth.

use glam::DVec3;

use crate::{
    fit::{
        Configuration, Sides,
        math::{cos, direction, pow},
    },
    light::{EVERYWHERE, Gaussian, Lighting, RandomLights, by_gaussian, light_error, rectangle, truth},
};

/// The measure of `docs/gaussians.md`.
#[test]
fn random_lights_are_off_by_a_tenth_and_the_stretched_gaussian_by_less() {
    let lights = RandomLights::draw(&EVERYWHERE, 1500).expect("ranges of a table");
    let error = |gaussian| light_error(Lighting::Gaussian(gaussian), &lights).expect("a surface");
    let [sg, asg] = [Gaussian::Sg, Gaussian::Asg].map(error);
    println!("sg {sg:?}\nasg {asg:?}");
    assert!(sg.mean < 0.058 && asg.mean < 0.031 && asg.mean < 0.7 * sg.mean, "{sg:?} {asg:?}");
    assert!(asg.max < 0.35, "{asg:?}");
}

/// The same over one surface, where the truth and both numbers are told.
#[test]
fn a_surface_reflects_about_what_ggx_does() {
    let at = Configuration { alpha_x: 0.25, alpha_y: 0.25, theta: 0.6, phi: 0.2 };
    let wo = direction(at.theta, at.phi);
    let mirror = DVec3::new(-wo.x, -wo.y, wo.z);
    let (x, y) = mirror.any_orthonormal_pair();
    let light = rectangle(mirror, [0.4 * x, 0.4 * y], Sides::Two).expect("a square");
    let wanted = truth(&at, &light).expect("a surface");
    for &gaussian in Gaussian::ALL {
        let found = by_gaussian(&at, &light, gaussian).expect("a surface");
        assert!((found.energy - wanted.energy).abs() < 0.1, "{gaussian} {found:?} {wanted:?}");
        assert!((found.fresnel / found.energy - pow(1.0 - cos(0.6), 5.0)).abs() < 2e-3, "{found:?}");
    }
}
