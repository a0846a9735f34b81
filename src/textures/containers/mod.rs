//! File formats that hold textures, one file each.
//!
//! A new format needs a file and a line in [`TextureContainer`].

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

pub(crate) use self::rules::ContainerRules;
use self::rules::Written;
pub(super) use self::{
    dds::dx10,
    ktx2::{IDENTIFIER as KTX2_IDENTIFIER, Ktx2File, Sample, encode as ktx2, float_samples, vk_format},
    rules::{Stored, stored},
};
use super::{
    about::About,
    file::{TextureFile, TextureFileError},
    texture::Texture,
};
use ltcforge_fit::{Precision, named_list};

named_list! {
    /// A file format that holds textures.
    pub enum TextureContainer: ContainerRules {
        /// Khronos' KTX 2.0, uncompressed: what any loader of KTX2 reads.
        Ktx2 = "ktx2" => ktx2::Ktx2 { zstd: false },
        /// KTX 2.0 with zstd supercompression.
        Ktx2Zstd = "ktx2-zstd" => ktx2::Ktx2 { zstd: true },
        /// `DirectDraw` Surface with the header of Direct3D 9, or, where that cannot hold the texture, of Direct3D 10.
        Dds = "dds" => dds::Dds { always_dx10: false },
        /// `DirectDraw` Surface with the header of Direct3D 10.
        DdsDx10 = "dds-dx10" => dds::Dds { always_dx10: true },
        /// `OpenEXR` with named channels, a part for each slice.
        Exr = "exr" => exr::Exr,
        /// `NumPy`'s array, C order.
        Npy = "npy" => npy::Npy,
        /// `NumPy`'s archive of arrays, uncompressed.
        Npz = "npz" => npz::Npz,
        /// The numbers alone, little-endian, beside a JSON document that says what they are.
        Raw = "raw" => raw::Raw,
        /// Arrays for C and C++.
        CHeader = "c" => c_header::CHeader,
        /// Statics for Rust.
        RustModule = "rust" => rust_module::RustModule,
        /// A static class for C#.
        CSharp = "csharp" => csharp::CSharp,
        /// An ES module that exports typed arrays.
        JavaScript = "js" => javascript::JavaScript,
        /// Arrays of numbers.
        Json = "json" => json::Json,
    }
}

impl TextureContainer {
    /// The files that hold these textures: one, whose name begins with `stem`, or one for each texture.
    ///
    /// # Errors
    /// When a texture is faulty, two have one name, or the format cannot hold one.
    pub fn files(
        self,
        stem: &str,
        textures: &[Texture],
        precision: Precision,
        about: &About,
    ) -> Result<Vec<TextureFile>, TextureFileError> {
        let stored = stored(textures, precision)?;
        let files = self.rules().files(stem, &stored, about)?;
        let file = |Written { name, bytes, rounding }| TextureFile { path: name, bytes, rounding };
        Ok(files.into_iter().map(file).collect())
    }
}

#[cfg(test)]
mod tests;
