use std::f64::consts::{FRAC_PI_2, PI, TAU};

use glam::{DMat3, DVec3};
use proptest::prelude::*;
use rand_core::{Rng, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

use super::*;

/// Nodes and weights of Gauss-Legendre of order 8 on [-1, 1], those on one side.
const GAUSS: [(f64, f64); 4] = [
    (0.183_434_642_495_649_8, 0.362_683_783_378_362),
    (0.525_532_409_916_329, 0.313_706_645_877_887_3),
    (0.796_666_477_413_626_7, 0.222_381_034_453_374_5),
    (0.960_289_856_497_536_3, 0.101_228_536_290_376_3),
];

/// The part of `M c`, for clamped-cosine `c`, that falls into the polygon: for each azimuth of `c` the directions whose
/// image lies inside all edges' planes are an interval, and the cosine over it is known; the azimuth is summed by
/// Gauss's rule between the azimuths at which the interval's ends change. No edge integral, no clipping, no inverse.
fn quadrature(m: DMat3, polygon: &[DVec3]) -> f64 {
    let n = polygon.len();
    let inside = polygon.iter().sum::<DVec3>();
    let planes: Vec<DVec3> = (0..n)
        .map(|i| polygon[i].cross(polygon[(i + 1) % n]))
        .map(|plane| if plane.dot(inside) < 0.0 { -plane } else { plane })
        .map(|plane| m.transpose() * plane)
        .collect();
    let mut cuts: Vec<f64> = (0..=64).map(|i| f64::from(i) * TAU / 64.0).collect();
    let turned = |v: DVec3| v.y.atan2(v.x).rem_euclid(TAU);
    for (i, plane) in planes.iter().enumerate() {
        let along_horizon = DVec3::new(-plane.y, plane.x, 0.0);
        cuts.extend([turned(along_horizon), turned(-along_horizon)]);
        for other in &planes[..i] {
            let line = plane.cross(*other);
            cuts.extend([turned(line), turned(-line)]);
        }
    }
    cuts.sort_by(f64::total_cmp);
    let at = |azimuth: f64| {
        let (sin, cos) = azimuth.sin_cos();
        // Directions (t cos, t sin, 1) for t in [0, inf): each plane says slope t + z >= 0.
        let (mut low, mut high) = (0.0_f64, f64::INFINITY);
        for plane in &planes {
            let slope = plane.x * cos + plane.y * sin;
            if slope > 0.0 {
                low = low.max(-plane.z / slope);
            } else if slope < 0.0 {
                high = high.min(-plane.z / slope);
            } else if plane.z < 0.0 {
                return 0.0;
            }
        }
        // The cosine up to t is sin^2 / (2 pi) = t^2 / (1 + t^2) / (2 pi).
        let up_to = |t: f64| if t.is_finite() { t * t / (1.0 + t * t) } else { 1.0 };
        if high > low { (up_to(high) - up_to(low)) / TAU } else { 0.0 }
    };
    let between = |a: f64, b: f64| {
        let (middle, half) = (0.5 * (a + b), 0.5 * (b - a));
        GAUSS.iter().map(|(x, w)| w * half * (at(middle - half * x) + at(middle + half * x))).sum::<f64>()
    };
    cuts.windows(2).map(|pair| between(pair[0], pair[1])).sum()
}

/// A convex polygon on a plane through `centre`, inscribed in an ellipse.
fn polygon(centre: DVec3, axes: [DVec3; 2], mut angles: Vec<f64>) -> Vec<DVec3> {
    angles.sort_by(f64::total_cmp);
    angles.into_iter().map(|angle| centre + axes[0] * angle.cos() + axes[1] * angle.sin()).collect()
}

struct Draw(Xoshiro256PlusPlus);

impl Draw {
    fn within(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * ((self.0.next_u64() >> 11) as f64 / (1_u64 << 53) as f64)
    }

    fn vector(&mut self) -> DVec3 {
        DVec3::new(self.within(-1.0, 1.0), self.within(-1.0, 1.0), self.within(-1.0, 1.0))
    }

    fn polygon(&mut self) -> Vec<DVec3> {
        let count = 3 + (self.0.next_u64() % 6) as usize;
        let angles = (0..count).map(|_| self.within(0.0, TAU)).collect();
        let axes = [self.vector() * 2.0, self.vector() * 2.0];
        polygon(self.vector() * 2.0, axes, angles)
    }

    /// Every other one as of a lobe: sharp, needle-like, seen from anywhere.
    fn matrix(&mut self, i: usize) -> DMat3 {
        if i % 2 == 1 {
            return DMat3::from_cols(self.vector(), self.vector(), self.vector() + DVec3::Z);
        }
        let (alpha_x, alpha_y) = (10_f64.powf(self.within(-4.0, 0.0)), 10_f64.powf(self.within(-4.0, 0.0)));
        mirror_like(alpha_x, alpha_y, self.within(0.0, 1.55), self.within(0.0, TAU))
    }
}

/// The limit of a sharp lobe: `[2 alpha_x (v_z x + v_x z), 2 alpha_y (v_z y + v_y z), r]`, `r` the mirror direction.
fn mirror_like(alpha_x: f64, alpha_y: f64, theta: f64, phi: f64) -> DMat3 {
    let v = DVec3::new(theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos());
    DMat3::from_cols(
        2.0 * alpha_x * DVec3::new(v.z, 0.0, v.x),
        2.0 * alpha_y * DVec3::new(0.0, v.z, v.y),
        DVec3::new(-v.x, -v.y, v.z),
    )
}

#[test]
fn ten_thousand_polygons_agree_with_quadrature() {
    const TOLERANCE: f64 = 1e-4;
    let mut draw = Draw(Xoshiro256PlusPlus::seed_from_u64(4));
    let (mut clipped, mut lit) = (0, 0);
    for i in 0..10_000 {
        let (polygon, m) = (draw.polygon(), draw.matrix(i));
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

/// The closed form of a square patch seen from under a corner, as every text on form factors has it.
#[test]
fn a_square_above_has_the_form_factor_of_the_books() {
    let square = [(1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0)].map(|(x, y)| DVec3::new(x, y, 1.0));
    let root = 2.0_f64.sqrt();
    let wanted = 4.0 / PI * (1.0 / root) * (1.0 / root).atan();
    let cosine = Ltc::new(DMat3::IDENTITY).expect("regular");
    assert!((cosine.polygon(&square, Sides::One) - wanted).abs() < 1e-14);
}

#[test]
fn one_side_sees_what_the_other_does_not() {
    let cosine = Ltc::new(DMat3::IDENTITY).expect("regular");
    let mut square = [(1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0)].map(|(x, y)| DVec3::new(x, y, 1.0));
    let front = cosine.polygon(&square, Sides::One);
    assert!(front > 0.5);
    square.reverse();
    assert_eq!(cosine.polygon(&square, Sides::One), 0.0);
    assert_eq!(cosine.polygon(&square, Sides::Two), front);
    // A mirror image of the lobe sees the same side.
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

/// The integral in f32, with a matrix that was inverted and scaled as the shader does it.
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

/// Zero, the horizon, a right angle and their neighbours among ordinary numbers.
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
        // Any closed outline, degenerate ones too.
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
        // Degenerate slivers seen edge on lose digits, but no more than this.
        prop_assert!((f64::from(in_f32(m, &outline)).abs() - exact).abs() < 1e-3, "{}", exact);
    }
}
