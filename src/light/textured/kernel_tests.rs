//! Compares the readings of a picture with finite differences, with the truth and with limits.

use glam::{DMat3, DQuat, DVec3};
use rayon::prelude::*;

use super::{
    LightImage, LightPyramid, Reading, Readings, TexturedLight,
    cosine::CosineLobe,
    ggx::GgxLobe,
    ltc_readings, normals_readings,
    readings::{Lobe, colour},
    rectangle::Rectangle,
};
use crate::{
    CosineSpace, LightError, NormalsRule, PolygonLight, by_normals,
    cases::{Draw, Lit, Roughness, cosine, jump},
    ltc::{TableUse, by_table_as},
    normals::View,
    truth,
};
use ltcforge_fit::{
    BrdfKind, Configuration, Ltc, Sides, Table, Terms,
    brdf::{Brdf, Ggx},
    math::{Scalar, Triple},
};

const HOW: (NormalsRule, Readings) = (NormalsRule::Balanced, Readings::Four);

fn corners(lit: &Lit) -> [Triple<f64>; 4] {
    [0, 1, 2, 3].map(|i| lit.vertices[i].to_array())
}

fn lights(seed: u64, count: usize) -> Vec<Lit> {
    let mut draw = Draw::new(seed);
    (0..count).map(|_| draw.lit_by(Roughness::All, [0.05, 1.2])).collect()
}

fn textured(lit: &Lit) -> TexturedLight {
    TexturedLight::new(lit.light(Sides::Two)).expect("a rectangle")
}

/// A picture with a dot, a checkerboard and a ramp in its channels.
fn picture() -> LightImage {
    const SIDE: usize = 256;
    let texel = |i: usize| {
        let [u, v] = [i % SIDE, i / SIDE].map(|x| (x as f32 + 0.5) / SIDE as f32);
        let dot = f32::from((u - 0.6).hypot(v - 0.4) < 0.1);
        [dot, f32::from((i % SIDE / 32 + i / SIDE / 32).is_multiple_of(2)), u]
    };
    LightImage::new(SIDE, SIDE, (0..SIDE * SIDE).map(texel).collect()).expect("an image")
}

#[test]
fn derivatives_match_differences_of_the_inverse_root() {
    for lit in lights(4400, 200) {
        let (view, rectangle) = (View::new(lit.alpha(), lit.wo().to_array()), Rectangle::new(&corners(&lit)));
        let lobe = GgxLobe::new(&view, &rectangle);
        let p = [0.3 * rectangle.size[0], 0.6 * rectangle.size[1]];
        let h = 1e-3 * view.alpha[0].min(view.alpha[1]) * rectangle.area().sqrt().min(1.0);
        let q = |x: f64, y: f64| lobe.inverse_root([p[0] + x * h, p[1] + y * h]);
        let middle = q(0.0, 0.0);
        let (gradient, second) = lobe.derivatives(p);
        let first = [q(1.0, 0.0) - q(-1.0, 0.0), q(0.0, 1.0) - q(0.0, -1.0)].map(|x| x / (2.0 * h * middle));
        let mixed = (q(1.0, 1.0) - q(1.0, -1.0) - q(-1.0, 1.0) + q(-1.0, -1.0)) / 4.0;
        let bends = [q(1.0, 0.0) - 2.0 * middle + q(-1.0, 0.0), mixed, q(0.0, 1.0) - 2.0 * middle + q(0.0, -1.0)];
        let bends = bends.map(|x| x / (h * h * middle));
        let scale = 1.0 + second[0].abs() + second[2].abs();
        assert!((0..2).all(|i| (first[i] - gradient[i]).abs() < 1e-4 * scale.sqrt()), "{gradient:?} {first:?}");
        assert!((0..3).all(|i| (bends[i] - second[i]).abs() < 1e-3 * scale), "{second:?} {bends:?}");
    }
}

/// True if the pairs have one common factor.
fn are_in_proportion(pairs: [[f64; 2]; 4]) -> bool {
    let ratios = pairs.map(|[a, b]| a / b);
    ratios.iter().all(|ratio| (ratio / ratios[0] - 1.0).abs() < 1e-3)
}

#[test]
fn weights_are_the_lobe_on_the_plane() {
    let mut checked = 0;
    for lit in lights(4401, 300).iter().filter(|lit| lit.vertices.iter().all(|v| v.z > 0.02)) {
        let (view, rectangle) = (View::new(lit.alpha(), lit.wo().to_array()), Rectangle::new(&corners(lit)));
        let [a, x, _, y] = corners(lit).map(DVec3::from_array);
        let normal = (x - a).cross(y - a).normalize();
        let ggx = Ggx { alpha_x: lit.at.alpha_x, alpha_y: lit.at.alpha_y };
        let matrix = DMat3::from_cols(DVec3::new(0.3, 0.1, 0.0), DVec3::new(0.0, 0.2, 0.1), a + x);
        let ltc = Ltc::new(matrix).expect("an LTC");
        let space = CosineSpace::from(&ltc);
        let (by_ggx, by_ltc) = (GgxLobe::new(&view, &rectangle), CosineLobe::new(&space, &rectangle));
        let points = [[0.1, 0.1], [0.4, 0.8], [0.5, 0.5], [0.9, 0.3]];
        let points = points.map(|[u, v]| [u * rectangle.size[0], v * rectangle.size[1]]);
        let share = |p: [f64; 2], value: &dyn Fn(DVec3) -> f64| {
            let place = DVec3::from_array(rectangle.at(p));
            value(place.normalize()) * normal.dot(place).abs() / place.length().powi(3)
        };
        let of_ggx = points.map(|p| [by_ggx.density(p), share(p, &|w| ggx.eval_cos(lit.wo(), w))]);
        assert!(are_in_proportion(of_ggx), "{of_ggx:?}");
        let there = points.map(|p| DVec3::from_array(space.of(rectangle.at(p))));
        if there.iter().all(|p| p.z > 0.05 * p.length()) {
            // The bump of an LTC is exact.
            let bump = by_ltc.bump();
            let density = |p| by_ltc.weight(&bump, p) / (1.0 + bump.quadratic(p)).powi(2);
            let of_ltc = points.map(|p| [density(p), share(p, &|w| ltc.pdf(w))]);
            assert!(are_in_proportion(of_ltc), "{of_ltc:?}");
            let exact = [0, 1, 2, 3].map(|i| [1.0 + bump.quadratic(points[i]), there[i].length_squared()]);
            assert!(are_in_proportion(exact), "{exact:?}");
            checked += 1;
        }
    }
    assert!(checked > 20, "{checked}");
}

#[test]
fn a_light_of_one_colour_is_lit_as_without_a_picture() {
    let colour = [0.25, 1.0, 3.0];
    // A table with a single entry of two lobes.
    let table = Table {
        matrix: vec![[0.3, 0.0, -0.4, 0.1, 0.2, 0.0, 0.2, 0.0, 0.9]],
        second: Some(vec![[0.5, 0.0, -0.6, 0.0, 0.3, 0.1, 0.0, 0.0, 0.7]]),
        terms: Some(Terms { amplitude: vec![0.75], fresnel: vec![0.25], edge: None }),
        ..cosine(BrdfKind::Ggx.into())
    };
    for size in [[1, 1], [37, 5], [64, 64]] {
        let image = LightImage::new(size[0], size[1], vec![colour; size[0] * size[1]]).expect("an image");
        let pyramid = LightPyramid::new(&image);
        for lit in lights(4402, 100) {
            let used = TableUse::default();
            let found = textured(&lit).by_table(&table, &lit.at, &pyramid, (used, Readings::Four)).expect("a surface");
            let plain = by_table_as(&table, &lit.at, &lit.light(Sides::Two), used).expect("a surface");
            for (i, channel) in colour.map(f64::from).into_iter().enumerate() {
                assert!((found.energy[i] - channel * plain.energy).abs() < 1e-6 * channel);
                assert!((found.fresnel[i] - channel * plain.fresnel).abs() < 1e-6 * channel);
            }
            for rule in NormalsRule::ALL {
                let found = textured(&lit).by_normals(&lit.at, &pyramid, (*rule, Readings::Four)).expect("a surface");
                let plain = by_normals(&lit.at, &lit.light(Sides::Two), *rule).expect("a surface");
                for (i, channel) in colour.map(f64::from).into_iter().enumerate() {
                    assert!((found.energy[i] - channel * plain.energy).abs() < 1e-6 * channel, "{rule}");
                    assert!((found.fresnel[i] - channel * plain.fresnel).abs() < 1e-6 * channel, "{rule}");
                }
            }
        }
    }
}

#[test]
fn texels_sum_to_the_light_and_pictures_are_near_the_truth() {
    let image = picture();
    let pyramid = LightPyramid::new(&image);
    let of_light = |lit: &Lit| {
        let light = textured(lit);
        let ones = LightImage::new(8, 8, vec![[1.0; 3]; 64]).expect("an image");
        let whole = light.truth(&lit.at, &ones, 1e-5).expect("sums to the light");
        let quadrature = truth(&lit.at, &lit.light(Sides::Two)).expect("a surface");
        assert!((whole.fresnel[0] - quadrature.fresnel).abs() < 1e-4, "{lit:?}");
        let wanted = light.truth(&lit.at, &image, 1e-4).expect("sums to the light");
        let found = light.by_normals(&lit.at, &pyramid, HOW).expect("a surface");
        [0, 1, 2].map(|i| (found.energy[i] - wanted.energy[i]).abs())
    };
    let errors: Vec<[f64; 3]> = lights(4403, 60).par_iter().map(of_light).collect();
    let mean = [0, 1, 2].map(|i| errors.iter().map(|error| error[i]).sum::<f64>() / errors.len() as f64);
    println!("mean errors of a dot, a checkerboard and a ramp: {mean:.4?}");
    assert!(mean.iter().all(|error| *error < 0.015), "{mean:?}");
}

/// A mirror shows the picture unchanged: the first texel at the first corner, its row towards the second corner.
#[test]
fn a_mirror_shows_the_picture() {
    let at = Configuration { alpha_x: 0.002, alpha_y: 0.002, theta: 0.0, phi: 0.0 };
    let quarters = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0; 3]];
    let texels = (0..64 * 64).map(|i| quarters[i % 64 / 32 + i / 64 / 32 * 2]).collect();
    let image = LightImage::new(64, 64, texels).expect("an image");
    let pyramid = LightPyramid::new(&image);
    for (place, wanted) in
        [([-0.4, 0.6], [1.0, 0.0, 0.0]), ([0.4, 0.6], [0.0, 1.0, 0.0]), ([-0.4, -0.6], [0.0, 0.0, 1.0])]
    {
        // Seen from above, a mirror reflects the point straight above the origin. This is the position on the light.
        let middle = DVec3::new(-place[0], -place[1], 1.0);
        let vertices = [[-1.0, 1.0], [1.0, 1.0], [1.0, -1.0], [-1.0, -1.0]];
        let vertices = vertices.map(|[x, y]| middle + DVec3::new(x, y, 0.0)).to_vec();
        let light = TexturedLight::new(PolygonLight::new(vertices, Sides::Two).expect("a light")).expect("a rectangle");
        let truth = light.truth(&at, &image, 1e-4).expect("sums to the light").energy;
        assert!((0..3).all(|i| (truth[i] - wanted[i]).abs() < 1e-2), "{truth:?} {wanted:?}");
        let found = light.by_normals(&at, &pyramid, HOW).expect("a surface").energy;
        assert!((0..3).all(|i| (found[i] - wanted[i]).abs() < 0.02), "{found:?} {wanted:?}");
    }
}

#[test]
fn colours_in_f32_match_f64() {
    let pyramid = LightPyramid::new(&picture());
    let of = |view: [f64; 3]| view.map(|x| x as f32);
    let mut far = 0;
    for lit in lights(4404, 2000) {
        let (alpha, wo) = (lit.alpha(), lit.wo().to_array());
        let (_, exact) = normals_readings(alpha, wo, &corners(&lit), Sides::Two, HOW);
        let alpha = alpha.map(|x| x as f32);
        let (_, single) = normals_readings(alpha, of(wo), &corners(&lit).map(of), Sides::Two, HOW);
        let widened: Vec<Reading<f64>> = single
            .iter()
            .map(|Reading { uv, radius, weight }| Reading {
                uv: uv.map(f64::from),
                radius: f64::from(*radius),
                weight: f64::from(*weight),
            })
            .collect();
        let [exact, single] = [exact, widened].map(|readings| colour(&readings, &pyramid));
        far += u32::from((0..3).any(|i| (exact[i] - single[i]).abs() > 1e-4));
    }
    println!("{far} of 2000 lights differ by more than 1e-4");
    assert_eq!(far, 0);
}

/// Bisects a path at the largest change of its light. Only rounding errors remain.
#[test]
fn jumps_along_random_paths_are_small() {
    let pyramid = LightPyramid::new(&picture());
    let most = |seed: u64| {
        let mut draw = Draw::new(4500 + seed);
        let lit = draw.lit_by(Roughness::All, [0.05, 1.2]);
        let axis = draw.vector().normalize();
        let [angle, phi] = [0.0, 0.0].map(|_: f64| draw.within(-1.0, 1.0));
        let theta = draw.within(0.0, 1.5);
        jump(|t| {
            let mut moved = lit.clone();
            let turn = DQuat::from_axis_angle(axis, angle * (t - 0.5));
            moved.vertices.iter_mut().for_each(|v| *v = turn * *v);
            moved.at.phi += 0.1 * phi * t;
            moved.at.theta += (theta - lit.at.theta) * 0.1 * t;
            textured(&moved).by_normals(&moved.at, &pyramid, HOW).expect("a surface").energy[0]
        })
    };
    let jumps: Vec<f64> = (0..300).into_par_iter().map(most).collect();
    let most = jumps.iter().copied().fold(0.0, f64::max);
    let large = jumps.iter().filter(|jump| **jump > 2e-4).count();
    println!("jumps by {most:.1e} at most; by more than 2e-4 on {large} of 300 paths");
    assert!(most < 1e-9, "{most}");
}

/// Tests lights of 0.001 to 20 radii, roughness from 1e-4 to 1, and views to 89.9 degrees.
#[test]
fn readings_are_within_the_picture() {
    let mut draw = Draw::new(4405);
    let mut checked = 0;
    for _ in 0..4000 {
        let lit = draw.lit_by(Roughness::Extreme, [0.001, 20.0]);
        let ltc = Ltc::new(DMat3::from_diagonal(DVec3::new(lit.at.alpha_x, lit.at.alpha_y, 1.0))).expect("an LTC");
        for number in Readings::ALL {
            let how = (NormalsRule::Balanced, *number);
            let (_, readings) = normals_readings(lit.alpha(), lit.wo().to_array(), &corners(&lit), Sides::Two, how);
            let by_ltc = ltc_readings(&CosineSpace::from(&ltc), &corners(&lit), *number);
            for reading in readings.iter().chain(&by_ltc) {
                assert!(reading.uv.iter().all(|x| (0.0..=1.0).contains(x)), "{lit:?} {reading:?}");
                assert!(reading.radius > 0.0 && reading.radius.is_finite(), "{lit:?} {reading:?}");
                assert!(reading.weight > 0.0 && reading.weight.is_finite(), "{lit:?} {reading:?}");
                checked += 1;
            }
        }
    }
    assert!(checked > 80_000, "{checked}");
}

/// Tests matrices that no fit produces: nearly of rank two or one, of any size, with lights far and near.
#[test]
fn degenerate_matrices_have_finite_readings() {
    fn check<T: Scalar + Into<f64>>(rows: [Triple<f64>; 3], corners: [Triple<f64>; 4]) {
        let of = |v: Triple<f64>| v.map(T::of);
        for Reading { uv, radius, weight } in
            ltc_readings(&CosineSpace::new(rows.map(of)), &corners.map(of), Readings::Four)
        {
            let [u, v, radius, weight]: [f64; 4] = [uv[0], uv[1], radius, weight].map(Into::into);
            assert!([u, v].iter().all(|x| (0.0..=1.0).contains(x)), "{rows:?} {corners:?}: {u} {v}");
            assert!(radius > 0.0 && radius.is_finite(), "{rows:?} {corners:?}: {radius}");
            assert!(weight > 0.0 && weight.is_finite(), "{rows:?} {corners:?}: {weight}");
        }
    }
    let mut draw = Draw::new(4407);
    for i in 0..4000 {
        let lit = draw.lit_by(Roughness::Extreme, [0.001, 20.0]);
        let [a, b, c] = [0; 3].map(|_| draw.vector().normalize());
        let little = if i % 2 == 0 { 0.0 } else { 10_f64.powf(draw.within(-12.0, 0.0)) };
        let rows = match i % 3 {
            0 => [a, b, a * draw.within(-1.0, 1.0) + c * little],
            1 => [a, a * draw.within(-1.0, 1.0) + b * little, a * draw.within(-1.0, 1.0) + c * little],
            _ => [a, b * little, c * little],
        };
        let far = 10_f64.powf(draw.within(-6.0, 6.0));
        let (rows, corners) = (rows.map(|row| row.to_array()), corners(&lit).map(|corner| corner.map(|x| x * far)));
        check::<f64>(rows, corners);
        check::<f32>(rows, corners);
    }
}

#[test]
fn lights_other_than_rectangles_are_refused() {
    let polygon = |corners: &[[f64; 2]]| {
        let vertices = corners.iter().map(|[x, y]| DVec3::new(*x, *y, 1.0)).collect();
        TexturedLight::new(PolygonLight::new(vertices, Sides::Two).expect("a light"))
    };
    let slanted = [[0.0, 0.0], [1.0, 0.0], [1.5, 1.0], [0.5, 1.0]];
    let open = [[0.0, 0.0], [1.0, 0.0], [1.2, 1.2], [0.0, 1.0]];
    for corners in [&slanted[..], &open, &slanted[..3]] {
        assert_eq!(polygon(corners), Err(LightError::NoRectangle));
    }
    let light = polygon(&[[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [0.0, 1.0]]).expect("a rectangle");
    let at = Configuration { alpha_x: 0.3, alpha_y: 0.3, theta: 2.0, phi: 0.0 };
    let pyramid = LightPyramid::new(&picture());
    assert!(matches!(light.by_normals(&at, &pyramid, HOW), Err(LightError::Domain { what: "theta", .. })));
    let no_terms = cosine(BrdfKind::Ggx.into());
    let at = Configuration { theta: 0.3, ..at };
    let how = (TableUse::default(), Readings::Four);
    assert_eq!(light.by_table(&no_terms, &at, &pyramid, how), Err(LightError::NoTerms));
}

/// If only one side is lit, either a light or the light with reversed corners is dark, for the model and for the truth.
#[test]
fn the_back_of_a_light_is_dark() {
    let image = picture();
    let pyramid = LightPyramid::new(&image);
    for lit in lights(4406, 30) {
        let [one, other] = [false, true].map(|is_turned| {
            let mut vertices = lit.vertices.clone();
            if is_turned {
                vertices.swap(1, 3);
            }
            let light = PolygonLight::new(vertices, Sides::One).expect("a light");
            let light = TexturedLight::new(light).expect("a rectangle");
            let truth = light.truth(&lit.at, &image, 1e-4).expect("sums to the light").energy;
            [light.by_normals(&lit.at, &pyramid, HOW).expect("a surface").energy, truth]
        });
        let (dark, lit) = if one[1] == [0.0; 3] { (one, other) } else { (other, one) };
        assert_eq!(dark, [[0.0; 3]; 2]);
        assert!(lit.iter().all(|channels| channels[2] > 0.0), "{lit:?}");
    }
}
