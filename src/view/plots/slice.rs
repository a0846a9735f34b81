//! Where the errors of a table are cut.

use std::{f64::consts::TAU, str::FromStr};

use serde::{Deserialize, Serialize};

/// Where the domain is cut.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Slice {
    /// Smaller over larger roughness.
    pub ratio: f64,
    /// Azimuth of the view direction, radians.
    pub phi: f64,
}

/// A ratio of a slice: 0 to 1.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(try_from = "String")]
pub struct Ratio(pub f64);

/// An azimuth of a slice: -2 pi to 2 pi, radians.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(try_from = "String")]
pub struct Azimuth(pub f64);

impl FromStr for Ratio {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        within(text, [0.0, 1.0]).map(Self).ok_or_else(|| format!("«{text}» is not a ratio; it is a number from 0 to 1"))
    }
}

impl FromStr for Azimuth {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let found = within(text, [-TAU, TAU]).map(Self);
        found.ok_or_else(|| format!("«{text}» is not an azimuth; it is a number of radians from -2 pi to 2 pi"))
    }
}

impl TryFrom<String> for Ratio {
    type Error = String;

    fn try_from(text: String) -> Result<Self, String> {
        text.parse()
    }
}

impl TryFrom<String> for Azimuth {
    type Error = String;

    fn try_from(text: String) -> Result<Self, String> {
        text.parse()
    }
}

/// The number that `text` is, if it is one between both ends.
fn within(text: &str, [low, high]: [f64; 2]) -> Option<f64> {
    text.parse().ok().filter(|number| (low..=high).contains(number))
}

/// Between the axes of a surface, where an anisotropic one differs most from an isotropic one.
impl Default for Slice {
    fn default() -> Self {
        Self { ratio: 0.25, phi: 0.7 }
    }
}

impl Slice {
    /// The slice at what is chosen, and at the defaults of what is not.
    #[must_use]
    pub fn new(ratio: Option<Ratio>, phi: Option<Azimuth>) -> Self {
        let usual = Self::default();
        Self { ratio: ratio.map_or(usual.ratio, |ratio| ratio.0), phi: phi.map_or(usual.phi, |phi| phi.0) }
    }
}
