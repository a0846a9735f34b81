//! Layouts, one file each: the nodes of a table, the numbers that an entry stores, and the lookup.
//!
//! A new layout needs a file, a part of the shader, and a line in [`Layout`].
//!
//! Invariant: a layout does not depend on how a lobe was fitted.

mod isotropic;
mod kt2022;
mod materials;
mod precision;
mod reflected;
mod reflection;
mod rules;
mod shader_axes;
mod smooth;
mod spacing;

pub(crate) use materials::nearest_material;
pub use materials::{LEAST_THETAS, MOST_MATERIALS};
pub use precision::Precision;
pub use reflection::Reflection;
pub use rules::{FreeNumbers, LayoutShader, ShaderNumbers};
pub(crate) use rules::{Interpolation, LayoutRules, LobeNumbers};
pub use shader_axes::{ShaderAxes, ShaderPlace};
pub(crate) use smooth::SMOOTH_NUMBERS;
pub use spacing::{ALPHA_FLOOR, RATIO_FLOOR, THETA_CEILING};
pub(crate) use spacing::{Spacing, within_limits};

use glam::Vec3;

use super::{axes::PerAxis, brdf::BrdfModel, lobe::LobeModel, named_list};

named_list! {
    /// The layout: the mapping from configurations to entries, and from a stored matrix to `M`.
    pub enum Layout: LayoutRules {
        /// Nodes are denser where lobes change faster. Stores the matrix between the [`Reflection`] and the lobe, with
        /// a third column of unit length, and terms relative to the reflection.
        Reflected = "reflected" => reflected::Reflected,
        /// Uniform axes; `M` with a third column of unit length [KT et al. 2022, sections 6 to 8].
        Kt2022 = "kt2022" => kt2022::Kt2022,
        /// Isotropic: `M^-1` divided by its middle element, over roughness and `sqrt(1 - cos theta)` [Hill and Heitz
        /// 2017].
        Ltc2017 = "ltc2017" => isotropic::LTC2017,
        /// Isotropic: `M^-1` divided by its first element, over roughness and theta [Heitz et al. 2016].
        Ltc2016 = "ltc2016" => isotropic::LTC2016,
        /// Isotropic: `M` with a third column of unit length, over roughness and theta, in the form that Godot reads.
        Godot = "godot" => isotropic::GODOT,
        /// Isotropic: `M^-1` divided by its last element, over roughness and `sqrt(1 - cos theta)`, in the form that
        /// Unity's HDRP reads.
        Hdrp = "hdrp" => isotropic::HDRP,
        /// Isotropic: the inverse of an `M` with a third column of unit length, on the nodes of `ltc2017`.
        Inverse = "inverse" => isotropic::INVERSE,
        /// Isotropic: `M` divided by its last element, on the nodes of `ltc2017`.
        Matrix33 = "matrix33" => isotropic::MATRIX33,
        /// The numbers of `reflected` for a list of pairs of alpha and ratio. Lookups do not interpolate between pairs.
        Materials = "materials" => materials::Materials,
    }
}

impl Layout {
    /// Ascending nodes of each axis for a range and a resolution.
    #[must_use]
    pub fn nodes(self, range: &PerAxis<[f64; 2]>, resolution: &PerAxis<u32>) -> PerAxis<Vec<f64>> {
        self.rules().nodes(range, resolution)
    }

    /// True if alpha and ratio form one axis, whose nodes are the materials of the recipe. The lists of alphas and
    /// ratios then have the same length, in the order of the recipe.
    #[must_use]
    pub fn is_of_materials(self) -> bool {
        self.rules().is_of_materials()
    }

    /// True if matrices are stored relative to the [`Reflection`] at their point.
    #[must_use]
    pub fn is_relative(self) -> bool {
        self.rules().is_relative()
    }

    /// The number of nodes on each axis of a table. For [materials](Layout::is_of_materials) alpha counts the
    /// materials, and ratio is 1.
    #[must_use]
    pub fn lengths(self, axes: &PerAxis<Vec<f64>>) -> PerAxis<usize> {
        let lengths = axes.lengths();
        if self.is_of_materials() { PerAxis { ratio: 1, ..lengths } } else { lengths }
    }

    /// The node at `index` in storage order. Domain: `index` below the product of [`Layout::lengths`].
    #[must_use]
    pub fn node(self, axes: &PerAxis<Vec<f64>>, index: usize) -> PerAxis<f64> {
        if !self.is_of_materials() {
            return axes.node(index);
        }
        let row = index / axes.phi.len();
        let material = row / axes.theta.len();
        PerAxis {
            alpha: axes.alpha[material],
            ratio: axes.ratio[material],
            theta: axes.theta[row % axes.theta.len()],
            phi: axes.phi[index % axes.phi.len()],
        }
    }

    /// The fixed ranges of the layout; `None` if the recipe sets the ranges.
    #[must_use]
    pub fn only_ranges(self) -> Option<PerAxis<[f64; 2]>> {
        self.rules().only_ranges()
    }

    /// True if the layout can store the lobes of a scattering model. A layout relative to the reflection needs lobes
    /// around a reflection. A layout of isotropic tables needs isotropic surfaces.
    #[must_use]
    pub fn takes(self, brdf: &BrdfModel) -> bool {
        (brdf.follows_reflection() || !self.rules().is_relative())
            && (self.only_ranges().is_none() || !brdf.has_azimuths())
    }

    /// True if the layout can store a lobe model. Layouts of isotropic tables store LTCs only.
    #[must_use]
    pub fn stores(self, lobe: LobeModel) -> bool {
        lobe.gaussian().is_none() || self.only_ranges().is_none()
    }

    /// The default number of nodes on each axis.
    #[must_use]
    pub fn default_resolution(self) -> PerAxis<u32> {
        self.rules().default_resolution()
    }

    /// The numbers that the fit chooses to minimise the error between nodes, for layouts of isotropic tables. `None`
    /// for other layouts, whose entries are stored as fitted.
    #[must_use]
    pub fn free_numbers(self) -> Option<FreeNumbers> {
        self.rules().free_numbers()
    }

    /// The axes of a table with one lobe per entry, as shaders read them. Domain: nodes of this layout, as
    /// [`Layout::nodes`] returns them.
    #[must_use]
    pub fn shader_axes(self, axes: &PerAxis<Vec<f64>>) -> ShaderAxes {
        let number = self.shader().number;
        if !self.is_of_materials() {
            return ShaderAxes::new(number, self.rules().spacing(), axes);
        }
        let materials = (0..axes.alpha.len()).map(|material| material as f64).collect();
        let numbered = PerAxis { alpha: materials, ratio: vec![0.0], ..axes.clone() };
        ShaderAxes::new(number, self.rules().spacing(), &numbered).of_materials(axes)
    }

    /// True if nodes are evenly spaced, as [`Layout::shader_axes`] assumes. If alpha or ratio is evenly spaced by
    /// value, its first node may be above its even position, because it was raised to a floor. Shaders know the
    /// position of this node. Explicit nodes of a recipe need not be evenly spaced.
    #[must_use]
    pub fn is_even(self, axes: &PerAxis<Vec<f64>>) -> bool {
        let PerAxis { alpha, ratio, theta, phi } = self.rules().spacing();
        let of_surface = [(&axes.alpha, alpha), (&axes.ratio, ratio)];
        let of_surface = if self.is_of_materials() { &[][..] } else { &of_surface[..] };
        let of_view = [(&axes.theta, theta), (&axes.phi, phi)];
        of_surface.iter().all(|(nodes, spacing)| spacing.is_even(nodes, matches!(spacing, Spacing::Even)))
            && of_view.into_iter().all(|(nodes, spacing)| spacing.is_even(nodes, false))
    }

    /// The shader code of the layout.
    #[must_use]
    pub fn shader(self) -> LayoutShader {
        self.rules().shader()
    }

    /// CPU twin of the shader function that finds the position of a configuration among a table's nodes. Domain: larger
    /// roughness, ratio and view direction within the table's ranges, `wo` in the first quadrant. For
    /// [materials](Layout::is_of_materials) `alpha` is the index of a material.
    #[must_use]
    pub fn place_in_shader(self, axes: &ShaderAxes, alpha: f32, ratio: f32, wo: Vec3) -> ShaderPlace {
        self.rules().place_in_shader(axes, alpha, ratio, wo)
    }

    /// CPU twin of the shader function that converts stored numbers to a lobe, in f32. `alpha` is the larger roughness
    /// and `wo` the view direction.
    #[must_use]
    pub fn restore_in_shader(self, stored: &ShaderNumbers, alpha: f32, ratio: f32, wo: Vec3) -> ShaderNumbers {
        self.rules().restore_in_shader(stored, alpha, ratio, wo)
    }

    /// The step between neighbouring nodes of each axis, in the variable in which they are evenly spaced. It is
    /// relative to the whole domain: 1 for two nodes at the domain's ends, 0 for a single node.
    #[must_use]
    pub fn steps(self, range: &PerAxis<[f64; 2]>, resolution: &PerAxis<u32>) -> PerAxis<f64> {
        spacing::steps(&self.rules().spacing(), range, resolution)
    }
}
