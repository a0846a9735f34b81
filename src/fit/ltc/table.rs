//! A fitted table.

use super::{Layout, PerAxis};

/// Preintegrated terms of each entry [Hill and Heitz 2016]: reflectance is `F0 (amplitude - fresnel) + F90 fresnel`.
#[derive(Debug, Clone, PartialEq)]
pub struct Terms {
    /// Directional albedo for a Fresnel factor of one.
    pub amplitude: Vec<f32>,
    /// The part of it that Schlick's fifth power weighs.
    pub fresnel: Vec<f32>,
}

/// A table as it is stored. Every vector has one element an entry, in the order of [`PerAxis`].
#[derive(Debug, Clone, PartialEq)]
pub struct Table {
    /// What the numbers mean.
    pub layout: Layout,
    /// Ascending nodes of each axis.
    pub axes: PerAxis<Vec<f64>>,
    /// Stored matrices, row-major.
    pub matrix: Vec<[f32; 9]>,
    /// Terms, where the recipe asks for them.
    pub terms: Option<Terms>,
    /// Sliced Wasserstein error of each entry on samples and directions that the fit did not see.
    pub node_error: Vec<f32>,
}
