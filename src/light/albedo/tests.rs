use std::f64::consts::FRAC_PI_2;

use glam::DVec3;

use super::*;
use crate::{LightModel, Lighting, PolygonLight, TableUse, by_table_as, cases::Draw};
use ltcforge_fit::{BrdfKind, Sides, Table, math::recurrence4, terms_of};

/// Surfaces with views up to 88 degrees from the normal.
fn places(count: usize) -> impl Iterator<Item = Configuration> {
    (0..count).map(|i| {
        let [root, ratio, theta, phi] = recurrence4(i, [0.3, 0.7, 0.2, 0.9]);
        let alpha_x = (root * root).max(1e-4);
        let theta = 88.0 / 90.0 * FRAC_PI_2 * theta;
        Configuration { alpha_x, alpha_y: (alpha_x * ratio).max(1e-4), theta, phi: FRAC_PI_2 * phi }
    })
}

/// The limits are the figures of docs/materials.md.
#[test]
fn the_cubic_is_near_the_mean_of_samples() {
    let errors: Vec<f64> = places(1500)
        .map(|at| {
            let wanted = sampled(&BrdfKind::Ggx.into(), &at).expect("a surface");
            let found = of_ggx(&at).expect("a surface");
            assert!((0.2..=1.0).contains(&found), "{at:?}: {found}");
            (found - wanted).abs()
        })
        .collect();
    let (mean, most) = (errors.iter().sum::<f64>() / 1500.0, errors.iter().copied().fold(0.0, f64::max));
    println!("{mean:.5} {most:.4}");
    assert!(mean < 0.0055 && most < 0.06, "{mean} {most}");
}

/// The albedo does not change if the frame turns by a right angle or is mirrored. f32 is close to f64.
#[test]
fn the_albedo_has_the_surface_s_symmetries() {
    for at in places(300) {
        let (alpha, wo) = ([at.alpha_x, at.alpha_y], direction(at.theta, at.phi));
        let found = albedo(alpha, wo.to_array());
        let others = [([alpha[1], alpha[0]], DVec3::new(wo.y, wo.x, wo.z)), (alpha, DVec3::new(-wo.x, wo.y, wo.z))];
        for (alpha, wo) in others {
            assert!((albedo(alpha, wo.to_array()) - found).abs() < 1e-12, "{at:?}");
        }
        let short = albedo(alpha.map(|x| x as f32), wo.as_vec3().to_array());
        assert!((f64::from(short) - found).abs() < 1e-4, "{at:?}: {short} {found}");
    }
    let mirror = albedo([1e-5; 2], DVec3::new(0.6, 0.0, 0.8).to_array());
    assert!((mirror - 1.0).abs() < 1e-3, "{mirror}");
}

/// A ceiling that covers the sky except for the horizon.
fn sky() -> PolygonLight {
    let corners = [[-1e4, -1e4, 1.0], [1e4, -1e4, 1.0], [1e4, 1e4, 1.0], [-1e4, 1e4, 1.0]];
    PolygonLight::new(corners.map(DVec3::from_array).to_vec(), Sides::Two).expect("a light")
}

/// White metal under uniform light. A table reflects all light, except for the part of its LTC below the surface; if
/// the LTC is cut, nothing is missing. Model `normals` has its own error and the error of the cubic.
#[test]
fn white_metal_reflects_all_of_a_white_sky() {
    let table = crate::cases::cosine(BrdfKind::Ggx.into());
    let terms = Some(terms_of(&table.brdf, table.layout, &table.axes));
    let table = Table { terms, ..table };
    let [mut worst, mut sum] = [0.0_f64; 2];
    let normals = Lighting::ClosedForm(LightModel::Normals.closed_form(None).expect("a formula"));
    let mut lost = 0.0_f64;
    for at in places(600) {
        let energy = normals.reflected(&at, &sky()).expect("a surface").energy;
        let factor = compensation(normals.albedo(&at).expect("a surface"), 1.0);
        lost = lost.max(1.0 - energy);
        let off = (energy * factor - 1.0).abs();
        (worst, sum) = (worst.max(off), sum + off);
        let by_table =
            by_table_as(&table, &at, &sky(), TableUse { cut: true, ..TableUse::default() }).expect("a table").energy;
        let factor = compensation(Lighting::by(&table).albedo(&at).expect("a table"), 1.0);
        assert!((by_table * factor - 1.0).abs() < 1e-3, "{at:?}: {by_table} {factor}");
    }
    println!("normals: mean {:.4}, most {worst:.4}; one bounce loses up to {lost:.3}", sum / 600.0);
    assert!(sum / 600.0 < 0.01 && worst < 0.1 && lost > 0.5, "{} {worst} {lost}", sum / 600.0);
}

#[test]
fn black_metal_is_as_it_was_and_what_has_no_facets_is_refused() {
    assert_eq!(compensation(0.5, 0.0), 1.0);
    assert_eq!(compensation(0.5, 1.0), 2.0);
    assert_eq!(compensation(1.0, 0.9), 1.0);
    let at = Draw::new(1).lit_by(crate::cases::Roughness::All, [0.1, 1.0]).at;
    let refused = sampled(&BrdfKind::OrenNayar.into(), &at);
    assert_eq!(refused, Err(LightError::NoFacets(BrdfKind::OrenNayar)));
    let beyond = Configuration { theta: FRAC_PI_2, ..at };
    assert!(matches!(of_ggx(&beyond), Err(LightError::Domain { what: "theta", .. })));
}
