//! A fitted table, and how it is looked up.
//!
//! Invariant: `table` knows how a table is read, not how it came to be.

mod blend;
mod fold;
mod function;
mod lookup;
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

/// Preintegrated terms of each entry [Hill and Heitz 2016]: reflectance is `F0 (amplitude - fresnel) + F90 fresnel`.
#[derive(Debug, Clone, PartialEq)]
pub struct Terms {
    /// Directional albedo for a Fresnel factor of one.
    pub amplitude: Vec<f32>,
    /// The same albedo, weighted by Schlick's fifth power.
    pub fresnel: Vec<f32>,
    /// The [`edge_spread`](crate::brdf::edge_spread), where the recipe asks for it: the same albedo, weighted by F82's edge, as
    /// a part of what the other two tell.
    pub edge: Option<Vec<f32>>,
}

/// A table as it is stored. Every vector has one element an entry, in the order of [`PerAxis`].
#[derive(Debug, Clone, PartialEq)]
pub struct Table {
    /// The scattering model that was fitted.
    #[doc(hidden)]
    pub brdf: BrdfModel,
    /// The distribution that stands for a lobe.
    #[doc(hidden)]
    pub lobe: LobeModel,
    /// The layout, which defines what the stored numbers mean.
    #[doc(hidden)]
    pub layout: Layout,
    /// Ascending nodes of each axis.
    #[doc(hidden)]
    pub axes: PerAxis<Vec<f64>>,
    /// Stored matrices, row-major.
    #[doc(hidden)]
    pub matrix: Vec<[f32; 9]>,
    /// Stored matrices of the second lobe, where entries have two.
    #[doc(hidden)]
    pub second: Option<Vec<[f32; 9]>>,
    /// Terms, where the recipe asks for them.
    #[doc(hidden)]
    pub terms: Option<Terms>,
    /// Sliced Wasserstein error of each entry on samples and directions that the fit did not see.
    #[doc(hidden)]
    pub node_error: Vec<f32>,
}

impl Table {
    /// The scattering model that was fitted.
    #[must_use]
    pub fn brdf(&self) -> BrdfKind {
        self.brdf.kind()
    }

    /// The scattering model with the file that a tabulated one is of.
    #[must_use]
    pub fn model(&self) -> &BrdfModel {
        &self.brdf
    }

    /// The distribution that stands for a lobe.
    #[must_use]
    pub fn lobe(&self) -> LobeModel {
        self.lobe
    }

    /// The layout, which defines what the stored numbers mean.
    #[must_use]
    pub fn layout(&self) -> Layout {
        self.layout
    }

    /// Ascending nodes of each axis.
    #[must_use]
    pub fn axes(&self) -> &PerAxis<Vec<f64>> {
        &self.axes
    }

    /// Nodes on each axis, whose product is the number of entries: of [materials](Layout::is_of_materials) as many as alpha
    /// has, each with one ratio.
    #[must_use]
    pub fn lengths(&self) -> PerAxis<usize> {
        self.layout.lengths(&self.axes)
    }

    /// The node of an entry. Domain: `entry` below the number of entries.
    #[must_use]
    pub fn node(&self, entry: usize) -> PerAxis<f64> {
        self.layout.node(&self.axes, entry)
    }

    /// The pairs of alpha and ratio of a table of [materials](Layout::is_of_materials), by their numbers; none of others.
    pub fn materials(&self) -> impl Iterator<Item = [f64; 2]> + Clone {
        let pairs = self.axes.alpha.iter().zip(&self.axes.ratio).map(|(alpha, ratio)| [*alpha, *ratio]);
        pairs.take(if self.layout.is_of_materials() { usize::MAX } else { 0 })
    }

    /// The number that textures have beside the terms of an entry: of materials alpha at the first theta, the ratio at the
    /// second; else zero.
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

    /// The matrices of the second lobe, where entries have two: see [`LobeFresnel`].
    #[must_use]
    pub fn second_matrices(&self) -> Option<&[[f32; 9]]> {
        self.second.as_deref()
    }

    /// The table's axes as shaders read them. Domain: nodes of its layout, which those of every file are.
    #[must_use]
    pub fn shader_axes(&self) -> ShaderAxes {
        let axes = self.layout.shader_axes(&self.axes);
        if self.second.is_some() { axes.with_second() } else { axes }
    }

    /// How the second lobe is used, where entries have two.
    #[must_use]
    pub fn second_lobe(&self) -> Option<SecondLobe> {
        self.brdf.fresnel().second()
    }

    /// The table of the second lobe alone, of the same layout, axes and terms; `None` where entries have one lobe. The lobe
    /// that it stands for is that of Schlick's fifth power.
    #[must_use]
    pub fn of_second(&self) -> Option<Self> {
        let matrix = self.second.clone()?;
        // That a blend reaches by way of a dielectric's is next to it.
        let of_power = LobeFresnel::mix(vec![WeightedF0 { f0: SecondLobe::Integrated.fitted_f0(), weight: 1.0 }]);
        let brdf = self.brdf.clone().with_fresnel(of_power.unwrap_or_default());
        Some(Self { brdf, matrix, second: None, ..self.clone() })
    }

    /// The determinant of each stored matrix, where entries have two lobes the lesser. Where it is zero or not finite, the
    /// matrix makes no distribution; where it is negative, a light's winding is reversed.
    pub fn determinants(&self) -> impl Iterator<Item = f64> {
        let of = |matrix: &[f32; 9]| from_row_major(&matrix.map(f64::from)).determinant();
        self.matrix.iter().enumerate().map(move |(entry, matrix)| {
            let first = of(matrix);
            let second = self.second.as_ref().map_or(first, |matrices| of(&matrices[entry]));
            if first <= second { first } else { second }
        })
    }

    /// The place of an entry in words, for messages.
    #[must_use]
    pub fn place_of(&self, entry: usize) -> String {
        self.node(entry).named().map(|(axis, x)| format!("{axis} {x:.4}")).join(", ")
    }

    /// Terms, where the table has them.
    #[must_use]
    pub fn terms(&self) -> Option<&Terms> {
        self.terms.as_ref()
    }

    /// Sliced Wasserstein error of each entry on samples and directions that the fit did not see.
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

    /// The same albedo, weighted by Schlick's fifth power.
    #[must_use]
    pub fn fresnel(&self) -> &[f32] {
        &self.fresnel
    }

    /// The same albedo, weighted by F82's edge, as a part of what the other two tell, if the table has that term.
    #[must_use]
    pub fn edge(&self) -> Option<&[f32]> {
        self.edge.as_deref()
    }
}
