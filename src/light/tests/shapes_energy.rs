//! Compares the reflected light of triangles, hexagons, octagons, disks, tubes and spheres with the truth.

use std::f64::consts::TAU;

use glam::DVec3;
use rayon::prelude::*;

use crate::cases::{Draw, Roughness};
use crate::{NormalsRule, PolygonLight, TubeEnds, by_normals, disk, truth_within, tube};
use ltcforge_fit::{Configuration, Sides};

/// A light of a kind, around a direction that the lobe reflects.
type Kind = fn(&mut Draw, DVec3) -> Option<PolygonLight>;

fn regular(draw: &mut Draw, centre: DVec3, corners: u32) -> Option<PolygonLight> {
    let normal = (-centre + 0.5 * draw.vector()).normalize();
    let x = normal.cross(draw.vector()).normalize() * draw.within(0.05, 1.0);
    let y = normal.cross(x).normalize() * draw.within(0.05, 1.0);
    let vertex = |i: u32| {
        let (sin, cos) = (f64::from(i) * TAU / f64::from(corners)).sin_cos();
        centre + x * cos + y * sin
    };
    PolygonLight::new((0..corners).map(vertex).collect(), Sides::Two).ok()
}

const KINDS: [(&str, Kind); 6] = [
    ("triangles", |draw, centre| regular(draw, centre, 3)),
    ("hexagons", |draw, centre| regular(draw, centre, 6)),
    ("octagons", |draw, centre| regular(draw, centre, 8)),
    ("disks", |draw, centre| {
        let normal = (-centre + 0.5 * draw.vector()).normalize();
        disk(centre, normal, draw.within(0.05, 1.0), Sides::Two).ok()
    }),
    ("spheres", |draw, centre| tube([centre; 2], draw.within(0.05, 0.8), TubeEnds::Round).ok()),
    ("tubes", |draw, centre| {
        let half = draw.vector().normalize() * draw.within(0.05, 1.0);
        tube([centre - half, centre + half], draw.within(0.02, 0.3), TubeEnds::Flat).ok()
    }),
];

/// The limits are 50 % above the measured errors. The truth has the same outline. Another test measures the error of
/// outlines.
#[test]
fn every_shape_reflects_what_the_truth_does() {
    for (i, (name, kind)) in KINDS.into_iter().enumerate() {
        let mut draw = Draw::new(111 + i as u64);
        let mut cases: Vec<(Configuration, PolygonLight)> = Vec::new();
        while cases.len() < 300 {
            let lit = draw.lit(Roughness::All);
            let centre = lit.vertices[0].midpoint(lit.vertices[2]);
            if let Some(light) = kind(&mut draw, centre) {
                cases.push((lit.at, light));
            }
        }
        let wanted: Vec<f64> =
            cases.par_iter().map(|(at, light)| truth_within(1e-5, at, light).expect("a surface").energy).collect();
        let mean = wanted.iter().sum::<f64>() / wanted.len() as f64;
        assert!(mean > 0.1, "lobes miss most lights: {mean}");
        for rule in [NormalsRule::Balanced, NormalsRule::Fine] {
            let mut errors: Vec<f64> = cases
                .iter()
                .zip(&wanted)
                .map(|((at, light), wanted)| (by_normals(at, light, rule).expect("a surface").energy - wanted).abs())
                .collect();
            errors.sort_by(f64::total_cmp);
            let found = [
                errors.iter().sum::<f64>() / errors.len() as f64,
                errors[errors.len() * 95 / 100],
                errors[errors.len() - 1],
            ];
            println!("{name}, {rule}: off by {found:.5?} of {mean:.3} (mean, p95, max)");
            let limits = [0.0012, 0.007, 0.04];
            assert!(found.iter().zip(limits).all(|(found, limit)| *found < limit), "{name}, {rule}: {found:?}");
        }
    }
}
