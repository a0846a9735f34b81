//! Measures the errors of the Gaussians.

use std::{f64::consts::FRAC_PI_2, ops::ControlFlow};

use glam::DVec3;

use crate::{
    EVERYWHERE, Gaussian, LightError, LightModel, Lighting, RandomLights, ReflectedLight, by_gaussian, by_table,
    cases::{Draw, Lit, Roughness},
    light_error, rectangle, truth,
};
use ltcforge_fit::{
    BrdfKind, Configuration, FITTER_VERSION, FitSettings, Layout, LobeModel, Metric, PerAxis, Plan, Precision, Recipe,
    Sides, Solver, StoredTerms, Table, fit_plan,
    math::{cos, direction, pow},
    report,
};

fn formula(model: LightModel) -> Lighting<'static> {
    Lighting::ClosedForm(model.closed_form(None).expect("a formula"))
}

/// The measurement of `studies/gaussians.md`.
#[test]
fn random_lights_are_off_by_a_tenth_and_the_stretched_gaussian_by_less() {
    let lights = RandomLights::draw(&BrdfKind::Ggx.into(), &EVERYWHERE, 1500).expect("ranges of a table");
    let error = |model| light_error(formula(model), &lights).expect("a surface");
    let [sg, asg] = [LightModel::Sg, LightModel::Asg].map(error);
    println!("sg {sg:?}\nasg {asg:?}");
    assert!(sg.mean < 0.058 && asg.mean < 0.031 && asg.mean < 0.7 * sg.mean, "{sg:?} {asg:?}");
    assert!(asg.max < 0.35, "{asg:?}");
}

/// The error on one surface, with limits for energy and Fresnel part.
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

/// A table of Gaussians, fitted over the whole domain.
fn fitted(lobe: LobeModel) -> Table {
    let quarter = [0.0, FRAC_PI_2];
    let recipe = Recipe {
        fitter: FITTER_VERSION,
        given: ltcforge_fit::GivenNodes::default(),
        brdf: BrdfKind::Ggx.into(),
        lobe,
        layout: Layout::Reflected,
        resolution: PerAxis { alpha: 5, ratio: 3, theta: 5, phi: 3 },
        range: PerAxis { alpha: [0.0, 1.0], ratio: [0.0, 1.0], theta: quarter, phi: quarter },
        fit: FitSettings {
            metric: Metric::Sw1,
            solver: Solver::Bfgs,
            samples: 96,
            directions: 8,
            steps: 20,
            seed: 0,
            simplex: None,
        },
        terms: StoredTerms::Schlick,
        precision: Precision::F32,
    };
    fit_plan(&Plan::new(&recipe), &|_| ControlFlow::Continue(())).expect("nothing stops it")
}

/// Tables of a few hundred entries are more accurate than the closed forms, over the whole domain. Their mean error is
/// 0.76 of the closed form's error for a round Gaussian, and 0.80 for a stretched Gaussian.
#[test]
fn fitted_gaussians_are_nearer_than_closed_forms() {
    let lights = RandomLights::draw(&BrdfKind::Ggx.into(), &EVERYWHERE, 600).expect("ranges of a table");
    let error = |model: Lighting<'_>| light_error(model, &lights).expect("a surface");
    for (lobe, part) in [(LobeModel::Sg, 0.8), (LobeModel::Asg, 0.84)] {
        let table = fitted(lobe);
        let [fitted, closed] = [Lighting::by(&table), formula(LightModel::of_lobe(lobe))].map(error);
        let measured = report(&table, &EVERYWHERE, 64);
        println!("{lobe}: {fitted:?}, closed form {closed:?}, {:?}", measured.nodes.amplitude);
        assert!(fitted.mean < part * closed.mean, "{lobe}: {fitted:?} {closed:?}");
        // The report's amplitude is the albedo. The table stores it divided by the part above the horizon.
        let amplitude = measured.nodes.amplitude.expect("terms");
        assert!(amplitude.mean < 0.01, "{lobe}: {amplitude:?}");
        assert!(table.terms().expect("terms").amplitude().iter().any(|stored| *stored > 1.05), "{lobe}");
        assert_eq!(
            light_error(Lighting::by(&Table { terms: None, ..table }), &lights).err(),
            Some(LightError::NoTerms)
        );
    }
}

/// Tests mirrored scenes and reversed corners with tables of Gaussians.
#[test]
fn a_table_of_gaussians_lights_a_scene_equally_in_every_description() {
    let mut draw = Draw::new(11);
    let scenes: Vec<Lit> =
        (0..200).map(|k| draw.lit_by(Roughness::All, if k % 2 == 0 { [0.05, 1.2] } else { [1.0, 8.0] })).collect();
    for lobe in [LobeModel::Sg, LobeModel::Asg] {
        let table = fitted(lobe);
        let energy = |lit: &Lit| by_table(&table, &lit.at, &lit.light(Sides::Two)).expect("a table").energy;
        let (mut most, mut sum) = (0.0_f64, 0.0);
        for scene in &scenes {
            let wanted = energy(scene);
            most = scene.variants().map(|scene_variant| (energy(&scene_variant) - wanted).abs()).fold(most, f64::max);
            sum += wanted;
        }
        assert!(most < 1e-9 && sum > 20.0, "{lobe}: {most:e}, {sum}");
    }
}

/// The reflected light is at most the incident light, at nodes and between them.
#[test]
fn a_table_of_gaussians_reflects_no_more_than_there_is() {
    let table = fitted(LobeModel::Asg);
    for (alpha, theta) in [1.0, 0.6, 0.1, 1e-4].into_iter().flat_map(|alpha| [0.0, 0.7, 1.3, 1.57].map(|t| (alpha, t)))
    {
        let at = Configuration { alpha_x: alpha, alpha_y: 0.7 * alpha, theta, phi: 0.9 };
        for half in [0.05, 0.5, 20.0] {
            let light = rectangle(DVec3::Z * 0.3, [DVec3::X * half, DVec3::Y * half], Sides::Two).expect("a square");
            let ReflectedLight { energy, fresnel } = by_table(&table, &at, &light).expect("a table");
            assert!((0.0..=1.0).contains(&energy) && (0.0..=energy).contains(&fresnel), "{at:?} {half}: {energy}");
        }
    }
}
