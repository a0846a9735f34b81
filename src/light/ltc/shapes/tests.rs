mod quadrature;

use std::f64::consts::{FRAC_PI_2, TAU};

use glam::{DMat3, DVec2, DVec3};
use proptest::prelude::*;
use rand_core::{Rng, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

use self::quadrature::{by_quadrature, line_by_quadrature};
use super::{super::cone::Horizon, *};
use ltcforge_fit::{cheap_form_factor, clipped_form_factor, lobe::ltc::cases::mirror_like};

fn space(ltc: &Ltc) -> CosineSpace<f64> {
    CosineSpace::from(ltc)
}

struct Draw(Xoshiro256PlusPlus);

impl Draw {
    fn new(seed: u64) -> Self {
        Self(Xoshiro256PlusPlus::seed_from_u64(seed))
    }

    fn within(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * ((self.0.next_u64() >> 11) as f64 / (1_u64 << 53) as f64)
    }

    fn vector(&mut self) -> DVec3 {
        DVec3::new(self.within(-1.0, 1.0), self.within(-1.0, 1.0), self.within(-1.0, 1.0))
    }

    /// A lobe with a roughness of at least `10^least`, seen from any direction.
    fn matrix(&mut self, least: f64) -> DMat3 {
        let (alpha_x, alpha_y) = (10_f64.powf(self.within(least, 0.0)), 10_f64.powf(self.within(least, 0.0)));
        mirror_like(alpha_x, alpha_y, self.within(0.0, 1.5), self.within(0.0, TAU))
    }

    /// A light of any size around the lobe.
    fn ellipse(&mut self, m: DMat3) -> (DVec3, [DVec3; 2]) {
        let towards = m * (self.vector() + 0.3 * DVec3::Z).normalize();
        let size = 10_f64.powf(self.within(-3.0, 1.0));
        (towards.normalize(), [self.vector() * size, self.vector() * size])
    }
}

#[test]
fn ellipses_agree_with_quadrature_wherever_they_are() {
    let mut draw = Draw::new(7);
    let (mut cut, mut above) = (0, 0);
    for _ in 0..1500 {
        let m = draw.matrix(-2.0);
        let (centre, half_axes) = draw.ellipse(m);
        let ltc = Ltc::new(m).expect("regular");
        let (found, wanted) = (space(&ltc).ellipse(centre, half_axes, Sides::Two), by_quadrature(m, centre, half_axes));
        let difference = (found - wanted).abs();
        assert!(difference < 1e-9, "{found} {wanted}: {m} {centre} {half_axes:?}");
        let cone = space(&ltc).cone(centre.to_array(), half_axes.map(|a| a.to_array())).expect("seen");
        match cone.horizon() {
            Horizon::Cuts { .. } => cut += usize::from(found > 1e-4),
            Horizon::Above => above += usize::from(found > 1e-4),
            Horizon::Below => assert_eq!(found, 0.0),
        }
    }
    assert!(cut > 300 && above > 300, "{cut} cut, {above} above");
}

#[test]
fn spheres_are_the_disks_that_are_seen_of_them() {
    let mut draw = Draw::new(8);
    let cosine = Ltc::new(DMat3::IDENTITY).expect("regular");
    for _ in 0..300 {
        let m = draw.matrix(-2.0);
        let centre = draw.ellipse(m).0 * 10_f64.powf(draw.within(-2.0, 2.0));
        let sine = draw.within(0.0, 1.0).powi(3);
        let (x, y) = centre.normalize().any_orthonormal_pair();
        let outline_axes = [x, y].map(|axis| axis * (sine * centre.length()));
        let disk = by_quadrature(m, centre * (1.0 - sine * sine).sqrt(), outline_axes);
        let ltc = Ltc::new(m).expect("regular");
        let found = space(&ltc).sphere(centre, sine * centre.length());
        assert!((found - disk).abs() < 1e-9, "{found} {disk}: {m} {centre} {sine}");
        assert_eq!(space(&ltc).sphere(centre, 1.0001 * centre.length()), 1.0);
        // The clamped cosine has a closed form for caps.
        let cap = sine * sine * clipped_form_factor(centre.normalize().z, sine * sine);
        let found = space(&cosine).sphere(centre, sine * centre.length());
        assert!((found - cap).abs() < 1e-12, "{found} {cap}");
    }
}

#[test]
fn lines_agree_with_quadrature() {
    let mut draw = Draw::new(9);
    let (mut cut, mut visible) = (0, 0);
    for _ in 0..1000 {
        let m = draw.matrix(-2.0);
        let (centre, [half, _]) = draw.ellipse(m);
        let ends = [centre - half, centre + half];
        let ltc = Ltc::new(m).expect("regular");
        let (found, wanted) = (space(&ltc).line(ends, 1e-3), line_by_quadrature(m, ends, 1e-3));
        assert!((found - wanted).abs() < 1e-9 * (1.0 + wanted), "{found} {wanted}: {m} {ends:?}");
        assert_eq!(found, space(&ltc).line([ends[1], ends[0]], 1e-3));
        let heights = ends.map(|end| (ltc.inverse() * end).z);
        cut += usize::from(heights[0] * heights[1] < 0.0 && wanted > 1e-5);
        visible += usize::from(heights[0] > 0.0 && heights[1] > 0.0 && wanted > 1e-5);
        // Compares with the limit of thin tubes and strips. The library's polygon of a line is a thin strip.
        let across = ends[0].cross(ends[1]).normalize() * 5e-7;
        let strip = ltc.polygon(&[ends[0] - across, ends[0] + across, ends[1] + across, ends[1] - across], Sides::Two);
        assert!((1e3 * strip - found).abs() < 2e-3 * found + 1e-6, "{strip} {found}");
    }
    assert!(cut > 100 && visible > 100, "{cut} {visible}");
    // A line towards the origin, through it, or below the horizon has no light.
    let cosine = Ltc::new(DMat3::IDENTITY).expect("regular");
    assert_eq!(space(&cosine).line([DVec3::Z, 2.0 * DVec3::Z], 0.1), 0.0);
    assert_eq!(space(&cosine).line([DVec3::NEG_X, DVec3::X], 0.1), 0.0);
    assert_eq!(space(&cosine).line([DVec3::ZERO, DVec3::ZERO], 0.1), 0.0);
    assert_eq!(space(&cosine).line([DVec3::new(-1.0, 0.0, -1.0), DVec3::new(1.0, 0.0, -1e-3)], 0.1), 0.0);
}

/// Points of a tube's outline, anticlockwise or clockwise: the hull of both spheres' circles, as directions.
fn outline_of_tube(ends: [DVec3; 2], radius: f64) -> Vec<DVec3> {
    let count = 3000;
    let nearest = {
        let along = ends[1] - ends[0];
        let foot = (-ends[0].dot(along) / along.length_squared()).clamp(0.0, 1.0);
        (ends[0] + along * foot).normalize()
    };
    let (x, y) = nearest.any_orthonormal_pair();
    let mut flat = Vec::new();
    for end in ends {
        let sine2 = radius * radius / end.length_squared();
        let (u, v) = end.normalize().any_orthonormal_pair();
        for i in 0..count {
            let (sin, cos) = (TAU * f64::from(i) / f64::from(count)).sin_cos();
            let p = end * (1.0 - sine2).sqrt() + (u * cos + v * sin) * radius;
            let depth = p.dot(nearest);
            assert!(depth > 0.0, "the tube is seen within a half space");
            flat.push(DVec2::new(p.dot(x), p.dot(y)) / depth);
        }
    }
    let hull = hull(flat);
    hull.into_iter().map(|p| x * p.x + y * p.y + nearest).collect()
}

fn hull(mut points: Vec<DVec2>) -> Vec<DVec2> {
    points.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
    let chain = |points: &mut dyn Iterator<Item = DVec2>| {
        let mut hull: Vec<DVec2> = Vec::new();
        for point in points {
            while let [.., a, b] = hull[..]
                && (b - a).perp_dot(point - b) >= 0.0
            {
                hull.pop();
            }
            hull.push(point);
        }
        hull.pop();
        hull
    };
    let upper = chain(&mut points.iter().copied());
    upper.into_iter().chain(chain(&mut points.iter().rev().copied())).collect()
}

#[test]
fn tubes_agree_with_their_outline_as_a_polygon() {
    let mut draw = Draw::new(10);
    let (mut visible, mut cut, mut alone) = (0, 0, 0);
    for _ in 0..400 {
        let m = draw.matrix(-2.0);
        let (centre, [half, _]) = draw.ellipse(m);
        let ends = [centre - half, centre + half];
        let nearest =
            (0..=1000).map(|i| ends[0].lerp(ends[1], f64::from(i) / 1000.0).length()).fold(f64::MAX, f64::min);
        // The polygon of both spheres' circles works only if the origin is far enough to see them from one side.
        let radius = nearest * draw.within(0.0, 0.9);
        if ends.iter().any(|end| end.normalize().dot(ends[0].lerp(ends[1], 0.5).normalize()) < 0.2) || radius == 0.0 {
            continue;
        }
        let outline = outline_of_tube(ends, radius);
        for mirror in [1.0, -1.0] {
            let m = m * DMat3::from_diagonal(DVec3::new(1.0, mirror, 1.0));
            let ltc = Ltc::new(m).expect("regular");
            let (found, wanted) = (space(&ltc).tube(ends, radius), ltc.polygon(&outline, Sides::Two));
            assert!((found - wanted).abs() < 2e-5, "{found} {wanted}: {m} {ends:?} {radius}");
            assert!((found - space(&ltc).tube([ends[1], ends[0]], radius)).abs() < 1e-12);
        }
        let inverse = m.inverse();
        let up = outline.iter().filter(|p| (inverse * **p).z > 0.0).count();
        let found = space(&Ltc::new(m).expect("regular")).tube(ends, radius);
        visible += usize::from(up == outline.len() && found > 1e-3);
        cut += usize::from(up > 0 && up < outline.len() && found > 1e-3);
        alone += usize::from(outline.len() >= 3000);
    }
    assert!(visible > 50 && cut > 50 && alone > 10, "{visible} {cut} {alone}");
    let cosine = Ltc::new(DMat3::IDENTITY).expect("regular");
    // From inside, the whole distribution is covered. A tube of zero length is a sphere, and a thin tube is a line.
    assert_eq!(space(&cosine).tube([DVec3::NEG_X, DVec3::new(1.0, 0.1, 0.0)], 0.2), 1.0);
    let (point, ends) = (DVec3::new(0.3, 0.2, 1.0), [DVec3::new(-0.5, 0.2, 1.0), DVec3::new(0.4, 0.1, -0.3)]);
    assert_eq!(space(&cosine).tube([point; 2], 0.4), space(&cosine).sphere(point, 0.4));
    let thin = [space(&cosine).tube(ends, 1e-5), space(&cosine).line(ends, 2e-5)];
    assert!((thin[0] / thin[1] - 1.0).abs() < 1e-4, "{thin:?}");
}

/// The map as in the shaders: in f32, divided by its largest number.
fn in_f32(m: DMat3) -> CosineSpace<f32> {
    let inverse = m.inverse();
    let scale = inverse.to_cols_array().into_iter().fold(0.0, |largest: f64, x| largest.max(x.abs()));
    CosineSpace::new((inverse * (1.0 / scale)).as_mat3().transpose().to_cols_array_2d())
}

fn single(v: DVec3) -> [f32; 3] {
    v.as_vec3().to_array()
}

/// Mean, 95th and 99.9th percentile and maximum.
fn figures(mut errors: Vec<f64>) -> [f64; 4] {
    errors.sort_by(f64::total_cmp);
    let n = errors.len();
    [errors.iter().sum::<f64>() / n as f64, errors[n * 95 / 100], errors[n * 999 / 1000], errors[n - 1]]
}

#[test]
fn f32_is_close_for_every_kind_of_light() {
    let mut draw = Draw::new(11);
    let mut errors: [Vec<f64>; 4] = std::array::from_fn(|_| Vec::new());
    for _ in 0..8000 {
        let m = draw.matrix(-2.0);
        let (centre, half_axes) = draw.ellipse(m);
        let (ltc, shader) = (Ltc::new(m).expect("regular"), in_f32(m));
        let ends = [centre - half_axes[0], centre + half_axes[0]];
        let radius = half_axes[1].length();
        let nearest = ends[0]
            .lerp(ends[1], (-ends[0].dot(ends[1] - ends[0]) / ends[0].distance_squared(ends[1])).clamp(0.0, 1.0))
            .length();
        let thin = radius.min(0.9 * nearest);
        let round = radius.min(0.99 * centre.length());
        let s = single;
        let pairs = [
            (
                shader.ellipse(s(centre), half_axes.map(s), Sides::Two),
                space(&ltc).ellipse(centre, half_axes, Sides::Two),
            ),
            (shader.sphere(s(centre), round as f32), space(&ltc).sphere(centre, round)),
            (shader.line(ends.map(s), 0.01), space(&ltc).line(ends, f64::from(0.01_f32))),
            (shader.tube(ends.map(s), thin as f32), space(&ltc).tube(ends, thin)),
        ];
        for (errors, (found, wanted)) in errors.iter_mut().zip(pairs) {
            assert!(found.is_finite());
            errors.push((f64::from(found) - wanted).abs());
        }
    }
    for (name, errors) in ["ellipse", "sphere", "line", "tube"].into_iter().zip(errors) {
        let [mean, _, most, max] = figures(errors);
        assert!(mean < 1e-7 && most < 3e-6 && max < 2e-5, "{name}: {mean:e} {most:e} {max:e}");
    }
}

fn hard() -> impl Strategy<Value = f64> {
    prop_oneof![
        -3.0..3.0,
        Just(0.0),
        Just(1.0),
        (-3_i64..3).prop_map(|ulps| ulps as f64 * 1e-16),
        -1e-6..1e-6,
        Just(1e4),
        Just(-1e-3)
    ]
}

fn hard_vector() -> impl Strategy<Value = DVec3> {
    prop::array::uniform3(hard()).prop_map(DVec3::from)
}

fn hard_matrix() -> impl Strategy<Value = DMat3> {
    let alpha = || prop_oneof![1e-5..1.0, Just(1e-4), Just(1.0), 1e-5..1e-3];
    let theta = prop_oneof![0.0..1.57, Just(0.0), Just(0.9999 * FRAC_PI_2)];
    (alpha(), alpha(), theta, prop_oneof![0.0..TAU, Just(0.0), Just(FRAC_PI_2)])
        .prop_map(|(alpha_x, alpha_y, theta, phi)| mirror_like(alpha_x, alpha_y, theta, phi))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1000))]

    /// Any vectors, including vectors without a light.
    #[test]
    fn never_negative_never_nan(
        m in hard_matrix(), centre in hard_vector(), x in hard_vector(), y in hard_vector(), radius in prop_oneof![0.0..2.0, Just(0.0), Just(1e-9), Just(1e4)],
    ) {
        if let Some(ltc) = Ltc::new(m) {
            for sides in [Sides::One, Sides::Two] {
                prop_assert!((0.0..=1.0).contains(&space(&ltc).ellipse(centre, [x, y], sides)));
            }
            for covered in [space(&ltc).sphere(centre, radius), space(&ltc).line([centre, x], radius), space(&ltc).tube([centre, x], radius)] {
                prop_assert!((0.0..=1.0).contains(&covered), "{}", covered);
            }
        }
        let (shader, s) = (in_f32(m), single);
        let radius = radius as f32;
        for covered in [
            shader.ellipse(s(centre), [s(x), s(y)], Sides::Two),
            shader.sphere(s(centre), radius),
            shader.line([s(centre), s(x)], radius),
            shader.tube([s(centre), s(x)], radius),
        ] {
            prop_assert!((0.0..=1.0).contains(&covered), "{}", covered);
        }
    }

    /// A light that moves by a millionth of its distance changes only slightly, in f64 and in f32.
    #[test]
    fn a_small_step_is_a_small_change(
        alpha_x in 0.05..1.0, alpha_y in 0.05..1.0, theta in 0.0..1.4, phi in 0.0..TAU, centre in prop::array::uniform3(-1.0..1.0),
        x in prop::array::uniform3(-1.0..1.0), y in prop::array::uniform3(-1.0..1.0), step in prop::array::uniform3(-1e-6..1e-6),
    ) {
        let m = mirror_like(alpha_x, alpha_y, theta, phi);
        let [centre, x, y, step] = [centre, x, y, step].map(DVec3::from);
        let (ltc, shader, s) = (Ltc::new(m).expect("regular"), in_f32(m), single);
        let size = 0.5 * centre.length();
        let half_axes = [x, y].map(|v| v.normalize() * size);
        let [before, after] = [DVec3::ZERO, step].map(|step| {
            let ends = [centre + step - half_axes[0], centre + step + half_axes[0]];
            [
                f64::from(shader.ellipse(s(centre + step), half_axes.map(s), Sides::Two)),
                f64::from(shader.sphere(s(centre + step), size as f32)),
                f64::from(shader.tube(ends.map(s), (0.5 * size) as f32)),
                space(&ltc).ellipse(centre + step, half_axes, Sides::Two),
                space(&ltc).sphere(centre + step, size),
                space(&ltc).tube(ends, 0.5 * size),
            ]
        });
        // The density is up to 1 / (pi 0.05^2), and the border of the light is one or two radians long.
        let most = 1000.0 * step.length() / centre.length() + 3e-5;
        for (before, after) in before.into_iter().zip(after) {
            prop_assert!((before - after).abs() < most, "{} {} {}", before, after, most);
        }
    }
}

/// Measures two common approximations. The first replaces an ellipse by an octagon of its area. The second replaces the
/// part of its form factor above the horizon by the part of a sphere of the same direction and size [Heitz and Hill
/// 2017]. This part has a closed form and a cheap fit.
#[test]
fn the_approximations_are_off_by_what_the_documents_say() {
    let mut draw = Draw::new(12);
    let mut errors: [[Vec<f64>; 3]; 2] = Default::default();
    for _ in 0..20_000 {
        let m = draw.matrix(-2.0);
        let (centre, [x, y]) = draw.ellipse(m);
        let ltc = Ltc::new(m).expect("regular");
        let exact = space(&ltc).ellipse(centre, [x, y], Sides::Two);
        let Some(cone) = space(&ltc).cone(centre.to_array(), [x, y].map(|axis| axis.to_array())) else {
            continue;
        };
        let is_cut = match cone.horizon() {
            Horizon::Cuts { .. } => true,
            Horizon::Above => false,
            Horizon::Below => continue,
        };
        let octagon = (0..8).map(|i| {
            let (sin, cos) = (TAU * (f64::from(i) + 0.5) / 8.0).sin_cos();
            centre + (x * cos + y * sin) * (TAU / 8.0 / (TAU / 8.0).sin()).sqrt()
        });
        let octagon = ltc.polygon(&octagon.collect::<Vec<_>>(), Sides::Two);
        let (length, cosine) = cone.form_factor();
        let sphere = length * clipped_form_factor(cosine, length);
        let cheap = length * cheap_form_factor(cosine, length);
        for (errors, found) in errors[usize::from(is_cut)].iter_mut().zip([octagon, sphere, cheap]) {
            errors.push((found - exact).abs());
        }
    }
    // Mean and 95th percentile, for lights above the horizon and for lights cut by it.
    let wanted = [[[8e-4, 4.4e-3], [2e-5, 0.0], [2.6e-3, 0.017]], [[1.5e-3, 5.9e-3], [4.4e-3, 0.0184], [0.033, 0.123]]];
    for (errors, wanted) in errors.into_iter().zip(wanted) {
        for (errors, wanted) in errors.into_iter().zip(wanted) {
            let [mean, p95, ..] = figures(errors);
            for (found, wanted) in [mean, p95].into_iter().zip(wanted) {
                assert!((found - wanted).abs() <= 0.1 * wanted + 1e-9, "{found} {wanted}");
            }
        }
    }
}
