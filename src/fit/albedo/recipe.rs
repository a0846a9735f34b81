//! Recipes of lookup tables.

use std::{f64::consts::FRAC_PI_2, fmt};

use serde::{Serialize, Serializer};

use super::{
    anisotropic::anisotropic,
    axes::{ALPHA, Axis, Curve, INDEX, LutAxes, PHI, RATIO, THETA, Texels},
    ggx::ggx,
    glass::glass,
    quadrature::{MOST_NODES, albedo, nodes_of_fibres},
};
use crate::{
    brdf::BrdfKind,
    math::{atan2, direction, from_half_bits, half_bits_f64},
    named_list,
};

/// The smallest alpha of a value. Smoother surfaces have the value of this alpha.
const LEAST_ALPHA: f64 = 1e-4;
/// The smallest cosine of a value. Lower views have the value of this cosine.
pub(super) const LEAST_COSINE: f64 = 1e-3;
/// The smallest cosine of the domain in which errors are stated.
const DOMAIN_COSINE: f64 = 0.01;
/// The smallest alpha of the domain in which errors are stated, except for tables of kind `albedo`.
const DOMAIN_ALPHA: f64 = 0.002;
/// The smallest ratio of a value. Narrower surfaces have the value of this ratio.
const LEAST_RATIO: f64 = 0.01;

named_list! {
    /// The values of a lookup table.
    pub enum LutKind {
        /// The two terms of the split sum for GGX [Karis 2013].
        Dfg = "dfg",
        /// The directional albedo of GGX, and its average over the hemisphere.
        Albedo = "albedo",
        /// The directional albedo of a sheen.
        Sheen = "sheen",
        /// The directional albedo of a diffuse reflection.
        Diffuse = "diffuse",
        /// The reflected and the transmitted albedo of rough glass.
        Transmission = "transmission",
        /// The terms of `dfg` for anisotropic GGX.
        AnisotropicDfg = "anisotropic_dfg",
    }
}

named_list! {
    /// The two terms of a `dfg` table.
    pub enum DfgForm {
        /// Scale and bias: the reflectance is `F0 scale + F90 bias` [Karis 2013].
        Karis = "karis",
        /// Filament's pair: the reflectance is `mix(x, y, F0)`. `x` is the bias, `y` the albedo.
        Filament = "filament",
        /// Scale, bias and the F82 tint's term: the reflectance is `F0 scale + F90 bias - b metal_bias` [Hoffman 2019].
        F82 = "f82",
    }
}

impl LutKind {
    /// The scattering models that a table of this kind can have, the default first.
    #[must_use]
    pub fn brdfs(self) -> &'static [BrdfKind] {
        match self {
            Self::Dfg | Self::Albedo | Self::Transmission | Self::AnisotropicDfg => &[BrdfKind::Ggx],
            Self::Sheen => &[BrdfKind::Charlie, BrdfKind::CharlieNeubelt, BrdfKind::Fuzz],
            Self::Diffuse => &[BrdfKind::BurleyDiffuse, BrdfKind::OrenNayar],
        }
    }

    /// The names of the axes. The last axis is the fastest.
    #[must_use]
    pub fn axes(self) -> &'static [&'static str] {
        match self {
            Self::Transmission => &["ior", "roughness", "cos_theta"],
            Self::AnisotropicDfg => &["alpha", "ratio", "theta", "phi"],
            _ => &["roughness", "cos_theta"],
        }
    }

    /// Whether a table of this kind has a form.
    #[must_use]
    pub fn has_forms(self) -> bool {
        matches!(self, Self::Dfg | Self::AnisotropicDfg)
    }
}

named_list! {
    /// A number format of a lookup table.
    pub enum LutPrecision {
        /// 32-bit floats.
        F32 = "f32",
        /// Halves.
        F16 = "f16",
        /// 16-bit integers from 0 to 1.
        Unorm16 = "unorm16",
        /// 8-bit integers from 0 to 1.
        Rgba8 = "rgba8",
    }
}

impl LutPrecision {
    /// The largest integer of the format. `None` for floats.
    #[must_use]
    pub fn steps(self) -> Option<u16> {
        match self {
            Self::F32 | Self::F16 => None,
            Self::Unorm16 => Some(u16::MAX),
            Self::Rgba8 => Some(u16::from(u8::MAX)),
        }
    }

    /// The nearest number of the format.
    #[must_use]
    pub fn round(self, x: f64) -> f32 {
        match self.steps() {
            Some(steps) => ((x.clamp(0.0, 1.0) * f64::from(steps)).round() / f64::from(steps)) as f32,
            None if self == Self::F16 => from_half_bits(half_bits_f64(x)),
            None => x as f32,
        }
    }
}

/// The number of texels on each axis, in the order of [`LutKind::axes`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct LutResolution {
    axes: &'static [&'static str],
    texels: [u32; 4],
}

impl LutResolution {
    /// The resolution of a table of a kind, with `texels` on each axis.
    #[must_use]
    pub fn new(table: LutKind, mut texels: impl FnMut(&'static str) -> u32) -> Self {
        let mut of = [1; 4];
        of.iter_mut().zip(table.axes()).for_each(|(of, axis)| *of = texels(axis));
        Self { axes: table.axes(), texels: of }
    }

    /// The number of texels on each axis.
    #[must_use]
    pub fn texels(&self) -> &[u32] {
        &self.texels[..self.axes.len()]
    }
}

impl Serialize for LutResolution {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(self.axes.iter().zip(self.texels()))
    }
}

/// `32 x 32`.
impl fmt::Display for LutResolution {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let texels: Vec<String> = self.texels().iter().map(u32::to_string).collect();
        f.write_str(&texels.join(" x "))
    }
}

/// A complete recipe of a lookup table. Equal recipes give equal bytes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct LutRecipe {
    /// The version of the fitter for which the recipe was written.
    pub fitter: u32,
    /// The values of the table.
    pub table: LutKind,
    /// Scattering model.
    pub brdf: BrdfKind,
    /// The terms of a `dfg` or `anisotropic_dfg` table.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub form: Option<DfgForm>,
    /// The number of texels.
    pub resolution: LutResolution,
    /// The parameters of the texels. `None` for those of layout `reflected`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub axes: Option<LutAxes>,
    /// Number format of the table.
    pub precision: LutPrecision,
}

impl LutRecipe {
    /// Texels of the table.
    #[must_use]
    pub fn entries(&self) -> u64 {
        self.resolution.texels().iter().map(|n| u64::from(*n)).product()
    }

    /// Where the parameters 0 and 1 are.
    #[must_use]
    pub fn texels(&self) -> Texels {
        self.axes.map_or(Texels::Corners, |axes| axes.texels)
    }

    /// The names of the axes with their parameters, such as `cos_theta (cube_root)`; axes of layout `reflected` have
    /// only a name. The last axis is the fastest.
    #[must_use]
    pub fn axis_names(&self) -> Vec<String> {
        let axes = self.axes.unwrap_or_default();
        let named = |name: &&str| match *name {
            "ior" => "ior (cube root of 2 (n - 1) / (n + 1))".to_owned(),
            "roughness" => format!("roughness ({})", axes.roughness),
            "cos_theta" => format!("cos_theta ({})", axes.cos_theta),
            of_layout => of_layout.to_owned(),
        };
        self.table.axes().iter().map(named).collect()
    }

    /// The axes, with places at the parameters that `places` chooses. The last axis is the fastest.
    pub(super) fn grid(&self, places: impl Fn(&Axis) -> Vec<f64>) -> Vec<Axis> {
        let axes = self.axes.unwrap_or_default();
        // A furnace needs the albedo of all surfaces.
        let least = if self.table == LutKind::Albedo { LEAST_ALPHA } else { DOMAIN_ALPHA };
        let lowest = atan2((1.0 - DOMAIN_COSINE * DOMAIN_COSINE).sqrt(), DOMAIN_COSINE);
        let axis = |(name, texels): (&&'static str, &u32)| {
            let (curve, domain): (Curve, _) = match *name {
                "ior" => (INDEX, [1.0, 3.0]),
                "roughness" => (axes.roughness.curve(), [least, 1.0]),
                "cos_theta" => (axes.cos_theta.curve(), [DOMAIN_COSINE, 1.0]),
                "alpha" => (ALPHA, [DOMAIN_ALPHA, 1.0]),
                "ratio" => (RATIO, [LEAST_RATIO, 1.0]),
                "theta" => (THETA, [0.0, lowest]),
                _ => (PHI, [0.0, FRAC_PI_2]),
            };
            let mut axis = Axis::new(name, curve, domain, self.texels(), *texels as usize);
            axis.places = places(&axis);
            axis
        };
        self.table.axes().iter().zip(self.resolution.texels()).map(axis).collect()
    }

    /// The seconds of a value on the machine of the cost model, and the number of places of a report between the ends of
    /// an axis. They are prime numbers, so the places are at many positions between texels.
    pub(super) fn cost(&self) -> (f64, usize) {
        match (self.table, self.brdf) {
            (LutKind::Transmission, _) => (40e-6, 29),
            (LutKind::AnisotropicDfg, _) => (60e-6, 13),
            (_, BrdfKind::Ggx) => (8e-6, 223),
            (_, BrdfKind::Charlie | BrdfKind::CharlieNeubelt) => (35e-6, 67),
            _ => (120e-6, 67),
        }
    }

    /// The names of the channels.
    #[must_use]
    pub fn channels(&self) -> &'static [&'static str] {
        match (self.table, self.form) {
            (LutKind::Transmission, _) => &["reflected", "transmitted"],
            (_, Some(DfgForm::Karis)) => &["scale", "bias"],
            (_, Some(DfgForm::Filament)) => &["bias", "albedo"],
            (_, Some(DfgForm::F82)) => &["scale", "bias", "metal_bias"],
            (_, None) => &["albedo"],
        }
    }

    /// The values of the channels at a place: the value on each axis, in the order of [`LutKind::axes`]. Correct to 1e-6
    /// (isotropic GGX and glass) or 1e-5. Unused channels are 0.
    ///
    /// # Panics
    /// If `place` has fewer numbers than the table has axes.
    #[must_use]
    pub fn truth(&self, place: &[f64]) -> [f64; 3] {
        let alpha = |i: usize| place[i].max(LEAST_ALPHA);
        let cosine = |i: usize| place[i].max(LEAST_COSINE);
        let [total, bias, metal_bias] = match (self.table, self.brdf) {
            (LutKind::Transmission, _) => {
                let [reflected, transmitted] = glass(place[0], alpha(1), cosine(2));
                return [reflected, transmitted, 0.0];
            }
            (LutKind::AnisotropicDfg, _) => {
                let alpha_y = (alpha(0) * place[1].max(LEAST_RATIO)).max(LEAST_ALPHA);
                let mut wo = direction(place[2], place[3]);
                if wo.z < LEAST_COSINE {
                    wo = direction(atan2(1.0, LEAST_COSINE), place[3]);
                }
                anisotropic([alpha(0), alpha_y], wo)
            }
            (_, BrdfKind::Ggx) => ggx(alpha(0), cosine(1)),
            (_, brdf) => {
                let is_of_fibres = matches!(brdf, BrdfKind::Charlie | BrdfKind::CharlieNeubelt);
                let nodes = if is_of_fibres { nodes_of_fibres(alpha(0)) } else { [MOST_NODES; 2] };
                [albedo(&*brdf.surface([alpha(0); 2]), cosine(1), nodes), 0.0, 0.0]
            }
        };
        match self.form {
            Some(DfgForm::Filament) => [bias, total, 0.0],
            Some(_) => [total - bias, bias, metal_bias],
            None => [total, 0.0, 0.0],
        }
    }

    /// The values of the channels at a place of the grid. Places are row-major.
    pub(super) fn values_at(&self, axes: &[Axis], mut index: usize) -> [f64; 3] {
        let mut place = [0.0; 4];
        for (value, axis) in place.iter_mut().zip(axes).rev() {
            *value = axis.value(axis.places[index % axis.places.len()]);
            index /= axis.places.len();
        }
        self.truth(&place)
    }
}
