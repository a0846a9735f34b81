//! Random surfaces and rectangles for pictures, with the true light of GGX in each channel. They are the same in every
//! run.

use std::f64::consts::TAU;

use glam::DVec3;
use ltcforge::{
    fit::{
        Configuration, Sides,
        brdf::{Brdf, Ggx},
        math::direction,
    },
    light::{
        PolygonLight,
        textured::{TexturedLight, TexturedReflection},
    },
};
use rayon::prelude::*;

use super::pictures::{CHANNELS, Pictures};
use crate::draw::Draw;

/// Sizes of the pictures in texels: squares, and rectangles that are two or four times as long as wide.
pub(super) const FORMS: [[usize; 2]; 5] = [[512, 512], [512, 256], [256, 512], [512, 128], [128, 512]];
/// The tolerance of the truth: a fiftieth of the mean error of the best row.
pub(super) const TOLERANCE: f64 = 1e-4;
/// There is one spare case for this many cases. The truth does not converge for one or two cases in a thousand, with
/// smooth surfaces and grazing views.
const SPARE: usize = 100;

/// The sets of cases. Each has its own distribution.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Set {
    /// Alpha .01 to 1, evenly distributed in its root, ratio 0 to 1, and views up to 88 degrees. The half sizes of
    /// lights are .05 to 1.2, evenly distributed in their logarithm. Lights are at distance one around a direction that
    /// the lobe reflects.
    Random,
    /// `Random` with alpha .1 to .6 and ratio .03 to .23.
    Anisotropic,
    /// `Random` with views from 70 to 85 degrees.
    Grazing,
    /// `Random` with alpha .6 to 1 and ratio .5 to 1.
    Rough,
    /// Upright walls opposite the viewer, .3 to 2 away. Their lower edge is between a tenth of their height below the
    /// surface and a quarter of their height above it.
    Floor,
    /// `Random` with views from 85 to 89 degrees.
    Horizon,
}

pub(super) const SETS: [Set; 6] = [Set::Random, Set::Anisotropic, Set::Grazing, Set::Horizon, Set::Rough, Set::Floor];

impl Set {
    /// The name of the set in tables.
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Random => "random",
            Self::Anisotropic => "anisotropic",
            Self::Grazing => "grazing",
            Self::Rough => "rough",
            Self::Floor => "floor",
            Self::Horizon => "horizon",
        }
    }
}

/// A surface, a light and its true reflected light.
#[derive(Debug, Clone)]
pub(super) struct Case {
    /// The surface and the view.
    pub(super) at: Configuration,
    /// The light.
    pub(super) light: TexturedLight,
    /// The index of the picture's size in [`FORMS`].
    pub(super) form: usize,
    /// The true reflected light of each channel, for a Fresnel factor of one.
    pub(super) truth: Vec<f64>,
}

/// `count` cases of a set. Equal arguments give equal cases.
pub(super) fn cases(set: Set, count: usize, pictures: &[Pictures]) -> Vec<Case> {
    let case = |(at, light, form): (Configuration, TexturedLight, usize)| {
        let Pictures { images, .. } = &pictures[form];
        let size = [images[0].width(), images[0].height()];
        let lights = light.texel_lights(&at, size, TOLERANCE).ok()?;
        let mut truth = Vec::with_capacity(CHANNELS);
        for image in images {
            let lit = lights.iter().zip(image.texels());
            let TexturedReflection { energy, .. } = TexturedReflection::of_texels(lit);
            truth.extend(energy);
        }
        Some(Case { at, light, form, truth })
    };
    let known: Vec<Option<Case>> = drawn(set, count).into_par_iter().map(case).collect();
    known.into_iter().flatten().take(count).collect()
}

/// Surfaces, lights and picture sizes of a set: `count` cases, and some spare cases.
pub(super) fn drawn(set: Set, count: usize) -> Vec<(Configuration, TexturedLight, usize)> {
    let mut draw = Generator(Draw::new(44_000 + set as u64));
    (0..=count + count / SPARE).map(|_| draw.valid(set)).collect()
}

/// A generator of random surfaces and lights.
struct Generator(Draw);

impl Generator {
    fn configuration(&mut self, set: Set) -> Configuration {
        let (long, ratio) = match set {
            Set::Anisotropic => (self.0.within(0.1, 0.6), self.0.within(0.03, 0.23)),
            Set::Rough => (self.0.within(0.6, 1.0), self.0.within(0.5, 1.0)),
            _ => (self.0.within(0.0, 1.0).powi(2).max(0.01), self.0.within(0.0, 1.0)),
        };
        let short = (long * ratio).max(0.005);
        let [alpha_x, alpha_y] = if self.0.within(0.0, 1.0) < 0.5 { [long, short] } else { [short, long] };
        let [low, high] = match set {
            Set::Grazing => [70.0, 85.0],
            Set::Horizon => [85.0, 89.0],
            _ => [0.0, 88.0_f64],
        }
        .map(f64::to_radians);
        Configuration { alpha_x, alpha_y, theta: self.0.within(low, high), phi: self.0.within(0.0, TAU) }
    }

    /// Draws until the rectangle is a valid light.
    fn valid(&mut self, set: Set) -> (Configuration, TexturedLight, usize) {
        loop {
            let form = (self.0.within(0.0, FORMS.len() as f64) as usize).min(FORMS.len() - 1);
            let at = self.configuration(set);
            let [width, height] = FORMS[form].map(|texels| texels as f64);
            let stretch = (width / height).sqrt();
            let corners =
                if set == Set::Floor { Some(self.wall(&at, stretch)) } else { self.around_lobe(&at, stretch) };
            let light = corners.and_then(|corners| PolygonLight::new(corners.to_vec(), Sides::Two).ok());
            if let Some(light) = light.and_then(|light| TexturedLight::new(light).ok()) {
                return (at, light, form);
            }
        }
    }

    fn around_lobe(&mut self, at: &Configuration, stretch: f64) -> Option<[DVec3; 4]> {
        let ggx = Ggx { alpha_x: at.alpha_x, alpha_y: at.alpha_y };
        let u = [self.0.within(0.0, 1.0), self.0.within(0.0, 1.0)];
        let centre = ggx.sample(direction(at.theta, at.phi), u).wi;
        let size = self.0.logarithmic(0.05, 1.2);
        let normal = (0.5 * self.0.vector() - centre).normalize();
        let x = normal.cross(self.0.vector()).normalize();
        let (x, y) = (x * size * stretch, normal.cross(x) * size / stretch);
        (centre.z > 0.0).then_some([centre - x - y, centre + x - y, centre + x + y, centre - x + y])
    }

    fn wall(&mut self, at: &Configuration, stretch: f64) -> [DVec3; 4] {
        let towards = at.phi + TAU * self.0.within(0.4, 0.6);
        let middle = DVec3::new(towards.cos(), towards.sin(), 0.0) * self.0.within(0.3, 2.0);
        let size = self.0.logarithmic(0.1, 1.0);
        let x = DVec3::new(-towards.sin(), towards.cos(), 0.0) * size * stretch;
        let top = DVec3::Z * 2.0 * size / stretch;
        let low = middle + top * self.0.within(-0.1, 0.25);
        [low - x, low + x, low + x + top, low - x + top]
    }
}
