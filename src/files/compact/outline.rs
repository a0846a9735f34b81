//! What a decoder in another language has to know of a compact form before it reads the coded bytes.

use super::{
    error::CompactError,
    header::{CHANNELS, Header},
};
use crate::fit::{Layout, PerAxis};

/// The header of a compact form, read.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::files) struct Outline {
    /// The layout of the table.
    pub(in crate::files) layout: Layout,
    /// Nodes of each axis.
    pub(in crate::files) axes: PerAxis<Vec<f64>>,
    /// Polynomials along each axis.
    pub(in crate::files) counts: [u8; 4],
    /// The step of each channel, 0 for one that is not stored.
    pub(in crate::files) steps: [f32; CHANNELS],
    /// Channels with corrections.
    pub(in crate::files) corrected: [bool; CHANNELS],
    /// What a correction is a multiple of, in steps of its channel.
    pub(in crate::files) correction_steps: f32,
    /// Whether there are amplitude and Fresnel term.
    pub(in crate::files) has_terms: bool,
    /// Where the coded bytes begin.
    pub(in crate::files) coded_at: usize,
}

impl Outline {
    /// Reads the header.
    ///
    /// # Errors
    /// When it is none.
    pub(in crate::files) fn of(bytes: &[u8]) -> Result<Self, CompactError> {
        let (header, coded) = Header::read(bytes)?;
        Ok(Self {
            layout: header.layout,
            axes: header.axes()?,
            counts: header.polynomials,
            steps: header.steps.map(Option::unwrap_or_default),
            corrected: header.corrected,
            correction_steps: header.correction_steps,
            has_terms: header.has_terms(),
            coded_at: bytes.len() - coded.len(),
        })
    }
}
