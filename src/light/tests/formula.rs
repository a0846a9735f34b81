//! Measures the LTC by a formula, and tests its symmetries and extremes.

use std::f64::consts::TAU;

use glam::{DQuat, DVec3};

use crate::{
    ClosedForm, EVERYWHERE, LightModel, Lighting, RandomLights, ShapedLight,
    albedo::sampled,
    cases::{Draw, Lit, Roughness},
    light_error,
    ltc::FormulaLobe,
    material_error,
};
use ltcforge_fit::{BrdfKind, Configuration, Sides, math::Triple};

fn form() -> ClosedForm {
    LightModel::LtcFormula.closed_form(None).expect("a formula")
}

fn energy(lit: &Lit) -> f64 {
    form().reflected(&lit.at, &lit.light(Sides::Two)).expect("a surface").energy
}

/// The limits are a tenth above the measured errors.
#[test]
fn random_lights_are_off_by_half_a_percent_and_plastics_by_three() {
    let lights = RandomLights::draw(&BrdfKind::Ggx.into(), &EVERYWHERE, 1500).expect("ranges of a table");
    let formula = Lighting::ClosedForm(form());
    let metal = light_error(formula, &lights).expect("a surface");
    let plastic = material_error(formula, &lights, 0.04).expect("a surface").mean / lights.mean_reflected(0.04);
    println!("metal {metal:?}, plastic {plastic}");
    assert!(metal.mean < 0.0061 && metal.p95 < 0.026, "{metal:?}");
    assert!(plastic < 0.031, "{plastic}");
}

/// The amplitude is near the mean of samples, also for rough isotropic surfaces: alpha .02 to 1, views to 85 degrees.
#[test]
fn the_amplitude_is_near_the_albedo() {
    let mut draw = Draw::new(316);
    let errors: Vec<f64> = (0..400)
        .map(|i| {
            let alpha = draw.within(0.02, 1.0);
            let other = if i % 2 == 0 { alpha } else { alpha * draw.within(0.1, 1.0) };
            let theta = draw.within(0.0, 85_f64.to_radians());
            let at = Configuration { alpha_x: alpha, alpha_y: other, theta, phi: draw.within(0.0, TAU) };
            let wanted = sampled(&BrdfKind::Ggx.into(), &at).expect("a surface");
            (Lighting::ClosedForm(form()).albedo(&at).expect("an albedo") - wanted).abs()
        })
        .collect();
    let (mean, most) = (errors.iter().sum::<f64>() / 400.0, errors.iter().copied().fold(0.0, f64::max));
    println!("mean {mean:.4}, max {most:.4}");
    assert!(mean < 0.008 && most < 0.05, "{mean} {most}");
}

/// Mirrored scenes, scenes with x and y exchanged, and lights whose corners are listed in another order are equal.
#[test]
fn equivalent_scenes_are_lit_equally() {
    for roughness in [Roughness::All, Roughness::Extreme] {
        for lit in Draw::many(310, 500, roughness) {
            let wanted = energy(&lit);
            for variant in lit.variants() {
                let found = energy(&variant);
                assert!((found - wanted).abs() < 1e-9, "{variant:?}: {found}, not {wanted}");
            }
        }
    }
}

/// The tangent frame of an isotropic surface does not matter.
#[test]
fn isotropic_surfaces_may_turn() {
    let mut draw = Draw::new(311);
    for mut lit in Draw::many(312, 500, Roughness::All) {
        lit.at.alpha_y = lit.at.alpha_x;
        let wanted = energy(&lit);
        let angle = draw.within(0.0, TAU);
        lit.at.phi += angle;
        lit.vertices.iter_mut().for_each(|v| *v = DQuat::from_rotation_z(angle) * *v);
        let found = energy(&lit);
        assert!((found - wanted).abs() < 1e-9, "{lit:?}: {found}, not {wanted}");
    }
}

/// A surface and view in the whole domain: alpha from 1e-5, views to 89.99 degrees.
fn extreme(draw: &mut Draw) -> ([f64; 2], Triple<f64>) {
    let alpha = [0, 1].map(|_| 10_f64.powf(draw.within(-5.0, 0.0)));
    // Half of the views are grazing.
    let most = if draw.within(0.0, 1.0) < 0.5 { 1.0 } else { 0.02 };
    let (height, phi) = (draw.within(1.75e-4, most), draw.within(0.0, TAU));
    let flat = (1.0 - height * height).sqrt();
    (alpha, [flat * phi.cos(), flat * phi.sin(), height])
}

/// The determinant is positive and all numbers are finite, in f32 and f64, for metals and plastics.
#[test]
fn lobes_of_extremes_are_finite_and_do_not_mirror() {
    let mut draw = Draw::new(313);
    for _ in 0..100_000 {
        let (alpha, wo) = extreme(&mut draw);
        for f0 in [1.0, 0.04, 0.0] {
            let double = FormulaLobe::new(alpha, wo, [f0, 1.0]);
            let single = FormulaLobe::new(alpha.map(|x| x as f32), wo.map(|x| x as f32), [f0 as f32, 1.0]);
            let rows = single.space.rows().map(|row| row.map(f64::from));
            for (rows, determinant, parts) in [
                (double.space.rows(), double.space.determinant(), double.parts),
                (rows, f64::from(single.space.determinant()), single.parts.map(f64::from)),
            ] {
                assert!(rows.as_flattened().iter().all(|x| x.is_finite()), "{alpha:?} {wo:?} {f0}: {rows:?}");
                assert!(determinant > 0.0 && determinant.is_finite(), "{alpha:?} {wo:?} {f0}: {determinant}");
                assert!(
                    (0.0..=1.0).contains(&parts[0]) && (0.0..=parts[0]).contains(&parts[1]),
                    "{alpha:?} {wo:?}: {parts:?}"
                );
            }
        }
    }
}

/// The lobes of f32 and f64 cover the same part of a light.
#[test]
fn single_precision_is_enough() {
    let error = |lit: &Lit| {
        let vertices: Vec<[f32; 3]> = lit.vertices.iter().map(|v| v.as_vec3().to_array()).collect();
        let single = FormulaLobe::new(lit.alpha().map(|x| x as f32), lit.wo().as_vec3().to_array(), [1.0; 2]);
        let found = single.parts[0] * single.space.polygon(&vertices, Sides::Two);
        (f64::from(found) - energy(lit)).abs()
    };
    for (roughness, limit) in [(Roughness::All, 5e-6), (Roughness::Extreme, 2e-3)] {
        let mut errors: Vec<f64> = Draw::many(314, 2000, roughness).iter().map(error).collect();
        errors.sort_by(f64::total_cmp);
        println!("{roughness:?}: p95 {:.1e}, max {:.1e}", errors[1900], errors[1999]);
        assert!(errors[1900] < limit, "{roughness:?}: {}", errors[1900]);
    }
}

/// White metal under a closed ceiling reflects all light, because the compensation divides by the lobe's amplitude.
#[test]
fn compensated_white_metal_reflects_the_whole_sky() {
    let sky = ShapedLight::ellipse(1e-3 * DVec3::Z, [1e3 * DVec3::X, 1e3 * DVec3::Y], Sides::Two).expect("a disk");
    for at in Draw::many(315, 200, Roughness::All).iter().map(|lit| lit.at) {
        let light = Lighting::ClosedForm(form().with_cut(true));
        let reflected = light.reflected(&at, &sky).expect("a light").energy / light.albedo(&at).expect("an albedo");
        assert!((reflected - 1.0).abs() < 1e-3, "{at:?}: {reflected}");
    }
}

/// Disks are integrated as they are, and the cut leaves no light from below the surface. The cut also removes F82's edge term.
#[test]
fn shapes_are_exact_and_the_cut_hides_what_is_below() {
    let at = Configuration { alpha_x: 0.6, alpha_y: 0.3, theta: 1.3, phi: 0.4 };
    let reflected = |light: &ShapedLight, cut| form().with_cut(cut).reflected(&at, light).expect("a light").energy;
    let round = |centre: DVec3, half| ShapedLight::ellipse(centre, half, Sides::Two).expect("a disk");
    let above = round(DVec3::new(-1.0, -0.3, 0.6), [0.4 * DVec3::X, 0.4 * DVec3::Y]);
    let polygon: Vec<DVec3> = (0..400)
        .map(|i| {
            DVec3::new(-1.0, -0.3, 0.6) + 0.4 * DQuat::from_rotation_z(-TAU * f64::from(i) / 400.0).mul_vec3(DVec3::X)
        })
        .collect();
    let lobe = FormulaLobe::new([0.6, 0.3], ltcforge_fit::math::direction(1.3, 0.4).to_array(), [1.0; 2]);
    let wanted =
        lobe.parts[0] * lobe.space.polygon(&polygon.iter().map(DVec3::to_array).collect::<Vec<_>>(), Sides::Two);
    assert!((reflected(&above, false) - wanted).abs() < 1e-4 * wanted, "{wanted}");
    let below = round(DVec3::new(-1.0, -0.4, -0.25), [0.24 * DVec3::Z, DVec3::new(-0.2, 0.5, 0.0)]);
    let [whole, cut] = [false, true].map(|cut| reflected(&below, cut));
    assert!(whole > 1e-4 && cut == 0.0, "{whole} {cut}");
    let edges = [false, true].map(|cut| form().with_cut(cut).edge(&at, &below).expect("a light"));
    assert!(edges[0] > 0.0 && edges[1] == 0.0, "{edges:?}");
}
