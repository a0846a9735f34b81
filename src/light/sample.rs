//! Draws directions to a polygon light where GGX or an LTC reflects it, and computes their exact density.
//!
//! A linear map `y(p)` transforms the corners of the light. Directions are uniform over the solid angle W of the
//! transformed polygon:
//!
//! ```text
//! pdf(wi) = |det y| / (W |y(wi)|^3)
//! ```
//!
//! # Map of GGX
//!
//! GGX reflects `p` by the stretched normal `c ~ A^-1 (|p| wo + p)`, `A = diag(alpha_x, alpha_y, 1)`. This is linear in
//! `p` except for `|p|`. Let `h` be a normal in the middle of the light, `d = h . wo`, and `q = 2 d h - wo` the
//! direction that `h` reflects. `q . p` is the tangent of `|p|` at `q`, and replaces it:
//!
//! ```text
//! y = T A^-1 (I + wo q^T),   T = sqrt(2) I + (1 - sqrt(2)) s s^T,   s = A wo / |A wo|
//! det y = 2 / (alpha_x alpha_y) (1 + q . wo) = 4 d^2 / (alpha_x alpha_y)
//! ```
//!
//! The visible normals have the density `max(s . c, 0)` per solid angle of c. T makes a uniform solid angle resemble
//! this cosine: over the hemisphere, the relative variance of `(s . c) |T c|^3` is 0.12, and 0.33 without T.
//!
//! `h` comes from a first map with `c = s + z`, the middle of all visible normals. The vector irradiance of the
//! transformed light, in the space of c, points to the middle of the light. Two corrections limit errors of the
//! tangent:
//!
//! - `c` moves towards `s` by [`TOWARDS_VIEW`] times the part of the hemisphere that the light covers. Large lights then
//!   get fewer samples near the horizon.
//! - Highlights on brushed metal bend, and a linear map does not. The second map has a roughness larger by
//!   `BEND size max(alpha)^2 |wo|`, per axis. The samples of large lights then cover the whole highlight.
//!
//! An LTC has the map `diag(sqrt(2), sqrt(2), 1) M^-1`. Each triangle of a fan is sampled by its solid angle [Arvo 1995].

use std::f64::consts::{SQRT_2, TAU};

use glam::{DMat3, DVec3};

use super::{LightError, PolygonLight, rules::surface_and_view};
use ltcforge_fit::{
    Configuration, Sides,
    math::{atan2, sin_cos},
};

/// The least cosine between the view and the normal `h`.
const LEAST_COSINE: f64 = 1e-5;
/// The least cosine between `s` and `c`.
const LEAST_TURN: f64 = 0.3;
/// How far `c` moves towards `s` for a light that covers a hemisphere. With 0, the mean variance of the eight sets in
/// `sample/sets.rs` is 1.4 times as large. From 3 to 6 it hardly changes.
const TOWARDS_VIEW: f64 = 4.0;
/// The additional roughness of the map. With 0, the mean variance of set `Needle` is 1.6 times as large, because of a few
/// lights. From 0.2 to 0.4, the mean of the eight sets changes by 1 %.
const BEND: f64 = 0.3;

/// A map of directions, its inverse, and the absolute value of its determinant.
#[derive(Debug, Clone, Copy)]
struct Map {
    to: DMat3,
    back: DMat3,
    det: f64,
}

/// A polygon light as seen from a surface, ready to draw directions.
#[derive(Debug, Clone)]
pub struct LightSampler {
    map: Map,
    /// The part above the surface, in the space of the map: unit vectors. The first is the tip of the fan.
    corners: Vec<DVec3>,
    /// Half of the solid angle of each triangle of the fan.
    halves: Vec<f64>,
    total: f64,
}

/// A direction and its density per steradian.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SampledDirection {
    /// The direction, of unit length.
    pub wi: DVec3,
    /// The density, above zero.
    pub pdf: f64,
}

impl LightSampler {
    /// Samples where GGX reflects the light, without a table.
    ///
    /// # Errors
    /// [`LightError::Domain`] for a roughness outside [0, 1] or a view direction on or below the horizon,
    /// [`LightError::NotPlanar`].
    pub fn normals(at: &Configuration, light: &PolygonLight) -> Result<Self, LightError> {
        let (alpha, wo) = surface_and_view(at)?;
        let visible = above_surface(light)?;
        let s = stretched(alpha, wo);
        let lobe = normals_map(alpha, wo, s, s + DVec3::Z);
        let corners = transformed(&lobe, &visible);
        let sum: DVec3 = corners.iter().sum();
        let flux: DVec3 = ends(&corners).map(|(a, b)| a.cross(b) * angle_per_sine(a, b)).sum();
        let flux = if flux.dot(sum) < 0.0 { -flux } else { flux } + 1e-4 * sum;
        // T^-1 flux
        let middle = flux / SQRT_2 + (1.0 - 1.0 / SQRT_2) * s.dot(flux) * s;
        Ok(Self::about(alpha, wo, middle, flux.length() / TAU, &visible))
    }

    /// As [`Self::normals`], around a known mean normal: `flux` of [`Region`](super::normals::Region). This saves the
    /// first map.
    ///
    /// # Errors
    /// As [`Self::normals`].
    pub fn normals_about(at: &Configuration, light: &PolygonLight, flux: DVec3) -> Result<Self, LightError> {
        let (alpha, wo) = surface_and_view(at)?;
        let visible = above_surface(light)?;
        // Digits of the flux are lost for tiny lights. The normal that reflects a corner replaces it.
        let p = visible.first().copied().unwrap_or(DVec3::Z);
        let corner = (p.length() * wo + p) / DVec3::new(alpha[0], alpha[1], 1.0);
        let middle = flux + 1e-4 * corner.normalize();
        Ok(Self::about(alpha, wo, middle, middle.length() / TAU, &visible))
    }

    /// The sampler around the stretched normal `middle`, of any length, for a light that covers the part `size` of the
    /// hemisphere.
    fn about(alpha: [f64; 2], wo: DVec3, middle: DVec3, size: f64, visible: &[DVec3]) -> Self {
        let s = stretched(alpha, wo);
        let middle = middle.normalize_or_zero();
        let mut c = middle + (TOWARDS_VIEW * size + (LEAST_TURN - middle.dot(s)).max(0.0)) * s;
        c.z = c.z.max(0.0);
        let h = (DVec3::new(alpha[0], alpha[1], 1.0) * c).normalize();
        let more = BEND * size * alpha[0].max(alpha[1]).powi(2);
        let wide = [alpha[0] + more * wo.x.abs(), alpha[1] + more * wo.y.abs()];
        Self::new(tangent_map(wide, wo, stretched(wide, wo), h), visible)
    }

    /// Samples where an LTC with the matrix `m` reflects the light. The unit matrix is for diffuse surfaces.
    ///
    /// # Errors
    /// [`LightError::Singular`] for a matrix without an inverse, [`LightError::NotPlanar`].
    pub fn ltc(m: DMat3, light: &PolygonLight) -> Result<Self, LightError> {
        let inverse = m.inverse();
        if !inverse.is_finite() {
            return Err(LightError::Singular);
        }
        let to = DMat3::from_diagonal(DVec3::new(SQRT_2, SQRT_2, 1.0)) * inverse;
        let back = m * DMat3::from_diagonal(DVec3::new(1.0 / SQRT_2, 1.0 / SQRT_2, 1.0));
        Ok(Self::new(Map { to, back, det: 2.0 / m.determinant().abs() }, &above_surface(light)?))
    }

    /// Samples the light by its solid angle.
    ///
    /// # Errors
    /// [`LightError::NotPlanar`].
    pub fn solid_angle(light: &PolygonLight) -> Result<Self, LightError> {
        let map = Map { to: DMat3::IDENTITY, back: DMat3::IDENTITY, det: 1.0 };
        Ok(Self::new(map, &above_surface(light)?))
    }

    fn new(map: Map, visible: &[DVec3]) -> Self {
        let corners = transformed(&map, visible);
        let halves: Vec<f64> = match corners.split_first() {
            Some((tip, others)) => others.windows(2).map(|pair| half_solid_angle(*tip, pair[0], pair[1])).collect(),
            None => Vec::new(),
        };
        let total = halves.iter().sum();
        Self { map, corners, halves, total }
    }

    /// True if no part of the light is visible from the surface, or if the visible part has no solid angle.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.total <= 0.0
    }

    /// The direction for two numbers in [0, 1); `None` if the light is not visible.
    #[must_use]
    pub fn sample(&self, u: [f64; 2]) -> Option<SampledDirection> {
        let last = self.halves.iter().rposition(|half| *half > 0.0)?;
        let mut rest = u[0] * self.total;
        let mut index = 0;
        while index < last && rest > self.halves[index] {
            rest -= self.halves[index];
            index += 1;
        }
        let [a, b, c] = [self.corners[0], self.corners[index + 1], self.corners[index + 2]];
        let y = in_triangle([a, b, c], rest.min(self.halves[index]), u[1]);
        let wi = (self.map.back * y).normalize();
        Some(SampledDirection { wi, pdf: self.pdf(wi) })
    }

    /// The density of a direction in the light, per steradian; zero if the light is not visible. It does not check that
    /// the direction hits the light.
    #[must_use]
    pub fn pdf(&self, wi: DVec3) -> f64 {
        let length = (self.map.to * wi).length();
        if self.is_empty() { 0.0 } else { self.map.det / (2.0 * self.total * length * length * length) }
    }
}

/// Draws from one of two samplers, such as specular and diffuse.
#[derive(Debug, Clone)]
pub struct Mixture {
    /// The samplers.
    pub samplers: [LightSampler; 2],
    /// The probability of the first, in [0, 1]: its part of the reflected light.
    pub share: f64,
}

impl Mixture {
    /// The direction for two numbers in [0, 1); `None` if the light is not visible. The density is [`Self::pdf`].
    #[must_use]
    pub fn sample(&self, u: [f64; 2]) -> Option<SampledDirection> {
        let [first, second] = &self.samplers;
        let SampledDirection { wi, .. } = if u[0] < self.share {
            first.sample([u[0] / self.share, u[1]])?
        } else {
            second.sample([(u[0] - self.share) / (1.0 - self.share), u[1]])?
        };
        Some(SampledDirection { wi, pdf: self.pdf(wi) })
    }

    /// The mean density of both samplers.
    #[must_use]
    pub fn pdf(&self, wi: DVec3) -> f64 {
        self.share * self.samplers[0].pdf(wi) + (1.0 - self.share) * self.samplers[1].pdf(wi)
    }
}

/// `A wo / |A wo|`
fn stretched([alpha_x, alpha_y]: [f64; 2], wo: DVec3) -> DVec3 {
    DVec3::new(alpha_x * wo.x, alpha_y * wo.y, wo.z).normalize()
}

/// The map that is exact at the stretched normal `c`, of any length.
fn normals_map(alpha: [f64; 2], wo: DVec3, s: DVec3, c: DVec3) -> Map {
    tangent_map(alpha, wo, s, (DVec3::new(alpha[0], alpha[1], 1.0) * c).normalize())
}

/// The map with the tangent of `|p|` at the direction that `h` reflects.
fn tangent_map([alpha_x, alpha_y]: [f64; 2], wo: DVec3, s: DVec3, h: DVec3) -> Map {
    let alpha = DVec3::new(alpha_x, alpha_y, 1.0);
    let d = h.dot(wo).max(LEAST_COSINE);
    let q = 2.0 * d * h - wo;
    let outer = |a: DVec3, b: DVec3| DMat3::from_cols(a * b.x, a * b.y, a * b.z);
    let turn = SQRT_2 * DMat3::IDENTITY + (1.0 - SQRT_2) * outer(s, s);
    let unturn = DMat3::IDENTITY * (1.0 / SQRT_2) + (1.0 - 1.0 / SQRT_2) * outer(s, s);
    // 1 + q . wo is 2 d^2, except where d is raised.
    let ahead = (1.0 + q.dot(wo)).max(2.0 * LEAST_COSINE * LEAST_COSINE);
    Map {
        to: turn * DMat3::from_diagonal(1.0 / alpha) * (DMat3::IDENTITY + outer(wo, q)),
        back: (DMat3::IDENTITY - outer(wo, q) * (1.0 / ahead)) * DMat3::from_diagonal(alpha) * unturn,
        det: 2.0 * ahead / (alpha_x * alpha_y),
    }
}

fn transformed(map: &Map, corners: &[DVec3]) -> Vec<DVec3> {
    corners.iter().map(|corner| (map.to * *corner).normalize_or_zero()).collect()
}

/// The corners of the light's visible part, the highest first; empty if the light is below the surface or turned away.
fn above_surface(light: &PolygonLight) -> Result<Vec<DVec3>, LightError> {
    light.check_plane()?;
    let vertices = light.vertices();
    let mut corners = Vec::with_capacity(vertices.len() + 1);
    for (a, b) in ends(vertices) {
        if a.z > 0.0 {
            corners.push(a);
        }
        if (a.z > 0.0) != (b.z > 0.0) {
            corners.push(((a * b.z - b * a.z) / (b.z - a.z)).with_z(0.0));
        }
    }
    // The outline runs clockwise as seen from the lit side.
    let volume: f64 = corners.iter().skip(1).zip(corners.iter().skip(2)).map(|(b, c)| volume(corners[0], *b, *c)).sum();
    if light.sides() == Sides::One && volume <= 0.0 {
        return Ok(Vec::new());
    }
    let highest = (0..corners.len()).max_by(|i, j| corners[*i].z.total_cmp(&corners[*j].z)).unwrap_or(0);
    corners.rotate_left(highest);
    Ok(corners)
}

/// The pairs of neighbours around an outline.
fn ends(corners: &[DVec3]) -> impl Iterator<Item = (DVec3, DVec3)> + '_ {
    corners.iter().copied().zip(corners.iter().copied().cycle().skip(1))
}

/// `a . (b x c)`, without loss of digits for corners close together.
fn volume(a: DVec3, b: DVec3, c: DVec3) -> f64 {
    a.dot((b - a).cross(c - a))
}

/// Half of the solid angle of a triangle of unit vectors [Van Oosterom and Strackee 1983].
fn half_solid_angle(a: DVec3, b: DVec3, c: DVec3) -> f64 {
    atan2(volume(a, b, c).abs(), 1.0 + a.dot(b) + b.dot(c) + c.dot(a))
}

/// The angle between unit vectors divided by its sine; one for equal vectors.
fn angle_per_sine(a: DVec3, b: DVec3) -> f64 {
    let sine = a.cross(b).length();
    if sine > 1e-12 { atan2(sine, a.dot(b)) / sine } else { 1.0 }
}

/// The point of a triangle of unit vectors for two numbers. An arc from B through Q on AC cuts off half the solid angle
/// `half` on the side of AB. The point divides the area along this arc from B at `u`.
///
/// With `T` the direction of AC at A: `Q = cos(b) A + sin(b) T`, `tan(b / 2) = num / den`,
/// `num = sin(half) (1 + A . B)`, `den = cos(half) |A x B . T| - sin(half) B . T`.
fn in_triangle([a, b, c]: [DVec3; 3], half: f64, u: f64) -> DVec3 {
    let (sin, cos) = sin_cos(half);
    let ac = c - a;
    let side = (ac + 0.5 * ac.length_squared() * a).normalize_or_zero();
    let ab = b - a;
    let den = cos * a.cross(ab).dot(side).abs() - sin * ab.dot(side);
    let num = sin * (2.0 - 0.5 * ab.length_squared());
    let size = den * den + num * num;
    // A triangle without area: any of its points will do.
    let q = if size > 1e-60 { a * ((den * den - num * num) / size) + side * (2.0 * den * num / size) } else { a };
    let bq = q - b;
    let along = 0.5 * bq.length_squared();
    let m = u * along;
    b * (1.0 - m) + (m * (2.0 - m)).max(0.0).sqrt() * (bq + along * b).normalize_or_zero()
}

#[cfg(any(test, feature = "testing"))]
pub mod sets;
#[cfg(test)]
mod tests;
