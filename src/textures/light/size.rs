//! The size of a light as text.

use std::str::FromStr;

/// The width and the height of a light, in any unit. Both are finite and above zero. Written as `1.6x0.9`.
#[derive(Debug, Clone, Copy, PartialEq, serde::Deserialize)]
#[serde(try_from = "String")]
pub struct LightSize(pub(super) [f64; 2]);

impl LightSize {
    /// Width and height.
    #[must_use]
    pub fn sides(self) -> [f64; 2] {
        self.0
    }
}

impl FromStr for LightSize {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let length = |text: &str| text.parse::<f64>().ok().filter(|x| *x > 0.0 && x.is_finite());
        let sides = text.split_once('x').and_then(|(width, height)| Some(Self([length(width)?, length(height)?])));
        sides.ok_or_else(|| {
            format!("«{text}» is not the size of a light; write a width and a height above zero, such as 1.6x0.9")
        })
    }
}

impl TryFrom<String> for LightSize {
    type Error = String;

    fn try_from(text: String) -> Result<Self, String> {
        text.parse()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_are_checked() {
        assert_eq!("1.6x9e2".parse(), Ok(LightSize([1.6, 900.0])));
        for wrong in ["", "1", "1x", "x1", "0x1", "-1x1", "1xinf", "NaNx1", "1x1x1", "1 x 1"] {
            assert!(wrong.parse::<LightSize>().is_err(), "{wrong}");
        }
    }
}
