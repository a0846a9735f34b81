//! `NumPy`'s `.npz` archive: a ZIP file of `.npy` files, without compression or timestamps.

use std::io::Write as _;

use rawzip::{ZipArchiveWriter, ZipDataWriter};

use super::{npy, rules::Stored};
use crate::{about::About, file::TextureFileError};

/// All textures in one file. The member `about.txt` holds the comments.
pub(super) fn encode(textures: &[Stored<'_>], about: &About) -> Result<Vec<u8>, TextureFileError> {
    let arrays = textures.iter().map(|texture| (format!("{}.npy", texture.texture.name), npy::encode(texture)));
    let text = ("about.txt".to_owned(), (about.lines().join("\n") + "\n").into_bytes());
    archive(arrays.chain([text]))
        .map_err(|error| TextureFileError::Refused { container: "NPZ", reason: error.to_string() })
}

fn archive(members: impl Iterator<Item = (String, Vec<u8>)>) -> Result<Vec<u8>, rawzip::Error> {
    let mut archive = ZipArchiveWriter::new(Vec::new());
    for (name, bytes) in members {
        let (mut entry, config) = archive.new_file(name.as_str()).start()?;
        let mut data: ZipDataWriter<_> = config.wrap(&mut entry);
        data.write_all(&bytes)?;
        let (_, descriptor) = data.finish()?;
        entry.finish(descriptor)?;
    }
    archive.finish()
}
