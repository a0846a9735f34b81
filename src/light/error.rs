//! Errors of lights.

use ltcforge_fit::BrdfKind;

/// The reason why a light is invalid, or why its reflection cannot be computed.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum LightError {
    /// A polygon has too few vertices.
    #[error("a light needs at least three vertices, got {0}")]
    TooFewVertices(usize),
    /// A vertex is not finite.
    #[error("vertex {index} is not finite")]
    NotFinite {
        /// The index of the vertex, from zero.
        index: usize,
    },
    /// The outline turns both ways, crosses itself, or goes around more than once.
    #[error("the light is not convex: vertices {0}, {1} and {2} turn the other way", .vertices[0], .vertices[1], .vertices[2])]
    NotConvex {
        /// The indices, from zero, of three vertices that turn the other way than the first three vertices that are not
        /// in line.
        vertices: [usize; 3],
    },
    /// A polygon has a vertex outside of the plane of the others.
    #[error("the light is not planar: vertex {index} is {distance:.2e} of the largest coordinate away from its plane")]
    NotPlanar {
        /// The index of the vertex, from zero.
        index: usize,
        /// Its distance, relative to the largest coordinate.
        distance: f64,
    },
    /// The shaded point lies on the outline. The light then has no direction.
    #[error("the shaded point lies on the edge that begins at vertex {edge}")]
    OnOutline {
        /// The edge, by the index of its first vertex, from zero.
        edge: usize,
    },
    /// The shaded point lies in the light.
    #[error("the shaded point lies inside the light")]
    Inside,
    /// The half axes of an ellipse are parallel, or one has no length.
    #[error("the half axes are parallel or zero; an ellipse needs two half axes that span a plane")]
    Flat,
    /// A length is negative or not finite.
    #[error("{what} is {value}; it must be finite and not negative")]
    Length {
        /// The name of the length.
        what: &'static str,
        /// The value.
        value: f64,
    },
    /// A number outside its allowed range, such as a roughness, a view direction or a length.
    #[error("{what} is {value}; {allowed}")]
    Domain {
        /// The name of the number.
        what: &'static str,
        /// The value.
        value: f64,
        /// The allowed values.
        allowed: &'static str,
    },
    /// A table without terms does not determine how much a lobe reflects.
    #[error("the table has no amplitude and no Fresnel term: its recipe needs \"terms\": true")]
    NoTerms,
    /// A blend needs two lobes.
    #[error("the table has one lobe per entry, but a blend needs two: its recipe needs \"fresnel\": \"blended_lobes\"")]
    OneLobe,
    /// A table has no third term for metals.
    #[error("the table has no edge term for F82: its recipe needs \"terms\": \"f82\"")]
    NoEdge,
    /// The model needs a table, and none was given.
    #[error("model {0} needs a table: name one, or choose --model normals")]
    NeedsTable(crate::LightModel),
    /// A closed form is for another scattering model than the reference.
    #[error(
        "models {models} are for brdf ggx, not for brdf {0}, which needs a table: choose --model ltc",
        models = crate::LightModel::names_of(|model| !model.needs_table())
    )]
    OtherBrdf(BrdfKind),
    /// A table has another scattering model than the lights with which it is measured.
    #[error(
        "the lights are for brdf {lights}, but the table is for brdf {table}: draw lights for the brdf of the table"
    )]
    OtherLights {
        /// The scattering model for which the lights were drawn.
        lights: BrdfKind,
        /// The scattering model of the table.
        table: BrdfKind,
    },
    /// A scattering model loses no light by shadowing.
    #[error("brdf {0} loses no light by shadowing between facets: compensation is for ggx and beckmann")]
    NoFacets(BrdfKind),
    /// A tabulated model without the values of its file.
    #[error("the BRDF is tabulated, and its file was not read: attach it first")]
    NoBrdfFile,
    /// A picture needs a rectangle.
    #[error("a picture needs a rectangular light: four corners with right angles")]
    NoRectangle,
    /// A picture needs a table of LTCs.
    #[error("a picture on a light needs a table of lobe ltc; this table has Gaussians")]
    NoLtc,
    /// The light of a picture's texels does not add up to the light of the rectangle.
    #[error(
        "the lobe is too sharp to integrate texel by texel: the sum is off by {off}; raise the roughness or move the light"
    )]
    NotConverged {
        /// The relative error of the sum.
        off: f64,
    },
    /// The table's matrix is singular.
    #[error("the table's matrix is singular")]
    Singular,
}
