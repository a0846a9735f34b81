//! The light that the nine materials reflect, in truth and by a light model.

use std::sync::LazyLock;

use glam::{DMat3, DVec3};

use super::{
    glass::through_glass,
    list::{Base, COAT_F0, GLASS_ETA, Material},
    sphere::Point,
};
use ltcforge::fit::{
    BrdfKind, Ltc, Sides,
    brdf::{Brdf, Ggx, LobeTerms, edge_of_parts, f82_light},
    math::{Lattice, SquarePoint},
};
use ltcforge_light::{
    LightError, Lighting, PolygonLight, ReflectedLight, edge_truth_of, layers, transmission::transmitted, truth_of,
    truth_within,
};

/// The tolerance of the truth per part of an edge: a tenth of the last digit of the errors in the picture.
pub(super) const TRUTH_TOLERANCE: f64 = 1e-6;
/// Sample points for the true albedo of a coat.
const ALBEDO_POINTS: usize = 4096;

static ALBEDO: LazyLock<Vec<SquarePoint>> =
    LazyLock::new(|| Lattice::new(ALBEDO_POINTS, [0.0; 2]).points().map(SquarePoint::new).collect());

/// How the light of lobes is computed.
#[derive(Debug, Clone, Copy)]
pub(super) enum Way<'a> {
    /// By quadrature of the scattering model.
    Truth,
    /// By a model of light.
    Model(Lighting<'a>),
}

/// The light of a lamp of radiance one that a material sends to the viewer, by channel. `None` for glass by a table,
/// because tables store no refraction.
///
/// # Errors
/// The errors of the light of each lobe.
pub(super) fn shade(material: &Material, way: Way<'_>, point: &Point) -> Result<Option<[f64; 3]>, LightError> {
    let light = point.light()?;
    let lit = Lit { way, point, light: &light };
    let base = match material.base {
        Base::Metal { alpha, f0, tint } => lit.metal(alpha, f0, tint)?,
        Base::Diffuse(colour) => colour.map(|part| part * lit.lambert()),
        Base::Glass { alpha } => {
            let Some(through) = lit.through(alpha) else { return Ok(None) };
            let reflected = lit.schlick(alpha, COAT_F0)?;
            return Ok(Some([through + reflected; 3]));
        }
    };
    let coated = match material.coat {
        Some((alpha, colour)) => {
            let (coat, albedo) = (lit.schlick([alpha; 2], COAT_F0)?, lit.albedo([alpha; 2], COAT_F0)?);
            [0, 1, 2].map(|i| layers::coated(base[i], coat, albedo, 1.0, colour[i]))
        }
        None => base,
    };
    Ok(Some(match material.fuzz {
        Some((roughness, colour)) => {
            let [fuzz, albedo] = lit.fuzz(roughness)?;
            [0, 1, 2].map(|i| layers::fuzzed(coated[i], colour[i] * fuzz, albedo, 1.0))
        }
        None => coated,
    }))
}

/// A point, a lamp, and how the lamp's light is computed.
struct Lit<'a> {
    way: Way<'a>,
    point: &'a Point,
    light: &'a PolygonLight,
}

impl Lit<'_> {
    fn ggx(&self, alpha: [f64; 2]) -> Result<ReflectedLight, LightError> {
        let at = self.point.of(alpha);
        match self.way {
            Way::Truth => truth_within(TRUTH_TOLERANCE, &at, self.light),
            Way::Model(model) => model.reflected(&at, self.light),
        }
    }

    /// The light that a dielectric reflects. A table with blended lobes uses the blend.
    fn schlick(&self, alpha: [f64; 2], f0: f64) -> Result<f64, LightError> {
        match self.way {
            Way::Truth => Ok(self.ggx(alpha)?.schlick(f0, 1.0)),
            Way::Model(model) => model.of_material(&self.point.of(alpha), self.light, [f0, 1.0]),
        }
    }

    /// The light that a metal reflects, by F82. A table without an edge term gets the edge term that follows from the
    /// light's energy and Fresnel part.
    fn metal(&self, alpha: [f64; 2], f0: [f64; 3], tint: [f64; 3]) -> Result<[f64; 3], LightError> {
        let parts = self.ggx(alpha)?;
        let at = self.point.of(alpha);
        let edge = match self.way {
            Way::Truth => edge_truth_of(&BrdfKind::Ggx.into(), TRUTH_TOLERANCE, &at, self.light)?,
            Way::Model(Lighting::Table(table, _)) if table.lookup(&at).edge.is_none() => {
                edge_of_parts([parts.energy, parts.fresnel])
            }
            Way::Model(model) => model.edge(&at, self.light)?,
        };
        let mut reflected = [0.0; 3];
        for i in 0..3 {
            let schlick = match self.way {
                Way::Truth => parts.schlick(f0[i], 1.0),
                Way::Model(model) => model.of_material(&at, self.light, [f0[i], 1.0])?,
            };
            reflected[i] = f82_light(schlick, edge, [f0[i], 1.0], tint[i]);
        }
        Ok(reflected)
    }

    /// The diffuse light of a white surface. Its closed form is exact, so it is the same in truth and for every model.
    fn lambert(&self) -> f64 {
        Ltc::new(DMat3::IDENTITY).map_or(0.0, |cosine| cosine.polygon(self.light.vertices(), self.light.sides()))
    }

    /// The part of uniform light that a dielectric reflects. The truth uses samples, and a table uses its terms. A
    /// closed form uses the light of a polygon that covers the sky.
    fn albedo(&self, alpha: [f64; 2], f0: f64) -> Result<f64, LightError> {
        let at = self.point.of(alpha);
        match self.way {
            Way::Truth => {
                let ggx = Ggx { alpha_x: alpha[0], alpha_y: alpha[1] };
                let LobeTerms { amplitude, fresnel } = ggx.terms(self.point.wo, &ALBEDO);
                Ok(f0 * (amplitude - fresnel) + fresnel)
            }
            Way::Model(Lighting::Table(table, _)) => {
                let found = table.lookup(&at);
                let (amplitude, fresnel) = found.amplitude.zip(found.fresnel).ok_or(LightError::NoTerms)?;
                Ok(f0 * (amplitude - fresnel) + fresnel)
            }
            Way::Model(model) => model.of_material(&at, &sky()?, [f0, 1.0]),
        }
    }

    /// The light and the albedo of white fuzz.
    fn fuzz(&self, roughness: f64) -> Result<[f64; 2], LightError> {
        let at = self.point.of([roughness * roughness; 2]);
        let found = layers::by_fuzz(roughness, &at, self.light)?;
        match self.way {
            Way::Truth => {
                let truth = truth_of(&BrdfKind::Fuzz.into(), TRUTH_TOLERANCE, &at, self.light)?;
                Ok([truth.energy, found[1]])
            }
            Way::Model(_) => Ok(found),
        }
    }

    /// The light from inside the glass, for a basic radiance of one.
    fn through(&self, alpha: [f64; 2]) -> Option<f64> {
        let (wo, lamp) = (self.point.wo.to_array(), self.point.lamp.map(|vertex| vertex.to_array()));
        match self.way {
            Way::Truth => Some(through_glass(alpha, self.point.wo, GLASS_ETA, &self.point.lamp)),
            Way::Model(Lighting::ClosedForm(_)) => Some(transmitted(alpha, wo, GLASS_ETA, &lamp, Sides::Two).schlick),
            Way::Model(Lighting::Table(..)) => None,
        }
    }
}

/// A light that covers the whole sky except its lowest thousandth.
fn sky() -> Result<PolygonLight, LightError> {
    let corners = [[-1.0, -1.0], [-1.0, 1.0], [1.0, 1.0], [1.0, -1.0]];
    PolygonLight::new(corners.map(|[x, y]| DVec3::new(x, y, 1e-3)).to_vec(), Sides::Two)
}
