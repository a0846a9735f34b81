//! How engines read a picture on a light, from their sources: with one read each, in the space of the cosine.
//!
//! In this study, all of them read the prefiltered picture of docs/textured.md, at the level whose blur equals that of
//! their own prefilter. The study compares the position and the width of these reads. Blurs are standard deviations
//! along an axis, in texels of a level.

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

/// An engine that supports pictures on area lights.
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

    /// The name of the engine in tables.
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Babylon => "Babylon.js",
            Self::Godot => "Godot",
            Self::Hdrp => "HDRP",
        }
    }

    /// The reflected light by an isotropic table, at the geometric mean of the two roughnesses.
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
            // Babylon.js computes the part above the horizon from a sphere with the same form factor. The other engines
            // clip.
            Self::Babylon => {
                let clipless = EngineWay::Clipless.reflected(Some(table), &at, light.polygon()).expect("a surface");
                self.read(table, &at, light, pyramid, clipless.energy)
            }
            Self::Godot | Self::Hdrp => self.by_table(table, &at, light, pyramid),
        }
    }

    /// The reflected light by a table as `ltcforge` uses it, with the engine's read of the picture.
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
        let projected = Projected::new(&ltc, light.polygon().vertices(), texels);
        let (uv, radius) = match self {
            Self::Babylon => projected.babylon(),
            Self::Godot => projected.godot(),
            Self::Hdrp => projected.hdrp((at.alpha_x * at.alpha_y).powf(0.25)),
        };
        let colour = colour(&[Reading { uv, radius, weight: 1.0 }], pyramid);
        TexturedReflection { energy: colour.map(|channel| energy * channel), fresnel: [0.0; 3] }
    }
}

/// A light in the space of the cosine.
struct Projected {
    corner: DVec3,
    sides: [DVec3; 2],
    /// The unit normal of the plane, and the area of the light.
    normal: DVec3,
    area: f64,
    /// The direction of the vector form factor.
    flux: DVec3,
    /// The square root of the picture's number of texels.
    texels: f64,
}

impl Projected {
    fn new(ltc: &Ltc, vertices: &[DVec3], texels: f64) -> Self {
        let inverse = ltc.inverse();
        let [corner, x, y] = [vertices[0], vertices[1] - vertices[0], vertices[3] - vertices[0]].map(|v| inverse * v);
        let across = x.cross(y);
        let area = across.length();
        let flux = ltc.vector_form_factor(vertices).normalize_or_zero();
        Self { corner, sides: [x, y], normal: across / area, area, flux, texels }
    }

    /// The picture coordinates of a point in the plane.
    fn uv(&self, p: DVec3) -> [f64; 2] {
        let from_corner = p - self.corner;
        let part = |side: DVec3, other: DVec3| {
            let upright = other.cross(self.normal);
            from_corner.dot(upright) / side.dot(upright)
        };
        [part(self.sides[0], self.sides[1]), part(self.sides[1], self.sides[0])]
    }

    /// The distance to the plane, divided by the square root of the area.
    fn distance(&self) -> f64 {
        self.corner.dot(self.normal).abs() / self.area.sqrt()
    }

    /// The picture coordinates of the foot of the perpendicular on the plane.
    fn foot(&self) -> [f64; 2] {
        self.uv(self.corner.dot(self.normal) * self.normal)
    }

    /// The level in the demo of [Heitz et al. 2016]: log3 of 2048 times the distance. The width grows by a factor of
    /// three per level.
    fn level(&self) -> f64 {
        (2048.0 * self.distance()).max(1e-9).ln() / 3.0_f64.ln()
    }

    /// Position and width of the read in Babylon.js, at the foot of the perpendicular. The picture is in the inner
    /// three quarters of 1024 x 1024 texels. Around it, the picture is mirrored and blurred by half the distance. The
    /// GPU halves the levels by means of texels, which blur by half a texel.
    fn babylon(&self) -> ([f64; 2], f64) {
        const PICTURE: f64 = 768.0;
        const BORDER: f64 = 1.0 / 6.0;
        let foot = self.foot();
        let outside = foot.map(|x| (-x).max(x - 1.0).clamp(0.0, BORDER));
        let uv = [0, 1].map(|i| if foot[i] < 0.5 { foot[i].max(outside[i]) } else { foot[i].min(1.0 - outside[i]) });
        let of_level = 0.5 * self.level().clamp(0.0, 10.0).exp2() / PICTURE;
        (uv, of_level.hypot(0.5 * outside[0].max(outside[1])))
    }

    /// Position and width of the read in Godot: where the direction of the vector form factor meets the light. Levels
    /// have the texels of the picture. After each halving, a Gaussian of nine texels blurs the level. All steps
    /// together blur by two texels.
    fn godot(&self) -> ([f64; 2], f64) {
        let met = self.flux * (self.corner.dot(self.normal) / self.flux.dot(self.normal));
        let level = self.level().clamp(0.0, self.texels.log2());
        (self.uv(met).map(|x| x.clamp(0.0, 1.0)), 2.0 * level.exp2() / self.texels)
    }

    /// Position and width of the read in HDRP, at the foot of the perpendicular. The width is that of a disk whose
    /// radius is the distance at which the direction of the vector form factor meets the plane. Below a perceptual
    /// roughness of .3 there are fewer levels, and at 0 the fourth is the last. Halving uses seven texels. All steps
    /// together blur by .8 texels.
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

    /// For a light straight above a diffuse surface, all engines read the middle of the picture, with the width of
    /// their formulas. The distance is half the side.
    #[test]
    fn a_light_straight_above_is_read_in_its_middle() {
        let vertices = [[-1.0, 1.0], [1.0, 1.0], [1.0, -1.0], [-1.0, -1.0]].map(|[x, y]| DVec3::new(x, y, 1.0));
        let light = Projected::new(&Ltc::new(DMat3::IDENTITY).expect("an LTC"), &vertices, 512.0);
        let level = 1024.0_f64.ln() / 3.0_f64.ln();
        let wanted = [0.5 * level.exp2() / 768.0, 2.0 * level.exp2() / 512.0, 0.8 * (PI / 4.0_f64).sqrt()];
        for ((uv, radius), wanted) in [light.babylon(), light.godot(), light.hdrp(1.0)].into_iter().zip(wanted) {
            assert!(uv.iter().all(|x| (x - 0.5).abs() < 1e-9), "{uv:?}");
            assert!((radius / wanted - 1.0).abs() < 1e-6, "{radius} {wanted}");
        }
        // For a smooth surface, HDRP reads no level coarser than the fourth.
        assert!((light.hdrp(0.0).1 - 0.8 * 8.0 / 512.0).abs() < 1e-12);
    }

    /// The foot of a light to the side is a tenth of the light's width outside it. Babylon.js mirrors and blurs there.
    #[test]
    fn a_foot_outside_is_read_at_the_border() {
        let vertices = [[0.1, 0.5], [1.1, 0.5], [1.1, -0.5], [0.1, -0.5]].map(|[x, y]| DVec3::new(x, y, 0.01));
        let light = Projected::new(&Ltc::new(DMat3::IDENTITY).expect("an LTC"), &vertices, 512.0);
        let (uv, radius) = light.babylon();
        assert!((uv[0] - 0.1).abs() < 1e-9 && (uv[1] - 0.5).abs() < 1e-9, "{uv:?}");
        assert!(radius > 0.05 && radius < 0.051, "{radius}");
        assert!(light.hdrp(1.0).0[0].abs() < 1e-9, "{:?}", light.hdrp(1.0));
        assert!(light.godot().0[0] > 0.0, "{:?}", light.godot());
    }
}
