use std::f64::consts::{FRAC_PI_2, PI, TAU};

use glam::{DMat3, DVec3};
use proptest::prelude::*;

use super::{
    super::{cheap_form_factor, clipped_form_factor},
    cases::{mirror_like, polygon, quadrature, random_cases},
    *,
};

#[test]
fn ten_thousand_polygons_agree_with_quadrature() {
    const TOLERANCE: f64 = 1e-4;
    let (mut clipped, mut lit) = (0, 0);
    for (i, (polygon, m)) in random_cases(10_000).enumerate() {
        let Some(ltc) = Ltc::new(m) else { panic!("{m} is singular") };
        let found = ltc.polygon(&polygon, Sides::Two);
        let wanted = quadrature(m, &polygon);
        assert!((found - wanted).abs() < TOLERANCE, "{i}: {found} {wanted} {m} {polygon:?}");
        let heights: Vec<f64> = polygon.iter().map(|v| (ltc.inverse() * *v).z).collect();
        clipped += usize::from(heights.iter().any(|z| *z > 0.0) && heights.iter().any(|z| *z < 0.0));
        lit += usize::from(wanted > 1e-3);
    }
    assert!(clipped > 3000 && lit > 3000, "{clipped} clipped, {lit} lit");
}

/// Approximates the part of a polygon above the horizon by the cap with the same vector form factor. Tests the closed
/// form and its cheap fit.
#[test]
fn spheres_instead_of_polygons_have_the_documented_error() {
    let mut errors: [[Vec<f64>; 2]; 2] = Default::default();
    for (polygon, m) in random_cases(20_000) {
        let ltc = Ltc::new(m).expect("regular");
        let exact = ltc.polygon(&polygon, Sides::Two);
        let flux = ltc.vector_form_factor(&polygon);
        let (length, heights) = (flux.length(), polygon.iter().map(|v| (ltc.inverse() * *v).z));
        let (up, down) = (heights.clone().any(|z| z > 0.0), heights.clone().any(|z| z <= 0.0));
        if !up || length < 1e-12 {
            continue;
        }
        let cosine = flux.z / length;
        let found = [clipped_form_factor, cheap_form_factor].map(|guess| length * guess(cosine, length));
        for (errors, found) in errors[usize::from(down)].iter_mut().zip(found) {
            errors.push((found - exact).abs());
        }
    }
    let wanted = [[7e-5, 0.00305], [0.00347, 0.0122]];
    for ((kind, wanted), [sphere, cheap]) in ["above", "cut"].into_iter().zip(wanted).zip(errors) {
        let figures = |mut errors: Vec<f64>| {
            errors.sort_by(f64::total_cmp);
            let mean = errors.iter().sum::<f64>() / errors.len() as f64;
            [mean, errors[errors.len() * 95 / 100], errors[errors.len() - 1]]
        };
        let (count, [sphere, cheap]) = (sphere.len(), [sphere, cheap].map(figures));
        println!("{kind}, {count}: sphere {sphere:.5?}, cheap {cheap:.5?}");
        let mean = [sphere[0], cheap[0]];
        assert!(mean.into_iter().zip(wanted).all(|(found, wanted)| (found - wanted).abs() < 0.1 * wanted), "{mean:?}");
    }
}

/// The square consists of four patches, each with a corner straight above the origin. Textbooks on form factors give
/// the closed form of this patch.
#[test]
fn a_square_above_has_the_form_factor_of_the_books() {
    let square = [(1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0)].map(|(x, y)| DVec3::new(x, y, 1.0));
    let root = 2.0_f64.sqrt();
    let wanted = 4.0 / PI * (1.0 / root) * (1.0 / root).atan();
    let cosine = Ltc::new(DMat3::IDENTITY).expect("regular");
    assert!((cosine.polygon(&square, Sides::One) - wanted).abs() < 1e-14);
}

#[test]
fn a_one_sided_light_is_visible_only_from_its_front() {
    let cosine = Ltc::new(DMat3::IDENTITY).expect("regular");
    let mut square = [(1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0)].map(|(x, y)| DVec3::new(x, y, 1.0));
    let front = cosine.polygon(&square, Sides::One);
    assert!(front > 0.5);
    square.reverse();
    assert_eq!(cosine.polygon(&square, Sides::One), 0.0);
    assert_eq!(cosine.polygon(&square, Sides::Two), front);
    // A mirrored lobe sees the same side.
    let mirrored = Ltc::new(DMat3::from_diagonal(DVec3::new(1.0, -1.0, 1.0))).expect("regular");
    square.reverse();
    assert!((mirrored.polygon(&square, Sides::One) - front).abs() < 1e-15);
}

#[test]
fn below_the_horizon_is_exactly_nothing() {
    let cosine = Ltc::new(DMat3::IDENTITY).expect("regular");
    let below = [(1.0, 0.0), (0.0, 1.0), (-1.0, -1.0)].map(|(x, y)| DVec3::new(x, y, -0.1));
    let flat = below.map(|v| DVec3::new(v.x, v.y, 0.0));
    assert_eq!(cosine.polygon(&below, Sides::Two), 0.0);
    assert_eq!(cosine.polygon(&flat, Sides::Two), 0.0);
    assert_eq!(cosine.polygon(&[], Sides::Two), 0.0);
    assert_eq!(cosine.polygon(&flat[..2], Sides::Two), 0.0);
}

/// The integral in f32, with the inverse of `m` scaled as in the shader.
fn in_f32(m: DMat3, polygon: &[DVec3]) -> f32 {
    let inverse = m.inverse();
    let scale = inverse.to_cols_array().into_iter().fold(0.0, |largest: f64, x| largest.max(x.abs()));
    let single = |v: &DVec3| (inverse * (1.0 / scale) * *v).as_vec3().to_array();
    let mut clip = Clip::begin(single(&polygon[polygon.len() - 1]));
    for vertex in polygon {
        clip.edge_to(single(vertex));
    }
    clip.finish()
}

/// An ordinary number, zero, one, or a number close to zero.
fn coordinate() -> impl Strategy<Value = f64> {
    prop_oneof![-3.0..3.0, Just(0.0), Just(1.0), (-3_i64..3).prop_map(|ulps| ulps as f64 * 1e-16), -1e-6..1e-6]
}

fn hard_alpha() -> impl Strategy<Value = f64> {
    prop_oneof![1e-5..1.0, Just(1e-4), Just(1.0), 1e-5..1e-3]
}

fn hard_theta() -> impl Strategy<Value = f64> {
    prop_oneof![0.0..1.57, Just(0.0), Just(0.9999 * FRAC_PI_2)]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    #[test]
    fn never_negative_never_nan(
        vertices in prop::collection::vec((coordinate(), coordinate(), coordinate()), 3..=MAX_VERTICES),
        alpha_x in hard_alpha(), alpha_y in hard_alpha(), theta in hard_theta(), phi in prop_oneof![0.0..TAU, Just(0.0), Just(FRAC_PI_2)],
    ) {
        // Any closed outline, including degenerate outlines.
        let outline: Vec<DVec3> = vertices.into_iter().map(DVec3::from).collect();
        let m = mirror_like(alpha_x, alpha_y, theta, phi);
        if let Some(ltc) = Ltc::new(m) {
            for sides in [Sides::One, Sides::Two] {
                prop_assert!((0.0..=1.0).contains(&ltc.polygon(&outline, sides)));
            }
        }
        prop_assert!(in_f32(m, &outline).is_finite());
    }

    #[test]
    fn f32_is_close_where_the_lobe_is_not_a_needle(
        angles in prop::collection::vec(0.0..TAU, 3..=MAX_VERTICES), centre in prop::array::uniform3(-2.0..2.0),
        first in prop::array::uniform3(-1.0..1.0), second in prop::array::uniform3(-1.0..1.0),
        alpha_x in 0.05..1.0, alpha_y in 0.05..1.0, theta in 0.0..1.4, phi in 0.0..TAU,
    ) {
        let outline = polygon(DVec3::from(centre), [DVec3::from(first), DVec3::from(second)], angles);
        let m = mirror_like(alpha_x, alpha_y, theta, phi);
        let exact = Ltc::new(m).expect("regular").polygon(&outline, Sides::Two);
        // Degenerate slivers seen edge-on lose digits, but the error stays below this limit.
        prop_assert!((f64::from(in_f32(m, &outline)).abs() - exact).abs() < 1e-3, "{}", exact);
    }
}
