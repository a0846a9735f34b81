//! Recipes of lookup tables.

use serde::Serialize;

use super::{
    axes::{LEAST_ALPHA, LutAxes, Parameter},
    ggx::ggx,
    quadrature::albedo,
};
use crate::{
    brdf::BrdfKind,
    math::{from_half_bits, half_bits_f64},
    named_list,
};

/// The smallest alpha of the domain in which errors are stated, except for tables of kind `albedo`.
const DOMAIN_ALPHA: f64 = 0.002;

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
            Self::Dfg | Self::Albedo => &[BrdfKind::Ggx],
            Self::Sheen => &[BrdfKind::Charlie, BrdfKind::CharlieNeubelt, BrdfKind::Fuzz],
            Self::Diffuse => &[BrdfKind::BurleyDiffuse, BrdfKind::OrenNayar],
        }
    }

    /// The names of the channels.
    #[must_use]
    pub fn channels(self, form: Option<DfgForm>) -> &'static [&'static str] {
        match (self, form) {
            (Self::Dfg, Some(DfgForm::Filament)) => &["bias", "albedo"],
            (Self::Dfg, Some(DfgForm::F82)) => &["scale", "bias", "metal_bias"],
            (Self::Dfg, _) => &["scale", "bias"],
            _ => &["albedo"],
        }
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

/// The number of texels on each axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct LutResolution {
    /// Texels on the axis of roughness.
    pub roughness: u32,
    /// Texels on the axis of the view.
    pub cos_theta: u32,
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
    /// The terms of a `dfg` table.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub form: Option<DfgForm>,
    /// The number of texels.
    pub resolution: LutResolution,
    /// The parameters of the texels.
    pub axes: LutAxes,
    /// Number format of the table.
    pub precision: LutPrecision,
}

impl LutRecipe {
    /// Texels of the table.
    #[must_use]
    pub fn entries(&self) -> u64 {
        u64::from(self.resolution.roughness) * u64::from(self.resolution.cos_theta)
    }

    /// The parameter of each axis and its texels. The last axis is the fastest.
    pub(super) fn grid(&self) -> [(Parameter, usize); 2] {
        let LutResolution { roughness, cos_theta } = self.resolution;
        // A furnace needs the albedo of all surfaces.
        let least = if self.table == LutKind::Albedo { LEAST_ALPHA } else { DOMAIN_ALPHA };
        [
            (Parameter::Roughness(self.axes.roughness, least), roughness as usize),
            (Parameter::Cosine(self.axes.cos_theta), cos_theta as usize),
        ]
    }

    /// The names of the channels.
    #[must_use]
    pub fn channels(&self) -> &'static [&'static str] {
        self.table.channels(self.form)
    }

    /// The values of the channels at an alpha and a cosine, correct to 1e-6 (GGX) or 1e-5. Further numbers have no meaning.
    #[must_use]
    pub fn truth(&self, alpha: f64, cosine: f64) -> [f64; 3] {
        if self.brdf != BrdfKind::Ggx {
            return [albedo(&*self.brdf.surface([alpha; 2]), cosine), 0.0, 0.0];
        }
        let [total, bias, metal_bias] = ggx(alpha, cosine);
        match (self.table, self.form) {
            (LutKind::Dfg, Some(DfgForm::Filament)) => [bias, total, 0.0],
            (LutKind::Dfg, _) => [total - bias, bias, metal_bias],
            _ => [total, 0.0, 0.0],
        }
    }
}
