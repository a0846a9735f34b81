//! Textures: 2D, arrays of 2D, or 3D.

use super::halves::Halves;

/// The largest number of texels along one side.
const MOST_TEXELS: u32 = 1 << 16;

/// A texture of 32-bit numbers. Its fields are public, so writers must call [`Texture::check`] before they read it.
#[derive(Debug, Clone, PartialEq)]
pub struct Texture {
    /// The name in files and code: a letter, followed by letters, digits and underscores.
    pub name: String,
    /// Texels along x.
    pub width: u32,
    /// Texels along y.
    pub height: u32,
    /// Texels along z. It is 1 for a 2D texture.
    pub depth: u32,
    /// Layers of an array. It is 1 for a texture that is not an array.
    pub layers: u32,
    /// The names of a texel's channels, in order.
    pub channels: Vec<String>,
    /// The numbers: channel fastest, then x, y, z, layer.
    pub texels: Vec<f32>,
    /// The numbers in 16 bits, if they were rounded together. `None` to round each number to the nearest half.
    pub halves: Option<Halves>,
}

/// The texture is invalid.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum TextureError {
    /// The name cannot be used in files or code.
    #[error(
        "name is «{name}»; a texture's name has 1 to 64 ASCII letters, digits and underscores, and starts with a letter"
    )]
    Name {
        /// The name.
        name: String,
    },
    /// A side has no texels, or too many.
    #[error("«{name}»: {field} is {value}; 1 to {MOST_TEXELS} are allowed")]
    Side {
        /// The texture.
        name: String,
        /// The name of the side.
        field: &'static str,
        /// The length of the side.
        value: u32,
    },
    /// There is no channel, or a channel has no name, or two channels have the same name.
    #[error("«{name}»: channels are {channels:?}; at least one is required, each with a different name")]
    Channels {
        /// The texture.
        name: String,
        /// The channels.
        channels: Vec<String>,
    },
    /// The number of texels does not match the sizes.
    #[error(
        "«{name}»: texels has {actual} numbers; {width} x {height} x {depth} texels, {layers} layers and {channels} channels need {expected}"
    )]
    Length {
        /// The texture.
        name: String,
        /// The number of values.
        actual: usize,
        /// The number of values that the sizes require.
        expected: u64,
        /// Texels along x.
        width: u32,
        /// Texels along y.
        height: u32,
        /// Texels along z.
        depth: u32,
        /// Layers.
        layers: u32,
        /// Channels.
        channels: usize,
    },
    /// The number of halves differs from the number of values.
    #[error("«{name}»: halves has {actual} numbers, but texels has {expected}")]
    Halves {
        /// The texture.
        name: String,
        /// The number of halves.
        actual: usize,
        /// The number of values.
        expected: usize,
    },
    /// A number is infinite or NaN.
    #[error("«{name}»: texels[{index}] is {value}; only finite numbers are allowed")]
    NotFinite {
        /// The texture.
        name: String,
        /// The index of the number.
        index: usize,
        /// The number as text.
        value: String,
    },
}

impl Texture {
    /// A 2D texture.
    ///
    /// # Errors
    /// [`Self::check`] fails.
    pub fn flat(
        name: impl Into<String>,
        [width, height]: [u32; 2],
        channels: &[&str],
        texels: Vec<f32>,
    ) -> Result<Self, TextureError> {
        Self::new(name, [width, height, 1], 1, channels, texels)
    }

    /// A texture with `[width, height, depth]` texels in each of `layers` layers.
    ///
    /// # Errors
    /// [`Self::check`] fails.
    pub fn new(
        name: impl Into<String>,
        [width, height, depth]: [u32; 3],
        layers: u32,
        channels: &[&str],
        texels: Vec<f32>,
    ) -> Result<Self, TextureError> {
        let channels = channels.iter().map(|&channel| channel.to_owned()).collect();
        let texture = Self { name: name.into(), width, height, depth, layers, channels, texels, halves: None };
        texture.check()?;
        Ok(texture)
    }

    /// Checks the names of the texture and its channels, the sizes, and that all numbers are finite.
    ///
    /// # Errors
    /// The error of the first invalid field.
    pub fn check(&self) -> Result<(), TextureError> {
        let name = || self.name.clone();
        if !is_identifier(&self.name) {
            return Err(TextureError::Name { name: name() });
        }
        for (field, value) in
            [("width", self.width), ("height", self.height), ("depth", self.depth), ("layers", self.layers)]
        {
            if !(1..=MOST_TEXELS).contains(&value) {
                return Err(TextureError::Side { name: name(), field, value });
            }
        }
        let distinct = self.channels.iter().enumerate().all(|(i, channel)| !self.channels[..i].contains(channel));
        if self.channels.is_empty() || !distinct || !self.channels.iter().all(|channel| is_identifier(channel)) {
            return Err(TextureError::Channels { name: name(), channels: self.channels.clone() });
        }
        let Self { width, height, depth, layers, .. } = *self;
        let sides = [width, height, depth, layers].map(u64::from);
        let expected = sides.iter().try_fold(self.channels.len() as u64, |product, side| product.checked_mul(*side));
        let (expected, actual) = (expected.unwrap_or(u64::MAX), self.texels.len());
        if expected != actual as u64 {
            let channels = self.channels.len();
            return Err(TextureError::Length {
                name: name(),
                actual,
                expected,
                width,
                height,
                depth,
                layers,
                channels,
            });
        }
        if let Some(halves) = self.halves.as_ref().filter(|halves| halves.numbers.len() != actual) {
            return Err(TextureError::Halves { name: name(), actual: halves.numbers.len(), expected: actual });
        }
        match self.texels.iter().position(|x| !x.is_finite()) {
            None => Ok(()),
            Some(index) => Err(TextureError::NotFinite { name: name(), index, value: self.texels[index].to_string() }),
        }
    }

    /// Lengths from the slowest index to the fastest, like array shapes in other programs: layers and depth if there
    /// are several, then height, width and channels.
    #[must_use]
    pub fn shape(&self) -> Vec<usize> {
        let several = [self.layers, self.depth].into_iter().filter(|n| *n > 1);
        let sides = several.chain([self.height, self.width]).map(|n| n as usize);
        sides.chain([self.channels.len()]).collect()
    }

    /// The numbers of each 2D slice: all slices of the first layer, then those of the next layer.
    #[must_use]
    pub fn slices(&self) -> impl ExactSizeIterator<Item = &[f32]> {
        self.texels.chunks_exact(self.width as usize * self.height as usize * self.channels.len())
    }

    /// The texture with only these channels, in this order.
    ///
    /// # Errors
    /// [`TextureError::Channels`] if a channel is missing.
    pub fn only(&self, channels: &[&str]) -> Result<Self, TextureError> {
        let place = |channel: &&str| self.channels.iter().position(|own| own == channel);
        let Some(places) = channels.iter().map(place).collect::<Option<Vec<_>>>() else {
            return Err(TextureError::Channels { name: self.name.clone(), channels: self.channels.clone() });
        };
        let taken = |numbers: &[f32]| -> Vec<f32> {
            let texels = numbers.chunks_exact(self.channels.len());
            texels.flat_map(|texel| places.iter().map(|place| texel[*place])).collect()
        };
        let sides = [self.width, self.height, self.depth];
        let only = Self::new(self.name.clone(), sides, self.layers, channels, taken(&self.texels))?;
        let halves = self.halves.as_ref().map(|halves| Halves { numbers: taken(&halves.numbers), ..*halves });
        Ok(Self { halves, ..only })
    }
}

/// Whether a name can be used in files and in the code of every language.
fn is_identifier(name: &str) -> bool {
    name.len() <= 64
        && name.starts_with(|c: char| c.is_ascii_alphabetic())
        && name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_')
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Displacement;

    fn planted() -> Texture {
        Texture::new("LTC_1", [2, 3, 1], 2, &["a", "b"], (0_u8..24).map(f32::from).collect()).expect("a texture")
    }

    #[test]
    fn each_fault_is_named() {
        type Change = fn(&mut Texture);
        let changes: [(Change, &str); 10] = [
            (|t| t.name = "../x".to_owned(), "name is «../x»"),
            (|t| t.name = String::new(), "name is «»"),
            (|t| t.width = 0, "width is 0"),
            (|t| t.layers = 1 << 17, "layers is 131072"),
            (|t| t.channels.clear(), "channels are []"),
            (|t| t.channels[1] = "a".to_owned(), r#"channels are ["a", "a"]"#),
            (|t| t.height = 4, "texels has 24 numbers; 2 x 4 x 1 texels, 2 layers and 2 channels need 32"),
            (
                |t| t.halves = Some(Halves { numbers: vec![0.0; 3], displacement: Displacement::default() }),
                "halves has 3 numbers, but texels has 24",
            ),
            (|t| t.texels[5] = f32::NAN, "texels[5] is NaN"),
            (|t| t.texels[0] = f32::NEG_INFINITY, "texels[0] is -inf"),
        ];
        planted().check().expect("no fault");
        for (change, said) in changes {
            let mut texture = planted();
            change(&mut texture);
            let error = texture.check().expect_err(said).to_string();
            assert!(error.contains(said), "{error}");
        }
    }

    #[test]
    fn shapes_omit_layers_and_depth_of_one() {
        assert_eq!(planted().shape(), [2, 3, 2, 2]);
        assert_eq!(Texture::flat("t", [5, 4], &["r"], vec![0.0; 20]).expect("a texture").shape(), [4, 5, 1]);
        assert_eq!(Texture::new("t", [2, 3, 4], 1, &["r"], vec![0.0; 24]).expect("one").shape(), [4, 3, 2, 1]);
    }

    #[test]
    fn channels_are_selected_by_name() {
        let only = planted().only(&["b"]).expect("a channel");
        assert_eq!(only.texels, planted().texels.iter().copied().skip(1).step_by(2).collect::<Vec<_>>());
        let numbers: Vec<f32> = (0_u8..24).map(|i| -f32::from(i)).collect();
        let halves = Some(Halves { numbers, displacement: Displacement { mean: 0.1, max: 0.2 } });
        let only = Texture { halves, ..planted() }.only(&["b"]).expect("a channel").halves.expect("halves");
        assert_eq!((only.numbers[11], only.displacement.max), (-23.0, 0.2));
        assert!(planted().only(&["c"]).is_err());
        assert_eq!(planted().slices().count(), 2);
    }
}
