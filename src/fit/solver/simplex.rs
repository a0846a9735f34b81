//! The settings of a solver with a simplex in a recipe.

use serde::Serialize;

use crate::named_list;

named_list! {
    /// The element of the matrix that skews a lobe in its plane of incidence, in the frame of the lobe's mean
    /// direction.
    pub enum Shear {
        /// An element of the third column. It shifts the lobe along x. All directions stay in the hemisphere around the
        /// mean direction [Heitz et al. 2016].
        X = "x",
        /// An element of the third row. It tilts the lobe. Some directions leave the hemisphere around the mean
        /// direction.
        Z = "z",
    }
}

named_list! {
    /// The start of the search for a lobe's matrix.
    pub enum Start {
        /// The matrix of the neighbouring lobe. The sequence begins with the roughest lobe seen from above, continues
        /// to the roughness of the row, and then to the horizon.
        Warm = "warm",
        /// The lobe's own location and scatter. Entries then do not depend on each other.
        Independent = "independent",
    }
}

/// The settings of solver `nelder_mead`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct Simplex {
    /// The element that skews a lobe.
    #[doc(hidden)]
    pub shear: Shear,
    /// The start of a search.
    #[doc(hidden)]
    pub start: Start,
}

impl Default for Simplex {
    fn default() -> Self {
        Self { shear: Shear::ALL[0], start: Start::ALL[0] }
    }
}

impl Simplex {
    /// The element that skews a lobe.
    #[must_use]
    pub fn shear(&self) -> Shear {
        self.shear
    }

    /// The start of a search.
    #[must_use]
    pub fn start(&self) -> Start {
        self.start
    }
}
