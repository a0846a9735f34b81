//! The interface of a layout.

use glam::{DMat3, Mat3, Vec3};

use super::{precision::Precision, spacing::Spacing};
use crate::fit::{
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
#[cfg_attr(not(feature = "render"), allow(dead_code, reason = "only previews run the shader's twin"))]
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct ShaderNumbers {
    /// The matrix.
    pub(crate) matrix: Mat3,
    /// Amplitude.
    pub(crate) amplitude: f32,
    /// Fresnel term.
    pub(crate) fresnel: f32,
}

/// A layout's part of the shader: a function `ltc_restore_NAME`, twin of [`LayoutRules::restore_in_shader`].
pub(crate) struct LayoutShader {
    /// WGSL.
    pub(crate) source: &'static str,
    /// The number that identifies this layout in a shader that reads several.
    pub(crate) number: u32,
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

    /// Ascending nodes of each axis, from one end of a range to the other or to the limit of what can be fitted.
    fn nodes(&self, range: &PerAxis<[f64; 2]>, resolution: &PerAxis<u32>) -> PerAxis<Vec<f64>>;

    /// The least ratio of the eigenvalues of a stored block. At grazing angles a lobe may be a curved line, which fits
    /// best with a ratio of zero. In numbers of 24 or 11 bits the determinant of a matrix stays positive if its block
    /// is some 100 or 8 times wider than their last bit.
    fn flattest(&self, precision: Precision) -> f64;

    /// The numbers that are stored for a lobe, before rounding. Only the direction of the third column counts; its
    /// length is set later.
    fn store(&self, place: &PerAxis<f64>, lobe: &LobeNumbers, mirrors: Mirrors, precision: Precision) -> LobeNumbers;

    /// The terms alone, as they are stored.
    fn store_terms(&self, place: &PerAxis<f64>, terms: LobeTerms) -> LobeTerms;

    /// The lobe of stored numbers: the inverse of [`LayoutRules::store`].
    fn restore(&self, place: &PerAxis<f64>, stored: &LobeNumbers) -> LobeNumbers;

    /// Twin of the layout's part of the shader: [`LayoutRules::restore`] in 32 bits, for larger roughness, ratio and
    /// view direction.
    #[cfg_attr(not(feature = "render"), allow(dead_code, reason = "only previews run the shader's twin"))]
    fn restore_in_shader(&self, stored: &ShaderNumbers, alpha: f32, ratio: f32, wo: Vec3) -> ShaderNumbers;

    /// How the error depends on the nodes.
    fn interpolation(&self) -> Interpolation;

    /// The layout's part of the shader.
    fn shader(&self) -> LayoutShader;
}
