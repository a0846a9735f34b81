//! Compares the integrals in different spaces with each other.

use glam::DVec3;

use super::*;
use crate::cases::{Draw, Roughness};
use ltcforge_fit::{
    brdf::{Beckmann, Brdf, Ggx, OrenNayar},
    testing::planted_tabulated,
};

const TOLERANCE: f64 = 1e-9;

/// The light that a lobe reflects does not depend on the space in which it is integrated.
#[test]
fn a_lobe_is_the_same_in_every_space() {
    let mut draw = Draw::new(91);
    for _ in 0..20 {
        let lit = draw.lit(Roughness::All);
        let (alpha, wo) = (lit.alpha(), lit.wo());
        let [alpha_x, alpha_y] = alpha.map(|alpha| alpha.max(0.1));
        let light = lit.light(Sides::Two);
        let ggx = Ggx { alpha_x: alpha[0], alpha_y: alpha[1] };
        for weight in [Weight::Schlick, Weight::Edge] {
            let own = reflected(&GgxNormals::new(alpha, wo, weight), (&light).into(), 1.0, TOLERANCE);
            let general = reflected(&Normals::new(&ggx, alpha, wo, weight), (&light).into(), 1.0, TOLERANCE);
            assert_same(own, general, 2e-9);
        }
        let broad: [&dyn Brdf; 3] =
            [&Ggx { alpha_x, alpha_y }, &Beckmann { alpha_x, alpha_y }, &OrenNayar { roughness: 0.7 }];
        for (brdf, weight) in broad.into_iter().flat_map(|brdf| [(brdf, Weight::Schlick), (brdf, Weight::Edge)]) {
            let normals =
                reflected(&Normals::new(brdf, [alpha_x, alpha_y], wo, weight), (&light).into(), 1.0, TOLERANCE);
            let directions = reflected(&Directions::new(brdf, wo, weight), (&light).into(), 1.0, TOLERANCE);
            assert_same(normals, directions, 2e-8);
        }
    }
}

fn assert_same(one: [f64; 2], other: [f64; 2], tolerance: f64) {
    let apart = (one[0] - other[0]).abs().max((one[1] - other[1]).abs());
    assert!(apart < tolerance, "{one:?} {other:?}");
}

/// Between two kinks of a ray, a tabulated lobe is within one cell. The ray is cut at every node that it crosses, and
/// nowhere else.
#[test]
fn rays_are_cut_at_the_nodes() {
    let brdf = planted_tabulated();
    let surface = brdf.surface([0.4; 2]);
    let mut draw = Draw::new(92);
    let mut cuts = 0;
    for _ in 0..50 {
        let wo = draw.lit(Roughness::All).wo();
        let space = Directions::new(&*surface, wo, Weight::Schlick);
        let [from, to] = [0; 2].map(|_: u32| {
            let v = draw.vector();
            DVec3::new(v.x, v.y, v.z.abs() + 1e-3).normalize()
        });
        let at = |s: f64| {
            let w = (from * (1.0 - s) + to * s).normalize();
            let phi = (wo.x * w.y - wo.y * w.x).abs().atan2(wo.x * w.x + wo.y * w.y);
            (w.z.acos(), phi)
        };
        let bends = space.bends(from, to);
        let nodes = surface.bends(wo);
        let cell = |(theta, phi): (f64, f64)| {
            [nodes.theta_i.partition_point(|x| *x < theta), nodes.phi.partition_point(|x| *x < phi)]
        };
        let ends: Vec<f64> = [0.0].into_iter().chain(bends.iter().copied()).chain([1.0]).collect();
        let middles: Vec<[usize; 2]> = ends.windows(2).map(|pair| cell(at(0.5 * (pair[0] + pair[1])))).collect();
        for (pair, middle) in ends.windows(2).zip(&middles) {
            let width = pair[1] - pair[0];
            for part in [0.01, 0.99] {
                assert_eq!(cell(at(pair[0] + part * width)), *middle, "{wo} {from} {to} {pair:?}");
            }
        }
        cuts += bends.len();
    }
    assert!(cuts > 500, "{cuts} cuts of 50 rays");
}
