//! Random surfaces and polygon lights of several kinds, with their true light reflected by GGX. The same seed gives the
//! same cases in every run.

use std::f64::consts::TAU;

use glam::DVec3;
use ltcforge::{
    fit::{
        Configuration, Sides,
        brdf::{Brdf, Ggx},
        math::direction,
    },
    light::{LightError, PolygonLight, TRUTH_TOLERANCE, truth_within},
};
use rayon::prelude::*;

use crate::draw::Draw;

/// The tolerance of the true light: a thirtieth of the mean error of the best model.
const TOLERANCE: f64 = 1e-5;
/// The tolerance for kinds with very sharp lobes. With a larger tolerance, the quadrature could miss them.
const TOLERANCE_OF_EXTREMES: f64 = TRUTH_TOLERANCE;

/// The kinds of cases. Each has its own distribution of surface, view and light.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Kind {
    /// Any surface, and a rectangle at distance one around a direction that the lobe reflects. Its half sides are 0.05
    /// to 1.2, before one is stretched by up to e and the other shrunk by the same factor.
    Random,
    /// Isotropic surfaces with alpha 0.02 to 1, and rectangles whose half sides have the geometric means 0.05 to 50.
    Isotropic,
    /// `Random` with alpha 0.1 to 0.6 and ratio 0.03 to 0.23.
    Anisotropic,
    /// Rectangles whose half sides have the geometric mean 50. They fill nearly half of all directions.
    Huge,
    /// Alpha over several decades with a ratio from 0.05, half sides from 0.002 to 50, and views up to 89.9 degrees.
    Extreme,
    /// Horizontal ceilings at height one, with half sides of 3 to 10,000. The largest are a white sky.
    Sky,
    /// `Extreme` with both roughnesses drawn over several decades.
    Needle,
    /// `Random` with alpha from 0.25 to 1 and ratio 1/50.
    Thin,
    /// An upright wall opposite the viewer. The middle of its lower edge is `foot` times its height above the surface.
    /// One end of this edge is `tilt` times the height higher, and the other end is lower.
    Wall {
        /// Height of the lower edge's middle.
        foot: f64,
        /// Height of one end of the lower edge above its middle.
        tilt: f64,
    },
    /// Walls with any foot from -0.1 to 0.25 and any tilt up to 0.05.
    NearHorizon,
    /// Walls of any proportion that stand on the surface, like floors and ceilings seen from a wall.
    Floor,
    /// A rectangle around a point, with its plane close to the point.
    Around,
    /// Rectangles at least twenty times as long as wide.
    Sliver,
    /// Views from 75 to 89 degrees.
    Grazing,
    /// Views from 80 to 89 degrees.
    Steep,
    /// Low, wide walls on the surface opposite the viewer, like strips of light on a floor.
    Strip,
    /// Alpha from 0.01 to 0.05.
    Sharp,
    /// Rectangles with their centre about as high as the horizon.
    Across,
    /// Rectangles with an angular radius of about 0.3 to 3 degrees.
    Tiny,
}

impl Kind {
    /// The kinds that the search for networks uses.
    pub const ALL: [Self; 16] = [
        Self::Random,
        Self::Anisotropic,
        Self::Huge,
        Self::Sky,
        Self::Extreme,
        Self::Wall { foot: 0.0, tilt: 0.0 },
        Self::NearHorizon,
        Self::Floor,
        Self::Around,
        Self::Sliver,
        Self::Grazing,
        Self::Steep,
        Self::Strip,
        Self::Sharp,
        Self::Across,
        Self::Tiny,
    ];

    /// The name of the kind in tables.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Random => "random",
            Self::Isotropic => "isotropic, alpha .02 to 1",
            Self::Anisotropic => "random, strongly anisotropic",
            Self::Huge => "of 50 radii, nearly half of all directions",
            Self::Sky => "ceilings, up to a white sky",
            Self::Extreme => "extremes: alpha 1e-4 to 1, ratio .05 to 1, sizes 0.002 to 50, views to 89.9 degrees",
            Self::Needle => "extremes, but both roughnesses log-uniform from 1e-4 to 1",
            Self::Thin => "needles: alpha .25 to 1, ratio 1:50",
            Self::Wall { .. } => "walls",
            Self::NearHorizon => "walls near the surface",
            Self::Floor => "floors and ceilings",
            Self::Around => "around the shaded point",
            Self::Sliver => "slivers",
            Self::Grazing => "grazing views",
            Self::Steep => "views from 80 to 89 degrees",
            Self::Strip => "strips on the surface",
            Self::Sharp => "sharp lobes",
            Self::Across => "across the horizon",
            Self::Tiny => "tiny",
        }
    }
}

/// A surface, a view direction, and the vertices of a light that emits to both sides.
#[derive(Debug, Clone)]
pub struct Lit {
    /// The surface and the view.
    pub at: Configuration,
    /// The vertices relative to the shaded point.
    pub vertices: Vec<[f64; 3]>,
}

impl Lit {
    /// Roughness along x and y.
    #[must_use]
    pub fn alpha(&self) -> [f64; 2] {
        [self.at.alpha_x, self.at.alpha_y]
    }

    /// The view direction.
    #[must_use]
    pub fn wo(&self) -> [f64; 3] {
        direction(self.at.theta, self.at.phi).to_array()
    }

    /// The light.
    ///
    /// # Errors
    /// The errors of [`PolygonLight::new`].
    pub fn light(&self) -> Result<PolygonLight, LightError> {
        PolygonLight::new(self.vertices.iter().map(|v| DVec3::from_array(*v)).collect(), Sides::Two)
    }
}

/// A light, and its true light reflected by GGX: for a Fresnel factor of one, and weighted by Schlick's fifth power.
#[derive(Debug, Clone)]
pub struct Case {
    /// The surface and the light.
    pub lit: Lit,
    /// The true reflected light.
    pub truth: [f64; 2],
}

/// The true light within a tolerance; zero for an invalid light.
#[must_use]
pub fn truth_of(lit: &Lit, tolerance: f64) -> [f64; 2] {
    let truth = lit.light().and_then(|light| truth_within(tolerance, &lit.at, &light));
    truth.map_or([0.0; 2], |truth| [truth.energy, truth.fresnel])
}

/// `count` surfaces and lights of a kind. Equal arguments give equal lights.
#[must_use]
pub fn lits(kind: Kind, seed: u64, count: usize) -> Vec<Lit> {
    drawn(kind, seed, count).into_iter().map(|(lit, _)| lit).collect()
}

fn drawn(kind: Kind, seed: u64, count: usize) -> Vec<(Lit, PolygonLight)> {
    let mut draw = Generator(Draw::new(seed));
    (0..count).map(|_| draw.valid(kind)).collect()
}

/// `count` cases of a kind. Equal arguments give equal cases.
#[must_use]
pub fn cases(kind: Kind, seed: u64, count: usize) -> Vec<Case> {
    let lights = drawn(kind, seed, count);
    let case = |(lit, light): (Lit, PolygonLight)| {
        let tolerance = if matches!(kind, Kind::Extreme | Kind::Needle) { TOLERANCE_OF_EXTREMES } else { TOLERANCE };
        let truth = truth_within(tolerance, &lit.at, &light).map_or([0.0; 2], |truth| [truth.energy, truth.fresnel]);
        Case { lit, truth }
    };
    lights.into_par_iter().map(case).collect()
}

/// Absolute errors over cases.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spread {
    /// Mean error.
    pub mean: f64,
    /// The median.
    pub p50: f64,
    /// The error that one case in twenty exceeds.
    pub p95: f64,
    /// The error that one case in a hundred exceeds.
    pub p99: f64,
    /// The error that one case in a thousand exceeds.
    pub p999: f64,
    /// Largest error.
    pub max: f64,
}

impl Spread {
    /// The spread of `errors`. Domain: at least one error.
    #[must_use]
    pub fn of(mut errors: Vec<f64>) -> Self {
        errors.sort_by(f64::total_cmp);
        let count = errors.len();
        let mean = errors.iter().sum::<f64>() / count as f64;
        let [p50, p95, p99, p999] = [500, 950, 990, 999].map(|part| errors[count * part / 1000]);
        Self { mean, p50, p95, p99, p999, max: errors[count - 1] }
    }
}

/// Errors of the energy and of Schlick's part, for the function `reflected`.
#[must_use]
pub fn errors(cases: &[Case], reflected: impl Fn(&Lit) -> [f64; 2] + Sync) -> [Spread; 2] {
    let both: Vec<[f64; 2]> = cases
        .par_iter()
        .map(|case| {
            let found = reflected(&case.lit);
            [0, 1].map(|part| (found[part] - case.truth[part]).abs())
        })
        .collect();
    [0, 1].map(|part| Spread::of(both.iter().map(|errors| errors[part]).collect()))
}

/// A generator of random surfaces and lights.
struct Generator(Draw);

/// The ranges of roughness and theta.
struct Surfaces {
    alpha: fn(&mut Generator) -> f64,
    /// The other roughness, from the first.
    other: fn(&mut Generator, f64) -> f64,
    /// Least value of the smaller roughness.
    least: f64,
    /// Range of theta in degrees.
    theta: [f64; 2],
}

const ALL: Surfaces = Surfaces {
    alpha: |draw| draw.0.within(0.0, 1.0).powi(2).max(0.01),
    other: |draw, alpha| alpha * draw.0.within(0.0, 1.0),
    least: 0.005,
    theta: [0.0, 88.0],
};
const ANISOTROPIC: Surfaces =
    Surfaces { alpha: |draw| draw.0.within(0.1, 0.6), other: |draw, alpha| alpha * draw.0.within(0.03, 0.23), ..ALL };
const THIN: Surfaces = Surfaces { alpha: |draw| draw.0.within(0.25, 1.0), other: |_, alpha| alpha / 50.0, ..ALL };
const ISOTROPIC: Surfaces = Surfaces { alpha: |draw| draw.0.within(0.02, 1.0), other: |_, alpha| alpha, ..ALL };
const EXTREME: Surfaces = Surfaces {
    alpha: |draw| draw.0.logarithmic(1e-4, 1.0),
    other: |draw, alpha| alpha * draw.0.within(0.05, 1.0),
    least: 1e-5,
    theta: [0.0, 89.9],
};
const NEEDLE: Surfaces = Surfaces { other: |draw, _| draw.0.logarithmic(1e-4, 1.0), ..EXTREME };
const GRAZING: Surfaces = Surfaces { theta: [75.0, 89.0], ..ALL };
const STEEP: Surfaces = Surfaces { theta: [80.0, 89.0], ..ALL };
const SHARP: Surfaces =
    Surfaces { alpha: |draw| draw.0.within(0.01, 0.05), other: |draw, alpha| alpha * draw.0.within(0.2, 1.0), ..ALL };

/// Range of the half sides of a light at distance one, before one is stretched by up to e and the other is shrunk.
const USUAL: [f64; 2] = [0.05, 1.2];

impl Generator {
    fn configuration(&mut self, surfaces: &Surfaces) -> Configuration {
        let long = (surfaces.alpha)(self);
        let short = (surfaces.other)(self, long).max(surfaces.least);
        let [alpha_x, alpha_y] = if self.0.within(0.0, 1.0) < 0.5 { [long, short] } else { [short, long] };
        let [low, high] = surfaces.theta.map(f64::to_radians);
        Configuration { alpha_x, alpha_y, theta: self.0.within(low, high), phi: self.0.within(0.0, TAU) }
    }

    /// Draws until the rectangle is a valid light. Rounding can make an edge-on rectangle concave.
    fn valid(&mut self, kind: Kind) -> (Lit, PolygonLight) {
        loop {
            let (at, vertices) = self.lit(kind);
            let lit = Lit { at, vertices: vertices.map(|v| v.to_array()).to_vec() };
            if let Ok(light) = lit.light() {
                return (lit, light);
            }
        }
    }

    fn lit(&mut self, kind: Kind) -> (Configuration, [DVec3; 4]) {
        match kind {
            Kind::Random => self.around_lobe(&ALL, USUAL, 1.0),
            Kind::Isotropic => self.around_lobe(&ISOTROPIC, [0.05, 50.0], 1.0),
            Kind::Thin => self.around_lobe(&THIN, USUAL, 1.0),
            Kind::Anisotropic => self.around_lobe(&ANISOTROPIC, USUAL, 1.0),
            Kind::Huge => self.around_lobe(&ALL, [50.0, 50.0], 1.0),
            Kind::Sky => {
                let at = self.configuration(&ALL);
                let size = self.0.logarithmic(3.0, 1e4);
                let [x, y] = [DVec3::X * size, DVec3::Y * size];
                (at, [-x - y, x - y, x + y, y - x].map(|v| v + DVec3::Z))
            }
            Kind::Extreme => self.around_lobe(&EXTREME, [0.002, 50.0], 1.0),
            Kind::Needle => self.around_lobe(&NEEDLE, [0.002, 50.0], 1.0),
            Kind::Sliver => self.around_lobe(&ALL, USUAL, 3.0),
            Kind::Grazing => self.around_lobe(&GRAZING, USUAL, 1.0),
            Kind::Around => {
                let at = self.configuration(&ALL);
                let size = self.0.logarithmic(2.0, 50.0);
                let centre = self.0.vector().normalize() * self.0.within(0.2, 1.0);
                (at, self.rectangle(centre, [size, size]))
            }
            Kind::Steep => self.around_lobe(&STEEP, USUAL, 1.0),
            Kind::Sharp => self.around_lobe(&SHARP, USUAL, 1.0),
            Kind::Tiny => self.around_lobe(&ALL, [0.005, 0.05], 1.0),
            Kind::Across => {
                let (at, vertices) = self.around_lobe(&ALL, USUAL, 1.0);
                let centre = 0.5 * (vertices[0] + vertices[2]);
                let height = 0.2 * self.0.within(-1.0, 1.0);
                (at, vertices.map(|v| v + DVec3::Z * (height - centre.z)))
            }
            Kind::Strip => {
                let at = self.configuration(&ALL);
                let towards = at.phi + TAU * self.0.within(0.4, 0.6);
                let middle = DVec3::new(towards.cos(), towards.sin(), 0.0) * self.0.logarithmic(0.5, 4.0);
                let turned = towards + self.0.within(-0.6, 0.6);
                let x = DVec3::new(-turned.sin(), turned.cos(), 0.0) * self.0.logarithmic(0.5, 4.0);
                let top = DVec3::Z * self.0.logarithmic(0.02, 0.5);
                (at, [middle - x, middle + x, middle + x + top, middle - x + top])
            }
            Kind::Wall { foot, tilt } => self.wall([0.1, 1.2], [0.1, 2.0], foot, tilt),
            Kind::NearHorizon => {
                let (foot, tilt) = (self.0.within(-0.1, 0.25), self.0.within(-0.05, 0.05));
                self.wall([0.1, 1.2], [0.1, 2.0], foot, tilt)
            }
            Kind::Floor => {
                let (width, height) = (self.0.logarithmic(0.3, 20.0), self.0.logarithmic(0.3, 20.0));
                self.wall([width, width], [height, height], 0.0, 0.0)
            }
        }
    }

    /// A rectangle at distance one around a direction that the lobe reflects. One side is up to `e^stretch` times
    /// longer, and the other is shorter by the same factor.
    fn around_lobe(&mut self, surfaces: &Surfaces, sizes: [f64; 2], stretch: f64) -> (Configuration, [DVec3; 4]) {
        loop {
            let at = self.configuration(surfaces);
            let ggx = Ggx { alpha_x: at.alpha_x, alpha_y: at.alpha_y };
            let u = [self.0.within(0.0, 1.0), self.0.within(0.0, 1.0)];
            let centre = ggx.sample(direction(at.theta, at.phi), u).wi;
            if centre.z > 0.0 {
                let size = self.0.logarithmic(sizes[0], sizes[1]);
                let least = if stretch > 1.0 { 1.5 } else { -stretch };
                let aspect = self.0.within(least, stretch).exp();
                return (at, self.rectangle(centre, [size * aspect, size / aspect]));
            }
        }
    }

    /// A rectangle around a point with these half sides, with random rotation and tilt.
    fn rectangle(&mut self, centre: DVec3, [width, height]: [f64; 2]) -> [DVec3; 4] {
        let normal = (0.5 * self.0.vector() - centre).normalize();
        let x = normal.cross(self.0.vector()).normalize();
        let (x, y) = (x * width, normal.cross(x) * height);
        [centre - x - y, centre + x - y, centre + x + y, centre - x + y]
    }

    fn wall(&mut self, half_width: [f64; 2], height: [f64; 2], foot: f64, tilt: f64) -> (Configuration, [DVec3; 4]) {
        let at = self.configuration(&ALL);
        let towards = at.phi + TAU * self.0.within(0.4, 0.6);
        let middle = DVec3::new(towards.cos(), towards.sin(), 0.0) * self.0.within(0.3, 2.0);
        let x = DVec3::new(-towards.sin(), towards.cos(), 0.0) * self.0.within(half_width[0], half_width[1]);
        let top = DVec3::Z * self.0.within(height[0], height[1]);
        let (low, x) = (middle + top * foot, x + top * tilt);
        (at, [low - x, low + x, low + x + top, low - x + top])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lights_of_each_kind_are_reproducible_and_visible() {
        for (i, kind) in Kind::ALL.into_iter().enumerate() {
            let [once, again] = [0; 2].map(|_| cases(kind, i as u64, 60));
            let vertices = |cases: &[Case]| cases.iter().map(|case| case.lit.vertices.clone()).collect::<Vec<_>>();
            assert_eq!(vertices(&once), vertices(&again), "{}", kind.name());
            let mean = once.iter().map(|case| case.truth[0]).sum::<f64>() / 60.0;
            assert!((0.01..0.95).contains(&mean), "{}: {mean}", kind.name());
            assert!(once.iter().all(|case| (0.0..=case.truth[0] + 1e-6).contains(&case.truth[1])), "{}", kind.name());
        }
    }
}
