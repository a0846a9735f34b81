//! KTX 2.0, the texture container of Khronos [KTX File Format Specification 2.0.4].
//!
//! Files have one level, 16 or 32 bits per number, and optional zstd compression. They hold 2D textures, arrays of 2D
//! textures, and 3D textures. The key `ltcforge` holds the comments, and `ltcforge.channels` the names of the channels.

mod file;

pub(crate) use self::file::{IDENTIFIER, Ktx2File, Sample};
use super::rules::Stored;
use crate::{about::About, file::TextureFileError};
use ltcforge_fit::Precision;

/// Channel numbers from the Khronos Data Format Specification 1.3, and the flags for signed floats.
const CHANNELS: [u8; 4] = [0, 1, 2, 15];
const SIGNED_FLOAT: u8 = 0x80 | 0x40;

/// The format's name in errors.
const NAME: &str = "KTX2";

/// The file of one texture.
pub(crate) fn encode(stored: &Stored<'_>, zstd: bool, about: &About) -> Result<Vec<u8>, TextureFileError> {
    let (texture, rounded) = (stored.texture, &stored.rounded);
    stored.at_most_four(NAME)?;
    if texture.depth > 1 && texture.layers > 1 {
        return Err(stored.unsupported(NAME, "layers", texture.layers.to_string(), "1 where depth is more than 1"));
    }
    let (channels, number_bytes) = (texture.channels.len(), rounded.number_bytes());
    // KTX2 stores a missing dimension as zero.
    let none_if_one = |n: u32| if n == 1 { 0 } else { n };
    let file = Ktx2File {
        vk_format: vk_format(channels, rounded.precision),
        number_bytes,
        texel_bytes: channels * number_bytes,
        samples: float_samples(channels, number_bytes),
        sizes: [texture.width, texture.height, none_if_one(texture.depth), none_if_one(texture.layers)],
        levels: vec![rounded.little_endian()],
        zstd,
    };
    let pairs = [("ltcforge", about.lines().join("\n")), ("ltcforge.channels", texture.channels.join(","))];
    file.bytes(&pairs)
        .map_err(|bytes| stored.unsupported(NAME, "metadata", format!("{bytes} bytes long"), "less than 4 GiB"))
}

/// `VK_FORMAT_R16_SFLOAT` and similar formats.
pub(crate) fn vk_format(channels: usize, precision: Precision) -> u32 {
    let (first, step) = match precision {
        Precision::F16 => (76, 7),
        Precision::F32 => (100, 3),
    };
    first + step * (channels as u32 - 1)
}

/// The channels of a texel of signed floats, each with this many bytes.
pub(crate) fn float_samples(channels: usize, number_bytes: usize) -> Vec<Sample> {
    let bits = 8 * number_bytes;
    let sample = |(i, channel): (usize, &u8)| Sample {
        bit_offset: (i * bits) as u16,
        bits: bits as u8,
        channel: channel | SIGNED_FLOAT,
        // The lower and upper end of the range of values.
        range: [(-1.0_f32).to_bits(), 1.0_f32.to_bits()],
    };
    CHANNELS.iter().take(channels).enumerate().map(sample).collect()
}
