//! The figures of the docs. Figures of the paper on anisotropic LTCs [KT et al. 2022] and of the notes on the isotropic
//! fit are drawn from our own fits. Other figures show Gaussians and rough glass.
//!
//! Invariant: equal calls give equal bytes on the same adapter. Figures without spheres have equal bytes on every
//! machine.

mod alignment;
mod alignments;
mod curves;
mod error;
mod fits;
mod gaussians;
mod glass;
mod halfway;
mod hemisphere;
mod isotropic;
mod lobes;
mod metrics;
mod nearest;
mod remedies;
mod resolution;
mod sizes;
#[cfg(test)]
mod tests;

use std::path::{Path, PathBuf};

use ltcforge::{
    files::replace::replace_file,
    fit::{Shear, named_list},
    view::{picture::Picture, preview::Preview},
};

pub use error::FigureError;

named_list! {
    /// A figure: of the paper, of the notes, or of other documents.
    pub enum Figure {
        /// Artefacts, each from one missing remedy.
        Figure3 = "figure_3",
        /// Lobes fitted with two metrics, from good and from bad starts.
        Figure4 = "figure_4",
        /// Interpolation of matrices with and without alignment.
        Figure7 = "figure_7",
        /// Spheres lit by tables with few and with many nodes.
        Figure12 = "figure_12",
        /// Eight GGX lobes next to their LTCs.
        Figure13 = "figure_13",
        /// The contents and sizes of tables of several layouts.
        Table1 = "table_1",
        /// The paper's alignment (equation 12) compared with ours.
        Alignment = "alignment",
        /// The notes' figure 1: the numbers of every entry.
        Notes1 = "notes_1",
        /// The notes' figure 2: shear along x.
        Notes2 = "notes_2",
        /// The notes' figure 3: shear along z.
        Notes3 = "notes_3",
        /// The notes' figure 4: skews from independent searches and from warm starts.
        Notes4 = "notes_4",
        /// The notes' figure 5: the order of warm starts.
        Notes5 = "notes_5",
        /// studies/gaussians.md: GGX and the Gaussians that approximate it.
        Gaussians = "gaussians",
        /// docs/refraction.md: lamps behind rough glass, in closed form and by Monte Carlo integration.
        Glass = "glass",
    }
}

/// Random lights for each point of a curve in the figure of Gaussians.
const GAUSSIAN_LIGHTS: usize = 150;
/// Side of each panel of rough glass in pixels, and visible normals per pixel of its reference.
const GLASS_SIDE: u32 = 192;
const GLASS_SAMPLES: usize = 610;

/// The contents of a figure's file.
#[derive(Debug, Clone, PartialEq)]
pub enum Drawn {
    /// A PNG.
    Picture(Picture),
    /// A table in Markdown.
    Table(String),
}

impl Drawn {
    /// The extension of the file.
    #[must_use]
    pub fn extension(&self) -> &'static str {
        match self {
            Self::Picture(_) => "png",
            Self::Table(_) => "md",
        }
    }
}

impl Figure {
    /// Fits the lobes or tables of the figure on the current rayon pool, and draws it. Figure 12 takes a minute. The
    /// others take seconds.
    ///
    /// # Errors
    /// The errors of the renderer for spheres.
    pub fn draw(self, preview: &mut Preview) -> Result<Drawn, FigureError> {
        let picture = match self {
            Self::Figure3 => remedies::draw(preview)?,
            Self::Figure4 => metrics::draw()?,
            Self::Figure7 => alignment::draw()?,
            Self::Figure12 => resolution::draw(preview)?,
            Self::Figure13 => lobes::draw()?,
            Self::Table1 => return Ok(Drawn::Table(sizes::table()?)),
            Self::Alignment => alignments::draw()?,
            Self::Notes1 => isotropic::numbers(),
            Self::Notes2 => isotropic::shears(Shear::X),
            Self::Notes3 => isotropic::shears(Shear::Z),
            Self::Notes4 => isotropic::starts(),
            Self::Notes5 => isotropic::order(),
            Self::Gaussians => gaussians::draw(GAUSSIAN_LIGHTS)?,
            Self::Glass => glass::draw(GLASS_SIDE, GLASS_SAMPLES).picture,
        };
        Ok(Drawn::Picture(picture))
    }

    /// Draws the figure and writes it to a file in a folder. The file has the name of the figure.
    ///
    /// # Errors
    /// The errors of [`Figure::draw`] and of the file system.
    pub fn write(self, preview: &mut Preview, folder: &Path) -> Result<PathBuf, FigureError> {
        let drawn = self.draw(preview)?;
        let path = folder.join(format!("{self}.{}", drawn.extension()));
        let bytes = match drawn {
            Drawn::Picture(picture) => picture.png()?,
            Drawn::Table(text) => text.into_bytes(),
        };
        replace_file(&path, &bytes).map_err(|source| FigureError::File { path: path.clone(), source })?;
        Ok(path)
    }
}
