//! Eight sets of random lights on GGX, for variances of samplers, and a quadrature over the solid angle of a light.
//!
//! Roughness is 0.05 to 0.5, its logarithm uniform, and the ratio of both axes 0.1 to 1. Views are up to 80 degrees. A
//! rectangle at distance one faces the surface roughly, around a direction that a visible normal reflects. Its half
//! sizes are 0.1 to 0.5, times a factor from 0.6 to 1.65 for one side and divided by it for the other. Each set changes
//! some of this.

use std::f64::consts::TAU;

use glam::DVec3;

use crate::cases::{Draw, Lit};
use ltcforge_fit::{
    Configuration,
    brdf::{Brdf, Ggx},
    math::{direction, sin_cos},
};

/// A set of random lights.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LightSet {
    /// Equal roughness along both axes.
    Isotropic,
    /// Ratio 0.1 to 0.5.
    Anisotropic,
    /// Roughness 0.01 to 0.1.
    Sharp,
    /// Roughness 0.5 to 1, ratio 0.5 to 1.
    Rough,
    /// Views at 75 to 85 degrees.
    Grazing,
    /// The surface cuts the light.
    Cut,
    /// One side is 16 to 64 times as long as the other.
    Strip,
    /// Half sizes 0.02 to 0.1.
    Small,
    /// Not among the eight: roughness 0.05 to 1, ratio 0.01 to 0.1, half sizes 0.05 to 1.2, views up to 88 degrees.
    Needle,
}

impl LightSet {
    /// The eight sets.
    pub const EIGHT: [Self; 8] = [
        Self::Isotropic,
        Self::Anisotropic,
        Self::Sharp,
        Self::Rough,
        Self::Grazing,
        Self::Cut,
        Self::Strip,
        Self::Small,
    ];

    /// A random light of the set.
    pub fn draw(self, draw: &mut Draw) -> Lit {
        let log = |draw: &mut Draw, [low, high]: [f64; 2]| draw.within(f64::ln(low), f64::ln(high)).exp();
        loop {
            let roughness = match self {
                Self::Sharp => [0.01, 0.1],
                Self::Rough => [0.5, 1.0],
                Self::Needle => [0.05, 1.0],
                _ => [0.05, 0.5],
            };
            let ratio = match self {
                Self::Isotropic => [1.0, 1.0],
                Self::Anisotropic => [0.1, 0.5],
                Self::Rough => [0.5, 1.0],
                Self::Needle => [0.01, 0.1],
                _ => [0.1, 1.0],
            };
            let long = log(draw, roughness);
            let short = long * draw.within(ratio[0], ratio[1]);
            let [alpha_x, alpha_y] = if draw.within(0.0, 1.0) < 0.5 { [long, short] } else { [short, long] };
            let [least, most] = match self {
                Self::Grazing => [75.0, 85.0],
                Self::Needle => [0.0, 88.0],
                _ => [0.0, 80.0],
            };
            let theta = draw.within(least, most).to_radians();
            let at = Configuration { alpha_x, alpha_y, theta, phi: draw.within(0.0, TAU) };
            let u = [draw.within(0.0, 1.0), draw.within(0.0, 1.0)];
            let centre = Ggx { alpha_x, alpha_y }.sample(direction(at.theta, at.phi), u).wi;
            if centre.z < 0.0 {
                continue;
            }
            let size = match self {
                Self::Small => [0.02, 0.1],
                Self::Needle => [0.05, 1.2],
                _ => [0.1, 0.5],
            };
            let size = log(draw, size);
            let aspect = if self == Self::Strip { log(draw, [4.0, 8.0]) } else { log(draw, [0.6, 1.65]) };
            let normal = (-centre + 0.5 * draw.vector()).normalize();
            let x = normal.cross(draw.vector()).normalize();
            let (x, y) = (x * size * aspect, normal.cross(x) * size / aspect);
            let vertices: Vec<DVec3> = vec![centre - x - y, centre + x - y, centre + x + y, centre - x + y];
            if self != Self::Cut || vertices.iter().any(|v| v.z < 0.0) {
                return Lit { at, vertices };
            }
        }
    }
}

/// The rectangle, or a polygon with 3 to 8 corners on the ellipse within it.
///
/// # Panics
/// If the light is not a rectangle.
#[must_use]
pub fn cornered(lit: &Lit, count: usize) -> Lit {
    if count == 4 {
        return lit.clone();
    }
    let [a, b, _, d] = lit.vertices[..] else { panic!("a rectangle") };
    let (middle, x, y) = ((b + d) * 0.5, (b - a) * 0.5, (d - a) * 0.5);
    let at = |k: usize| {
        let (sin, cos) = sin_cos(TAU * (k as f64 + 0.4) / count as f64);
        middle + x * cos + y * sin
    };
    Lit { at: lit.at, vertices: (0..count).map(at).collect() }
}

/// The triangles of the part above the surface.
#[must_use]
pub fn triangles(vertices: &[DVec3]) -> Vec<[DVec3; 3]> {
    let mut above: Vec<DVec3> = Vec::new();
    for (i, a) in vertices.iter().enumerate() {
        let b = vertices[(i + 1) % vertices.len()];
        if a.z >= 0.0 {
            above.push(*a);
        }
        if a.z * b.z < 0.0 {
            above.push(a.lerp(b, a.z / (a.z - b.z)));
        }
    }
    (2..above.len()).map(|i| [above[0], above[i - 1], above[i]]).collect()
}

/// The integral of `of` over the solid angle of a triangle: Gauss' rule on both halves of the longest side, until it
/// agrees with the rule on the whole triangle.
pub fn over_triangle(of: &impl Fn(DVec3) -> f64, [a, b, c]: [DVec3; 3], depth: u32) -> f64 {
    // Five-point rule of degree 9 along both axes of the triangle, folded at `a`.
    const NODES: [(f64, f64); 5] = [
        (0.046_910_077_030_668, 0.118_463_442_528_094_5),
        (0.230_765_344_947_158_5, 0.239_314_335_249_683_2),
        (0.5, 0.284_444_444_444_444_4),
        (0.769_234_655_052_841_5, 0.239_314_335_249_683_2),
        (0.953_089_922_969_332, 0.118_463_442_528_094_5),
    ];
    let rule = |[a, b, c]: [DVec3; 3]| {
        let area = (b - a).cross(c - a);
        let mut sum = 0.0;
        for (s, weight) in NODES {
            for (t, other) in NODES {
                let p = a + s * ((b - a) + t * (c - b));
                let r = p.length();
                sum += weight * other * s * of(p / r) * p.dot(area).abs() / (r * r * r);
            }
        }
        sum
    };
    let lengths = [(b - c).length(), (c - a).length(), (a - b).length()];
    let [a, b, c] = match (0..3).max_by(|i, j| lengths[*i].total_cmp(&lengths[*j])) {
        Some(0) => [a, b, c],
        Some(1) => [b, c, a],
        _ => [c, a, b],
    };
    let middle = b.midpoint(c);
    let halves = [[a, b, middle], [a, middle, c]];
    let [whole, parts] = [rule([a, b, c]), halves.map(rule).iter().sum()];
    if depth == 0 || (depth < 12 && (whole - parts).abs() < 1e-9) {
        return parts;
    }
    halves.map(|half| over_triangle(of, half, depth - 1)).iter().sum()
}
