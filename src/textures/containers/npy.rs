//! `NumPy`'s `.npy` format, version 1.0: C order, little-endian.

use super::rules::Stored;
use ltcforge_files::container::NPY_MAGIC;

/// The alignment of the data in the file.
const ALIGNMENT: usize = 64;

/// The file of one texture: an array with the shape from [`crate::Texture::shape`]. The format has no comments.
pub(super) fn encode(stored: &Stored<'_>) -> Vec<u8> {
    let descr = stored.rounded.either("<f4", "<f2");
    let shape: Vec<String> = stored.texture.shape().iter().map(usize::to_string).collect();
    let mut header = format!("{{'descr': '{descr}', 'fortran_order': False, 'shape': ({}), }}", shape.join(", "));
    // Magic number, version, length of the header, and the header with a line break at its end.
    let before = NPY_MAGIC.len() + 2 + 2;
    let length = (before + header.len() + 1).next_multiple_of(ALIGNMENT) - before;
    header = format!("{header:<width$}\n", width = length - 1);
    let mut file = NPY_MAGIC.to_vec();
    file.extend([1, 0]);
    // The header is shorter than 128 bytes, even with a shape of five numbers.
    file.extend((length as u16).to_le_bytes());
    file.extend(header.into_bytes());
    file.extend(stored.rounded.little_endian());
    file
}
