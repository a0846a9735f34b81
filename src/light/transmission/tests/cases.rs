//! Random interfaces and lights.

use std::f64::consts::TAU;

use rand_core::{Rng, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

use super::{super::*, truth::Truth};

/// A square seen through an interface.
#[derive(Debug, Clone, Copy)]
pub(super) struct Case {
    pub(super) alpha: [f64; 2],
    pub(super) eta: f64,
    pub(super) wo: [f64; 3],
    pub(super) vertices: [[f64; 3]; 4],
}

/// Kinds of cases.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Set {
    /// Roughness from .05 to 1, the light where a random normal refracts.
    Isotropic,
    Anisotropic,
    /// Roughness from .001 to .05.
    Sharp,
    /// Cut at the surface.
    Cut,
    /// Clipped by the cone of normals across the view or the light.
    Facing,
    /// Clipped by the cone of normals along the surface.
    Horizon,
    /// A light in any direction below.
    Anywhere,
    /// A hundred times larger than it is far.
    Huge,
}

impl Set {
    /// Those that the quadrature can do.
    pub(super) const MEASURED: [Self; 7] =
        [Self::Isotropic, Self::Anisotropic, Self::Sharp, Self::Cut, Self::Facing, Self::Horizon, Self::Anywhere];
}

/// The model in f64 and f32 as the truth has it, the visible part first.
impl Case {
    pub(super) fn model(&self) -> Truth {
        let of = |x| x;
        self.evaluated::<f64>(of, of)
    }

    pub(super) fn model32(&self) -> Truth {
        self.evaluated::<f32>(|x| x as f32, f64::from)
    }

    fn evaluated<T: Scalar>(&self, of: impl Fn(f64) -> T, to: impl Fn(T) -> f64) -> Truth {
        let vertices = self.vertices.map(|v| v.map(&of));
        let (alpha, wo, eta) = (self.alpha.map(&of), self.wo.map(&of), of(self.eta));
        let interface = Interface::new(alpha, wo, eta);
        let visible = Region::new(&interface, &outline(&interface, &vertices, Sides::Two)).part(&interface);
        let Transmitted { energy, dielectric, schlick } = transmitted(alpha, wo, eta, &vertices, Sides::Two);
        [visible, energy, dielectric, schlick].map(to)
    }

    /// The kinds and extents of the outline's arcs.
    pub(super) fn kinds(&self) -> Vec<(ArcKind, Extent)> {
        let interface = Interface::new(self.alpha, self.wo, self.eta);
        outline(&interface, &self.vertices, Sides::Two).iter().map(|arc| (arc.kind, arc.extent)).collect()
    }

    fn has(&self, kinds: &[ArcKind]) -> bool {
        self.kinds().iter().any(|(kind, _)| kinds.contains(kind))
    }
}

/// Numbers that are the same in every run.
pub(super) struct Draw(Xoshiro256PlusPlus);

impl Draw {
    pub(super) fn new(seed: u64) -> Self {
        Self(Xoshiro256PlusPlus::seed_from_u64(seed))
    }

    pub(super) fn within(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * ((self.0.next_u64() >> 11) as f64 / (1_u64 << 53) as f64)
    }

    /// Evenly in the logarithm.
    pub(super) fn scale(&mut self, low: f64, high: f64) -> f64 {
        low * (high / low).powf(self.within(0.0, 1.0))
    }

    fn normal(&mut self) -> f64 {
        (-2.0 * self.within(1e-12, 1.0).ln()).sqrt() * self.within(0.0, TAU).cos()
    }

    fn vector(&mut self) -> [f64; 3] {
        [self.normal(), self.normal(), self.normal()]
    }

    pub(super) fn view(&mut self, steepest: f64) -> [f64; 3] {
        let (theta, phi) = (self.within(0.0, steepest), self.within(0.0, TAU));
        [theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos()]
    }

    /// A direction that a visible normal refracts to `wo` [Heitz 2018, Dupuy and Benyoub 2023]; `None` for those that
    /// are reflected or end above the surface.
    pub(super) fn refracted(&mut self, [alpha_x, alpha_y]: [f64; 2], wo: [f64; 3], eta: f64) -> Option<[f64; 3]> {
        let view = unit([alpha_x * wo[0], alpha_y * wo[1], wo[2]]);
        let z = (1.0 - self.within(0.0, 1.0)) * (1.0 + view[2]) - view[2];
        let (sin, phi) = ((1.0 - z * z).max(0.0).sqrt(), self.within(0.0, TAU));
        let c = plus(view, [sin * phi.cos(), sin * phi.sin(), z]);
        let h = unit([alpha_x * c[0], alpha_y * c[1], c[2]]);
        let cos_o = dot(wo, h);
        let cosine2 = eta * eta - 1.0 + cos_o * cos_o;
        if cosine2 < 0.0 || cos_o < 0.0 {
            return None;
        }
        let wi = scaled(minus(scaled(h, cos_o - cosine2.sqrt()), wo), 1.0 / eta);
        (wi[2] < 0.0).then_some(wi)
    }

    /// A rectangle around a direction, turned towards the surface more or less, with these half axes.
    pub(super) fn rectangle(&mut self, around: [f64; 3], [width, height]: [f64; 2]) -> [[f64; 3]; 4] {
        let lean = scaled(self.vector(), 0.5);
        let normal = unit(minus(lean, around));
        let x = unit(cross(normal, self.vector()));
        let y = scaled(cross(normal, x), height);
        let x = scaled(x, width);
        [minus(minus(around, x), y), minus(plus(around, x), y), plus(plus(around, x), y), plus(minus(around, x), y)]
    }

    /// A case of a set.
    pub(super) fn case(&mut self, set: Set, eta: f64) -> Case {
        loop {
            let (low, high) = if set == Set::Sharp { (0.001, 0.05) } else { (0.05, 1.0) };
            let a = if self.within(0.0, 1.0) < 0.5 { self.scale(low, high) } else { self.within(low, high) };
            let b = self.scale(low, high);
            let alpha = [a, if set == Set::Isotropic { a } else { b }];
            let wo = self.view(88_f64.to_radians());
            let Some(around) = self.refracted(alpha, wo, eta) else { continue };
            let [x, y, z] = self.vector();
            let around = if set == Set::Anywhere { unit([x, y, -z.abs()]) } else { around };
            let size = if set == Set::Huge { 50.0 } else { self.scale(0.05, 1.2) };
            let aspect = self.within(-1.0, 1.0).exp();
            let vertices = self.rectangle(around, [size * aspect, size / aspect]);
            let case = Case { alpha, eta, wo, vertices };
            let is_wanted = match set {
                Set::Cut => vertices.iter().any(|v| v[2] > 0.0),
                Set::Facing => case.has(&[ArcKind::Grazing, ArcKind::Critical]),
                Set::Horizon => case.has(&[ArcKind::Horizon]),
                _ => true,
            };
            // The quadrature cannot do a light that all but touches the point.
            let normal = unit(cross(minus(vertices[1], vertices[0]), minus(vertices[3], vertices[0])));
            if is_wanted && (set == Set::Huge || dot(normal, around).abs() > 0.05) {
                return case;
            }
        }
    }
}
