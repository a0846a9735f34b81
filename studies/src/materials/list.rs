//! The nine materials.

use glam::DVec3;

use super::sphere::Lamp;

/// F0 of coats, plastic and glass. Their refractive index is 1.5.
pub(super) const COAT_F0: f64 = 0.04;
pub(super) const GLASS_ETA: f64 = 1.5;

/// The lamp, and its position for glass, behind the surface.
const ABOVE: Lamp = Lamp { centre: DVec3::new(-1.2, 1.9, 2.1), half_size: [1.9, 1.1] };
const BEHIND: Lamp = Lamp { centre: DVec3::new(0.9, -1.1, -9.0), half_size: [1.9, 1.1] };

/// A base with the layers above it, combined as in OpenPBR.
#[derive(Debug)]
pub(super) struct Material {
    /// The name in the picture.
    pub(super) name: &'static str,
    pub(super) base: Base,
    /// Roughness and transmittance of a dielectric coat. The coat of plastic is the surface of the plastic itself.
    pub(super) coat: Option<(f64, [f64; 3])>,
    /// Roughness and colour of fuzz.
    pub(super) fuzz: Option<(f64, [f64; 3])>,
}

/// The material below the layers.
#[derive(Debug, Clone, Copy)]
pub(super) enum Base {
    /// GGX by F82: the reflectance at normal incidence, and the factor on Schlick's reflectance at 82 degrees.
    Metal { alpha: [f64; 2], f0: [f64; 3], tint: [f64; 3] },
    /// Lambert's reflection.
    Diffuse([f64; 3]),
    /// One rough interface with a lamp behind it.
    Glass { alpha: [f64; 2] },
}

const CLEAR: [f64; 3] = [1.0; 3];

impl Material {
    /// The lamp for the material.
    pub(super) fn lamp(&self) -> &'static Lamp {
        if matches!(self.base, Base::Glass { .. }) { &BEHIND } else { &ABOVE }
    }

    /// The roughnesses of all reflecting GGX lobes.
    pub(super) fn roughnesses(&self) -> impl Iterator<Item = [f64; 2]> {
        let base = match self.base {
            Base::Metal { alpha, .. } => Some(alpha),
            Base::Diffuse(_) | Base::Glass { .. } => None,
        };
        base.into_iter().chain(self.coat.map(|(alpha, _)| [alpha; 2]))
    }
}

/// The materials in the order of the picture. The numbers of gold come from its refractive index at 660, 549 and 451 nm
/// [Johnson and Christy 1972]. The other numbers were chosen by appearance.
pub(super) static MATERIALS: [Material; 9] = [
    Material {
        name: "brushed steel",
        base: Base::Metal { alpha: [0.5, 0.1], f0: [0.62, 0.6, 0.57], tint: [0.8, 0.82, 0.85] },
        coat: None,
        fuzz: None,
    },
    Material {
        name: "gold, F82",
        base: Base::Metal { alpha: [0.25; 2], f0: [0.963, 0.787, 0.408], tint: [0.986, 0.993, 0.978] },
        coat: None,
        fuzz: None,
    },
    Material {
        name: "rough chrome",
        base: Base::Metal { alpha: [0.5; 2], f0: [0.55, 0.56, 0.53], tint: [0.74, 0.78, 0.83] },
        coat: None,
        fuzz: None,
    },
    Material { name: "plastic", base: Base::Diffuse([0.6, 0.05, 0.04]), coat: Some((0.1, CLEAR)), fuzz: None },
    Material { name: "rough plastic", base: Base::Diffuse([0.03, 0.3, 0.28]), coat: Some((0.4, CLEAR)), fuzz: None },
    Material {
        name: "car paint",
        base: Base::Metal { alpha: [0.4; 2], f0: [0.05, 0.16, 0.55], tint: CLEAR },
        coat: Some((0.05, CLEAR)),
        fuzz: None,
    },
    Material {
        name: "coated brass",
        base: Base::Metal { alpha: [0.15, 0.5], f0: [0.89, 0.75, 0.42], tint: [0.95, 0.95, 0.95] },
        coat: Some((0.1, [0.9, 0.75, 0.55])),
        fuzz: None,
    },
    Material {
        name: "velvet",
        base: Base::Diffuse([0.18, 0.01, 0.05]),
        coat: None,
        fuzz: Some((0.4, [0.9, 0.55, 0.7])),
    },
    Material { name: "frosted glass", base: Base::Glass { alpha: [0.25; 2] }, coat: None, fuzz: None },
];
