//! The parameters of plots. The command line parses each parameter by its type, and HTTP parses all of them from text.

use std::{f64::consts::TAU, str::FromStr};

use super::{plot::Plot, slice::ErrorSlice};
use crate::parameters::{ParameterFault, read_pairs};

/// The ratio of a slice: 0 to 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ratio(pub f64);

/// The azimuth of a slice, in radians: -2 pi to 2 pi.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Azimuth(pub f64);

impl FromStr for Ratio {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let ratio = within(text, [0.0, 1.0]).map(Self);
        ratio.ok_or_else(|| format!("«{text}» is not a ratio: a number from 0 to 1"))
    }
}

impl FromStr for Azimuth {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let azimuth = within(text, [-TAU, TAU]).map(Self);
        azimuth.ok_or_else(|| format!("«{text}» is not an azimuth: a number from -2 pi to 2 pi, in radians"))
    }
}

/// The number in `text`, if it is within the bounds.
fn within(text: &str, [low, high]: [f64; 2]) -> Option<f64> {
    text.parse().ok().filter(|number| (low..=high).contains(number))
}

impl ErrorSlice {
    /// The slice with these parameters. A missing parameter has its default.
    #[must_use]
    pub fn new(ratio: Option<Ratio>, phi: Option<Azimuth>) -> Self {
        let default = Self::default();
        Self { ratio: ratio.map_or(default.ratio, |ratio| ratio.0), phi: phi.map_or(default.phi, |phi| phi.0) }
    }
}

impl ErrorSlice {
    /// The slice that the optional parameters `ratio` and `phi` describe.
    ///
    /// # Errors
    /// Every parameter that is unknown, repeated, malformed or out of bounds.
    pub fn from_pairs<'a>(pairs: impl IntoIterator<Item = (&'a str, &'a str)>) -> Result<Self, Vec<ParameterFault>> {
        let (mut ratio, mut phi) = (None, None);
        let faults = read_pairs(pairs, |name, text| {
            match name {
                "ratio" => ratio = Some(text.parse()?),
                "phi" => phi = Some(text.parse()?),
                _ => return Err("is not a parameter of this plot; its parameters are ratio and phi".to_owned()),
            }
            Ok(())
        });
        if faults.is_empty() { Ok(Self::new(ratio, phi)) } else { Err(faults) }
    }
}

impl Plot {
    /// The error plot with the slice of [`ErrorSlice::from_pairs`].
    ///
    /// # Errors
    /// The errors of [`ErrorSlice::from_pairs`].
    pub fn error_from<'a>(pairs: impl IntoIterator<Item = (&'a str, &'a str)>) -> Result<Self, Vec<ParameterFault>> {
        ErrorSlice::from_pairs(pairs).map(Self::Error)
    }

    /// The matrix plot, which takes no parameters.
    ///
    /// # Errors
    /// Every parameter that is given.
    pub fn matrix_from<'a>(pairs: impl IntoIterator<Item = (&'a str, &'a str)>) -> Result<Self, Vec<ParameterFault>> {
        let faults = read_pairs(pairs, |_, _| Err("is not a parameter of this plot; it has no parameters".to_owned()));
        if faults.is_empty() { Ok(Self::Matrix) } else { Err(faults) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_set_the_plot_and_missing_parameters_have_defaults() {
        let slice = |ratio, phi| Ok(Plot::Error(ErrorSlice { ratio, phi }));
        assert_eq!(Plot::error_from([]), Ok(Plot::Error(ErrorSlice::default())));
        assert_eq!(Plot::error_from([("phi", "-1.5"), ("ratio", "1")]), slice(1.0, -1.5));
        assert_eq!(Plot::error_from([("ratio", "0")]), slice(0.0, ErrorSlice::default().phi));
        assert_eq!(Plot::matrix_from([]), Ok(Plot::Matrix));
    }

    #[test]
    fn every_fault_is_listed_in_order() {
        let pairs = [("phi", "7"), ("colour", "red"), ("ratio", "-0.1"), ("ratio", "0.1")];
        let faults = Plot::error_from(pairs).expect_err("four faults");
        let names: Vec<&str> = faults.iter().map(|fault| fault.parameter.as_str()).collect();
        assert_eq!(names, ["phi", "colour", "ratio", "ratio"]);
        assert_eq!(faults[3], ParameterFault::repeated("ratio"));
        assert_eq!(Plot::matrix_from(pairs).expect_err("four faults").len(), 4);
    }
}
