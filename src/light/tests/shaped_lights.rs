//! Compares the truth of disks, spheres, tubes and lines with sums over their surfaces and with every model.

use std::f64::consts::TAU;

use glam::DVec3;
use rayon::prelude::*;

use crate::cases::{Draw, Roughness};
use crate::{
    CosineSpace, Gaussian, LightError, LightShape, NormalsRule, ReflectedLight, ShapedLight, by_gaussian, by_normals,
    by_table, truth, truth_within,
};
use ltcforge_fit::{
    BrdfKind, Configuration, Layout, LobeModel, Ltc, PerAxis, Sides, Table, Terms,
    brdf::{Brdf, Ggx},
    math::direction,
};

/// A light with the numbers of its shape.
#[derive(Debug, Clone, Copy)]
pub(super) enum Case {
    Ellipse(DVec3, [DVec3; 2]),
    Sphere(DVec3, f64),
    Tube([DVec3; 2], f64),
    Line([DVec3; 2], f64),
}

impl Case {
    pub(super) fn light(&self) -> Result<ShapedLight, LightError> {
        match *self {
            Self::Ellipse(centre, half_axes) => ShapedLight::ellipse(centre, half_axes, Sides::Two),
            Self::Sphere(centre, radius) => ShapedLight::sphere(centre, radius),
            Self::Tube(ends, radius) => ShapedLight::tube(ends, radius),
            Self::Line(ends, width) => ShapedLight::line(ends, width),
        }
    }

    /// The reflected light, energy and Schlick's part, by the midpoint rule over the surface of the light with `n` by
    /// `n` cells per part. Evaluates the BRDF directly.
    pub(super) fn by_sum(&self, brdf: &dyn Brdf, wo: DVec3, n: u32) -> [f64; 2] {
        let mut sum = [0.0; 2];
        // Adds a piece of the surface with a solid angle.
        let mut add = |place: DVec3, solid_angle: f64| {
            let wi = place.normalize();
            let energy = brdf.eval_cos(wo, wi) * solid_angle;
            let cosine = wo.dot((wo + wi).normalize()).min(1.0);
            sum = [sum[0] + energy, sum[1] + energy * (1.0 - cosine).powi(5)];
        };
        let middle = |i: u32| (f64::from(i) + 0.5) / f64::from(n);
        let cells = (0..n).flat_map(|i| (0..n).map(move |j| [middle(i), middle(j)]));
        let solid_angle_of = |place: DVec3, area: DVec3| (-place).dot(area).max(0.0) / place.length().powi(3);
        let share = 1.0 / f64::from(n * n);
        // A cap or a whole sphere. Its heights along `axis` are uniform, which gives equal areas.
        let mut sphere = |centre: DVec3, radius: f64, axis: DVec3, [low, high]: [f64; 2]| {
            let (x, y) = axis.any_orthonormal_pair();
            for [u, v] in cells.clone() {
                let (height, (sin, cos)) = (low + (high - low) * u, (TAU * v).sin_cos());
                let outwards = axis * height + (x * cos + y * sin) * (1.0 - height * height).sqrt();
                let area = outwards * (TAU * (high - low) * radius * radius * share);
                add(centre + outwards * radius, solid_angle_of(centre + outwards * radius, area));
            }
        };
        match *self {
            Self::Ellipse(centre, [x, y]) => {
                let normal = x.cross(y) * -centre.dot(x.cross(y)).signum();
                for [u, v] in cells {
                    let (sin, cos) = (TAU * v).sin_cos();
                    let place = centre + (x * cos + y * sin) * u;
                    add(place, solid_angle_of(place, normal * (TAU * u * share)));
                }
            }
            // The visible part of a sphere is the cap in front of the circle of its tangents.
            Self::Sphere(centre, radius) => {
                sphere(centre, radius, -centre.normalize(), [radius / centre.length(), 1.0]);
            }
            Self::Tube(ends @ [from, to], radius) => {
                let axis = (to - from).normalize();
                sphere(from, radius, -axis, [0.0, 1.0]);
                sphere(to, radius, axis, [0.0, 1.0]);
                let (x, y) = axis.any_orthonormal_pair();
                for [u, v] in cells {
                    let (sin, cos) = (TAU * v).sin_cos();
                    let outwards = x * cos + y * sin;
                    let place = ends[0].lerp(ends[1], u) + outwards * radius;
                    add(place, solid_angle_of(place, outwards * (TAU * radius * from.distance(to) * share)));
                }
            }
            Self::Line([from, to], width) => {
                let count = n * n;
                for i in 0..count {
                    let place = from.lerp(to, (f64::from(i) + 0.5) / f64::from(count));
                    add(place, width * from.cross(to).length() / place.length().powi(3) / f64::from(count));
                }
            }
        }
        sum
    }
}

/// A light of each shape around a direction that the lobe reflects, at distance one.
pub(super) fn cases(draw: &mut Draw, centre: DVec3) -> [Case; 4] {
    let [x, y] = [0; 2].map(|_: u32| draw.vector() * draw.within(0.05, 0.6));
    let half = draw.vector().normalize() * draw.within(0.05, 1.0);
    let ends = [centre - half, centre + half];
    [
        Case::Ellipse(centre, [x, y]),
        Case::Sphere(centre, draw.within(0.05, 0.6)),
        Case::Tube(ends, draw.within(0.02, 0.4)),
        Case::Line(ends, draw.within(0.001, 0.01)),
    ]
}

/// Surfaces that a sum of some 10^5 cells resolves, each with a light of each shape.
fn broad(seed: u64, count: usize) -> Vec<(Configuration, Case)> {
    let mut draw = Draw::new(seed);
    let mut found = Vec::new();
    while found.len() < 4 * count {
        let lit = draw.lit(Roughness::All);
        let centre = lit.vertices[0].midpoint(lit.vertices[2]);
        if lit.at.alpha_x.min(lit.at.alpha_y) > 0.15 {
            found.extend(cases(&mut draw, centre).map(|case| (lit.at, case)));
        }
    }
    found
}

/// The error of the sum falls to a quarter from 150 to 300 cells. It falls more slowly if a horizon or an outline cuts
/// cells.
#[test]
fn the_truth_is_the_sum_over_a_lights_surface() {
    let errors: Vec<(Case, f64)> = broad(81, 60)
        .into_par_iter()
        .filter_map(|(at, case)| {
            let light = case.light().ok()?;
            let found = truth(&at, &light).expect("a surface");
            let (ggx, wo) = (Ggx { alpha_x: at.alpha_x, alpha_y: at.alpha_y }, direction(at.theta, at.phi));
            let [coarse, fine] = [150, 300].map(|n| case.by_sum(&ggx, wo, n));
            let off = |found: f64, i: usize| (found - fine[i]).abs() - (fine[i] - coarse[i]).abs();
            assert!(found.fresnel <= found.energy, "{found:?}");
            Some((case, off(found.energy, 0).max(off(found.fresnel, 1))))
        })
        .collect();
    assert!(errors.len() > 200, "{}", errors.len());
    let (case, worst) = errors.iter().max_by(|a, b| a.1.total_cmp(&b.1)).expect("cases");
    println!("error beyond the change of the sum: {worst:.1e}, {case:?}");
    assert!(*worst < 1e-5, "{case:?}: {worst}");
}

/// A lower tolerance changes the result by at most the higher tolerance, also for mirrors and needles.
#[test]
fn the_truth_of_shapes_converges() {
    let mut draw = Draw::new(82);
    let cases: Vec<(Configuration, Case)> = (0..60)
        .flat_map(|_| {
            let lit = draw.lit(Roughness::Extreme);
            let centre = lit.vertices[0].midpoint(lit.vertices[2]);
            cases(&mut draw, centre).map(|case| (lit.at, case))
        })
        .collect();
    let worst = cases
        .par_iter()
        .filter_map(|(at, case)| Some((at, case, case.light().ok()?)))
        .map(|(at, case, light)| {
            let [rough, fine] = [1e-6, 1e-10].map(|t| truth_within(t, at, &light).expect("a surface"));
            assert!((rough.energy - fine.energy).abs() < 1e-5, "{rough:?} {fine:?} {at:?} {case:?}");
            let usual = truth(at, &light).expect("a surface");
            (usual.energy - fine.energy).abs().max((usual.fresnel - fine.fresnel).abs())
        })
        .reduce(|| 0.0, f64::max);
    println!("worst change {worst:.1e}");
    assert!(worst < 1e-8, "{worst}");
}

/// The polygon of a shape's outline has the same truth.
#[test]
fn the_truth_of_a_shape_is_near_that_of_its_outline() {
    let errors: Vec<f64> = broad(83, 50)
        .into_par_iter()
        .filter_map(|(at, case)| {
            let light = case.light().ok()?;
            let outline = light.outline().expect("an outline");
            let [exact, polygon] = [truth_within(1e-7, &at, &light), truth_within(1e-7, &at, &outline)];
            let (exact, polygon) = (exact.expect("a surface").energy, polygon.expect("a surface").energy);
            assert!((exact - polygon).abs() < 3e-3 * exact + 1e-3, "{exact} {polygon} {case:?}");
            Some((exact - polygon).abs())
        })
        .collect();
    let mean = errors.iter().sum::<f64>() / errors.len() as f64;
    assert!(errors.len() > 150 && mean < 5e-4, "{mean}");
}

/// A table with a single entry of this matrix and lobe model.
fn table(matrix: [f64; 9], lobe: LobeModel) -> Table {
    Table {
        brdf: BrdfKind::Ggx.into(),
        lobe,
        layout: Layout::Kt2022,
        axes: PerAxis { alpha: vec![1.0], ratio: vec![1.0], theta: vec![0.0], phi: vec![0.0] },
        matrix: vec![matrix.map(|x| x as f32)],
        terms: Some(Terms { amplitude: vec![0.75], fresnel: vec![0.25], edge: None }),
        second: None,
        node_error: vec![0.0],
    }
}

#[test]
fn a_table_lights_by_the_shape_and_other_models_by_its_outline() {
    let rows = [0.5, 0.0, 0.25, 0.0, 0.375, 0.0, 0.0, 0.0, 1.0];
    let ltc = Ltc::new(ltcforge_fit::math::from_row_major(&rows)).expect("regular");
    let space = CosineSpace::from(&ltc);
    let at = Configuration { alpha_x: 1.0, alpha_y: 1.0, theta: 0.0, phi: 0.0 };
    let mut shapes = Vec::new();
    for (_, case) in broad(84, 10) {
        let Ok(light) = case.light() else { continue };
        shapes.push(light.shape());
        let covered = match case {
            Case::Ellipse(centre, half_axes) => space.ellipse(centre, half_axes, Sides::Two),
            Case::Sphere(centre, radius) => space.sphere(centre, radius),
            Case::Tube(ends, radius) => space.tube(ends, radius),
            Case::Line(ends, width) => space.line(ends, width),
        };
        let wanted = ReflectedLight { energy: 0.75 * covered, fresnel: 0.25 * covered };
        let found = by_table(&table(rows, LobeModel::Ltc), &at, &light).expect("a lobe");
        let off = (found.energy - wanted.energy).abs().max((found.fresnel - wanted.fresnel).abs());
        assert!(off < 1e-12, "{case:?}: {found:?} {wanted:?}");
        let outline = light.outline().expect("an outline");
        let asg = table(rows, LobeModel::Asg);
        let model = Gaussian::Asg;
        assert_eq!(by_normals(&at, &light, NormalsRule::Balanced), by_normals(&at, &outline, NormalsRule::Balanced));
        assert_eq!(by_gaussian(&at, &light, model), by_gaussian(&at, &outline, model));
        assert_eq!(by_table(&asg, &at, &light), by_table(&asg, &at, &outline));
    }
    assert!(LightShape::ALL[1..].iter().all(|shape| shapes.contains(shape)), "{shapes:?}");
}

/// Tests numbers near the limits of f64, one-sided lights, and invalid lights.
#[test]
fn shapes_at_the_ends_of_the_range() {
    let at = Configuration { alpha_x: 0.4, alpha_y: 0.15, theta: 0.8, phi: 0.3 };
    let (centre, x, y) = (DVec3::new(-0.8, 0.1, 1.0), 0.4 * DVec3::X, 0.3 * DVec3::Y);
    let energy =
        |light: Result<ShapedLight, LightError>| truth(&at, &light.expect("a light")).expect("a surface").energy;
    for scale in [1e300, 1e-300] {
        let same = |a: f64, b: f64| assert!((a - b).abs() < 1e-9 && a > 0.001, "{scale}: {a} {b}");
        let disk = |scale: f64| energy(ShapedLight::ellipse(centre * scale, [x * scale, y * scale], Sides::Two));
        same(disk(1.0), disk(scale));
        let tube = |scale: f64| energy(ShapedLight::tube([centre * scale, (centre + x) * scale], 0.2 * scale));
        same(tube(1.0), tube(scale));
        let line = |scale: f64| energy(ShapedLight::line([centre * scale, (centre + x) * scale], 0.02 * scale));
        same(line(1.0), line(scale));
    }
    let [lit, dark] = [[y, x], [x, y]].map(|half| energy(ShapedLight::ellipse(centre, half, Sides::One)));
    let both = energy(ShapedLight::ellipse(centre, [x, y], Sides::Two));
    assert!((lit - both).abs() < 1e-9 && dark == 0.0 && lit > 0.01, "{lit} {dark} {both}");
    // A tube of zero length is a sphere. If the rest of a tube is behind its nearer end, this end hides the rest.
    let sphere = energy(ShapedLight::sphere(centre, 0.3));
    for beyond in [centre, 1.5 * centre] {
        let tube = energy(ShapedLight::tube([centre, beyond], 0.3));
        assert!((tube - sphere).abs() < 1e-9, "{tube} {sphere}");
    }
    assert_eq!(energy(ShapedLight::line([centre, 2.0 * centre], 0.1)), 0.0);
    assert_eq!(energy(ShapedLight::sphere(-centre, 0.3)), 0.0);
    let nan = DVec3::new(0.0, f64::NAN, 1.0);
    for refused in [
        ShapedLight::ellipse(nan, [x, y], Sides::One),
        ShapedLight::ellipse(centre, [x, nan], Sides::One),
        ShapedLight::sphere(centre, f64::INFINITY),
        ShapedLight::sphere(centre, 0.0),
        ShapedLight::tube([centre, nan], 0.1),
        ShapedLight::tube([centre, x], -0.1),
        ShapedLight::line([centre, x], f64::NAN),
        ShapedLight::line([centre, centre], 0.1),
    ] {
        assert!(matches!(refused, Err(LightError::Domain { .. })), "{refused:?}");
    }
    assert_eq!(ShapedLight::ellipse(centre, [x, -2.0 * x], Sides::One), Err(LightError::Flat));
    assert_eq!(ShapedLight::ellipse(centre, [x, DVec3::ZERO], Sides::One), Err(LightError::Flat));
    for inside in [
        ShapedLight::ellipse(DVec3::new(0.1, 0.1, 0.0), [x, y], Sides::Two),
        ShapedLight::sphere(centre, 1.3),
        ShapedLight::tube([centre, -centre], 0.01),
        ShapedLight::tube([centre, -x], 0.41),
        ShapedLight::line([centre, -2.0 * centre], 0.01),
    ] {
        assert_eq!(inside, Err(LightError::Inside));
    }
    assert!(ShapedLight::ellipse(DVec3::new(0.41, 0.0, 0.0), [x, y], Sides::Two).is_ok());
}
