//! Scattering models that tables are fitted to, one file each.
//!
//! A new model needs a file and a line in [`BrdfKind`].

mod ggx;
mod scattering;
mod symmetry;

pub use ggx::Ggx;
pub(crate) use scattering::BrdfRules;
pub use scattering::{Brdf, BrdfSample, LobeTerms};
pub(crate) use symmetry::Mirrors;

use super::{axes::PerAxis, named_list::named_list};

named_list! {
    /// The scattering model that is fitted.
    pub enum BrdfKind: BrdfRules {
        /// Anisotropic GGX with height-correlated Smith masking.
        Ggx = "ggx" => ggx::Rules,
    }
}

impl BrdfKind {
    /// The surface of these roughnesses along x and y. Domain: both in (0, 1].
    #[must_use]
    pub fn surface(self, roughness: [f64; 2]) -> Box<dyn Brdf> {
        self.rules().surface(roughness)
    }

    /// The surface at a place of a table, x along its larger roughness.
    #[must_use]
    pub fn surface_at(self, place: &PerAxis<f64>) -> Box<dyn Brdf> {
        self.surface(place.roughness())
    }
}
