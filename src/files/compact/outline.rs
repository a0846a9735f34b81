//! The parameters of a compact form that a decoder in another language needs before it reads the coded bytes.

use super::{decoder::CHANNELS, error::CompactError, header::Header};
use ltcforge_fit::{Layout, PerAxis};

/// The parsed header of a compact form.
#[derive(Debug, Clone, PartialEq)]
pub struct Outline {
    /// The layout of the table.
    pub layout: Layout,
    /// The number of nodes of each axis.
    pub axes: PerAxis<Vec<f64>>,
    /// The number of polynomials along each axis.
    pub counts: [u8; 4],
    /// The step of each channel; 0 for a channel that is not stored.
    pub steps: [f32; CHANNELS],
    /// The channels with corrections.
    pub corrected: [bool; CHANNELS],
    /// The unit of corrections, in steps of their channel.
    pub correction_steps: f32,
    /// Whether the form contains amplitude and Fresnel term.
    pub has_terms: bool,
    /// The position of the coded bytes.
    pub coded_at: usize,
}

impl Outline {
    /// Reads the header.
    ///
    /// # Errors
    /// The bytes are not a compact form.
    pub fn of(bytes: &[u8]) -> Result<Self, CompactError> {
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
