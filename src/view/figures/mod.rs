//! The figures of the paper that introduced anisotropic LTCs [KT et al. 2022], made anew from our own fits.
//!
//! Invariant: equal calls give equal bytes on the same adapter; lobes do so on every machine.

mod alignment;
mod error;
mod fits;
mod hemisphere;
mod lobes;
mod metrics;
mod remedies;
mod resolution;

use crate::view::{picture::Picture, preview::Preview};

pub use error::FigureError;

/// One of the figures.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Figure {
    /// Artefacts, each from leaving out one remedy.
    Figure3,
    /// Lobes fitted by two metrics, from good starts and bad.
    Figure4,
    /// Interpolation of matrices that are aligned, and that are not.
    Figure7,
    /// Spheres by tables of few and of many nodes.
    Figure12,
    /// Eight lobes of GGX beside the LTCs that stand for them.
    Figure13,
}

impl Figure {
    /// All of them, in the paper's order.
    pub const ALL: [Self; 5] = [Self::Figure3, Self::Figure4, Self::Figure7, Self::Figure12, Self::Figure13];

    /// The name of its file, without the extension.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Figure3 => "figure_3",
            Self::Figure4 => "figure_4",
            Self::Figure7 => "figure_7",
            Self::Figure12 => "figure_12",
            Self::Figure13 => "figure_13",
        }
    }

    /// Fits what it shows, on the current rayon pool, and draws it. Figure 12 takes a minute, the others seconds.
    ///
    /// # Errors
    /// What the renderer of spheres reports.
    pub fn draw(self, preview: &mut Preview) -> Result<Picture, FigureError> {
        match self {
            Self::Figure3 => remedies::draw(preview),
            Self::Figure4 => metrics::draw(),
            Self::Figure7 => alignment::draw(),
            Self::Figure12 => resolution::draw(preview),
            Self::Figure13 => lobes::draw(),
        }
    }
}

#[cfg(test)]
mod tests;
