//! The settings of a solver with a simplex that a recipe chooses.

use serde::Serialize;

use crate::named_list;

named_list! {
    /// Which number of the matrix skews a lobe in its plane of incidence, in the frame of the lobe's mean direction.
    pub enum Shear {
        /// The third column's: it shifts the lobe along x, and leaves nothing behind it [Heitz et al. 2016].
        X = "x",
        /// The third row's: it tilts the lobe, and leaves a part of it behind.
        Z = "z",
    }
}

named_list! {
    /// Where the search for a lobe's matrix starts.
    pub enum Start {
        /// From the matrix of the lobe next to it: from the roughest lobe seen from above down to the roughness, then
        /// down to the horizon.
        Warm = "warm",
        /// From the lobe's own location and scatter, so that entries do not depend on each other.
        Independent = "independent",
    }
}

/// The choices of solver `nelder_mead`, which has a simplex.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct Simplex {
    /// Which number skews a lobe.
    #[doc(hidden)]
    pub shear: Shear,
    /// Where a search starts.
    #[doc(hidden)]
    pub start: Start,
}

impl Default for Simplex {
    fn default() -> Self {
        Self { shear: Shear::ALL[0], start: Start::ALL[0] }
    }
}

impl Simplex {
    /// Which number skews a lobe.
    #[must_use]
    pub fn shear(&self) -> Shear {
        self.shear
    }

    /// Where a search starts.
    #[must_use]
    pub fn start(&self) -> Start {
        self.start
    }
}
