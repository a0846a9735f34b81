//! Eight sets of random lights on GGX, for variances of samplers.
//!
//! Roughness is 0.05 to 0.5, its logarithm uniform, and the ratio of both axes 0.1 to 1. Views are up to 80 degrees. A
//! rectangle at distance one faces the surface roughly, around a direction that a visible normal reflects. Its half
//! sizes are 0.1 to 0.5, times a factor from 0.6 to 1.65 for one side and divided by it for the other. Each set changes
//! some of this.

use glam::DVec3;

use crate::cases::{Draw, Lit};
use ltcforge_fit::{
    Configuration,
    brdf::{Brdf, Ggx},
    math::direction,
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
            let at = Configuration { alpha_x, alpha_y, theta, phi: draw.within(0.0, std::f64::consts::TAU) };
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
