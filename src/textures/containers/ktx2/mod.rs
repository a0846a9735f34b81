//! KTX 2.0, the container of Khronos for textures [KTX File Format Specification 2.0.4].
//!
//! 2D textures, arrays of them, and 3D textures, one level, 16 or 32 bits a number, with or without zstd. The data
//! format descriptor and the level index are those that `ktx validate` expects. What the file says of itself is under
//! the key `ltcforge`, the channels' names under `ltcforge.channels`.
//!
//! The writer is our own: crate `ktx2_writer` brings BC6H compression and with it binaries of another compiler.

use ruzstd::encoding::{CompressionLevel, compress_to_vec};

use super::rules::{ContainerRules, Stored, Written, one_each};
use crate::{about::About, file::TextureFileError};
use ltcforge_fit::Precision;

const IDENTIFIER: [u8; 12] = *b"\xABKTX 20\xBB\r\n\x1A\n";
const HEADER_BYTES: usize = 80;
const LEVEL_INDEX_BYTES: usize = 24;
const SUPERCOMPRESSION_ZSTD: u32 = 2;

/// Versions, models and channels of the Khronos Data Format Specification 1.3, and what marks a channel of signed
/// floats.
const DESCRIPTOR_VERSION: u16 = 2;
const MODEL_RGBSDA: u8 = 1;
const PRIMARIES_UNSPECIFIED: u8 = 0;
const TRANSFER_LINEAR: u8 = 1;
const CHANNELS: [u8; 4] = [0, 1, 2, 15];
const SIGNED_FLOAT: u8 = 0x80 | 0x40;

/// The name in errors.
const NAME: &str = "KTX2";

/// KTX2, compressed or not.
pub(super) struct Ktx2 {
    pub(super) zstd: bool,
}

impl ContainerRules for Ktx2 {
    fn files(&self, _stem: &str, textures: &[Stored<'_>], about: &About) -> Result<Vec<Written>, TextureFileError> {
        one_each(textures, "ktx2", |texture| encode(texture, self.zstd, about))
    }
}

/// The file of one texture.
pub(crate) fn encode(stored: &Stored<'_>, zstd: bool, about: &About) -> Result<Vec<u8>, TextureFileError> {
    let (texture, rounded) = (stored.texture, &stored.rounded);
    stored.at_most_four(NAME)?;
    if texture.depth > 1 && texture.layers > 1 {
        return Err(stored.unsupported(NAME, "layers", texture.layers.to_string(), "1 where depth is more than 1"));
    }
    let (channels, number_bytes) = (texture.channels.len(), rounded.number_bytes());
    let data = rounded.little_endian();
    let level = if zstd { compress_to_vec(&*data, CompressionLevel::Fastest) } else { data.clone() };

    let descriptor = descriptor(channels, number_bytes);
    let key_values = key_values(&[
        ("KTXwriter", concat!("ltcforge ", env!("CARGO_PKG_VERSION"))),
        ("ltcforge", &about.lines().join("\n")),
        ("ltcforge.channels", &texture.channels.join(",")),
    ]);
    let descriptor_at = HEADER_BYTES + LEVEL_INDEX_BYTES;
    let key_values_at = descriptor_at + descriptor.len();
    let alignment = if zstd { 1 } else { lcm(channels * number_bytes, 4) };
    let level_at = (key_values_at + key_values.len()).next_multiple_of(alignment);

    // Zero where a texture has no such dimension.
    let none_if_one = |n: u32| if n == 1 { 0 } else { n };
    let scheme = if zstd { SUPERCOMPRESSION_ZSTD } else { 0 };
    let sizes = [texture.width, texture.height, none_if_one(texture.depth), none_if_one(texture.layers)];
    let mut file = Vec::with_capacity(level_at + level.len());
    file.extend(IDENTIFIER);
    words(&mut file, [vk_format(channels, rounded.precision), number_bytes as u32]);
    words(&mut file, sizes);
    // One face, one level.
    words(&mut file, [1, 1, scheme]);
    let length = |bytes: usize| u32::try_from(bytes).map_err(|_| too_long(stored, bytes));
    words(&mut file, [length(descriptor_at)?, length(descriptor.len())?]);
    words(&mut file, [length(key_values_at)?, length(key_values.len())?]);
    // No global data of a supercompression.
    longs(&mut file, [0, 0]);
    longs(&mut file, [level_at, level.len(), data.len()]);
    file.extend(descriptor);
    file.extend(key_values);
    file.resize(level_at, 0);
    file.extend(level);
    Ok(file)
}

fn too_long(stored: &Stored<'_>, bytes: usize) -> TextureFileError {
    stored.unsupported(NAME, "metadata", format!("{bytes} bytes long"), "less than 4 GiB")
}

/// `VK_FORMAT_R16_SFLOAT` and so on.
fn vk_format(channels: usize, precision: Precision) -> u32 {
    let first = match precision {
        Precision::F16 => 76,
        Precision::F32 => 100,
    };
    // Formats of one more channel lie 7 apart for 16 bits, which have normalised ones between, and 3 for 32.
    let step = match precision {
        Precision::F16 => 7,
        Precision::F32 => 3,
    };
    first + step * (channels as u32 - 1)
}

/// The data format descriptor: one basic block.
fn descriptor(channels: usize, number_bytes: usize) -> Vec<u8> {
    let block_bytes = 24 + 16 * channels;
    let mut block = Vec::new();
    words(&mut block, [4 + block_bytes as u32]);
    // Vendor Khronos, type basic.
    words(&mut block, [0]);
    block.extend(DESCRIPTOR_VERSION.to_le_bytes());
    block.extend((block_bytes as u16).to_le_bytes());
    block.extend([MODEL_RGBSDA, PRIMARIES_UNSPECIFIED, TRANSFER_LINEAR, 0]);
    // A block is one texel, all of it in plane 0.
    block.extend([0; 4]);
    block.extend([(channels * number_bytes) as u8, 0, 0, 0, 0, 0, 0, 0]);
    for (i, channel) in CHANNELS.iter().take(channels).enumerate() {
        let bits = 8 * number_bytes;
        block.extend(((i * bits) as u16).to_le_bytes());
        block.extend([(bits - 1) as u8, channel | SIGNED_FLOAT]);
        block.extend([0; 4]);
        // The lower and upper end of the range of values.
        block.extend((-1.0_f32).to_le_bytes());
        block.extend(1.0_f32.to_le_bytes());
    }
    block
}

/// Keys and values, which have to be sorted by key; each value ends in a zero.
fn key_values(pairs: &[(&str, &str)]) -> Vec<u8> {
    let mut sorted = pairs.to_vec();
    sorted.sort_unstable();
    let mut bytes = Vec::new();
    for (key, value) in sorted {
        words(&mut bytes, [(key.len() + value.len() + 2) as u32]);
        for text in [key, value] {
            bytes.extend(text.as_bytes());
            bytes.push(0);
        }
        bytes.resize(bytes.len().next_multiple_of(4), 0);
    }
    bytes
}

fn words<const N: usize>(file: &mut Vec<u8>, words: [u32; N]) {
    file.extend(words.iter().flat_map(|word| word.to_le_bytes()));
}

fn longs<const N: usize>(file: &mut Vec<u8>, longs: [usize; N]) {
    file.extend(longs.iter().flat_map(|long| (*long as u64).to_le_bytes()));
}

fn lcm(a: usize, b: usize) -> usize {
    let (mut x, mut y) = (a, b);
    while y != 0 {
        (x, y) = (y, x % y);
    }
    a / x * b
}
