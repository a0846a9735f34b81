//! Why there is no answer.

use crate::fit::BrdfKind;

/// Why a light is none, or what it reflects cannot be told.
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
        /// What it is.
        value: f64,
    },
    /// A surface or a view direction that has no reflection.
    #[error("{what} is {value}; {allowed}")]
    Domain {
        /// Which number.
        what: &'static str,
        /// What it is.
        value: f64,
        /// What it may be.
        allowed: &'static str,
    },
    /// A table tells how lobes look and not how much they reflect.
    #[error("the table has no amplitude and no Fresnel term")]
    NoTerms,
    /// A table stands for another scattering model than what it is compared with.
    #[error("the true light and the closed forms are of GGX, and the table is of brdf {0}: take a table of brdf ggx")]
    OtherBrdf(BrdfKind),
    /// A table's matrix has no inverse.
    #[error("the table's matrix is singular")]
    Singular,
}
