//! File formats for textures, with one source file per format.
//!
//! A new format needs a source file and a line in [`TextureContainer`].

mod c_header;
mod csharp;
mod dds;
mod exr;
mod javascript;
mod json;
mod ktx2;
mod npy;
mod npz;
mod raw;
mod rules;
mod rust_module;

pub(super) use self::{
    c_header::numbers,
    dds::dx10,
    ktx2::{IDENTIFIER as KTX2_IDENTIFIER, Ktx2File, Sample, encode as ktx2, float_samples, vk_format},
    rules::{Stored, rounding_of, stored},
};
use super::{
    about::About,
    file::{TextureFile, TextureFileError},
    rounding::RoundingError,
    texture::Texture,
};
use ltcforge_fit::{Precision, named_list};
use serde_json::json;

named_list! {
    /// A file format for textures.
    pub enum TextureContainer {
        /// KTX 2.0 of Khronos, uncompressed. Any KTX2 loader can read it.
        Ktx2 = "ktx2",
        /// KTX 2.0 with zstd supercompression.
        Ktx2Zstd = "ktx2-zstd",
        /// `DirectDraw` Surface with the Direct3D 9 header, or with the Direct3D 10 header if the texture requires it.
        Dds = "dds",
        /// `DirectDraw` Surface with the Direct3D 10 header.
        DdsDx10 = "dds-dx10",
        /// `OpenEXR` with named channels and one part per slice.
        Exr = "exr",
        /// A `NumPy` array in C order.
        Npy = "npy",
        /// A `NumPy` archive of arrays, uncompressed.
        Npz = "npz",
        /// Only the numbers, little-endian, and a JSON document that describes them.
        Raw = "raw",
        /// Arrays for C and C++.
        CHeader = "c",
        /// Statics for Rust.
        RustModule = "rust",
        /// A static class for C#.
        CSharp = "csharp",
        /// An ES module that exports typed arrays.
        JavaScript = "js",
        /// JSON arrays of numbers.
        Json = "json",
    }
}

impl TextureContainer {
    /// The files with these textures: a single file whose name starts with `stem`, or one file per texture. If our
    /// shader reads the textures, the last file, `STEM.json`, has the contents of its binding 0.
    ///
    /// # Errors
    /// A texture is inconsistent, two textures have the same name, or the format cannot store a texture.
    pub fn files(
        self,
        stem: &str,
        textures: &[Texture],
        precision: Precision,
        about: &About,
    ) -> Result<Vec<TextureFile>, TextureFileError> {
        let stored = stored(textures, precision)?;
        let one_of_all = |ending: &str, bytes: Vec<u8>| {
            vec![TextureFile { path: format!("{stem}.{ending}"), bytes, rounding: rounding_of(&stored) }]
        };
        let one_each = |ending: &str, encode: &dyn Fn(&Stored<'_>) -> Result<Vec<u8>, TextureFileError>| {
            let file = |texture: &Stored<'_>| {
                let path = format!("{}.{ending}", texture.texture.name);
                Ok(TextureFile { path, bytes: encode(texture)?, rounding: texture.rounded.error })
            };
            stored.iter().map(file).collect::<Result<_, TextureFileError>>()
        };
        let mut files = match self {
            Self::Ktx2 | Self::Ktx2Zstd => one_each("ktx2", &|texture| ktx2(texture, self == Self::Ktx2Zstd, about))?,
            Self::Dds => one_each("dds", &dds::encode)?,
            Self::DdsDx10 => one_each("dds", &dx10)?,
            Self::Exr => one_each("exr", &|texture| exr::encode(texture, about))?,
            Self::Npy => one_each("npy", &|texture| Ok(npy::encode(texture)))?,
            Self::Npz => one_of_all("npz", npz::encode(&stored, about)?),
            Self::Raw => raw::files(&stored, about),
            Self::CHeader => one_of_all("h", c_header::text(stem, &stored, about).into_bytes()),
            Self::RustModule => one_of_all("rs", rust_module::text(&stored, about).into_bytes()),
            Self::CSharp => one_of_all("cs", csharp::text(&stored, about).into_bytes()),
            Self::JavaScript => one_of_all("js", javascript::text(&stored, about).into_bytes()),
            Self::Json => one_of_all("json", json::text(&stored, about).into_bytes()),
        };
        let path = format!("{stem}.json");
        // JSON documents contain the uniform themselves.
        if let Some(words) = about.uniform_json().filter(|_| files.iter().all(|file| file.path != path)) {
            let paths: Vec<_> = files.iter().map(|file| &file.path).collect();
            let document = json!({ "textures": paths, "ltc_table": words, "about": about.lines() });
            let bytes = format!("{document:#}\n").into_bytes();
            files.push(TextureFile { path, bytes, rounding: RoundingError::default() });
        }
        Ok(files)
    }
}

#[cfg(test)]
mod tests;
