//! Twin of `ggx_reference.wgsl`.

use std::f32::consts::PI;

use glam::{Vec2, Vec3};

use super::solids;
use crate::preview::{
    frame::{FrameLight, FrameShape},
    light::Ellipse,
};
use ltcforge_fit::math::sin_cos_turns;

pub(super) const HORIZON: f32 = 1e-6;

/// A point of the surface with its tangent frame, and the view direction.
pub(super) struct Shaded {
    pub(super) position: Vec3,
    pub(super) x: Vec3,
    pub(super) y: Vec3,
    pub(super) z: Vec3,
    pub(super) wo: Vec3,
    pub(super) alpha: Vec2,
}

fn hash(key: u32) -> u32 {
    let x = (key ^ (key >> 16)).wrapping_mul(0x7feb_352d);
    let x = (x ^ (x >> 15)).wrapping_mul(0x846c_a68b);
    x ^ (x >> 16)
}

/// Seeds for the samples of a pixel.
pub(super) fn seeds(key: u32) -> [u32; 4] {
    const STEP: u32 = 0x9e37_79b9;
    let a = hash(key);
    let b = hash(a ^ STEP);
    let c = hash(b ^ STEP);
    [a, b, c, hash(c ^ STEP)]
}

pub(super) fn point(i: u32, seed: [u32; 2]) -> Vec2 {
    let u = |step: u32, seed: u32| (i.wrapping_mul(step).wrapping_add(seed) >> 8) as f32 * (1.0 / 16_777_216.0);
    Vec2::new(u(0xc13f_a9a9, seed[0]), u(0x91e1_0da5, seed[1]))
}

pub(super) fn smith_lambda(alpha: Vec2, w: Vec3) -> f32 {
    let t = alpha * w.truncate() / w.z;
    0.5 * ((1.0 + t.dot(t)).sqrt() - 1.0)
}

pub(super) fn distribution(alpha: Vec2, wm: Vec3) -> f32 {
    let t = wm.truncate() / alpha;
    let q = t.dot(t) + wm.z * wm.z;
    1.0 / (PI * alpha.x * alpha.y * q * q)
}

fn visible_normal(alpha: Vec2, wo: Vec3, u: Vec2) -> Vec3 {
    let standard = (alpha * wo.truncate()).extend(wo.z).normalize();
    let z = (1.0 - u.y) * (1.0 + standard.z) - standard.z;
    let radius = (1.0 - z * z).max(0.0).sqrt();
    let (sin, cos) = sin_cos_turns(u.x);
    let wm = Vec3::new(radius * cos, radius * sin, z) + standard;
    (alpha * wm.truncate()).extend(wm.z.max(0.0)).normalize()
}

impl FrameLight {
    pub(super) fn faces(&self, cosine: f32) -> bool {
        if self.two_sided { cosine.abs() > HORIZON } else { cosine < -HORIZON }
    }

    pub(super) fn pdf(&self, position: Vec3, wi: Vec3) -> f32 {
        if let FrameShape::Tube { .. } | FrameShape::Line { .. } = self.shape {
            return solids::pdf(&self.shape, position, wi);
        }
        let cosine = self.normal.dot(wi);
        if !self.faces(cosine) {
            return -1.0;
        }
        let away = self.normal.dot(self.vertices[0] - position) / cosine;
        if away <= 0.0 {
            return -1.0;
        }
        let hit = position + away * wi;
        if !self.holds(hit) {
            return -1.0;
        }
        away * away / (self.area * cosine.abs())
    }

    /// A direction towards the light, and its density per steradian. The density is zero if the light does not emit to
    /// the shaded point.
    pub(super) fn sample(&self, position: Vec3, u: Vec2) -> (Vec3, f32) {
        if let FrameShape::Tube { .. } | FrameShape::Line { .. } = self.shape {
            return solids::sample(&self.shape, position, u);
        }
        let to_light = self.point(u) - position;
        let distance2 = to_light.dot(to_light);
        let direction = to_light / distance2.max(1e-36).sqrt();
        let facing = self.normal.dot(direction);
        let density = distance2 / (self.area * facing.abs().max(HORIZON));
        (direction, if self.faces(facing) { density } else { 0.0 })
    }

    /// Whether the light is a line. Directions to a line are sampled only by its points, because no direction from a
    /// lobe hits it exactly.
    pub(super) fn is_line(&self) -> bool {
        matches!(self.shape, FrameShape::Line { .. })
    }

    /// Whether a point of the light's plane is on the light.
    fn holds(&self, hit: Vec3) -> bool {
        if let FrameShape::Ellipse(Ellipse { centre, half_axes }) = self.shape {
            let [x, y] = half_axes.map(|(axis, per_length2)| (hit - centre).dot(axis) * per_length2);
            return x * x + y * y <= 1.0;
        }
        let mut a = self.vertices[self.vertices.len() - 1];
        for b in &self.vertices {
            if (*b - a).cross(hit - a).dot(self.normal) > 0.0 {
                return false;
            }
            a = *b;
        }
        true
    }

    fn point(&self, u: Vec2) -> Vec3 {
        if let FrameShape::Ellipse(Ellipse { centre, half_axes: [(x, _), (y, _)] }) = self.shape {
            let (sin, cos) = sin_cos_turns(u.y);
            return centre + u.x.sqrt() * (cos * x + sin * y);
        }
        let last = self.vertices.len() - 1;
        let i = 2 + (2..last).filter(|k| u.x >= self.area_up_to[*k]).count();
        let before = self.area_up_to[i - 1];
        let root = ((u.x - before) / (self.area_up_to[i] - before)).clamp(0.0, 1.0).sqrt();
        let origin = self.vertices[0];
        let (first, second) = (self.vertices[i - 1] - origin, self.vertices[i] - origin);
        origin + root * ((1.0 - u.y) * first + u.y * second)
    }
}

/// The reflected light of each colour channel: for a Fresnel factor of one, and weighted by Schlick's fifth power.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct ColouredParts {
    pub(super) all: Vec3,
    pub(super) fresnel: Vec3,
}

impl ColouredParts {
    /// The same parts in all channels.
    pub(super) fn grey(parts: Vec2) -> Self {
        Self { all: Vec3::splat(parts.x), fresnel: Vec3::splat(parts.y) }
    }

    /// The parts times a colour.
    pub(super) fn coloured(parts: Vec2, colour: Vec3) -> Self {
        Self { all: parts.x * colour, fresnel: parts.y * colour }
    }

    pub(super) fn plus(self, other: Self) -> Self {
        Self { all: self.all + other.all, fresnel: self.fresnel + other.fresnel }
    }

    pub(super) fn over(self, count: f32) -> Self {
        Self { all: self.all / count, fresnel: self.fresnel / count }
    }
}

/// The Monte Carlo reference. `colour` returns the colour of the light that arrives along a direction.
pub(super) fn reference(
    at: &Shaded,
    light: &FrameLight,
    colour: impl Fn(Vec3) -> Vec3,
    samples: u32,
    key: u32,
) -> ColouredParts {
    let [a, b, c, d] = seeds(key);
    let lambda_o = smith_lambda(at.alpha, at.wo);
    let to_pdf = 1.0 / (4.0 * at.wo.z * (1.0 + lambda_o));
    let weighed = |wm: Vec3, wi: Vec3, of_light: f32| {
        let of_brdf = distribution(at.alpha, wm) * to_pdf;
        let g2_over_g1 = (1.0 + lambda_o) / (1.0 + lambda_o + smith_lambda(at.alpha, wi));
        g2_over_g1 * (of_brdf / (if light.is_line() { 0.0 } else { of_brdf } + of_light))
    };
    let mut sum = ColouredParts::default();
    for i in 0..samples {
        let wm = visible_normal(at.alpha, at.wo, point(i, [a, b]));
        let cosine = at.wo.dot(wm);
        let wi = 2.0 * cosine * wm - at.wo;
        if wi.z > HORIZON {
            let towards = at.x * wi.x + at.y * wi.y + at.z * wi.z;
            let of_light = light.pdf(at.position, towards);
            if of_light >= 0.0 {
                let parts = fresnel(cosine) * weighed(wm, wi, of_light);
                sum = sum.plus(ColouredParts::coloured(parts, colour(towards)));
            }
        }
        let (direction, of_light) = light.sample(at.position, point(i, [c, d]));
        let wi = Vec3::new(direction.dot(at.x), direction.dot(at.y), direction.dot(at.z));
        if wi.z > HORIZON && of_light > 0.0 {
            let wm = (at.wo + wi).normalize();
            let parts = fresnel(at.wo.dot(wm)) * weighed(wm, wi, of_light);
            sum = sum.plus(ColouredParts::coloured(parts, colour(direction)));
        }
    }
    sum.over(samples as f32)
}

fn fresnel(cosine: f32) -> Vec2 {
    let m = (1.0 - cosine).clamp(0.0, 1.0);
    let m2 = m * m;
    Vec2::new(1.0, m2 * m2 * m)
}
