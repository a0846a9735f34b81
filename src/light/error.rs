//! Why there is no answer.

use ltcforge_fit::BrdfKind;

/// Why a light is invalid, or its reflection cannot be computed.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum LightError {
    /// A polygon has too few vertices.
    #[error("{0} vertices; a light has three at least")]
    TooFewVertices(usize),
    /// A vertex is not finite.
    #[error("vertex {index} is not finite")]
    NotFinite {
        /// Which vertex, from zero.
        index: usize,
    },
    /// The outline turns both ways, crosses itself or goes around more than once.
    #[error("the light is not convex: vertices {0}, {1} and {2} run against the others", .vertices[0], .vertices[1], .vertices[2])]
    NotConvex {
        /// Three vertices, from zero, that run the other way round than the first three that are not in line.
        vertices: [usize; 3],
    },
    /// The shaded point lies on the outline, so that it is seen in no direction.
    #[error("the shaded point lies on the edge that begins at vertex {edge}")]
    OnOutline {
        /// Which edge, by the vertex where it begins, from zero.
        edge: usize,
    },
    /// The shaded point lies in the light.
    #[error("the shaded point lies inside the light")]
    Inside,
    /// The half axes of an ellipse are parallel, or one has no length.
    #[error("the half axes are parallel or zero; an ellipse has two that span a plane")]
    Flat,
    /// A length is negative or not finite.
    #[error("{what} is {value}; it is a finite number, not negative")]
    Length {
        /// Which length.
        what: &'static str,
        /// Its value.
        value: f64,
    },
    /// A surface or a view direction that has no reflection.
    #[error("{what} is {value}; {allowed}")]
    Domain {
        /// Which number.
        what: &'static str,
        /// Its value.
        value: f64,
        /// The allowed values.
        allowed: &'static str,
    },
    /// A table tells how lobes look and not how much they reflect.
    #[error("the table has no amplitude and no Fresnel term")]
    NoTerms,
    /// A blend needs two lobes.
    #[error(
        "the table has one lobe an entry; a blend is of two, as field fresnel of a recipe asks for: \"blended_lobes\""
    )]
    OneLobe,
    /// A table has not the third term of metals.
    #[error("the table has no edge term, by which F82 weighs: its recipe needs \"terms\": \"f82\"")]
    NoEdge,
    /// The model needs a table, and none was given.
    #[error("model {0} lights by a table: name one, or choose --model normals")]
    NeedsTable(crate::LightModel),
    /// A closed form is of another scattering model than the light that it is compared with.
    #[error(
        "models {models} are of brdf ggx, not of brdf {0}, which is lit by a table: choose --model ltc",
        models = crate::LightModel::names_of(|model| !model.needs_table())
    )]
    OtherBrdf(BrdfKind),
    /// A table stands for another scattering model than the lights that it is measured by.
    #[error(
        "the lights are around what brdf {lights} reflects, and the table is of brdf {table}: draw lights for the table's own"
    )]
    OtherLights {
        /// The scattering model for which the lights were drawn.
        lights: BrdfKind,
        /// The scattering model of the table.
        table: BrdfKind,
    },
    /// A scattering model has no light that its shadowing loses.
    #[error(
        "brdf {0} loses nothing by shadowing between facets that could be given back: compensation is of ggx and beckmann"
    )]
    NoFacets(BrdfKind),
    /// A tabulated model has no numbers at hand.
    #[error("the BRDF is tabulated, and its file was not read: attach it first")]
    NoBrdfFile,
    /// A picture needs a rectangle.
    #[error("the light is no rectangle: a picture is on a light of four corners with right angles")]
    NoRectangle,
    /// A picture is lit by tables of LTCs.
    #[error("the table is one of Gaussians; a picture on a light is read by tables of lobe ltc")]
    NoLtc,
    /// The light of a picture's texels does not sum to that of the whole rectangle.
    #[error(
        "the lobe is too sharp to be integrated texel by texel: the sum is off by {off}; raise the roughness or move the light"
    )]
    NotConverged {
        /// By how much.
        off: f64,
    },
    /// A table's matrix has no inverse.
    #[error("the table's matrix is singular")]
    Singular,
}
