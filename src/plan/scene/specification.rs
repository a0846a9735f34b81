//! The specular reflection of a glTF material, as the specification states it. Plans are measured with it.
//!
//! Invariant: this code shares nothing with the reduction to lobes in `material`.

/// The parameters of a material at a point.
#[derive(Debug, Clone, Copy)]
pub(super) struct Specification {
    pub(super) base_color: [f64; 3],
    pub(super) metallic: f64,
    pub(super) ior: f64,
    pub(super) specular: f64,
    pub(super) specular_color: [f64; 3],
}

impl Specification {
    /// Luminance of the reflectance at normal and at grazing incidence, where the mix of metal and dielectric reflects
    /// `f0 + (f90 - f0) (1 - wo . h)^5` [glTF 2.0, appendix B; `KHR_materials_specular`, `KHR_materials_ior`].
    pub(super) fn reflectance(&self) -> [f64; 2] {
        const REC_709: [f64; 3] = [0.2126, 0.7152, 0.0722];
        let mut sums = [0.0; 2];
        for (channel, share) in REC_709.into_iter().enumerate() {
            let of_ior = ((1.0 - self.ior) / (1.0 + self.ior)).powi(2);
            let dielectric_f0 = f64::min(of_ior * self.specular_color[channel], 1.0) * self.specular;
            let dielectric_f90 = self.specular;
            let mix = |dielectric: f64, metal: f64| dielectric * (1.0 - self.metallic) + metal * self.metallic;
            sums[0] += share * mix(dielectric_f0, self.base_color[channel]);
            sums[1] += share * mix(dielectric_f90, 1.0);
        }
        sums
    }
}
