//! Random polygons and matrices, and their integrals by an independent method.

use std::f64::consts::TAU;

use glam::{DMat3, DVec3};
use rand_core::{Rng, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

/// The positive nodes and their weights of the Gauss-Legendre rule of order 8 on [-1, 1].
const GAUSS: [(f64, f64); 4] = [
    (0.183_434_642_495_649_8, 0.362_683_783_378_362),
    (0.525_532_409_916_329, 0.313_706_645_877_887_3),
    (0.796_666_477_413_626_7, 0.222_381_034_453_374_5),
    (0.960_289_856_497_536_3, 0.101_228_536_290_376_3),
];

/// The fraction of `M c` inside the polygon, for a clamped cosine `c`. For each azimuth of `c`, the directions whose
/// image is inside all edge planes form an interval. The integral of the cosine over this interval has a closed form.
/// Gauss's rule integrates over the azimuth, separately between the azimuths at which the ends of the interval change.
/// The method has no edge integral, no clipping and no inverse.
#[must_use]
pub fn quadrature(m: DMat3, polygon: &[DVec3]) -> f64 {
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
        // Directions are (t cos, t sin, 1) for t in [0, inf). Each plane requires slope t + z >= 0.
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
        // The integral of the cosine up to t is sin^2 / (2 pi) = t^2 / (1 + t^2) / (2 pi).
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
#[must_use]
pub fn polygon(centre: DVec3, axes: [DVec3; 2], mut angles: Vec<f64>) -> Vec<DVec3> {
    angles.sort_by(f64::total_cmp);
    angles.into_iter().map(|angle| centre + axes[0] * angle.cos() + axes[1] * angle.sin()).collect()
}

/// `count` cases, the same in every run. Each case is a convex polygon of 3 to 8 vertices and a matrix. Every other
/// matrix resembles a lobe.
pub fn random_cases(count: usize) -> impl Iterator<Item = (Vec<DVec3>, DMat3)> {
    let mut draw = Draw(Xoshiro256PlusPlus::seed_from_u64(4));
    (0..count).map(move |i| (draw.polygon(), draw.matrix(i)))
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

    /// A random matrix. Every other matrix resembles a lobe: sharp, needle-like, seen from any direction.
    fn matrix(&mut self, i: usize) -> DMat3 {
        if i % 2 == 1 {
            return DMat3::from_cols(self.vector(), self.vector(), self.vector() + DVec3::Z);
        }
        let (alpha_x, alpha_y) = (10_f64.powf(self.within(-4.0, 0.0)), 10_f64.powf(self.within(-4.0, 0.0)));
        mirror_like(alpha_x, alpha_y, self.within(0.0, 1.55), self.within(0.0, TAU))
    }
}

/// The limit of a sharp lobe: `[2 alpha_x (v_z x + v_x z), 2 alpha_y (v_z y + v_y z), r]`, where `r` is the mirror
/// direction.
#[must_use]
pub fn mirror_like(alpha_x: f64, alpha_y: f64, theta: f64, phi: f64) -> DMat3 {
    let v = DVec3::new(theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos());
    DMat3::from_cols(
        2.0 * alpha_x * DVec3::new(v.z, 0.0, v.x),
        2.0 * alpha_y * DVec3::new(0.0, v.z, v.y),
        DVec3::new(-v.x, -v.y, v.z),
    )
}
