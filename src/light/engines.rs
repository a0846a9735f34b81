//! The area lights of engines and papers, computed by the published formulas for comparison with the models.
//!
//! Engines with isotropic tables use one roughness. Here it is the geometric mean of a surface's two roughnesses, which
//! is more accurate than either.

use glam::DVec3;

use super::{LightError, LitPoint, PolygonLight, ReflectedLight, by_table, rules::lit};
use ltcforge_fit::{
    Configuration, LEAST_ALPHA, Layout, Ltc, Sides, Table,
    brdf::{Brdf, Ggx},
    cheap_form_factor,
    math::{atan2, direction, from_row_major},
    named_list,
};

named_list! {
    /// The method with which engines and papers compute rectangular lights.
    pub enum EngineWay {
        /// The isotropic table. The horizon reduces the vector form factor as for a sphere with the same form factor
        /// [Hill and Heitz 2016]. three.js, Babylon.js, PlayCanvas and Bevy use it.
        Clipless = "ltc2017, clipless",
        /// Like [`EngineWay::Clipless`], with directions first stretched along x and y by each alpha divided by the
        /// mean of both. This preserves the shadows of an anisotropic surface [Heitz 2014, section 5.3].
        Stretched = "ltc2017, stretched",
        /// The anisotropic table, with the light cut at the lobe's horizon [KT et al. 2022].
        Anisotropic = "kt2022, its own",
        /// GGX towards the point of the light nearest to the mirrored view, times the light's solid angle [Lagarde and
        /// de Rousiers 2014]. The lobe's peak is lowered to compensate for the widening by the light [Karis 2013].
        RepresentativePoint = "representative point",
    }
}

impl EngineWay {
    /// The layout of the table; `None` for a method without a table.
    #[must_use]
    pub fn layout(self) -> Option<Layout> {
        match self {
            Self::Clipless | Self::Stretched => Some(Layout::Ltc2017),
            Self::Anisotropic => Some(Layout::Kt2022),
            Self::RepresentativePoint => None,
        }
    }

    /// The light of a parallelogram that a surface reflects.
    ///
    /// Domain: a table of [`EngineWay::layout`], with terms; a light of four vertices.
    ///
    /// # Errors
    /// [`LightError::Domain`] for a roughness outside [0, 1] or a view direction on or below the horizon,
    /// [`LightError::NoTerms`] for a table that is missing or has no terms, [`LightError::Singular`] for a singular
    /// matrix.
    pub fn reflected(
        self,
        table: Option<&Table>,
        at: &Configuration,
        light: &PolygonLight,
    ) -> Result<ReflectedLight, LightError> {
        let table = || table.ok_or(LightError::NoTerms);
        let mean = (at.alpha_x * at.alpha_y).sqrt();
        let isotropic = Configuration { alpha_x: mean, alpha_y: mean, ..*at };
        match self {
            Self::Clipless => clipless(table()?, &isotropic, light.vertices(), light.sides()),
            Self::Stretched => {
                let mean = mean.max(LEAST_ALPHA);
                let stretch = DVec3::new(at.alpha_x.max(LEAST_ALPHA) / mean, at.alpha_y.max(LEAST_ALPHA) / mean, 1.0);
                let wo = stretch * direction(at.theta, at.phi);
                let (theta, phi) = (atan2(wo.truncate().length(), wo.z), atan2(wo.y, wo.x));
                let vertices: Vec<DVec3> = light.vertices().iter().map(|v| stretch * *v).collect();
                clipless(table()?, &Configuration { theta, phi, ..isotropic }, &vertices, light.sides())
            }
            Self::Anisotropic => by_table(table()?, at, light),
            Self::RepresentativePoint => lit(at, light.into(), representative_point),
        }
    }
}

/// Computes the light with a table, without cutting it at the lobe's horizon.
fn clipless(table: &Table, at: &Configuration, vertices: &[DVec3], sides: Sides) -> Result<ReflectedLight, LightError> {
    let found = table.lookup(at);
    let (amplitude, fresnel) = found.amplitude.zip(found.fresnel).ok_or(LightError::NoTerms)?;
    let ltc = Ltc::new(from_row_major(&found.matrix)).ok_or(LightError::Singular)?;
    if !faces(vertices, sides) {
        return Ok(ReflectedLight::NONE);
    }
    let flux = ltc.vector_form_factor(vertices);
    let length = flux.length();
    let covered = if length > 0.0 { length * cheap_form_factor(flux.z / length, length) } else { 0.0 };
    Ok(ReflectedLight { energy: amplitude * covered, fresnel: fresnel * covered })
}

/// True if the origin is on a lit side. The vertices run clockwise as seen from the lit side.
fn faces(vertices: &[DVec3], sides: Sides) -> bool {
    sides == Sides::Two || volume(vertices) > 0.0
}

/// Six times the volume between a parallelogram's first three corners and the origin.
fn volume(vertices: &[DVec3]) -> f64 {
    (vertices[1] - vertices[0]).cross(vertices[2] - vertices[0]).dot(vertices[0])
}

/// Computes the light from its point nearest to the ray of the mirrored view: energy, and energy weighted by Schlick's
/// fifth power.
fn representative_point(at: &LitPoint<'_, f64>) -> [f64; 2] {
    let vertices: Vec<DVec3> = at.vertices.iter().map(|v| DVec3::from_array(*v)).collect();
    if !faces(&vertices, at.sides) {
        return [0.0; 2];
    }
    let [corner, x, y] = [vertices[0], vertices[1] - vertices[0], vertices[3] - vertices[0]];
    let across = x.cross(y);
    let wo = DVec3::from_array(at.wo);
    let mirrored = DVec3::new(-wo.x, -wo.y, wo.z);
    // A ray that leaves the plane is treated as meeting it far away, in its direction along the plane.
    let descent = mirrored.dot(across) / corner.dot(across);
    let met = if descent > 1e-4 { mirrored / descent } else { 1e4 * mirrored } - corner;
    let part = |side: DVec3| (met.dot(side) / side.length_squared()).clamp(0.0, 1.0);
    let point = corner + part(x) * x + part(y) * y;
    let centre = corner + 0.5 * (x + y);
    let radius = 0.5 * across.length().sqrt();
    let widened = |alpha: f64| (alpha + radius / (2.0 * centre.length())).min(1.0);
    let peak = at.alpha.iter().map(|alpha| alpha / widened(*alpha)).product::<f64>();
    let ggx = Ggx { alpha_x: at.alpha[0], alpha_y: at.alpha[1] };
    let wi = point.normalize_or_zero();
    let reflected = (ggx.eval_cos(wo, wi) * peak * solid_angle(&vertices)).clamp(0.0, 1.0);
    let cosine = wo.dot((wo + wi).normalize_or_zero()).clamp(0.0, 1.0);
    [reflected, reflected * (1.0 - cosine).powi(5)]
}

/// The solid angle of a parallelogram seen from the origin, from two triangles [Van Oosterom and Strackee 1983].
fn solid_angle(vertices: &[DVec3]) -> f64 {
    let unit: Vec<DVec3> = vertices.iter().map(|v| v.normalize_or_zero()).collect();
    let triangle = |[a, b, c]: [DVec3; 3]| 2.0 * atan2(a.cross(b).dot(c).abs(), 1.0 + a.dot(b) + b.dot(c) + c.dot(a));
    triangle([unit[0], unit[1], unit[2]]) + triangle([unit[0], unit[2], unit[3]])
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;
    use crate::{cases::cosine, truth};
    use ltcforge_fit::{BrdfKind, BrdfModel, Terms};

    fn square(at: DVec3, half: f64, sides: Sides) -> PolygonLight {
        let (x, y) = (DVec3::new(half, 0.0, 0.0), DVec3::new(0.0, half, 0.0));
        PolygonLight::new(vec![at - x - y, at + x - y, at + x + y, at - x + y], sides).expect("a square")
    }

    /// A table whose lobes are all the clamped cosine.
    fn table() -> Table {
        let table = cosine(BrdfModel::from(BrdfKind::Ggx));
        Table { terms: Some(Terms { amplitude: vec![1.0], fresnel: vec![0.0], edge: None }), ..table }
    }

    const AT: Configuration = Configuration { alpha_x: 0.3, alpha_y: 0.3, theta: 0.6, phi: 0.4 };

    #[test]
    fn a_side_of_a_cube_is_a_sixth_of_all_directions() {
        let light = square(DVec3::Z, 1.0, Sides::One);
        assert!((solid_angle(light.vertices()) - 4.0 * PI / 6.0).abs() < 1e-12);
    }

    #[test]
    fn a_light_above_the_horizon_is_cut_by_nothing() {
        let light = square(DVec3::new(0.2, 0.1, 1.0), 0.1, Sides::One);
        let exact = by_table(&table(), &AT, &light).expect("a table").energy;
        for way in [EngineWay::Clipless, EngineWay::Stretched, EngineWay::Anisotropic] {
            let found = way.reflected(Some(&table()), &AT, &light).expect("a table").energy;
            assert!((found / exact - 1.0).abs() < 0.02, "{way}: {found}, {exact}");
        }
    }

    #[test]
    fn lights_seen_from_behind_are_dark() {
        let light = |sides| {
            let reversed: Vec<DVec3> = square(DVec3::Z, 0.1, sides).vertices().iter().rev().copied().collect();
            PolygonLight::new(reversed, sides).expect("a square")
        };
        for way in EngineWay::ALL {
            let found = |sides| way.reflected(Some(&table()), &AT, &light(sides)).expect("a table").energy;
            assert_eq!(found(Sides::One), 0.0, "{way}");
            assert!(found(Sides::Two) > 1e-3, "{way}");
        }
    }

    /// Directions are stretched along x and shrunk along y, and the view turns towards x.
    #[test]
    fn directions_are_stretched_by_the_roughness() {
        let at = Configuration { alpha_x: 0.6, alpha_y: 0.15, ..AT };
        let wo = direction(at.theta, at.phi) * DVec3::new(2.0, 0.5, 1.0);
        let stretched = Configuration {
            alpha_x: 0.3,
            alpha_y: 0.3,
            theta: (wo.x * wo.x + wo.y * wo.y).sqrt().atan2(wo.z),
            phi: wo.y.atan2(wo.x),
        };
        let light = square(DVec3::new(0.2, 0.1, 1.0), 0.1, Sides::One);
        let vertices = light.vertices().iter().map(|v| *v * DVec3::new(2.0, 0.5, 1.0)).collect();
        let wanted = PolygonLight::new(vertices, Sides::One).expect("a rectangle");
        let found = EngineWay::Stretched.reflected(Some(&table()), &at, &light).expect("a table").energy;
        let wanted = EngineWay::Clipless.reflected(Some(&table()), &stretched, &wanted).expect("a table").energy;
        assert!((found - wanted).abs() < 1e-12, "{found} {wanted}");
    }

    #[test]
    fn of_a_tiny_light_the_representative_point_is_exact() {
        for at in [AT, Configuration { alpha_x: 0.5, alpha_y: 0.1, theta: 1.2, phi: 2.0 }] {
            let light = square(DVec3::new(-0.4, -0.2, 1.0), 1e-4, Sides::One);
            let found = EngineWay::RepresentativePoint.reflected(None, &at, &light).expect("a light");
            let wanted = truth(&at, &light).expect("a light");
            for [found, wanted] in [[found.energy, wanted.energy], [found.fresnel, wanted.fresnel]] {
                assert!((found / wanted - 1.0).abs() < 2e-3, "{found} {wanted}");
            }
        }
    }

    /// A light that the mirrored view hits has the peak of the lobe. A light behind the viewer does not.
    #[test]
    fn the_nearest_point_of_a_light_that_is_hit_is_where_it_is_hit() {
        let wo = direction(0.5, 0.0);
        let light = square(DVec3::new(-wo.x, 0.0, wo.z), 0.2, Sides::One);
        let at = Configuration { alpha_x: 0.4, alpha_y: 0.4, theta: 0.5, phi: 0.0 };
        let away = Configuration { phi: PI, ..at };
        let found = |at| EngineWay::RepresentativePoint.reflected(None, at, &light).expect("a light").energy;
        assert!(found(&at) > 2.0 * found(&away) && found(&away) > 0.0, "{} {}", found(&at), found(&away));
    }
}
