//! Small lights reflect little light, but its digits must still be correct.

use rayon::prelude::*;

use crate::cases::{Draw, Lit, Roughness};
use crate::{
    NormalsRule, by_normals,
    normals::{NormalsRule as Rule, reflected},
};
use ltcforge_fit::Sides;

/// The result in f32 as in a shader, and the result in f64 for the same rounded numbers.
fn in_both(lit: &Lit, rule: Rule) -> [f64; 2] {
    let vertices: Vec<[f32; 3]> = lit.vertices.iter().map(|v| v.as_vec3().to_array()).collect();
    let (alpha, wo) = (lit.alpha().map(|x| x as f32), lit.wo().as_vec3());
    let [single, _] = reflected(alpha, wo.to_array(), &vertices, Sides::Two, rule);
    let vertices: Vec<[f64; 3]> = vertices.iter().map(|v| v.map(f64::from)).collect();
    let wo = wo.as_dvec3().normalize().to_array();
    let [double, _] = reflected(alpha.map(f64::from), wo, &vertices, Sides::Two, rule);
    [f64::from(single), double]
}

/// A light of a thousandth of a radian gives a few millionths of all reflected light, so only relative errors are
/// meaningful.
#[test]
fn small_lights_have_digits_in_f32() {
    for (size, limits) in [(0.03, [3e-6, 5e-4]), (0.01, [1e-5, 2e-3]), (0.003, [4e-5, 2e-2]), (0.001, [2e-4, 0.2])] {
        for rule in NormalsRule::SHADED {
            let mut draw = Draw::new(101);
            let lights: Vec<Lit> = (0..2000).map(|_| draw.lit_by(Roughness::All, [size, 1.5 * size])).collect();
            let mut errors: Vec<f64> = lights
                .par_iter()
                .map(|lit| in_both(lit, rule))
                .filter(|[_, double]| *double > 0.0)
                .map(|[single, double]| (single / double - 1.0).abs())
                .collect();
            assert!(errors.len() > 1900, "{}", errors.len());
            errors.sort_by(f64::total_cmp);
            let found = [errors[errors.len() / 2], errors[errors.len() * 99 / 100]];
            println!(
                "{size}, {rule}: off by {:.1e} of itself (median), {:.1e} (p99), {:.1e} at most",
                found[0],
                found[1],
                errors[errors.len() - 1]
            );
            assert!(found.iter().zip(limits).all(|(found, limit)| *found < limit), "{size}, {rule}: {found:?}");
        }
    }
}

/// A light of half the size reflects a quarter of the light. The closed form converges to the BRDF at a point, for
/// lobes that do not vary over the light.
#[test]
fn small_lights_tend_to_a_point() {
    let mut draw = Draw::new(102);
    for _ in 0..300 {
        let lit = draw.lit_by(Roughness::All, [1e-3, 1.1e-3]);
        if lit.alpha().iter().any(|alpha| *alpha < 0.05) {
            continue;
        }
        let centre = lit.vertices[0].midpoint(lit.vertices[2]);
        let mut half = lit.clone();
        half.vertices.iter_mut().for_each(|v| *v = centre + 0.5 * (*v - centre));
        let [whole, half] = [lit, half]
            .map(|lit| by_normals(&lit.at, &lit.light(Sides::Two), NormalsRule::Balanced).expect("a surface").energy);
        assert!((4.0 * half / whole - 1.0).abs() < 0.02, "{half} {whole}");
    }
}
