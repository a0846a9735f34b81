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

/// Nine numbers and two terms: those of a lobe, or those that a layout stores for it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct LobeNumbers {
    /// The matrix.
    pub(crate) matrix: DMat3,
    /// Amplitude and Fresnel term.
    pub(crate) terms: LobeTerms,
}

/// The same in 32 bits, as a shader has them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ShaderNumbers {
    /// The matrix.
    pub matrix: Mat3,
    /// Amplitude.
    pub amplitude: f32,
    /// Fresnel term.
    pub fresnel: f32,
}

/// A layout's part of the shader. Layouts may share a source.
#[derive(Debug, Clone, Copy)]
pub struct LayoutShader {
    /// WGSL, in parts.
    pub sources: &'static [&'static str],
    /// The function that is the twin of [`LayoutRules::restore_in_shader`].
    pub restore: &'static str,
    /// The function that is the twin of [`LayoutRules::place_in_shader`]; in a layout of isotropic tables, where a
    /// configuration lies along the two axes that these have.
    pub place: &'static str,
    /// Whether it is a layout of isotropic tables alone, which have two axes.
    pub is_isotropic: bool,
    /// The number that identifies this layout in a shader that reads several.
    pub number: u32,
}

/// The stored numbers that a fit may choose for the least error between nodes: those of a matrix that is symmetric in
/// the plane of incidence.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct FreeNumbers {
    /// Whether the matrix is that of `M^-1`, not of `M`.
    pub is_inverse: bool,
    /// The number that is always one, by column and row.
    pub fixed: Option<[usize; 2]>,
}

/// How a layout's error depends on its nodes.
pub(crate) struct Interpolation {
    /// The error that remains with infinitely many nodes: mostly that of the best LTCs.
    pub(crate) limit: f64,
    /// The error that a step of the whole domain adds. The error of linear interpolation grows with the square of the
    /// step.
    pub(crate) step: PerAxis<f64>,
}

/// A layout as an item of [`super::Layout`]. Places are within the layout's nodes.
pub(crate) trait LayoutRules: Sync {
    /// Nodes on each axis unless a recipe says otherwise.
    fn default_resolution(&self) -> PerAxis<u32>;

    /// How nodes are spaced on each axis.
    fn spacing(&self) -> PerAxis<Spacing>;

    /// Ascending nodes of each axis, from one end of a range to the other or to the limit of the fit.
    fn nodes(&self, range: &PerAxis<[f64; 2]>, resolution: &PerAxis<u32>) -> PerAxis<Vec<f64>>;

    /// The ranges of a layout that stands for one domain only, because its readers take no other; `None` where a recipe
    /// may choose.
    fn only_ranges(&self) -> Option<PerAxis<[f64; 2]>> {
        None
    }

    /// Whether alpha and ratio are one axis of pairs.
    fn is_of_materials(&self) -> bool {
        false
    }

    /// Whether lobes are stored relative to GGX's reflection, so that they have to lie around it.
    fn is_relative(&self) -> bool {
        false
    }

    /// The variable of each axis in which weights between nodes are linear: by default the axis's values themselves.
    fn weights(&self) -> PerAxis<Spacing> {
        PerAxis { alpha: Spacing::Even, ratio: Spacing::Even, theta: Spacing::Even, phi: Spacing::Even }
    }

    /// Twin of the layout's part of the shader: where a configuration lies among a table's nodes, with the weights of
    /// [`LayoutRules::weights`].
    fn place_in_shader(&self, axes: &ShaderAxes, alpha: f32, ratio: f32, wo: Vec3) -> ShaderPlace;

    /// The least ratio of the eigenvalues of a stored block. At grazing angles a lobe may be a curved line, which fits
    /// best with a ratio of zero. In numbers of 24 or 11 bits the determinant of a matrix stays positive if its block
    /// is some 100 or 8 times wider than their last bit.
    fn flattest(&self, precision: Precision) -> f64;

    /// The numbers that are stored for a lobe, before rounding, up to a factor of the matrix that
    /// [`LayoutRules::norm`] sets.
    fn store(&self, place: &PerAxis<f64>, lobe: &LobeNumbers, mirrors: Mirrors, precision: Precision) -> LobeNumbers;

    /// The numbers that are chosen for the least error between nodes, where a layout's readers leave nothing else to
    /// choose: isotropic tables of one domain. `None` where entries are stored as they fit their own lobes.
    fn free_numbers(&self) -> Option<FreeNumbers> {
        None
    }

    /// The numbers that are nearest to these, among those that numbers of a precision can hold and a reader can invert.
    fn limited(&self, stored: LobeNumbers, _precision: Precision) -> LobeNumbers {
        stored
    }

    /// The divisor of a stored matrix: by default the length of its third column.
    fn norm(&self, stored: &DMat3) -> f64 {
        stored.z_axis.length()
    }

    /// The terms alone, as they are stored.
    fn store_terms(&self, place: &PerAxis<f64>, terms: LobeTerms) -> LobeTerms;

    /// The lobe of stored numbers: the inverse of [`LayoutRules::store`].
    fn restore(&self, place: &PerAxis<f64>, stored: &LobeNumbers) -> LobeNumbers;

    /// Twin of the layout's part of the shader: [`LayoutRules::restore`] in 32 bits, for larger roughness, ratio and
    /// view direction.
    fn restore_in_shader(&self, stored: &ShaderNumbers, alpha: f32, ratio: f32, wo: Vec3) -> ShaderNumbers;

    /// How the error depends on the nodes.
    fn interpolation(&self) -> Interpolation;

    /// The layout's part of the shader.
    fn shader(&self) -> LayoutShader;
}
