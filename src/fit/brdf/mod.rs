//! The scattering models to which tables are fitted, one file each.
//!
//! A new model needs a file and a line in [`BrdfKind`].

mod beckmann;
mod burley_diffuse;
mod charlie;
mod charlie_neubelt;
mod f82;
mod fresnel;
mod fuzz;
mod ggx;
mod hemisphere;
mod model;
mod oren_nayar;
mod scattering;
mod symmetry;
mod tabulated;
#[cfg(test)]
mod tests;

pub use beckmann::Beckmann;
pub use burley_diffuse::BurleyDiffuse;
pub use charlie::Charlie;
pub use charlie_neubelt::CharlieNeubelt;
pub use f82::{EDGE_COSINE, edge_of_parts, edge_spread, edge_weight, f82_light};
pub use fresnel::{LobeFresnel, SecondLobe, WeightedF0};
pub use fuzz::Fuzz;
pub use ggx::Ggx;
pub use model::{BrdfModel, TabulatedFile};
pub use oren_nayar::OrenNayar;
pub(crate) use scattering::BrdfRules;
pub use scattering::{Bends, Brdf, BrdfSample, LobeTerms, cos_theta_d};
pub use symmetry::Mirrors;
#[cfg(any(test, feature = "testing"))]
pub use tabulated::planted::{planted as planted_tabulated, planted_anisotropic};
pub use tabulated::{Asymmetry, MOST_ALBEDO, MOST_VALUES, TabulatedAxes, TabulatedBrdf, TabulatedFault};

use super::{axes::PerAxis, named_list};

named_list! {
    /// The scattering model to which a table is fitted.
    pub enum BrdfKind: BrdfRules {
        /// Anisotropic GGX with height-correlated Smith masking.
        Ggx = "ggx" => ggx::GgxRules,
        /// Anisotropic Beckmann with height-correlated Smith masking.
        Beckmann = "beckmann" => beckmann::BeckmannRules,
        /// Sheen: Charlie with the visibility of Estevez and Kulla.
        Charlie = "charlie" => charlie::CharlieRules,
        /// Sheen: Charlie with the visibility of Neubelt and Pettineo, as in glTF.
        CharlieNeubelt = "charlie_neubelt" => charlie_neubelt::CharlieNeubeltRules,
        /// Burley's diffuse reflection.
        BurleyDiffuse = "burley_diffuse" => burley_diffuse::BurleyDiffuseRules,
        /// Energy-preserving Oren-Nayar [Portsmouth, Kutz and Hill 2024].
        OrenNayar = "oren_nayar" => oren_nayar::OrenNayarRules,
        /// Sheen of a volume of fibres [Zeltner, Burley and Chiang 2022]. Its lobes are LTCs.
        Fuzz = "fuzz" => fuzz::FuzzRules,
        /// A BRDF whose values are in a file.
        Tabulated = "tabulated" => tabulated::TabulatedRules,
    }
}

impl BrdfKind {
    /// The models that are formulas and need no file.
    pub fn formulas() -> impl Iterator<Item = Self> {
        Self::ALL.iter().copied().filter(|kind| !kind.needs_file())
    }

    /// The surface with these roughnesses along x and y. Domain: both in (0, 1], and the model is a formula. For models
    /// with a file see [`BrdfModel::surface`].
    #[must_use]
    pub fn surface(self, roughness: [f64; 2]) -> Box<dyn Brdf> {
        self.rules().surface(roughness)
    }

    /// The surface at a point of a table. Its x axis is the axis of the larger roughness. Domain: the same as for
    /// [`BrdfKind::surface`].
    #[must_use]
    pub fn surface_at(self, place: &PerAxis<f64>) -> Box<dyn Brdf> {
        self.surface(place.roughness())
    }

    /// True if the values are in a file that the recipe names.
    #[must_use]
    pub fn needs_file(self) -> bool {
        self.rules().needs_file()
    }

    /// True if surfaces look the same from all azimuths. Tables of isotropic surfaces have a ratio of one only. A file
    /// can also contain anisotropic surfaces: see [`BrdfModel::is_isotropic`].
    #[must_use]
    pub fn is_isotropic(self) -> bool {
        self.rules().is_isotropic()
    }

    /// True if a Fresnel factor scales the reflected light, so a recipe can set the factor. This holds for models of
    /// reflecting microfacets.
    #[must_use]
    pub fn has_fresnel(self) -> bool {
        self.follows_reflection() && !self.needs_file()
    }

    /// True if the lobes are LTCs. The entries of a table are then the model's own lobes, and nothing is fitted.
    #[must_use]
    pub fn is_ltc(self) -> bool {
        self.rules().is_ltc()
    }

    /// True if lobes are centred near the reflection of GGX, as layout `reflected` requires.
    #[must_use]
    pub fn follows_reflection(self) -> bool {
        self.rules().follows_reflection()
    }
}
