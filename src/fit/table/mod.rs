//! A fitted table and its lookup.
//!
//! Invariant: `table` reads tables and does not depend on how they were fitted.

mod blend;
mod fold;
mod function;
mod lookup;
mod resample;
mod smooth;

use super::{
    axes::PerAxis,
    brdf::{BrdfKind, BrdfModel, LobeFresnel, SecondLobe, WeightedF0},
    layout::{Layout, ShaderAxes},
    lobe::LobeModel,
    math::from_row_major,
};

pub use blend::{blend_weight, blended};
pub use fold::Configuration;
#[cfg(any(test, feature = "testing"))]
pub use function::planted::planted as planted_isotropic;
pub use function::{FUNCTION_SIDE, FunctionError, IsotropicFunction};
pub use lookup::LookedUp;

/// Preintegrated terms of each entry [Hill and Heitz 2016]. The reflectance is
/// `F0 (amplitude - fresnel) + F90 fresnel`.
#[derive(Debug, Clone, PartialEq)]
pub struct Terms {
    /// Directional albedo for a Fresnel factor of one.
    pub amplitude: Vec<f32>,
    /// The albedo weighted by Schlick's fifth power.
    pub fresnel: Vec<f32>,
    /// The [`edge_spread`](crate::brdf::edge_spread), if the recipe requests it: the albedo weighted by F82's edge
    /// weight, relative to its estimate from the other two terms.
    pub edge: Option<Vec<f32>>,
}

/// A stored table. Every vector has one element for each entry, in the order of [`PerAxis`].
#[derive(Debug, Clone, PartialEq)]
pub struct Table {
    /// The scattering model to which the table was fitted.
    #[doc(hidden)]
    pub brdf: BrdfModel,
    /// The distribution that represents a lobe.
    #[doc(hidden)]
    pub lobe: LobeModel,
    /// The layout, which defines the meaning of the stored numbers.
    #[doc(hidden)]
    pub layout: Layout,
    /// Ascending nodes of each axis.
    #[doc(hidden)]
    pub axes: PerAxis<Vec<f64>>,
    /// Stored matrices, row-major.
    #[doc(hidden)]
    pub matrix: Vec<[f32; 9]>,
    /// Stored matrices of the second lobe, if entries have two lobes.
    #[doc(hidden)]
    pub second: Option<Vec<[f32; 9]>>,
    /// Terms, if the recipe requests them.
    #[doc(hidden)]
    pub terms: Option<Terms>,
    /// Sliced Wasserstein error of each entry on held-out samples and directions.
    #[doc(hidden)]
    pub node_error: Vec<f32>,
}

impl Table {
    /// The scattering model to which the table was fitted.
    #[must_use]
    pub fn brdf(&self) -> BrdfKind {
        self.brdf.kind()
    }

    /// The scattering model, including the file of a tabulated BRDF.
    #[must_use]
    pub fn model(&self) -> &BrdfModel {
        &self.brdf
    }

    /// The distribution that represents a lobe.
    #[must_use]
    pub fn lobe(&self) -> LobeModel {
        self.lobe
    }

    /// The layout, which defines the meaning of the stored numbers.
    #[must_use]
    pub fn layout(&self) -> Layout {
        self.layout
    }

    /// Ascending nodes of each axis.
    #[must_use]
    pub fn axes(&self) -> &PerAxis<Vec<f64>> {
        &self.axes
    }

    /// The number of nodes on each axis; their product is the number of entries. For
    /// [materials](Layout::is_of_materials) alpha counts the materials, and ratio is 1.
    #[must_use]
    pub fn lengths(&self) -> PerAxis<usize> {
        self.layout.lengths(&self.axes)
    }

    /// The node of an entry. Domain: `entry` below the number of entries.
    #[must_use]
    pub fn node(&self, entry: usize) -> PerAxis<f64> {
        self.layout.node(&self.axes, entry)
    }

    /// The pairs of alpha and ratio of a table of [materials](Layout::is_of_materials), by index; empty for other
    /// tables.
    pub fn materials(&self) -> impl Iterator<Item = [f64; 2]> + Clone {
        let pairs = self.axes.alpha.iter().zip(&self.axes.ratio).map(|(alpha, ratio)| [*alpha, *ratio]);
        pairs.take(if self.layout.is_of_materials() { usize::MAX } else { 0 })
    }

    /// The number in the unused channel of the terms' texture. For materials it is alpha at the first theta and the
    /// ratio at the second theta. It is zero otherwise.
    #[must_use]
    pub fn beside_terms(&self, entry: usize) -> f32 {
        if !self.layout.is_of_materials() {
            return 0.0;
        }
        let PerAxis { alpha, ratio, .. } = self.node(entry);
        match entry / self.axes.phi.len() % self.axes.theta.len() {
            0 => alpha as f32,
            1 => ratio as f32,
            _ => 0.0,
        }
    }

    /// Stored matrices, row-major, one for each entry.
    #[must_use]
    pub fn matrices(&self) -> &[[f32; 9]] {
        &self.matrix
    }

    /// The matrices of the second lobe, if entries have two lobes: see [`LobeFresnel`].
    #[must_use]
    pub fn second_matrices(&self) -> Option<&[[f32; 9]]> {
        self.second.as_deref()
    }

    /// The table's axes as shaders read them. Domain: the nodes belong to the table's layout, as in every table file.
    #[must_use]
    pub fn shader_axes(&self) -> ShaderAxes {
        let axes = self.layout.shader_axes(&self.axes);
        if self.second.is_some() { axes.with_second() } else { axes }
    }

    /// How renderers use the second lobe, if entries have two lobes.
    #[must_use]
    pub fn second_lobe(&self) -> Option<SecondLobe> {
        self.brdf.fresnel().second()
    }

    /// The table of the second lobe alone, with the same layout, axes and terms; `None` if entries have one lobe. It
    /// represents the lobe of Schlick's fifth power.
    #[must_use]
    pub fn of_second(&self) -> Option<Self> {
        let matrix = self.second.clone()?;
        // The second lobe of blended lobes is close to the lobe of Schlick's fifth power.
        let of_power = LobeFresnel::mix(vec![WeightedF0 { f0: SecondLobe::Integrated.fitted_f0(), weight: 1.0 }]);
        let brdf = self.brdf.clone().with_fresnel(of_power.unwrap_or_default());
        Some(Self { brdf, matrix, second: None, ..self.clone() })
    }

    /// The determinant of each stored matrix. If entries have two lobes, it is the smaller determinant. If the
    /// determinant is zero or not finite, the matrix has no distribution. If it is negative, the winding of lights is
    /// reversed.
    pub fn determinants(&self) -> impl Iterator<Item = f64> {
        let of = |matrix: &[f32; 9]| from_row_major(&matrix.map(f64::from)).determinant();
        self.matrix.iter().enumerate().map(move |(entry, matrix)| {
            let first = of(matrix);
            let second = self.second.as_ref().map_or(first, |matrices| of(&matrices[entry]));
            if first <= second { first } else { second }
        })
    }

    /// The node of an entry as text, for messages.
    #[must_use]
    pub fn place_of(&self, entry: usize) -> String {
        self.node(entry).named().map(|(axis, x)| format!("{axis} {x:.4}")).join(", ")
    }

    /// Terms, if the table has them.
    #[must_use]
    pub fn terms(&self) -> Option<&Terms> {
        self.terms.as_ref()
    }

    /// Sliced Wasserstein error of each entry on held-out samples and directions.
    #[must_use]
    pub fn node_error(&self) -> &[f32] {
        &self.node_error
    }
}

impl Terms {
    /// Directional albedo of each entry for a Fresnel factor of one.
    #[must_use]
    pub fn amplitude(&self) -> &[f32] {
        &self.amplitude
    }

    /// The albedo of each entry, weighted by Schlick's fifth power.
    #[must_use]
    pub fn fresnel(&self) -> &[f32] {
        &self.fresnel
    }

    /// The albedo of each entry weighted by F82's edge weight, relative to its estimate from the other two terms, if
    /// the table has this term.
    #[must_use]
    pub fn edge(&self) -> Option<&[f32]> {
        self.edge.as_deref()
    }
}
