//! The bytes of a KTX2 file: header, level index, data format descriptor, keys and values, levels.
//!
//! `ktx validate` accepts the descriptor and the level index. The crate `ktx2_writer` is not used, because it adds BC6H
//! compression and binaries from another compiler.

use std::borrow::Cow;

use ruzstd::encoding::{CompressionLevel, compress_to_vec};

/// The magic number of a file.
pub(crate) const IDENTIFIER: [u8; 12] = *b"\xABKTX 20\xBB\r\n\x1A\n";
const HEADER_BYTES: usize = 80;
const LEVEL_INDEX_BYTES: usize = 24;
const SUPERCOMPRESSION_ZSTD: u32 = 2;

/// Versions and colour models from the Khronos Data Format Specification 1.3.
const DESCRIPTOR_VERSION: u16 = 2;
const MODEL_RGBSDA: u8 = 1;
const PRIMARIES_UNSPECIFIED: u8 = 0;
const TRANSFER_LINEAR: u8 = 1;

/// A channel of a texel in a data format descriptor.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Sample {
    /// The first bit.
    pub(crate) bit_offset: u16,
    /// The number of bits.
    pub(crate) bits: u8,
    /// The channel number, with flags for its number type.
    pub(crate) channel: u8,
    /// The encodings of the lower and the upper end of the range of values.
    pub(crate) range: [u32; 2],
}

/// The contents of a file.
#[derive(Debug, Clone)]
pub(crate) struct Ktx2File {
    /// The number of its `VkFormat`.
    pub(crate) vk_format: u32,
    /// The size in bytes of the little-endian numbers.
    pub(crate) number_bytes: usize,
    pub(crate) texel_bytes: usize,
    pub(crate) samples: Vec<Sample>,
    /// Width, height, depth and layers of the first level. A missing dimension is zero.
    pub(crate) sizes: [u32; 4],
    /// The texels of each level, the largest level first.
    pub(crate) levels: Vec<Vec<u8>>,
    /// Whether the levels are compressed.
    pub(crate) zstd: bool,
}

impl Ktx2File {
    /// The bytes of the file, with these keys and values, and the name of the writer.
    ///
    /// # Errors
    /// The length of keys and values, if it is 4 GiB or more.
    pub(crate) fn bytes(&self, pairs: &[(&str, String)]) -> Result<Vec<u8>, usize> {
        let compressed = |level: &Vec<u8>| compress_to_vec(&**level, CompressionLevel::Fastest);
        let stored = |level| if self.zstd { Cow::Owned(compressed(level)) } else { Cow::Borrowed(&**level) };
        let stored: Vec<Cow<'_, [u8]>> = self.levels.iter().map(stored).collect();
        let descriptor = self.descriptor();
        let writer = ("KTXwriter", concat!("ltcforge ", env!("CARGO_PKG_VERSION")).to_owned());
        let key_values = key_values([&[writer], pairs].concat());
        let descriptor_at = HEADER_BYTES + LEVEL_INDEX_BYTES * stored.len();
        let key_values_at = descriptor_at + descriptor.len();
        let alignment = if self.zstd { 1 } else { lcm(self.texel_bytes, 4) };
        let mut places = vec![0; stored.len()];
        let mut end = key_values_at + key_values.len();
        // The file stores the smallest level first.
        for (place, level) in places.iter_mut().zip(&stored).rev() {
            *place = end.next_multiple_of(alignment);
            end = *place + level.len();
        }

        let mut file = Vec::with_capacity(end);
        file.extend(IDENTIFIER);
        words(&mut file, [self.vk_format, self.number_bytes as u32]);
        words(&mut file, self.sizes);
        // A texture that is not a cube map has one face.
        words(&mut file, [1, stored.len() as u32, if self.zstd { SUPERCOMPRESSION_ZSTD } else { 0 }]);
        let length = |bytes: usize| u32::try_from(bytes).map_err(|_| bytes);
        words(&mut file, [length(descriptor_at)?, length(descriptor.len())?]);
        words(&mut file, [length(key_values_at)?, length(key_values.len())?]);
        // The file has no global data for supercompression.
        longs(&mut file, [0, 0]);
        for ((place, level), raw) in places.iter().zip(&stored).zip(&self.levels) {
            longs(&mut file, [*place, level.len(), raw.len()]);
        }
        file.extend(descriptor);
        file.extend(key_values);
        for (place, level) in places.iter().zip(&stored).rev() {
            file.resize(*place, 0);
            file.extend(&**level);
        }
        Ok(file)
    }

    /// The data format descriptor: one basic block.
    fn descriptor(&self) -> Vec<u8> {
        let block_bytes = 24 + 16 * self.samples.len();
        let mut block = Vec::new();
        words(&mut block, [4 + block_bytes as u32]);
        // The vendor is Khronos, and the descriptor type is basic.
        words(&mut block, [0]);
        block.extend(DESCRIPTOR_VERSION.to_le_bytes());
        block.extend((block_bytes as u16).to_le_bytes());
        block.extend([MODEL_RGBSDA, PRIMARIES_UNSPECIFIED, TRANSFER_LINEAR, 0]);
        // A block is one texel, with all bytes in plane 0.
        block.extend([0; 4]);
        block.extend([self.texel_bytes as u8, 0, 0, 0, 0, 0, 0, 0]);
        for Sample { bit_offset, bits, channel, range } in &self.samples {
            block.extend(bit_offset.to_le_bytes());
            block.extend([bits - 1, *channel]);
            block.extend([0; 4]);
            words(&mut block, *range);
        }
        block
    }
}

/// The keys and values, which must be sorted by key. A zero byte ends each value.
fn key_values(mut pairs: Vec<(&str, String)>) -> Vec<u8> {
    pairs.sort_unstable();
    let mut bytes = Vec::new();
    for (key, value) in pairs {
        words(&mut bytes, [(key.len() + value.len() + 2) as u32]);
        for text in [key, &value] {
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
