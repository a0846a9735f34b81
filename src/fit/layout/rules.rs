//! The interface of a layout.

use glam::{DMat3, Mat3, Vec3};

use super::{
    precision::Precision,
    shader_axes::{ShaderAxes, ShaderPlace},
    spacing::Spacing,
};
use crate::{
    axes::PerAxis,
    brdf::{LobeTerms, Mirrors},
};

/// The matrix and the two terms of a lobe, or the numbers that a layout stores for the lobe.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct LobeNumbers {
    /// The matrix.
    pub(crate) matrix: DMat3,
    /// Amplitude and Fresnel term.
    pub(crate) terms: LobeTerms,
}

/// The numbers of a lobe in f32, as in a shader.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ShaderNumbers {
    /// The matrix.
    pub matrix: Mat3,
    /// Amplitude.
    pub amplitude: f32,
    /// Fresnel term.
    pub fresnel: f32,
}

/// The shader code of a layout. Layouts can share a source.
#[derive(Debug, Clone, Copy)]
pub struct LayoutShader {
    /// WGSL, in parts.
    pub sources: &'static [&'static str],
    /// The shader function with the CPU twin [`LayoutRules::restore_in_shader`].
    pub restore: &'static str,
    /// The shader function with the CPU twin [`LayoutRules::place_in_shader`]. For a layout of isotropic tables it
    /// returns the position along the table's two axes.
    pub place: &'static str,
    /// True for layouts of isotropic tables, which have two axes.
    pub is_isotropic: bool,
    /// The number of this layout, for a shader that reads several layouts.
    pub number: u32,
}

/// The stored numbers that a fit can choose to minimise the error between nodes. The matrix is symmetric about the
/// plane of incidence.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct FreeNumbers {
    /// True if the stored matrix is `M^-1`, false if it is `M`.
    pub is_inverse: bool,
    /// Column and row of the number that is always one.
    pub fixed: Option<[usize; 2]>,
}

/// The dependence of a layout's error on its nodes.
pub(crate) struct Interpolation {
    /// The error with infinitely many nodes, mostly the error of the best LTCs.
    pub(crate) limit: f64,
    /// The error that a step of the whole domain adds. The error of linear interpolation grows with the square of the
    /// step.
    pub(crate) step: PerAxis<f64>,
}

/// A layout as an item of [`super::Layout`]. All points passed to its functions are within the range of the nodes.
pub(crate) trait LayoutRules: Sync {
    /// The default number of nodes on each axis.
    fn default_resolution(&self) -> PerAxis<u32>;

    /// The spacing of the nodes on each axis.
    fn spacing(&self) -> PerAxis<Spacing>;

    /// Ascending nodes of each axis, from one end of a range to the other or to the limit of the fit.
    fn nodes(&self, range: &PerAxis<[f64; 2]>, resolution: &PerAxis<u32>) -> PerAxis<Vec<f64>>;

    /// The fixed ranges of a layout whose shaders support only one domain; `None` if the recipe sets the ranges.
    fn only_ranges(&self) -> Option<PerAxis<[f64; 2]>> {
        None
    }

    /// True if alpha and ratio are one axis of pairs.
    fn is_of_materials(&self) -> bool {
        false
    }

    /// True if lobes are stored relative to GGX's reflection. Lobes must then be centred near this reflection.
    fn is_relative(&self) -> bool {
        false
    }

    /// The variable of each axis in which interpolation weights are linear. The default is the value itself.
    fn weights(&self) -> PerAxis<Spacing> {
        PerAxis { alpha: Spacing::Even, ratio: Spacing::Even, theta: Spacing::Even, phi: Spacing::Even }
    }

    /// CPU twin of the shader function that finds the position of a configuration among a table's nodes. The weights
    /// are linear in the variables of [`LayoutRules::weights`].
    fn place_in_shader(&self, axes: &ShaderAxes, alpha: f32, ratio: f32, wo: Vec3) -> ShaderPlace;

    /// The smallest ratio of the eigenvalues of a stored block. At grazing angles the best fit of a curved, line-like
    /// lobe has a ratio of zero. The determinant of the rounded matrix stays positive if the ratio is about 100 (f32)
    /// or 8 (f16) times the rounding error of the format.
    fn flattest(&self, precision: Precision) -> f64;

    /// The stored numbers of a lobe, before rounding. The matrix is not yet divided by [`LayoutRules::norm`].
    fn store(&self, place: &PerAxis<f64>, lobe: &LobeNumbers, mirrors: Mirrors, precision: Precision) -> LobeNumbers;

    /// The numbers that the fit chooses to minimise the error between nodes, for layouts of isotropic tables. `None`
    /// for other layouts, whose entries are stored as fitted.
    fn free_numbers(&self) -> Option<FreeNumbers> {
        None
    }

    /// Clamps numbers to the range that the precision can represent and a shader can invert.
    fn limited(&self, stored: LobeNumbers, _precision: Precision) -> LobeNumbers {
        stored
    }

    /// The divisor of a stored matrix. The default is the length of its third column.
    fn norm(&self, stored: &DMat3) -> f64 {
        stored.z_axis.length()
    }

    /// The stored form of the terms.
    fn store_terms(&self, place: &PerAxis<f64>, terms: LobeTerms) -> LobeTerms;

    /// Converts stored numbers to a lobe: the inverse of [`LayoutRules::store`].
    fn restore(&self, place: &PerAxis<f64>, stored: &LobeNumbers) -> LobeNumbers;

    /// CPU twin of the shader's version of [`LayoutRules::restore`], in f32. `alpha` is the larger roughness and `wo`
    /// the view direction.
    fn restore_in_shader(&self, stored: &ShaderNumbers, alpha: f32, ratio: f32, wo: Vec3) -> ShaderNumbers;

    /// The dependence of the error on the nodes.
    fn interpolation(&self) -> Interpolation;

    /// The shader code of the layout.
    fn shader(&self) -> LayoutShader;
}
