//! How engines of today read a picture on a light, by their sources: one reading each, in the space of the cosine.
//!
//! All read the prefilter of docs/textured.md at the level that blurs as widely as their own: what is told apart is where
//! they read, and how wide. Blurs are standard deviations along an axis, in texels of a level.

use std::f64::consts::PI;

use glam::DVec3;
use ltcforge::{
    fit::{Configuration, Ltc, Table, math::from_row_major},
    light::{
        by_table,
        engines::EngineWay,
        textured::{LightPyramid, Reading, TexturedLight, TexturedReflection, colour},
    },
};

/// An engine that has pictures on area lights.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Engine {
    /// Babylon.js, `ltcHelperFunctions.fx` and `areaLightsTextureTools.ts` as of c79f559 (2025).
    Babylon,
    /// Godot 4.7, `area_lights_inc.glsl` as of 0385d21 (2026).
    Godot,
    /// Unity HDRP, `LightEvaluation.hlsl` and `FilterAreaLightCookies.shader` as of 6236f8e (2023).
    Hdrp,
}

impl Engine {
    pub(super) const ALL: [Self; 3] = [Self::Babylon, Self::Godot, Self::Hdrp];

    /// Its name in tables.
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Babylon => "Babylon.js",
            Self::Godot => "Godot",
            Self::Hdrp => "HDRP",
        }
    }

    /// What it reflects of a light by an isotropic table, at the geometric mean of the two roughnesses.
    pub(super) fn by_isotropic(
        self,
        table: &Table,
        at: &Configuration,
        light: &TexturedLight,
        pyramid: &LightPyramid,
    ) -> TexturedReflection {
        let mean = (at.alpha_x * at.alpha_y).sqrt();
        let at = Configuration { alpha_x: mean, alpha_y: mean, ..*at };
        match self {
            // It takes what the sphere of the same form factor leaves above the horizon; the others clip.
            Self::Babylon => {
                let energy = EngineWay::Clipless.reflected(Some(table), &at, light.polygon()).expect("a surface");
                self.read(table, &at, light, pyramid, energy)
            }
            Self::Godot | Self::Hdrp => self.by_table(table, &at, light, pyramid),
        }
    }

    /// By a table as `ltcforge` uses it: only the reading is the engine's.
    pub(super) fn by_table(
        self,
        table: &Table,
        at: &Configuration,
        light: &TexturedLight,
        pyramid: &LightPyramid,
    ) -> TexturedReflection {
        let energy = by_table(table, at, light.polygon()).expect("a surface").energy;
        self.read(table, at, light, pyramid, energy)
    }

    fn read(
        self,
        table: &Table,
        at: &Configuration,
        light: &TexturedLight,
        pyramid: &LightPyramid,
        energy: f64,
    ) -> TexturedReflection {
        let ltc = Ltc::new(from_row_major(&table.lookup(at).matrix)).expect("an LTC");
        let base = &pyramid.levels()[0];
        let texels = ((base.width() * base.height()) as f64).sqrt();
        let seen = Seen::new(&ltc, light.polygon().vertices(), texels);
        let (uv, radius) = match self {
            Self::Babylon => seen.babylon(),
            Self::Godot => seen.godot(),
            Self::Hdrp => seen.hdrp((at.alpha_x * at.alpha_y).powf(0.25)),
        };
        let colour = colour(&[Reading { uv, radius, weight: 1.0 }], pyramid);
        TexturedReflection { energy: colour.map(|channel| energy * channel), fresnel: [0.0; 3] }
    }
}

/// A light in the space of the cosine.
struct Seen {
    corner: DVec3,
    sides: [DVec3; 2],
    /// Across the plane, of length one, and the area.
    normal: DVec3,
    area: f64,
    /// The direction of the vector form factor.
    flux: DVec3,
    /// The root of how many texels the picture has.
    texels: f64,
}

impl Seen {
    fn new(ltc: &Ltc, vertices: &[DVec3], texels: f64) -> Self {
        let inverse = ltc.inverse();
        let [corner, x, y] = [vertices[0], vertices[1] - vertices[0], vertices[3] - vertices[0]].map(|v| inverse * v);
        let across = x.cross(y);
        let area = across.length();
        let flux = ltc.vector_form_factor(vertices).normalize_or_zero();
        Self { corner, sides: [x, y], normal: across / area, area, flux, texels }
    }

    /// The parts of the sides at which a point of the plane is.
    fn uv(&self, p: DVec3) -> [f64; 2] {
        let from_corner = p - self.corner;
        let part = |side: DVec3, other: DVec3| {
            let upright = other.cross(self.normal);
            from_corner.dot(upright) / side.dot(upright)
        };
        [part(self.sides[0], self.sides[1]), part(self.sides[1], self.sides[0])]
    }

    /// The distance of the plane, over the root of the area.
    fn distance(&self) -> f64 {
        self.corner.dot(self.normal).abs() / self.area.sqrt()
    }

    /// The foot of the perpendicular.
    fn foot(&self) -> [f64; 2] {
        self.uv(self.corner.dot(self.normal) * self.normal)
    }

    /// The level of the demo of [Heitz et al. 2016], whose levels widen by three: log3 of 2048 distances.
    fn level(&self) -> f64 {
        (2048.0 * self.distance()).max(1e-9).ln() / 3.0_f64.ln()
    }

    /// At the foot of the perpendicular. The picture is the inner three fourths of 1024 x 1024 texels; around it it is
    /// mirrored, blurred by half the distance. Levels are halved means, which are a GPU's own and blur by half a texel.
    fn babylon(&self) -> ([f64; 2], f64) {
        const PICTURE: f64 = 768.0;
        const BORDER: f64 = 1.0 / 6.0;
        let foot = self.foot();
        let outside = foot.map(|x| (-x).max(x - 1.0).clamp(0.0, BORDER));
        let uv = [0, 1].map(|i| if foot[i] < 0.5 { foot[i].max(outside[i]) } else { foot[i].min(1.0 - outside[i]) });
        let of_level = 0.5 * self.level().clamp(0.0, 10.0).exp2() / PICTURE;
        (uv, of_level.hypot(0.5 * outside[0].max(outside[1])))
    }

    /// Where the vector form factor meets the light. Levels are of the picture's own texels, each blurred by a Gaussian of
    /// nine texels after it is halved: by two texels, all steps together.
    fn godot(&self) -> ([f64; 2], f64) {
        let met = self.flux * (self.corner.dot(self.normal) / self.flux.dot(self.normal));
        let level = self.level().clamp(0.0, self.texels.log2());
        (self.uv(met).map(|x| x.clamp(0.0, 1.0)), 2.0 * level.exp2() / self.texels)
    }

    /// At the foot of the perpendicular, as wide as a disk of the radius at which the vector form factor meets the plane.
    /// Below a perceptual roughness of .3 levels end earlier, at 0 the fourth is the last. Seven texels are blurred as they
    /// are halved: by .8 texels, all steps together.
    fn hdrp(&self, perceptual_roughness: f64) -> ([f64; 2], f64) {
        let hit = self.corner.dot(self.normal) / self.flux.dot(self.normal);
        let count = self.texels.log2();
        let smooth = (1.0 - perceptual_roughness / 0.3).clamp(0.0, 1.0);
        let last = count + (3.0 - count) * smooth;
        let level = (0.5 * (1e-8 + PI * hit * hit / self.area).log2() + count).min(last).max(0.0);
        (self.foot().map(|x| x.clamp(0.0, 1.0)), 0.8 * level.exp2() / self.texels)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DMat3;

    /// A light straight above a diffuse surface, half as far away as its sides are long: all ways read the middle, as wide
    /// as their formulas say.
    #[test]
    fn a_light_straight_above_is_read_in_its_middle() {
        let vertices = [[-1.0, 1.0], [1.0, 1.0], [1.0, -1.0], [-1.0, -1.0]].map(|[x, y]| DVec3::new(x, y, 1.0));
        let seen = Seen::new(&Ltc::new(DMat3::IDENTITY).expect("an LTC"), &vertices, 512.0);
        let level = 1024.0_f64.ln() / 3.0_f64.ln();
        let wanted = [0.5 * level.exp2() / 768.0, 2.0 * level.exp2() / 512.0, 0.8 * (PI / 4.0_f64).sqrt()];
        for ((uv, radius), wanted) in [seen.babylon(), seen.godot(), seen.hdrp(1.0)].into_iter().zip(wanted) {
            assert!(uv.iter().all(|x| (x - 0.5).abs() < 1e-9), "{uv:?}");
            assert!((radius / wanted - 1.0).abs() < 1e-6, "{radius} {wanted}");
        }
        // A smooth surface reads no level above the fourth.
        assert!((seen.hdrp(0.0).1 - 0.8 * 8.0 / 512.0).abs() < 1e-12);
    }

    /// A light beside the surface: its foot is a tenth of its width outside, where Babylon.js mirrors and blurs.
    #[test]
    fn a_foot_outside_is_read_at_the_border() {
        let vertices = [[0.1, 0.5], [1.1, 0.5], [1.1, -0.5], [0.1, -0.5]].map(|[x, y]| DVec3::new(x, y, 0.01));
        let seen = Seen::new(&Ltc::new(DMat3::IDENTITY).expect("an LTC"), &vertices, 512.0);
        let (uv, radius) = seen.babylon();
        assert!((uv[0] - 0.1).abs() < 1e-9 && (uv[1] - 0.5).abs() < 1e-9, "{uv:?}");
        assert!(radius > 0.05 && radius < 0.051, "{radius}");
        assert!(seen.hdrp(1.0).0[0].abs() < 1e-9, "{:?}", seen.hdrp(1.0));
        assert!(seen.godot().0[0] > 0.0, "{:?}", seen.godot());
    }
}
